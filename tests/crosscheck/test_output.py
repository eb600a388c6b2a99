"""Where models stand in files, by the written bytes, against the same model as it is."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from checks import played
from checks.document import Document

if TYPE_CHECKING:
    from kiln import Baked, Kiln

VERIFY = Path(__file__).parents[2] / "scripts" / "verify.py"

FIGURE = """
tolerance = 0.002
[shape.arm.capsule]
radius = 0.08
height = 1.2
[shape.hat.cone]
radius = 0.3
height = 0.4
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
[[clip.nod.track]]
node = "hat"
path = "translation"
keys = [{ at = 0, value = [1, 0, 0] }, { at = 1, value = [1, 0, 2] }]
[node.arm]
shape = "arm"
[node.hat]
shape = "hat"
at = [1, 0, 0]
[collider.arm]
shape = "arm"
"""

PLACED = '[output]\nforward = "-x"\npivot = [0.5, -0.7, 0.25]\nscale = 100\n'
# Front +z to -x is a quarter turn about y the other way: x goes to z, z to -x.
TURN = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def place(points: np.ndarray) -> np.ndarray:
    """Where points of the model are in the file."""
    return 100.0 * (points - np.array([0.5, -0.7, 0.25])) @ TURN.T


def posed(made: Baked, time: float) -> dict[str, np.ndarray]:
    """Some vertices of what joints carry, and the place of the hat, at a time."""
    vertices = {"arm": [{"vertex": vertex} for vertex in range(0, 40, 7)]}
    found = played.Stage(made.document).pose(
        made.document.json["animations"][0], {"time": time, "nodes": ["hat"], "vertices": vertices}
    )
    hat = np.array(found["nodes"]["hat"]).reshape(4, 4).T[:3, 3]
    return {"hat": hat[None, :], "arm": np.array(found["vertices"]["arm"])}


@pytest.mark.parametrize("profile", ["core", "quantized"])
def test_all_of_a_model_stands_where_it_is_put(kiln: Kiln, profile: str) -> None:
    """Nodes that move and vertices that joints carry, at several times, against the same model as it is."""
    file = "model" if profile == "core" else f"model.{profile}"
    times = (0.0, 0.4, 1.0)
    plain = bake(kiln, FIGURE, profile, file)
    before = [posed(plain, time) for time in times]
    made = bake(kiln, FIGURE + PLACED, profile, file)
    for own, time in zip(before, times, strict=True):
        for name, points in posed(made, time).items():
            assert np.abs(points - place(own[name])).max() < 2e-4, name
    bounds, found = (one.report["totals"]["bounds"] for one in (plain, made))
    corners = place(np.array([bounds["min"], bounds["max"]]))
    assert np.abs(np.array([found["min"], found["max"]]) - [corners.min(axis=0), corners.max(axis=0)]).max() < 2e-4
    around, told = (one.document.json["animations"][0]["extras"]["bounds"] for one in (plain, made))
    corners = place(np.array([around["min"], around["max"]]))
    assert np.abs(np.array([told["min"], told["max"]]) - [corners.min(axis=0), corners.max(axis=0)]).max() < 1e-2
    done = subprocess.run(
        [sys.executable, str(VERIFY), str(made.path)], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def bake(kiln: Kiln, spec: str, profile: str, file: str) -> Baked:
    """Bake for a profile."""
    kiln.write(spec, "model")
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", profile)
    assert done.returncode == 0, done.stdout + done.stderr
    return kiln.baked(file)


def test_a_pivot_at_the_base_is_one_for_all_levels(kiln: Kiln) -> None:
    """Levels in files of their own do not jump where one takes the other's place."""
    spec = '[output]\npivot = "base"\n[lod]\nlevels = 3\nform = "files"\n[shape.a.sphere]\nradius = 1\n'
    kiln.write(spec + '[node.a]\nshape = "a"\nat = [5, 0, 0]\n', "model")
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 0, done.stdout + done.stderr
    files = sorted((kiln.folder / "out").glob("*.glb"))
    assert len(files) == 3
    moves = {tuple(Document(file).worlds["a"][:3, 3].round(6)) for file in files}
    assert len(moves) == 1
    finest = Document(kiln.folder / "out" / "model.glb")
    (index, world), *_ = finest.instances
    places = finest.meshes[index].places @ world[:3, :3].T + world[:3, 3]
    assert abs(places[:, 1].min()) < 1e-6
    assert np.abs((places.min(axis=0) + places.max(axis=0))[[0, 2]]).max() < 1e-6
