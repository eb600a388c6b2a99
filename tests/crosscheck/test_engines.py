"""Profiles of engines: each file by all tools, and against rules of loaders that are written down here anew."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from checks.document import Document

if TYPE_CHECKING:
    from kiln import Kiln

# What loaders read, and so what files for them may require.
READ = {
    "bevy": set(),
    "godot": set(),
    "unreal": set(),
    "unity": {"KHR_mesh_quantization"},
    "three": {"KHR_mesh_quantization"},
    "babylon": {"KHR_mesh_quantization"},
    "blender": set(),
}
# Godot 4: these ends of names, after `-`, `_` or `$`, in any case; digits at the end do not count.
GODOT = re.compile(r"[-_$](noimp|(conv)?col(only)?|navmesh|vehicle|wheel|rigid|occ(only)?|vcol|alpha)[\d.\s]*$", re.I)
VERIFY = Path(__file__).parents[2] / "scripts" / "verify.py"
LAMP = """
tolerance = 0.002
[lod]
levels = 3
[shape.shade]
material = "paper"
vertex-color = { colors = ["#402010", "#ffe0a0"], by = "= y" }
[shape.shade.revolve]
profile = { bezier = { points = [[0.3, 0], [0.4, 0.3], [0.2, 0.6], [0.1, 0.8]] } }
caps = false
[shape.arm]
vertex-color = "#806040"
[shape.arm.capsule]
radius = 0.08
height = 1.2
[skeleton.s.joint.low]
head = [0, -0.5, 0]
tail = [0, 0, 0]
[skeleton.s.joint.high]
parent = "low"
tail = [0, 0.5, 0]
[skin.k]
shape = "arm"
skeleton = "s"
weights = "rigid"
[[clip.nod.track]]
joint = "high"
path = "rotation"
keys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [30, 0, 0] }]
[node.lamp]
shape = "shade"
at = [2, 0, 0]
[node.arm]
shape = "arm"
[material.paper]
roughness = 0.9
double-sided = true
"""
BODY = """
[collider.body]
shape = "shade"
node = "lamp"
"""
PROFILES = ("--profile", ",".join(["core", *READ]))


def test_files_hold_to_the_rules_of_loaders(kiln: Kiln) -> None:
    kiln.bake(LAMP + BODY, *PROFILES)
    for name, allowed in READ.items():
        own = sorted((kiln.folder / "out").glob(f"*.{name}.glb"))
        assert own, name
        for file in own:
            document = Document(file).json
            assert set(document.get("extensionsRequired", [])) <= allowed, file.name
            names = [one.get("name", "") for kind in ("nodes", "materials") for one in document.get(kind, [])]
            acted = {one for one in names if GODOT.search(one)}
            assert acted == ({"body-convcolonly"} if name == "godot" else set()), file.name


def test_every_tool_takes_the_files_of_every_engine(kiln: Kiln) -> None:
    kiln.bake(LAMP + BODY, *PROFILES)
    done = subprocess.run(
        [sys.executable, str(VERIFY), str(kiln.folder / "out")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
