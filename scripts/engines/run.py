#!/usr/bin/env python3
"""Loads baked files in the engines that users have, and compares what they show with Blender and with the reports.

    scripts/engines/run.py out              files of the profiles core, web, quantized, three and babylon under out/ in
                                            three.js and Babylon.js: no complaints, and the silhouettes of Blender
    scripts/engines/run.py --bevy out       also files of core and bevy in a Bevy application without a window: its
                                            meshes, nodes, joints, targets, clips and levels are those of the report
    scripts/engines/run.py --all specs      bakes every document in every profile, does both, and verifies all files

Each file is compared with Blender's picture of the `core` file of its model; where a profile makes it stand otherwise,
of itself. Exit code 0: all agree; 1: something does not, each with a line that says what; 2: usage. Needs
scripts/setup; --bevy builds its application with cargo.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.ndimage import binary_dilation

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

from checks.document import Document  # noqa: E402 -- it stands beside this folder
from checks.tools import PYTHON  # noqa: E402

if TYPE_CHECKING:
    from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
SIZE = 360
VIEW = (30.0, 25.0)
ENGINES = ("three", "babylon")
IN_BROWSERS = ("core", "quantized", "web", "three", "babylon")
IN_BEVY = ("core", "bevy")
PROFILES = ("core", "quantized", "web", "verify", "bevy", "godot", "unreal", "unity", "three", "babylon", "blender")
# Of a picture by Blender a pixel is covered where this much of it is.
COVERED = 0.05
# Pixels beyond Blender's silhouette, grown by one, and the part of its own that a browser may miss, grown by two: a
# pixel counts for Blender where anything is in it, and for a browser where one of a few points is.
BEYOND = 4
MISSING = 0.004
# What Chromium says of itself: that reading a picture back takes time is no fault of the file.
OF_THE_BROWSER = ("ReadPixels", "GPU stall")
# Babylon.js 9.28 plays no changes of roughness, which the profile for it warns of.
OF_BABYLON = re.compile(r"Invalid pointer \(/materials/\d+/pbrMetallicRoughness/roughnessFactor\)")
# Bevy's reader refuses files in which clips change what is no node; its own profile leaves such changes out.
PROPERTIES = "KHR_animation_pointer"
SECONDS = 1e-5  # single precision
MOVED = 1e-3  # of the size of a model: it stands otherwise


@dataclass
class File:
    """A written file with its report."""

    path: Path
    report: dict[str, Any]
    document: Document = field(init=False)

    def __post_init__(self) -> None:
        self.document = Document(self.path)

    @property
    def model(self) -> tuple[Path, str, str | None]:
        """What it is a file of."""
        return (self.path.parent, self.report["asset"], self.report.get("variant"))

    @property
    def profile(self) -> str:
        """For whom it is."""
        return self.report["profile"]

    @property
    def hidden(self) -> list[str]:
        """Meshes that are not drawn beside the others: coarser levels, and those of no shape, which are bodies."""
        coarser = {level["mesh"] for chain in self.report.get("lods", {}).values() for level in chain[1:]}
        shown = {mesh for name, own in self.report["shapes"].items() for mesh in own.get("meshes", [name])}
        meshes = {mesh.get("name", "") for mesh in self.document.json.get("meshes", [])}
        return sorted((meshes - shown) | coarser)

    @property
    def vertices(self) -> int:
        """Vertices of all primitives; who draws them one by one has those that two share twice."""
        meshes, accessors = (self.document.json.get(kind, []) for kind in ("meshes", "accessors"))
        positions = (one["attributes"]["POSITION"] for mesh in meshes for one in mesh["primitives"])
        return sum(accessors[position]["count"] for position in positions)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Where it stands."""
        own = self.report["totals"]["bounds"]
        return np.array([own["min"], own["max"]])

    def stands_as(self, other: File) -> bool:
        """Whether both stand in one place."""
        size = np.ptp(other.bounds, axis=0).max()
        return bool(np.abs(self.bounds - other.bounds).max() <= MOVED * size)


