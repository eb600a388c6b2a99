"""The profile `verify`: meshes by EXT_mesh_manifold, held against every demand of that extension by numpy alone."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from test_verify import VERIFY

from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

SHAPES = {
    "box": "[shape.a.box]\nsize = [1, 2, 3]\n",
    "ball": '[shape.a]\nuv = "always"\n[shape.a.sphere]\nradius = 1\n',
    "ring": "[shape.a.torus]\nradius = 1\ntube-radius = 0.3\n",
    "two materials": (
        '[shape.b]\nmaterial = "red"\n[shape.b.box]\nsize = [1, 1, 1]\n[shape.c]\nat = [0.4, 0.4, 0.4]\n'
        'material = "blue"\n[shape.c.box]\nsize = [1, 1, 1]\n[shape.a.union]\nof = ["b", "c"]\n'
        '[material.red]\ncolor = "#ff0000"\n[material.blue]\ncolor = "#0000ff"\n'
    ),
    "flat facets": '[shape.a]\nsmoothing = "flat"\n[shape.a.geodesic]\nradius = 1\n',
}


def baked(kiln: Kiln, text: str) -> Path:
    """A document in the profile."""
    kiln.write(f"tolerance = 0.01\n{text}", "model")
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", "verify")
    assert done.returncode == 0, done.stdout + done.stderr
    return kiln.folder / "out" / "model.verify.glb"


def pairs(triangles: np.ndarray) -> tuple[set[tuple[int, int]], int]:
    """The halves of edges, and how many there are."""
    halves = [(int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3)]
    return set(halves), len(halves)


@pytest.mark.parametrize("name", SHAPES)
def test_closed_meshes_are_manifold_after_merging(kiln: Kiln, name: str) -> None:
    """One accessor of positions, one view of indices, merges of equal places, each half of an edge with its other."""
    document = Document(baked(kiln, SHAPES[name]))
    root: dict[str, Any] = document.json
    assert "EXT_mesh_manifold" in root["extensionsUsed"]
    assert "EXT_mesh_manifold" not in root.get("extensionsRequired", [])
    (mesh,) = root["meshes"]
    said = mesh["extensions"]["EXT_mesh_manifold"]
    own = said["manifoldPrimitive"]
    assert set(own) == {"attributes", "indices", "mode"}
    assert own["mode"] == 4
    for primitive in mesh["primitives"]:
        assert primitive.get("mode", 4) == 4
        assert own["attributes"] == {"POSITION": primitive["attributes"]["POSITION"]}
    accessors = root["accessors"]
    whole = accessors[own["indices"]]
    parts = [accessors[primitive["indices"]] for primitive in mesh["primitives"]]
    assert {part["bufferView"] for part in parts} == {whole["bufferView"]}
    drawn = np.concatenate([document.accessor(primitive["indices"]).ravel() for primitive in mesh["primitives"]])
    merged = document.accessor(own["indices"]).ravel()
    assert len(merged) == len(drawn)
    places = document.accessor(own["attributes"]["POSITION"])
    assert (places[drawn] == places[merged]).all()
    halves, count = pairs(merged.reshape(-1, 3))
    assert len(halves) == count
    assert all((b, a) in halves for a, b in halves)
    if "sparse" in whole:
        sparse = whole["sparse"]
        for key, named in (("indices", "mergeIndices"), ("values", "mergeValues")):
            told = accessors[said[named]]
            assert told["bufferView"] == sparse[key]["bufferView"]
            assert told.get("byteOffset", 0) == sparse[key].get("byteOffset", 0)
            assert told["count"] == sparse["count"]
        assert accessors[said["mergeValues"]]["componentType"] == whole["componentType"]
        assert accessors[said["mergeIndices"]]["componentType"] == sparse["indices"]["componentType"]
        corners = document.accessor(said["mergeIndices"]).ravel().astype(int)
        assert (np.diff(corners) > 0).all()
        assert (drawn[corners] != merged[corners]).all()
        assert (merged[corners] == document.accessor(said["mergeValues"]).ravel()).all()
        kept = np.ones(len(drawn), bool)
        kept[corners] = False
        assert (drawn[kept] == merged[kept]).all()
    else:
        assert (drawn == merged).all()
    assert ("sparse" in whole) == (name not in {"ring"})


def test_open_meshes_and_lines_say_nothing(kiln: Kiln) -> None:
    """A flat sheet and a wire are no solids."""
    text = "[shape.a.plane]\nsize = [1, 1]\n"
    root = Document(baked(kiln, text)).json
    assert "EXT_mesh_manifold" not in root.get("extensionsUsed", [])
    assert all("extensions" not in mesh for mesh in root["meshes"])


def test_what_the_profile_says_is_the_core_file_otherwise(kiln: Kiln) -> None:
    """The same triangles as in the core profile."""
    path = baked(kiln, SHAPES["box"])
    core = kiln.bake(f"tolerance = 0.01\n{SHAPES['box']}")
    one, other = Document(path).meshes[0], core.document.meshes[0]
    assert (one.positions == other.positions).all()
    assert (one.triangles == other.triangles).all()


def test_every_tool_confirms_it(kiln: Kiln) -> None:
    for name, text in SHAPES.items():
        # The validator tells of texture coordinates without a texture.
        baked(kiln, text.replace('uv = "always"\n', "")).rename(kiln.folder / "out" / f"{name.replace(' ', '-')}.glb")
        report = kiln.folder / "out" / "model.verify.report.json"
        report.rename(report.with_name(f"{name.replace(' ', '-')}.report.json"))
    line = [sys.executable, str(VERIFY), str(kiln.folder / "out")]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
