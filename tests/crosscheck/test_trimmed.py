"""Trimmed surfaces: areas by quadrature over the parameters, borders on the lines, nothing beyond them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import dblquad

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

# Control points over the unit square: rows of equal y, and heights that bend in both directions.
HEIGHTS = np.array([[0.0, 0.4, -0.2, 0.1], [0.3, 0.9, 0.1, 0.0], [-0.1, 0.2, 0.8, 0.4], [0.0, -0.3, 0.2, 0.5]])
SPEC = """tolerance = {tolerance}
[shape.skin.patches]
control = {control}
[shape.a.trimmed]
of = "skin"
{trim}
"""
DISK = "profile = {{ circle = {{ radius = {r}, center = [0.45, 0.55] }} }}"
HOLE = "holes = [{{ circle = {{ radius = {r}, center = [0.45, 0.55] }} }}]"


def spec(trim: str, tolerance: float) -> str:
    """A bicubic patch over the unit square, which its x and y run over evenly."""
    rows = [[[i / 3, j / 3, float(HEIGHTS[j, i])] for i in range(4)] for j in range(4)]
    return SPEC.format(tolerance=tolerance, control=rows, trim=trim)


def bernstein(t: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cubic Bernstein polynomials and their derivatives."""
    s = 1 - t
    values = np.array([s**3, 3 * s * s * t, 3 * s * t * t, t**3])
    slopes = np.array([-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t])
    return values, slopes


def height(u: float, v: float) -> float:
    return float(bernstein(v)[0] @ HEIGHTS @ bernstein(u)[0])


def element(u: float, v: float) -> float:
    """Area of the graph over a unit of area."""
    (b, db), (c, dc) = bernstein(u), bernstein(v)
    return float(np.sqrt(1 + (c @ HEIGHTS @ db) ** 2 + (dc @ HEIGHTS @ b) ** 2))


def disk_area(radius: float) -> float:
    polar = lambda t, r: r * element(0.45 + r * np.cos(t), 0.55 + r * np.sin(t))  # noqa: E731 -- the integrand
    return dblquad(polar, 0, radius, 0, 2 * np.pi, epsabs=1e-10)[0]


def test_areas_are_those_of_quadrature(kiln: Kiln) -> None:
    radius = 0.3
    lid, whole = disk_area(radius), dblquad(element, 0, 1, 0, 1)[0]
    errors = []
    for tolerance in (1e-2, 1e-3, 1e-4):
        disk = kiln.bake(spec(DISK.format(r=radius), tolerance)).shape("a")
        rest = kiln.bake(spec(HOLE.format(r=radius), tolerance)).shape("a")
        assert (disk["boundary-loops"], rest["boundary-loops"]) == (1, 2)
        errors.append(abs(disk["area"] / lid - 1))
        assert abs(rest["area"] / (whole - lid) - 1) <= 20 * tolerance
    assert errors[-1] <= 1e-3
    assert np.polyfit(np.log([1e-2, 1e-3, 1e-4]), np.log(errors), 1)[0] >= 0.9


def test_points_lie_on_the_surface_inside_of_the_line(kiln: Kiln) -> None:
    points, triangles = kiln.bake(spec(DISK.format(r=0.3), 1e-3)).mesh("a")
    expected = np.array([height(x, y) for x, y, _ in points])
    assert np.abs(points[:, 2] - expected).max() <= 1e-6
    radii = np.hypot(points[:, 0] - 0.45, points[:, 1] - 0.55)
    assert radii.max() <= 0.3 + 1e-6
    # Edges that one triangle alone has are the border: all of their ends stand on the circle.
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    ends, counts = np.unique(edges, axis=0, return_counts=True)
    border = np.unique(ends[counts == 1])
    assert np.abs(radii[border] - 0.3).max() <= 1e-6
    assert set(np.flatnonzero(radii > 0.3 - 1e-6)) == set(border)


# A cylinder about the z axis; u comes round after 1.
TUBE = """tolerance = 1e-3
[shape.skin.loft]
caps = false
profiles = [
  {{ curve = {{ circle = {{ radius = 1 }} }} }},
  {{ curve = {{ circle = {{ radius = 1 }} }}, at = [0, 0, 2] }},
]
[shape.a.trimmed]
of = "skin"
{trim}
"""


def test_lines_run_over_the_seam(kiln: Kiln) -> None:
    """A cylinder unrolled is a strip 2 pi wide and 2 high: ellipses in its parameters have the areas of the plane."""
    ellipse = np.pi * (0.1 * 2 * np.pi) * (0.3 * 2)
    for center in (0.0, 0.37, 1.0, -0.03, 2.98):
        hole = f"{{ ellipse = {{ radii = [0.1, 0.3], center = [{center}, 0.5] }} }}"
        rest = kiln.bake(TUBE.format(trim=f"holes = [{hole}]")).shape("a")
        lid = kiln.bake(TUBE.format(trim=f"profile = {hole}")).shape("a")
        assert (rest["components"], rest["boundary-loops"], lid["boundary-loops"]) == (1, 3, 1)
        assert abs(lid["area"] / ellipse - 1) <= 5e-3
        assert abs((rest["area"] + lid["area"]) / (4 * np.pi) - 1) <= 5e-3
        points, _ = kiln.bake(TUBE.format(trim=f"profile = {hole}")).mesh("a")
        turn = (np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi) - center + 0.5) % 1 - 0.5
        inside = (turn / 0.1) ** 2 + ((points[:, 2] / 2 - 0.5) / 0.3) ** 2
        assert inside.max() <= 1 + 1e-5
