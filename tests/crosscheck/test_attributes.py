"""Normals, texture coordinates and tangents as written, against closed forms and Blender's MikkTSpace."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

from checks.document import Document
from inputs.picture import Picture
from test_blender import model

if TYPE_CHECKING:
    from kiln import Baked, Kiln

TEXTURED = '[material.m]\ncolor-texture = "t.png"\n'
MAPPED = '[material.m]\nnormal-texture = "t.png"\n'
POT = """
tolerance = 0.002
[curve.c.bezier]
points = [[0.2, 0.0], [0.9, 0.0], [1.2, 0.5], [1.0, 1.0]]
[shape.s]
material = "m"
[shape.s.revolve]
profile = "c"
"""


def picture(kiln: Kiln) -> None:
    Picture(4, 4, (128, 128, 255)).write(kiln.folder / "t.png")


def attribute(asset: Baked, name: str) -> np.ndarray:
    """An attribute of all primitives, one row a vertex."""
    primitives = [p for mesh in asset.document.meshes for p in mesh.primitives]
    return np.concatenate([p.attributes[name] for p in primitives]).astype(float)


def names(asset: Baked) -> set[str]:
    return {name for mesh in asset.document.meshes for p in mesh.primitives for name in p.attributes}


def test_normals_of_a_sphere_are_its_points(kiln: Kiln) -> None:
    asset = kiln.bake("tolerance = 0.01\n[shape.s.sphere]\nradius = 2\n")
    np.testing.assert_allclose(attribute(asset, "NORMAL"), attribute(asset, "POSITION") / 2, atol=2e-6)


def test_normals_of_a_torus_are_analytic(kiln: Kiln) -> None:
    spec = 'tolerance = 0.01\n[curve.c.circle]\nradius = 0.4\ncenter = [1.2, 0]\n[shape.s.revolve]\nprofile = "c"\n'
    asset = kiln.bake(spec)
    points = attribute(asset, "POSITION")
    ring = points * [1, 0, 1]
    ring *= 1.2 / np.linalg.norm(ring, axis=1)[:, None]
    np.testing.assert_allclose(attribute(asset, "NORMAL"), (points - ring) / 0.4, atol=1e-5)


def test_normals_are_unit_and_agree_with_the_facets(kiln: Kiln) -> None:
    picture(kiln)
    for mesh in kiln.bake(POT + TEXTURED).document.meshes:
        for primitive in mesh.primitives:
            normals = primitive.attributes["NORMAL"].astype(float)
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
            a, b, c = (primitive.attributes["POSITION"].astype(float)[primitive.triangles[:, i]] for i in range(3))
            facets = np.cross(b - a, c - a)
            facets /= np.linalg.norm(facets, axis=1)[:, None]
            for corner in range(3):
                agreement = np.einsum("ti,ti->t", facets, normals[primitive.triangles[:, corner]])
                assert agreement.min() > 0.8


def test_cylinder_has_a_hard_edge_at_its_ends(kiln: Kiln) -> None:
    asset = kiln.bake("tolerance = 0.01\n[shape.s.cylinder]\nradius = 1\nheight = 1\n")
    points, normals = attribute(asset, "POSITION"), attribute(asset, "NORMAL")
    flat = np.abs(np.abs(normals[:, 1]) - 1) < 1e-6
    round_ = np.abs(normals[:, 1]) < 1e-6
    assert (flat | round_).all()
    np.testing.assert_allclose(normals[round_], points[round_] * [1, 0, 1], atol=1e-5)


@pytest.mark.parametrize(("smoothing", "vertices"), [("flat", 24), ("smooth", 8)])
def test_smoothing_splits_vertices_only_where_normals_differ(kiln: Kiln, smoothing: str, vertices: int) -> None:
    spec = f'[shape.s]\nsmoothing = "{smoothing}"\n[shape.s.mesh]\n' + (
        "points = [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]]\n"
        "faces = [[0,3,2,1],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]\n"
    )
    assert kiln.bake(spec).shape("s")["vertices"] == vertices


def test_crease_angle_decides_what_is_sharp(kiln: Kiln) -> None:
    """A roof that bends by 40 degrees: two quads share two points."""
    rise = np.tan(np.radians(20))
    mesh = (
        f"[shape.s.mesh]\npoints = [[-1,0,0],[-1,0,1],[0,{rise},0],[0,{rise},1],[1,0,0],[1,0,1]]\n"
        "faces = [[0,1,3,2],[2,3,5,4]]\n"
    )
    for angle, vertices in ((39, 8), (41, 6)):
        asset = kiln.bake(f"[shape.s]\ncrease-angle = {angle}\n{mesh}")
        assert asset.shape("s")["vertices"] == vertices, angle


def test_texture_coordinates_only_where_a_texture_uses_them(kiln: Kiln) -> None:
    picture(kiln)
    assert "TEXCOORD_0" not in names(kiln.bake(POT + '[material.m]\ncolor = "#808080"\n'))
    assert "TEXCOORD_0" in names(kiln.bake(POT + TEXTURED))
    always = POT.replace('material = "m"', 'material = "m"\nuv = "always"')
    assert "TEXCOORD_0" in names(kiln.bake(always + '[material.m]\ncolor = "#808080"\n'))


def test_texture_coordinates_are_in_proportion_to_arc_length(kiln: Kiln) -> None:
    picture(kiln)
    spec = (
        'tolerance = 0.002\n[curve.c.bezier]\npoints = [[1, 0], [1, 0.1], [1, 0.2], [1, 3]]\n'
        '[shape.s]\nmaterial = "m"\n[shape.s.revolve]\nprofile = "c"\ncaps = false\n'
    )  # fmt: skip
    asset = kiln.bake(spec + TEXTURED)
    points, uvs = attribute(asset, "POSITION"), attribute(asset, "TEXCOORD_0")
    assert uvs.min() >= -1e-6
    assert uvs.max() <= 1 + 1e-6
    along = [np.abs(np.corrcoef(uvs[:, i], points[:, 1])[0, 1]) for i in (0, 1)]
    i = int(np.argmax(along))
    fit = np.polyfit(points[:, 1], uvs[:, i], 1)
    np.testing.assert_allclose(np.polyval(fit, points[:, 1]), uvs[:, i], atol=1e-5)


def test_tangents_if_and_only_if_there_is_a_normal_map(kiln: Kiln) -> None:
    picture(kiln)
    assert "TANGENT" not in names(kiln.bake(POT + TEXTURED))
    assert "TANGENT" in names(kiln.bake(POT + MAPPED))


def test_tangents_are_those_of_blenders_mikktspace(kiln: Kiln) -> None:
    picture(kiln)
    for name, spec in {
        "pot": POT,
        "box": '[shape.s]\nmaterial = "m"\n[shape.s.box]\nsize = [1, 2, 3]\n',
        "sphere": 'tolerance = 0.01\n[shape.s]\nmaterial = "m"\n[shape.s.sphere]\nradius = 1\n',
    }.items():
        asset = kiln.bake(spec + MAPPED, name=name)
        own = attribute(asset, "TANGENT")
        made = model(kiln.folder, make="tangents", file=str(asset.path))["tangents"]
        assert len(own) == len(made)
        seen = made[:, 3] > -1.5
        assert seen.all(), name
        # Blender keeps imported normals in 16 bits and MikkTSpace projects onto their plane.
        agreement = np.einsum("vi,vi->v", own[:, :3], made[:, :3])
        assert np.quantile(agreement, 0.02) > 0.999, name
        assert np.mean(own[:, 3] == made[:, 3]) > 0.99, name


def test_tangents_follow_u_and_bitangents_go_up_the_picture(kiln: Kiln) -> None:
    """By the definition alone: glTF's v runs down the picture, the green of a normal map points up."""
    picture(kiln)
    for mesh in kiln.bake(POT + MAPPED).document.meshes:
        for primitive in mesh.primitives:
            get = lambda name, p=primitive: p.attributes[name].astype(float)[p.triangles]  # noqa: E731
            points, uvs, normals, tangents = map(get, ("POSITION", "TEXCOORD_0", "NORMAL", "TANGENT"))
            edges = points[:, 1:] - points[:, :1]
            steps = uvs[:, 1:] - uvs[:, :1]
            along_u, along_v = np.moveaxis(np.linalg.solve(steps, edges), 1, 0)
            bitangents = np.cross(normals[:, 0], tangents[:, 0, :3]) * tangents[:, 0, 3:]
            assert (np.einsum("ti,ti->t", tangents[:, 0, :3], along_u) > 0).mean() > 0.99
            assert (np.einsum("ti,ti->t", bitangents, along_v) < 0).mean() > 0.99


