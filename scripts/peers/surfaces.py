"""The surface parts of the bench: the teapot, triangles of one face at equal deviation, and evaluation."""

from __future__ import annotations

import json
import math
import statistics
import subprocess
from typing import TYPE_CHECKING, Any

from peers import nets
from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

STEPS = 1000  # along each parameter: a million places
GEOMDL_STEPS = 40
UNIFORM = (48, 96, 160)
OPENCASCADE = (0.5, 1.0, 2.0)
FREE_ANGLE = 1.0


def write(folder: Path) -> None:
    """The documents for Kiln."""
    (folder / "teapot.toml").write_text(kiln_teapot())
    (folder / "face.toml").write_text(kiln_face(f"tolerance = {nets.FACE_TOLERANCE}"))
    for count in UNIFORM:
        (folder / f"face-{count}.toml").write_text(kiln_face(f"segments = [{count}, {count}]"))


def kiln_teapot() -> str:
    """All patches, each with points of its own."""
    grids = nets.teapot()
    points = [point for grid in grids for row in grid for point in row]
    rows = [list(range(16 * k, 16 * k + 16)) for k in range(len(grids))]
    return (
        f"tolerance = {nets.TEAPOT_TOLERANCE}\n\n[shape.teapot.patches]\n"
        f"points = {json.dumps(points)}\npatches = {json.dumps(rows)}\n"
    )


def kiln_face(density: str) -> str:
    """The face within a tolerance or on a grid."""
    return f"[shape.face]\n{density}\n\n[shape.face.b-spline]\ncontrol = {json.dumps(nets.face())}\n"


def checked(case: str, files: list[Path], folder: Path, checker: list[str]) -> dict[str, Any]:
    """What the checker says of each file, and of the surface."""
    out = folder / f"{case}-quality.json"
    subprocess.run([*checker, case, str(out), *map(str, files)], check=True, stdout=subprocess.DEVNULL)
    found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    return found


def teapot(
    kiln: Path,
    peers: list[tuple[str, list[str], str]],
    checker: list[str],
    folder: Path,
    runs: int,
    tell: Callable[[str], None],
) -> dict[str, Any]:
    """Whole processes from script to file, and what they wrote."""
    entries = [Runs("Kiln", [str(kiln), "bake", "teapot.toml", "--out", "pot", "--quiet"], folder / "pot/teapot.glb")]
    for name, line, suffix in peers:
        out = folder / f"teapot-{name.lower()}.{suffix}"
        entries.append(Runs(name, [*line, "teapot", str(out)], out))
    together(entries, runs, folder, tell)
    done = [entry for entry in entries if entry.failure is None]
    found = checked("teapot", [entry.output for entry in done], folder, checker)
    quality = dict(zip((entry.name for entry in done), found["files"], strict=True))
    rows = []
    for entry in entries:
        seconds = entry.median if entry.failure is None else None
        row = {"tool": entry.name, "failure": entry.failure, "seconds": seconds, **quality.get(entry.name, {})}
        row["times-kiln"] = seconds / entries[0].median if seconds and entries[0].failure is None else None
        rows.append(row)
    return {"rows": rows}


def face(
    kiln: Path, opencascade: list[str], checker: list[str], folder: Path, tell: Callable[[str], None]
) -> dict[str, Any]:
    """Triangles of one doubly curved face: Kiln's, and what others need for the deviation that was measured there."""

    def bake(name: str) -> Runs:
        return Runs(
            "Kiln", [str(kiln), "bake", f"{name}.toml", "--out", "face", "--quiet"], folder / f"face/{name}.glb"
        )

    own = bake("face")
    grids = [bake(f"face-{count}") for count in UNIFORM]
    cad = []
    for factor in OPENCASCADE:
        out = folder / f"opencascade-{factor}.stl"
        line = [*opencascade, "face", str(out), str(nets.FACE_TOLERANCE * factor), str(FREE_ANGLE)]
        cad.append(Runs("OpenCascade", line, out))
    entries = [own, *grids, *cad]
    together(entries, 1, folder, tell)
    failed = [entry for entry in entries if entry.failure]
    if failed:
        return {"rows": [{"tool": entry.name, "failure": entry.failure} for entry in failed]}
    found = checked("face", [entry.output for entry in entries], folder, checker)
    kilns, uniform = found["files"][0], found["files"][1 : 1 + len(grids)]
    deviation = kilns["deviation"]
    best = found["optimum"] / (2.0 * deviation)
    rows = [
        {"tool": "Kiln", "triangles": kilns["triangles"]},
        {"tool": "uniform grid", "triangles": at(uniform, deviation)},
        {"tool": "OpenCascade", "triangles": at(found["files"][1 + len(grids) :], deviation)},
        {"tool": "asymptotic optimum", "triangles": best},
    ]
    for row in rows:
        row |= {"failure": None, "deviation": deviation, "kiln-of-it": kilns["triangles"] / row["triangles"]}
    return {"rows": rows, "promised": kilns["triangles"] / (found["optimum"] / (2.0 * nets.FACE_TOLERANCE))}


def at(found: list[dict[str, Any]], deviation: float) -> float:
    """Triangles at a deviation on the line through the two nearest measurements, in logarithms."""
    nearest = sorted(found, key=lambda one: abs(math.log(one["deviation"] / deviation)))[:2]
    (x0, y0), (x1, y1) = ((math.log(one["deviation"]), math.log(one["triangles"])) for one in nearest)
    slope = (y1 - y0) / (x1 - x0) if abs(x1 - x0) > 1e-9 else -1.0
    return math.exp(y0 + slope * (math.log(deviation) - x0))


def evaluation(kiln: Path, python: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Nanoseconds for a point with both derivatives, Kiln and geomdl in turn."""
    times: dict[str, list[float]] = {"kiln": [], "geomdl": []}
    for number in range(runs):
        tell(f"round {number + 1} of {runs}: surface evaluation")
        line = [str(kiln), "sample", "face.toml", "--shape", "face", "--count", str(STEPS - 1), "--time"]
        done = subprocess.run(line, cwd=folder, check=True, capture_output=True, text=True)
        times["kiln"].append(json.loads(done.stdout)["nanoseconds"])
        peer = subprocess.run([*python, str(GEOMDL_STEPS)], cwd=folder, check=True, capture_output=True, text=True)
        times["geomdl"].append(float(peer.stdout))
    own, other = (statistics.median(times[tool]) for tool in ("kiln", "geomdl"))
    return {
        "rows": [
            {"surface": "bicubic B-spline", "failure": None, "kiln": own, "geomdl": other, "times-kiln": other / own}
        ]
    }
