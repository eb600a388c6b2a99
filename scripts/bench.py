#!/usr/bin/env python3
"""Sets Kiln beside its peers on the same work in one run: whole processes, medians, quality beside speed.

    scripts/bench.py                  vase, sweep and loft on a fixed grid, the vase within 0.1 mm, peak memory,
                                      evaluation of curves, the teapot, a face at equal deviation, evaluation
                                      of surfaces, height maps, booleans, weights by heat, inverse
                                      kinematics, keys of clips, growth, growth of motion, a thousand
                                      documents, glTF files made small, every spec of the gallery
    scripts/bench.py --only vase      one part: vase, sweep, loft, tolerance, memory, curves, teapot, face,
                                      surfaces, heights, booleans, weights, reach, keys, growth, motion, farm,
                                      packing, authoring or gallery
    scripts/bench.py --large          memory up to an output of 1 GB
    scripts/bench.py --json FILE      the figures as JSON too
    scripts/bench.py --plot FILE      growth as a picture
    scripts/bench.py --readme         also renews the tables between the markers in README.md

Kiln's time runs from its start to .glb and report on disk. Needs scripts/setup --peers and the release build.
Nothing here asserts a time: the tables say what was measured. Exit code 1: a tool failed or is missing.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path
from typing import Any

from peers import (
    animation,
    authoring,
    booleans,
    evaluation,
    farm,
    gallery,
    growth,
    heights,
    models,
    motion,
    packing,
    specs,
    surfaces,
)
from peers.process import Runs, together

ROOT = Path(__file__).resolve().parents[1]
PEERS = ROOT / "scripts" / "peers"
PYTHON = ROOT / ".venv" / "bin" / "python"
CAD_PYTHON = ROOT / ".venv-peers" / "bin" / "python"
KILN = Path(os.environ.get("KILN_BIN", ROOT / "target" / "release" / "kiln"))
MARKERS = ("<!-- bench:begin -->", "<!-- bench:end -->")
PARTS = (
    "vase",
    "sweep",
    "loft",
    "tolerance",
    "memory",
    "curves",
    "teapot",
    "face",
    "surfaces",
    "heights",
    "booleans",
    "weights",
    "reach",
    "keys",
    "growth",
    "motion",
    "farm",
    "packing",
    "authoring",
    "gallery",
)

TOLERANCE = 1e-4  # meters: a tenth of a millimeter on a vase of two meters
# CadQuery's own tolerance is steered until its measured deviation is Kiln's; its angle is set out of the way.
CAD_TOLERANCES = (0.5, 1.0, 2.0)
CAD_ANGLE = 1.0
BYTES_A_QUAD = 48  # a vertex of position and normal, two triangles of 32-bit indices
MEMORY_STEPS = (1e6, 1e7, 1e8)
LARGE_STEP = 1e9
MEMORY_FLOOR = 30e6

Part = dict[str, Any]


def main() -> int:
    """Measure what the command line asks for; returns the exit code."""
    options = arguments()
    if not KILN.is_file():
        print(f"bench: {KILN} is missing; run cargo build --release", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory(prefix="kiln-bench-") as name:
        folder = Path(name)
        specs.write(folder)
        surfaces.write(folder)
        parts = {part: measure(part, folder, options) for part in PARTS if part in options.only}
    figures = {"machine": machine(), "date": date.today().isoformat(), "runs": options.runs, **parts}
    text = tables(figures)
    print(text)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    if "growth" in parts and options.plot:
        options.plot.write_text(growth.plot(parts["growth"]), encoding="utf-8")
    if options.readme:
        renew(ROOT / "README.md", text)
    return 1 if any(row.get("failure") for part in parts.values() for row in part["rows"]) else 0


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="scripts/bench.py", description=__doc__.split("\n\n")[0])
    parser.add_argument("--runs", type=int, default=5, help="runs of each command (default 5)")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS, help="the parts to measure")
    parser.add_argument("--large", action="store_true", help="memory up to an output of 1 GB")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures as JSON")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the growth of time and memory as SVG")
    parser.add_argument("--readme", action="store_true", help="renew the tables in README.md")
    return parser.parse_args()


def measure(part: str, folder: Path, options: argparse.Namespace) -> Part:
    """The figures of one part."""
    if part == "memory":
        return memory(folder, [*MEMORY_STEPS, *([LARGE_STEP] if options.large else [])])
    if part == "curves":
        peer = [str(PYTHON), str(PEERS / "peer_curves.py")]
        return evaluation.measure(KILN, peer, folder, options.runs, tell)
    if part in ("teapot", "face", "surfaces"):
        return of_surfaces(part, folder, options.runs)
    if part == "heights":
        peer = [str(CAD_PYTHON), str(PEERS / "peer_delatin.py")]
        return heights.measure(KILN, peer, folder, options.runs, tell)
    if part == "booleans":
        peers = [
            ("manifold-3d", ["node", str(PEERS / "peer_booleans.mjs")]),
            ("manifold3d", [str(PYTHON), str(PEERS / "peer_booleans.py")]),
        ]
        return booleans.measure(KILN, peers, folder, options.runs, tell)
    if part == "weights":
        peer = [str(PYTHON), str(ROOT / "tests" / "crosscheck" / "blender_weights.py")]
        return motion.measure(KILN, peer, folder, options.runs, tell)
    if part in ("reach", "keys", "motion"):
        return of_clips(part, folder, options.runs)
    if part in ("growth", "farm", "packing", "authoring", "gallery"):
        return of_files(part, folder, options.runs)
    return tolerance(folder) if part == "tolerance" else grid(part, folder, options.runs)


def of_clips(part: str, folder: Path, runs: int) -> Part:
    """Inverse kinematics, keys and growth of motion."""
    if part == "reach":
        return animation.reach(KILN, [str(PYTHON), str(PEERS / "peer_ik.py")], folder, runs, tell)
    if part == "keys":
        return animation.keys(KILN, PEERS / "node_modules" / ".bin" / "gltfpack", folder, tell)
    return animation.growth(KILN, folder, runs, tell)


def of_files(part: str, folder: Path, runs: int) -> Part:
    """Large files, many files, and files of other makers."""
    if part == "growth":
        return growth.measure(KILN, folder, runs, tell)
    if part == "farm":
        return farm.measure(KILN, CAD_PYTHON.parent / "ninja", folder, runs, tell)
    if part == "packing":
        programs = PEERS / "node_modules" / ".bin"
        plain = ROOT / "tests" / "crosscheck" / "plain.mjs"
        return packing.measure(KILN, (programs, plain), folder, runs, tell)
    if part == "authoring":
        return authoring.measure(KILN, [str(PYTHON), str(PEERS / "peer_picture.py")], folder, runs, tell)
    return gallery.measure(KILN, ROOT / "specs", folder, runs, tell)


def of_surfaces(part: str, folder: Path, runs: int) -> Part:
    """Patches and NURBS beside their peers."""

    def peer(python: Path, tool: str) -> list[str]:
        return [str(python), str(PEERS / f"peer_{tool}.py")]

    checker = [str(PYTHON), str(PEERS / "surface_quality.py")]
    if part == "surfaces":
        return surfaces.evaluation(KILN, peer(PYTHON, "surface"), folder, runs, tell)
    if part == "face":
        return surfaces.face(KILN, peer(CAD_PYTHON, "opencascade"), checker, folder, tell)
    peers = [("Blender", peer(PYTHON, "blender"), "glb"), ("geomdl", peer(PYTHON, "geomdl"), "obj")]
    return surfaces.teapot(KILN, peers, checker, folder, runs, tell)


def grid(case: str, folder: Path, runs: int) -> Part:
    """Time, memory and quality of one model on a fixed grid, all tools in turn."""
    entries = [*kiln_entries(case, folder), *peer_entries(case, folder)]
    together(entries, runs, folder, tell)
    quality = measured_quality(case, [e.output for e in entries if e.failure is None], folder)
    rows = [{**timing(entry), **quality.get(entry.output, {})} for entry in entries]
    base = next((e.median for e in entries if e.failure is None and e.name == "Kiln"), None)
    for row in rows:
        row["times-kiln"] = row["seconds"] / base if base and row["seconds"] else None
    return {"rows": rows}


def kiln_entries(case: str, folder: Path) -> list[Runs]:
    """Kiln with and without the report."""
    entries = []
    for name, extra in (("Kiln", []), ("Kiln, no report", ["--no-report"])):
        out = folder / name.replace(", ", "-").replace(" ", "-").lower()
        line = [str(KILN), "bake", f"{case}.toml", "--out", str(out), "--quiet", *extra]
        entries.append(Runs(name, line, out / f"{case}.glb"))
    return entries


def peer_entries(case: str, folder: Path) -> list[Runs]:
    """Every other tool on the same model."""

    def script(name: str, python: Path, tool: str) -> Runs:
        out = folder / f"{case}-{tool}.glb"
        return Runs(name, [str(python), str(PEERS / f"peer_{tool}.py"), case, str(out)], out)

    if case == "loft":  # the others have no lofts with splines
        return [script("Blender", PYTHON, "blender")]
    off, jscad = folder / f"{case}-openscad.off", folder / f"{case}-jscad.glb"
    node = ["node", str(PEERS / "peer_jscad.mjs"), case, str(folder / "jscad.json"), str(jscad)]
    return [
        Runs("OpenSCAD", ["openscad", "-o", str(off), str(folder / f"{case}.scad")], off),
        Runs("JSCAD", node, jscad),
        script("manifold3d", PYTHON, "manifold"),
        script("trimesh", PYTHON, "trimesh"),
        script("Blender", PYTHON, "blender"),
        script("CadQuery", CAD_PYTHON, "cadquery"),
    ]


def timing(entry: Runs) -> dict[str, Any]:
    """The times and the memory of one command."""
    done = entry.failure is None
    return {
        "tool": entry.name,
        "failure": entry.failure,
        "seconds": entry.median if done else None,
        "fastest": min(entry.wall) if done else None,
        "cpu": sorted(entry.cpu)[len(entry.cpu) // 2] if done else None,
        "peak": entry.peak if done else None,
    }


def measured_quality(case: str, files: list[Path], folder: Path) -> dict[Path, dict[str, Any]]:
    """What the common checker says of each file."""
    tell(f"quality of {len(files)} files")
    out = folder / "quality.json"
    line = [str(PYTHON), str(PEERS / "quality.py"), case, str(out), *map(str, files)]
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL)
    return dict(zip(files, json.loads(out.read_text(encoding="utf-8")), strict=True))


def tolerance(folder: Path) -> Part:
    """Triangles for a measured deviation: Kiln, CadQuery at the same one, and the asymptotic optimum."""
    line = [str(KILN), "bake", "tolerance.toml", "--out", "kiln", "--quiet"]
    entry = Runs("Kiln", line, folder / "kiln" / "tolerance.glb")
    together([entry], 1, folder, tell)
    if entry.failure:
        return {"rows": [timing(entry)]}
    own = measured_quality("vase", [entry.output], folder)[entry.output]
    optimum = models.vase_optimum(own["deviation"])
    rows: list[dict[str, Any]] = [{"tool": "Kiln", **own, "times-optimum": own["triangles"] / optimum}]
    rows.append(cadquery_at(own["deviation"], folder))
    if rows[1].get("triangles"):
        rows[1]["times-optimum"] = rows[1]["triangles"] / optimum
        rows[1]["times-kiln"] = rows[1]["triangles"] / own["triangles"]
    promised = models.vase_optimum(TOLERANCE)
    rows.append({"tool": "optimum at 0.1 mm", "triangles": promised, "deviation": TOLERANCE})
    rows[0]["times-optimum-promised"] = own["triangles"] / promised
    return {"rows": rows}


def cadquery_at(deviation: float, folder: Path) -> dict[str, Any]:
    """CadQuery's triangles at a measured deviation, between runs around it (both are powers of each other)."""
    entries = []
    for factor in CAD_TOLERANCES:
        out = folder / f"cad-{factor}.glb"
        line = [str(CAD_PYTHON), str(PEERS / "peer_cadquery.py"), "vase", str(out)]
        entries.append(Runs("CadQuery", [*line, str(deviation * factor), str(CAD_ANGLE)], out))
    together(entries, 1, folder, tell)
    failed = next((entry for entry in entries if entry.failure), None)
    if failed:
        return timing(failed)
    found = measured_quality("vase", [entry.output for entry in entries], folder).values()
    return {"tool": "CadQuery", "triangles": surfaces.at(list(found), deviation), "deviation": deviation}


