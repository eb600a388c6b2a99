"""Curves as `kiln sample` gives them, against scipy, closed forms and the reference cases."""

from __future__ import annotations

import gzip
import json
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from sampled import bezier

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from kiln import Kiln

POINTS = [
    [0.0, 0.0, 0.0],
    [1.0, 2.0, 0.5],
    [3.0, 2.5, 1.0],
    [3.5, 0.5, 2.0],
    [6.0, 1.0, 0.0],
    [6.5, 1.25, 0.5],
]
ACCURACY = 1e-9  # relative to the curve's size: both sides compute in double precision


def sampled(kiln: Kiln, spec: str, shares: NDArray[np.float64], name: str = "c") -> dict[str, Any]:
    """A curve's samples at shares of its domain, as arrays, derivatives by the share."""
    kiln.write(spec)
    start, end = kiln.sample("--curve", name, "--count", "2")["domain"]
    at = [f"--at={start + (end - start) * share!r}" for share in shares.tolist()]
    found = kiln.sample("--curve", name, *at)
    samples = found["samples"]
    assert len(samples) == len(shares)
    span = end - start
    return {
        **found,
        "points": np.array([s["point"] for s in samples]),
        "first": np.array([s["first"] for s in samples]) * span,
        "second": np.array([s["second"] for s in samples]) * span**2,
    }


def knots(points: NDArray[np.float64], power: float) -> NDArray[np.float64]:
    """Parameters in proportion to a power of the distance between points."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1) ** power
    return np.concatenate([[0.0], np.cumsum(steps)])


def length(first: Any, start: float, end: float, breaks: NDArray[np.float64]) -> float:
    """Arc length by adaptive quadrature of the speed, piece by piece."""
    inside = [start, *[b for b in breaks if start < b < end], end]
    speed = lambda t: float(np.linalg.norm(first(t)))  # noqa: E731 -- only handed on
    return sum(quad(speed, a, b, epsabs=1e-12)[0] for a, b in pairwise(inside))


@pytest.mark.parametrize(("parameters", "power"), [("uniform", 0.0), ("chordal", 1.0), ("centripetal", 0.5)])
def test_natural_spline_is_scipys(kiln: Kiln, parameters: str, power: float) -> None:
    points = np.array(POINTS)
    t = knots(points, power)
    spline = CubicSpline(t, points, bc_type="natural")
    shares = np.linspace(0, 1, 83)
    spec = f'[curve.c.natural-spline]\npoints = {POINTS}\nparameters = "{parameters}"\n'
    found = sampled(kiln, spec, shares)
    at = shares * t[-1]
    np.testing.assert_allclose(found["points"], spline(at), atol=ACCURACY * 10)
    np.testing.assert_allclose(found["first"], spline(at, 1) * t[-1], atol=ACCURACY * 100)
    np.testing.assert_allclose(found["second"], spline(at, 2) * t[-1] ** 2, atol=ACCURACY * 1e4)
    assert found["length"] == pytest.approx(length(lambda u: spline(u, 1), 0, t[-1], t), rel=1e-9)
    assert found["closed"] is False


def test_natural_spline_is_chordal_when_nothing_is_said(kiln: Kiln) -> None:
    shares = np.linspace(0, 1, 17)
    silent = sampled(kiln, f"[curve.c.natural-spline]\npoints = {POINTS}\n", shares)
    spoken = sampled(kiln, f'[curve.c.natural-spline]\npoints = {POINTS}\nparameters = "chordal"\n', shares)
    assert np.array_equal(silent["points"], spoken["points"])


def test_closed_spline_is_scipys_periodic_one(kiln: Kiln) -> None:
    points = np.array([*POINTS, POINTS[0]])
    t = knots(points, 1.0)
    spline = CubicSpline(t, points, bc_type="periodic")
    shares = np.linspace(0, 1, 61)
    found = sampled(kiln, f"[curve.c.natural-spline]\npoints = {POINTS}\nclosed = true\n", shares)
    np.testing.assert_allclose(found["points"], spline(shares * t[-1]), atol=ACCURACY * 10)
    np.testing.assert_allclose(found["second"][0], found["second"][-1], atol=ACCURACY * 1e4)
    assert found["closed"] is True


def test_bezier_of_any_degree_is_de_casteljaus(kiln: Kiln) -> None:
    for degree in (1, 2, 3, 5):
        control = POINTS[: degree + 1]
        shares = np.linspace(0, 1, 41)
        found = sampled(kiln, f"[curve.c.bezier]\npoints = {control}\ndegree = {degree}\n", shares)
        np.testing.assert_allclose(found["points"], bezier(control, shares), atol=ACCURACY * 10)


def test_piecewise_bezier_joins_its_pieces(kiln: Kiln) -> None:
    control = [[0, 0], [1, 2], [2, 2], [3, 0], [4, -2], [5, -1], [6, 0.5]]
    found = sampled(kiln, f"[curve.c.bezier]\npoints = {control}\n", np.linspace(0, 1, 21))
    pieces = [bezier(control[i : i + 4], np.linspace(0, 1, 11)) for i in (0, 3)]
    expected = np.concatenate([pieces[0], pieces[1][1:]])
    np.testing.assert_allclose(found["points"][:, :2], expected, atol=ACCURACY * 10)


def test_circle_arc_ellipse_and_helix_lie_where_their_formulas_say(kiln: Kiln) -> None:
    shares = np.linspace(0, 1, 37)
    circle = sampled(kiln, "[curve.c.circle]\nradius = 2\ncenter = [1, -1]\n", shares)
    away = circle["points"][:, :2] - [1, -1]
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), 2.0, atol=ACCURACY)
    assert circle["length"] == pytest.approx(4 * np.pi, rel=1e-9)
    assert circle["closed"] is True

    arc = sampled(kiln, "[curve.c.arc]\ncenter = [0, 0]\nradius = 3\nfrom = 30\nto = 120\n", shares)
    turned = np.degrees(np.arctan2(arc["points"][:, 1], arc["points"][:, 0]))
    np.testing.assert_allclose(turned, 30 + 90 * shares, atol=1e-9)
    assert arc["length"] == pytest.approx(1.5 * np.pi, rel=1e-9)

    ellipse = sampled(kiln, "[curve.c.ellipse]\nradii = [3, 1]\n", shares)["points"]
    np.testing.assert_allclose((ellipse[:, 0] / 3) ** 2 + ellipse[:, 1] ** 2, 1.0, atol=ACCURACY)

    helix = sampled(kiln, "[curve.c.helix]\nradius = 2\npitch = 0.5\nturns = 3\n", shares)
    x, y, z = helix["points"].T
    np.testing.assert_allclose(np.hypot(x, z), 2.0, atol=ACCURACY)
    np.testing.assert_allclose(y, 1.5 * shares, atol=ACCURACY)
    assert helix["length"] == pytest.approx(3 * np.hypot(4 * np.pi, 0.5), rel=1e-9)


def test_arc_through_three_points_passes_through_them(kiln: Kiln) -> None:
    through = [[0.0, 0.0, 1.0], [1.0, 1.0, 2.0], [2.0, 0.5, 0.0]]
    found = sampled(kiln, f"[curve.c.arc]\npoints = {through}\n", np.linspace(0, 1, 4001))["points"]
    for point in through:
        assert np.linalg.norm(found - point, axis=1).min() < 2e-3
    np.testing.assert_allclose(found[[0, -1]], [through[0], through[2]], atol=1e-12)


def test_derivatives_are_those_of_the_points(kiln: Kiln) -> None:
    curves = {
        "natural-spline": f"points = {POINTS}",
        "helix": "radius = 1\npitch = 0.3\nturns = 2\nend-radius = 0.25",
        "ellipse": "radii = [2, 0.5]",
        "bezier": f"points = {POINTS}\ndegree = 5",
    }
    step, shares = 1e-5, np.linspace(0.06, 0.94, 23)
    for kind, fields in curves.items():
        at = np.concatenate([shares - step, shares, shares + step])
        found = sampled(kiln, f"[curve.c.{kind}]\n{fields}\n", at)
        before, here, after = np.split(found["points"], 3)
        scale = np.abs(found["first"]).max()
        central = (after - before) / (2 * step)
        np.testing.assert_allclose(np.split(found["first"], 3)[1], central, atol=1e-7 * scale, err_msg=kind)
        bend = (after - 2 * here + before) / step**2
        np.testing.assert_allclose(np.split(found["second"], 3)[1], bend, atol=1e-3 * scale, err_msg=kind)


def test_path_joins_its_segments(kiln: Kiln) -> None:
    spec = """
