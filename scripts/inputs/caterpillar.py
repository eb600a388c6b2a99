"""A caterpillar as a Quake II model (MD2) with frames: it looks around (`stand`), crawls (`run`) and rears up (`jump`).

The body is a tube of octagons along a spine in the plane of x and z; a frame moves and lifts its rings. Eyes and
feelers ride on the head. Quake's axes: x forward, y to the left, z up; about 56 units long.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

from inputs.bird import OCTAGON, SIDES
from inputs.picture import Picture

Vector = tuple[float, float, float]

SKIN = 128  # pixels of the picture along each side
# Radii of the rings from the tail's tip to the nose; between bumps the body is drawn in.
RADII = (0.4, 3.2, 4.6, 3.9, 4.9, 4.1, 5.0, 4.1, 5.0, 4.1, 4.9, 4.0, 4.6, 3.9, 5.2, 5.6, 4.4, 0.5)
STEP = 3.3
HEAD = range(13, len(RADII))
# One turn of a wave in sixteenths, rounded; to compute it would not give the same on every machine.
WAVE = (0.0, 0.38, 0.71, 0.92, 1.0, 0.92, 0.71, 0.38, 0.0, -0.38, -0.71, -0.92, -1.0, -0.92, -0.71, -0.38)
GREEN, LIGHT, DARK, RED = (98, 150, 52), (166, 200, 84), (52, 92, 34), (190, 66, 40)


def wave(turn: float) -> float:
    """The sine of so many turns, straight between sixteenths."""
    place = (turn % 1.0) * len(WAVE)
    before, share = int(place), place - int(place)
    return WAVE[before % len(WAVE)] * (1.0 - share) + WAVE[(before + 1) % len(WAVE)] * share


@dataclass
class Body:
    """Faces by the numbers of their points and of their texture coordinates; for each point how a frame moves it."""

    rides: list[tuple[int, Vector]] = field(default_factory=list)
    places: list[tuple[int, int]] = field(default_factory=list)
    triangles: list[tuple[tuple[int, int, int], tuple[int, int, int]]] = field(default_factory=list)

    def point(self, ring: int, offset: Vector) -> int:
        """A point that rides on a ring of the spine."""
        self.rides.append((ring, offset))
        return len(self.rides) - 1

    def place(self, s: float, t: float) -> int:
        """A place in the picture, in pixels."""
        self.places.append((int(s + 0.5), int(t + 0.5)))
        return len(self.places) - 1

    def quad(self, points: list[int], places: list[int]) -> None:
        """Two triangles, clockwise seen from outside as Quake has them; corners are given counter-clockwise."""
        for a, b, c in ((0, 2, 1), (0, 3, 2)):
            self.triangles.append(((points[a], points[b], points[c]), (places[a], places[b], places[c])))


def body() -> Body:
    """The whole caterpillar."""
    made = Body()
    rings = [[made.point(ring, (0.0, radius * y, radius * z)) for y, z in OCTAGON] for ring, radius in enumerate(RADII)]
    last = len(RADII) - 1
    places = [
        [made.place(SKIN * side / SIDES, SKIN * ring / last) for side in range(SIDES + 1)] for ring in range(last + 1)
    ]
    for ring in range(last):
        for side in range(SIDES):
            corners = [(ring, side), (ring, side + 1), (ring + 1, side + 1), (ring + 1, side)]
            made.quad([rings[r][s % SIDES] for r, s in corners], [places[r][s] for r, s in corners])
    for ring, middle in ((0, 0.02), (last, 0.98)):
        for quad in ((0, 1, 6, 7), (1, 2, 5, 6), (2, 3, 4, 5)):
            sides = quad[::-1] if ring == 0 else quad
            place = made.place(SKIN * 0.5, SKIN * middle)
            made.quad([rings[ring][side] for side in sides], [place] * 4)
    for y in (-1, 1):
        knob(made, 16, (0.6, 2.4 * y, 2.6), (1.4, 1.4, 1.4), 0.52)
        knob(made, 14, (0.8, 2.0 * y, 6.6), (0.45, 0.45, 3.0), 0.86)
    return made


def knob(made: Body, ring: int, center: Vector, half: Vector, band: float) -> None:
    """An octahedron on the head: an eye, a feeler. All of it shows one place of the picture's seam."""
    axes = ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    points = [made.point(ring, tuple(center[k] + half[k] * axis[k] for k in range(3))) for axis in axes]
    place = made.place(SKIN - 2, SKIN * band)
    for side in range(4):
        a, b = points[side], points[(side + 1) % 4]
        for c, order in ((points[4], (0, 2, 1)), (points[5], (0, 1, 2))):
            corners = (a, b, c)
            made.triangles.append((tuple(corners[k] for k in order), (place, place, place)))


