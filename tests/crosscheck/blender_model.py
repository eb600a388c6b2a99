"""Blender as an independent modeler: `blender_model.py REQUEST.json OUT.npz`, always a process of its own.

A request names what to make: `screw` (a profile turned about the axis), `bevel` (a circle along a path), `nurbs` (a
surface by control points), or `tangents` (MikkTSpace tangents of a .glb's only mesh, at its written vertices). Meshes
come out in glTF's axes.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import bpy  # isort: skip -- the wheel makes the rest importable
import numpy as np

EMPTY = -2.0  # no tangent seen at this vertex


def screw(request: dict[str, Any]) -> dict[str, np.ndarray]:
    """A profile (radius, height) turned once by the screw modifier."""
    profile = request["profile"]
    mesh = bpy.data.meshes.new("profile")
    edges = [(i, i + 1) for i in range(len(profile) - 1)]
    mesh.from_pydata([(radius, 0.0, height) for radius, height in profile], edges, [])
    item = shown(mesh)
    modifier = item.modifiers.new("screw", "SCREW")
    modifier.steps = modifier.render_steps = request["steps"]
    modifier.use_merge_vertices, modifier.merge_threshold = True, 1e-6
    return arrays(item)


def bevel(request: dict[str, Any]) -> dict[str, np.ndarray]:
    """A circle along a path given in glTF's axes, by the curve bevel."""
    curve = bpy.data.curves.new("path", "CURVE")
    curve.dimensions, curve.twist_mode = "3D", "MINIMUM"
    curve.bevel_depth, curve.bevel_resolution = request["radius"], request["resolution"]
    curve.use_fill_caps = True
    spline = curve.splines.new("POLY")
    spline.points.add(len(request["path"]) - 1)
    for at, (x, y, z) in zip(spline.points, request["path"], strict=True):
        at.co = (x, -z, y, 1.0)
    return arrays(shown(curve))


def nurbs(request: dict[str, Any]) -> dict[str, np.ndarray]:
    """A bicubic NURBS surface from rows of points in glTF's axes and weights, the rows run by u."""
    points, weights = np.array(request["points"]), np.array(request["weights"])
    surface = bpy.data.curves.new("net", "SURFACE")
    surface.dimensions = "3D"
    for row in points:
        line = surface.splines.new("NURBS")
        line.points.add(len(row) - 1)
        for at, (x, y, z) in zip(line.points, row, strict=True):
            at.co, at.select = (x, -z, y, 1.0), True
    item = shown(surface)
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.curve.make_segment()
    bpy.ops.object.mode_set(mode="OBJECT")
    net = surface.splines[0]
    rows, columns = points.shape[:2]
    assert (net.point_count_u, net.point_count_v) == (rows, columns)
    # In Blender's list its own u runs fastest, here from row to row.
    for place, at in enumerate(net.points):
        column, row = divmod(place, rows)
        x, y, z = points[row, column]
        at.co = (x, -z, y, weights[row, column])
    net.order_u = net.order_v = 4
    net.use_endpoint_u, net.use_endpoint_v = True, not request["cyclic"]
    net.use_cyclic_v = request["cyclic"]
    net.resolution_u = net.resolution_v = request["resolution"]
    return arrays(item)


def tangents(request: dict[str, Any]) -> dict[str, np.ndarray]:
    """Tangents (x, y, z, sign) in glTF's axes for each written vertex; `EMPTY` where no face reaches."""
    bpy.ops.import_scene.gltf(filepath=request["file"], merge_vertices=False)
    mesh = next(item for item in bpy.context.scene.objects if item.type == "MESH").data
    mesh.calc_tangents()
    found = np.full((len(mesh.vertices), 4), EMPTY)
    for loop in mesh.loops:
        x, y, z = loop.tangent
        found[loop.vertex_index] = (x, z, -y, loop.bitangent_sign)
    return {"tangents": found}


def shown(data: bpy.types.ID) -> bpy.types.Object:
    """An object of the scene for mesh or curve data."""
    item = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def arrays(item: bpy.types.Object) -> dict[str, np.ndarray]:
    """Points and triangles of what the modifiers make."""
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    evaluated = item.evaluated_get(graph)
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    points = np.array([(v.co.x, v.co.z, -v.co.y) for v in mesh.vertices])
    triangles = np.array([t.vertices[:] for t in mesh.loop_triangles])
    evaluated.to_mesh_clear()
    return {"points": points, "triangles": triangles}


if __name__ == "__main__":
    request = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = {"screw": screw, "bevel": bevel, "nurbs": nurbs, "tangents": tangents}[request["make"]](request)
    np.savez(sys.argv[2], **made)
