"""Plain shapes and how they are combined, against closed forms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

if TYPE_CHECKING:
    from kiln import Kiln

EXACT = 1e-6  # relative; flat shapes are exact but for single precision


def box_of(shape: dict) -> tuple[np.ndarray, np.ndarray]:
    return np.array(shape["bounds"]["min"]), np.array(shape["bounds"]["max"])


def test_box(kiln: Kiln) -> None:
    shape = kiln.bake("[shape.s.box]\nsize = [1, 2, 4]\ncenter = [1, 0, -1]\n").shape("s")
    assert shape["area"] == pytest.approx(2 * (2 + 8 + 4), rel=EXACT)
    assert shape["volume"] == pytest.approx(8, rel=EXACT)
    np.testing.assert_allclose(shape["centroid"], [1, 0, -1], atol=1e-6)
    inertia = 8 / 12 * np.array([4 + 16, 1 + 16, 1 + 4])
    np.testing.assert_allclose(np.diag(shape["inertia"]), inertia, rtol=1e-6)
    assert (shape["triangles"], shape["points"], shape["vertices"]) == (12, 8, 24)
    assert (shape["euler"], shape["genus"], shape["components"]) == (2, 0, 1)


def test_units_and_axes(kiln: Kiln) -> None:
    shape = kiln.bake('unit = "cm"\nup = "z"\n[shape.s.box]\nsize = [100, 200, 400]\n').shape("s")
    low, high = box_of(shape)
    np.testing.assert_allclose(high - low, [1, 4, 2], atol=1e-6)


def test_extrude_with_holes(kiln: Kiln) -> None:
    spec = """
tolerance = 0.0005
[curve.outline.polyline]
points = [[0, 0], [4, 0], [4, 3], [0, 3]]
closed = true
[curve.square.polyline]
points = [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]
closed = true
[shape.s.extrude]
profile = "outline"
holes = ["square", { circle = { radius = 0.5, center = [3, 2] } }]
height = 0.25
"""
    shape = kiln.bake(spec).shape("s")
    face = 12 - 1 - np.pi * 0.25
    around = 14 + 4 + np.pi
    assert shape["volume"] == pytest.approx(face * 0.25, rel=2e-4)
    assert shape["area"] == pytest.approx(2 * face + around * 0.25, rel=2e-4)
    assert shape["closed"]
    assert shape["manifold"]
    assert shape["genus"] == 2
    low, high = box_of(shape)
    np.testing.assert_allclose([low[2], high[2]], [0, 0.25], atol=1e-6)


def test_part_of_a_turn_with_caps(kiln: Kiln) -> None:
    spec = """
tolerance = 0.0002
[curve.p.polyline]
points = [[1, 0], [2, 0], [2, 1], [1, 1]]
closed = true
[shape.s.revolve]
profile = "p"
angle = 90
"""
    shape = kiln.bake(spec).shape("s")
    assert shape["volume"] == pytest.approx(np.pi / 2 * 1.5, rel=1e-3)  # Pappus: area times the centroid's way
    assert shape["area"] == pytest.approx(np.pi / 2 * 1.5 * 4 + 2, rel=1e-3)
    assert shape["closed"]
    assert shape["genus"] == 0


def test_open_glass_by_quadrature_of_its_spline(kiln: Kiln) -> None:
    from scipy.interpolate import CubicSpline

    from sampled import revolved

    points = np.array([[0.5, 0.0], [0.1, 0.3], [0.08, 1.0], [0.5, 1.5], [0.6, 2.0], [0.45, 2.4]])
    spline = CubicSpline(np.linspace(0, 1, len(points)), points, bc_type="natural")
    area, _ = revolved(spline)
    spec = (
        f"tolerance = 0.0005\n[curve.p.natural-spline]\npoints = {points.tolist()}\n"
        'parameters = "uniform"\n[shape.s.revolve]\nprofile = "p"\n'
    )
    shape = kiln.bake(spec).shape("s")
    assert shape["area"] == pytest.approx(area, rel=2e-3)
    assert not shape["closed"]
    assert shape["boundary-loops"] == 2


def test_tube_bent_by_an_arc_is_pappus(kiln: Kiln) -> None:
    spec = """
tolerance = 0.0003
[curve.p.arc]
center = [0, 0]
radius = 2
from = 0
to = 135
[shape.s.sweep]
profile = { circle = { radius = 0.5 } }
path = "p"
"""
    shape = kiln.bake(spec).shape("s")
    way = np.radians(135) * 2
    assert shape["volume"] == pytest.approx(np.pi * 0.25 * way, rel=2e-3)
    assert shape["area"] == pytest.approx(np.pi * way + 2 * np.pi * 0.25, rel=2e-3)


def test_twist_keeps_the_volume(kiln: Kiln) -> None:
    spec = """
