"""Points spread over meshes, and their distances to closed-form surfaces, with numpy alone."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Points = NDArray[np.float64]
    Triangles = NDArray[np.int64]


def spread(points: Points, triangles: Triangles, steps: int = 6) -> Points:
    """A lattice of points on every triangle, corners and sides included."""
    weights = [(a, b, steps - a - b) for a in range(steps + 1) for b in range(steps + 1 - a)]
    corners = points[triangles]
    return np.concatenate([np.einsum("c,tci->ti", np.array(w) / steps, corners) for w in weights])


def area(points: Points, triangles: Triangles) -> float:
    """The area of a mesh."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def volume(points: Points, triangles: Triangles) -> float:
    """The signed volume of a closed mesh."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.einsum("ti,ti->", a, np.cross(b, c)) / 6)


def to_profile(points: Points, profile: Points) -> Points:
    """Distances to the surface that a fine polyline (radius, height) sweeps about the y axis."""
    flat = np.column_stack([np.hypot(points[:, 0], points[:, 2]), points[:, 1]])
    return to_polyline(flat, profile)


def to_polyline(points: Points, curve: Points) -> Points:
    """Distances to a fine polyline: to the two pieces beside each point's nearest vertex."""
    nearest = cKDTree(curve).query(points)[1]
    found = np.full(len(points), np.inf)
    for step in (-1, 0):
        start = curve[np.clip(nearest + step, 0, len(curve) - 2)]
        along = curve[np.clip(nearest + step + 1, 1, len(curve) - 1)] - start
        square = np.maximum((along * along).sum(axis=1), 1e-300)
        t = np.clip(((points - start) * along).sum(axis=1) / square, 0, 1)
        found = np.minimum(found, np.linalg.norm(start + t[:, None] * along - points, axis=1))
    return found


def bezier(control: list[list[float]], t: Points) -> Points:
    """Points of one Bezier of any degree, by de Casteljau's construction."""
    layer = [np.outer(np.ones_like(t), point) for point in np.array(control, float)]
    while len(layer) > 1:
        layer = [(1 - t)[:, None] * a + t[:, None] * b for a, b in pairwise(layer)]
    return layer[0]


def revolved(profile: Callable[[Points], Points], pieces: int = 2000) -> tuple[float, float]:
    """(area, volume) of a profile r(t), y(t), t from 0 to 1, turned once about the y axis.

    Gauss-Legendre with 8 points on each piece; the volume is pi times the integral of r^2 dy, so it is that
    between the surface and the axis, closed by flat discs.
    """
    nodes, weights = np.polynomial.legendre.leggauss(8)
    ends = np.linspace(0, 1, pieces + 1)
    t = ((ends[:-1] + ends[1:])[:, None] / 2 + nodes / (2 * pieces)).ravel()
    w = np.tile(weights / (2 * pieces), pieces)
    step = 1e-6
    speed = (profile(t + step) - profile(t - step)) / (2 * step)
    radius = profile(t)[:, 0]
    area = 2 * np.pi * (w * radius * np.hypot(speed[:, 0], speed[:, 1])).sum()
    return float(area), float(abs(np.pi * (w * radius**2 * speed[:, 1]).sum()))


def exponent(sizes: list[float], errors: list[float]) -> float:
    """The fitted power with which errors fall with sizes."""
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
