"""Files drawn by three.js in a browser cover what Blender covers of the `core` file, in every profile that it reads."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.ndimage import binary_dilation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SIZE = 360
VIEW = ("30", "25")
PROFILES = ("core", "quantized", "web", "three")
# Solids, what joints carry, what stands in many places at once, what is turned and levels of detail.
SPECS = ["solids/mug", "motion/arm", "garden/orchard", "levels/amphora"]


def grown(covered: NDArray[np.bool_], pixels: int) -> NDArray[np.bool_]:
    return binary_dilation(covered, np.ones((3, 3), bool), iterations=pixels)


@pytest.mark.parametrize("spec", SPECS)
def test_silhouettes_are_those_of_blender(kiln: Kiln, spec: str) -> None:
    path = ROOT / "specs" / f"{spec}.toml"
    line = ("bake", str(path), "--root", str(ROOT), "--out", str(kiln.folder / "out"), "--profile", ",".join(PROFILES))
    done = kiln.run(*line)
    assert done.returncode == 0, done.stderr
    name = path.stem
    files = [kiln.folder / "out" / (f"{name}.glb" if p == "core" else f"{name}.{p}.glb") for p in PROFILES]
    blender = kiln.folder / "blender.npy"
    line = [sys.executable, str(HERE / "blender_silhouette.py"), str(files[0]), str(SIZE), *VIEW, str(blender)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "scripts")}
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL, env=environment)
    wanted = np.load(blender) > 0.05
    line = ["node", str(HERE / "silhouettes.mjs"), str(SIZE), *VIEW, *map(str, files)]
    done = subprocess.run(line, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    # That reading a picture back takes time is no fault of the file.
    assert [told for told in found["complaints"] if "ReadPixels" not in told] == []
    assert 0.03 < wanted.mean() < 0.9
    for profile, rows in zip(PROFILES, found["covered"], strict=True):
        covered = np.array([[pixel == "1" for pixel in row] for row in rows])
        # A pixel counts for Blender where anything is in it, and for a browser where its middle is.
        beyond = (covered & ~grown(wanted, 1)).sum()
        missing = (wanted & ~grown(covered, 2)).sum()
        assert beyond <= 2, (profile, beyond)
        assert missing <= 0.002 * wanted.sum(), (profile, missing)
