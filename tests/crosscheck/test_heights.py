"""Height maps: the field by scipy, the greatest distance of the written mesh from it, volumes, real ground."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator
from scipy.ndimage import label

from conftest import cases_folder

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Baked, Kiln

    Field = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]

PLACES_IN_A_CELL = 16


def field_of(heights: NDArray[np.float64], interpolation: str) -> Field:
    """The interpolated field of a grid by scipy; x counts columns, y counts rows."""
    rows, columns = (np.arange(count, dtype=float) for count in heights.shape)
    if interpolation == "bicubic":
        spline = RectBivariateSpline(rows, columns, heights, kx=3, ky=3, s=0)
        return lambda x, y: spline.ev(y, x)
    linear = RegularGridInterpolator((rows, columns), heights)
    return lambda x, y: linear(np.stack([y, x], axis=-1))


def error(baked: Baked, field: Field, shape: tuple[int, int], size: tuple[float, float]) -> float:
    """The greatest vertical distance of the sheet from the field, at sixteen places in each cell of the grid."""
    points, triangles = baked.mesh("a")
    rows, columns = shape
    place = np.stack(
        [(points[:, 0] / size[0] + 0.5) * (columns - 1), (points[:, 2] / size[1] + 0.5) * (rows - 1)], axis=1
    )
    worst = 0.0
    for corners in triangles:
        flat, heights = place[corners], points[corners, 1]
        edges = flat[1:] - flat[0]
        twice = edges[0, 0] * edges[1, 1] - edges[0, 1] * edges[1, 0]
        assert twice < 0, "the sheet looks up"
        low, high = flat.min(axis=0), flat.max(axis=0)
        steps = math.sqrt(PLACES_IN_A_CELL)
        # The corners of quarters of cells, and so the nodes too.
        x = np.arange(math.ceil(low[0] * steps - 1e-6), math.floor(high[0] * steps + 1e-6) + 1) / steps
        y = np.arange(math.ceil(low[1] * steps - 1e-6), math.floor(high[1] * steps + 1e-6) + 1) / steps
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        away = grid - flat[0]
        s = (away[:, 0] * edges[1, 1] - away[:, 1] * edges[1, 0]) / twice
        t = (edges[0, 0] * away[:, 1] - edges[0, 1] * away[:, 0]) / twice
        inside = (s >= -1e-7) & (t >= -1e-7) & (s + t <= 1 + 1e-7)
        along = np.linspace(0, 1, 9)
        s = np.concatenate([s[inside], along, 0 * along, 1 - along])
        t = np.concatenate([t[inside], 0 * along, along, along])
        at = flat[0] + s[:, None] * edges[0] + t[:, None] * edges[1]
        over = heights[0] + s * (heights[1] - heights[0]) + t * (heights[2] - heights[0])
        at = np.clip(at, 0, [columns - 1, rows - 1])
        worst = max(worst, float(np.abs(field(at[:, 0], at[:, 1]) - over).max()))
    return worst


def hills(rows: int, columns: int, seed: int) -> NDArray[np.float64]:
    """Smooth ground with a little chance in it."""
    chance = np.random.default_rng(seed)
    y, x = np.mgrid[:rows, :columns] / 7.0
    return np.round(np.sin(x) * np.cos(1.3 * y) + 0.05 * chance.normal(size=(rows, columns)), 6)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize("tolerance", [0.2, 0.02, 0.002])
def test_the_mesh_is_within_its_tolerance_of_scipys_field(kiln: Kiln, interpolation: str, tolerance: float) -> None:
    heights, size = hills(19, 26, seed=4), (5.0, 3.6)
    baked = kiln.bake(
        f'tolerance = {tolerance}\n[map.m]\ninterpolation = "{interpolation}"\n'
        f"[map.m.grid]\nrows = {heights.tolist()}\n"
        f'[shape.a.height-map]\nmap = "m"\nsize = {list(size)}\n'
    )
    found = error(baked, field_of(heights, interpolation), heights.shape, size)
    # Single precision moves points sideways too, on slopes of up to 10.
    assert found <= tolerance + 1e-5
    assert found <= baked.shape("a")["deviation"]["bound"] * 1.0001 + 1e-5
    assert found > tolerance / 8, "far more triangles than are needed"


def test_samples_are_met_where_samples_are_asked_for(kiln: Kiln) -> None:
    heights, size = hills(31, 40, seed=8), (4.0, 3.0)
    baked = kiln.bake(
        f"tolerance = 0.03\n[map.m.grid]\nrows = {heights.tolist()}\n"
        f'[shape.a.height-map]\nmap = "m"\nsize = {list(size)}\nbound = "samples"\n'
    )
    points, triangles = baked.mesh("a")
    place = np.stack([(points[:, 0] / size[0] + 0.5) * 39, (points[:, 2] / size[1] + 0.5) * 30], axis=1).round(4)
    assert np.array_equal(place, place.round()), "corners are samples"
    met = np.zeros(heights.shape, bool)
    for corners in triangles:
        flat, over = place[corners], points[corners, 1]
        edges = (flat[1:] - flat[0]).T
        low, high = flat.min(axis=0).astype(int), flat.max(axis=0).astype(int)
        for y in range(low[1], high[1] + 1):
            for x in range(low[0], high[0] + 1):
                s, t = np.linalg.solve(edges, np.array([x, y]) - flat[0])
                if min(s, t) >= -1e-9 and s + t <= 1 + 1e-9:
                    height = over[0] + s * (over[1] - over[0]) + t * (over[2] - over[0])
                    assert abs(height - heights[y, x]) <= 0.03 + 1e-5
                    met[y, x] = True
    assert met.all()


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
def test_a_closed_map_has_the_volume_of_scipys_integral(kiln: Kiln, interpolation: str) -> None:
    heights, size, tolerance = hills(14, 17, seed=2), (3.2, 2.6), 1e-3
    baked = kiln.bake(
        f'tolerance = {tolerance}\n[map.m]\ninterpolation = "{interpolation}"\n'
        f"[map.m.grid]\nrows = {heights.tolist()}\n"
        f'[shape.a.height-map]\nmap = "m"\nsize = {list(size)}\nclose = "base"\nbase = -2\n'
    )
    y, x = np.arange(14.0), np.arange(17.0)
    degree = 3 if interpolation == "bicubic" else 1
    spline = RectBivariateSpline(y, x, heights, kx=degree, ky=degree, s=0)
    mean = spline.integral(0, 13, 0, 16) / (13 * 16)
    area = size[0] * size[1]
    facts = baked.shape("a")
    assert facts["closed"]
    assert facts["genus"] == 0
    assert abs(facts["volume"] - area * (mean + 2)) <= 1e-6 * area * (mean + 2) + tolerance * area


@pytest.mark.cases
@pytest.mark.parametrize("name", ["maunga_whau_volcano", "west_bijou_escarpment"])
def test_real_ground_from_pictures_and_grids(kiln: Kiln, name: str) -> None:
    folder = cases_folder()
    assert folder is not None
    source = folder / "height" / f"{name}.asc"
    text = source.read_text(encoding="ascii")
    numbers = [line for line in text.splitlines() if not line[:1].isalpha()]
    heights = np.array(" ".join(numbers).split(), float)
    header = dict(line.lower().split() for line in text.splitlines() if line[:1].isalpha())
    heights = heights.reshape(int(header["nrows"]), int(header["ncols"]))
    (kiln.folder / "ground.asc").write_text(text, encoding="ascii")
    size = (float(heights.shape[1] - 1), float(heights.shape[0] - 1))
    spec = (
        'tolerance = 2\n[shape.a.height-map]\nmap = {{ {kind} = {{ file = "{file}" }} }}\n'
        "size = {size}\nrange = {range}\n"
    )
    grid = kiln.bake(spec.format(kind="grid", file="ground.asc", size=list(size), range=[0, 1]))
    assert error(grid, field_of(heights, "bilinear"), heights.shape, size) <= 2.001
    picture = folder / "height" / f"{name}_16.png"
    (kiln.folder / "ground.png").write_bytes(picture.read_bytes())
    low, high = float(heights.min()), float(heights.max())
    grey = kiln.bake(spec.format(kind="image", file="ground.png", size=list(size), range=[low, high]), name="grey")
    # The picture rounds to 65535 steps of the range.
    assert error(grey, field_of(heights, "bilinear"), heights.shape, size) <= 2.001 + (high - low) / 65535


def masked_area(field: Field, shape: tuple[int, int], size: tuple[float, float], threshold: float) -> float:
    """The area where a field is at least a threshold, by the crossings along many lines."""
    rows, columns = shape
    lines, steps = 1500, 64 * (columns - 1)
    y = (np.arange(lines) + 0.5) / lines * (rows - 1)
    x = np.linspace(0, columns - 1, steps + 1)
    covered = 0.0
    for at in y:
        value = field(x, np.full_like(x, at)) - threshold
        one, other = value[:-1], value[1:]
        part = np.where(one == other, 1.0, one / np.where(one == other, 1.0, one - other))
        inside = np.where(one >= 0, np.where(other >= 0, 1.0, part), np.where(other >= 0, 1.0 - part, 0.0))
        covered += inside.sum() / steps
    return covered / lines * size[0] * size[1]


def sheet_area(baked: Baked) -> float:
    """The area of an open sheet, seen from above."""
    points, triangles = baked.mesh("a")
    flat = points[triangles][:, :, [0, 2]]
    edges = flat[:, 1:] - flat[:, :1]
    twice = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    assert (twice < 0).all()
    return float(-twice.sum() / 2)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize("threshold", [-0.4, 0.0, 0.35])
def test_masks_have_the_area_of_scipys_field(kiln: Kiln, interpolation: str, threshold: float) -> None:
    heights, mask, size = hills(12, 15, seed=3), hills(19, 26, seed=6), (5.0, 3.6)
    tolerance = 1e-3
    spec = (
        f"tolerance = {tolerance}\n[map.ground.grid]\nrows = {heights.tolist()}\n"
        f'[map.m]\ninterpolation = "{interpolation}"\n[map.m.grid]\nrows = {mask.tolist()}\n'
        f'[shape.a.height-map]\nmap = "ground"\nsize = {list(size)}\n'
        'mask = [{{ map = "m", {side} = {threshold} }}]\n'
    )
    field = field_of(mask, interpolation)
    exact = masked_area(field, mask.shape, size, threshold)
    above = kiln.bake(spec.format(side="at-least", threshold=threshold))
    below = kiln.bake(spec.format(side="at-most", threshold=threshold), name="below")
    # A quarter of the tolerance along some forty meters of line, on both sides of it.
    assert abs(sheet_area(above) - exact) < 2e-3
    assert abs(sheet_area(above) + sheet_area(below) - size[0] * size[1]) < 1e-5
    # The line itself, at the places where it ends an edge: within the tolerance of the exact one.
    points, triangles = above.mesh("a")
    edges, counts = np.unique(
        np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1),
        axis=0,
        return_counts=True,
    )
    rim = edges[counts == 1]
    x = (points[:, 0] / size[0] + 0.5) * (mask.shape[1] - 1)
    y = (points[:, 2] / size[1] + 0.5) * (mask.shape[0] - 1)
    border = (np.abs(x[rim] - [[0]]) < 1e-4).all(1) | (np.abs(x[rim] - 25) < 1e-4).all(1)
    border |= (np.abs(y[rim]) < 1e-4).all(1) | (np.abs(y[rim] - 18) < 1e-4).all(1)
    inner = rim[~border]
    assert len(inner) > 20
    for part in np.linspace(0, 1, 5):
        px = np.clip(x[inner[:, 0]] * (1 - part) + x[inner[:, 1]] * part, 0, 25)
        py = np.clip(y[inner[:, 0]] * (1 - part) + y[inner[:, 1]] * part, 0, 18)
        # Somewhere within the tolerance around it the field takes the threshold.
        around = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
        step = np.array([25 / size[0], 18 / size[1]]) * tolerance
        near = np.stack(
            [
                field(np.clip(px + dx * step[0], 0, 25), np.clip(py + dy * step[1], 0, 18)) - threshold
                for dx, dy in around
            ]
        )
        assert ((near.min(0) <= 1e-9) & (near.max(0) >= -1e-9)).all()


@pytest.mark.cases
@pytest.mark.parametrize("name", ["maunga_whau_volcano", "jacksboro_fault"])
def test_real_masks_have_their_components_and_volume(kiln: Kiln, name: str) -> None:
    folder = cases_folder()
    assert folder is not None
    for kind, suffix in [("ground", "16"), ("mask", "mask50")]:
        picture = folder / "height" / f"{name}_{suffix}.png"
        (kiln.folder / f"{kind}.png").write_bytes(picture.read_bytes())
    baked = kiln.bake(
        'tolerance = 0.05\n[map.g.image]\nfile = "ground.png"\n[map.m.image]\nfile = "mask.png"\n'
        '[shape.a.height-map]\nmap = "g"\nsize = [40, 30]\nrange = [0, 3]\nclose = "thickness"\ndepth = 0.5\n'
        'mask = [{ map = "m", at-least = 0.5 }]\n'
    )
    mask = np.array(Image.open(kiln.folder / "mask.png"), float) / 255
    facts = baked.shape("a")
    assert facts["closed"]
    assert facts["manifold"]
    exact = masked_area(field_of(mask, "bilinear"), mask.shape, (40.0, 30.0), 0.5)
    assert abs(facts["volume"] / 0.5 - exact) < 0.05 * 0.25 * 400
    # At a half, cells with two white corners across are joined in their middle: white pixels touch over corners too.
    _, count = label(mask > 0.5, np.ones((3, 3)))
    assert facts["components"] == count


def test_a_split_body_has_the_volume_of_both_integrals(kiln: Kiln) -> None:
    front, back = 2 + hills(15, 18, seed=11), 3 + hills(15, 18, seed=12)
    mask, size, tolerance = hills(13, 16, seed=13), (3.0, 2.0), 1e-3
    part = "{{ map = {{ grid = {{ rows = {rows} }} }}, range = [0, 0.2], normal = {normal} }}"
    baked = kiln.bake(
        f"tolerance = {tolerance}\n[map.m.grid]\nrows = {mask.tolist()}\n"
        f'[shape.a.split]\nsize = {list(size)}\nmask = [{{ map = "m", at-least = 0.1 }}]\npart = ['
        f"{part.format(rows=front.tolist(), normal=[0, 1, 0])}, {part.format(rows=back.tolist(), normal=[0, -1, 0])}]\n"
    )
    facts = baked.shape("a")
    assert facts["closed"]
    assert facts["manifold"]
    fields = [field_of(heights, "bilinear") for heights in (mask, front, back)]
    x, y = np.meshgrid((np.arange(1500) + 0.5) / 1500, (np.arange(1000) + 0.5) / 1000)
    of = [
        field(x.ravel() * (shape[1] - 1), y.ravel() * (shape[0] - 1))
        for field, shape in zip(fields, (mask.shape, front.shape, back.shape), strict=True)
    ]
    inside = of[0] >= 0.1
    exact = 0.2 * (of[1] + of[2])[inside].sum() / inside.size * size[0] * size[1]
    # The tolerance over the area on both sides, and a quarter of it along the line on a wall of a meter.
    assert abs(facts["volume"] - exact) < 2 * tolerance * size[0] * size[1]
