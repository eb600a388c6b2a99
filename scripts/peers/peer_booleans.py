"""Manifold from Python: two balls, one without the other; trimesh writes the file. `peer_booleans.py OUT.glb`."""

from __future__ import annotations

import sys

import manifold3d
import trimesh

SEGMENTS = 448  # of the equator: 100 352 triangles

if __name__ == "__main__":
    ball = manifold3d.Manifold.sphere(1.0, SEGMENTS)
    made = (ball - ball.translate((0.7, 0.2, 0.1))).to_mesh()
    trimesh.Trimesh(made.vert_properties[:, :3], made.tri_verts, process=False).export(sys.argv[1])
