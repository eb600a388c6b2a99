"""Capitals and digits as strokes: each glyph is polylines on a grid 4 wide and 6 high, y down."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inputs.picture import Color, Picture, Point

WIDTH, HEIGHT, GAP = 4.0, 6.0, 1.7

# Corner-cut octagons stand for round forms: the strokes stay crisp at small sizes.
ROUND = "10 30 41 45 36 16 05 01 10"
GLYPHS = {
    " ": "",
    ".": "16 16",
    "A": "06 20 46|14 34",
    "B": "00 30 41 42 33 03|33 44 45 36 06 00",
    "C": "41 30 10 01 05 16 36 45",
    "D": "00 30 41 45 36 06 00",
    "E": "40 00 06 46|03 33",
    "F": "40 00 06|03 33",
    "G": "41 30 10 01 05 16 36 45 43 23",
    "H": "00 06|40 46|03 43",
    "I": "20 26",
    "K": "00 06|40 03 46",
    "L": "00 06 46",
    "M": "06 00 23 40 46",
    "N": "06 00 46 40",
    "O": ROUND,
    "P": "06 00 30 41 42 33 03",
    "R": "06 00 30 41 42 33 03|23 46",
    "S": "41 30 10 01 02 13 33 44 45 36 16 05",
    "T": "00 40|20 26",
    "U": "00 05 16 36 45 40",
    "V": "00 26 40",
    "Y": "00 23 40|23 26",
    "0": ROUND + "|41 05",
    "1": "11 20 26",
    "2": "01 10 30 41 42 06 46",
    "5": "40 00 02 32 43 45 36 16 05",
    "7": "00 40 16",
}


def width_of(text: str, height: float, spacing: float = GAP) -> float:
    """The width of a line of text, in pixels."""
    return (len(text) * (WIDTH + spacing) - spacing) * height / HEIGHT


def write(picture: Picture, text: str, center: Point, height: float, stroke: float, color: Color) -> None:
    """Draw a line of text about `center`; `height` and `stroke` (the pen's width) in pixels."""
    unit = height / HEIGHT
    left, top = center[0] - width_of(text, height) / 2, center[1] - height / 2
    for position, letter in enumerate(text):
        start = left + position * (WIDTH + GAP) * unit
        for polyline in filter(None, GLYPHS[letter].split("|")):
            points = [(start + int(p[0]) * unit, top + int(p[1]) * unit) for p in polyline.split()]
            for a, b in pairwise(points):
                picture.line(a, b, stroke, color)
