"""A mounting plate as a drawing (DXF): outline, slot and holes on layers, as CAD programs draw them.

The outline is separate lines and arcs, some of them drawn backwards; the slot is one polyline with bulges; the hole is
a block that is inserted in rows, once mirrored; the window is a closed spline. Lengths in millimeters.
"""

from __future__ import annotations

Pair = tuple[int, object]

WIDTH, HEIGHT, ROUND = 120, 80, 10


def line(layer: str, ends: tuple[float, float, float, float]) -> list[Pair]:
    """A straight line."""
    a, b, c, d = ends
    return [(0, "LINE"), (8, layer), (10, a), (20, b), (11, c), (21, d)]


def arc(layer: str, middle: tuple[float, float], radius: float, angles: tuple[float, float]) -> list[Pair]:
    """A part of a circle, counter-clockwise."""
    return [
        (0, "ARC"),
        (8, layer),
        (10, middle[0]),
        (20, middle[1]),
        (40, radius),
        (50, angles[0]),
        (51, angles[1]),
    ]


def outline() -> list[Pair]:
    """A rectangle with round corners; its upper and left sides are drawn backwards."""
    w, h, r = WIDTH, HEIGHT, ROUND
    return [
        *line("outline", (r, 0, w - r, 0)),
        *line("outline", (r, h, w - r, h)),
        *line("outline", (w, r, w, h - r)),
        *line("outline", (0, r, 0, h - r)),
        *arc("outline", (w - r, r), r, (270, 360)),
        *arc("outline", (w - r, h - r), r, (0, 90)),
        *arc("outline", (r, h - r), r, (90, 180)),
        *arc("outline", (r, r), r, (180, 270)),
    ]


def slot() -> list[Pair]:
    """Two lines and two half circles in one polyline."""
    corners = ((45, 58, 0), (75, 58, 1), (75, 68, 0), (45, 68, 1))
    pairs: list[Pair] = [(0, "LWPOLYLINE"), (8, "slot"), (90, len(corners)), (70, 1)]
    for x, y, bulge in corners:
        pairs += [(10, x), (20, y), (42, bulge)]
    return pairs


def window() -> list[Pair]:
    """A closed quadratic spline of four arches, its knots doubled between them; it begins and ends at one point."""
    points = ((60, 16), (84, 16), (84, 32), (84, 48), (60, 48), (36, 48), (36, 32), (36, 16), (60, 16))
    knots = (0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4)
    pairs: list[Pair] = [(0, "SPLINE"), (8, "window"), (70, 9), (71, 2), (72, len(knots)), (73, len(points)), (74, 0)]
    pairs += [(40, knot) for knot in knots]
    for x, y in points:
        pairs += [(10, x), (20, y), (30, 0)]
    return pairs


def block() -> list[Pair]:
    """A hole, its middle beside the block's origin."""
    hole: list[Pair] = [(0, "CIRCLE"), (8, "0"), (10, 2), (20, 0), (40, 4)]
    return [(0, "BLOCK"), (8, "0"), (2, "HOLE"), (70, 0), (10, 0), (20, 0), (30, 0), *hole, (0, "ENDBLK"), (8, "0")]


def insert(x: float, y: float, scale: float) -> list[Pair]:
    """Two holes, one above the other."""
    place: list[Pair] = [(10, x), (20, y), (41, scale), (42, 1), (43, 1)]
    return [(0, "INSERT"), (8, "holes"), (2, "HOLE"), *place, (70, 1), (71, 2), (44, 0), (45, 56)]


def pairs() -> list[Pair]:
    """The whole drawing."""
    return [
        (999, "A mounting plate, millimeters"),
        (0, "SECTION"),
        (2, "BLOCKS"),
        *block(),
        (0, "ENDSEC"),
        (0, "SECTION"),
        (2, "ENTITIES"),
        *outline(),
        *slot(),
        *window(),
        *insert(10, 12, 1),
        *insert(110, 12, -1),
        (0, "ENDSEC"),
        (0, "EOF"),
    ]


def dxf() -> str:
    """The text of the file."""
    return "".join(f"{code:3}\n{value}\n" for code, value in pairs())
