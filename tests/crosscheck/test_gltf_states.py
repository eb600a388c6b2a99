"""Morph targets, weights and properties of glTF files of others: they play as in the file, by a player of its own."""

from __future__ import annotations

import base64
import json
import shutil
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from checks.document import Document
from checks.played import Stage

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from kiln import Kiln

FILES = {"AnimatedMorphCube": "AnimatedMorphCube/AnimatedMorphCube.gltf", "SimpleMorph": "SimpleMorph/SimpleMorph.gltf"}


def corners(document: Document, animation: dict[str, Any] | None, time: float) -> NDArray[np.float64]:
    """The corners of all triangles at a time, then their middles, in the scene."""
    stage = Stage(document)
    weights = {index: stage.rest_weights(node) for index, node in enumerate(stage.nodes)}
    for channel in animation["channels"] if animation else []:
        if channel["target"]["path"] == "weights":
            sampler = animation["samplers"][channel["sampler"]]
            weights[channel["target"]["node"]] = stage.sample(sampler, "weights", time)
    found = []
    for index, node in enumerate(stage.nodes):
        if "mesh" not in node:
            continue
        mesh = document.meshes[node["mesh"]]
        places = mesh.positions.astype(float)
        for target, weight in zip(mesh.targets, weights[index], strict=True):
            places = places + weight * target.attributes["POSITION"]
        world = stage.world(index, [dict(node) for node in stage.nodes])
        found.append((places @ world[:3, :3].T + world[:3, 3])[mesh.triangles])
    triangles = np.concatenate(found)
    return np.concatenate([triangles.reshape(-1, 3), triangles.mean(axis=1)])


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """How far a point of one set is from the other set at most, as a part of their size."""
    ways = cKDTree(one).query(other)[0].max(), cKDTree(other).query(one)[0].max()
    return float(max(ways) / np.ptp(one, axis=0).max())


@pytest.mark.cases
@pytest.mark.parametrize("name", FILES)
def test_states_and_their_clips_play_the_same(kiln: Kiln, cases: Path, name: str) -> None:
    """At rest and at many times."""
    source = cases / "gltf" / FILES[name]
    shutil.copytree(source.parent, kiln.folder / name)
    document = Document(source)
    file = f'file = "{name}/{source.name}"'
    made = kiln.bake(f"[shape.s.import]\n{file}\n[clip.c]\ntolerance = 1e-6\n[clip.c.import]\n{file}\n")
    own, animation = document.json["animations"][0], made.document.json["animations"][0]
    assert len(made.document.meshes[0].targets) == len(document.meshes[0].targets)
    assert apart(corners(document, None, 0.0), corners(made.document, None, 0.0)) < 1e-6
    lasting = float(document.accessor(own["samplers"][0]["input"]).max())
    worst = max(
        apart(corners(document, own, time), corners(made.document, animation, time))
        for time in np.linspace(0, lasting, 53)
    )
    assert worst < 1e-5, worst


@pytest.mark.cases
def test_frames_one_is_the_shape_at_rest(kiln: Kiln, cases: Path) -> None:
    """No states, and `weld` cannot keep them."""
    shutil.copytree(cases / "gltf" / "SimpleMorph", kiln.folder / "SimpleMorph")
    file = f'file = "{FILES["SimpleMorph"]}"'
    wanted = corners(Document(cases / "gltf" / FILES["SimpleMorph"]), None, 0.0)
    made = kiln.bake(f'[shape.s.import]\n{file}\nframes = "one"\n')
    assert not made.document.meshes[0].targets
    assert apart(wanted, corners(made.document, None, 0.0)) < 1e-6
    kiln.write(f"[shape.s.import]\n{file}\nweld = 0.001\n", "welded")
    done = kiln.run("bake", "welded.toml", "--out", "out")
    assert "its 2 states are left out, since `weld` joins points" in " ".join(done.stderr.split())
    assert apart(wanted, corners(kiln.baked("welded").document, None, 0.0)) < 1e-6


