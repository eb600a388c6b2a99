"""How far facets lie from patches, and how few triangles would do: the checker of the surface parts, by numpy alone.

`surface_quality.py teapot|face OUT.json FILE...`
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
from scipy.interpolate import BSpline
from scipy.spatial import cKDTree

from nets import DEGREE, face, face_knots, teapot
from quality import spread

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SAMPLES = 48  # places along each side of a patch from which the search starts
ROUNDS = 16  # of descent
QUADRATURE = 400


@dataclass
class Patches:
    """Clamped B-spline patches over the unit square, all on one list of knots: (patches, rows, columns, 3)."""

    knots: Array
    control: Array

    def basis(self, t: Array, order: int) -> Array:
        """Derivatives of all basis functions at many parameters."""
        spline = BSpline(self.knots, np.eye(self.control.shape[1]), DEGREE)
        return spline.derivative(order)(t) if order else spline(t)

    def at(self, patch: NDArray[np.int64], u: Array, v: Array, order: tuple[int, int]) -> Array:
        """Points or derivatives, one for each place."""
        control = self.control[patch]
        return np.einsum("nr,nc,nrcd->nd", self.basis(v, order[1]), self.basis(u, order[0]), control)


def patches(case: str) -> Patches:
    """The surfaces of a case."""
    if case == "teapot":
        return Patches(np.array([0.0] * 4 + [1.0] * 4), np.array(teapot()))
    return Patches(np.array(face_knots()), np.array([face()]))


def deviation(points: Array, surface: Patches) -> float:
    """The largest distance of points to the patches, by descent from the nearest sample of every patch that is near."""
    line = np.linspace(0.0, 1.0, SAMPLES)
    v, u = (a.ravel() for a in np.meshgrid(line, line, indexing="ij"))
    found, apart = [], []
    for number in range(len(surface.control)):
        samples = surface.at(np.full(len(u), number), u, v, (0, 0))
        found.append(cKDTree(samples).query(points))
        grid = samples.reshape(SAMPLES, SAMPLES, 3)
        steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).max() for axis in (0, 1)]
        apart.append(float(np.hypot(*steps)))
    least = np.min([distance for distance, _ in found], axis=0)
    nearest = np.full(len(points), np.inf)
    for number, (distance, sample) in enumerate(found):
        # What is on a patch is no further from its nearest sample than samples are apart.
        near = np.flatnonzero(distance <= least + apart[number])
        start = sample[near]
        place = (np.full(len(near), number), u[start], v[start])
        nearest[near] = np.minimum(nearest[near], refined(points[near], surface, place))
    return float(nearest.max())


def refined(points: Array, surface: Patches, place: tuple[NDArray[np.int64], Array, Array]) -> Array:
    """Distances after damped steps (Levenberg, Marquardt) toward the foot of each point, kept inside the patch."""
    patch, u, v = place
    damping = np.full(len(points), 1e-6)
    best = np.linalg.norm(points - surface.at(patch, u, v, (0, 0)), axis=1)
    for _ in range(ROUNDS):
        away = points - surface.at(patch, u, v, (0, 0))
        du, dv = surface.at(patch, u, v, (1, 0)), surface.at(patch, u, v, (0, 1))
        a, b, c = (du * du).sum(1), (du * dv).sum(1), (dv * dv).sum(1)
        x, y = (away * du).sum(1), (away * dv).sum(1)
        # A side that is in the way stops its parameter; the other goes on alone.
        free_u = ~(((u <= 0.0) & (x < 0.0)) | ((u >= 1.0) & (x > 0.0)))
        free_v = ~(((v <= 0.0) & (y < 0.0)) | ((v >= 1.0) & (y > 0.0)))
        x, y, b = x * free_u, y * free_v, b * (free_u & free_v)
        more = damping * (a + c)
        a, c = a + more, c + more
        size = a * c - b * b
        new_u = np.clip(u + (x * c - y * b) / size, 0.0, 1.0)
        new_v = np.clip(v + (y * a - x * b) / size, 0.0, 1.0)
        found = np.linalg.norm(points - surface.at(patch, new_u, new_v, (0, 0)), axis=1)
        better = found < best
        u, v, best = np.where(better, new_u, u), np.where(better, new_v, v), np.minimum(found, best)
        damping = np.where(better, damping / 10.0, np.minimum(damping * 10.0, 1e3))
    return best


def optimum(surface: Patches) -> float:
    """The integral of sqrt|K| dA: twice the tolerance times the fewest triangles, asymptotically."""
    line = (np.arange(QUADRATURE) + 0.5) / QUADRATURE
    u, v = (a.ravel() for a in np.meshgrid(line, line))
    total = 0.0
    for patch in range(len(surface.control)):
        number = np.full(len(u), patch)
        du, dv = surface.at(number, u, v, (1, 0)), surface.at(number, u, v, (0, 1))
        normal = np.cross(du, dv)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        bends = [surface.at(number, u, v, order) for order in ((2, 0), (1, 1), (0, 2))]
        e, f, g = ((bend * normal).sum(1) for bend in bends)
        total += float(np.sqrt(np.abs(e * g - f * f)).sum()) / QUADRATURE**2
    return total


def load(file: Path, surface: Patches) -> trimesh.Trimesh:
    """The whole file as one mesh in the axes of the patches: glTF turns z up to y up."""
    mesh = trimesh.load_scene(file, process=False).to_mesh()
    low, high = surface.control.min(axis=(0, 1, 2)), surface.control.max(axis=(0, 1, 2))
    turned = np.column_stack([mesh.vertices[:, 0], -mesh.vertices[:, 2], mesh.vertices[:, 1]])

    def outside(vertices: Array) -> float:
        return float(np.maximum(low - vertices, vertices - high).max())

    vertices = min((mesh.vertices, turned), key=outside)
    return trimesh.Trimesh(vertices, mesh.faces, process=False)


def measure(file: Path, surface: Patches) -> dict[str, Any]:
    """Triangles, bytes and deviation of one file."""
    mesh = load(file, surface)
    return {
        "triangles": len(mesh.faces),
        "bytes": file.stat().st_size,
        "deviation": deviation(spread(mesh), surface),
    }


if __name__ == "__main__":
    case, out, *files = sys.argv[1:]
    shape = patches(case)
    found = {"files": [measure(Path(file), shape) for file in files], "optimum": optimum(shape)}
    Path(out).write_text(json.dumps(found))
