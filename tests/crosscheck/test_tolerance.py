"""The certified tolerance: no point of a mesh is further from the true surface than the report's bound.

The true surfaces are closed forms written here; the points are spread densely over every triangle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from sampled import area, bezier, exponent, revolved, spread, to_polyline, to_profile, volume

if TYPE_CHECKING:
    from collections.abc import Callable

    from kiln import Baked, Kiln
    from sampled import Points

TOLERANCES = [0.02, 0.006, 0.002, 0.0006]
# The written positions are single precision: half a unit in the last place of a coordinate near 2.
WRITTEN = 2.4e-7

VASE = [[0.0, 0.0], [0.9, 0.0], [1.2, 0.5], [1.0, 1.0], [0.8, 1.5], [0.5, 1.6], [0.0, 2.0]]
BALL = "[shape.s.sphere]\nradius = 1\n"
TUBE = "[shape.s.cylinder]\nradius = 0.5\nheight = 2\n"
RING = '[curve.c.circle]\nradius = 0.4\ncenter = [1.2, 0]\n[shape.s.revolve]\nprofile = "c"\n'
POT = f'[curve.c.bezier]\npoints = {VASE}\n[shape.s.revolve]\nprofile = "c"\n'
COIL = (
    "[curve.p.helix]\nradius = 1\npitch = 0.6\nturns = 2\n"
    '[shape.s.sweep]\nprofile = { circle = { radius = 0.15 } }\npath = "p"\n'
)


def pot_profile(t: Points) -> Points:
    """The pot's outline over both of its Beziers."""
    low, high = bezier(VASE[:4], 2 * t), bezier(VASE[3:], 2 * t - 1)
    return np.where((t < 0.5)[:, None], low, high)


def ball(points: Points) -> Points:
    return np.abs(np.linalg.norm(points, axis=1) - 1)


def tube(points: Points) -> Points:
    side = np.abs(np.hypot(points[:, 0], points[:, 2]) - 0.5)
    ends = np.abs(np.abs(points[:, 1]) - 1)
    return np.minimum(side, np.where(np.hypot(points[:, 0], points[:, 2]) <= 0.5, ends, np.inf))


def ring(points: Points) -> Points:
    return np.abs(np.hypot(np.hypot(points[:, 0], points[:, 2]) - 1.2, points[:, 1]) - 0.4)


def pot(points: Points) -> Points:
    return to_profile(points, pot_profile(np.linspace(0, 1, 20_001)))


def coil(points: Points) -> Points:
    """Distance to the tube about the helix; points of the two flat ends count as on it."""
    turn = np.linspace(0, 4 * np.pi, 40_001)
    down = np.column_stack([np.cos(turn), 0.6 * turn / (2 * np.pi), -np.sin(turn)])
    up = down * [1, 1, -1]
    near = min((down, up), key=lambda curve: np.abs(to_polyline(points[::50], curve) - 0.15).max())
    distance = to_polyline(points, near)
    inward = np.minimum(np.abs(points[:, 1]), np.abs(points[:, 1] - 1.2)) < 0.16
    return np.where(inward & (distance < 0.15), 0.0, np.abs(distance - 0.15))


SURFACES: dict[str, tuple[str, Callable[[Points], Points]]] = {
    "sphere": (BALL, ball),
    "cylinder": (TUBE, tube),
    "torus": (RING, ring),
    "vase": (POT, pot),
    "coil": (COIL, coil),
}
# (area, volume) by closed form (Archimedes, Pappus) or by quadrature.
EXACT = {
    "sphere": (4 * np.pi, 4 / 3 * np.pi),
    "cylinder": (2 * np.pi * 0.5 * 2 + 2 * np.pi * 0.25, np.pi * 0.25 * 2),
    "torus": (4 * np.pi**2 * 1.2 * 0.4, 2 * np.pi**2 * 1.2 * 0.16),
    "vase": revolved(pot_profile),
    "coil": (
        2 * np.pi * 0.15 * 2 * np.hypot(2 * np.pi, 0.6) + 2 * np.pi * 0.15**2,
        np.pi * 0.15**2 * 2 * np.hypot(2 * np.pi, 0.6),
    ),
}


