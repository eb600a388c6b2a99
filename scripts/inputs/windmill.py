"""A windmill as a whole 3D Studio scene (3DS): objects below each other, a camera, lights, and keys for all of them.

The rotor turns in front of the cap, the cap swings, a lantern is hidden for half of the time, and the camera rises
while it looks at the mill. One unit is a meter, z points up.
"""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

from inputs.bird import OCTAGON, SIDES

if TYPE_CHECKING:
    from inputs.caterpillar import Vector

FRAMES = 120
NONE = 0xFFFF

Face = tuple[tuple[int, int, int], int, str]


def chunk(number: int, *parts: bytes) -> bytes:
    """A chunk with its length."""
    body = b"".join(parts)
    return struct.pack("<HI", number, len(body) + 6) + body


def text(name: str) -> bytes:
    """Text with its zero."""
    return name.encode() + b"\0"


def numbers(*values: float) -> bytes:
    """Numbers in single precision."""
    return struct.pack(f"<{len(values)}f", *values)


def tube(rings: list[tuple[float, float]], material: str) -> tuple[list[Vector], list[Face]]:
    """Octagons around z by height and radius; the sides are one smoothing group, the ends another."""
    points = [(radius * a, radius * b, z) for z, radius in rings for a, b in OCTAGON]
    faces: list[Face] = []
    for ring in range(len(rings) - 1):
        for side in range(SIDES):
            a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
            faces += [((a, b, b + SIDES), 1, material), ((a, b + SIDES, a + SIDES), 1, material)]
    for ring in (0, len(rings) - 1):
        for side in range(1, SIDES - 1):
            a, b, c = (ring * SIDES + k for k in (0, side, side + 1))
            faces.append(((a, b, c) if ring else (a, c, b), 2, material))
    return points, faces


def box(low: Vector, high: Vector, material: str) -> tuple[list[Vector], list[Face]]:
    """A box, flat all over."""
    points = [(x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1]) for x in (low[0], high[0])]
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    faces = [((q[0], q[a], q[b]), 0, material) for q in quads for a, b in ((1, 2), (2, 3))]
    return points, faces


def joined(*parts: tuple[list[Vector], list[Face]]) -> tuple[list[Vector], list[Face]]:
    """Several bodies as one object."""
    points: list[Vector] = []
    faces: list[Face] = []
    for own, of in parts:
        faces += [(tuple(k + len(points) for k in corners), group, material) for corners, group, material in of]
        points += own
    return points, faces


def thing(name: str, at: Vector, body: tuple[list[Vector], list[Face]]) -> bytes:
    """An object whose axes stand at a place: the file has its points in the scene."""
    points, faces = body
    materials = sorted({material for _, _, material in faces})
    worn = [
        chunk(
            0x4130,
            text(material),
            struct.pack("<H", sum(own == material for _, _, own in faces)),
            *(struct.pack("<H", k) for k, (_, _, own) in enumerate(faces) if own == material),
        )
        for material in materials
    ]
    mesh = chunk(
        0x4100,
        chunk(0x4110, struct.pack("<H", len(points)), *(numbers(*(p[k] + at[k] for k in range(3))) for p in points)),
        chunk(0x4160, numbers(1, 0, 0, 0, 1, 0, 0, 0, 1, *at)),
        chunk(
            0x4120,
            struct.pack("<H", len(faces)),
            *(struct.pack("<4H", *corners, 7) for corners, _, _ in faces),
            *worn,
            chunk(0x4150, *(struct.pack("<I", group) for _, group, _ in faces)),
        ),
    )
    return chunk(0x4000, text(name), mesh)


def material(name: str, color: tuple[int, int, int], shine: int = 0) -> bytes:
    """A material."""
    return chunk(
        0xAFFF,
        chunk(0xA000, text(name)),
        chunk(0xA020, chunk(0x0011, bytes(color))),
        chunk(0xA040, chunk(0x0030, struct.pack("<H", shine))),
    )


def track(number: int, *keys: tuple[int, tuple[float, ...]], tension: float | None = None) -> bytes:
    """Keys by frames, all with a tension if one is given."""
    head = struct.pack("<H8xI", 0, len(keys))
    given = struct.pack("<H", 0) if tension is None else struct.pack("<Hf", 1, tension)
    return chunk(number, head, *(struct.pack("<I", frame) + given + numbers(*values) for frame, values in keys))


def node(kind: int, name: str, numbered: tuple[int, int], *tracks: bytes) -> bytes:
    """A node with its number and its parent's."""
    own, parent = numbered
    head = chunk(0xB030, struct.pack("<H", own)), chunk(0xB010, text(name), struct.pack("<3H", 0, 0, parent))
    return chunk(kind, *head, *tracks)


