"""The claim of the method: what a map of heights stands for, in corners of polygons and in bytes.

Source: S. Vyatkin and B. Dolgovesov, "Modeling and rendering of freeforms by scalar perturbation functions": six
corners of polygons for each number of a bilinear map, and six times the square of l for a spline through each l-th one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

    Array = NDArray[np.float64]

CELLS = 288  # more vertices than indices of 16 bits name
SIZE = 2.0


def ground(x: Array, y: Array) -> Array:
    """Smooth heights over the unit square."""
    return 0.1 * np.sin(5 * x + 0.3) * np.cos(4 * y) + 0.05 * np.sin(7 * x * y + 1)


def samples(cells: int) -> Array:
    """The ground on a grid."""
    at = np.linspace(0, 1, cells + 1)
    return ground(*np.meshgrid(at, at))


def fine() -> tuple[Array, Array]:
    """Places between the samples of every grid here."""
    at = np.linspace(0, 1, 8 * CELLS + 1)
    return np.meshgrid(at, at)


def bake(kiln: Kiln, heights: Array, interpolation: str, bound: str, tolerance: float, name: str) -> Baked:
    """A map from a raw file of 32-bit numbers, which is the data that counts."""
    (kiln.folder / f"{name}.raw").write_bytes(heights.astype("<f4").tobytes())
    rows, columns = heights.shape
    return kiln.bake(
        f'tolerance = {tolerance}\n[map.m]\ninterpolation = "{interpolation}"\n[map.m.raw]\nfile = "{name}.raw"\n'
        f'columns = {columns}\nrows = {rows}\nnumber = "f32"\n'
        f'[shape.a.height-map]\nmap = "m"\nsize = [{SIZE}, {SIZE}]\nbound = "{bound}"\n',
        name=name,
    )


def distance(baked: Baked) -> float:
    """The greatest vertical distance of the written mesh from the ground, by its own triangles."""
    points, triangles = baked.mesh("a")
    weights = np.array([[i, j, 8 - i - j] for i in range(9) for j in range(9 - i)]) / 8
    worst = 0.0
    for part in np.array_split(points[triangles], max(1, len(triangles) // 20000)):
        places = (weights @ part).reshape(-1, 3)
        at = places[:, [0, 2]] / SIZE + 0.5
        worst = max(worst, float(np.abs(ground(at[:, 0], at[:, 1]) - places[:, 1]).max()))
    return worst


def test_a_number_of_a_bilinear_map_stands_for_six_corners(kiln: Kiln) -> None:
    baked = bake(kiln, samples(CELLS), "bilinear", "dense", 1.0, "dense")
    facts = baked.report["heights"]["a"]
    count = CELLS + 1
    assert facts["samples"] == count**2
    assert facts["corners"] == 6 * CELLS**2
    # Six but for the border: a row and a column of samples have no cells of their own.
    assert facts["ratio"] == pytest.approx(6, rel=2.1 / count)
    assert facts["ratio"] == facts["dense-ratio"]
    # In bytes of the raw file against those of the .glb: a vertex of 24 bytes and two triangles of 12 for 4.
    raw = (kiln.folder / "dense.raw").stat().st_size
    assert facts["data-bytes"] == raw
    assert facts["mesh-bytes"] / raw == pytest.approx(12, rel=2.1 / count)
    assert baked.path.stat().st_size / raw == pytest.approx(12, rel=0.03)


def test_a_number_of_a_spline_stands_for_six_corners_times_the_square_of_the_coarsening(kiln: Kiln) -> None:
    dense = bake(kiln, samples(CELLS), "bilinear", "dense", 1.0, "dense")
    reached = distance(dense)
    x, y = fine()
    truth = ground(x, y)
    whole = np.linspace(0, 1, CELLS + 1)
    linear = RegularGridInterpolator((whole, whole), samples(CELLS))
    assert np.abs(linear(np.stack([y, x], axis=-1)) - truth).max() <= reached * 1.01
    # The largest coarsening whose spline is as near as the dense mesh.
    least = 1
    for coarser in (2, 3, 4, 6, 8, 12, 16, 24, 32):
        at = np.linspace(0, 1, CELLS // coarser + 1)
        spline = RectBivariateSpline(at, at, samples(CELLS // coarser), kx=3, ky=3, s=0)
        if np.abs(spline(y[:, 0], x[0]) - truth).max() > reached:
            break
        least = coarser
    assert least >= 4, "smooth ground"
    coarse = samples(CELLS // least)
    # In the paper's count: the corners of the dense mesh for each number of the spline.
    corners = dense.report["heights"]["a"]["corners"]
    count = CELLS // least + 1
    assert corners / coarse.size == pytest.approx(6 * least**2, rel=2.1 / count)
    # In bytes: the spline's raw file against the dense mesh's .glb.
    (kiln.folder / "coarse.raw").write_bytes(coarse.astype("<f4").tobytes())
    raw = (kiln.folder / "coarse.raw").stat().st_size
    assert dense.path.stat().st_size / raw == pytest.approx(12 * least**2, rel=2.1 / count + 0.03)
    # And the mesh that is written for the spline, as near as the dense one is, is smaller than that: fewer triangles
    # than a grid needs.
    spline_mesh = bake(kiln, coarse, "bicubic", "surface", reached / 2, "coarse")
    assert distance(spline_mesh) <= 1.5 * reached
    facts = spline_mesh.report["heights"]["a"]
    assert facts["interpolation"] == "bicubic"
    assert facts["dense-ratio"] == pytest.approx(6, rel=2.1 / count)
    assert 6 < facts["ratio"] < 6 * least**2


def test_dense_work_does_not_depend_on_the_form(kiln: Kiln) -> None:
    # A count of work: triangles, vertices and bytes of flat and of rough ground are the same.
    chance = np.random.default_rng(3)
    flat = bake(kiln, np.zeros((120, 150)), "bilinear", "dense", 1.0, "flat")
    rough = bake(kiln, chance.normal(size=(120, 150)), "bilinear", "dense", 1.0, "rough")
    for fact in ("corners", "mesh-bytes", "samples"):
        assert flat.report["heights"]["a"][fact] == rough.report["heights"]["a"][fact]
    assert flat.report["totals"]["vertices"] == rough.report["totals"]["vertices"]
    # With a tolerance flat ground needs two triangles.
    plain = bake(kiln, np.zeros((120, 150)), "bilinear", "surface", 0.01, "plain")
    assert plain.report["heights"]["a"]["ratio"] < 0.001