def memory(folder: Path, steps: list[float]) -> Part:
    """Peak memory beside the bytes written, with and without the report."""
    rows = []
    for size in steps:
        across = round(math.sqrt(size / BYTES_A_QUAD / 2))
        (folder / "memory.toml").write_text(specs.kiln_vase(across, 2 * across))
        for entry in kiln_entries("memory", folder):
            together([entry], 1, folder, tell)
            row = {**timing(entry), "tool": entry.name}
            if entry.failure is None:
                row["bytes"] = entry.output.stat().st_size
                row["times-bytes"] = max(0.0, row["peak"] - MEMORY_FLOOR) / row["bytes"]
                entry.output.unlink()
            rows.append(row)
    return {"rows": rows}


def tables(figures: dict[str, Any]) -> str:
    """The figures as Markdown."""
    blocks = [f"Measured on {figures['machine']}, {figures['date']}, median of {figures['runs']} whole processes."]
    cases = [case for case in ("vase", "sweep", "loft") if case in figures]
    blocks += [grid_table(case, figures[case]["rows"]) for case in cases]
    others = {
        "tolerance": tolerance_table,
        "memory": memory_table,
        "curves": curves_table,
        "teapot": teapot_table,
        "face": face_table,
        "surfaces": surfaces_table,
        "heights": heights_table,
        "booleans": booleans_table,
        "weights": weights_table,
        "reach": reach_table,
        "keys": keys_table,
        "growth": growth_table,
        "motion": motion_table,
        "farm": farm_table,
        "packing": packing_table,
        "authoring": authoring_table,
        "gallery": gallery_table,
    }
    blocks += [table(figures[part]["rows"]) for part, table in others.items() if part in figures]
    return "\n\n".join(blocks)


