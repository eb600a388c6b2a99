"""The models that every tool makes from the same numbers, as plain Python without any library.

`vase`: two cubic Beziers (radius, height) revolved once; both ends lie on the axis. `sweep`: a circle of
radius 0.15 along an open space curve through 513 points. `loft`: the natural cubic spline through three circles
about one axis, which is what the natural spline through (radius, height) makes when it is turned.
"""

from __future__ import annotations

import math
from itertools import pairwise

BEZIERS = (
    ((0.0, 0.0), (0.9, 0.0), (1.2, 0.5), (1.0, 1.0)),
    ((1.0, 1.0), (0.8, 1.5), (0.5, 1.6), (0.0, 2.0)),
)
PROFILE_SEGMENTS, TURN_SEGMENTS = 128, 256
TUBE_RADIUS, TUBE_SEGMENTS, PATH_SEGMENTS = 0.15, 64, 512
PATH_END = 4.0
LOFT_RINGS = ((1.0, 0.0), (0.4, 1.0), (0.7, 3.0))
LOFT_AROUND, LOFT_ALONG = 128, 128

Pair = tuple[float, float]
Triple = tuple[float, float, float]


def bezier(control: tuple[Pair, ...], t: float) -> Pair:
    """A point of a cubic Bezier."""
    s = 1.0 - t
    weights = (s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t)
    radius, height = (sum(w * c[axis] for w, c in zip(weights, control, strict=True)) for axis in (0, 1))
    return radius, height


def profile() -> list[Pair]:
    """The vase's profile in 128 steps, both ends exactly on the axis."""
    half = PROFILE_SEGMENTS // 2
    points = [bezier(control, k / half) for control in BEZIERS for k in range(half)]
    return [*points, (0.0, 2.0)]


def path_point(t: float) -> Triple:
    """The sweep's path at t, from 0 to 4."""
    return 2.0 * math.cos(t), 2.0 * math.sin(t), 0.5 * t + 0.3 * math.sin(3.0 * t)


def path(segments: int = PATH_SEGMENTS) -> list[Triple]:
    """The sweep's path at equal steps of its parameter."""
    return [path_point(PATH_END * k / segments) for k in range(segments + 1)]


def frames() -> list[tuple[Triple, Triple, Triple]]:
    """Normal, binormal and tangent at each point of the path; normals are projected from one to the next."""
    points = path()
    tangents = [unit(minus(points[min(i + 1, PATH_SEGMENTS)], points[max(i - 1, 0)])) for i in range(len(points))]
    normal = unit(cross(tangents[0], (0.0, 0.0, 1.0)))
    found = []
    for tangent in tangents:
        off = dot(normal, tangent)
        normal = unit(minus(normal, (tangent[0] * off, tangent[1] * off, tangent[2] * off)))
        found.append((normal, cross(tangent, normal), tangent))
    return found


def loft_profile(segments: int = LOFT_ALONG) -> list[Pair]:
    """The loft's outline (radius, height) at equal steps of its parameter, which grows with the chords.

    Of a natural spline through three points only the second derivative at the middle one is unknown.
    """
    first, middle, last = LOFT_RINGS
    before, after = math.dist(first, middle), math.dist(middle, last)

    def between(t: float, axis: int) -> float:
        a, b, c = first[axis], middle[axis], last[axis]
        bend = 3.0 * ((c - b) / after - (b - a) / before) / (before + after)
        if t <= before:
            return a + (b - a) * t / before + bend * t * (t * t - before * before) / (6.0 * before)
        s = before + after - t
        return c + (b - c) * s / after + bend * s * (s * s - after * after) / (6.0 * after)

    places = [(before + after) * k / segments for k in range(segments + 1)]
    return [(between(t, 0), between(t, 1)) for t in places]


def vase_optimum(tolerance: float) -> float:
    """The asymptotic optimum of triangles for the vase: the integral of sqrt|K| dA / (2 tolerance).

    For a profile (r, z) turned about the axis sqrt|K| dA is 2 pi sqrt(r |z'| |r'z'' - z'r''|) / s du with
    s = sqrt(r'^2 + z'^2). The midpoint rule meets the square roots at the ends without evaluating there.
    """
    steps, total = 20_000, 0.0
    for control in BEZIERS:
        velocity = [(3 * (b[0] - a[0]), 3 * (b[1] - a[1])) for a, b in pairwise(control)]
        bend = [(2 * (b[0] - a[0]), 2 * (b[1] - a[1])) for a, b in pairwise(velocity)]
        for k in range(steps):
            t = (k + 0.5) / steps
            s = 1.0 - t
            r = bezier(control, t)[0]
            dr, dz = (s * s * velocity[0][i] + 2 * s * t * velocity[1][i] + t * t * velocity[2][i] for i in (0, 1))
            ddr, ddz = (s * bend[0][i] + t * bend[1][i] for i in (0, 1))
            turning = abs(dz) * abs(dr * ddz - dz * ddr)
            total += 2 * math.pi * math.sqrt(r * turning) / math.hypot(dr, dz) / steps
    return total / (2.0 * tolerance)


def minus(a: Triple, b: Triple) -> Triple:
    """A - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a: Triple, b: Triple) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Triple, b: Triple) -> Triple:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def unit(a: Triple) -> Triple:
    """A at length one."""
    size = math.sqrt(dot(a, a))
    return a[0] / size, a[1] / size, a[2] / size
