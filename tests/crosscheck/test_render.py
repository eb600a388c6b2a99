"""Pictures of the preview against Blender's: what covers a pixel, by two programs that share no code."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).resolve().parents[2]
SIZE = 400
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
    out = tmp_path / "silhouette.npy"
    line = [
        sys.executable,
        str(Path(__file__).parent / "blender_silhouette.py"),
        str(file),
        str(SIZE),
        "30",
        "20",
        str(out),
    ]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "scripts")}
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
    other = np.load(out)
    both, either = np.minimum(own, other).sum(), np.maximum(own, other).sum()
    assert both / either >= 0.99, f"{both / either:.4f}"
    assert abs(own.mean() - other.mean()) <= 0.005 * other.mean()
    # A picture that is nothing but background would agree with itself.
    assert 0.02 < own.mean() < 0.9
