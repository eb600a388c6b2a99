"""Displaced shapes and baked normal maps: exact surfaces and normals by numpy, meshes and pictures as written."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from scipy.interpolate import RectBivariateSpline

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Baked, Kiln

    Array = NDArray[np.float64]


def wave(points: Array) -> Array:
    """The height of `WAVE`."""
    x, y, z = np.moveaxis(points, -1, 0)
    return 0.05 * np.sin(np.radians(300 * x)) * np.cos(np.radians(240 * y)) + 0.03 * z


WAVE = 'formula = "= 0.05 * sin(300 * x) * cos(240 * y) + 0.03 * z"\n'


@pytest.mark.parametrize("tolerance", [0.02, 0.003])
def test_a_displaced_ball_is_within_its_tolerance(kiln: Kiln, tolerance: float) -> None:
    baked = kiln.bake(f"tolerance = {tolerance}\n[shape.a.displace]\nof = {{ sphere = {{ radius = 1 }} }}\n{WAVE}")
    facts = baked.shape("a")
    assert facts["closed"]
    assert facts["manifold"]
    points, triangles = baked.mesh("a")
    weights = np.array([[i, j, 6 - i - j] for i in range(7) for j in range(7 - i)]) / 6
    places = (weights @ points[triangles]).reshape(-1, 3)
    ways = places / np.linalg.norm(places, axis=1, keepdims=True)
    # Along a ray from the center the surface is at 1 + h, h taken on the ball; slopes are below a half.
    away = np.abs(np.linalg.norm(places, axis=1) - 1 - wave(ways))
    assert away.max() <= tolerance * 1.15
    assert away.max() > tolerance / 8, "far more triangles than are needed"
    # The volume by the same formula over a fine grid of directions.
    angle, rise = np.meshgrid((np.arange(2000) + 0.5) * np.pi / 1000, (np.arange(1000) + 0.5) * np.pi / 1000)
    ways = np.stack([np.sin(rise) * np.sin(angle), np.cos(rise), np.sin(rise) * np.cos(angle)], axis=-1)
    exact = float(((1 + wave(ways)) ** 3 / 3 * np.sin(rise)).mean() * 2 * np.pi**2)
    assert abs(facts["volume"] - exact) <= tolerance * facts["area"]


def test_a_box_moved_by_a_map_keeps_its_edges_and_is_closed(kiln: Kiln) -> None:
    rows = np.round(0.5 + 0.5 * np.sin(np.arange(12)[:, None] * 1.1) * np.cos(np.arange(15) * 0.9), 4)
    for projection in ("x", "y", "z", "spherical", "cylindrical"):
        grid = rows.copy()
        if projection == "cylindrical":
            grid[0], grid[-1] = grid[0, 0], grid[-1, 0]
        baked = kiln.bake(
            "tolerance = 0.004\n[shape.a.displace]\nof = { box = { size = [1, 1.5, 2] } }\nrange = [0, 0.1]\n"
            f'map = {{ grid = {{ rows = {grid.tolist()} }} }}\nprojection = "{projection}"\n'
        )
        facts = baked.shape("a")
        assert facts["closed"], projection
        assert facts["manifold"], projection
        assert facts["genus"] == 0
        # Between the box and the box grown by the greatest height.
        assert 1 * 1.5 * 2 < facts["volume"] < 1.2 * 1.7 * 2.2


def picture_of(baked: Baked) -> Array:
    """The directions in the one normal map of an asset."""
    document = baked.document
    (material,) = [m for m in document.json["materials"] if "normalTexture" in m]
    texture = document.json["textures"][material["normalTexture"]["index"]]
    view = document.json["bufferViews"][document.json["images"][texture["source"]]["bufferView"]]
    start = view.get("byteOffset", 0)
    data = document.buffers[view["buffer"]][start : start + view["byteLength"]]
    return np.array(Image.open(io.BytesIO(data)), float) / 127.5 - 1


def angles(baked: Baked, exact: Callable[[Array], Array]) -> Array:
    """Degrees between what the normal map shows and exact normals, at the centers of texels that the mesh covers."""
    shown = picture_of(baked)
    height, width = shown.shape[:2]
    found = []
    for part in baked.document.meshes[0].surfaces:
        if "TANGENT" not in part.attributes:
            continue
        uv = part.attributes["TEXCOORD_0"].astype(float)
        normals = part.attributes["NORMAL"].astype(float)
        tangents = part.attributes["TANGENT"].astype(float)
        for corners in part.triangles:
            place = uv[corners] * [width, height]
            low = np.floor(place.min(0)).astype(int).clip(0)
            high = np.ceil(place.max(0)).astype(int).clip(None, [width, height])
            i, j = (part.ravel() for part in np.meshgrid(np.arange(low[0], high[0]), np.arange(low[1], high[1])))
            edges = (place[1:] - place[0]).T
            if i.size == 0 or abs(np.linalg.det(edges)) < 1e-12:
                continue
            st = np.linalg.solve(edges, np.stack([i + 0.5, j + 0.5]) - place[0][:, None])
            weights = np.stack([1 - st.sum(0), st[0], st[1]], axis=1)
            inside = (weights >= 1e-9).all(1)
            weights, i, j = weights[inside], i[inside], j[inside]
            if i.size == 0:
                continue
            normal = weights @ normals[corners]
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            along = weights @ tangents[corners][:, :3]
            along /= np.linalg.norm(along, axis=1, keepdims=True)
            across = np.cross(normal, along) * tangents[corners[0], 3]
            across /= np.linalg.norm(across, axis=1, keepdims=True)
            x, y, z = shown[j, i].T
            seen = along * x[:, None] + across * y[:, None] + normal * z[:, None]
            seen /= np.linalg.norm(seen, axis=1, keepdims=True)
            true = exact(np.stack([(i + 0.5) / width, (j + 0.5) / height], axis=1))
            found.append(np.degrees(np.arccos((seen * true).sum(1).clip(-1, 1))))
    return np.concatenate(found)


def test_the_normal_map_of_ground_has_the_normals_of_its_spline(kiln: Kiln) -> None:
    chance = np.random.default_rng(7)
    rows = np.round(0.1 * chance.normal(size=(13, 17)), 6)
    baked = kiln.bake(
        'tolerance = 0.08\n[map.m]\ninterpolation = "bicubic"\n'
        f"[map.m.grid]\nrows = {rows.tolist()}\n"
        '[shape.a]\nmaterial = "stone"\n[shape.a.height-map]\nmap = "m"\nsize = [3, 2]\nclose = "base"\nbase = -1\n'
        "bake-normal-map = [256, 160]\n[material.stone]\n"
    )
    spline = RectBivariateSpline(np.arange(13.0), np.arange(17.0), rows, kx=3, ky=3, s=0)

    def exact(uv: Array) -> Array:
        x, y = uv[:, 0] * 16, uv[:, 1] * 12
        by_x, by_z = spline.ev(y, x, dy=1) * 16 / 3, spline.ev(y, x, dx=1) * 12 / 2
        normal = np.stack([-by_x, np.ones_like(x), -by_z], axis=1)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)

    away = angles(baked, exact)
    assert len(away) > 0.99 * 256 * 160
    # Half a step of 8 bits in each of three directions; few look behind the coarse mesh, which no normal map can hold.
    assert np.percentile(away, 99) < 0.6
    assert (away > 1).mean() < 0.005
    # The coarse mesh by itself is far from that.
    (part,) = [part for part in baked.document.meshes[0].surfaces if "TANGENT" in part.attributes]
    assert len(part.triangles) < 800
    # Walls and the bottom keep the plain material.
    assert len(baked.document.meshes[0].surfaces) == 2


def test_the_normal_map_of_a_planet_has_the_normals_of_its_field(kiln: Kiln) -> None:
    formula = "0.05 * cos(y) ^ 2 * sin(3 * x) * sin(4 * y)"
    baked = kiln.bake(
        'tolerance = 0.05\n[map.m]\ninterpolation = "bicubic"\n'
        f'[map.m.formula]\nf = "= {formula}"\nfrom = [-180, 90]\nto = [180, -90]\ncolumns = 145\nrows = 73\n'
        '[shape.a.height-map]\nmap = "m"\non = { sphere = { radius = 1 } }\nbake-normal-map = [256, 128]\n'
    )

    def exact(uv: Array) -> Array:
        def skin(s: Array, t: Array) -> Array:
            x, y = 2 * np.pi * s - np.pi, np.pi / 2 - np.pi * t
            way = np.stack([np.cos(y) * np.sin(x), np.sin(y), np.cos(y) * np.cos(x)], axis=1)
            height = 1 + 0.05 * np.cos(y) ** 2 * np.sin(3 * x) * np.sin(4 * y)
            return way * height[:, None]

        s, t, step = uv[:, 0], uv[:, 1], 1e-5
        by_s = skin(s + step, t) - skin(s - step, t)
        by_t = skin(s, t + step) - skin(s, t - step)
        normal = np.cross(by_t, by_s)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)

    away = angles(baked, exact)
    assert len(away) > 0.9 * 256 * 128
    assert np.percentile(away, 99) < 0.8
    assert baked.shape("a")["triangles"] < 700


def test_the_normal_map_of_a_displaced_ball_has_the_normals_of_its_formula(kiln: Kiln) -> None:
    baked = kiln.bake(
        "tolerance = 0.02\n[shape.a.displace]\nof = { sphere = { radius = 1 } }\n"
        f"{WAVE}bake-normal-map = [256, 128]\n"
    )
    (part,) = baked.document.meshes[0].surfaces
    # Which place of the sphere a texture coordinate is: told by the mesh itself, of any sphere.
    plain = kiln.bake('tolerance = 0.02\n[shape.a]\nuv = "always"\n[shape.a.sphere]\nradius = 1\n', name="plain")
    (ball,) = plain.document.meshes[0].surfaces
    uv, points = ball.attributes["TEXCOORD_0"].astype(float), ball.attributes["POSITION"].astype(float)
    inner = np.hypot(points[:, 0], points[:, 2]) > 0.2
    turn = np.unwrap(np.arctan2(points[inner, 2], points[inner, 0])[np.argsort(uv[inner, 0])])
    direction = math.copysign(1.0, turn[-1] - turn[0])
    offset = np.angle(np.exp(1j * (np.arctan2(points[:, 2], points[:, 0]) - direction * 2 * np.pi * uv[:, 0]))[inner])
    start = float(np.angle(np.exp(1j * offset).mean()))
    fall = math.copysign(1.0, points[uv[:, 1].argmin(), 1])

    def exact(at: Array) -> Array:
        def skin(s: Array, t: Array) -> Array:
            angle, rise = start + direction * 2 * np.pi * s, fall * (np.pi / 2 - np.pi * t)
            way = np.stack([np.cos(rise) * np.cos(angle), np.sin(rise), np.cos(rise) * np.sin(angle)], axis=1)
            return way * (1 + wave(way))[:, None]

        s, t, step = at[:, 0], at[:, 1], 1e-5
        normal = np.cross(skin(s, t + step) - skin(s, t - step), skin(s + step, t) - skin(s - step, t))
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        return normal * np.sign((normal * skin(s, t)).sum(1))[:, None]

    away = angles(baked, exact)
    assert len(part.triangles) < 6000
    # The ball that is moved is a mesh of its own, a quarter of the tolerance from the exact one.
    assert np.percentile(away, 95) < 2
