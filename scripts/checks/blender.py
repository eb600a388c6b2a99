"""What Blender finds when it imports the file: counts, volume, area, topology, world bounds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import bpy  # isort: skip -- the wheel makes bmesh importable
import bmesh
from mathutils import Matrix

from checks import finding

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

TOOL = "blender"
TO_GLTF = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))


def measure(path: Path) -> finding.Measured:
    """The facts of one file. Blender is Z-up: its (x, y, z) is glTF's (x, z, -y)."""
    open_file(path)
    shown = [item for item in bpy.context.scene.objects if item.type == "MESH"]
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    meshes = {item.data.name: item.data for item in shown}
    totals = {
        "meshes": len(meshes),
        "nodes": len(bpy.context.scene.objects),
        "materials": len(bpy.data.materials),
        "images": len(bpy.data.images),
        "bounds": box(item.matrix_world @ vertex.co for item in shown for vertex in item.data.vertices),
    }
    shapes = {name: shape(mesh) for name, mesh in meshes.items()}
    nodes = {item.name: world(item) for item in bpy.context.scene.objects}
    return finding.Measured(TOOL, bpy.app.version_string, str(path), totals, shapes, nodes)


def open_file(path: Path) -> None:
    """An empty scene with the file in it, vertices split as written."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path), merge_vertices=False, disable_bone_shape=True)


def world(item: bpy.types.Object) -> list[float]:
    """An object's world matrix in glTF's axes, column by column."""
    turned = TO_GLTF @ item.matrix_world @ TO_GLTF.inverted()
    return [turned[row][column] for column in range(4) for row in range(4)]


def shape(data: bpy.types.Mesh) -> dict[str, Any]:
    """The facts of one mesh; points at equal positions are merged before topology is counted."""
    mesh = bmesh.new()
    mesh.from_mesh(data)
    bounds = box(vertex.co for vertex in mesh.verts)
    facts: dict[str, Any] = take_lines(mesh)
    facts |= {"bounds": bounds, "vertices": len(mesh.verts), "proper-triangles": len(mesh.faces)}
    if not mesh.faces:
        mesh.free()
        return facts
    weld(mesh)
    facts["proper-area"] = math.fsum(face.calc_area() for face in mesh.faces)
    facts["closed-volume"] = mesh.calc_volume(signed=True)
    facts["proper-boundary-edges"] = sum(edge.is_boundary for edge in mesh.edges)
    facts["proper-edge-manifold"] = all(edge.is_manifold and edge.is_contiguous for edge in mesh.edges)
    facts["proper-euler"] = len(mesh.verts) - len(mesh.edges) + len(mesh.faces)
    mesh.free()
    return facts


def take_lines(mesh: bmesh.types.BMesh) -> dict[str, Any]:
    """The facts of the edges that bound no face, which are then taken out; none where there are none."""
    lines = [edge for edge in mesh.edges if edge.is_wire]
    if not lines:
        return {}
    ends = {vertex for edge in lines for vertex in edge.verts}
    facts = {
        "lines.segments": len(lines),
        "lines.vertices": len(ends),
        "lines.length": math.fsum(edge.calc_length() for edge in lines),
        "lines.bounds": box(vertex.co for vertex in ends),
    }
    bmesh.ops.delete(mesh, geom=[*lines], context="EDGES")
    bmesh.ops.delete(mesh, geom=[vertex for vertex in mesh.verts if not vertex.link_edges], context="VERTS")
    return facts


def weld(mesh: bmesh.types.BMesh) -> None:
    """Merge vertices at equal positions.

    Blender's merge by distance searches a tree whose comparisons miss equal points when the distance is
    lost beside the coordinates, so the pairs are named here.
    """
    first: dict[tuple[float, ...], bmesh.types.BMVert] = {}
    targets = {}
    for vertex in mesh.verts:
        kept = first.setdefault(tuple(value + 0.0 for value in vertex.co), vertex)
        if kept is not vertex:
            targets[vertex] = kept
    bmesh.ops.weld_verts(mesh, targetmap=targets)


def box(points: Iterable[Any]) -> dict[str, list[float]]:
    """The bounding box in glTF's axes."""
    turned = [(point.x, point.z, -point.y) for point in points]
    axes = list(zip(*turned, strict=True))
    return {"min": [min(axis) for axis in axes], "max": [max(axis) for axis in axes]}


if __name__ == "__main__":
    finding.run(TOOL, bpy.app.version_string, measure)
