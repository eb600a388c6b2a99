"""`kiln render --exact` against closed forms, and against the ordinary picture of the whole gallery."""

from __future__ import annotations

import json
import re
import shutil
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Kiln

    Array = NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
SIZE = 200
# Documents without a shape are there for others to include.
SPECS = sorted(
    str(path.relative_to(ROOT / "specs").with_suffix(""))
    for path in (ROOT / "specs").glob("*/*.toml")
    if re.search(r"^\[(shape|import)\.", path.read_text(encoding="utf-8"), re.MULTILINE)
)
# An eye on +z that sees a square of side 4 in parallel lines, or a cone of 40 degrees.
EYES = {
    "parallel": ("height = 4", 6.0),
    "meeting": ("field-of-view = 40", 7.0),
}


def draw(kiln: Kiln, file: str, out: str, *options: str) -> tuple[NDArray[np.uint8], list[dict[str, Any]]]:
    """A picture with its opacity, and what the program says of it."""
    done = kiln.run("render", file, "-o", out, "--background", "transparent", "--format", "json", *options, seconds=600)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return np.asarray(Image.open(kiln.folder / out).convert("RGBA")), [line for line in lines if "drawn" in line]


def spec(shape: str, eye: str) -> str:
    """A shape, and a camera that looks at it along -z."""
    lens, away = EYES[eye]
    return (
        f'tolerance = 0.02\n{shape}\n[node.model]\nshape = "a"\nrotate = [25, 40, 0]\n'
        f"[node.eye]\nat = [0, 0, {away}]\n[node.eye.camera]\n{lens}\n"
    )


def lines_of_sight(eye: str) -> tuple[Array, Array]:
    """A point and a direction for the middle of each pixel."""
    steps = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    x, y = np.meshgrid(steps, -steps)
    flat, one = np.zeros_like(x), np.ones_like(x)
    if eye == "parallel":
        return np.stack([2 * x, 2 * y, 6 * one], -1), np.stack([flat, flat, -one], -1)
    half = np.tan(np.radians(20))
    return np.stack([flat, flat, 7 * one], -1), np.stack([half * x, half * y, -one], -1)


def turned() -> Array:
    """The rotation of the node: about x first, then y, then z."""
    a, b = np.radians(25), np.radians(40)
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    return about_y @ about_x


def ellipsoid(half: Array) -> Callable[[Array, Array], tuple[Array, Array]]:
    """The first place of lines on an ellipsoid (not a number where they miss it) with its normal."""

    def hit(start: Array, way: Array) -> tuple[Array, Array]:
        p, d = start / half, way / half
        a, b, c = (d * d).sum(-1), (p * d).sum(-1), (p * p).sum(-1) - 1
        with np.errstate(invalid="ignore"):
            away = (-b - np.sqrt(b * b - a * c)) / a
        point = start + way * away[..., None]
        return away, point / half**2

    return hit


def torus(start: Array, way: Array) -> tuple[Array, Array]:
    """The same of a torus of radii 1.2 and 0.4, by the roots of its quartic."""
    major, minor = 1.2, 0.4
    away = np.full(start.shape[:-1], np.nan)
    for place in np.ndindex(away.shape):
        p, d = start[place], way[place]
        square = np.array([d @ d, 2 * (p @ d), p @ p + major**2 - minor**2])
        flat = np.array([d[0] ** 2 + d[2] ** 2, 2 * (p[0] * d[0] + p[2] * d[2]), p[0] ** 2 + p[2] ** 2])
        roots = np.roots(np.polysub(np.polymul(square, square), 4 * major**2 * flat))
        real = roots.real[np.abs(roots.imag) < 1e-7]
        if len(real):
            away[place] = real.min()
    point = start + way * away[..., None]
    ring = np.hypot(point[..., 0], point[..., 2])
    inward = 1 - major / ring
    return away, np.stack([point[..., 0] * inward, point[..., 1], point[..., 2] * inward], -1)


SHAPES = {
    "sphere": ("[shape.a.sphere]\nradius = 1.5", ellipsoid(np.array([1.5, 1.5, 1.5]))),
    "ellipsoid": (
        '[shape.a.quadric]\nxx = 0.390625\nyy = "= 1 / 0.49"\nzz = "= 1 / 1.21"\nconstant = -1',
        ellipsoid(np.array([1.6, 0.7, 1.1])),
    ),
    "torus": ("[shape.a.torus]\nradius = 1.2\ntube-radius = 0.4", torus),
}


