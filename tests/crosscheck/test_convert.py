"""Files of other programs written as documents: the same model, and text that people read."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial import cKDTree
from test_import import bring

if TYPE_CHECKING:
    from kiln import Baked, Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"
OURS = ["bird.obj", "fish.glb", "rook.glb", "windmill.3ds", "caterpillar.md2", "beetle.md3", "lamp.md5mesh"]
# Quads, holes, several groups, several materials, colors of vertices, seams, faces that touch along edges.
REAL = [
    "obj/common_spot.obj.gz", "obj/common_suzanne.obj", "obj/fuze.obj", "obj/wallhole.obj", "obj/two_objects.obj",
    "obj/assimp_cube_with_vertexcolors.obj", "obj/assimp_concave_polygon.obj", "obj/cubevt.obj",
    "obj/negative_indices.obj", "stl/featuretype.STL.gz", "stl/multibody.stl", "gltf/cubevc.glb",
    "gltf/BoxInterleaved.glb",
]  # fmt: skip
PLAIN = [1.0, 1.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0]
SINGLE = 2.0**-22
"""The share of a coordinate that single precision may come to."""


def facts(baked: Baked) -> dict[str, Any]:
    """What the written bytes hold, whatever they are called: triangles by place and color."""
    rows = []
    for mesh in baked.document.meshes:
        points, triangles = mesh.merged
        # Each triangle begins at its first corner in the order of places, so that turned ones are the same.
        corners = points[triangles]
        first = np.lexsort(corners.round(5).transpose(2, 0, 1)[::-1], axis=1)[:, 0]
        turned = (first[:, None] + np.arange(3)) % 3
        rows.append(np.take_along_axis(corners, turned[:, :, None], axis=1))
    places = np.concatenate(rows)
    materials = baked.document.json.get("materials", [])
    looks = sorted(look(material) for material in materials)
    return {"triangles": len(places), "places": places, "looks": looks}


def look(material: dict[str, Any]) -> list[float]:
    """A material in numbers."""
    metal = material.get("pbrMetallicRoughness", {})
    rest = [metal.get("metallicFactor", 1.0), metal.get("roughnessFactor", 1.0)]
    return [*metal.get("baseColorFactor", [1.0] * 4), *rest, *material.get("emissiveFactor", [0.0] * 3)]


def volume(places: np.ndarray) -> tuple[float, float]:
    """Signed volume and area of triangles."""
    a, b, c = places.reshape(-1, 3, 3).transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    return float(np.einsum("ij,ij->", a, cross) / 6), float(np.linalg.norm(cross, axis=1).sum() / 2)


def compare(kiln: Kiln, file: str, name: str) -> None:
    """Bake the file once by `import` and once as it is converted."""
    uv = '[shape.m]\nuv = "always"\n'
    imported = facts(kiln.bake(f'{uv}[shape.m.import]\nfile = "{file}"\n', name=f"{name}-imported"))
    done = kiln.run("convert", file, "-o", f"{name}.toml", "--name", "m")
    assert done.returncode == 0, done.stderr
    assert kiln.run("fmt", "--check", f"{name}.toml").returncode == 0
    text = (kiln.folder / f"{name}.toml").read_text(encoding="utf-8")
    converted = facts(kiln.bake(text.replace("[shape.m]\n", uv, 1), name=name))
    assert converted["triangles"] == imported["triangles"]
    mine, theirs = converted["places"], imported["places"]
    size = float(np.abs(theirs).max())
    far = cKDTree(mine.reshape(-1, 9)).query(theirs.reshape(-1, 9))[0].max()
    assert far <= 16 * SINGLE * size, (file, far, size)
    for one, other, power in zip(volume(mine), volume(theirs), (3, 2), strict=True):
        assert abs(one - other) <= 1e-5 * size**power, (file, one, other)
    # Materials that are only names keep these, and look like none.
    named = [look for look in converted["looks"] if look != PLAIN] if not imported["looks"] else converted["looks"]
    assert np.allclose(np.array(named), np.array(imported["looks"]), atol=1e-6), file


@pytest.mark.parametrize("file", OURS)
def test_ours_are_the_same_model(kiln: Kiln, file: str) -> None:
    shutil.copy(INPUTS / file, kiln.folder / file)
    compare(kiln, file, "converted")


@pytest.mark.cases
def test_real_files_are_the_same_model(kiln: Kiln, cases: Path) -> None:
    for number, name in enumerate(REAL):
        compare(kiln, bring(cases, name, kiln.folder), f"real-{number}")


def test_a_cage_keeps_its_polygons(kiln: Kiln) -> None:
    shutil.copy(INPUTS / "bird.obj", kiln.folder / "bird.obj")
    done = kiln.run("convert", "bird.obj", "-o", "bird.toml", "--subdivide", "catmull-clark", "--unit", "cm")
    assert done.returncode == 0, done.stderr
    text = (kiln.folder / "bird.toml").read_text(encoding="utf-8")
    assert 'unit = "cm"' in text
    faces = [line for line in (INPUTS / "bird.obj").read_text(encoding="utf-8").splitlines() if line.startswith("f ")]
    document = tomllib.loads(text)
    assert [len(face) for face in document["shape"]["bird-cage"]["mesh"]["faces"]] == [
        len(line.split()) - 1 for line in faces
    ]
    baked = kiln.bake(text, name="bird")
    imported = kiln.bake(
        'unit = "cm"\n[shape.bird.subdivide]\ncage = { import = { file = "bird.obj" } }\n', name="imported"
    )
    assert [mesh.name for mesh in baked.document.meshes] == ["bird"]
    assert baked.shape("bird")["triangles"] == imported.shape("bird")["triangles"]
    assert baked.shape("bird")["volume"] == pytest.approx(imported.shape("bird")["volume"], rel=1e-6)


def test_refusals_write_nothing(kiln: Kiln) -> None:
    (kiln.folder / "there.toml").write_text("mine", encoding="utf-8")
    (kiln.folder / "noise.obj").write_text("v 0 0 0\n", encoding="utf-8")
    shutil.copy(INPUTS / "bird.obj", kiln.folder / "bird.obj")
    shutil.copy(INPUTS / "label.png", kiln.folder / "label.obj")
    for arguments, code, said in [
        (["bird.obj", "-o", "there.toml"], 3, "there already"),
        (["bird.obj", "-o", "bird.glb"], 2, "ends in .toml"),
        (["bird.obj", "-o", "new.toml", "--name", "My Bird"], 2, "kebab-case"),
        (["noise.obj", "-o", "new.toml"], 1, "no faces"),
        (["label.obj", "-o", "new.toml"], 1, "PNG picture"),
        (["bird.obj", "-o", "new.toml", "--group", "wing"], 1, "wing"),
        (["missing.obj", "-o", "new.toml"], 3, "missing.obj"),
        (["bird.obj", "-o", "new.toml", "--weld=-1"], 2, "distance"),
    ]:
        done = kiln.run("convert", *arguments)
        assert done.returncode == code, (arguments, done.stderr)
        assert said in done.stderr, (arguments, done.stderr)
        assert not (kiln.folder / "new.toml").exists()
    assert (kiln.folder / "there.toml").read_text(encoding="utf-8") == "mine"
    assert kiln.run("convert", "bird.obj", "-o", "there.toml", "--force").returncode == 0


def test_colors_of_points_come_along(kiln: Kiln) -> None:
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    head = "ply\nformat ascii 1.0\nelement vertex 8\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += "".join(f"property uchar {part}\n" for part in ("red", "green", "blue"))
    head += "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [f"{x} {y} {z} {255 * x} {255 * y} {255 * z}" for x, y, z in corners]
    rows += [" ".join(map(str, (4, *face))) for face in faces]
    (kiln.folder / "cube.ply").write_text(head + "\n".join(rows) + "\n", encoding="utf-8")
    compare(kiln, "cube.ply", "cube")
    document = tomllib.loads((kiln.folder / "cube.toml").read_text(encoding="utf-8"))
    mesh = document["shape"]["m"]["mesh"]
    # Red where x is 1, green where y is, blue where z is.
    assert mesh["colors"] == mesh["points"]
    assert [len(face) for face in mesh["faces"]] == [4] * 6
