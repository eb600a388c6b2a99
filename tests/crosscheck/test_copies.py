"""Copies of a shape: nodes in some files and places of one node in others, the same for every tool."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from checks import tools
from checks.compare import compare

if TYPE_CHECKING:
    from kiln import Kiln

ORCHARD = Path(__file__).parents[2] / "specs" / "garden" / "orchard.toml"
PROFILES = "core,quantized,web,three,babylon,unity,blender"
INSTANCES = "EXT_mesh_gpu_instancing"
BLENDER = """
import json, sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
shown = [one for one in bpy.data.objects if one.type == "MESH" and one.data.name.startswith(sys.argv[2])]
boxes = []
for one in shown:
    places = [one.matrix_world @ vertex.co for vertex in one.data.vertices]
    boxes.append([bound(place[axis] for place in places) for bound in (min, max) for axis in range(3)])
print("told " + json.dumps(boxes))
"""


def test_every_tool_finds_the_same_places(kiln: Kiln) -> None:
    kiln.bake(ORCHARD.read_text(encoding="utf-8"), "--profile", PROFILES)
    files = sorted((kiln.folder / "out").glob("*.glb"))
    assert len(files) == 7
    measured = tools.measure(files)
    for file in files:
        report = kiln.baked(file.stem).report
        drawn = INSTANCES in report["file"]["used-extensions"]
        assert drawn == (report["profile"] not in ("core", "quantized"))
        assert [f.place for f in compare(file.stem, report, measured[file]) if not f.holds] == [], file.name
        assert report["totals"]["nodes"] == 131


def test_what_is_wrong_of_them_is_found(kiln: Kiln) -> None:
    """The places are looked at, not only counted: one that a report moves is told of, by three.js too."""
    kiln.bake(ORCHARD.read_text(encoding="utf-8"), "--profile", "core,three")
    file = kiln.folder / "out" / "model.three.glb"
    report = kiln.baked(file.stem).report
    one = next(node for node in report["nodes"] if node["name"] == "trees.17")
    one["matrix"][12] += 0.01
    found = {(f.place, f.tool) for f in compare("model", report, tools.measure([file])[file]) if not f.holds}
    assert {tool for place, tool in found if "trees.17" in place} >= {"written", "blender", "three"}


def test_blender_shows_them_from_files_as_they_are_shipped(kiln: Kiln) -> None:
    kiln.bake(ORCHARD.read_text(encoding="utf-8"), "--profile", "core,blender")
    (kiln.folder / "seen.py").write_text(BLENDER)

    def seen(file: str) -> np.ndarray:
        line = [sys.executable, "seen.py", f"out/{file}", "stone"]
        done = subprocess.run(line, cwd=kiln.folder, capture_output=True, text=True, check=True)
        told = next(line for line in done.stdout.splitlines() if line.startswith("told "))
        found = np.array(json.loads(told[5:]))
        angle = np.arctan2(found[:, 0] + found[:, 3], found[:, 1] + found[:, 4])
        return found[np.argsort(angle)]

    core = seen("model.glb")
    assert core.shape == (80, 6)
    assert np.abs(core - seen("model.blender.glb")).max() < 1e-4
    done = kiln.run("optimize", "out/model.blender.glb", "-o", "out/small.glb", "--profile", "quantized")
    assert done.returncode == 0, done.stderr
    assert np.abs(core - seen("small.glb")).max() < 2e-3
