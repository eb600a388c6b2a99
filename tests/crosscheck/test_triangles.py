"""Bezier triangles: points are the sums of Bernstein polynomials, areas those of quadrature."""

from __future__ import annotations

from math import factorial
from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln


def net(degree: int, seed: int) -> NDArray[np.float64]:
    """Points over a flat triangle, with noise."""
    noise = np.random.default_rng(seed)
    places = [(row / degree, k / degree) for row in range(degree + 1) for k in range(row + 1)]
    return np.array([[1 - v, u, 0.0] for v, u in places]) + noise.normal(0, 0.08, (len(places), 3))


def surface(
    points: NDArray[np.float64], weights: NDArray[np.float64], b: tuple[float, float, float]
) -> NDArray[np.float64]:
    """The sum of points by the multinomial weights of all splits of the degree."""
    degree = int((np.sqrt(8 * len(points) + 1) - 3) / 2)
    total, divisor, number = np.zeros(3), 0.0, 0
    for row in range(degree + 1):
        for k in range(row + 1):
            i, j = degree - row, row - k
            count = factorial(degree) / (factorial(i) * factorial(j) * factorial(k))
            share = count * b[0] ** i * b[1] ** j * b[2] ** k * weights[number]
            total, divisor, number = total + share * points[number], divisor + share, number + 1
    return total / divisor


def written(points: NDArray[np.float64], weights: NDArray[np.float64] | None, tolerance: float) -> str:
    text = f"tolerance = {tolerance}\n[shape.a.bezier-triangles]\npoints = {points.tolist()}\n"
    return text if weights is None else text + f"weights = {weights.tolist()}\n"


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("rational", [False, True])
def test_points_are_sums_of_bernstein_polynomials(kiln: Kiln, degree: int, rational: bool) -> None:
    points = net(degree, degree)
    weights = np.random.default_rng(9).uniform(0.5, 2, len(points)) if rational else None
    kiln.write(written(points, weights, 1e-2))
    found = kiln.sample("--shape", "a", "--count", "9")
    known = np.ones(len(points)) if weights is None else weights
    assert len(found["samples"]) >= 9
    for place in found["samples"]:
        u, v = place["u"], place["v"]
        expected = surface(points, known, (1 - v, v * (1 - u), v * u))
        assert np.abs(np.array(place["point"]) - expected).max() <= 1e-12


def test_area_is_that_of_quadrature(kiln: Kiln) -> None:
    points = net(3, 1)
    ones = np.ones(len(points))
    count = 400
    # Small flat triangles of a regular net: their sum converges with the square of their size.
    areas = []
    for steps in (count // 10, count // 5):
        rows = [
            [surface(points, ones, (1 - r / steps, (r - k) / steps, k / steps)) for k in range(r + 1)]
            for r in range(steps + 1)
        ]
        area = 0.0
        for r in range(steps):
            for k in range(r + 1):
                area += triangle(rows[r][k], rows[r + 1][k], rows[r + 1][k + 1])
                if k < r:
                    area += triangle(rows[r][k], rows[r][k + 1], rows[r + 1][k + 1])
        areas.append(area)
    expected = areas[1] + (areas[1] - areas[0]) / 3
    errors = [
        abs(kiln.bake(written(points, None, tolerance)).shape("a")["area"] / expected - 1)
        for tolerance in (1e-2, 1e-3, 1e-4)
    ]
    assert errors[2] <= 2e-4
    assert errors[2] < errors[0]


def triangle(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(np.cross(b - a, c - a))) / 2