def editor() -> bytes:
    """What stands in the scene."""
    tower = tube([(0, 2.6), (0.6, 2.4), (7.0, 1.5)], "plaster")
    cap = tube([(0, 1.7), (0.3, 1.7), (1.7, 0.2)], "shingle")
    hub = box((-0.25, -0.5, -0.25), (0.25, 0.9, 0.25), "wood")
    sails = [
        box((-0.35, -0.42, 0.6), (0.45, -0.34, 4.6), "canvas"),
        box((-0.45, -0.42, -4.6), (0.35, -0.34, -0.6), "canvas"),
    ]
    sails += [
        box((0.6, -0.42, -0.45), (4.6, -0.34, 0.35), "canvas"),
        box((-4.6, -0.42, -0.35), (-0.6, -0.34, 0.45), "canvas"),
    ]
    spars = [
        box((-0.08, -0.34, -4.7), (0.08, -0.24, 4.7), "wood"),
        box((-4.7, -0.34, -0.08), (4.7, -0.24, 0.08), "wood"),
    ]
    lantern = box((-0.25, -0.25, -0.35), (0.25, 0.25, 0.35), "glass")
    camera = chunk(0x4700, numbers(14, -18, 6, 0, 0, 5, 0, 35), chunk(0x4720, numbers(0.5, 200)))
    spot = chunk(
        0x4600,
        numbers(8, -12, 14),
        chunk(0x0010, numbers(1, 0.9, 0.7)),
        chunk(0x4610, numbers(0, 0, 5, 40, 55)),
        chunk(0x465B, numbers(30)),
    )
    lamp = chunk(0x4600, numbers(0, -3.2, 3), chunk(0x0010, numbers(1, 0.6, 0.2)), chunk(0x465A, numbers(20)))
    return chunk(
        0x3D3D,
        material("plaster", (232, 224, 208)),
        material("shingle", (88, 60, 52)),
        material("wood", (122, 84, 46), 20),
        material("canvas", (240, 236, 222)),
        material("glass", (255, 190, 80), 80),
        thing("Tower", (0, 0, 0), tower),
        thing("Cap", (0, 0, 7), cap),
        thing("Rotor", (0, -2.2, 7.6), joined(hub, *sails, *spars)),
        thing("Lantern", (0, -3.2, 3), lantern),
        chunk(0x4000, text("Camera01"), camera),
        chunk(0x4000, text("Sun"), spot),
        chunk(0x4000, text("Lamp"), lamp),
    )


def keyframer() -> bytes:
    """How it moves. A key of a rotation is a turn since the one before, clockwise seen from the end of its axis."""
    quarter = math.pi / 2
    swing = 0.25
    turns = [(0, (0.0, 0.0, 1.0, 0.0))] + [(30 * k, (quarter, 0.0, 1.0, 0.0)) for k in range(1, 5)]
    cap = [
        (0, (0.0, 0.0, 0.0, 1.0)),
        (30, (swing, 0.0, 0.0, 1.0)),
        (90, (-2 * swing, 0.0, 0.0, 1.0)),
        (120, (swing, 0.0, 0.0, 1.0)),
    ]
    rise = [(0, (14, -18, 6)), (60, (9, -20, 9)), (120, (14, -18, 6))]
    still = track(0xB022, (0, (1, 1, 1)))
    return chunk(
        0xB000,
        chunk(0xB008, struct.pack("<2I", 0, FRAMES)),
        node(0xB002, "Tower", (0, NONE), track(0xB020, (0, (0, 0, 0)))),
        node(0xB002, "Cap", (1, 0), track(0xB020, (0, (0, 0, 7))), track(0xB021, *cap), still),
        node(0xB002, "Rotor", (2, 1), track(0xB020, (0, (0, -2.2, 0.6))), track(0xB021, *turns)),
        node(0xB002, "Lantern", (3, 0), track(0xB020, (0, (0, -3.2, 3))), track(0xB029, (30, ()), (90, ()))),
        node(0xB003, "Camera01", (4, NONE), track(0xB020, *rise, tension=0.5), track(0xB024, (0, (0,)))),
        node(0xB004, "Camera01", (5, NONE), track(0xB020, (0, (0, 0, 5)))),
        node(0xB007, "Sun", (6, NONE), track(0xB020, (0, (8, -12, 14)))),
        node(0xB006, "Sun", (7, NONE), track(0xB020, (0, (0, 0, 5)))),
    )


def studio() -> bytes:
    """The file."""
    return chunk(0x4D4D, chunk(0x0002, struct.pack("<I", 3)), editor(), keyframer())
