"""Heat maps of `kiln render` against closed forms, the report, and numbers computed again from the file."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

ROOT = Path(__file__).resolve().parents[2]
TORUS = "[shape.ring]\nsegments = [128, 64]\n[shape.ring.torus]\nradius = 1\ntube-radius = 0.25\n"
# Single precision.
ROUNDING = 1e-6


def shown(kiln: Kiln, file: str, heat: str, *options: str) -> dict[str, Any]:
    """What a heat map says of itself."""
    done = kiln.run("render", file, "--heat", heat, "-o", "heat.png", "--size", "256", "--format", "json", *options)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(line for line in map(json.loads, done.stdout.splitlines()) if "heat" in line)


def gallery(kiln: Kiln, spec: str, *options: str) -> Baked:
    """A spec of the gallery, baked with what it reads beside it."""
    shutil.copytree(ROOT / "specs", kiln.folder / "specs", dirs_exist_ok=True)
    done = kiln.run("bake", f"specs/{spec}.toml", "--out", "out", *options)
    assert done.returncode == 0, done.stderr
    return kiln.baked(spec.rsplit("/", 1)[-1])


@pytest.mark.parametrize("spec", ["turned/vase", "swept/spring", "patches/teapot", "lofted/rowboat", "machine/gear"])
def test_the_greatest_deviation_is_that_of_the_report(kiln: Kiln, spec: str) -> None:
    report = gallery(kiln, spec, "--measure").report
    measured = max(shape["deviation"]["measured"] for shape in report["shapes"].values())
    found = shown(kiln, f"specs/{spec}.toml", "deviation")
    assert measured > 0
    assert found["greatest"] == pytest.approx(measured, rel=ROUNDING)
    assert (found["low"], found["high"]) == (0, found["greatest"])


def test_curvature_is_that_of_closed_forms(kiln: Kiln) -> None:
    """Of a ball 1 / radius; of a torus 1 / its tube; of a box none. Triangles are a twentieth of the tube wide."""
    kiln.write("[shape.ball]\nsegments = [64, 32]\n[shape.ball.sphere]\nradius = 0.5\n")
    assert shown(kiln, "model.toml", "curvature")["greatest"] == pytest.approx(2, rel=0.01)
    kiln.write(TORUS)
    assert shown(kiln, "model.toml", "curvature")["greatest"] == pytest.approx(4, rel=0.01)
    kiln.write("[shape.s.box]\nsize = [1, 2, 3]\n")
    assert shown(kiln, "model.toml", "curvature")["greatest"] == pytest.approx(0, abs=1e-9)


def jacobians(baked: Baked) -> NDArray[np.float64]:
    """For each triangle how texture coordinates become places, as 3 by 2 matrices."""
    found = []
    for mesh in baked.document.meshes:
        for part in mesh.surfaces:
            corners = part.indices.reshape(-1, 3)
            places = part.attributes["POSITION"].astype(float)[corners]
            uvs = part.attributes["TEXCOORD_0"].astype(float)[corners]
            sides = np.stack([places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]], axis=2)
            picture = np.stack([uvs[:, 1] - uvs[:, 0], uvs[:, 2] - uvs[:, 0]], axis=2)
            whole = np.abs(np.linalg.det(picture)) > 0
            found.append(sides[whole] @ np.linalg.inv(picture[whole]))
    return np.concatenate(found)


def test_stretch_and_density_are_those_of_singular_values(kiln: Kiln) -> None:
    baked = gallery(kiln, "built/crate")
    values = np.linalg.svd(jacobians(baked), compute_uv=False)
    stretch = shown(kiln, "out/crate.glb", "uv-stretch")
    assert stretch["low"] == 1
    # Single precision of coordinates, magnified where triangles are thin.
    assert stretch["greatest"] == pytest.approx((values[:, 0] / values[:, 1]).max(), rel=1e-3)
    with Image.open(ROOT / "specs" / "inputs" / "crate-color.png") as image:
        texels = image.size[0] * image.size[1]
    density = shown(kiln, "out/crate.glb", "texel-density")
    assert density["greatest"] == pytest.approx(np.sqrt(texels / (values[:, 0] * values[:, 1])).max(), rel=1e-3)


def test_weights_are_those_of_the_file(kiln: Kiln) -> None:
    baked = gallery(kiln, "motion/fish")
    head = baked.document.json["skins"][0]["joints"]
    names = [baked.document.json["nodes"][joint].get("name") for joint in head]
    (part,) = [part for mesh in baked.document.meshes for part in mesh.surfaces if "JOINTS_0" in part.attributes][:1]
    joints, weights = (part.attributes[name].astype(float) for name in ("JOINTS_0", "WEIGHTS_0"))
    weights = weights / weights.sum(axis=1, keepdims=True)
    for number, name in enumerate(names):
        carried = (weights * (joints == number)).sum(axis=1).max()
        found = shown(kiln, "out/fish.glb", f"weights:{name}")
        assert found["greatest"] == pytest.approx(carried, abs=0.005)
        assert (found["low"], found["high"]) == (0, 1)


def test_levels_of_detail_have_a_color_each(kiln: Kiln) -> None:
    """A ball of three levels beside a box of one, which shows that whatever is asked for."""
    text = "tolerance = 0.001\n[lod]\nlevels = 3\n[shape.ball.sphere]\nradius = 1\n"
    kiln.write(text + "[shape.box]\nat = [3, 0, 0]\n[shape.box.box]\nsize = [1, 1, 1]\n")
    for level in range(3):
        found = shown(kiln, "model.toml", "lod", "--lod", str(level), "--view", "front")
        assert (found["low"], found["high"], found["greatest"]) == (0, 2, level)
        picture = np.asarray(Image.open(kiln.folder / "heat.png"))[:, :256, :3].astype(int)
        across = np.flatnonzero((picture != picture[0, 0]).any(axis=2).any(axis=0))
        middle = [picture[128, int(across[0] + share * (across[-1] - across[0]))] for share in (0.2, 0.9)]
        # From violet, where there is no green, over blue-green to yellow; the box keeps the first.
        green = [int(pixel[1]) for pixel in middle]
        assert green[1] < 40, middle
        assert [green[0] < 40, 80 < green[0] < 160, green[0] > 160][level], middle


def test_the_scale_stands_beside_the_picture(kiln: Kiln) -> None:
    kiln.write(TORUS)
    shown(kiln, "model.toml", "curvature", "--background", "#ffffff")
    picture = np.asarray(Image.open(kiln.folder / "heat.png"))
    assert picture.shape[0] == 256
    scale = picture[:, 256:, :3].reshape(-1, 3).tolist()
    # The first and the last color of the bar, and ink of letters.
    for color in ([0x44, 0x01, 0x54], [0xFD, 0xE7, 0x25], [0x30, 0x34, 0x38]):
        assert color in scale
    model = picture[:, :256, :3].reshape(-1, 3)
    assert len(np.unique(model, axis=0)) > 50


def test_what_cannot_be_shown_is_said(kiln: Kiln) -> None:
    kiln.bake(TORUS)
    for file, heat, code, words in (
        ("out/model.glb", "deviation", 1, "name a document"),
        ("model.toml", "texel-density", 1, "no material has a color texture"),
        ("model.toml", "lod", 1, "one level of detail"),
        ("model.toml", "uv-stretch", 1, "no mesh has texture coordinates"),
        ("model.toml", "weights:hip", 1, "the file has no skin"),
        ("model.toml", "weights", 2, "weights:JOINT"),
        ("model.toml", "warmth", 2, "curvature"),
    ):
        done = kiln.run("render", file, "--heat", heat, "-o", "x.png")
        assert done.returncode == code, done.stderr
        assert words in done.stderr
        assert not (kiln.folder / "x.png").exists()
    done = kiln.run("render", "model.toml", "--heat", "curvature", "-o", "x.svg")
    assert done.returncode == 2
