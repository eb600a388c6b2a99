"""glTF files of other makers as shapes, held against what trimesh and numpy make of them."""

from __future__ import annotations

import json
import re
import shutil
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from checks import played
from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from kiln import Kiln

STILL = ["BoxInterleaved.glb", "BoxTexcoords/boxTexcoords.gltf", "boolean.glb", "cubevc.glb", "monkey.glb"]
SKINNED = ["CesiumMan.glb", "Fox.glb", "RiggedSimple.glb", "SimpleSkin.gltf"]
SINGLE = 2.0**-22
"""The share of a model's size that rounding to single precision may come to, twice."""


def bring(cases: Path, name: str, kiln: Kiln) -> str:
    """Copy a file with what stands beside it; returns its name."""
    source = cases / "gltf" / name
    for other in [source, *source.parent.glob("*.bin")]:
        shutil.copyfile(other, kiln.folder / other.name)
    return source.name


def measures(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> tuple[float, float]:
    """Area and volume."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    middle = points.mean(0)
    return float(np.linalg.norm(across, axis=1).sum() / 2), float(np.einsum("ij,ij->", across, a - middle) / 6)


@pytest.mark.cases
@pytest.mark.parametrize("name", STILL)
def test_still_files_are_those_of_trimesh(kiln: Kiln, cases: Path, name: str) -> None:
    """Box, area, triangles and, where it is closed, volume, with the places of nodes."""
    file = bring(cases, name, kiln)
    wanted = trimesh.load(kiln.folder / file, process=False).to_geometry()
    baked = kiln.bake(f'[shape.s.import]\nfile = "{file}"\n')
    points, triangles = baked.mesh("s")
    size = float(np.ptp(wanted.bounds, axis=0).max())
    assert np.abs(np.stack([points.min(0), points.max(0)]) - wanted.bounds).max() < SINGLE * size
    area, volume = measures(points, triangles)
    assert area == pytest.approx(wanted.area, rel=1e-5)
    assert len(triangles) == len(wanted.triangles[wanted.area_faces > 0])
    wanted.merge_vertices(merge_tex=True, merge_norm=True)
    if wanted.is_watertight:
        assert baked.shape("s")["closed"]
        assert volume == pytest.approx(wanted.volume, rel=1e-5)


class CubicHermiteSplines:
    """Keys with a slope before and one after each, by scipy."""

    def __init__(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> None:
        self.times = times
        self.pieces = [
            CubicHermiteSpline(times[k : k + 2], rows[k : k + 2, 1], [rows[k, 2], rows[k + 1, 0]])
            for k in range(len(times) - 1)
        ]

    def at(self, time: float) -> NDArray[np.float64]:
        """The value at a time."""
        place = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.pieces) - 1))
        return self.pieces[place](np.clip(time, self.times[0], self.times[-1]))


class Stage(played.Stage):
    """A file whose turns are brought to length 1 before they are interpolated, by scipy."""

    def sample(self, sampler: dict[str, Any], path: str, time: float) -> NDArray[np.float64]:
        """A sampler's value."""
        times = self.document.accessor(sampler["input"]).astype(float).ravel()
        if sampler.get("interpolation") == "CUBICSPLINE":
            rows = self.document.accessor(sampler["output"]).astype(float).reshape(len(times), 3, -1)
            value = CubicHermiteSplines(times, rows).at(time)
            return value / np.linalg.norm(value) if path == "rotation" else value
        if path != "rotation" or len(times) < 2 or sampler.get("interpolation", "LINEAR") != "LINEAR":
            return super().sample(sampler, path, time)
        turns = Rotation.from_quat(self.document.accessor(sampler["output"]).astype(float))
        return Slerp(times, turns)(np.clip(time, times[0], times[-1])).as_quat()


def binding(document: Document, stage: played.Stage) -> tuple[list[int], NDArray[np.float64], NDArray[np.float64]]:
    """Joints of the first skin, their inverse bind matrices, and the map from its mesh to the scene as it is bound."""
    skin = document.json["skins"][0]
    back = document.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
    return skin["joints"], back, stage.world(skin["joints"][0], stage.nodes) @ back[0]


@pytest.mark.cases
@pytest.mark.parametrize("name", SKINNED)
def test_skinned_files_stand_as_they_are_bound(kiln: Kiln, cases: Path, name: str) -> None:
    """Where their first joint brings them, in numpy."""
    file = bring(cases, name, kiln)
    document = Document(kiln.folder / file)
    _, _, bound = binding(document, played.Stage(document))
    node = next(node for node in document.json["nodes"] if "skin" in node)
    primitives = document.json["meshes"][node["mesh"]]["primitives"]
    places = np.concatenate([document.accessor(one["attributes"]["POSITION"]).astype(float) for one in primitives])
    wanted = places @ bound[:3, :3].T + bound[:3, 3]
    points, triangles = kiln.bake(f'[shape.s.import]\nfile = "{file}"\n').mesh("s")
    size = float(np.ptp(wanted, axis=0).max())
    assert np.abs(np.stack([points.min(0) - wanted.min(0), points.max(0) - wanted.max(0)])).max() < SINGLE * size
    assert len(triangles) > 0
    near = np.linalg.norm(points[::17, None] - wanted[None], axis=2).min(1)
    assert near.max() < SINGLE * size


def worlds(stage: played.Stage, animation: dict[str, Any], question: dict[str, Any]) -> list[NDArray[np.float64]]:
    """The world matrix of every node at a time."""
    places = range(len(stage.nodes))
    named = {**stage.names}
    stage.names = {f"#{place}": place for place in places}
    pose = stage.pose(animation, {**question, "nodes": list(stage.names)})
    stage.names = named
    return [np.array(pose["nodes"][f"#{place}"]).reshape(4, 4).T for place in places]


def even(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nearest turn of even scale."""
    before, stretch, after = np.linalg.svd(matrix)
    return before @ after * stretch.mean()


def kebab(name: str, index: int) -> str:
    """A joint's name as a document has it."""
    words = re.findall(r"[A-Z]+(?![a-z])[0-9]*|[A-Z]?[a-z]+[0-9]*|[0-9]+", name)
    return "-".join(words).lower() if words else f"joint-{index + 1}"


@pytest.mark.cases
@pytest.mark.parametrize(("name", "number"), [(name, 0) for name in SKINNED] + [("Fox.glb", 1), ("Fox.glb", 2)])
def test_skeletons_and_animations_play_the_same(
    kiln: Kiln, cases: Path, name: str, number: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """The matrix of each joint with its bind taken out, at keys and between them.

    The rounded matrices of the files stretch axes unevenly by as much as a millionth, which a skeleton does not.
    """
    file = bring(cases, name, kiln)
    document = Document(kiln.folder / file)
    stage = Stage(document)
    joints, back, bound = binding(document, stage)
    animation = document.json["animations"][number]
    mesh = next(node["mesh"] for node in stage.nodes if "skin" in node)
    positions = document.accessor(document.json["meshes"][mesh]["primitives"][0]["attributes"]["POSITION"])
    size = float(np.linalg.norm(np.ptp(positions @ bound[:3, :3].T, axis=0)))
    chosen = f'animation = "{animation["name"]}"\n' if "name" in animation else ""
    baked = kiln.bake(
        f'[shape.s.import]\nfile = "{file}"\n[skeleton.k.import]\nfile = "{file}"\n'
        '[skin.m]\nshape = "s"\nskeleton = "k"\nweights = "imported"\n'
        f'[clip.c]\ntolerance = {1e-7 * size}\n[clip.c.import]\nfile = "{file}"\n{chosen}'
    )
    again = Stage(baked.document)
    ours, own_back, own_bound = binding(baked.document, again)
    assert np.abs(own_bound - np.eye(4)).max() < 1e-6
    names = {again.nodes[joint]["name"]: place for place, joint in enumerate(ours)}
    last = max(document.accessor(one["input"]).max() for one in animation["samplers"])
    times = np.linspace(0, float(last), 23)
    worst, uneven = 0.0, 0.0
    for time in times:
        question = {"time": float(time), "nodes": [], "vertices": {}}
        before, after = (
            worlds(stage, animation, question),
            worlds(again, baked.document.json["animations"][0], question),
        )
        for place, joint in enumerate(joints):
            own = names[kebab(stage.nodes[joint].get("name", ""), sorted(joints).index(joint))]
            wanted = before[joint] @ back[place] @ np.linalg.inv(bound)
            found = after[ours[own]] @ own_back[own]
            apart = found[:3] - np.column_stack([even(wanted[:3, :3]), wanted[:3, 3]])
            worst = max(worst, float(np.abs(apart).max(0) @ [0, 0, 0, 1]) / size, float(np.abs(apart[:3, :3]).max()))
            uneven = max(uneven, float(np.abs(wanted[:3, :3] - even(wanted[:3, :3])).max()))
    with capsys.disabled():
        sys.stdout.write(
            f"\n{name}, animation {number}: joint matrices within {worst:.1e} of the model's size; "
            f"the file's own stretch unevenly by {uneven:.1e}\n"
        )
    assert worst < 1e-6


def cubic_file(path: Path) -> None:
    """Two joints, turned and bound askew, one of them behind a node that is none; moves by cubics with a corner."""
    chance = np.random.default_rng(5)
    bind = [np.eye(4), np.eye(4)]
    bind[0][:3, :3] = Rotation.from_euler("xyz", [30, -50, 80], degrees=True).as_matrix()
    bind[1][:3, :3] = Rotation.from_euler("xyz", [-70, 10, 25], degrees=True).as_matrix() * 0.5
    bind[0][:3, 3], bind[1][:3, 3] = [0.2, 0.1, 0], [0.4, 1.1, -0.3]
    between = np.eye(4)
    between[:3, 3] = [0.1, 0.2, 0.3]
    below = np.linalg.inv(bind[0] @ between) @ bind[1]
    turns = Rotation.from_matrix(below[:3, :3] / 0.5) * Rotation.from_rotvec(chance.normal(0, 0.5, (4, 3)))
    turns = turns.as_quat()
    turns *= np.where(turns @ turns[0] < 0, -1, 1)[:, None]
    times = np.array([0, 0.4, 0.9, 1.5])
    cubic = np.stack([chance.normal(0, 0.3, (4, 4)), turns, chance.normal(0, 0.3, (4, 4))], axis=1)
    moves = np.stack([chance.normal(0, 0.4, (4, 3)), below[:3, 3] + chance.normal(0, 0.1, (4, 3)), np.zeros((4, 3))], 1)
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]])
    weights = np.tile([0.5, 0.5, 0, 0], (3, 1))
    back = np.array([np.linalg.inv(one).T for one in bind])
    arrays = [points, weights, back, times, cubic, moves]
    data = b"".join(np.asarray(one, "<f4").tobytes() for one in arrays) + bytes([0, 1, 0, 0] * 3)
    starts = np.cumsum([0] + [4 * one.size for one in arrays])
    kinds = ["VEC3", "VEC4", "MAT4", "SCALAR", "VEC4", "VEC3"]
    counts = [3, 3, 2, 4, 12, 12]
    views = [
        {"buffer": 0, "byteOffset": int(s), "byteLength": 4 * a.size} for s, a in zip(starts, arrays, strict=False)
    ]
    views.append({"buffer": 0, "byteOffset": int(starts[-1]), "byteLength": 12})
    accessors: list[dict[str, Any]] = [
        {"bufferView": k, "componentType": 5126, "type": kinds[k], "count": counts[k]} for k in range(6)
    ]
    accessors[0] |= {"min": [0, 0, 0], "max": [1, 2, 0]}
    accessors[3] |= {"min": [0], "max": [1.5]}
    accessors.append({"bufferView": 6, "componentType": 5121, "type": "VEC4", "count": 3})
    flat = [one.T.ravel().tolist() for one in (bind[0], below)]
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data), "uri": "cubic.bin"}],
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 6, "WEIGHTS_0": 1}}]}],
        "skins": [{"joints": [1, 3], "inverseBindMatrices": 2}],
        "nodes": [
            {"mesh": 0, "skin": 0},
            {"name": "upper", "matrix": flat[0], "children": [2]},
            {"name": "between", "translation": [0.1, 0.2, 0.3], "children": [3]},
            {"name": "lower", "rotation": turns[0].tolist(), "translation": below[:3, 3].tolist(), "scale": [0.5] * 3},
        ],
        "scenes": [{"nodes": [0, 1]}],
        "animations": [
            {
                "name": "sway",
                "channels": [
                    {"sampler": 0, "target": {"node": 3, "path": "rotation"}},
                    {"sampler": 1, "target": {"node": 3, "path": "translation"}},
                ],
                "samplers": [
                    {"input": 3, "output": 4, "interpolation": "CUBICSPLINE"},
                    {"input": 3, "output": 5, "interpolation": "CUBICSPLINE"},
                ],
            }
        ],
    }
    path.with_name("cubic.bin").write_bytes(data)
    path.write_text(json.dumps(document), encoding="utf-8")


