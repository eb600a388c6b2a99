"""Doom 3 models held against their texts, read and played here, and against assimp."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import assimp
import numpy as np

from checks import played

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"
SCALE = 0.01


def matrix(numbers: list[float]) -> NDArray[np.float64]:
    """A place and three parts of a quaternion whose fourth is not positive."""
    x, y, z = numbers[3:6]
    w = -np.sqrt(max(0.0, 1 - x * x - y * y - z * z))
    found = np.eye(4)
    found[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    found[:3, 3] = numbers[:3]
    return found


def numbers(line: str) -> list[float]:
    """All numbers of a line that stand alone."""
    plain = re.sub(r'"[^"]*"|//.*', " ", line)
    return [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", plain)]


def section(text: str, name: str) -> list[list[float]]:
    """The numbers of each line between braces."""
    body = re.search(rf"^{name} {{\n(.*?)^}}", text, re.MULTILINE | re.DOTALL)
    assert body, name
    return [numbers(line) for line in body[1].splitlines() if numbers(line)]


class Model:
    """Joints and vertices of a mesh, and the frames of a motion."""

    def __init__(self, mesh: str, motion: str) -> None:
        joints = section(mesh, "joints")
        self.parents = [int(row[0]) for row in joints]
        self.rest = [matrix(row[1:]) for row in joints]
        self.vertices: list[list[list[float]]] = []
        for body in re.findall(r"^mesh {\n(.*?)^}", mesh, re.MULTILINE | re.DOTALL):
            rows = [numbers(line) for line in body.splitlines()]
            weights = [row for row in rows if len(row) == 6]
            for row in (row for row in rows if len(row) == 5):
                first, count = int(row[3]), int(row[4])
                self.vertices.append([weight[1:] for weight in weights[first : first + count]])
        hierarchy, base = section(motion, "hierarchy"), section(motion, "baseframe")
        self.frames = []
        for body in re.findall(r"^frame \d+ {\n(.*?)^}", motion, re.MULTILINE | re.DOTALL):
            moved, worlds = numbers(body), []
            for (parent, flags, start), still in zip(hierarchy, base, strict=True):
                own, at = list(still), int(start)
                for bit in range(6):
                    if int(flags) >> bit & 1:
                        own[bit], at = moved[at], at + 1
                carrier = worlds[int(parent)] if parent >= 0 else np.eye(4)
                worlds.append(carrier @ matrix(own))
            self.frames.append(worlds)

    def places(self, joints: list[NDArray[np.float64]]) -> NDArray[np.float64]:
        """The vertices where joints carry them, in meters with y up."""
        found = [
            sum(share * (joints[int(joint)] @ np.array([*place, 1.0]))[:3] for joint, share, *place in own)
            for own in self.vertices
        ]
        return np.array(found)[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0]) * SCALE


def lamp(kiln: Kiln) -> tuple[Baked, Model]:
    """The gallery's own model."""
    for name in ("lamp.md5mesh", "lamp-bow.md5anim"):
        shutil.copy(INPUTS / name, kiln.folder / name)
    spec = (
        f'[shape.m.import]\nfile = "lamp.md5mesh"\nscale = {SCALE}\n'
        f'[skeleton.s.import]\nfile = "lamp.md5mesh"\nscale = {SCALE}\n'
        '[skin.m]\nshape = "m"\nskeleton = "s"\nweights = "imported"\n'
        '[clip.bow]\nloop = true\n[clip.bow.import]\nfile = "lamp-bow.md5anim"\n'
    )
    made = kiln.bake(spec, name="lamp")
    return made, Model(*((INPUTS / name).read_text(encoding="utf-8") for name in ("lamp.md5mesh", "lamp-bow.md5anim")))


def test_every_frame_is_as_in_the_files(kiln: Kiln) -> None:
    """Each vertex is where the file's own joints and weights bring it, at every frame."""
    made, model = lamp(kiln)
    stage = played.Stage(made.document)
    clip = made.document.json["animations"][0]
    attributes = made.document.meshes[0].surfaces[0].attributes
    count = len(attributes["POSITION"])
    rest = model.places(model.rest)
    own = [int(np.linalg.norm(rest - place, axis=1).argmin()) for place in attributes["POSITION"].astype(float)]
    assert np.abs(rest[own] - attributes["POSITION"]).max() < 1e-6
    size = np.ptp(rest, axis=0).max()
    for frame, joints in enumerate(model.frames):
        time = min(frame / 24, 2.0) + 1e-9
        question = {"time": time, "nodes": [], "vertices": {"m": [{"vertex": v} for v in range(count)]}}
        found = np.array(stage.pose(clip, question)["vertices"]["m"])
        # A 255th of a weight, and the tolerance of motions.
        assert np.abs(found - model.places(joints)[own]).max() < 3e-3 * size, frame
    moved = np.ptp([model.places(joints) for joints in model.frames], axis=0).max()
    assert moved > 0.3 * size, "the lamp bows"


def test_weights_are_those_of_the_file(kiln: Kiln) -> None:
    """By the names of the joints, to a 255th."""
    made, model = lamp(kiln)
    document = made.document
    attributes = document.meshes[0].surfaces[0].attributes
    names = [document.json["nodes"][joint]["name"] for joint in document.json["skins"][0]["joints"]]
    order = [names.index(name) for name in ("base", "lower", "upper", "head")]
    rest = model.places(model.rest)
    for place, joints, weights in zip(
        attributes["POSITION"].astype(float), attributes["JOINTS_0"], attributes["WEIGHTS_0"], strict=True
    ):
        told = model.vertices[int(np.linalg.norm(rest - place, axis=1).argmin())]
        wanted = {order[int(joint)]: share for joint, share, *_ in told}
        found = {int(j): int(w) / 255 for j, w in zip(joints, weights, strict=True) if w}
        assert found.keys() == wanted.keys()
        assert all(abs(found[joint] - wanted[joint]) < 1 / 255 for joint in found)


def test_assimp_reads_the_same_mesh(kiln: Kiln) -> None:
    """As many triangles of the same area and volume about the same middle."""
    made, _ = lamp(kiln)
    other = assimp.triangles(kiln.folder / "lamp.md5mesh")
    facts = made.shape("m")
    assert facts["triangles"] == len(other)
    edges = other[:, 1:] - other[:, :1]
    crossed = np.cross(edges[:, 0], edges[:, 1])
    area = np.linalg.norm(crossed, axis=1).sum() / 2 * SCALE**2
    volume = np.einsum("ij,ij->i", other[:, 0], np.cross(other[:, 1], other[:, 2])).sum() / 6 * SCALE**3
    assert abs(facts["area"] / area - 1) < 1e-4
    assert abs(facts["volume"] / volume - 1) < 1e-4
