"""Height maps over curved bases: skins by numpy and scipy, how far the written mesh is from them, volumes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline, RegularGridInterpolator

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Baked, Kiln

    Array = NDArray[np.float64]
    Field = Callable[[Array, Array], Array]
    Base = Callable[[Array, Array], tuple[Array, Array]]

PLACES_IN_A_CELL = 16


def field_of(heights: Array, interpolation: str, *, around: bool) -> tuple[Field, int]:
    """The field of a grid over parts s and t of its rectangle, and its columns; around, it is periodic in s."""
    rows = np.arange(heights.shape[0], dtype=float)
    if around and not np.array_equal(heights[:, 0], heights[:, -1]):
        heights = np.concatenate([heights, heights[:, :1]], axis=1)
    count = heights.shape[1]
    columns = np.arange(count, dtype=float)
    if interpolation == "bilinear":
        linear = RegularGridInterpolator((rows, columns), heights)
        return lambda s, t: linear(np.stack([t * rows[-1], s * columns[-1]], axis=-1)), count
    if around:
        turn = heights[:, :-1]
        beyond = 3 * turn.shape[1]
        heights = np.concatenate([turn] * 7 + [turn[:, :1]], axis=1)
        columns = np.arange(heights.shape[1], dtype=float) - beyond
    spline = RectBivariateSpline(rows, columns, heights, kx=3, ky=3, s=0)
    return lambda s, t: spline.ev(t * rows[-1], s * (count - 1)), count


def ellipsoid(radii: list[float], longitude: list[float], latitude: list[float]) -> Base:
    """Points and true normals by angles that run to the right and down."""
    half = np.array(radii)

    def stand(s: Array, t: Array) -> tuple[Array, Array]:
        angle = np.radians(longitude[0] + (longitude[1] - longitude[0]) * s)
        rise = np.radians(latitude[0] + (latitude[1] - latitude[0]) * t)
        on = np.stack([np.cos(rise) * np.sin(angle), np.sin(rise), np.cos(rise) * np.cos(angle)], axis=-1)
        normal = on / half
        return on * half, normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    return stand


def ellipsoid_cylindrical(radii: list[float], longitude: list[float], rise: list[float]) -> Base:
    """Points and true normals by an angle and the height."""
    half = np.array(radii)

    def stand(s: Array, t: Array) -> tuple[Array, Array]:
        angle = np.radians(longitude[0] + (longitude[1] - longitude[0]) * s)
        part = (rise[0] + (rise[1] - rise[0]) * t) / half[1]
        wide = np.sqrt(1 - part**2)
        on = np.stack([wide * np.sin(angle), part, wide * np.cos(angle)], axis=-1)
        normal = on / half
        return on * half, normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    return stand


def ellipsoid_parallel(radii: list[float], size: list[float]) -> Base:
    """Points and true normals over a rectangle seen from +z."""
    half = np.array(radii)

    def stand(s: Array, t: Array) -> tuple[Array, Array]:
        x, y = (s - 0.5) * size[0] / half[0], (0.5 - t) * size[1] / half[1]
        on = np.stack([x, y, np.sqrt(1 - x**2 - y**2)], axis=-1)
        normal = on / half
        return on * half, normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    return stand


def cylinder(radius: float, height: float, longitude: list[float]) -> Base:
    """Points and normals of a cylinder."""

    def stand(s: Array, t: Array) -> tuple[Array, Array]:
        angle = np.radians(longitude[0] + (longitude[1] - longitude[0]) * s)
        normal = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
        return radius * normal + np.array([0, 1, 0]) * ((0.5 - t) * height)[..., None], normal

    return stand


def cylinder_parallel(radius: float, size: list[float]) -> Base:
    """Points and normals over a rectangle seen from +z."""

    def stand(s: Array, t: Array) -> tuple[Array, Array]:
        x = (s - 0.5) * size[0]
        normal = np.stack([x, 0 * x, np.sqrt(radius**2 - x**2)], axis=-1) / radius
        return radius * normal + np.array([0, 1, 0]) * ((0.5 - t) * size[1])[..., None], normal

    return stand


def vase(s: Array, t: Array) -> tuple[Array, Array]:
    """The surface of `VASE`, u from +x toward -z, v against t."""
    u, v = 2 * math.pi * s, 1 - t
    radius, slope = 0.5 + 0.2 * np.sin(4 * v), 0.8 * np.cos(4 * v)
    out = np.stack([np.cos(u), 0 * u, -np.sin(u)], axis=-1)
    up = np.array([0.0, 1.0, 0.0])
    normal = (out - up * slope[..., None]) / np.sqrt(1 + slope**2)[..., None]
    return out * radius[..., None] + up * v[..., None], normal


VASE = (
    "{ surface = { of = { parametric = { "
    'x = "= (0.5 + 0.2 * sin(4 * v * 180 / pi)) * cos(u)", y = "= v", '
    'z = "= 0 - (0.5 + 0.2 * sin(4 * v * 180 / pi)) * sin(u)", u = [0, 360], v = [0, 1] } } } }'
)

ALL_AROUND = [-180.0, 180.0]
BASES: dict[str, tuple[str, Base, bool, bool]] = {
    "sphere": ("{ sphere = { radius = 1.5 } }", ellipsoid([1.5] * 3, ALL_AROUND, [90, -90]), True, True),
    "ellipsoid": (
        "{ ellipsoid = { radii = [1.2, 0.8, 1.5] } }",
        ellipsoid([1.2, 0.8, 1.5], ALL_AROUND, [90, -90]),
        True,
        True,
    ),
    "part of an ellipsoid": (
        "{ ellipsoid = { radii = [1.2, 0.8, 1.5], longitude = [-70, 50], latitude = [40, -60] } }",
        ellipsoid([1.2, 0.8, 1.5], [-70, 50], [40, -60]),
        False,
        False,
    ),
    "ellipsoid by heights": (
        '{ ellipsoid = { radii = [1.2, 0.8, 1.5], projection = "cylindrical", rise = [0.6, -0.5] } }',
        ellipsoid_cylindrical([1.2, 0.8, 1.5], ALL_AROUND, [0.6, -0.5]),
        True,
        False,
    ),
    "front of an ellipsoid": (
        '{ ellipsoid = { radii = [1.2, 0.8, 1.5], projection = "parallel", size = [1.2, 0.9] } }',
        ellipsoid_parallel([1.2, 0.8, 1.5], [1.2, 0.9]),
        False,
        False,
    ),
    "cylinder": ("{ cylinder = { radius = 0.7, height = 2 } }", cylinder(0.7, 2, ALL_AROUND), True, False),
    "front of a cylinder": (
        '{ cylinder = { radius = 0.7, projection = "parallel", size = [1.1, 0.8] } }',
        cylinder_parallel(0.7, [1.1, 0.8]),
        False,
        False,
    ),
    "vase": (VASE, vase, True, False),
}


def hills(*, poles: bool) -> Array:
    """Smooth ground with a little chance in it, even at poles."""
    chance = np.random.default_rng(5)
    t, s = np.mgrid[:13, :24] / np.array([12.0, 24.0])[:, None, None]
    ground = 0.06 * np.sin(2 * np.pi * 3 * s) * np.cos(7 * t) + 0.02 * chance.normal(size=t.shape)
    if poles:
        ground *= np.sin(np.pi * t) ** 2
        ground[0], ground[-1] = 0.01, -0.02
    return np.round(ground, 6)


def spec(on: str, heights: Array, interpolation: str, tolerance: float, rest: str = "") -> str:
    """A document with one map over a base."""
    return (
        f'tolerance = {tolerance}\n[map.m]\ninterpolation = "{interpolation}"\n'
        f"[map.m.grid]\nrows = {heights.tolist()}\n"
        f'[shape.a]\nuv = "always"\n[shape.a.height-map]\nmap = "m"\non = {on}\n{rest}'
    )


def error(baked: Baked, skin: Callable[[Array, Array], Array], cells: tuple[int, int], *, poles: bool) -> float:
    """The greatest distance of the mesh from the skin of the same parameters, at sixteen places in each cell."""
    (part,) = baked.document.meshes[0].surfaces
    points = part.attributes["POSITION"].astype(float)
    places = part.attributes["TEXCOORD_0"].astype(float)
    worst = 0.0
    for corners in part.triangles:
        flat, over = places[corners], points[corners]
        at_pole = np.isin(flat[:, 1], [0.0, 1.0]) & poles
        reach = np.abs(flat - np.roll(flat, 1, axis=0)).max(axis=0) * np.array(cells)
        steps = max(4, math.ceil(math.sqrt(PLACES_IN_A_CELL) * reach.max()))
        i, j = (index.ravel() for index in np.mgrid[: steps + 1, : steps + 1])
        inside = i + j <= steps
        weights = np.stack([i, j, steps - i - j], axis=1)[inside] / steps
        at = weights @ flat
        if at_pole.any():
            # The columns of a pole are those of the side that it looks at.
            rest = weights[:, ~at_pole]
            total = rest.sum(axis=1)
            columns = rest @ flat[~at_pole, 0] / np.where(total > 0, total, 1)
            at[:, 0] = np.where(total > 0, columns, flat[at_pole, 0][0])
        away = np.linalg.norm(skin(at[:, 0].clip(0, 1), at[:, 1].clip(0, 1)) - weights @ over, axis=1)
        worst = max(worst, float(away.max()))
    return worst


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize("name", BASES)
def test_the_mesh_is_within_its_tolerance_of_the_skin(kiln: Kiln, name: str, interpolation: str) -> None:
    on, base, around, poles = BASES[name]
    heights = hills(poles=poles)
    field, columns = field_of(heights, interpolation, around=around)

    def skin(s: Array, t: Array) -> Array:
        point, normal = base(s, t)
        return point + normal * field(s, t)[..., None]

    for tolerance in (0.02, 0.002):
        baked = kiln.bake(spec(on, heights, interpolation, tolerance), "--measure")
        facts = baked.shape("a")
        assert facts["closed"] == poles
        found = error(baked, skin, (columns - 1, heights.shape[0] - 1), poles=poles)
        # Single precision moves points, and parameters along slopes.
        assert found <= tolerance + 2e-6
        assert found <= facts["deviation"]["bound"] + 2e-6
        assert facts["deviation"]["measured"] <= facts["deviation"]["bound"] + 1e-6
        assert found > tolerance / 8, "far more triangles than are needed"


def flux(skin: Callable[[Array, Array], Array], cells: tuple[int, int]) -> float:
    """A third of the integral of S . (S_t x S_s) by Gauss's rule in each cell of the grid."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    axes = []
    for count in cells:
        starts = np.arange(count)[:, None]
        axes.append(((starts + (nodes + 1) / 2).ravel() / count, np.tile(weights / 2, count) / count))
    (s, ws), (t, wt) = axes
    s, t = np.meshgrid(s, t, indexing="ij")
    step = 1e-6
    by_s = (skin(s + step, t) - skin(s - step, t)) / (2 * step)
    by_t = (skin(s, t + step) - skin(s, t - step)) / (2 * step)
    return float((np.einsum("ijk,ijk->ij", skin(s, t), np.cross(by_t, by_s)) * np.outer(ws, wt)).sum() / 3)