tolerance = 0.0005
[curve.square.polyline]
points = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
closed = true
[curve.p.line]
from = [0, 0, 0]
to = [0, 0, 4]
[shape.s.sweep]
profile = "square"
path = "p"
twist = 90
"""
    shape = kiln.bake(spec).shape("s")
    assert shape["volume"] == pytest.approx(4, rel=2e-3)
    assert shape["area"] == pytest.approx(16.102221877337733 + 2, rel=2e-3)
    assert shape["closed"]


def test_scale_rotate_and_move_in_that_order(kiln: Kiln) -> None:
    spec = "[shape.s]\nscale = [1, 2, 3]\nrotate = [0, 0, 90]\nat = [10, 0, 0]\n[shape.s.box]\nsize = [1, 1, 1]\n"
    low, high = box_of(kiln.bake(spec).shape("s"))
    np.testing.assert_allclose(low, [9, -0.5, -1.5], atol=1e-6)
    np.testing.assert_allclose(high, [11, 0.5, 1.5], atol=1e-6)


def test_rotations_apply_about_x_then_y_then_z(kiln: Kiln) -> None:
    from scipy.spatial.transform import Rotation

    spec = "[shape.s]\nrotate = [30, 40, 50]\n[shape.s.box]\nsize = [2, 4, 8]\n"
    points, _ = kiln.bake(spec).mesh("s")
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-2, 2) for z in (-4, 4)])
    turned = Rotation.from_euler("xyz", [30, 40, 50], degrees=True).apply(corners)
    for corner in turned:
        assert np.linalg.norm(points - corner, axis=1).min() < 1e-5


def test_mirror_keeps_the_outside_outside(kiln: Kiln) -> None:
    spec = """
[shape.half]
at = [3, 0, 0]
[shape.half.box]
size = [1, 2, 3]
[shape.s.mirror]
of = "half"
plane = "x"
"""
    shape = kiln.bake(spec).shape("s")
    assert shape["volume"] == pytest.approx(12, rel=EXACT)
    assert shape["components"] == 2
    low, high = box_of(shape)
    np.testing.assert_allclose([low[0], high[0]], [-3.5, 3.5], atol=1e-6)


def test_mirror_in_any_plane(kiln: Kiln) -> None:
    spec = """
[shape.s.mirror]
of = { box = { size = [1, 1, 1], center = [2, 0, 0] } }
plane = { normal = [1, 1, 0], point = [0, 0, 0] }
keep = false
"""
    shape = kiln.bake(spec).shape("s")
    np.testing.assert_allclose(shape["centroid"], [0, -2, 0], atol=1e-6)
    assert shape["volume"] == pytest.approx(1, rel=EXACT)


def test_array_in_a_block(kiln: Kiln) -> None:
    spec = "[shape.s.array]\nof = { box = { size = [1, 1, 1] } }\ncount = [3, 2, 4]\noffset = [2, 3, 4]\n"
    shape = kiln.bake(spec).shape("s")
    assert shape["components"] == 24
    assert shape["volume"] == pytest.approx(24, rel=EXACT)
    low, high = box_of(shape)
    np.testing.assert_allclose(high - low, [5, 4, 13], atol=1e-5)


def test_array_around_an_axis(kiln: Kiln) -> None:
    spec = "[shape.s.array]\nof = { box = { size = [1, 1, 1], center = [4, 0, 0] } }\ncount = 8\nrotate = [0, 45, 0]\n"
    shape = kiln.bake(spec).shape("s")
    assert shape["components"] == 8
    np.testing.assert_allclose(shape["centroid"], [0, 0, 0], atol=1e-5)
    low, high = box_of(shape)
    np.testing.assert_allclose(high, [4.5, 0.5, 4.5], atol=1e-5)
    np.testing.assert_allclose(low, [-4.5, -0.5, -4.5], atol=1e-5)


def test_group_is_one_mesh_with_a_primitive_for_each_material(kiln: Kiln) -> None:
    spec = """
[shape.a]
material = "red"
[shape.a.box]
size = [1, 1, 1]
[shape.b]
material = "blue"
at = [3, 0, 0]
[shape.b.box]
size = [1, 1, 1]
[shape.s.group]
of = ["a", "b"]
[material.red]
color = "#ff0000"
[material.blue]
color = "#0000ff"
"""
    asset = kiln.bake(spec)
    assert list(asset.report["shapes"]) == ["s"]
    assert asset.shape("s")["primitives"] == 2
    assert asset.report["totals"]["materials"] == 2
    colors = [m["pbrMetallicRoughness"]["baseColorFactor"] for m in asset.document.json["materials"]]
    assert [1, 0, 0, 1] in colors
    assert [0, 0, 1, 1] in colors


def test_nodes_that_name_one_shape_share_its_mesh(kiln: Kiln) -> None:
    spec = """
[shape.s.box]
size = [1, 1, 1]
[node.left]
shape = "s"
at = [-2, 0, 0]
[node.right]
shape = "s"
at = [2, 0, 0]
rotate = [0, 90, 0]
parent = "left"
"""
    asset = kiln.bake(spec)
    assert asset.report["totals"]["meshes"] == 1
    assert len(asset.document.instances) == 2
    places = sorted(world[0, 3] for _, world in asset.document.instances)
    np.testing.assert_allclose(places, [-2, 0], atol=1e-6)


def test_inline_mesh(kiln: Kiln) -> None:
    spec = """
[shape.s.mesh]
points = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1], [0.5, 1, 0.5]]
faces = [[0, 1, 2, 3], [1, 0, 4], [2, 1, 4], [3, 2, 4], [0, 3, 4]]
"""
    shape = kiln.bake(spec).shape("s")
    assert shape["volume"] == pytest.approx(1 / 3, rel=EXACT)
    assert shape["triangles"] == 6
    polygons = shape["polygons"]
    assert (polygons["vertices"], polygons["edges"], polygons["faces"]) == (5, 8, 5)
