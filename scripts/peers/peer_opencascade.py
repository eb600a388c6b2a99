"""OpenCascade through CadQuery: the exact B-spline face, meshed to a tolerance.

`peer_opencascade.py face OUT.stl TOLERANCE ANGLE`
"""

from __future__ import annotations

import sys

import cadquery
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

from nets import DEGREE, face, face_knots


def main() -> None:
    """One face, as triangles."""
    grid = face()
    poles = TColgp_Array2OfPnt(1, len(grid[0]), 1, len(grid))
    for row, points in enumerate(grid):
        for column, (x, y, z) in enumerate(points):
            poles.SetValue(column + 1, row + 1, gp_Pnt(x, y, z))
    distinct = sorted(set(face_knots()))
    knots, counts = TColStd_Array1OfReal(1, len(distinct)), TColStd_Array1OfInteger(1, len(distinct))
    for k, knot in enumerate(distinct):
        knots.SetValue(k + 1, knot)
        counts.SetValue(k + 1, DEGREE + 1 if k in (0, len(distinct) - 1) else 1)
    surface = Geom_BSplineSurface(poles, knots, knots, counts, counts, DEGREE, DEGREE)
    made = cadquery.Face(BRepBuilderAPI_MakeFace(surface, 1e-9).Face())
    tolerance, angle = float(sys.argv[3]), float(sys.argv[4])
    cadquery.exporters.export(cadquery.Workplane(obj=made), sys.argv[2], tolerance=tolerance, angularTolerance=angle)


if __name__ == "__main__":
    main()
