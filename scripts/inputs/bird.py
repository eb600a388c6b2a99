"""A stylized wren as a closed cage of quads, written as OBJ with UVs and smoothing groups.

The body is a tube of octagons along a bent spine, from the tip of the tail to the tip of the beak; each
wing is a patch of the body's side, pulled out. Group `body` has smoothing group 1, `wings` 2, `beak` 3, so
that their borders stay hard edges. Lengths in meters, y up, the beak looks to +x.
"""

from __future__ import annotations

from dataclasses import dataclass, field

Vector = tuple[float, float, float]

SIDES = 8
# The octagon (z, y) with corners on the unit circle; index 0 is the top, 4 the bottom.
HALF = 0.5**0.5
OCTAGON = ((0, 1), (-HALF, HALF), (-1, 0), (-HALF, -HALF), (0, -1), (HALF, -HALF), (1, 0), (HALF, HALF))
# Center x and y, half width, half height, and how far the ring leans: its top is moved by this much in x.
RINGS = (
    (-0.120, 0.118, 0.024, 0.004, -0.004),
    (-0.086, 0.094, 0.021, 0.006, -0.006),
    (-0.058, 0.070, 0.019, 0.014, -0.008),
    (-0.040, 0.055, 0.030, 0.030, -0.010),
    (-0.014, 0.046, 0.041, 0.042, -0.008),
    (0.014, 0.046, 0.043, 0.044, -0.004),
    (0.036, 0.060, 0.036, 0.038, -0.010),
    (0.046, 0.086, 0.027, 0.025, -0.014),
    (0.058, 0.102, 0.025, 0.022, -0.006),
    (0.078, 0.104, 0.016, 0.015, 0.000),
    (0.086, 0.103, 0.0075, 0.0065, 0.000),
    (0.112, 0.099, 0.0015, 0.0012, 0.000),
)
BEAK = 10  # the first ring of the beak
WING_RINGS = range(3, 6)  # the strips of the body's side that carry a wing
WING_SIDES = {"left": (1, 2), "right": (5, 6)}
WING_OUT, WING_BACK = 0.012, -0.014


@dataclass
class Cage:
    """Points, UVs, and faces (corner -> point, UV) by group."""

    points: list[Vector] = field(default_factory=list)
    uvs: list[tuple[float, float]] = field(default_factory=list)
    faces: dict[str, list[list[tuple[int, int]]]] = field(default_factory=dict)

    def face(self, group: str, points: list[int], uvs: list[tuple[float, float]]) -> None:
        """Add a quad with its own UVs; equal UVs are written once."""
        corners = []
        for point, uv in zip(points, uvs, strict=True):
            if uv not in self.uvs:
                self.uvs.append(uv)
            corners.append((point, self.uvs.index(uv)))
        self.faces.setdefault(group, []).append(corners)


def obj() -> str:
    """The text of the OBJ file."""
    cage = build()
    lines = ["# A wren: closed cage of quads, y up, meters", "o bird"]
    lines += [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in cage.points]
    lines += [f"vt {u:.6g} {v:.6g}" for u, v in cage.uvs]
    for smoothing, (group, faces) in enumerate(cage.faces.items(), start=1):
        lines += [f"g {group}", f"s {smoothing}"]
        lines += ["f " + " ".join(f"{p + 1}/{t + 1}" for p, t in face) for face in faces]
    return "\n".join(lines) + "\n"


def build() -> Cage:
    """The whole cage."""
    cage = Cage(faces={"body": [], "wings": [], "beak": []})
    for x, y, half_width, half_height, lean in RINGS:
        cage.points += [(x + lean * up, y + half_height * up, half_width * side) for side, up in OCTAGON]
    for ring in range(len(RINGS) - 1):
        for side in range(SIDES):
            if ring not in WING_RINGS or not any(side in sides for sides in WING_SIDES.values()):
                strip(cage, ring, side)
    for sides in WING_SIDES.values():
        wing(cage, sides)
    cap(cage, "body", 0, turned=False)
    cap(cage, "beak", len(RINGS) - 1, turned=True)
    return cage


def index(ring: int, side: int) -> int:
    """The point of a ring."""
    return ring * SIDES + side % SIDES


def uv(ring: int, side: int) -> tuple[float, float]:
    """Around and along the body; the seam runs along the back."""
    return side / SIDES, ring / (len(RINGS) - 1)


def strip(cage: Cage, ring: int, side: int) -> None:
    """One quad between two rings, outside out."""
    corners = [(ring, side), (ring + 1, side), (ring + 1, side + 1), (ring, side + 1)]
    group = "beak" if ring >= BEAK else "body"
    cage.face(group, [index(*c) for c in corners], [uv(*c) for c in corners])


def cap(cage: Cage, group: str, ring: int, turned: bool) -> None:
    """An octagon closed by three quads."""
    for quad in ((0, 1, 6, 7), (1, 2, 5, 6), (2, 3, 4, 5)):
        sides = quad[::-1] if turned else quad
        # A small patch of its own in a corner of the picture.
        uvs = [(0.5 + 0.04 * OCTAGON[s][0], (0.04 if ring == 0 else 0.96) + 0.04 * OCTAGON[s][1]) for s in sides]
        cage.face(group, [index(ring, s) for s in sides], uvs)


def wing(cage: Cage, sides: tuple[int, int]) -> None:
    """A patch of strips pulled outward and back: its lifted copy, and a wall around its border."""
    columns = (sides[0], sides[0] + 1, sides[1] + 1)
    rows = (*WING_RINGS, WING_RINGS[-1] + 1)
    outward = WING_OUT if cage.points[index(rows[1], columns[1])][2] > 0 else -WING_OUT
    lifted = {}
    for row in rows:
        for column in columns:
            x, y, z = cage.points[index(row, column)]
            # The rear hangs over the tail; the front and the borders stay close to the body.
            back = WING_BACK * (rows[-1] - row) / (len(rows) - 1)
            out = outward * (1.0 if column == columns[1] else 0.4) * (0.5 if row == rows[-1] else 1.0)
            lifted[row, column] = len(cage.points)
            cage.points.append((x + 1.6 * back, y - 0.3 * back, z + out))
    patch(cage, rows, columns, lifted)
    wall(cage, rows, columns, lifted)


def patch(cage: Cage, rows: tuple[int, ...], columns: tuple[int, ...], lifted: dict[tuple[int, int], int]) -> None:
    """The outer side of a wing."""
    for row in rows[:-1]:
        for column in columns[:-1]:
            corners = [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
            cage.face("wings", [lifted[c] for c in corners], [uv(*c) for c in corners])


def wall(cage: Cage, rows: tuple[int, ...], columns: tuple[int, ...], lifted: dict[tuple[int, int], int]) -> None:
    """The rim of a wing, from the body to the lifted border."""
    border = [(row, columns[0]) for row in rows]
    border += [(rows[-1], column) for column in columns[1:]]
    border += [(row, columns[-1]) for row in rows[-2::-1]]
    border += [(rows[0], column) for column in columns[-2:0:-1]]
    for a, b in zip(border, border[1:] + border[:1], strict=True):
        (ua, va), (ub, vb) = uv(*a), uv(*b)
        uvs = [(ua, va), (ub, vb), (ub, vb - 0.02), (ua, va - 0.02)]
        cage.face("wings", [index(*a), index(*b), lifted[b], lifted[a]], uvs)