SHADED = """
tolerance = 0.002
[shape.s.vertex-color]
red = "= 0.5 + x / 4"
green = "= 0.5 + ny / 2"
blue = "= 0.5 + z / 4"
[shape.s.sphere]
radius = 1
"""


def test_colors_are_the_formulas_of_place_and_normal(kiln: Kiln) -> None:
    asset = kiln.bake(SHADED)
    points, shades = attribute(asset, "POSITION"), attribute(asset, "COLOR_0")
    np.testing.assert_allclose(shades, 0.5 + points * [0.25, 0.5, 0.25], atol=1e-6)
    facts = asset.shape("s")["colors"]
    np.testing.assert_allclose(facts["min"], [*shades.min(axis=0), 1], atol=1e-7)
    np.testing.assert_allclose(facts["max"], [*shades.max(axis=0), 1], atol=1e-7)


def test_colors_of_small_profiles_are_bytes_near_the_formulas(kiln: Kiln) -> None:
    kiln.bake(SHADED, "--profile", "core", "--profile", "quantized")
    small = Document(kiln.folder / "out" / "model.quantized.glb")
    grid = small.json["asset"]["extras"]["grid"]
    attributes = small.meshes[0].primitives[0].attributes
    points = attributes["POSITION"] * grid["step"] + np.asarray(grid["offset"])
    shades = attributes["COLOR_0"]
    assert shades.dtype == np.uint8
    assert (shades[:, 3] == 255).all()
    # Half a step of a byte, and what normals in bytes and a grid within the tolerance may differ by.
    np.testing.assert_allclose(shades[:, :3] / 255, 0.5 + points * [0.25, 0.5, 0.25], atol=0.5 / 255 + 0.002)


