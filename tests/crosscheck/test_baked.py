"""Lightmaps and occlusion: second coordinates drawn texel by texel, and skies sampled at random, by numpy alone."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from kiln import Kiln

SIZE, PADDING = 256, 2
SHAPES = {
    "box": "[shape.a.box]\nsize = [1, 2, 0.5]\n",
    "ring": "[shape.a.torus]\nradius = 0.5\ntube-radius = 0.15\n",
    "bracket": (
        "[shape.a.extrude]\nheight = 0.7\nbevel = 0.03\nprofile = { polyline = { points = "
        "[[0, 0], [2, 0], [2, 0.5], [0.5, 0.5], [0.5, 2], [0, 2]], closed = true } }\n"
    ),
    "ball": "[shape.a.geodesic]\nradius = 0.6\n",
}


def unwrapped(path: Path, mesh: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Positions, second texture coordinates and triangles of a mesh of one primitive."""
    document = Document(path)
    (primitive,) = document.json["meshes"][mesh]["primitives"]
    attributes = primitive["attributes"]
    index = attributes["TEXCOORD_1"]
    places = np.asarray(document.accessor(index), float)
    if document.json["accessors"][index]["componentType"] == 5123:
        places = places / 65535.0 if places.max() > 1.0 else places
    return document.meshes[mesh].positions, places, document.meshes[mesh].triangles


def drawn(places: NDArray[np.float64], triangles: NDArray[np.int64], side: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """For each texel of a picture how many triangles hold its middle, away from their sides, and which piece does."""
    # Vertices of several normals that share a place hold a piece together.
    _, same = np.unique(places, axis=0, return_inverse=True)
    joined = same.ravel()[triangles]
    piece = np.arange(len(places))
    while True:
        least = piece.copy()
        for corner in range(3):
            np.minimum.at(least, joined[:, corner], piece[joined].min(axis=1))
        if (least == piece).all():
            break
        piece = least
    count = np.zeros((side, side), int)
    label = np.full((side, side), -1)
    for corners, own in zip(triangles, joined, strict=True):
        a, b, c = places[corners] * side
        twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if twice == 0.0:
            continue
        low = np.maximum(np.floor(np.minimum(np.minimum(a, b), c)).astype(int), 0)
        high = np.minimum(np.ceil(np.maximum(np.maximum(a, b), c)).astype(int), side)
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / twice
        w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / twice
        least = np.minimum(np.minimum(v, w), 1.0 - v - w)
        count[low[1] : high[1], low[0] : high[0]] += least > 1e-3
        block = label[low[1] : high[1], low[0] : high[0]]
        block[least >= 0.0] = piece[own[0]]
    return count, label


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("profile", ["core", "quantized"])
def test_no_texel_has_two_places(kiln: Kiln, name: str, profile: str) -> None:
    """Places lie in the picture, no texel in two triangles, pieces keep apart, and the density is what is told."""
    text = f"tolerance = 0.005\n[shape.a]\nlightmap = {{ size = {SIZE}, padding = {PADDING} }}\n{SHAPES[name]}"
    kiln.write(text, "model")
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", profile)
    assert done.returncode == 0, done.stdout + done.stderr
    ending = "" if profile == "core" else f".{profile}"
    path = kiln.folder / "out" / f"model{ending}.glb"
    facts = json.loads(path.with_name(f"model{ending}.report.json").read_text())["shapes"]["a"]["lightmap"]
    positions, places, triangles = unwrapped(path)
    assert places.min() >= 0.0
    assert places.max() <= 1.0
    fine, _ = drawn(places, triangles, 4 * SIZE)
    assert fine.max() == 1
    _, label = drawn(places, triangles, SIZE)
    for down in range(PADDING + 1):
        for along in range(-PADDING, PADDING + 1):
            one = label[: SIZE - down, max(0, -along) : SIZE - max(0, along)]
            other = label[down:, max(0, along) : SIZE - max(0, -along)]
            assert ((one == other) | (one < 0) | (other < 0)).all()
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    surface = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    p, q, r = (places[triangles[:, corner]] for corner in range(3))
    covered = np.abs((q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]).sum() / 2
    assert facts["filled"] == pytest.approx(covered, rel=1e-4)
    assert facts["overlaps"] == 0
    if profile == "core":
        # Elsewhere positions are whole numbers.
        assert facts["density"] == pytest.approx(SIZE * np.sqrt(covered / surface), rel=1e-4)


def hidden(start: NDArray[np.float64], normal: NDArray[np.float64], corners: NDArray[np.float64], count: int) -> float:
    """The share of a sky that triangles hide, by directions at random, weighted by their cosine."""
    random = np.random.default_rng(7)
    away, turn = np.sqrt(random.random(count)), 2 * np.pi * random.random(count)
    across = np.cross(normal, [0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    up = np.cross(normal, across)
    rays = np.outer(away * np.cos(turn), across) + np.outer(away * np.sin(turn), up)
    rays += np.outer(np.sqrt(1 - away**2), normal)
    blocked = np.zeros(count, bool)
    for a, b, c in corners:
        cross = np.cross(rays, c - a)
        determinant = cross @ (b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = (cross @ (start - a)) / determinant
            over = np.cross(start - a, b - a)
            v = (rays @ over) / determinant
            t = ((c - a) @ over) / determinant
            blocked |= (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 1e-9)
    return float(blocked.mean())


def test_colors_are_darkened_by_the_sky_that_is_hidden(kiln: Kiln) -> None:
    """At every vertex of an angle of boxes: as a sampler at random finds."""
    text = (
        "[shape.a]\nocclusion = { samples = 4096, strength = 0.8 }\n[shape.a.extrude]\nheight = 2\n"
        "profile = { polyline = { closed = true, points = "
        "[[0, 0], [2, 0], [2, 0.5], [0.5, 0.5], [0.5, 2], [0, 2]] } }\n"
    )
    asset = kiln.bake(text)
    document = Document(asset.path)
    (primitive,) = document.json["meshes"][0]["primitives"]
    colors = np.asarray(document.accessor(primitive["attributes"]["COLOR_0"]), float)
    mesh = document.meshes[0]
    corners = mesh.positions[mesh.triangles]
    assert colors[:, 0].min() < 0.8
    for vertex, color in enumerate(colors):
        own = [
            (triangle, int(np.argmax(triangle == vertex))) for triangle in mesh.triangles if (triangle == vertex).any()
        ]
        shares = []
        for triangle, which in own:
            a, b, c = mesh.positions[np.roll(triangle, -which)]
            normal = np.cross(b - a, c - a)
            normal /= np.linalg.norm(normal)
            start = a + 0.02 * (b - a + c - a) + 1e-5 * normal
            shares.append(hidden(start, normal, corners, 20_000))
        # Three deviations of both samplers together.
        assert color[0] == pytest.approx(1 - 0.8 * np.mean(shares), abs=0.025)
