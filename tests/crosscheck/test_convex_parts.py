"""Colliders of convex parts: read back from the file and held against the mesh by trimesh alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh

from checks.document import Document

if TYPE_CHECKING:
    from kiln import Kiln

SHAPES = {
    "ring": "[shape.a.torus]\nradius = 0.5\ntube-radius = 0.12\n",
    "bowl": (
        "[shape.a.revolve]\nprofile = { polyline = { points = "
        "[[0, 0], [0.3, 0], [0.35, 0.3], [0.33, 0.3], [0.28, 0.02], [0, 0.02]] } }\n"
    ),
    "angle": (
        "[shape.a.extrude]\nheight = 0.5\nprofile = { polyline = { points = "
        "[[0, 0], [2, 0], [2, 0.5], [0.5, 0.5], [0.5, 2], [0, 2]], closed = true } }\n"
    ),
}
COLLIDER = '[collider.c]\nshape = "a"\nfit = "parts"\n'


def hulls(path: Any) -> list[trimesh.Trimesh]:
    """The parts that the extras of nodes tell."""
    told = [one for node in Document(path).json["nodes"] for one in node.get("extras", {}).get("colliders", [])]
    assert told
    assert all(one["part-of"] == "c" for one in told)
    return [trimesh.Trimesh(one["points"], np.reshape(one["indices"], (-1, 3)), process=False) for one in told]


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("rest", ["", "vertices = 12\nparts = 8\nconcavity = 0.1\n"])
def test_parts_are_convex_and_cover(kiln: Kiln, name: str, rest: str) -> None:
    """Every part is convex and closed, every vertex lies in one, and nothing reaches further out than is told."""
    asset = kiln.bake("tolerance = 0.004\n" + SHAPES[name] + COLLIDER + rest)
    facts = asset.report["colliders"]["c"]
    parts = hulls(asset.path)
    mesh = trimesh.load(asset.path, force="mesh", process=False)
    assert facts["parts"] == len(parts)
    for part in parts:
        assert part.is_watertight
        assert part.volume > 0
        # Single precision moves points by 3e-8, and turns the planes of faces that are slivers.
        planes, first = part.face_normals, part.triangles[:, 0]
        above = part.vertices @ planes.T - np.einsum("ij,ij->i", planes, first)
        assert above.max() < 2e-5
        assert len(part.vertices) <= (12 if rest else 64)
    away = [
        (mesh.vertices @ part.face_normals.T - np.einsum("ij,ij->i", part.face_normals, part.triangles[:, 0])).max(
            axis=1
        )
        for part in parts
    ]
    assert np.min(away, axis=0).max() < 2e-5
    welded = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    welded.merge_vertices(merge_norm=True, merge_tex=True)
    assert welded.is_watertight
    ratio = sum(part.volume for part in parts) / welded.volume
    assert ratio == pytest.approx(facts["volume-ratio"], rel=1e-4)
    # How far parts reach out, by samples: no more than is told, and the told is no mere bound.
    points = np.concatenate([trimesh.sample.sample_surface_even(part, 400, seed=1)[0] for part in parts])
    signed = trimesh.proximity.signed_distance(welded, points)
    farthest = max(0.0, -float(signed.min()))
    assert farthest <= facts["beyond"] + 1e-6
    size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    allowed = size * (0.1 if rest else 0.03)
    assert facts["beyond"] <= farthest + 0.3 * allowed
    assert facts["concavity"] <= allowed or rest