def linear(color: NDArray[np.uint8]) -> Array:
    """Colors of a screen back to numbers."""
    part = color / 255.0
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def inner(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Pixels that look as their eight neighbors do."""
    same = np.ones_like(mask)
    padded = np.pad(mask, 1, mode="edge")
    for down in range(3):
        for right in range(3):
            same &= padded[down : down + SIZE, right : right + SIZE] == mask
    return same


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("shape", SHAPES)
def test_silhouettes_and_normals_are_those_of_closed_forms(kiln: Kiln, shape: str, eye: str) -> None:
    text, hit = SHAPES[shape]
    kiln.write(spec(text, eye))
    options = ("--exact", "--camera", "eye", "--size", str(SIZE), "--shading", "normals")
    picture, told = draw(kiln, "model.toml", "exact.png", *options)
    assert [one["drawn"] for one in told] == ["field"]
    turn = turned()
    start, way = lines_of_sight(eye)
    away, normal = hit(start @ turn, way @ turn)
    seen = ~np.isnan(away)
    sure = inner(seen)
    covered = picture[..., 3]
    assert (covered[sure & seen] == 255).all()
    assert (covered[sure & ~seen] == 0).all()
    normal = normal @ turn.T
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    found = linear(picture[..., :3]) * 2 - 1
    # Where neighbors lie on one sheet, the picture has the normal of the middle of a pixel: eight bits of a screen's
    # scale, coarsest near white, and half a pixel between the middle of its samples and its own.
    depth = np.where(seen, away, 0)
    jump = np.max([np.abs(np.gradient(depth, axis=axis)) for axis in (0, 1)], axis=0)
    flat = sure & seen & (jump < 0.1)
    off = np.abs(found - normal).max(axis=-1)[flat]
    assert flat.sum() > 0.5 * seen.sum()
    assert off.max() < 0.03


def test_the_mesh_comes_nearer_as_its_tolerance_falls(kiln: Kiln) -> None:
    body = "[shape.a.torus]\nradius = 1\ntube-radius = 0.4\n"
    options = ("--size", "160", "--shading", "normals", "--view", "corner")
    shares = []
    for tolerance in (0.1, 0.02, 0.004, 0.0008):
        kiln.write(f"tolerance = {tolerance}\n{body}")
        exact, _ = draw(kiln, "model.toml", "exact.png", "--exact", *options)
        mesh, _ = draw(kiln, "model.toml", "mesh.png", *options)
        far = np.abs(exact.astype(int) - mesh.astype(int)).max(axis=-1) > 4
        shares.append(far.sum() / (exact[..., 3] > 0).sum())
    assert all(after < 0.7 * before for before, after in pairwise(shares)), shares
    assert shares[-1] < 0.02, shares


@pytest.mark.parametrize("name", SPECS)
def test_the_gallery_has_the_silhouette_of_its_surfaces(kiln: Kiln, name: str) -> None:
    shutil.copytree(ROOT / "specs", kiln.folder / "specs")
    file = f"specs/{name}.toml"
    exact, told = draw(kiln, file, "exact.png", "--exact", "--size", "96")
    mesh, _ = draw(kiln, file, "mesh.png", "--size", "96")
    assert told
    assert all(one["pixels"] < 1 for one in told if one["drawn"] in ("proved", "sampled")), told
    # How much of each pixel is covered. Where a mesh is coarse beside its own small parts, what it lacks is a seam
    # along its rim, no wider than it lies from its surface.
    one, other = (picture[..., 3] / 255.0 for picture in (exact, mesh))
    shared = np.minimum(one, other).sum() / np.maximum(one, other).sum()
    rim = ((other > 0) & (other < 1)).sum()
    wide = np.abs(one - other).sum() / rim
    assert shared >= 0.99 or wide <= max(shape["pixels"] for shape in told), (shared, wide)


def test_the_same_bytes_with_any_number_of_threads(kiln: Kiln, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(ROOT / "specs", kiln.folder / "specs")
    found = []
    for threads in ("1", "3"):
        monkeypatch.setenv("RAYON_NUM_THREADS", threads)
        draw(kiln, "specs/quadrics/crisps.toml", "x.png", "--exact", "--size", "96")
        found.append((kiln.folder / "x.png").read_bytes())
    assert found[0] == found[1]


def test_what_has_no_surface_of_its_own_is_told(kiln: Kiln) -> None:
    kiln.write(
        "[shape.box.box]\nsize = [1, 1, 1]\n[shape.ball.sphere]\nradius = 0.6\n"
        "[shape.bore.cylinder]\nradius = 0.3\nheight = 3\n"
        '[shape.left.difference]\nof = ["box", "bore"]\n'
        "[shape.jug.revolve]\nprofile = { polyline = { points = [[0.3, 0], [0.4, 0.5], [0.2, 1]] } }\n"
        "[shape.die.box]\nsize = [1, 1, 1]\n"
        '[node.left]\nshape = "left"\n[node.ball]\nshape = "ball"\nat = [2, 0, 0]\n'
        '[node.jug]\nshape = "jug"\nat = [4, 0, 0]\n[node.die]\nshape = "die"\nat = [6, 0, 0]\n'
    )
    _, told = draw(kiln, "model.toml", "x.png", "--exact", "--size", "96")
    drawn = {one["shape"]: one["drawn"] for one in told}
    assert drawn == {"left": "field", "ball": "field", "jug": "proved", "die": "mesh"}


def test_what_cannot_be_drawn_so_is_refused(kiln: Kiln) -> None:
    kiln.bake("[shape.a.sphere]\nradius = 1\n")
    for arguments, words in (
        (("out/model.glb",), "the document that it was baked from"),
        (("model.toml", "-o", "x.svg"), "edges of triangles"),
        (("model.toml", "--heat", "deviation"), "--heat"),
        (("model.toml", "--lod", "1"), "no levels of detail"),
    ):
        done = kiln.run("render", *arguments, "--exact")
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
    assert not list(kiln.folder.glob("*.png"))
    assert not list(kiln.folder.glob("*.svg"))