@pytest.mark.parametrize("interpolation", ["bilinear", "bicubic"])
@pytest.mark.parametrize("name", ["sphere", "ellipsoid"])
def test_a_closed_skin_has_the_volume_of_its_integral(kiln: Kiln, name: str, interpolation: str) -> None:
    on, base, around, _ = BASES[name]
    heights, tolerance = hills(poles=True), 1e-3
    field, columns = field_of(heights, interpolation, around=around)

    def skin(s: Array, t: Array) -> Array:
        point, normal = base(s, t)
        return point + normal * field(s.clip(0, 1), t.clip(0, 1))[..., None]

    exact = flux(skin, (columns - 1, heights.shape[0] - 1))
    facts = kiln.bake(spec(on, heights, interpolation, tolerance)).shape("a")
    assert facts["closed"]
    assert facts["manifold"]
    assert facts["genus"] == 0
    assert abs(facts["volume"] - exact) <= 1e-6 * exact + tolerance * facts["area"]
    # Hollow, the base and a lower skin inside: the volume between two skins.
    thick = kiln.bake(spec(on, heights, interpolation, tolerance, 'close = "thickness"\ndepth = 0.1'), name="thick")

    def lower(s: Array, t: Array) -> Array:
        point, normal = base(s, t)
        return point + normal * (field(s.clip(0, 1), t.clip(0, 1)) - 0.1)[..., None]

    between = exact - flux(lower, (columns - 1, heights.shape[0] - 1))
    facts = thick.shape("a")
    assert facts["closed"]
    assert facts["components"] == 2
    assert abs(facts["volume"] - between) <= 1e-6 * between + tolerance * facts["area"]


