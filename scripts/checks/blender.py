"""What Blender finds when it imports the file: counts, volume, area, topology, world bounds."""

from __future__ import annotations

import math
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy  # isort: skip -- the wheel makes bmesh importable
import bmesh

from checks import blender_motion, finding, played
from checks.document import Document, split, without_animations

if TYPE_CHECKING:
    from collections.abc import Iterable

TOOL = "blender"
# What the importer makes to show colors of vertices without a material.
STAND_IN = "DefaultMaterial"


def measure(path: Path) -> finding.Measured:
    """The facts of one file. Blender is Z-up: its (x, y, z) is glTF's (x, z, -y)."""
    open_still(path)
    document = Document(path)
    coarser = document.coarser_meshes
    shown = [item for item in bpy.context.scene.objects if item.type == "MESH"]
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    meshes = {item.data.name: item.data for item in shown}
    totals = {
        "meshes": len(meshes),
        "nodes": count_nodes(document.above_joints) - len(document.carriers),
        "materials": sum(not own.name.startswith(STAND_IN) for own in bpy.data.materials),
        "images": len(bpy.data.images),
        "bounds": box(
            item.matrix_world @ vertex.co
            for item in shown
            if item.data.name not in coarser
            for vertex in item.data.vertices
        ),
    }
    shapes = {name: shape(mesh) for name, mesh in meshes.items()}
    nodes = blender_motion.worlds(graph)
    rest = blender_motion.Rest.of_scene()
    clips = {}
    if played.asked(path):
        open_file(path)
        clips = blender_motion.clips(path, rest)
    return finding.Measured(TOOL, bpy.app.version_string, str(path), totals, shapes, nodes, clips)


def count_nodes(above: set[str]) -> int:
    """Objects and bones; the importer makes an armature for each skeleton: of the node above it, else of none."""
    objects = bpy.context.scene.objects
    bones = sum(len(item.data.bones) for item in objects if item.type == "ARMATURE")
    return sum(item.type != "ARMATURE" or item.name in above for item in objects) + bones


def open_still(path: Path) -> None:
    """The file as it is at rest."""
    if not split(path.read_bytes())[0].get("animations"):
        open_file(path)
        return
    with tempfile.TemporaryDirectory() as folder:
        still = Path(folder) / path.name
        still.write_bytes(without_animations(path))
        open_file(still)


def open_file(path: Path) -> None:
    """An empty scene with the file in it, vertices split as written."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(
        filepath=str(path), merge_vertices=False, disable_bone_shape=True, bone_heuristic="BLENDER"
    )


def shape(data: bpy.types.Mesh) -> dict[str, Any]:
    """The facts of one mesh; points at equal positions are merged before topology is counted."""
    mesh = bmesh.new()
    mesh.from_mesh(data)
    bounds = box(vertex.co for vertex in mesh.verts)
    facts: dict[str, Any] = take_lines(mesh)
    facts |= {"bounds": bounds, "separate-vertices": len(mesh.verts), "proper-triangles": len(mesh.faces)}
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
