"""Quake III models held against their bytes, unpacked here field by field, and against assimp."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import assimp
import numpy as np

from checks import played

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"
STEP = 1 / 64


class Model:
    """Surfaces with points of every frame, normals and texture coordinates; tags as matrices. Z up as in the file."""

    def __init__(self, data: bytes) -> None:
        self.frames, tags, surfaces, _, _, at_tags, at_surface, _ = struct.unpack_from("<8i", data, 76)
        self.tags: dict[str, list[NDArray[np.float64]]] = {}
        for row in range(self.frames * tags):
            start = at_tags + 112 * row
            name = data[start : start + 64].split(b"\0")[0].decode()
            numbers = np.frombuffer(data, "<f4", 12, start + 64).astype(float)
            matrix = np.eye(4)
            matrix[:3, 3], matrix[:3, :3] = numbers[:3], numbers[3:].reshape(3, 3).T
            self.tags.setdefault(name, []).append(matrix)
        self.surfaces = {}
        for _ in range(surfaces):
            name = data[at_surface + 4 : at_surface + 68].split(b"\0")[0].decode()
            points, triangles = struct.unpack_from("<2i", data, at_surface + 80)
            starts = struct.unpack_from("<5i", data, at_surface + 88)
            corners = np.frombuffer(data, "<i4", 3 * triangles, at_surface + starts[0]).reshape(-1, 3)
            places = np.frombuffer(data, "<f4", 2 * points, at_surface + starts[2]).reshape(-1, 2)
            rows = np.frombuffer(data, "<i2", 4 * points * self.frames, at_surface + starts[3])
            rows = rows.reshape(self.frames, points, 4)
            angles = rows[:, :, 3].copy().view("u1").reshape(self.frames, points, 2) * (2 * np.pi / 256)
            from_z, about_z = angles[..., 0], angles[..., 1]
            sine = np.sin(from_z)
            normals = np.stack([np.cos(about_z) * sine, np.sin(about_z) * sine, np.cos(from_z)], axis=-1)
            self.surfaces[name] = (corners, places, rows[:, :, :3] * STEP, normals)
            at_surface += starts[4]

    def corners(self, frame: int) -> NDArray[np.float64]:
        """For each corner of each triangle its place and its normal, y up, and its place on the picture."""
        rows = []
        for corners, places, points, normals in self.surfaces.values():
            own = corners.ravel()
            rows.append(np.hstack([up(points[frame][own]), up(normals[frame][own]), places[own]]))
        return np.concatenate(rows)


def up(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """From z up to y up."""
    return points[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0])


def beetle(kiln: Kiln, extra: str = "") -> tuple[Baked, Model]:
    """The gallery's own model."""
    source = INPUTS / "beetle.md3"
    shutil.copy(source, kiln.folder / source.name)
    spec = f'[shape.m]\nuv = "always"\n[shape.m.import]\nfile = "beetle.md3"\nscale = 0.01\n{extra}'
    return kiln.bake(spec, name="beetle"), Model(source.read_bytes())


def rounded(rows: NDArray[np.float64]) -> set[tuple[int, ...]]:
    """Rows that differ by more than the normals' rounding to bytes in the file."""
    return {tuple(row) for row in np.round(rows * 300).astype(int).tolist()}


def test_every_frame_is_as_in_the_file(kiln: Kiln) -> None:
    """Points, normals and places on the picture of every corner; surfaces are materials."""
    made, model = beetle(kiln)
    mesh = made.document.meshes[0]
    attributes = mesh.surfaces[0].attributes
    assert len(mesh.targets) == model.frames - 1
    assert made.shape("m")["closed"]
    for frame in range(model.frames):
        points, normals = attributes["POSITION"].astype(float), attributes["NORMAL"].astype(float)
        if frame:
            moved = mesh.targets[frame - 1].attributes
            points, normals = points + moved["POSITION"], normals + moved["NORMAL"]
        wanted = model.corners(frame)
        found = np.hstack([points * 100, normals, attributes["TEXCOORD_0"].astype(float)])
        for row in found[::5]:
            # Where a vertex has two normals in the file that were one in the first frame, either will do.
            apart = np.abs(wanted - row)
            near = apart[(apart[:, :3].max(axis=1) < 1e-3) & (apart[:, 6:].max(axis=1) < 1e-4)]
            assert len(near), row
            assert near[:, 3:6].max(axis=1).min() < 2e-3, row


def test_one_surface_can_be_had_alone(kiln: Kiln) -> None:
    """By its name; the tags stay."""
    made, model = beetle(kiln, 'group = "legs"\n')
    assert made.shape("m")["triangles"] == len(model.surfaces["legs"][0])
    assert any(node.get("name") == "tag-load" for node in made.document.json["nodes"])


def test_tags_move_as_in_the_file(kiln: Kiln) -> None:
    """Their matrices at the times of the frames, in the axes of the file."""
    made, model = beetle(kiln, 'loop = ["walk"]\n')
    stage = played.Stage(made.document)
    clip = next(one for one in made.document.json["animations"] if one["name"] == "walk")
    axes = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], float)
    for frame, matrix in enumerate(model.tags["tag_load"]):
        pose = stage.pose(clip, {"time": frame / 10 + 1e-9, "nodes": ["tag-load"], "vertices": {}})
        found = np.array(pose["nodes"]["tag-load"]).reshape(4, 4).T
        wanted = axes @ matrix @ axes.T
        wanted[:3, 3] /= 100
        assert np.abs(found[:3, :3] - wanted[:3, :3]).max() < 2e-3, frame
        assert np.abs(found[:3, 3] - wanted[:3, 3]).max() < 1e-4, frame
    extras = next(node for node in made.document.json["nodes"] if node.get("name") == "tag-load")["extras"]
    assert extras.get("socket")


def test_assimp_reads_the_same_triangles(kiln: Kiln) -> None:
    """The first frame, each triangle with its sense; assimp turns z up to y up."""
    made, _ = beetle(kiln, 'frames = "one"\n')
    other = assimp.triangles(kiln.folder / "beetle.md3")
    points, triangles = made.mesh("m")
    own = points[triangles] * 100

    def keyed(corners: NDArray[np.float64]) -> set[tuple[tuple[int, ...], ...]]:
        keys = np.round(corners * 64).astype(int).tolist()
        rings = [[tuple(corner) for corner in triangle] for triangle in keys]
        return {tuple(ring[(k + ring.index(min(ring))) % 3] for k in range(3)) for ring in rings}

    assert keyed(own) == keyed(other)