def test_colors_are_read_by_trimesh(kiln: Kiln) -> None:
    asset = kiln.bake(SHADED)
    mesh = next(iter(trimesh.load(asset.path).geometry.values()))
    shades = np.asarray(mesh.visual.vertex_colors) / 255
    wanted = 0.5 + np.asarray(mesh.vertices) * [0.25, 0.5, 0.25]
    assert np.abs(shades[:, :3] - wanted).max() < 1.01 / 255
    assert (shades[:, 3] == 1).all()


MELTING = """
tolerance = 0.004
[shape.s]
at = [1, 2, 3]
[shape.s.implicit]
field = "blobs"
[field.blobs.skeleton]
level = 0.4
elements = [
  { point = [0, 0, 0], radius = 1.0, color = [1, 0, 0] },
  { point = [0.8, 0, 0], radius = 0.9, strength = 1.2, color = [0, 0.5, 1] },
  { point = [0, 0.7, 0], radius = 0.8 },
  { point = [0, 0, 0.6], radius = 0.5, strength = -0.5, color = [0, 1, 0] },
]
"""


def test_colors_of_elements_blend_by_their_shares(kiln: Kiln) -> None:
    asset = kiln.bake(MELTING)
    points, shades = attribute(asset, "POSITION"), attribute(asset, "COLOR_0")
    wyvill = lambda s: np.where(s < 1, 1 - 22 / 9 * s + 17 / 9 * s**2 - 4 / 9 * s**3, 0.0)  # noqa: E731 -- one formula
    # What takes away has no color; what has none is white.
    elements = [
        ([0, 0, 0], 1.0, 1.0, [1, 0, 0]),
        ([0.8, 0, 0], 0.9, 1.2, [0, 0.5, 1]),
        ([0, 0.7, 0], 0.8, 1.0, [1, 1, 1]),
    ]
    local = points - [1, 2, 3]
    squares = [((local - np.asarray(at)) ** 2).sum(axis=1) / radius**2 for at, radius, _, _ in elements]
    shares = np.stack([one[2] * wyvill(square) for one, square in zip(elements, squares, strict=True)])
    wanted = (shares[:, :, None] * np.asarray([one[3] for one in elements])[:, None, :]).sum(axis=0)
    wanted /= shares.sum(axis=0)[:, None]
    np.testing.assert_allclose(shades[:, :3], wanted, atol=1e-5)
    assert len(np.unique(np.round(shades, 3), axis=0)) > 100


@pytest.mark.parametrize("profile", ["core", "three"])
def test_attributes_of_games_are_their_formulas(kiln: Kiln, profile: str) -> None:
    """At each written vertex, computed here from place, normal and texture coordinates; bytes within half a step."""
    spec = (
        "tolerance = 0.001\n[lod]\nlevels = 2\n[shape.s]\nrotate = [0, 90, 0]\nat = [3, 0, 0]\n"
        'attributes = { _WAY = ["= x", "= y * y", "= nz"], _UV = "= u + 2 * v", '
        '_SHARE = { formula = "= 2 * y", form = "byte" } }\n'
        "[shape.s.revolve]\ncaps = false\n"
        "profile = { bezier = { points = [[0.2, 0], [0.9, 0.3], [0.8, 0.7], [0.4, 1]] } }\n"
    )
    kiln.write(spec)
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", profile)
    assert done.returncode == 0, done.stdout + done.stderr
    asset = kiln.baked("model" if profile == "core" else f"model.{profile}")
    grid = asset.report.get("grid")
    for mesh in asset.document.meshes:
        for one in mesh.primitives:
            places = one.attributes["POSITION"].astype(float)
            if grid:
                places = places * grid["step"] + np.array(grid["offset"])
            normals = one.attributes["NORMAL"].astype(float) / (127.0 if grid else 1.0)
            uv = one.attributes["TEXCOORD_0"].astype(float) / (65535.0 if grid else 1.0)
            # Back through the placement: 3 along x, then a quarter turn about y, which brings x to -z and z to x.
            x, y, nz = -places[:, 2], places[:, 1], normals[:, 0]
            way = one.attributes["_WAY"].astype(float)
            np.testing.assert_allclose(way[:, 0], x, atol=2e-6)
            np.testing.assert_allclose(way[:, 1], y * y, atol=2e-6)
            np.testing.assert_allclose(way[:, 2], nz, atol=0.01 if grid else 2e-6)
            np.testing.assert_allclose(one.attributes["_UV"].ravel(), uv @ [1, 2], atol=5e-5 if grid else 2e-6)
            share = one.attributes["_SHARE"].astype(float)[:, 0] / 255.0
            np.testing.assert_allclose(share, np.clip(2 * y, 0, 1), atol=0.5 / 255 + 1e-6)
