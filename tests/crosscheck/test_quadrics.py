"""Quadrics: every written point satisfies the equation, areas are those of quadrature, the report names the kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

if TYPE_CHECKING:
    from kiln import Kiln

NAMES = ("xx", "yy", "zz", "xy", "yz", "zx", "x", "y", "z", "constant")


def spec(factors: dict[str, float], box: float | None, tolerance: float, *, caps: bool = False) -> str:
    """A quadric inside the cube of a half width."""
    lines = [f"{name} = {value!r}" for name, value in factors.items()]
    if box is not None:
        lines.append(f"within = {{ min = {[-box] * 3}, max = {[box] * 3} }}")
    lines.append(f"caps = {str(caps).lower()}")
    return f"tolerance = {tolerance}\n[shape.a.quadric]\n" + "\n".join(lines) + "\n"


def value(factors: dict[str, float], points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The sum of the equation at points, and the length of its gradient."""
    xx, yy, zz, xy, yz, zx, bx, by, bz, c = (factors.get(name, 0.0) for name in NAMES)
    a = np.array([[2 * xx, xy, zx], [xy, 2 * yy, yz], [zx, yz, 2 * zz]]) / 2
    b = np.array([bx, by, bz])
    sums = np.einsum("ij,jk,ik->i", points, a, points) + points @ b + c
    return sums, np.linalg.norm(2 * points @ a + b, axis=1)


KINDS = {
    "ellipsoid": {"xx": 1.0, "yy": 0.5, "zz": 2.0, "xy": 0.3, "constant": -0.5},
    "hyperboloid of one sheet": {"xx": 1.0, "yy": -1.0, "zz": 2.0, "zx": 0.5, "constant": -0.2},
    "hyperboloid of two sheets": {"xx": -1.0, "yy": 1.0, "zz": -2.0, "yz": 0.4, "constant": -0.1},
    "cone": {"xx": 1.0, "yy": -1.0, "zz": 0.7, "xy": 0.2},
    "elliptic paraboloid": {"xx": 1.0, "zz": 0.5, "y": -1.0, "constant": 0.1},
    "hyperbolic paraboloid": {"xy": 1.0, "z": -1.0, "x": 0.1},
    "elliptic cylinder": {"xx": 1.0, "yy": 2.0, "constant": -0.4},
    "hyperbolic cylinder": {"xy": 1.0, "constant": -0.1},
    "parabolic cylinder": {"xx": 1.0, "y": -1.0, "z": 0.5},
    "pair of crossing planes": {"xx": 1.0, "yy": -2.0},
    "pair of parallel planes": {"xx": 1.0, "constant": -0.25},
    "plane": {"x": 1.0, "y": 2.0, "z": 0.5, "constant": 0.3},
}


@pytest.mark.parametrize("name", KINDS)
def test_written_points_satisfy_the_equation(kiln: Kiln, name: str) -> None:
    baked = kiln.bake(spec(KINDS[name], 1.0, 1e-3))
    points, triangles = baked.mesh("a")
    assert baked.report["quadrics"]["a"]["surface"] == name
    assert len(triangles) > 0
    sums, slopes = value(KINDS[name], points)
    size = np.linalg.norm(np.ptp(points, axis=0))
    # The distance to first order; at an apex, where the slope vanishes, the root of the sum.
    away = np.minimum(np.abs(sums) / np.maximum(slopes, 1e-300), np.sqrt(np.abs(sums)))
    assert away.max() <= 1e-6 * size
    # Nothing leaves the box, which is moved outward by a billionth of its size.
    assert np.abs(points).max() <= 1 + 1e-7


