"""The label of the bottle: cream paper with green bands, a kiln in a medallion, and lettering.

1024 x 512 pixels; the picture goes once around the bottle, the front in the middle.
"""

from __future__ import annotations

from inputs import lettering
from inputs.picture import Picture

PAPER, INK, GREEN = (240, 229, 205), (46, 38, 30), (38, 70, 57)
GOLD, FIRE, GLOW = (176, 136, 66), (190, 74, 38), (238, 168, 70)
WIDTH, HEIGHT = 1024, 512


def draw() -> Picture:
    """The whole label."""
    picture = Picture(WIDTH, HEIGHT, PAPER)
    bands(picture)
    front(picture)
    for side in (118, WIDTH - 118):
        back(picture, side)
    return picture


def bands(picture: Picture) -> None:
    """Green along the upper and lower edge, each with a gold line and a row of dots."""
    for edge, line, dots in ((0, 62, 31), (HEIGHT, HEIGHT - 62, HEIGHT - 31)):
        picture.box((0, min(edge, line)), (WIDTH, max(edge, line)), GREEN)
        picture.box((0, line - 3), (WIDTH, line + 3), GOLD)
        for x in range(16, WIDTH, 32):
            picture.disc((x, dots), 4.0, GOLD)


def front(picture: Picture) -> None:
    """The medallion with the name below it."""
    middle = WIDTH / 2
    medallion(picture, middle, 168.0, 84.0)
    lettering.write(picture, "KILN", (middle, 318.0), 84.0, 15.0, INK)
    lettering.write(picture, "STONE FRUIT CORDIAL", (middle, 398.0), 22.0, 4.0, GREEN)
    for side in (-1, 1):
        picture.line((middle + side * 30, 430), (middle + side * 190, 430), 2.5, GOLD)
    picture.disc((middle, 430), 5.0, FIRE)


def medallion(picture: Picture, x: float, y: float, radius: float) -> None:
    """A bottle kiln with an open fire."""
    for size, color in ((radius, GOLD), (radius - 5, PAPER), (radius - 9, GREEN)):
        picture.disc((x, y), size, color)
    floor, top = y + 46, y - 60
    for row in range(int(top), int(floor)):
        # Straight at the foot, drawn in to the neck like a bottle.
        t = (row - top) / (floor - top)
        half = 13.0 + 31.0 * t * t * (3.0 - 2.0 * t)
        picture.box((x - half, row), (x + half, row + 1), PAPER)
    for t in (0.28, 0.5, 0.72):
        row, half = top + t * (floor - top), 13.0 + 31.0 * t * t * (3.0 - 2.0 * t)
        picture.box((x - half, row - 1.5), (x + half, row + 1.5), GREEN)
    picture.box((x - 15, floor - 26), (x + 15, floor), FIRE)
    picture.disc((x, floor - 26), 15.0, FIRE)
    picture.disc((x, floor - 10), 9.0, GLOW)
    picture.line((x, floor - 10), (x, floor - 27), 7.0, GLOW)


def back(picture: Picture, x: float) -> None:
    """One side panel: number, contents and lines of small print."""
    picture.line((x - 86, 96), (x - 86, HEIGHT - 96), 2.0, GOLD)
    picture.line((x + 86, 96), (x + 86, HEIGHT - 96), 2.0, GOLD)
    lettering.write(picture, "NO. 7", (x, 130.0), 34.0, 6.0, FIRE)
    for row, words in enumerate(("BAKED IN", "SMALL", "BATCHES")):
        lettering.write(picture, words, (x, 192.0 + 30 * row), 15.0, 2.6, INK)
    for row, half in enumerate((66, 70, 60, 68, 40)):
        picture.line((x - half, 292 + 16 * row), (x + half, 292 + 16 * row), 2.2, GREEN)
    lettering.write(picture, "750 ML", (x, 396.0), 20.0, 3.6, GREEN)