def spine(name: str, share: float) -> list[tuple[float, float, float]]:
    """For each ring x, z and how far it leans back, at a share of a sequence."""
    found = []
    for ring, radius in enumerate(RADII):
        along = STEP * (ring - len(RADII) / 2)
        x, z, lean = along, radius, 0.0
        front = max(0.0, ring - 8.0) / 9.0
        if name == "stand":
            z += front * front * (5.0 + 2.0 * wave(share))
            x -= front * front * 1.5
            lean = 0.3 * front
        elif name == "run":
            # A hump runs from the tail to the head and carries the body along.
            hump = max(0.0, wave(share - ring / 17.0 * 0.75))
            z += 7.0 * hump * hump
            x -= 1.6 * wave(share - ring / 17.0 * 0.75 + 0.25)
        else:
            rise = 2.0 * min(share, 1.0 - share)
            z += 26.0 * rise * front * front
            x -= 12.0 * rise * front * front
            lean = 1.2 * rise * front
        found.append((x, z, lean))
    return found


def frame(made: Body, name: str, share: float) -> list[Vector]:
    """The points of a frame."""
    rings = spine(name, share)
    points = []
    for ring, (dx, dy, dz) in made.rides:
        x, z, lean = rings[ring]
        points.append((x + dx - lean * dz, dy, z + dz))
    return points


def frames() -> list[tuple[str, str, float]]:
    """Names of frames, their sequences and how far along in these they are."""
    counts = (("stand", 8), ("run", 12), ("jump", 9))
    return [(f"{name}{k + 1:02}", name, k / (count - (name == "jump"))) for name, count in counts for k in range(count)]


def md2() -> bytes:
    """The file."""
    made = body()
    names = frames()
    skin = b"caterpillar.png".ljust(64, b"\0")
    places = b"".join(struct.pack("<2h", *place) for place in made.places)
    triangles = b"".join(struct.pack("<6H", *points, *corners) for points, corners in made.triangles)
    packed = b"".join(pack(name, frame(made, sequence, share)) for name, sequence, share in names)
    # Nothing is drawn by commands: a list of none.
    commands = struct.pack("<i", 0)
    sections = (skin, places, triangles, packed, commands)
    starts = [68 + sum(map(len, sections[:k])) for k in range(len(sections) + 1)]
    counts = (1, len(made.rides), len(made.places), len(made.triangles), 1, len(names))
    header = struct.pack("<4s16i", b"IDP2", 8, SKIN, SKIN, 40 + 4 * len(made.rides), *counts, *starts)
    return header + b"".join(sections)


def pack(name: str, points: list[Vector]) -> bytes:
    """A frame: its box in single precision, and the points in it in bytes."""
    low = [min(point[k] for point in points) for k in range(3)]
    scale = [max((max(point[k] for point in points) - low[k]) / 255.0, 1e-6) for k in range(3)]
    head = struct.pack("<6f", *scale, *low) + name.encode().ljust(16, b"\0")
    body = b""
    for point in points:
        parts = [min(255, max(0, int((point[k] - low[k]) / scale[k] + 0.5))) for k in range(3)]
        # The normal of a table that our reader leaves alone: the one that looks up.
        body += struct.pack("<4B", *parts, 5)
    return head + body


def draw() -> Picture:
    """The skin: green with light bands, a dark line along the back, red feet; eyes and feelers dark at the seam."""
    picture = Picture(SKIN, SKIN, GREEN)
    rings = len(RADII) - 1
    for ring in range(2, 12, 2):
        row = SKIN * ring / rings
        picture.box((0, row - 2.6), (SKIN, row + 2.6), LIGHT)
        picture.disc((SKIN * 0.5 - 22, row), 3.4, RED)
        picture.disc((SKIN * 0.5 + 22, row), 3.4, RED)
    picture.box((0, SKIN * 13.4 / rings), (SKIN, SKIN), LIGHT)
    for side in (0, SKIN):
        picture.box((side - 5, 0), (side + 5, SKIN), DARK)
    return picture
