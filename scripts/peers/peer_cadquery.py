"""CadQuery on OpenCascade: exact surfaces, meshed to a tolerance.

`peer_cadquery.py CASE OUT.glb [TOLERANCE [ANGLE]]`

The default tolerances give about the deviation that the other tools' fixed grids have.
"""

from __future__ import annotations

import sys

import cadquery

from models import BEZIERS, TUBE_RADIUS, path

TOLERANCES = {"vase": 1.7e-4, "sweep": 3e-4}
PATH_POINTS = 128  # segments of the interpolating spline: OpenCascade's own is smooth, so few are enough


def vase() -> cadquery.Workplane:
    """Two Beziers revolved as exact surfaces."""
    outline = cadquery.Workplane("XZ").moveTo(0, 0)
    for control in BEZIERS:
        outline = outline.bezier(list(control), includeCurrent=False)
    return outline.close().revolve(360, (0, 0, 0), (0, 1, 0))


def sweep() -> cadquery.Workplane:
    """A circle along an interpolating spline."""
    points = path(PATH_POINTS)
    edge = cadquery.Edge.makeSpline([cadquery.Vector(*point) for point in points])
    start = cadquery.Plane(points[0], normal=edge.tangentAt(0).toTuple())
    spine = cadquery.Workplane(obj=cadquery.Wire.assembleEdges([edge]))
    return cadquery.Workplane(start).circle(TUBE_RADIUS).sweep(spine)


if __name__ == "__main__":
    case, out, *rest = sys.argv[1:]
    tolerance = float(rest[0]) if rest else TOLERANCES[case]
    angle = float(rest[1]) if rest[1:] else 0.1
    made = {"vase": vase, "sweep": sweep}[case]()
    cadquery.Assembly(made).export(out, tolerance=tolerance, angularTolerance=angle)