def test_a_column_has_the_volume_of_its_integral(kiln: Kiln) -> None:
    heights, tolerance = hills(poles=False), 1e-3
    for interpolation in ("bilinear", "bicubic"):
        field, columns = field_of(heights, interpolation, around=True)
        s, t = np.meshgrid((np.arange(2400) + 0.5) / 2400, (np.arange(1200) + 0.5) / 1200)
        # Half the squared radius over the angle and the height.
        exact = float(((0.7 + field(s, t)) ** 2).mean() * math.pi * 2)
        facts = kiln.bake(spec(BASES["cylinder"][0], heights, interpolation, tolerance, 'close = "ends"')).shape("a")
        assert facts["closed"]
        assert facts["genus"] == 0
        assert columns == 25
        assert abs(facts["volume"] - exact) <= 1e-6 * exact + tolerance * facts["area"]


def test_masks_on_a_base_have_the_area_of_their_field(kiln: Kiln) -> None:
    tolerance = 1e-3
    t, s = np.mgrid[:33, :64] / np.array([32.0, 63.0])[:, None, None]
    angle, rise = np.radians(360 * s - 180), np.radians(90 - 180 * t)
    # A cap around an axis that leans: over the north pole and the seam.
    axis = np.array([0.4, 0.8, -0.45])
    toward = np.stack([np.cos(rise) * np.sin(angle), np.sin(rise), np.cos(rise) * np.cos(angle)], axis=-1) @ axis
    field, columns = field_of(toward, "bilinear", around=True)
    x, y = np.meshgrid((np.arange(4000) + 0.5) / 4000, (np.arange(2000) + 0.5) / 2000)
    kept = field(x, y) >= 0.55
    exact = float((kept * np.sin(np.pi * y)).mean() * 2 * math.pi**2)
    mask = f'mask = [{{ map = {{ grid = {{ rows = {toward.tolist()} }} }}, at-least = 0.55 }}]\nclose = "thickness"\n'
    flat = np.zeros((9, 16))
    baked = kiln.bake(spec("{ sphere = { radius = 1 } }", flat, "bilinear", tolerance, mask + "depth = 0.25"))
    facts = baked.shape("a")
    assert facts["closed"]
    assert facts["manifold"]
    assert facts["components"] == 1
    assert columns == 65
    volume = exact * (1 - 0.75**3) / 3
    assert abs(facts["volume"] - volume) <= tolerance * facts["area"]