def pointing(folder: Path, cases: Path) -> NDArray[np.float64]:
    """A file whose clip changes colors, roughness and more, and moves a node; the colors of its keys."""
    shutil.copytree(cases / "gltf" / "SimpleMorph", folder / "SimpleMorph")
    path = folder / FILES["SimpleMorph"]
    document = json.loads(path.read_text(encoding="utf-8"))
    chance = np.random.default_rng(11)
    colors, rough = chance.uniform(0, 1, (5, 4)), chance.uniform(0, 1, 5)
    data = b"".join(one.astype("<f4").tobytes() for one in (colors, rough, chance.normal(0, 1, (5, 3))))
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    document["buffers"].append({"uri": uri, "byteLength": len(data)})
    for start, length, kind in ((0, 80, "VEC4"), (80, 20, "SCALAR"), (100, 60, "VEC3")):
        document["bufferViews"].append({"buffer": 2, "byteOffset": start, "byteLength": length})
        view = len(document["bufferViews"]) - 1
        document["accessors"].append({"bufferView": view, "componentType": 5126, "count": 5, "type": kind})
    document["materials"] = [{"name": "Skin"}]
    document["meshes"][0]["primitives"][0]["material"] = 0
    document["nodes"].append({"name": "Beside"})
    clip = document["animations"][0]
    first = len(document["accessors"]) - 3
    clip["samplers"] += [{"input": 4, "output": first + k} for k in range(3)]
    pointers = ((1, "/materials/0/pbrMetallicRoughness/baseColorFactor"),)
    pointers += ((2, "/materials/0/pbrMetallicRoughness/roughnessFactor"), (2, "/cameras/0/perspective/yfov"))
    clip["channels"] += [
        {"sampler": k, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}}
        for k, pointer in pointers
    ]
    clip["channels"].append({"sampler": 3, "target": {"node": 1, "path": "translation"}})
    document["extensionsUsed"] = ["KHR_animation_pointer"]
    path.write_text(json.dumps(document), encoding="utf-8")
    return np.column_stack([colors, rough])


@pytest.mark.cases
def test_properties_play_the_same_and_the_rest_is_told(kiln: Kiln, cases: Path) -> None:
    """Colors and roughness of a material arrive; a camera and a node that is no joint are named."""
    wanted = pointing(kiln.folder, cases)
    file = f'file = "{FILES["SimpleMorph"]}"'
    kiln.write(f"[shape.s.import]\n{file}\n[clip.c.import]\n{file}\n")
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 0, done.stderr
    told = " ".join(done.stderr.split())
    assert "left out: the translation of node `Beside`, which is no joint" in told
    assert "left out: `/cameras/0/perspective/yfov`: no imported material" in told
    made = kiln.baked()
    stage, clip = Stage(made.document), made.document.json["animations"][0]
    for key, row in enumerate(wanted):
        found = stage.pose(clip, {"time": float(key) + 1e-6, "nodes": [], "vertices": {}})["properties"]
        color = found["/materials/0/pbrMetallicRoughness/baseColorFactor"]
        rough = found["/materials/0/pbrMetallicRoughness/roughnessFactor"]
        assert np.abs(np.array([*color, *rough]) - row).max() < 4e-3, key


@pytest.mark.cases
def test_a_clip_that_moves_nothing_is_refused(kiln: Kiln, cases: Path) -> None:
    """With what it would move."""
    shutil.copytree(cases / "gltf" / "SimpleMorph", kiln.folder / "SimpleMorph")
    kiln.write(f'[shape.s.box]\nsize = [1, 1, 1]\n[clip.c.import]\nfile = "{FILES["SimpleMorph"]}"\n')
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 1
    told = " ".join(done.stderr.split())
    assert "moves nothing of this document" in told
    assert "the weights of node 0: no shape that a node shows is imported from this node" in told
