"""Deformed shapes: every written vertex, brought back by the inverse of the map, lies on the plain shape."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Kiln

    Points = NDArray[np.float64]

SINGLE = 2e-6
"""Metres that single precision leaves open at the size of these shapes, times what the inverse maps stretch."""


def untwist(points: Points, radians: float, height: float) -> Points:
    """Undo a turn about y that is 0 at the lower end and `radians` at the upper one."""
    angle = -radians * (points[:, 1] / height + 0.5)
    x, z = points[:, 0], points[:, 2]
    # From z toward x is counterclockwise for who looks against y.
    return np.column_stack([x * np.cos(angle) + z * np.sin(angle), points[:, 1], z * np.cos(angle) - x * np.sin(angle)])


def unbend(points: Points, radians: float, height: float) -> Points:
    """Undo a bend of the y axis toward x that begins at the lower end."""
    radius = height / radians
    x, y = points[:, 0], points[:, 1] + height / 2
    angle = np.arctan2(y, radius - x)
    return np.column_stack([radius - np.hypot(y, radius - x), angle * radius - height / 2, points[:, 2]])


def untaper(points: Points, factor: float, height: float) -> Points:
    """Undo a factor of size across y, 1 at the lower end."""
    share = points[:, 1] / height + 0.5
    scale = 1 + (factor - 1) * share
    return np.column_stack([points[:, 0] / scale, points[:, 1], points[:, 2] / scale])


def off_box(points: Points, size: tuple[float, float, float]) -> float:
    """The greatest distance of points from the sides of a box."""
    beyond = np.abs(points) - np.asarray(size) / 2
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return float(np.abs(np.where(outside > 0, outside, beyond.max(axis=1))).max())


def hold(kiln: Kiln, spec: str, back: Callable[[Points], Points], size: tuple[float, float, float]) -> None:
    tolerance = 0.002
    asset = kiln.bake(f"tolerance = {tolerance}\n{spec}", "--measure")
    shape = asset.shape("a")
    assert shape["closed"]
    points, triangles = asset.mesh("a")
    assert off_box(back(points), size) <= SINGLE
    # Triangles, sampled inside: chords leave the surface by no more than the bound.
    weights = np.random.default_rng(3).dirichlet((1, 1, 1), len(triangles))
    inside = np.einsum("tc,tcx->tx", weights, points[triangles])
    stretch = 1.5
    assert off_box(back(inside), size) <= stretch * shape["deviation"]["bound"] + SINGLE


def test_a_twisted_box_is_a_box_again(kiln: Kiln) -> None:
    spec = "[shape.a.twist]\nof = { box = { size = [0.4, 2, 0.3] } }\nangle = 130\n"
    hold(kiln, spec, lambda points: untwist(points, math.radians(130), 2), (0.4, 2, 0.3))


def test_a_bent_box_is_a_box_again(kiln: Kiln) -> None:
    spec = "[shape.a.bend]\nof = { box = { size = [0.4, 2, 0.3] } }\nangle = 110\n"
    hold(kiln, spec, lambda points: unbend(points, math.radians(110), 2), (0.4, 2, 0.3))


def test_a_tapered_box_is_a_box_again(kiln: Kiln) -> None:
    spec = "[shape.a.taper]\nof = { box = { size = [0.4, 2, 0.3] } }\nfactor = 0.7\n"
    hold(kiln, spec, lambda points: untaper(points, 0.7, 2), (0.4, 2, 0.3))


def test_laid_along_an_arc_a_cylinder_is_part_of_a_torus(kiln: Kiln) -> None:
    """By the distance from the circle of radius 2 in the plane z = 0."""
    spec = (
        "tolerance = 0.001\n[shape.a.along]\nof = { cylinder = { radius = 0.2, height = 3 } }\n"
        'axis = "y"\npath = { arc = { radius = 2, from = 0, to = 90 } }\n'
    )
    asset = kiln.bake(spec, "--measure")
    points, triangles = asset.mesh("a")
    away = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 2, points[:, 2])
    turned = np.arctan2(points[:, 1], points[:, 0])
    assert turned.min() >= -1e-6
    assert turned.max() <= 1.5 + 1e-6
    wall = (turned > 1e-5) & (turned < 1.5 - 1e-5)
    # What lies on a chord of the cylinder before the map is off by no more than the bound.
    assert np.abs(away[wall] - 0.2).max() <= asset.shape("a")["deviation"]["bound"]
    corners = points[triangles]
    volume = np.einsum("tx,tx->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert abs(volume - math.pi * 0.04 * 3) <= 0.001 * asset.shape("a")["area"]
