"""geomdl: the teapot's patches as B-spline surfaces, tessellated and written as OBJ.

`peer_geomdl.py teapot OUT.obj`
"""

from __future__ import annotations

import sys

from geomdl import BSpline, exchange, multi, utilities

from nets import TEAPOT_STEPS, teapot


def main() -> None:
    """All patches in one file."""
    container = multi.SurfaceContainer()
    for grid in teapot():
        surface = BSpline.Surface()
        surface.degree_u = surface.degree_v = 3
        surface.set_ctrlpts([point for row in grid for point in row], 4, 4)
        surface.knotvector_u = surface.knotvector_v = utilities.generate_knot_vector(3, 4)
        container.add(surface)
    container.sample_size = TEAPOT_STEPS + 1
    container.tessellate()
    exchange.export_obj(container, sys.argv[2])


if __name__ == "__main__":
    main()
