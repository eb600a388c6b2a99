"""Measures the quality of what a tool wrote, by one measure for all: `quality.py CASE OUT.json FILE...`.

Deviation is the largest distance from points spread densely over the facets to the true surface; positions
are merged to single precision first, so that text formats with few digits are not called open.
"""

from __future__ import annotations

import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from models import BEZIERS, PATH_END, TUBE_RADIUS, loft_profile, path_point

if TYPE_CHECKING:
    from numpy.typing import NDArray

CURVE_SAMPLES = 4000  # chords of this many pieces leave the curve by less than 1e-6 of the model
TRIED = 500  # points that decide which way a file's axes are turned
# Points of a triangle in barycentric coordinates: the middle, the middles of the sides, and between these.
SPREAD = [
    (1 / 3, 1 / 3, 1 / 3), (0.5, 0.5, 0.0), (0.5, 0.0, 0.5), (0.0, 0.5, 0.5),
    (0.6, 0.2, 0.2), (0.2, 0.6, 0.2), (0.2, 0.2, 0.6),
]  # fmt: skip


def measure(case: str, file: Path) -> dict[str, Any]:
    """Triangles, bytes, closedness, volume and deviation of one file."""
    mesh = load(file)
    deviation = {"vase": vase_deviation, "sweep": sweep_deviation, "loft": loft_deviation}[case](mesh)
    return {
        "triangles": len(mesh.faces),
        "bytes": file.stat().st_size,
        "closed": bool(mesh.is_watertight and mesh.is_winding_consistent),
        "volume": float(abs(mesh.volume)),
        "deviation": deviation,
    }


def load(file: Path) -> trimesh.Trimesh:
    """The whole file as one mesh, merged by position; millimeters of CAD tools turned back to the model."""
    mesh = read_off(file) if file.suffix == ".off" else trimesh.load_scene(file, process=False).to_mesh()
    mesh = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    if mesh.extents.max() < 0.1:
        mesh.apply_scale(1000.0)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=6)
    mesh.update_faces(mesh.nondegenerate_faces(height=0.0))
    return mesh


def read_off(file: Path) -> trimesh.Trimesh:
    """An OFF file with polygons of mixed sizes, as fans; trimesh's own reader fails on those."""
    words = iter(file.read_text().split()[1:])
    vertices, faces, _ = (int(next(words)) for _ in range(3))
    points = [[float(next(words)) for _ in range(3)] for _ in range(vertices)]
    triangles = []
    for _ in range(faces):
        polygon = [int(next(words)) for _ in range(int(next(words)))]
        triangles += [[polygon[0], a, b] for a, b in pairwise(polygon[1:])]
    return trimesh.Trimesh(points, triangles, process=False)


def spread(mesh: trimesh.Trimesh) -> NDArray[np.float64]:
    """Points all over the facets, one weight after the other."""
    corners = mesh.vertices[mesh.faces]
    return np.concatenate([np.einsum("c,tci->ti", np.array(weights), corners) for weights in SPREAD])


def vase_deviation(mesh: trimesh.Trimesh) -> float:
    """The largest distance to the profile, measured in the plane of radius and height.

    The vase is as high as 2 along its axis and wider than 2.05 across.
    """
    axis = int(np.argmin(np.abs(mesh.extents - 2.0)))
    points = spread(mesh)
    height = points[:, axis] - mesh.bounds[0][axis]
    radius = np.linalg.norm(np.delete(points, axis, axis=1), axis=1)
    upright = np.column_stack([radius, height])
    ways = (upright, upright * [1, -1] + [0, 2])
    curve = vase_curve()
    fitting = min(ways, key=lambda way: largest(way[:: len(way) // TRIED], curve))
    return largest(fitting, curve)


def vase_curve() -> NDArray[np.float64]:
    """The profile as a fine polyline."""
    t = np.linspace(0, 1, CURVE_SAMPLES // 2)[:, None]
    s = 1 - t
    weights = np.hstack([s**3, 3 * s * s * t, 3 * s * t * t, t**3])
    low, high = (weights @ control for control in np.array(BEZIERS))
    return np.concatenate([low, high[1:]])  # no point twice: distances look at the pieces beside one point


def loft_deviation(mesh: trimesh.Trimesh) -> float:
    """The largest distance to the outline in the plane of radius and height, the flat ends left out.

    The loft is 3 high along its axis and 2 wide.
    """
    axis = int(np.argmax(mesh.extents))
    points = spread(mesh)
    height = points[:, axis] - mesh.bounds[0][axis]
    radius = np.linalg.norm(np.delete(points, axis, axis=1), axis=1)
    upright = np.column_stack([radius, height])
    curve = np.array(loft_profile(CURVE_SAMPLES))
    inner = 1e-6  # single precision of a height of 3
    found = []
    for way in (upright, upright * [1, -1] + [0, 3]):
        walls = way[(way[:, 1] > inner) & (way[:, 1] < 3 - inner)]
        found.append(largest(walls, curve))
    return min(found)


def sweep_deviation(mesh: trimesh.Trimesh) -> float:
    """How far distances to the path are from the tube's radius, the caps left out.

    Tools choose their own axes (glTF turns z up to y up), so the fitting ones are taken.
    """
    curve = np.array([path_point(t) for t in np.linspace(0, PATH_END, CURVE_SAMPLES)])
    points = spread(mesh)
    ways = (points, points[:, [0, 2, 1]] * [1, -1, 1])
    fitting = min(ways, key=lambda way: np.abs(tube_distance(way[:: len(way) // TRIED], curve)).max())
    return float(np.abs(tube_distance(fitting, curve)).max())


def tube_distance(points: NDArray[np.float64], curve: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed distances to the tube; points whose nearest point of the path is an end count as on it."""
    nearest = cKDTree(curve).query(points)[1]
    inner = (nearest > 0) & (nearest < len(curve) - 1)
    return np.where(inner, to_polyline(points, curve, nearest) - TUBE_RADIUS, 0.0)


def largest(points: NDArray[np.float64], curve: NDArray[np.float64]) -> float:
    """The largest distance to a fine polyline."""
    return float(to_polyline(points, curve, cKDTree(curve).query(points)[1]).max())


def to_polyline(
    points: NDArray[np.float64], curve: NDArray[np.float64], nearest: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Distances to the two segments beside each point's nearest sample."""
    found = np.full(len(points), np.inf)
    for step in (-1, 0):
        start = curve[np.clip(nearest + step, 0, len(curve) - 2)]
        along = curve[np.clip(nearest + step + 1, 1, len(curve) - 1)] - start
        square = np.maximum((along * along).sum(axis=1), 1e-300)
        t = np.clip(((points - start) * along).sum(axis=1) / square, 0, 1)
        found = np.minimum(found, np.linalg.norm(start + t[:, None] * along - points, axis=1))
    return found


if __name__ == "__main__":
    case, out, *files = sys.argv[1:]
    Path(out).write_text(json.dumps([measure(case, Path(file)) for file in files]))
