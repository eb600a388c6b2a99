"""Blender: the screw modifier, the curve bevel, a mesh of rings and NURBS surfaces, exported by its own glTF exporter.

`peer_blender.py CASE OUT.glb`
"""

from __future__ import annotations

import math
import sys

import bpy  # isort: skip -- the wheel makes the rest importable
from models import (
    LOFT_AROUND,
    PROFILE_SEGMENTS,
    TUBE_RADIUS,
    TUBE_SEGMENTS,
    TURN_SEGMENTS,
    loft_profile,
    path,
    profile,
)
from nets import TEAPOT_STEPS, teapot


def vase() -> None:
    """The profile as a polyline with a screw modifier."""
    mesh = bpy.data.meshes.new("vase")
    points = [(radius, 0.0, height) for radius, height in profile()]
    mesh.from_pydata(points, [(i, i + 1) for i in range(PROFILE_SEGMENTS)], [])
    screw = show(mesh).modifiers.new("screw", "SCREW")
    screw.steps = screw.render_steps = TURN_SEGMENTS
    screw.use_merge_vertices, screw.merge_threshold = True, 1e-6
    screw.use_normal_calculate = screw.use_smooth_shade = True


def sweep() -> None:
    """The path as a curve with a round bevel; its resolution counts the points of a quarter."""
    curve = bpy.data.curves.new("sweep", "CURVE")
    curve.dimensions, curve.twist_mode = "3D", "MINIMUM"
    curve.bevel_depth, curve.bevel_resolution = TUBE_RADIUS, (TUBE_SEGMENTS - 4) // 2
    curve.use_fill_caps = True
    points = path()
    spline = curve.splines.new("POLY")
    spline.points.add(len(points) - 1)
    for at, point in zip(spline.points, points, strict=True):
        at.co = (*point, 1.0)
    item = show(curve)
    bpy.context.view_layer.objects.active = item
    item.select_set(True)
    bpy.ops.object.convert(target="MESH")


def loft() -> None:
    """Rings of the spline through three circles, bridged by quads; Blender's own bridge makes no splines."""
    count, rings = LOFT_AROUND, loft_profile()
    turns = [2.0 * math.pi * k / count for k in range(count)]
    points = [(r * math.cos(a), r * math.sin(a), z) for r, z in rings for a in turns]
    faces = [
        (row * count + k, row * count + (k + 1) % count, (row + 1) * count + (k + 1) % count, (row + 1) * count + k)
        for row in range(len(rings) - 1)
        for k in range(count)
    ]
    last = (len(rings) - 1) * count
    faces += [tuple(reversed(range(count))), tuple(range(last, last + count))]
    mesh = bpy.data.meshes.new("loft")
    mesh.from_pydata(points, [], faces)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=math.radians(30.0))
    show(mesh)


def pot() -> None:
    """Each patch of the teapot as a NURBS surface; rows become one when they are joined as segments."""
    for number, grid in enumerate(teapot()):
        surface = bpy.data.curves.new(f"patch-{number}", "SURFACE")
        surface.dimensions = "3D"
        for row in grid:
            line = surface.splines.new("NURBS")
            line.points.add(len(row) - 1)
            for at, point in zip(line.points, row, strict=True):
                at.co, at.select = (*point, 1.0), True
        item = show(surface)
        bpy.context.view_layer.objects.active = item
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.curve.make_segment()
        bpy.ops.object.mode_set(mode="OBJECT")
        net = surface.splines[0]
        for place, at in enumerate(net.points):
            at.co = (*grid[place % 4][place // 4], 1.0)
        net.order_u = net.order_v = 4
        net.use_endpoint_u = net.use_endpoint_v = True
        net.resolution_u = net.resolution_v = TEAPOT_STEPS // 4


def show(data: bpy.types.ID) -> bpy.types.Object:
    """An object of the scene for mesh or curve data."""
    item = bpy.data.objects.new(data.name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


if __name__ == "__main__":
    bpy.ops.wm.read_factory_settings(use_empty=True)
    {"vase": vase, "sweep": sweep, "loft": loft, "teapot": pot}[sys.argv[1]]()
    bpy.ops.export_scene.gltf(filepath=sys.argv[2], export_apply=True, export_animations=False)