def main() -> int:
    """Check what the command line names; returns the exit code."""
    options = arguments()
    with tempfile.TemporaryDirectory(prefix="kiln-engines-") as name:
        folder = Path(name)
        failures = []
        out = options.paths
        if options.all:
            out = [folder / "baked"]
            failures += baked_and_verified(options, out[0])
        files = find(out)
        if not files:
            print("engines: no .glb file with a report", file=sys.stderr)
            return 2
        failures += browsers(files, folder)
        if options.bevy or options.all:
            failures += bevy([file for file in files if file.profile in IN_BEVY])
    for failure in failures:
        print(f"error: {failure}")
    return 1 if failures else 0


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="scripts/engines/run.py", description=__doc__.split("\n\n")[0])
    parser.add_argument(
        "paths", nargs="+", type=Path, metavar="PATH", help="folders of baked files; with --all documents"
    )
    parser.add_argument("--bevy", action="store_true", help="also load files in Bevy")
    parser.add_argument("--all", action="store_true", help="bake documents in every profile, and do everything")
    kiln = os.environ.get("KILN_BIN") or str(ROOT / "target" / "release" / "kiln")
    parser.add_argument(
        "--kiln", default=kiln, metavar="PROGRAM", help="kiln itself [default: KILN_BIN, else its release build]"
    )
    options = parser.parse_args()
    for path in options.paths:
        if not path.exists():
            parser.error(f"{path} does not exist")
    return options


def baked_and_verified(options: argparse.Namespace, out: Path) -> list[str]:
    """Every document in every profile, judged by all tools."""
    line = [options.kiln, "bake", *map(str, options.paths), "--root", str(ROOT), "--out", str(out), "--quiet"]
    if subprocess.run([*line, "--profile", ",".join(PROFILES)], check=False).returncode:
        return ["not every document was baked in every profile"]
    verified = subprocess.run(
        [str(PYTHON), str(ROOT / "scripts" / "verify.py"), str(out)], capture_output=True, text=True, check=False
    )
    told = verified.stdout.splitlines()
    print(told[-1] if told else verified.stderr)
    return [line.removeprefix("error: ") for line in told if line.startswith("error: ")]


def find(paths: list[Path]) -> list[File]:
    """The files under folders that have a report."""
    found = []
    for path in sorted({file for folder in paths for file in folder.resolve().rglob("*.glb")}):
        report = path.with_name(f"{path.stem}.report.json")
        if report.exists():
            found.append(File(path, json.loads(report.read_text(encoding="utf-8"))))
    return found


def browsers(files: list[File], folder: Path) -> list[str]:
    """What browsers show beside what Blender shows."""
    standards, asked = {}, []
    whole = {file.model: file for file in files if file.profile == "core"}
    for file in files:
        if file.profile not in IN_BROWSERS or not file.report["totals"]["drawn-triangles"]:
            continue
        core = whole.get(file.model)
        standard = core if core is not None and file.stands_as(core) else file
        # What Blender cannot read is unpacked for it where nothing else stands as it does.
        standards[standard.path] = standard
        asked.append((file, standard.path))
    cameras, wanted = silhouettes(list(standards.values()), folder)
    line = {
        "size": SIZE,
        "engines": ENGINES,
        "files": [
            {"path": str(file.path), "camera": cameras[standard], "hidden": file.hidden} for file, standard in asked
        ],
    }
    (folder / "asked.json").write_text(json.dumps(line), encoding="utf-8")
    done = subprocess.run(
        ["node", str(HERE / "browser.mjs"), str(folder / "asked.json")], stdout=subprocess.PIPE, check=True
    )
    found = json.loads(done.stdout)
    failures = []
    for engine in ENGINES:
        own = found[engine]
        told = [text for text in own["complaints"] if not any(part in text for part in OF_THE_BROWSER)]
        told = [text for text in told if not (engine == "babylon" and OF_BABYLON.search(text))]
        failures += [f"{engine}: {text}" for text in told]
        for (file, standard), covered, error in zip(asked, own["covered"], own["errors"], strict=True):
            place = f"{file.path.name}: {engine}"
            if error is not None:
                failures.append(f"{place}: {error}")
                continue
            failures += [f"{place} {what}" for what in differences(bits(covered), wanted[standard])]
    print(f"engines: {len(asked)} files in {' and '.join(ENGINES)}, {len(standards)} silhouettes by Blender")
    return failures


