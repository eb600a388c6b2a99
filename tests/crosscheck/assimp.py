"""Asset Import Library's command line: another reader of the classical formats, and a writer of some."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


def export(source: Path, target: Path) -> None:
    """Turn a file into another format, told by the ending of its name."""
    done = subprocess.run(
        ["assimp", "export", str(source), str(target)], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert target.exists(), done.stdout + done.stderr


def triangles(source: Path) -> NDArray[np.float64]:
    """The corners of all triangles of a file as assimp reads it, shape (n, 3, 3): the scene's transforms applied."""
    target = source.with_suffix(".assimp.obj")
    export(source, target)
    points, faces = [], []
    for line in target.read_text(encoding="utf-8").splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append([float(part) for part in rest[:3]])
        elif word == "f":
            corners = [int(part.split("/")[0]) - 1 for part in rest]
            faces += [[corners[0], *corners[k : k + 2]] for k in range(1, len(corners) - 1)]
    return np.array(points)[np.array(faces)]
