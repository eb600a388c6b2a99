"""Manifold: revolve, and a straight extrusion warped along the path; trimesh writes the file.

`peer_manifold.py CASE OUT.glb`
"""

from __future__ import annotations

import sys

import manifold3d
import numpy as np
import trimesh

from models import PATH_SEGMENTS, TUBE_RADIUS, TUBE_SEGMENTS, TURN_SEGMENTS, frames, path, profile


def vase() -> manifold3d.Manifold:
    """The profile revolved."""
    return manifold3d.CrossSection([profile()]).revolve(TURN_SEGMENTS)


def sweep() -> manifold3d.Manifold:
    """A prism whose layers are moved to the frames of the path."""
    points, axes = np.array(path()), np.array(frames())
    circle = manifold3d.CrossSection.circle(TUBE_RADIUS, TUBE_SEGMENTS)
    prism = manifold3d.Manifold.extrude(circle, float(PATH_SEGMENTS), PATH_SEGMENTS - 1)

    def bend(vertices: np.ndarray) -> np.ndarray:
        layer = np.rint(vertices[:, 2]).astype(int)
        return points[layer] + axes[layer, 0] * vertices[:, :1] + axes[layer, 1] * vertices[:, 1:2]

    return prism.warp_batch(bend)


if __name__ == "__main__":
    made = {"vase": vase, "sweep": sweep}[sys.argv[1]]().to_mesh()
    trimesh.Trimesh(made.vert_properties[:, :3], made.tri_verts, process=False).export(sys.argv[2])
