"""Splines, B-splines and NURBS as `kiln sample` gives them, against scipy and geomdl."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from geomdl import NURBS, BSpline
from scipy.interpolate import BSpline as ScipyBSpline
from scipy.interpolate import CubicSpline
from test_curves import ACCURACY, POINTS, knots, sampled

if TYPE_CHECKING:
    from kiln import Kiln

ENDS = {
    "natural": ('"natural"', (2, np.zeros(3))),
    "clamped": ('"clamped"', (1, np.zeros(3))),
    "first": ("{ first = [1, -2, 0.5] }", (1, np.array([1, -2, 0.5]))),
    "second": ("{ second = [-1, 3, 2] }", (2, np.array([-1.0, 3, 2]))),
}


def assert_spline(found: dict[str, Any], spline: CubicSpline, at: Any) -> None:
    """Points and both derivatives of samples over the whole domain of a scipy spline."""
    span = spline.x[-1] - spline.x[0]
    np.testing.assert_allclose(found["points"], spline(at), atol=ACCURACY * 10)
    np.testing.assert_allclose(found["first"], spline(at, 1) * span, atol=ACCURACY * 100)
    np.testing.assert_allclose(found["second"], spline(at, 2) * span**2, atol=ACCURACY * 1e4)


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("end", ENDS)
def test_ends_are_scipys(kiln: Kiln, start: str, end: str) -> None:
    points = np.array(POINTS)
    t = knots(points, 0.5)
    spline = CubicSpline(t, points, bc_type=(ENDS[start][1], ENDS[end][1]))
    shares = np.linspace(0, 1, 31)
    lines = f'parameters = "centripetal"\nstart = {ENDS[start][0]}\nend = {ENDS[end][0]}\n'
    found = sampled(kiln, f"[curve.c.spline]\npoints = {POINTS}\n{lines}", shares)
    assert_spline(found, spline, shares * t[-1])


@pytest.mark.parametrize("count", [2, 3, 4, 6])
def test_not_a_knot_is_scipys(kiln: Kiln, count: int) -> None:
    points = np.array(POINTS[:count])
    t = knots(points, 1.0)
    spline = CubicSpline(t, points, bc_type="not-a-knot")
    shares = np.linspace(0, 1, 31)
    spec = f'[curve.c.spline]\npoints = {POINTS[:count]}\nends = "not-a-knot"\n'
    assert_spline(sampled(kiln, spec, shares), spline, shares * t[-1])


def test_coefficients_of_a_function_spline_are_scipys(kiln: Kiln) -> None:
    x, y = np.array([0.0, 1.0, 1.5, 4.0, 5.0]), np.array([2.0, -1.0, 0.5, 3.0, 2.0])
    table = np.column_stack([x, y]).tolist()
    for lines, rule in (
        ('ends = "not-a-knot"', "not-a-knot"),
        ("periodic = true", "periodic"),
    ):
        kiln.write(f"[curve.c.function-spline]\npoints = {table}\n{lines}\n")
        pieces = kiln.sample("--curve", "c")["function"]
        spline = CubicSpline(x, y, bc_type=rule)
        found = np.array([[piece[name] for name in "dcba"] for piece in pieces]).T
        np.testing.assert_allclose(found, spline.c, atol=1e-11)
        assert [piece["from"] for piece in pieces] == x[:-1].tolist()


CONTROL = [
    [5.0, 10, 0],
    [15, 25, 2],
    [30, 30, 5],
    [45, 5, 1],
    [55, 5, -3],
    [70, 40, 0],
    [60, 60, 4],
]
WEIGHTS = [1.0, 2.0, 0.5, 3.0, 1.0, 0.25, 1.0]


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 6])
def test_b_splines_are_scipys_and_geomdls(kiln: Kiln, degree: int) -> None:
    inner = np.linspace(0, 1, len(CONTROL) - degree + 1)[1:-1] ** 2
    vector = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)]).tolist()
    shares = np.linspace(0, 1, 53)
    spec = f"[curve.c.b-spline]\npoints = {CONTROL}\ndegree = {degree}\nknots = {vector}\n"
    found = sampled(kiln, spec, shares)
    spline = ScipyBSpline(vector, np.array(CONTROL), degree)
    np.testing.assert_allclose(found["points"], spline(shares), atol=1e-11)
    np.testing.assert_allclose(found["first"][1:-1], spline(shares[1:-1], 1), atol=1e-8)
    other = BSpline.Curve()
    other.degree, other.ctrlpts, other.knotvector = degree, CONTROL, vector
    np.testing.assert_allclose(found["points"], other.evaluate_list(shares.tolist()), atol=1e-11)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_nurbs_are_geomdls(kiln: Kiln, degree: int) -> None:
    inner = np.linspace(0, 1, len(CONTROL) - degree + 1)[1:-1] ** 2
    vector = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)]).tolist()
    shares = np.linspace(0, 0.999, 41)
    lines = f"degree = {degree}\nknots = {vector}\nweights = {WEIGHTS}\n"
    found = sampled(kiln, f"[curve.c.nurbs]\npoints = {CONTROL}\n{lines}", shares)
    other = NURBS.Curve()
    other.degree, other.ctrlpts, other.weights, other.knotvector = (
        degree,
        CONTROL,
        WEIGHTS,
        vector,
    )
    expected = np.array([other.derivatives(share, 2) for share in shares.tolist()])
    for order, name in enumerate(("points", "first", "second")):
        scale = np.abs(expected[:, order]).max()
        np.testing.assert_allclose(found[name], expected[:, order], atol=1e-9 * scale)


def test_four_points_two_at_infinity_are_a_circle(kiln: Kiln) -> None:
    spec = (
        "[curve.c.nurbs]\npoints = [[1, 0], [0, 1], [-1, 0], [0, -1]]\nweights = [1, 0, 1, 0]\n"
        "degree = 2\nclosed = true\nknots = [0, 1, 1, 2, 2]\n"
    )
    found = sampled(kiln, spec, np.linspace(0, 1, 101))
    np.testing.assert_allclose(np.linalg.norm(found["points"], axis=1), 1.0, atol=1e-15)
    assert found["length"] == pytest.approx(2 * np.pi, rel=1e-12)
    assert [sample["curvature"] for sample in found["samples"]] == pytest.approx([1.0] * 101, rel=1e-12)


def test_closed_b_splines_are_scipys_periodic_ones(kiln: Kiln) -> None:
    count, degree = len(CONTROL), 3
    wrapped = np.array([*CONTROL, *CONTROL[:degree]])
    spline = ScipyBSpline(np.arange(-degree, count + degree + 1.0), wrapped, degree)
    shares = np.linspace(0, 1, 61)
    found = sampled(kiln, f"[curve.c.b-spline]\npoints = {CONTROL}\nclosed = true\n", shares)
    np.testing.assert_allclose(found["points"], spline(shares * count), atol=1e-11)
    assert found["closed"] is True
    assert found["seam"] == "C2"
