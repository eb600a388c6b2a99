"""Pictures of the preview against Blender's: what covers a pixel, by two programs that share no code."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image, ImageSequence

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
SIZE = 400
SILHOUETTES = ROOT / "scripts" / "engines" / "blender_silhouettes.py"
SPECS = ["chess/rook", "patches/teapot", "solids/bracket", "formula/seashell", "rope/torus-knot", "garden/fence"]


@pytest.mark.parametrize("spec", SPECS)
def test_silhouettes_are_those_of_blender(kiln: Kiln, tmp_path: Path, spec: str) -> None:
    """Intersection over union at least 0.99, and opacities equal in the mean to half a percent."""
    name = spec.rsplit("/", 1)[-1]
    kiln.run("bake", str(ROOT / "specs" / f"{spec}.toml"), "--root", str(ROOT), "--out", str(tmp_path))
    file, picture = tmp_path / f"{name}.glb", tmp_path / f"{name}.png"
    view = ["--view", "30,20", "--orthographic", "--background", "transparent", "--size", str(SIZE)]
    kiln.run("render", str(file), "--out", str(picture), *view)
    own = np.asarray(Image.open(picture), dtype=float)[:, :, 3] / 255.0
    out, asked = tmp_path / "silhouette.npy", tmp_path / "asked.json"
    job = {"path": str(file), "hidden": [], "out": str(out)}
    asked.write_text(json.dumps({"size": SIZE, "view": [30, 20], "files": [job]}))
    line = [sys.executable, str(SILHOUETTES), str(asked), str(tmp_path / "cameras.json")]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "scripts")}
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
    other = np.load(out)
    both, either = np.minimum(own, other).sum(), np.maximum(own, other).sum()
    assert both / either >= 0.99, f"{both / either:.4f}"
    assert abs(own.mean() - other.mean()) <= 0.005 * other.mean()
    # A picture that is nothing but background would agree with itself.
    assert 0.02 < own.mean() < 0.9


def test_pictures_through_a_camera_of_the_document(kiln: Kiln) -> None:
    """A ball seen through a lens of 40 degrees covers the disk of the cone that touches it."""
    ball = "tolerance = 1e-4\n[shape.ball]\nat = [0.3, 0.2, 0]\n[shape.ball.sphere]\nradius = 1\n"
    eye = "[node.ball]\nshape = 'ball'\n[node.eye]\nat = [0.3, 0.2, 5]\n[node.eye.camera]\nfield-of-view = 40\n"
    # A wall that reaches from before the eye to behind it, to its right.
    wall = "[shape.wall]\nat = [2.3, 0.2, 5]\n[shape.wall.box]\nsize = [0.1, 0.1, 12]\n[node.wall]\nshape = 'wall'\n"
    pixels = []
    for name, text in [("ball", ball + eye), ("wall", ball + wall + eye)]:
        kiln.write(text, name)
        options = ["--camera", "eye", "--size", "400x300", "--background", "transparent", "--no-shadows"]
        done = kiln.run("render", f"{name}.toml", "-o", f"{name}.png", *options)
        assert done.returncode == 0, done.stderr
        pixels.append(np.asarray(Image.open(kiln.folder / f"{name}.png"), dtype=float)[:, :, 3] / 255.0)
    radius = 150 / np.tan(np.radians(20)) * np.tan(np.arcsin(1 / 5))
    rows, columns = np.mgrid[0:300, 0:400] + 0.5
    away = np.hypot(rows - 150, columns - 200)
    assert np.all(pixels[0][away < radius - 1] == 1.0)
    assert np.all(pixels[0][away > radius + 1] == 0.0)
    # The side that is seen stands 1.95 to the right and is 0.1 high: at the border so high as the lens alone says.
    right = pixels[1][:, 399] > 0.5
    height = 0.05 * 199.5 / 1.95
    middle = np.abs(np.arange(300) + 0.5 - 150)
    assert right[middle < height - 1].all()
    assert not right[middle > height + 1].any()


@pytest.mark.parametrize("background", ["#e6e8ec", "transparent"])
def test_a_gif_shows_the_pictures_of_an_apng(kiln: Kiln, background: str) -> None:
    """The same pictures by another reader: as many, as long, and of colors near to them."""
    spec = str(ROOT / "specs" / "turned" / "vase.toml")
    frames = {}
    for ending in ("gif", "apng"):
        words = ["--turntable", "5", "--size", "300x200", "--background", background, "--root", str(ROOT)]
        done = kiln.run("render", spec, "-o", f"turn.{ending}", *words)
        assert done.returncode == 0, done.stderr
        with Image.open(kiln.folder / f"turn.{ending}") as image:
            assert (image.size, image.n_frames) == ((300, 200), 5)
            assert image.info["duration"] == 800
            assert image.info["loop"] == 0
            frames[ending] = [np.asarray(frame.convert("RGBA")).astype(int) for frame in ImageSequence.Iterator(image)]
    assert len({frame.tobytes() for frame in frames["gif"]}) == 5
    for few, all_ in zip(frames["gif"], frames["apng"], strict=True):
        there = all_[:, :, 3] >= 128
        assert (few[:, :, 3] == np.where(there, 255, 0)).all()
        apart = np.abs(few - all_)[there][:, :3]
        # 255 colors for all five: parts of 8 bits are cut to 5, which is 8 steps.
        assert apart.mean() < 4
        assert np.quantile(apart, 0.99) <= 16
    assert kiln.run("render", spec, "-o", "still.gif", "--root", str(ROOT)).returncode == 2


def test_a_gif_of_very_many_words_is_read(kiln: Kiln) -> None:
    """Noise, of which each pixel is a word: the table of words is full many times."""
    rng = np.random.default_rng(5)
    Image.fromarray(rng.integers(0, 256, (256, 256, 3), dtype=np.uint8)).save(kiln.folder / "noise.png")
    material = '[material.m]\ncolor-texture = "noise.png"\nunlit = true\n'
    kiln.write(f'[shape.s]\nmaterial = "m"\n[shape.s.plane]\nsize = [1, 1]\n{material}')
    for ending in ("gif", "apng"):
        done = kiln.run(
            "render", "model.toml", "-o", f"n.{ending}", "--turntable", "2", "--size", "400", "--view", "top"
        )
        assert done.returncode == 0, done.stderr
    with Image.open(kiln.folder / "n.gif") as few, Image.open(kiln.folder / "n.apng") as all_:
        pixels = [np.asarray(image.convert("RGB")).astype(int) for image in (few, all_)]
    assert len(np.unique(pixels[0].reshape(-1, 3), axis=0)) > 200
    # 255 of all colors: about six in each direction.
    assert np.abs(pixels[0] - pixels[1]).mean() < 16