def test_cubics_and_bent_binds_play_the_same(kiln: Kiln) -> None:
    """Slopes that differ around a key, a scaled bind, a matrix, a node between joints; z up in the document."""
    path = kiln.folder / "cubic.gltf"
    cubic_file(path)
    document = Document(path)
    stage = Stage(document)
    joints, back, bound = binding(document, stage)
    baked = kiln.bake(
        'unit = "cm"\nup = "z"\n[shape.s.import]\nfile = "cubic.gltf"\nup = "z"\n[skeleton.k.import]\n'
        'file = "cubic.gltf"\nup = "z"\n[skin.m]\nshape = "s"\nskeleton = "k"\nweights = "imported"\n'
        '[clip.c]\ntolerance = 1e-5\nrate = 480\n[clip.c.import]\nfile = "cubic.gltf"\n'
    )
    again = Stage(baked.document)
    ours, own_back, _ = binding(baked.document, again)
    # One unit is a centimeter, and z of the file points up: (x, y, z) stands at (x, z, -y).
    into = np.diag([0.01, 0.01, 0.01, 1.0]) @ np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    worst = 0.0
    for time in np.linspace(0, 1.5, 61):
        question = {"time": float(time), "nodes": [], "vertices": {}}
        before = worlds(stage, document.json["animations"][0], question)
        after = worlds(again, baked.document.json["animations"][0], question)
        for place, joint in enumerate(joints):
            wanted = into @ before[joint] @ back[place] @ np.linalg.inv(bound) @ np.linalg.inv(into)
            found = after[ours[place]] @ own_back[place]
            apart = np.abs(found - wanted)[:3]
            worst = max(worst, float(apart[:, :3].max()), float(apart[:, 3].max()) / 0.02)
    assert worst < 2e-4, worst


