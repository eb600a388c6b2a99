"""A beetle as a Quake III model (MD3) with frames: it walks (`walk`), six legs in two tripods, and its back rocks.

Two surfaces, `shell` and `legs`. The tag `tag_load` rides on the back and turns with it, for a load that another model
is. Quake's axes: x forward, y to the left, z up; about 40 units long.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, field

from inputs.bird import OCTAGON, SIDES
from inputs.caterpillar import Vector, wave

FRAMES = 12
# Rings of the shell from the tail to the head: x, half width, height of the middle, half height.
RINGS = (
    (-20.0, 1.0, 5.0, 0.6),
    (-18.0, 6.0, 6.0, 3.6),
    (-12.0, 10.0, 7.4, 5.6),
    (-4.0, 11.5, 8.0, 6.4),
    (4.0, 10.5, 7.6, 5.8),
    (8.0, 8.0, 6.6, 4.6),
    (10.0, 7.4, 6.0, 4.0),
    (14.0, 6.4, 5.4, 3.4),
    (18.0, 4.0, 4.6, 2.4),
    (20.0, 1.0, 4.2, 0.6),
)
LEGS = ((10.0, 4.0), (0.0, 0.0), (-9.0, -4.0))  # x of the hip, and how much further in front the foot is


@dataclass
class Surface:
    """Faces over vertices with places on a picture; for each frame where the vertices are."""

    name: str
    shader: str
    places: list[tuple[float, float]] = field(default_factory=list)
    faces: list[tuple[int, int, int]] = field(default_factory=list)
    frames: list[list[Vector]] = field(default_factory=list)

    def quad(self, a: int, b: int, c: int, d: int) -> None:
        """Two triangles."""
        self.faces += [(a, b, c), (a, c, d)]


def lean(share: float) -> tuple[float, float]:
    """Cosine and sine of the angle by which the back rocks; by rational numbers, the same on every machine."""
    half = 0.07 * wave(share)
    return (1 - half * half) / (1 + half * half), 2 * half / (1 + half * half)


def rocked(point: Vector, share: float) -> Vector:
    """A point of the back, turned about an axis along x at half its height, and lifted."""
    (x, y, z), (cos, sin) = point, lean(share)
    z -= 6.0
    return (x, y * cos - z * sin, 6.0 + 0.6 * wave(2 * share) + y * sin + z * cos)


def shell() -> Surface:
    """A tube of octagons; the first and the last place around it are one line of points."""
    made = Surface("shell", "textures/beetle/shell")
    still = []
    for ring, (x, width, middle, height) in enumerate(RINGS):
        for side in range(SIDES + 1):
            z, y = OCTAGON[side % SIDES][1], OCTAGON[side % SIDES][0]
            still.append((x, width * y, middle + height * (z if z > 0 else 0.5 * z)))
            made.places.append((side / SIDES, ring / (len(RINGS) - 1)))
    row = SIDES + 1
    for ring in range(len(RINGS) - 1):
        for side in range(SIDES):
            at = ring * row + side
            made.quad(at, at + 1, at + row + 1, at + row)
    for ring in (0, len(RINGS) - 1):
        for quad in ((0, 1, 6, 7), (1, 2, 5, 6), (2, 3, 4, 5)):
            made.quad(*(ring * row + side for side in (quad if ring else quad[::-1])))
    made.frames = [[rocked(point, frame / FRAMES) for point in still] for frame in range(FRAMES)]
    return made


def leg(side: int, number: int, share: float) -> list[Vector]:
    """Hip, knee and foot as squares around the leg, the foot as one point."""
    hip_x, ahead = LEGS[number]
    step = share + (0.5 if (number + (side > 0)) % 2 else 0.0)
    foot = (hip_x + ahead + 3.0 * wave(step), 17.0 * side, max(0.0, 3.0 * wave(step + 0.25)))
    hip = rocked((hip_x, 6.0 * side, 5.0), share)
    knee = ((hip[0] + foot[0]) / 2 + ahead * 0.2, 13.0 * side, 8.0 + foot[2] * 0.5)
    around = ((0.0, 0.9), (0.9, 0.0), (0.0, -0.9), (-0.9, 0.0))
    points = [(x + dx, y, z + dz) for x, y, z in (hip, knee) for dx, dz in around]
    return [*points, foot]


def legs() -> Surface:
    """Six legs, each closed."""
    made = Surface("legs", "textures/beetle/legs", frames=[[] for _ in range(FRAMES)])
    for side in (-1, 1):
        for number in range(len(LEGS)):
            first = len(made.places)
            for frame in range(FRAMES):
                made.frames[frame] += leg(side, number, frame / FRAMES)
            made.places += [(k % 4 / 4, k // 4 / 2) for k in range(9)]
            faces = [(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]
            for corners in [(3, 2, 1, 0), *faces]:
                made.quad(*(first + k for k in (corners if side > 0 else corners[::-1])))
            for k in range(4):
                a, b = first + 4 + k, first + 4 + (k + 1) % 4
                made.faces.append((a, b, first + 8) if side > 0 else (b, a, first + 8))
    return made


def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normals(surface: Surface, points: list[Vector]) -> list[tuple[int, int]]:
    """For each vertex two angles in 256ths of a turn; vertices at one place look the same way."""
    sums: dict[Vector, list[float]] = {}
    for face in surface.faces:
        a, b, c = (points[k] for k in face)
        area = cross([b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)])
        for corner in face:
            own = sums.setdefault(points[corner], [0.0, 0.0, 0.0])
            for k in range(3):
                own[k] += area[k]
    found = []
    for point in points:
        x, y, z = sums[point]
        # Rounded to bytes, so that the last digit of a machine's functions does not count.
        from_z = math.atan2(math.hypot(x, y), z) * 128 / math.pi
        about_z = math.atan2(y, x) * 128 / math.pi
        found.append((round(from_z) % 256, round(about_z) % 256))
    return found


def packed(surface: Surface) -> bytes:
    """A surface of the file."""
    count, frames = len(surface.places), len(surface.frames)
    # Clockwise seen from outside; faces are kept counter-clockwise.
    triangles = b"".join(struct.pack("<3i", a, c, b) for a, b, c in surface.faces)
    shader = surface.shader.encode().ljust(64, b"\0") + struct.pack("<i", 0)
    places = b"".join(struct.pack("<2f", *place) for place in surface.places)
    rows = b""
    for points in surface.frames:
        snapped = [tuple(round(part * 64) / 64 for part in point) for point in points]
        for point, angles in zip(snapped, normals(surface, snapped), strict=True):
            rows += struct.pack("<3h2B", *(round(part * 64) for part in point), *angles)
    sections = (triangles, shader, places, rows)
    starts = [108 + sum(map(len, sections[:k])) for k in range(len(sections) + 1)]
    counts = (0, frames, 1, count, len(surface.faces))
    name = surface.name.encode().ljust(64, b"\0")
    return b"IDP3" + name + struct.pack("<5i", *counts) + struct.pack("<5i", *starts) + b"".join(sections)


def md3() -> bytes:
    """The file."""
    surfaces = [shell(), legs()]
    frames, tags = b"", b""
    for frame in range(FRAMES):
        points = [point for surface in surfaces for point in surface.frames[frame]]
        low, high = ([pick(point[k] for point in points) for k in range(3)] for pick in (min, max))
        radius = max(math.sqrt(x * x + y * y + z * z) for x, y, z in points)
        frames += struct.pack("<10f", *low, *high, 0, 0, 0, radius) + f"walk{frame + 1:02}".encode().ljust(16, b"\0")
        share = frame / FRAMES
        cos, sin = lean(share)
        axes = (1.0, 0.0, 0.0, 0.0, cos, sin, 0.0, -sin, cos)
        tags += b"tag_load".ljust(64, b"\0") + struct.pack("<12f", *rocked((-3.0, 0.0, 14.2), share), *axes)
    body = b"".join(map(packed, surfaces))
    starts = [108, 108 + len(frames), 108 + len(frames) + len(tags)]
    counts = struct.pack("<5i", 0, FRAMES, 1, len(surfaces), 0)
    offsets = struct.pack("<4i", *starts, starts[2] + len(body))
    return b"IDP3" + struct.pack("<i", 15) + b"beetle".ljust(64, b"\0") + counts + offsets + frames + tags + body
