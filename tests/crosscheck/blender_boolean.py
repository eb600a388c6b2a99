"""Blender's exact boolean of two meshes: `blender_boolean.py IN.npz OPERATION OUT.npz`, in a process of its own."""

from __future__ import annotations

import sys

import bpy
import numpy as np


def mesh(name: str, points: np.ndarray, triangles: np.ndarray) -> bpy.types.Object:
    """An object of bare triangles."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(points.tolist(), [], triangles.tolist())
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def main() -> None:
    """Apply the modifier and write the triangles of the result."""
    source, operation, target = sys.argv[1:]
    given = np.load(source)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    one = mesh("a", given["points_a"], given["triangles_a"])
    other = mesh("b", given["points_b"], given["triangles_b"])
    modifier = one.modifiers.new("boolean", "BOOLEAN")
    modifier.operation, modifier.object, modifier.solver = operation, other, "EXACT"
    made = one.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    made.calc_loop_triangles()
    points = np.array([vertex.co[:] for vertex in made.vertices])
    triangles = np.array([triangle.vertices[:] for triangle in made.loop_triangles])
    np.savez(target, points=points, triangles=triangles)


if __name__ == "__main__":
    main()
