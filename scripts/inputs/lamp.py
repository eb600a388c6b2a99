"""A desk lamp as a Doom 3 model: a mesh with joints and weights (MD5), and a motion in which it bows and looks up.

Four joints, each with its x along its bone: `base`, `lower`, `upper`, `head`. The arm is one tube that bends at its
elbow and is carried by two joints there. Doom's axes: x forward, y to the left, z up; about 70 units high.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from inputs.bird import OCTAGON, SIDES
from inputs.caterpillar import Vector, wave

Quaternion = tuple[float, float, float, float]

FRAMES, RATE = 48, 24
# Each bone's place and the direction of its x, by whole numbers so that every machine finds the same rotations.
BONES = {
    "base": (None, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "lower": ("base", (0.0, 0.0, 5.0), (-8.0 / 17, 0.0, 15.0 / 17)),
    "upper": ("lower", (-16.0, 0.0, 35.0), (4.0 / 5, 0.0, 3.0 / 5)),
    "head": ("upper", (20.0, 0.0, 62.0), (3.0 / 5, 0.0, -4.0 / 5)),
}
NAMES = list(BONES)


def about_y(half: float) -> Quaternion:
    """The turn about y by twice the angle of a tangent."""
    length = math.sqrt(1 + half * half)
    return (0.0, half / length, 0.0, 1 / length)


def toward(direction: Vector) -> Quaternion:
    """The turn about y that brings x into a direction."""
    cos, sin = direction[0], -direction[2]
    return about_y(sin / (1 + cos))


def times(a: Quaternion, b: Quaternion) -> Quaternion:
    """The turn by b, then by a."""
    (ax, ay, az, aw), (bx, by, bz, bw) = a, b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def back(turn: Quaternion) -> Quaternion:
    """The turn back."""
    return (-turn[0], -turn[1], -turn[2], turn[3])


def turned(turn: Quaternion, point: Vector) -> Vector:
    """A point, turned."""
    return times(times(turn, (*point, 0.0)), back(turn))[:3]


def local(bone: str, point: Vector) -> Vector:
    """A point in the space of a bone."""
    _, place, direction = BONES[bone]
    return turned(back(toward(direction)), tuple(point[k] - place[k] for k in range(3)))


@dataclass
class Mesh:
    """Triangles over vertices, each with its place on a picture and the bones that carry it."""

    shader: str
    vertices: list[tuple[Vector, tuple[float, float], dict[str, float]]] = field(default_factory=list)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)

    def tube(self, rings: list[tuple[Vector, Vector, float, dict[str, float]]]) -> None:
        """Octagons around places, square to directions in the plane of x and z; closed at both ends."""
        first = len(self.vertices)
        row = SIDES + 1
        for number, (middle, along, radius, weights) in enumerate(rings):
            out = (-along[2], 0.0, along[0])
            for side in range(row):
                a, b = OCTAGON[side % SIDES]
                point = tuple(middle[k] + radius * (b * out[k] + a * (k == 1)) for k in range(3))
                self.vertices.append((point, (side / SIDES, number / (len(rings) - 1)), weights))
        for ring in range(len(rings) - 1):
            for side in range(SIDES):
                at = first + ring * row + side
                self.quad(at, at + 1, at + row + 1, at + row)
        for ring in (0, len(rings) - 1):
            for quad in ((0, 1, 6, 7), (1, 2, 5, 6), (2, 3, 4, 5)):
                self.quad(*(first + ring * row + side for side in (quad if ring else quad[::-1])))

    def quad(self, a: int, b: int, c: int, d: int) -> None:
        """Two triangles, clockwise seen from outside as Doom has them; corners are given the other way round."""
        self.triangles += [(a, c, b), (a, d, c)]


def along(bone: str, length: float) -> Vector:
    """A place on a bone."""
    _, place, direction = BONES[bone]
    return tuple(place[k] + length * direction[k] for k in range(3))


def meshes() -> list[Mesh]:
    """Foot and shade, and the arm between them."""
    iron, arm = Mesh("models/lamp/iron"), Mesh("models/lamp/arm")
    up = (0.0, 0.0, 1.0)
    foot = {"base": 1.0}
    iron.tube([((0.0, 0.0, z), up, radius, foot) for z, radius in ((0, 15), (2, 15), (4, 12), (5, 4))])
    head = {"head": 1.0}
    aim = BONES["head"][2]
    shade = ((-5, 2.5), (-4, 4), (3, 5.5), (16, 12), (16.5, 11.5), (4, 4.5))
    iron.tube([(along("head", length), aim, radius, head) for length, radius in shade])
    lower, upper = BONES["lower"][2], BONES["upper"][2]
    bent = tuple(
        (lower[k] + upper[k]) / math.sqrt(2 + 2 * sum(lower[i] * upper[i] for i in range(3))) for k in range(3)
    )
    arm.tube(
        [
            (along("lower", -1.0), lower, 1.8, {"base": 0.5, "lower": 0.5}),
            (along("lower", 3.0), lower, 1.8, {"lower": 1.0}),
            (along("lower", 26.0), lower, 1.8, {"lower": 1.0}),
            (along("lower", 31.0), lower, 2.2, {"lower": 0.75, "upper": 0.25}),
            (along("upper", 0.0), bent, 2.6, {"lower": 0.5, "upper": 0.5}),
            (along("upper", 3.0), upper, 2.2, {"lower": 0.25, "upper": 0.75}),
            (along("upper", 8.0), upper, 1.8, {"upper": 1.0}),
            (along("upper", 41.0), upper, 1.8, {"upper": 1.0}),
            (along("upper", 46.0), upper, 1.6, {"upper": 0.5, "head": 0.5}),
        ]
    )
    return [iron, arm]


def number(value: float) -> str:
    """A number as Doom's tools write it."""
    text = f"{value:.10f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def group(values: tuple[float, ...]) -> str:
    """Numbers in parentheses."""
    return f"( {' '.join(map(number, values))} )"


