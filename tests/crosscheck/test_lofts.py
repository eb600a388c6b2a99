"""Lofts against scipy's splines: vertices lie on the surface, volumes are integrals of sections."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.interpolate import CubicSpline

if TYPE_CHECKING:
    from kiln import Kiln

RINGS = np.array([[1.0, 0.0], [0.4, 1.0], [0.7, 3.0], [0.5, 3.8]])  # radius, height
SINGLE = 2e-6  # written positions are of single precision
ENDS = {
    "": "natural",
    'start = "not-a-knot"\nend = "not-a-knot"\n': "not-a-knot",
    'start = "straight"\nend = { first = [0, 0, 2] }\n': ((1, [0.0, 1.0]), (1, [0.0, 2.0])),
}


def outline(ends: object) -> CubicSpline:
    """Radius and height by the sum of chords."""
    chords = np.linalg.norm(np.diff(RINGS, axis=0), axis=1)
    return CubicSpline(np.concatenate([[0.0], np.cumsum(chords)]), RINGS, bc_type=ends)


def circle(radius: float, height: float) -> str:
    return f"{{ circle = {{ radius = {radius}, center = [0, 0, {height}] }} }}"


@pytest.mark.parametrize("words", ENDS)
def test_smooth_loft_of_circles(kiln: Kiln, words: str) -> None:
    profiles = ", ".join(circle(*ring) for ring in RINGS.tolist())
    baked = kiln.bake(f"tolerance = 1e-3\n[shape.s.loft]\n{words}profiles = [{profiles}]\n")
    spline = outline(ENDS[words])
    places = np.linspace(0.0, spline.x[-1], 200_001)
    radius, height = spline(places).T
    points, _ = baked.mesh("s")
    # The heights of these grow along the whole spline, so each tells its radius.
    assert np.all(np.diff(height) > 0)
    found = np.hypot(points[:, 0], points[:, 1])
    np.testing.assert_allclose(found, np.interp(points[:, 2], height, radius), atol=SINGLE)
    volume = np.pi * trapezoid(radius**2, height)
    assert baked.shape("s")["volume"] == pytest.approx(volume, rel=3e-3)


def test_linear_loft_of_ellipses(kiln: Kiln) -> None:
    """Between two ellipses matched by parameter every section is an ellipse with linear half axes."""
    lower = "{ ellipse = { radii = [1.0, 0.5] } }"
    upper = "{ ellipse = { radii = [0.4, 0.9], center = [0.3, -0.2, 2] } }"
    spec = f'across = "linear"\nmatching = "parameter"\nalign = false\nprofiles = [{lower}, {upper}]\n'
    baked = kiln.bake(f"tolerance = 1e-3\n[shape.s.loft]\n{spec}")
    points, _ = baked.mesh("s")
    v = points[:, 2] / 2.0
    a, b = 1.0 - 0.6 * v, 0.5 + 0.4 * v
    away = np.hypot((points[:, 0] - 0.3 * v) / a, (points[:, 1] + 0.2 * v) / b)
    np.testing.assert_allclose(away, 1.0, atol=1e-5)
    t = np.linspace(0.0, 1.0, 10_001)
    volume = 2.0 * np.pi * trapezoid((1.0 - 0.6 * t) * (0.5 + 0.4 * t), t)
    assert baked.shape("s")["volume"] == pytest.approx(volume, rel=3e-3)


def test_round_tip_is_level(kiln: Kiln) -> None:
    """All normals near a round tip point along the axis."""
    spec = f'start = "round"\nend = "round"\nprofiles = [[0, 0, -1], {circle(1.0, 0.0)}, [0, 0, 1]]\n'
    baked = kiln.bake(f"tolerance = 1e-4\n[shape.s.loft]\n{spec}")
    points, triangles = baked.mesh("s")
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    near = np.linalg.norm(corners.mean(axis=1) - [0.0, 0.0, 1.0], axis=1) < 0.05
    assert near.sum() > 5
    assert normals[near, 2].min() > 0.99
