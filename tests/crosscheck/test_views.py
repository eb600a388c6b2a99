"""Cameras, lights and what nodes look at, by the written files and by Blender."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from checks import played

if TYPE_CHECKING:
    from kiln import Baked, Kiln

BALL = '[shape.ball.sphere]\nradius = 0.5\n[node.ball]\nshape = "ball"\n'

BLENDER = """
import json, sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
bpy.context.view_layer.update()
told = {}
for item in bpy.data.objects:
    if item.type in ("CAMERA", "LIGHT"):
        data = item.data
        told[item.name] = {
            "at": list(item.matrix_world.translation),
            "ahead": list(-item.matrix_world.col[2].to_3d().normalized()),
            "type": data.type,
        }
        if item.type == "CAMERA":
            told[item.name] |= {"angle": data.angle_y, "size": data.ortho_scale}
print("told " + json.dumps(told))
"""


def worlds(made: Baked, time: float, *names: str) -> list[np.ndarray]:
    """Matrices of nodes at a time of the first clip."""
    clip = made.document.json["animations"][0]
    found = played.Stage(made.document).pose(clip, {"time": time, "nodes": list(names), "vertices": {}})
    return [np.array(found["nodes"][name]).reshape(4, 4).T for name in names]


def ahead(eye: np.ndarray, goal: np.ndarray, axis: int = -3) -> float:
    """The cosine between an axis of a place (-3 is -z) and the way to another place."""
    way = goal[:3, 3] - eye[:3, 3]
    own = np.sign(axis) * eye[:3, abs(axis) - 1]
    return float(own @ way / np.linalg.norm(way) / np.linalg.norm(own))


@pytest.mark.parametrize("up", ["y", "z"])
def test_cameras_look_at_their_aims(kiln: Kiln, up: str) -> None:
    """Perspective and parallel, above and straight above, in either convention; Blender sees the same."""
    high = {"y": "[0, 9, 0]", "z": "[0, 0, 9]"}[up]
    made = kiln.bake(
        f'up = "{up}"\nunit = "cm"\n[shape.ball.sphere]\nradius = 50\n[node.ball]\nshape = "ball"\nat = [30, 20, 10]\n'
        '[node.eye]\nat = [200, 150, 500]\naim = "ball"\n[node.eye.camera]\nfield-of-view = 30\nnear = 1\nfar = 2000\n'
        f"[node.plan]\nat = {high}\naim = [0, 0, 0]\n[node.plan.camera]\nheight = 400\naspect = 2\n"
        '[node.lamp]\nat = [0, 300, 100]\naim = "ball"\n[node.lamp.light]\nkind = "spot"\ninner = 10\nouter = 20\n'
    )
    document = made.document.json
    eye, plan = document["cameras"]
    assert eye["perspective"]["yfov"] == pytest.approx(np.radians(30))
    assert (eye["perspective"]["znear"], eye["perspective"]["zfar"]) == pytest.approx((0.01, 20))
    assert (plan["orthographic"]["xmag"], plan["orthographic"]["ymag"]) == pytest.approx((4, 2))
    program = kiln.folder / "look.py"
    program.write_text(BLENDER)
    done = subprocess.run(
        [sys.executable, program, next((kiln.folder / "out").glob("*.glb"))], capture_output=True, text=True, check=True
    )
    told = json.loads(next(line for line in done.stdout.splitlines() if line.startswith("told "))[5:])
    # Blender's z is up: (x, -z, y) of the file.
    scale = np.array([0.01] * 3)
    blender = (lambda p: np.array([p[0], -p[2], p[1]])) if up == "y" else np.array
    ball = blender(np.array([30, 20, 10]) * scale)
    for name in ("eye", "lamp"):
        way = ball - told[name]["at"]
        assert np.abs(told[name]["ahead"] - way / np.linalg.norm(way)).max() < 1e-5, name
    assert told["plan"]["ahead"] == pytest.approx([0, 0, -1], abs=1e-6)
    assert (told["eye"]["type"], told["plan"]["type"], told["lamp"]["type"]) == ("PERSP", "ORTHO", "SPOT")


def test_in_clips_nodes_go_on_looking(kiln: Kiln) -> None:
    """The eye is carried by a turning, unevenly scaled node; its goal runs along a spline below another one."""
    made = kiln.bake(
        BALL + "[curve.way.natural-spline]\npoints = [[0, 0, 0], [2, 1, 1], [4, -1, 3]]\n"
        '[node.goal]\nparent = "post"\n[node.post]\nat = [0, 0, -3]\nrotate = [0, 40, 0]\n'
        "[node.table]\nat = [5, 0, 5]\nscale = [1, 2, 3]\n"
        '[node.eye]\nparent = "table"\nat = [1, 1, 0]\naim = "goal"\n[node.eye.camera]\n'
        '[node.head]\nshape = "ball"\nat = [-4, 0, 0]\naim = "goal"\n'
        '[clip.c]\ntolerance = 1e-5\n[[clip.c.track]]\nnode = "goal"\nalong = "way"\n'
        '[[clip.c.track]]\nnode = "table"\npath = "rotation"\naxis = "y"\n'
        "keys = [{ at = 0, value = 0 }, { at = 3, value = 200 }]\n"
    )
    for time in np.linspace(0, 3, 37):
        eye, head, goal = worlds(made, time, "eye", "head", "goal")
        assert ahead(head, goal, 3) > 1 - 2e-7, time
        # The table stretches what it carries, so the axis itself is what arrives: it still points at the goal.
        assert ahead(eye, goal) > 1 - 2e-6, time


def test_what_is_carried_by_what_looks_is_looked_at(kiln: Kiln) -> None:
    """Aims are found in the order in which they depend on each other, whatever the order of the document."""
    made = kiln.bake(
        BALL + '[node.second]\nat = [3, 0, 0]\naim = "tip"\n[node.tip]\nparent = "first"\nat = [0, 0, 2]\n'
        "[node.first]\naim = [0, 5, 1]\n[clip.c]\ntolerance = 1e-5\n"
        '[[clip.c.track]]\nnode = "first"\npath = "translation"\n'
        "keys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [0, 2, -4] }]\n"
    )
    for time in np.linspace(0, 1, 11):
        first, second, tip = worlds(made, time, "first", "second", "tip")
        goal = np.eye(4)
        goal[:3, 3] = [0, 5, 1]
        assert ahead(first, goal, 3) > 1 - 2e-7
        assert ahead(second, tip, 3) > 1 - 2e-7
        assert abs(np.linalg.norm(tip[:3, 3] - first[:3, 3]) - 2) < 1e-5


def test_models_look_with_their_front(kiln: Kiln) -> None:
    """Where z points up in the document the front of a model is its -y, and its top stays up."""
    made = kiln.bake(
        'up = "z"\n' + BALL + "[node.head]\nat = [1, 2, 0]\naim = [4, 6, 0]\n"
        '[[clip.c.track]]\nnode = "ball"\npath = "translation"\n'
        "keys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [0, 0, 1] }]\n"
    )
    (head,) = worlds(made, 0.0, "head")
    # The document's (x, y, z) is (x, z, -y) of the file, so its -y is the file's z.
    assert head[:3, 2] == pytest.approx([0.6, 0, -0.8], abs=1e-6)
    assert head[:3, 1] == pytest.approx([0, 1, 0], abs=1e-6)


def test_lights_are_those_of_the_extension(kiln: Kiln) -> None:
    made = kiln.bake(
        BALL + '[node.a.light]\ncolor = [1, 0.5, 0.25]\nintensity = 40\nrange = 3\n[node.b.light]\nkind = "sun"\n'
        '[node.c.light]\nkind = "spot"\ninner = 5\nouter = 25\n'
    )
    document = made.document.json
    assert document["extensionsUsed"] == ["KHR_lights_punctual"]
    lamp, sun, spot = document["extensions"]["KHR_lights_punctual"]["lights"]
    assert lamp == {"name": "a", "type": "point", "color": [1, 0.5, 0.25], "intensity": 40, "range": 3}
    assert (sun["type"], sun["intensity"]) == ("directional", 1)
    assert np.degrees([spot["spot"]["innerConeAngle"], spot["spot"]["outerConeAngle"]]) == pytest.approx([5, 25])


def test_the_lighthouse_is_never_lost(kiln: Kiln) -> None:
    """The gallery's camera keeps its eye on the lantern all the way round."""
    specs = Path(__file__).resolve().parents[2] / "specs"
    made = kiln.bake((specs / "motion" / "lighthouse.toml").read_text())
    for time in np.linspace(0, 24, 97):
        plane, lantern = worlds(made, time, "plane", "lantern")
        assert ahead(plane, lantern) > 1 - 1e-6, time
        assert abs(plane[1, 0]) < 1e-3, "level"