@pytest.mark.parametrize("name", KINDS)
def test_a_ball_holds_what_both_sides_of_a_quadric_share(kiln: Kiln, name: str) -> None:
    center, radius, tolerance = np.array([0.2, -0.1, 0.15]), 0.9, 2e-3
    within = f"within = {{ center = {center.tolist()}, radius = {radius} }}"
    volumes = []
    for sign in (1.0, -1.0):
        factors = {key: sign * factor for key, factor in KINDS[name].items()}
        text = spec(factors, None, tolerance, caps=True).replace("caps =", f"{within}\ncaps =")
        baked = kiln.bake(text)
        points, triangles = baked.mesh("a")
        depth = np.linalg.norm(points - center, axis=1) - radius
        sums, slopes = value(factors, points)
        on_quadric = np.minimum(np.abs(sums) / np.maximum(slopes, 1e-300), np.sqrt(np.abs(sums)))
        # Every point lies on the ball or on the quadric, inside of the ball and where the sum is not positive.
        assert np.minimum(np.abs(depth), on_quadric).max() <= 1e-6
        assert depth.max() <= 1e-6
        assert (sums / np.maximum(slopes, 1e-3)).max() <= 1e-5
        assert baked.shape("a")["closed"]
        corners = points[triangles] - center
        volumes.append(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)
        assert volumes[-1] > 0
    # Chords of both surfaces lie within the tolerance: of the ball, and of the face between, which is no larger.
    assert sum(volumes) == pytest.approx(4 / 3 * np.pi * radius**3, abs=tolerance * 3 * 4 * np.pi * radius**2)


def test_both_halves_of_a_cone_meet_in_its_apex(kiln: Kiln) -> None:
    points, _ = kiln.bake(spec({"xx": 1.0, "yy": -1.0, "zz": 1.0, "y": 0.2, "constant": -0.01}, 1.0, 1e-3)).mesh("a")
    apex = np.array([0.0, 0.1, 0.0])
    assert np.linalg.norm(points - apex, axis=1).min() <= 1e-8
    assert points[:, 1].min() < -0.5
    assert points[:, 1].max() > 0.9


def measured_area(kiln: Kiln, factors: dict[str, float], box: float | None, tolerance: float) -> float:
    return kiln.bake(spec(factors, box, tolerance)).shape("a")["area"]


def ellipsoid_element(t: float, p: float) -> float:
    """The area element of the half axes 1, 2, 3 at x = sin t cos p, y = 2 sin t sin p, z = 3 cos t."""
    sides = (6 * np.sin(t) * np.cos(p), 3 * np.sin(t) * np.sin(p), 2 * np.cos(t))
    return np.sin(t) * np.sqrt(sum(side * side for side in sides))


def areas() -> dict[str, tuple[dict[str, float], float | None, float]]:
    """Quadrics with their areas by quadrature."""
    ellipsoid = 8 * dblquad(ellipsoid_element, 0, np.pi / 2, 0, np.pi / 2)[0]
    # x^2 + z^2 - y^2 / 4 = 1 between y = -2 and 2, whose radius there is the root of 2.
    tower = quad(lambda y: 2 * np.pi * np.sqrt(1 + y * y * 5 / 16), -2, 2)[0]
    saddle = dblquad(lambda x, y: np.sqrt(1 + x * x + y * y), -1, 1, -1, 1)[0]
    return {
        "ellipsoid": ({"xx": 1.0, "yy": 0.25, "zz": 1 / 9, "constant": -1.0}, None, ellipsoid),
        "tower": ({"xx": 1.0, "yy": -0.25, "zz": 1.0, "constant": -1.0}, 2.0, tower),
        "saddle": ({"xy": 1.0, "z": -1.0}, 1.0, saddle),
    }


@pytest.mark.parametrize("name", ["ellipsoid", "tower", "saddle"])
def test_areas_converge_to_those_of_quadrature(kiln: Kiln, name: str) -> None:
    factors, box, expected = areas()[name]
    # Saddle-shaped parts lose at the rim what they gain inside: coarse ones are right by accident.
    tolerances = 10.0 ** np.arange(-2, -6, -1) if name == "saddle" else 3 * 10.0 ** np.arange(-2, -5, -1)
    errors = [abs(measured_area(kiln, factors, box, tolerance) / expected - 1) for tolerance in tolerances]
    exponent = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert exponent >= 0.9, errors
