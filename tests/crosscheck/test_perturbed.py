"""Perturbed patches against numpy: the equation at every vertex, closed skins, volumes and areas by quadrature."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sampled import exponent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kiln import Kiln

    Points = NDArray[np.float64]

OCTAHEDRON = (
    "points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]\n"
    "faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]\n"
)


@dataclass(frozen=True)
class Bump:
    """An ellipsoid's quadric, -1 in the middle, turned and moved, with bumps of its own."""

    half: tuple[float, float, float]
    at: tuple[float, float, float]
    factor: float
    rotate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bumps: Sequence[Bump] = field(default_factory=tuple)

    def depth(self, points: Points) -> Points:
        """Q where it is negative, 0 elsewhere."""
        turn = Rotation.from_euler("xyz", self.rotate, degrees=True)
        local = turn.inv().apply(np.atleast_2d(points) - self.at)
        inner = np.sum((local / self.half) ** 2, axis=1) - 1.0
        for bump in self.bumps:
            inner = inner - bump.factor * bump.depth(local) ** 2
        return np.minimum(inner, 0.0)

    def quadric(self) -> str:
        """The table of the ellipsoid's quadric."""
        xx, yy, zz = (1 / half**2 for half in self.half)
        return f"{{ xx = {xx!r}, yy = {yy!r}, zz = {zz!r}, constant = -1 }}"

    def spec(self) -> str:
        """The bump as an item of `bumps`."""
        inner = f"quadric = {self.quadric()}"
        if self.bumps:
            own = ", ".join(bump.spec() for bump in self.bumps)
            inner = f"perturbed = {{ base = {{ {inner} }}, bumps = [{own}] }}"
        place = f"at = {list(self.at)}, rotate = {list(self.rotate)}"
        return f"{{ field = {{ {inner}, {place} }}, factor = {self.factor!r} }}"


HEAD = (
    Bump((0.4, 0.35, 0.6), (0.0, -0.1, 0.9), 1.2, (10.0, 0.0, 0.0), (Bump((0.12, 0.1, 0.2), (0.1, 0.1, 0.4), -0.5),)),
    Bump((0.3, 0.25, 0.35), (0.4, 0.3, 0.85), -0.2),
    Bump((0.3, 0.25, 0.35), (-0.4, 0.3, 0.85), -0.2),
    Bump((0.6, 0.5, 0.7), (0.0, 0.8, -0.3), 0.25, (0.0, 20.0, 35.0)),
)


def spec(shape: str, bumps: Sequence[Bump], tolerance: float) -> str:
    own = ",\n".join(bump.spec() for bump in bumps)
    return f"tolerance = {tolerance!r}\n[shape.a.perturbed]\n{shape}bumps = [\n{own}\n]\n"


def ball(points: Points) -> Points:
    """About the height over the unit ball."""
    return (np.sum(points**2, axis=1) - 1) / 2


def octahedron(points: Points) -> Points:
    """The height over the planes |x| + |y| + |z| = 1, of all the same distance from the center."""
    return (np.sum(np.abs(points), axis=1) - 1) / np.sqrt(3)


BASES = {
    "ball": (OCTAHEDRON + "center = [0, 0, 0]\nspherical = true\n", ball),
    "planes": (OCTAHEDRON + "center = [0, 0, 0]\n", octahedron),
}


def equation(base: str, bumps: Sequence[Bump], points: Points) -> Points:
    """F' at points."""
    return BASES[base][1](points) - sum(bump.factor * bump.depth(points) ** 2 for bump in bumps)


def is_closed(triangles: NDArray[np.int64]) -> bool:
    """Whether every edge has a triangle on both sides, which run along it in opposite directions."""
    sides = Counter((a, b) for triangle in triangles for a, b in zip(triangle, np.roll(triangle, -1), strict=True))
    return all(count == 1 and sides[b, a] == 1 for (a, b), count in sides.items())


@pytest.mark.parametrize("base", BASES)
def test_written_points_satisfy_the_equation(kiln: Kiln, base: str) -> None:
    baked = kiln.bake(spec(BASES[base][0], HEAD, 2e-3))
    points, triangles = baked.mesh("a")
    assert baked.report["perturbed"]["a"] == {"made": "surface", "faces": 8, "closed": True}
    assert baked.shape("a")["deviation"]["kind"] == "proved"
    assert is_closed(triangles)
    size = np.linalg.norm(np.ptp(points, axis=0))
    step = 1e-6
    slopes = [
        (equation(base, HEAD, points + step * axis) - equation(base, HEAD, points - step * axis)) / (2 * step)
        for axis in np.eye(3)
    ]
    away = np.abs(equation(base, HEAD, points)) / np.linalg.norm(slopes, axis=0)
    assert away.max() <= 1e-6 * size