def grid_table(case: str, rows: list[dict[str, Any]]) -> str:
    """One model by all tools."""
    sizes = {
        "vase": "128 x 256 quads, closed",
        "sweep": "64 x 512 quads, closed",
        "loft": "128 x 128 quads, closed",
    }
    head = ["tool", "ms", "times Kiln", "cpu ms", "peak MB", "triangles", "bytes", "deviation", "closed"]
    body = [
        [
            row["tool"], thousandths(row["seconds"]), ratio(row["times-kiln"]), thousandths(row["cpu"]),
            millions(row["peak"]), count(row.get("triangles")), count(row.get("bytes")),
            small(row.get("deviation")), {True: "yes", False: "no"}.get(row.get("closed"), "-"),
        ]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]  # fmt: skip
    return f"**{case}** ({sizes[case]})\n\n{markdown(head, body)}"


def tolerance_table(rows: list[dict[str, Any]]) -> str:
    """Triangles at equal measured deviation."""
    head = [
        "vase within 0.1 mm",
        "triangles",
        "measured deviation",
        "times the optimum",
        "times Kiln",
    ]
    body = [
        [
            row["tool"], count(row.get("triangles")), small(row.get("deviation")),
            ratio(row.get("times-optimum")), ratio(row.get("times-kiln")),
        ]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def memory_table(rows: list[dict[str, Any]]) -> str:
    """Memory against output."""
    head = ["memory", "bytes written", "ms", "peak MB", "(peak - 30 MB) / bytes"]
    body = [
        [row["tool"], count(row.get("bytes")), thousandths(row["seconds"]), millions(row["peak"]),
         ratio(row.get("times-bytes"))]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def curves_table(rows: list[dict[str, Any]]) -> str:
    """Evaluation by curve."""
    head = [
        "point and first derivative",
        "Kiln, ns",
        "scipy or numpy, ns",
        "times Kiln",
        "geomdl, ns",
        "times Kiln",
    ]
    body = [
        [
            row["curve"], ratio(row["kiln"]), ratio(row["scipy"]), ratio(row["scipy-times-kiln"]),
            count(row["geomdl"]), ratio(row["geomdl-times-kiln"]),
        ]
        for row in rows
    ]  # fmt: skip
    return f"**curves** ({count(evaluation.POINTS)} points each)\n\n{markdown(head, body)}"


def teapot_table(rows: list[dict[str, Any]]) -> str:
    """The teapot, from script to file."""
    head = ["teapot within a thousandth of its size", "ms", "times Kiln", "triangles", "bytes", "deviation"]
    body = [
        [
            row["tool"], thousandths(row["seconds"]), ratio(row["times-kiln"]), count(row.get("triangles")),
            count(row.get("bytes")), small(row.get("deviation")),
        ]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def face_table(rows: list[dict[str, Any]]) -> str:
    """Triangles of one bicubic face at the deviation that was measured on Kiln's."""
    head = ["B-spline face at equal deviation", "triangles", "measured deviation", "Kiln's share of it"]
    body = [
        [row["tool"], count(row["triangles"]), small(row["deviation"]), ratio(row["kiln-of-it"])]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]
    return markdown(head, body)


def surfaces_table(rows: list[dict[str, Any]]) -> str:
    """Evaluation by surface."""
    head = ["point and both first derivatives", "Kiln, ns", "geomdl, ns", "times Kiln"]
    body = [[row["surface"], ratio(row["kiln"]), count(row["geomdl"]), ratio(row["times-kiln"])] for row in rows]
    return markdown(head, body)


def heights_table(rows: list[dict[str, Any]]) -> str:
    """Dense maps by base, and ground within an error."""
    head = [
        f"height maps: {heights.DENSE}² samples dense, {heights.GROUND}² within an error",
        "ms",
        "times the rough plane, or pydelatin",
        "peak MB",
        "triangles",
    ]
    body = [
        [
            row["tool"], thousandths(row["seconds"]), ratio(row["times"]), millions(row["peak"]),
            count(row.get("triangles")),
        ]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def booleans_table(rows: list[dict[str, Any]]) -> str:
    """One ball without another by all tools."""
    head = ["two balls of 100 352 triangles, difference", "ms", "of the fastest other", "cpu ms", "peak MB"]
    body = [
        [
            row["tool"], thousandths(row["seconds"]), ratio(row["of-fastest"]), thousandths(row["cpu"]),
            millions(row["peak"]),
        ]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def weights_table(rows: list[dict[str, Any]]) -> str:
    """Weights by heat by both tools."""
    head = ["50 000 points, 50 bones, weights by heat", "ms, from files to a file", "ms, weights alone", "of Blender's"]
    body = [
        [row["tool"], thousandths(row["seconds"]), thousandths(row["weights"]), ratio(row.get("of-blender"))]
        if row["failure"] is None
        else [row["tool"], "failed", "-", "-"]
        for row in rows
    ]
    return markdown(head, body)


def reach_table(rows: list[dict[str, Any]]) -> str:
    """Inverse kinematics by both tools."""
    head = [
        "7 joints with limits, 60 s at 60 frames a second",
        "ms, whole process",
        "solves a second",
        "furthest from its place, mm",
        "times Blender's",
    ]
    body = [
        [
            row["tool"],
            thousandths(row["seconds"]),
            count(row["solves"]),
            thousandths(row["furthest"]),
            ratio(row.get("times-blender")),
        ]
        if row["failure"] is None
        else [row["tool"], "failed", *["-"] * 3]
        for row in rows
    ]
    return markdown(head, body)


def keys_table(rows: list[dict[str, Any]]) -> str:
    """Keys at the same measured error of skinned vertices."""
    head = [
        "clips of",
        "keys",
        "gltfpack, resampled",
        "furthest vertex",
        "Kiln",
        "furthest vertex",
        "of gltfpack's",
    ]
    body = [
        [
            row["file"],
            count(row["source"]),
            count(row["gltfpack"]),
            f"{row['gltfpack-error']:.3g}",
            count(row["kiln"]),
            f"{row['kiln-error']:.3g}",
            ratio(row["of-gltfpack"]),
        ]
        if row["failure"] is None
        else [row["file"], "failed", *["-"] * 5]
        for row in rows
    ]
    return markdown(head, body)


def motion_table(rows: list[dict[str, Any]]) -> str:
    """A swaying tube from small to large."""
    head = ["a skinned tube sways", "", "ms", "peak MB", "exponent of the last step"]
    body = [
        [
            row["axis"],
            count(row["size"]),
            thousandths(row["seconds"]),
            millions(row["peak"]),
            f"{row['exponent']:.2f}" if "exponent" in row else "",
        ]
        if row["failure"] is None
        else [row["axis"], count(row["size"]), "failed", "-", "-"]
        for row in rows
    ]
    return markdown(head, body)


def growth_table(rows: list[dict[str, Any]]) -> str:
    """One face from coarse to fine."""
    head = ["B-spline face, report included", "triangles", "ms", "us a triangle", "peak MB", "bytes"]
    body = [
        [
            f"within {row['tolerance']:g}", count(row["triangles"]), thousandths(row["seconds"]),
            ratio(row["seconds"] / row["triangles"] * 1e6), millions(row["peak"]), count(row["bytes"]),
        ]
        if row["failure"] is None
        else [f"within {row['tolerance']:g}", "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def farm_table(rows: list[dict[str, Any]]) -> str:
    """A thousand documents."""
    head = [f"{farm.DOCUMENTS} documents", "ms", "cpu ms", "times Ninja"]
    body = [
        [row["work"], thousandths(row["seconds"]), thousandths(row["cpu"]), ratio(row["times-ninja"])]
        if row["failure"] is None
        else [row["work"], "failed", "-", "-"]
        for row in rows
    ]
    return markdown(head, body)


def packing_table(rows: list[dict[str, Any]]) -> str:
    """Large files of other makers."""
    head = [
        "a million triangles",
        "tool",
        "ms",
        "times Kiln",
        "bytes",
        "ACMR",
        "positions",
        "normals",
        "UVs",
    ]
    body = [
        [
            row["input"], row["tool"], thousandths(row["seconds"]), ratio(row["times-kiln"]),
            count(row["bytes"]), ratio(row["acmr"]), small(row["position-error"]), small(row["normal-error"]),
            small(row["uv-error"]),
        ]
        if row["failure"] is None
        else [row["input"], row["tool"], "failed", *["-"] * (len(head) - 3)]
        for row in rows
    ]  # fmt: skip
    return markdown(head, body)


def authoring_table(rows: list[dict[str, Any]]) -> str:
    """What a person waits for."""
    head = ["work", "tool", "ms", "times Kiln"]
    body = [
        [row["work"], row["tool"], thousandths(row["seconds"]), ratio(row["times-kiln"])]
        if row["failure"] is None
        else [row["work"], row["tool"], "failed", "-"]
        for row in rows
    ]
    return markdown(head, body)


def gallery_table(rows: list[dict[str, Any]]) -> str:
    """Each spec of the gallery, the slowest first."""
    head = ["gallery, two jobs", "ms", "peak MB", "files", "bytes"]
    body = [
        [row["asset"], thousandths(row["seconds"]), millions(row["peak"]), count(row["files"]), count(row["bytes"])]
        if row["failure"] is None
        else [row["asset"], "failed", *["-"] * (len(head) - 2)]
        for row in rows
    ]
    return markdown(head, body)


def markdown(head: list[str], body: list[list[str]]) -> str:
    """A Markdown table, numbers to the right."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *body))


def thousandths(value: float | None) -> str:
    """Seconds as milliseconds."""
    return "-" if value is None else f"{value * 1e3:.3g}" if value < 0.1 else f"{value * 1e3:.0f}"


def millions(value: float | None) -> str:
    """Bytes as megabytes."""
    return "-" if value is None else f"{value / 1e6:.0f}"


def ratio(value: float | None) -> str:
    """A ratio in three digits."""
    return "-" if value is None else f"{value:.3g}" if value < 100 else f"{value:.0f}"


def count(value: float | None) -> str:
    """A whole number with thin groups."""
    return "-" if value is None else f"{value:,.0f}".replace(",", " ")


def small(value: float | None) -> str:
    """A length in two digits."""
    return "-" if value is None else f"{value:.2g}"


def machine() -> str:
    """The processor, its number of cores, and the system."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()} ({len(names) or 1} cores), {platform.system()}"


def renew(readme: Path, text: str) -> None:
    """Put the tables between the markers."""
    old = readme.read_text(encoding="utf-8")
    begin, end = (old.find(marker) for marker in MARKERS)
    if begin < 0 or end < begin:
        sys.exit(f"bench: {readme} holds no {MARKERS[0]} ... {MARKERS[1]}")
    readme.write_text(old[: begin + len(MARKERS[0])] + f"\n{text}\n" + old[end:], encoding="utf-8")


def tell(message: str) -> None:
    """Progress, for a person who watches."""
    if sys.stderr.isatty():
        print(f"\r\033[Kbench: {message}", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
