"""glTF files of other makers as shapes, held against what trimesh and numpy make of them."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

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


@pytest.mark.cases
@pytest.mark.parametrize("name", SKINNED)
def test_skinned_files_stand_as_their_joints_rest(kiln: Kiln, cases: Path, name: str) -> None:
    """Every vertex by the sum over its joints, in numpy."""
    file = bring(cases, name, kiln)
    document = Document(kiln.folder / file)
    stage = played.Stage(document)
    nodes = document.json["nodes"]
    node = next(node for node in nodes if "skin" in node)
    skin = document.json["skins"][node["skin"]]
    worlds = [stage.world(joint, nodes) for joint in skin["joints"]]
    back = document.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    maps = np.array([world @ inverse for world, inverse in zip(worlds, back, strict=True)])
    places = []
    for primitive in document.json["meshes"][node["mesh"]]["primitives"]:
        of = {key: document.accessor(index) for key, index in primitive["attributes"].items()}
        weights = of["WEIGHTS_0"] / of["WEIGHTS_0"].sum(1, keepdims=True)
        blend = np.einsum("vk,vkij->vij", weights, maps[of["JOINTS_0"].astype(int)])
        places.append(np.einsum("vij,vj->vi", blend[:, :3, :3], of["POSITION"]) + blend[:, :3, 3])
    wanted = np.concatenate(places)
    points, triangles = kiln.bake(f'[shape.s.import]\nfile = "{file}"\n').mesh("s")
    size = float(np.ptp(wanted, axis=0).max())
    assert np.abs(np.stack([points.min(0) - wanted.min(0), points.max(0) - wanted.max(0)])).max() < SINGLE * size
    assert len(triangles) > 0
    near = np.linalg.norm(points[::17, None] - wanted[None], axis=2).min(1)
    assert near.max() < SINGLE * size


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