[curve.c.path]
start = [0.0, 0.0]
segments = [
  { line = [[1.0, 0.0]] },
  { arc = { center = [1.0, 1.0], angle = 90.0 } },
  { bezier = [[2.0, 2.0], [1.0, 3.0], [0.0, 3.0]] },
]
joints = ["smooth", "smooth"]
"""
    found = sampled(kiln, spec, np.linspace(0, 1, 3001))
    points = found["points"][:, :2]
    for corner in ([0, 0], [1, 0], [2, 1], [0, 3]):
        assert np.linalg.norm(points - corner, axis=1).min() < 2e-3, corner
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).max() < 0.02


def reference(cases: Path, kind: str) -> list[dict[str, Any]]:
    """The reference curves of one kind."""
    text = gzip.decompress((cases / "curves" / "curves.json.gz").read_bytes())
    return [case for case in json.loads(text)["cases"] if case["kind"] == kind]


def check_case(kiln: Kiln, spec: str, case: dict[str, Any]) -> None:
    """Hold points, derivatives and length against one reference curve."""
    t = np.array(case["t"])
    start, span = t.min(), np.ptp(t)
    found = sampled(kiln, spec, (t - start) / span)
    points = np.array(case["p"])
    width, size = points.shape[1], np.abs(points).max()
    np.testing.assert_allclose(found["points"][:, :width], points, atol=1e-9 * size, err_msg=case["name"])
    derivatives = np.array(case["dp_dt"]) * span
    scale = np.abs(derivatives).max()
    np.testing.assert_allclose(found["first"][:, :width], derivatives, atol=1e-9 * scale, err_msg=case["name"])
    assert found["length"] == pytest.approx(case["arc_length"], rel=1e-8), case["name"]


@pytest.mark.cases
def test_reference_splines(kiln: Kiln, cases: Path) -> None:
    found = [*reference(cases, "natural_cubic_spline"), *reference(cases, "periodic_cubic_spline")]
    assert len(found) == 7
    for case in found:
        given = case["input"]
        closed = str(given.get("closed", False)).lower()
        spec = (
            f"[curve.c.natural-spline]\npoints = {given['points']}\n"
            f"parameters = {[float(p) for p in given['parameters']]}\nclosed = {closed}\n"
        )
        check_case(kiln, spec, case)


@pytest.mark.cases
def test_reference_beziers(kiln: Kiln, cases: Path) -> None:
    found = reference(cases, "bezier")
    assert len(found) == 4
    for case in found:
        given = case["input"]
        check_case(kiln, f"[curve.c.bezier]\npoints = {given['points']}\ndegree = {given['degree']}\n", case)