def baked(kiln: Kiln, spec: str, tolerance: float, *options: str) -> Baked:
    return kiln.bake(f"tolerance = {tolerance}\n{spec}", *options)


@pytest.mark.parametrize("name", SURFACES)
def test_no_point_leaves_the_bound(kiln: Kiln, name: str) -> None:
    spec, distance = SURFACES[name]
    for tolerance in TOLERANCES:
        asset = baked(kiln, spec, tolerance)
        deviation = asset.shape("s")["deviation"]
        assert deviation["tolerance"] == pytest.approx(tolerance)
        assert deviation["bound"] <= tolerance
        worst = distance(spread(*asset.mesh("s"))).max()
        assert worst <= deviation["bound"] + WRITTEN, f"{name} at {tolerance}: {worst}"


@pytest.mark.parametrize("name", SURFACES)
def test_measured_deviation_is_the_independent_one(kiln: Kiln, name: str) -> None:
    spec, distance = SURFACES[name]
    asset = baked(kiln, spec, 0.004, "--measure")
    measured = asset.shape("s")["deviation"]["measured"]
    worst = distance(spread(*asset.mesh("s"), steps=12)).max()
    assert measured == pytest.approx(worst, rel=0.05, abs=1e-6)


@pytest.mark.parametrize("name", SURFACES)
def test_area_and_volume_converge_with_the_tolerance(kiln: Kiln, name: str) -> None:
    spec, _ = SURFACES[name]
    area_errors, volume_errors = [], []
    for tolerance in TOLERANCES:
        shape = baked(kiln, spec, tolerance).shape("s")
        area_errors.append(abs(shape["area"] - EXACT[name][0]))
        volume_errors.append(abs(shape["volume"] - EXACT[name][1]))
    assert exponent(TOLERANCES, area_errors) >= 0.9, area_errors
    assert exponent(TOLERANCES, volume_errors) >= 0.9, volume_errors


@pytest.mark.parametrize("name", SURFACES)
def test_every_surface_is_closed_and_outward(kiln: Kiln, name: str) -> None:
    asset = baked(kiln, SURFACES[name][0], 0.01)
    shape = asset.shape("s")
    assert shape["closed"]
    assert shape["manifold"]
    assert volume(*asset.mesh("s")) > 0
    assert area(*asset.mesh("s")) == pytest.approx(shape["area"], rel=1e-6)


def test_true_surface_is_near_the_mesh_too(kiln: Kiln) -> None:
    """The other side of the Hausdorff distance: no part of the surface is left out."""
    import trimesh

    turn = np.random.default_rng(1).normal(size=(2000, 3))
    truth = turn / np.linalg.norm(turn, axis=1)[:, None]
    mesh = trimesh.Trimesh(*baked(kiln, BALL, 0.01).mesh("s"), process=False)
    away = trimesh.proximity.closest_point(mesh, truth)[1]
    assert away.max() <= 0.011


def test_neck_has_fewer_segments_than_belly(kiln: Kiln) -> None:
    spec = '[curve.c.polyline]\npoints = [[0.05, 0], [1, 0.5], [1, 1], [0.05, 1.5]]\n[shape.s.revolve]\nprofile = "c"\n'
    points, _ = baked(kiln, spec, 0.001).mesh("s")
    radius = np.hypot(points[:, 0], points[:, 2])
    neck = (np.abs(radius - 0.05) < 1e-3).sum() / 2
    belly = (np.abs(radius - 1) < 1e-3).sum() / 2
    assert neck < belly / 2


def test_uneven_profile_takes_fewer_triangles_than_a_grid(kiln: Kiln) -> None:
    """A fixed grid of the same deviation: as many segments around everywhere as the widest place needs."""
    asset = baked(kiln, POT, 0.001)
    worst = pot(spread(*asset.mesh("s"))).max()
    own = asset.shape("s")["triangles"]
    for across in range(8, 200, 2):
        grid = kiln.bake(
            POT.replace("[shape.s.revolve]", f"[shape.s]\nsegments = [{2 * across}, {across}]\n[shape.s.revolve]")
        )
        if pot(spread(*grid.mesh("s"), steps=4)).max() <= worst:
            assert own < grid.shape("s")["triangles"]
            return
    pytest.fail("no grid was fine enough")