def test_what_kiln_writes_it_reads_again(kiln: Kiln) -> None:
    """With its names, materials and closed bodies, in every profile."""
    spec = (
        '[shape.a]\nmaterial = "red"\n[shape.a.torus]\nradius = 1\ntube-radius = 0.3\n[shape.b.box]\nsize = [1, 2, 3]\n'
        '[node.ring]\nshape = "a"\nat = [3, 0, 0]\nrotate = [0, 0, 90]\n[node.block]\nshape = "b"\nscale = [-1, 1, 1]\n'
        '[material.red]\ncolor = "#ff0000"\nmetallic = 0.5\n'
    )
    for profile in ("core", "quantized", "web"):
        kiln.write(f'{spec}[output]\nprofiles = ["{profile}"]\n', "first")
        done = kiln.run("bake", "first.toml", "--out", "out")
        assert done.returncode == 0, done.stderr
        stem = "first" if profile == "core" else f"first.{profile}"
        shapes = json.loads((kiln.folder / "out" / f"{stem}.report.json").read_text(encoding="utf-8"))["shapes"]
        shutil.copyfile(kiln.folder / "out" / f"{stem}.glb", kiln.folder / "first.glb")
        again = kiln.bake(
            '[shape.all.import]\nfile = "first.glb"\n[shape.ring.import]\nfile = "first.glb"\ngroup = "ring"\n'
            '[node.all]\nshape = "all"\n[node.ring]\nshape = "ring"\nat = [9, 0, 0]\n',
            name="again",
        )
        ring, block = shapes["a"], shapes["b"]
        whole, part = again.shape("all"), again.shape("ring")
        assert whole["triangles"] == ring["triangles"] + block["triangles"]
        assert (whole["closed"], part["closed"], part["components"]) == (True, True, 1)
        assert whole["volume"] == pytest.approx(ring["volume"] + block["volume"], rel=1e-3)
        assert part["volume"] == pytest.approx(ring["volume"], rel=1e-3)
        red = next(one for one in again.document.json["materials"] if one["name"] == "red")
        assert red["pbrMetallicRoughness"]["metallicFactor"] == 0.5


@pytest.mark.cases
def test_broken_files_are_refused_with_what_is_wrong(kiln: Kiln, cases: Path) -> None:
    """One diagnostic, exit code 1, nothing written."""
    for name, words in (
        ("gltf/bad/IndexOutOfRange.gltf", "vertex"),
        ("gltf/bad/BoxTextured.gltf", "which cannot be read"),
        ("hostile/gltf/node_cycle.gltf", "stands in two places"),
        ("hostile/gltf/uri_traversal.gltf", "which cannot be read"),
        ("hostile/gltf/accessor_count_huge.gltf", "K"),
    ):
        source = cases / name
        for other in [source, *source.parent.glob("*.bin")]:
            shutil.copyfile(other, kiln.folder / other.name)
        kiln.write(f'[shape.s.import]\nfile = "{source.name}"\n')
        done = kiln.run("bake", "model.toml", "--out", "out")
        assert done.returncode == 1, name
        assert words in done.stderr, done.stderr
        assert not (kiln.folder / "out" / "model.glb").exists()
