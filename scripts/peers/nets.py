"""The surfaces by control points of the bench, as plain Python without any library: the teapot and a domed face.

The teapot's points are those of the gallery's spec. The face is one clamped uniform bicubic B-spline, bent both ways.
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

TEAPOT = Path(__file__).resolve().parents[2] / "specs" / "patches" / "teapot.toml"
# A thousandth of its size: from the handle to the mouth of the spout it is 6.43 long.
TEAPOT_TOLERANCE = 0.0064
# Steps of each patch with which the deviation of the peers is about the same.
TEAPOT_STEPS = 16
FACE_COUNT = 8
FACE_TOLERANCE = 1e-4
DEGREE = 3

Point = list[float]
Grid = list[list[Point]]


def teapot() -> list[Grid]:
    """Thirty-two grids of four by four points, up along z."""
    table = tomllib.loads(TEAPOT.read_text(encoding="utf-8"))["shape"]["teapot"]["patches"]
    points, first = table["points"], table["first"]
    grids = [[points[k - first] for k in patch] for patch in map(flat, table["patches"])]
    return [[grid[row : row + 4] for row in range(0, 16, 4)] for grid in grids]


def flat(patch: list[int] | list[list[int]]) -> list[int]:
    """Sixteen numbers, whether they were written in rows or not."""
    return [k for row in patch for k in (row if isinstance(row, list) else [row])]


def face() -> Grid:
    """Rows of points of a dome over two by two, higher in the middle and leaning."""
    places = [2.0 * k / (FACE_COUNT - 1) - 1.0 for k in range(FACE_COUNT)]
    return [[[x, y, 0.9 * math.cos(1.1 * x) * math.cos(0.9 * y + 0.2 * x)] for x in places] for y in places]


def face_knots() -> list[float]:
    """Clamped and uniform, from 0 to 1."""
    inner = FACE_COUNT - DEGREE - 1
    return [*[0.0] * (DEGREE + 1), *[(k + 1) / (inner + 1) for k in range(inner)], *[1.0] * (DEGREE + 1)]