def radial(base: str, bumps: Sequence[Bump], directions: Points) -> Points:
    """How far the surface is from the center, by bisection of each ray."""
    low, high = np.full(len(directions), 1e-3), np.full(len(directions), 3.0)
    for _ in range(60):
        middle = (low + high) / 2
        inside = equation(base, bumps, directions * middle[:, None]) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return (low + high) / 2


@pytest.mark.parametrize("base", BASES)
def test_volumes_are_those_of_quadrature(kiln: Kiln, base: str) -> None:
    # Gauss in the cosine and the trapezoid rule around, per octant, so that edges of faces fall between the pieces.
    nodes, weights = np.polynomial.legendre.leggauss(120)
    volume = 0.0
    for sign in (-1.0, 1.0):
        for quadrant in range(4):
            z, wz = sign * (nodes + 1) / 2, weights / 2
            angle, wa = (quadrant + (nodes + 1) / 2) * np.pi / 2, weights * np.pi / 4
            z, angle = (grid.ravel() for grid in np.meshgrid(z, angle, indexing="ij"))
            across = np.sqrt(1 - z**2)
            directions = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
            volume += np.sum(np.outer(wz, wa).ravel() * radial(base, HEAD, directions) ** 3) / 3
    tolerances = [3e-3 / 10 ** (k / 2) for k in range(5)]
    errors = []
    for tolerance in tolerances:
        shape = kiln.bake(spec(BASES[base][0], HEAD, tolerance)).shape("a")
        errors.append(abs(shape["volume"] - volume))
        # No point is further off than the tolerance.
        assert errors[-1] <= tolerance * shape["area"]
    assert exponent(tolerances, errors) >= 0.9, errors


def test_the_area_of_a_flat_patch_is_that_of_quadrature(kiln: Kiln) -> None:
    bumps = (Bump((0.5, 0.4, 0.3), (0.5, 0.4, 0.0), 0.08), Bump((0.3, 0.3, 0.3), (0.9, 0.5, 0.05), -0.06, (0, 0, 30)))
    triangle = "points = [[0, 0, 0], [1.5, 0, 0], [0.5, 1.2, 0]]\nfaces = [[0, 1, 2]]\n"
    corners = np.array([[0, 0], [1.5, 0], [0.5, 1.2]])

    def heights(places: Points) -> Points:
        low, high = np.full(len(places), -1.0), np.full(len(places), 1.0)
        for _ in range(52):
            middle = (low + high) / 2
            points = np.column_stack([places, middle])
            inside = middle < sum(bump.factor * bump.depth(points) ** 2 for bump in bumps)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return (low + high) / 2

    # The midpoint rule on a fine triangulation of the domain, with slopes by differences of the implicit heights.
    count, step = 200, 1e-5
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    lower, upper = i + j < count, i + j < count - 1
    s = np.concatenate([i[lower] + 1 / 3, i[upper] + 2 / 3]) / count
    t = np.concatenate([j[lower] + 1 / 3, j[upper] + 2 / 3]) / count
    places = corners[0] + np.outer(s, corners[1] - corners[0]) + np.outer(t, corners[2] - corners[0])
    slopes = [(heights(places + step * axis) - heights(places - step * axis)) / (2 * step) for axis in np.eye(2)]
    cell = np.linalg.det(corners[1:] - corners[0]) / 2 / count**2
    area = cell * np.sum(np.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2))
    found = kiln.bake(spec(triangle, bumps, 1e-5)).shape("a")
    assert found["deviation"]["kind"] == "proved"
    assert abs(found["area"] - area) <= 2e-4 * area


def test_the_gallery_says_what_was_made(kiln: Kiln) -> None:
    folder = Path(__file__).parents[2] / "specs" / "perturbed"
    for path in sorted(folder.glob("*.toml")):
        baked = kiln.bake(path.read_text(encoding="utf-8"), name=path.stem)
        for name, facts in baked.report["perturbed"].items():
            assert facts["made"] == "surface", path.stem
            _, triangles = baked.mesh(name)
            assert is_closed(triangles) == facts["closed"], path.stem