def part(turn: Quaternion) -> Vector:
    """Three parts of the one of its two quaternions whose fourth is not positive."""
    return tuple(-one for one in turn[:3]) if turn[3] > 0 else turn[:3]


def md5mesh() -> str:
    """The file of the mesh."""
    made = meshes()
    lines = [
        "MD5Version 10",
        'commandline "lamp"',
        "",
        f"numJoints {len(BONES)}",
        f"numMeshes {len(made)}",
        "",
        "joints {",
    ]
    for name, (parent, place, direction) in BONES.items():
        carrier = NAMES.index(parent) if parent else -1
        lines.append(f'\t"{name}"\t{carrier} {group(place)} {group(part(toward(direction)))}\t\t// {parent or ""}')
    lines += ["}", ""]
    for mesh in made:
        vertices, weights = [], []
        for k, (point, place, carried) in enumerate(mesh.vertices):
            vertices.append(f"\tvert {k} {group(place)} {len(weights)} {len(carried)}")
            for bone, share in carried.items():
                own = f"{NAMES.index(bone)} {number(share)} {group(local(bone, point))}"
                weights.append(f"\tweight {len(weights)} {own}")
        triangles = [f"\ttri {k} {a} {b} {c}" for k, (a, b, c) in enumerate(mesh.triangles)]
        lines += ["mesh {", f'\tshader "{mesh.shader}"', "", f"\tnumverts {len(vertices)}", *vertices, ""]
        lines += [f"\tnumtris {len(triangles)}", *triangles, "", f"\tnumweights {len(weights)}", *weights, "}", ""]
    return "\n".join(lines)


def md5anim() -> str:
    """The file of the motion: the arm bows, the head looks up; the last frame is the first again."""
    rest = {}
    for name, (parent, place, direction) in BONES.items():
        turn = toward(direction)
        if parent:
            rest[name] = (local(parent, place), times(back(toward(BONES[parent][2])), turn))
        else:
            rest[name] = (place, turn)
    bend = {
        "lower": lambda t: 0.16 * (1 - wave(t + 0.25)),
        "upper": lambda t: 0.1 * wave(t),
        "head": lambda t: 0.3 * wave(2 * t),
    }
    lines = ["MD5Version 10", 'commandline "bow"', "", f"numFrames {FRAMES + 1}", f"numJoints {len(BONES)}"]
    lines += [f"frameRate {RATE}", f"numAnimatedComponents {3 * len(bend)}", "", "hierarchy {"]
    for name, (parent, _, _) in BONES.items():
        moved = name in bend
        start = 3 * list(bend).index(name) if moved else 0
        lines.append(
            f'\t"{name}"\t{NAMES.index(parent) if parent else -1} {56 if moved else 0} {start}\t// {parent or ""}'
        )
    lines += ["}", "", "bounds {", *["\t( -40 -20 0 ) ( 60 20 80 )"] * (FRAMES + 1), "}", "", "baseframe {"]
    lines += [f"\t{group(place)} {group(part(turn))}" for place, turn in rest.values()]
    lines += ["}", ""]
    for frame in range(FRAMES + 1):
        lines.append(f"frame {frame} {{")
        for name, law in bend.items():
            turn = times(rest[name][1], about_y(law(frame / FRAMES)))
            lines.append("\t" + " ".join(map(number, part(turn))))
        lines += ["}", ""]
    return "\n".join(lines)
