"""The crate's two pictures, a color and a normal map of one side: a frame, planks, a brace, nails.

Both come from one field of heights and wood tones, 512 x 512 pixels. Normals are those of glTF: x right,
y up, z out of the picture, each channel 127.5 (1 + component), rounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from inputs.picture import Picture, length, to_segment

SIZE = 512
FRAME, PLANKS, GROOVE = 74.0, 5, 4.0
BRACE = 30.0  # half the width of the diagonal board
NAIL = 6.5
STEEPNESS = 1.4
TONES = 40  # distinct wood tones: few enough that the pictures pack well
DARK, LIGHT = (92, 58, 30), (196, 146, 92)


@dataclass(frozen=True)
class Wood:
    """What one pixel shows: height in pixels, tone from 0 (dark) to 1 (light), whether it is a nail."""

    height: float
    tone: float
    nail: bool = False


def draw() -> tuple[Picture, Picture]:
    """The color and the normal map."""
    field = [[wood(x + 0.5, y + 0.5) for x in range(SIZE)] for y in range(SIZE)]
    color, normal = Picture(SIZE, SIZE, LIGHT), Picture(SIZE, SIZE, (128, 128, 255))
    for y, x in product(range(SIZE), range(SIZE)):
        color.blend(x, y, paint(field[y][x]), 1.0)
        normal.blend(x, y, encode(field, x, y), 1.0)
    return color, normal


def wood(x: float, y: float) -> Wood:
    """The boards from the uppermost down: nails, frame, brace, planks."""
    if (nail := nail_at(x, y)) is not None:
        return nail
    inset = min(x, y, SIZE - x, SIZE - y)
    if inset < FRAME:
        upright = min(x, SIZE - x) < FRAME
        board = 11 + (x > SIZE / 2) if upright else 13 + (y > SIZE / 2)
        along, across = (y, x) if upright else (x, y)
        joint = abs(x - FRAME) if not upright and x < SIZE / 2 else abs(SIZE - FRAME - x)
        edges = [inset, FRAME - inset] + ([] if upright else [joint])
        return board_at(along, across, board, min(edges), 9.0)
    off = to_segment((x, y), (0.0, SIZE), (SIZE, 0.0))
    if off < BRACE:
        return board_at(x - y, x + y, 21, min(BRACE - off, inset - FRAME + GROOVE), 5.0)
    width = (SIZE - 2 * FRAME) / PLANKS
    plank, within = divmod(x - FRAME, width)
    return board_at(y, x, int(plank), min(within, width - within), 0.0)


def board_at(along: float, across: float, board: int, edge: float, raised: float) -> Wood:
    """A point of one board: grain along it, rounded at its edge, `edge` pixels away."""
    rings = 0.5 * noise(along / 90, across / 7, board) + 0.3 * noise(along / 40, across / 2.5, board + 50)
    fine = 0.2 * noise(along / 12, across / 1.5, board + 100)
    grain = rings + fine
    drop = max(0.0, GROOVE - edge) / GROOVE
    tint = 0.16 * (noise(board * 3.7, 0.5, 7) - 0.5)
    tone = 0.30 + 0.55 * grain + tint - 0.55 * drop * drop
    return Wood(raised + 1.4 * grain - GROOVE * drop * drop, tone)


def nail_at(x: float, y: float) -> Wood | None:
    """The nail head here, if there is one: two in each corner of the frame and one in each side's middle."""
    x, y = min(x, SIZE - x), min(y, SIZE - y)
    for place in (
        (FRAME * 0.35, FRAME * 0.35),
        (FRAME * 0.68, FRAME * 0.68),
        (FRAME / 2, SIZE / 2),
        (SIZE / 2, FRAME / 2),
    ):
        off = length(x - place[0], y - place[1])
        if off < NAIL:
            dome = (1.0 - (off / NAIL) ** 2) ** 0.5
            return Wood(10.0 + 3.0 * dome, 0.25 + 0.2 * dome, nail=True)
    return None


def paint(point: Wood) -> tuple[int, int, int]:
    """The color of a point, one of `TONES` between dark and light; nails are gray."""
    tone = round(min(1.0, max(0.0, point.tone)) * TONES) / TONES
    if point.nail:
        gray = int(70 + 150 * tone)
        return gray, gray, gray + 6
    red, green, blue = (int(a + (b - a) * tone + 0.5) for a, b in zip(DARK, LIGHT, strict=True))
    return red, green, blue


def encode(field: list[list[Wood]], x: int, y: int) -> tuple[int, int, int]:
    """The normal of the heights by central differences; slopes are rounded to eighths to pack well."""
    here = field[y]
    left, right = here[max(x - 1, 0)].height, here[min(x + 1, SIZE - 1)].height
    above, below = field[max(y - 1, 0)][x].height, field[min(y + 1, SIZE - 1)][x].height
    slope_x = round(STEEPNESS * (right - left) / 2 * 8) / 8
    slope_y = round(STEEPNESS * (above - below) / 2 * 8) / 8
    scale = 1.0 / (slope_x * slope_x + slope_y * slope_y + 1.0) ** 0.5
    red, green, blue = (int(127.5 * (1.0 + n * scale) + 0.5) for n in (-slope_x, -slope_y, 1.0))
    return red, green, blue


def noise(x: float, y: float, seed: int) -> float:
    """Smooth value noise from 0 to 1 on the integer lattice."""
    i, j = int(x // 1), int(y // 1)
    s, t = fade(x - i), fade(y - j)
    low = mix(lattice(i, j, seed), lattice(i + 1, j, seed), s)
    high = mix(lattice(i, j + 1, seed), lattice(i + 1, j + 1, seed), s)
    return mix(low, high, t)


def fade(t: float) -> float:
    """The cubic step from 0 to 1."""
    return t * t * (3.0 - 2.0 * t)


def mix(a: float, b: float, t: float) -> float:
    """From a to b."""
    return a + (b - a) * t


def lattice(i: int, j: int, seed: int) -> float:
    """A number from 0 to 1 for a lattice point, by integer mixing."""
    h = (i * 374761393 + j * 668265263 + seed * 1442695041) & 0xFFFFFFFF
    h = ((h ^ (h >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((h ^ (h >> 16)) & 0xFFFF) / 0xFFFF
