"""geomdl: nanoseconds for a point of the face with its first derivatives, `peer_surface.py STEPS`."""

from __future__ import annotations

import sys
import time

from geomdl import BSpline

from nets import DEGREE, FACE_COUNT, face, face_knots


def main() -> None:
    """Even steps over the domain, one place after the other, as geomdl evaluates."""
    steps = int(sys.argv[1])
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = DEGREE
    surface.set_ctrlpts([point for row in face() for point in row], FACE_COUNT, FACE_COUNT)
    surface.knotvector_u = surface.knotvector_v = face_knots()
    places = [(i / steps, j / steps) for i in range(steps + 1) for j in range(steps + 1)]
    started = time.perf_counter()
    for u, v in places:
        surface.derivatives(u, v, 1)
    sys.stdout.write(f"{(time.perf_counter() - started) * 1e9 / len(places)}\n")


if __name__ == "__main__":
    main()
