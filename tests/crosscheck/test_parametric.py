"""Formula surfaces against quadrature: areas and volumes of named surfaces, points and normals by complex steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from sampled import exponent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

Formula = Callable[..., tuple["NDArray", "NDArray", "NDArray"]]
RADIAN = np.pi / 180.0
STEP = 1e-30  # of complex steps: exact to rounding


def sin(degrees: NDArray) -> NDArray:
    return np.sin(degrees * RADIAN)


def cos(degrees: NDArray) -> NDArray:
    return np.cos(degrees * RADIAN)


@dataclass(frozen=True)
class Surface:
    """A formula in the language and in numpy."""

    spec: tuple[str, str, str]
    formula: Formula
    u: tuple[float, float]
    v: tuple[float, float]
    closed: str
    volume: float | None = None

    def text(self, tolerance: float) -> str:
        """The surface as a document."""
        x, y, z = self.spec
        return (
            f"tolerance = {tolerance}\n[shape.s]\nmaterial = 'both'\n[shape.s.parametric]\n"
            f"x = '= {x}'\ny = '= {y}'\nz = '= {z}'\nu = {list(self.u)}\nv = {list(self.v)}\nclosed = {self.closed}\n"
            "[material.both]\ndouble-sided = true\n"
        )

    def tangents(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Derivatives by u and v."""
        du = np.stack(np.broadcast_arrays(*self.formula(u + 1j * STEP, v + 0j)), axis=-1).imag / STEP
        dv = np.stack(np.broadcast_arrays(*self.formula(u + 0j, v + 1j * STEP)), axis=-1).imag / STEP
        return du, dv

    def area(self, pieces: int = 64) -> float:
        """Gauss's rule on a grid of pieces."""
        nodes, weights = leggauss(8)

        def line(ends: tuple[float, float]) -> tuple[NDArray, NDArray]:
            edges = np.linspace(*ends, pieces + 1)
            half = np.diff(edges) / 2.0
            middle = (edges[1:] + edges[:-1]) / 2.0
            return (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel()

        (u, wu), (v, wv) = line(self.u), line(self.v)
        du, dv = self.tangents(u[:, None], v[None, :])
        return float(np.einsum("i,j,ij", wu, wv, np.linalg.norm(np.cross(du, dv), axis=-1)))


SURFACES = {
    "torus": Surface(
        ("(2 + 0.7 * cos(v)) * sin(u)", "0.7 * sin(v)", "(2 + 0.7 * cos(v)) * cos(u)"),
        lambda u, v: ((2 + 0.7 * cos(v)) * sin(u), 0.7 * sin(v), (2 + 0.7 * cos(v)) * cos(u)),
        (0, 360),
        (0, 360),
        "['u', 'v']",
        2 * np.pi**2 * 2 * 0.49,
    ),
    "steiner": Surface(
        ("sin(2 * u) * cos(v) ^ 2", "sin(u) * sin(2 * v)", "cos(u) * sin(2 * v)"),
        lambda u, v: (sin(2 * u) * cos(v) ** 2, sin(u) * sin(2 * v), cos(u) * sin(2 * v)),
        (0, 180),
        (-90, 90),
        "['u']",
    ),
    "klein": Surface(
        (
            "(3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * cos(u)",
            "sin(u / 2) * sin(v) + cos(u / 2) * sin(2 * v)",
            "(3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * sin(u)",
        ),
        lambda u, v: (
            (3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * cos(u),
            sin(u / 2) * sin(v) + cos(u / 2) * sin(2 * v),
            (3 + cos(u / 2) * sin(v) - sin(u / 2) * sin(2 * v)) * sin(u),
        ),
        (0, 360),
        (-180, 180),
        "['u', 'v']",
    ),
    "enneper": Surface(
        ("u - u ^ 3 / 3 + u * v ^ 2", "v - v ^ 3 / 3 + v * u ^ 2", "u ^ 2 - v ^ 2"),
        lambda u, v: (u - u**3 / 3 + u * v**2, v - v**3 / 3 + v * u**2, u**2 - v**2),
        (-1, 1),
        (-1, 1),
        "[]",
    ),
    "moebius": Surface(
        ("(2 + v * cos(u / 2)) * cos(u)", "v * sin(u / 2)", "(2 + v * cos(u / 2)) * sin(u)"),
        lambda u, v: ((2 + v * cos(u / 2)) * cos(u), v * sin(u / 2), (2 + v * cos(u / 2)) * sin(u)),
        (0, 360),
        (-0.8, 0.8),
        "['u']",
    ),
    "breather": Surface(
        ("exp(v / 4) * cos(u)", "tanh(v) + v / 2", "exp(v / 4) * sin(u)"),
        lambda u, v: (np.exp(v / 4) * cos(u), np.tanh(v) + v / 2, np.exp(v / 4) * sin(u)),
        (0, 360),
        (-2, 2),
        "['u']",
    ),
}


@pytest.mark.parametrize("name", SURFACES)
def test_area_is_the_integral(kiln: Kiln, name: str) -> None:
    surface = SURFACES[name]
    expected = surface.area()
    if name == "enneper":
        # In closed form: the integral of (1 + u^2 + v^2)^2.
        assert expected == pytest.approx(4 * (1 + 4 / 3 + 2 / 5 + 2 / 9), rel=1e-12)
    for tolerance in (1e-2, 1e-3, 1e-4):
        facts = kiln.bake(surface.text(tolerance)).shape("s")
        # All are about a metre across: a mesh so near has an area that near. On saddles the sign changes by place.
        assert facts["area"] == pytest.approx(expected, rel=tolerance)
        if surface.volume is not None:
            assert facts["volume"] == pytest.approx(surface.volume, rel=3.0 * tolerance)


@pytest.mark.parametrize(("name", "coarsest"), [("steiner", 1e-2), ("klein", 3e-2), ("torus", 1e-2)])
def test_measures_converge_with_the_tolerance(kiln: Kiln, name: str, coarsest: float) -> None:
    """Over three decades of the tolerance the error of the area, and of the volume, falls with it."""
    surface = SURFACES[name]
    expected = surface.area(128)
    # Where a surface pinches, as Steiner's does, quadrature converges slowly: still far below the smallest error here.
    assert surface.area(64) == pytest.approx(expected, rel=1e-8)
    tolerances = [coarsest / 10 ** (k / 2) for k in range(7)]
    shapes = [kiln.bake(surface.text(tolerance)).shape("s") for tolerance in tolerances]
    assert exponent(tolerances, [abs(shape["area"] - expected) for shape in shapes]) >= 0.9
    if surface.volume is not None:
        assert exponent(tolerances, [abs(shape["volume"] - surface.volume) for shape in shapes]) >= 0.9


@pytest.mark.parametrize("name", SURFACES)
def test_points_and_derivatives(kiln: Kiln, name: str) -> None:
    surface = SURFACES[name]
    kiln.write(surface.text(1e-2))
    shown = kiln.sample("--shape", "s", "--count", "7")
    assert len(shown["samples"]) >= 7
    for sample in shown["samples"]:
        u, v = np.array(sample["u"]), np.array(sample["v"])
        point = np.stack(np.broadcast_arrays(*surface.formula(u, v)))
        du, dv = surface.tangents(u, v)
        for found, exact in ((sample["point"], point), (sample["du"], du), (sample["dv"], dv)):
            size = max(1.0, float(np.linalg.norm(exact)))
            assert np.linalg.norm(np.array(found) - exact) <= 1e-9 * size
        across = np.cross(du, dv)
        if np.linalg.norm(across) > 1e-6:
            np.testing.assert_allclose(sample["normal"], across / np.linalg.norm(across), atol=1e-8)