def silhouettes(files: list[File], folder: Path) -> tuple[dict[Path, Any], dict[Path, NDArray[np.bool_]]]:
    """The camera of each file and what Blender covers through it."""
    from checks.tools import unpacked

    plain = unpacked([file.path for file in files], folder)
    jobs = [
        {"path": str(plain.get(file.path, file.path)), "hidden": file.hidden, "out": str(folder / f"{number}.npy")}
        for number, file in enumerate(files)
    ]
    asked, found = folder / "blender.json", folder / "cameras.json"
    asked.write_text(json.dumps({"size": SIZE, "view": VIEW, "files": jobs}), encoding="utf-8")
    line = [str(PYTHON), str(HERE / "blender_silhouettes.py"), str(asked), str(found)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "scripts")}
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
    cameras = json.loads(found.read_text(encoding="utf-8"))
    by_file = dict(zip([file.path for file in files], cameras, strict=True))
    wanted = {file.path: np.load(job["out"]) > COVERED for file, job in zip(files, jobs, strict=True)}
    return by_file, wanted


def bits(packed: str) -> NDArray[np.bool_]:
    """The covered pixels of a picture."""
    flags = np.unpackbits(np.frombuffer(base64.b64decode(packed), np.uint8), count=SIZE * SIZE)
    return flags.reshape(SIZE, SIZE).astype(bool)


def differences(covered: NDArray[np.bool_], wanted: NDArray[np.bool_]) -> list[str]:
    """How what an engine covers differs from what Blender covers."""

    def grown(picture: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
        return binary_dilation(picture, np.ones((3, 3), bool), iterations=pixels)

    if not wanted.any():
        return ["has nothing to be compared with: Blender shows nothing"]
    found = []
    beyond = int((covered & ~grown(wanted, 1)).sum())
    missing = int((wanted & ~grown(covered, 2)).sum())
    if beyond > BEYOND:
        found.append(f"covers {beyond} pixels beyond Blender's silhouette of {wanted.sum()}")
    if missing > MISSING * wanted.sum():
        found.append(f"misses {missing} pixels of Blender's silhouette of {wanted.sum()}")
    return found


def bevy(files: list[File]) -> list[str]:
    """What Bevy counts beside what the reports and files say."""
    manifest, target = HERE / "bevy" / "Cargo.toml", ROOT / "target" / "bevy"
    line = ["cargo", "run", "--quiet", "--locked", "--ignore-rust-version", "--manifest-path", str(manifest)]
    line += ["--target-dir", str(target), "--"]
    done = subprocess.run([*line, *(str(file.path) for file in files)], stdout=subprocess.PIPE, text=True, check=True)
    failures = []
    told = [json.loads(row) for row in done.stdout.splitlines()]
    for file, found in zip(files, told, strict=True):
        if "error" in found:
            if not (PROPERTIES in file.report["file"]["used-extensions"] and file.profile != "bevy"):
                failures.append(f"{file.path.name}: Bevy: {found['error']}")
            continue
        claims = expected(file)
        for name, seconds in found["clips"].items():
            if abs(seconds - claims["clips"].get(name, seconds)) <= SECONDS:
                found["clips"][name] = claims["clips"].get(name)
        for what, claimed in claims.items():
            if found[what] != claimed:
                failures.append(f"{file.path.name}: Bevy finds {what} {found[what]}, the report says {claimed}")
    print(f"engines: {len(files)} files in Bevy")
    return failures


def expected(file: File) -> dict[str, Any]:
    """What the report says of what Bevy counts. Levels of detail are meshes of their own there."""
    report = file.report
    totals, shapes = report["totals"], report["shapes"]
    shown = [mesh for name, own in shapes.items() for mesh in own.get("meshes", [name])]
    states = [own["morphs"] for own in shapes.values() for _ in own.get("meshes", [0]) if own.get("morphs")]
    return {
        **{what: totals[what] for what in ("primitives", "triangles", "materials")},
        "vertices": file.vertices,
        "meshes": sorted(shown),
        "nodes": sorted(node["name"] for node in report["nodes"]),
        "skins": sorted(len(skin["joints"]) for skin in report.get("skins", {}).values()),
        "clips": {name: clip["duration"] for name, clip in report.get("clips", {}).items()},
        "targets": sorted(map(len, states)),
    }


if __name__ == "__main__":
    sys.exit(main())
