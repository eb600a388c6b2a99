"""Clips played by Blender: its depsgraph evaluated at the times that a report names.

Blender moves rotations between keys along straight lines that are brought back to unit length, and places bones with
their y along the bone, as the joints of our files have it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import bpy  # isort: skip -- the wheel makes mathutils importable
from mathutils import Matrix
from mathutils.kdtree import KDTree

from checks import played
from checks.document import Document

if TYPE_CHECKING:
    from pathlib import Path

FROM_GLTF = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
TO_GLTF = FROM_GLTF.inverted()


@dataclass(frozen=True)
class Rest:
    """Where everything is before any clip plays, by name; weights by the names of meshes.

    A skinned mesh whose weights a clip moves is an object of its own where the file has the clip, and stays in place.
    """

    items: dict[str, Matrix]
    bones: dict[tuple[str, str], Matrix]
    weights: dict[tuple[str, str], float]

    @classmethod
    def of_scene(cls) -> Rest:
        """The scene as it is."""
        objects = bpy.context.scene.objects
        bones = {(item.name, bone.name): bone for item in objects if item.pose for bone in item.pose.bones}
        return cls(
            {item.name: item.matrix_basis.copy() for item in objects},
            {names: bone.matrix_basis.copy() for names, bone in bones.items()},
            {(item.data.name, key.name): key.value for item in objects for key in keys(item)},
        )

    def restore(self) -> None:
        """Put everything back."""
        for item in bpy.context.scene.objects:
            if item.name in self.items:
                item.matrix_basis = self.items[item.name]
            for bone in item.pose.bones if item.pose else []:
                bone.matrix_basis = self.bones[item.name, bone.name]
            for key in keys(item):
                key.value = self.weights[item.data.name, key.name]


def keys(item: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """The shape keys of an object that stand for morph targets."""
    shapes = getattr(item.data, "shape_keys", None) if item.data else None
    return list(shapes.key_blocks[1:]) if shapes else []


def clips(path: Path, rest: Rest) -> dict[str, list[dict[str, Any]]]:
    """The poses of every clip that the report beside the opened file names."""
    questions = played.asked(path)
    numbers = vertex_numbers(path, questions)
    for key in [key for item in bpy.context.scene.objects for key in keys(item)]:
        # The import leaves values between 0 and 1 alone, and Blender keeps weights within the range of their sliders.
        key.slider_min, key.slider_max = -10.0, 10.0
    found = {}
    for name, clip in questions.items():
        rest.restore()
        start(name)
        found[name] = [pose(question, numbers) for question in clip["poses"]]
    return found


def start(name: str) -> None:
    """Let every object play its part of a clip and nothing else."""
    for item in [*bpy.data.objects, *bpy.data.shape_keys]:
        data = item.animation_data
        if data is None:
            continue
        data.action = None
        for track in data.nla_tracks:
            track.mute = True
            if track.name == name:
                strip = track.strips[0]
                data.action = strip.action
                if getattr(strip, "action_slot", None) is not None:
                    data.action_slot = strip.action_slot


def pose(question: dict[str, Any], numbers: dict[str, list[int]]) -> dict[str, Any]:
    """The scene at a time."""
    scene = bpy.context.scene
    frame = question["time"] * scene.render.fps / scene.render.fps_base
    scene.frame_set(int(frame), subframe=frame - int(frame))
    graph = bpy.context.evaluated_depsgraph_get()
    nodes = worlds(graph)
    vertices = {}
    for item in scene.objects:
        if item.type == "MESH" and item.data.name in numbers:
            evaluated = item.evaluated_get(graph)
            mesh = evaluated.to_mesh()
            places = [TO_GLTF @ (evaluated.matrix_world @ mesh.vertices[k].co) for k in numbers[item.data.name]]
            vertices[item.data.name] = [list(place) for place in places]
            evaluated.to_mesh_clear()
    return {
        "time": question["time"],
        "nodes": {n: nodes[n] for n in question["nodes"] if n in nodes},
        "vertices": vertices,
    }


def worlds(graph: bpy.types.Depsgraph) -> dict[str, list[float]]:
    """World matrices in glTF's axes, column by column, of objects and of bones."""
    found = {}
    for item in bpy.context.scene.objects:
        evaluated = item.evaluated_get(graph)
        # Cameras and lights look along their own -z in both.
        own = Matrix.Identity(4) if item.type in ("CAMERA", "LIGHT") else FROM_GLTF
        # What joints carry has no place in the tree; the importer hangs it on their armature, where it has none either.
        hung = any(modifier.type == "ARMATURE" for modifier in item.modifiers)
        world = evaluated.matrix_local if hung else evaluated.matrix_world
        found[item.name] = flat(TO_GLTF @ world @ own)
    for item in bpy.context.scene.objects:
        if item.type == "ARMATURE":
            evaluated = item.evaluated_get(graph)
            for bone in evaluated.pose.bones:
                found[bone.name] = flat(TO_GLTF @ evaluated.matrix_world @ bone.matrix)
    return found


def flat(matrix: Matrix) -> list[float]:
    """A matrix column by column."""
    return [matrix[row][column] for column in range(4) for row in range(4)]


def vertex_numbers(path: Path, questions: dict[str, Any]) -> dict[str, list[int]]:
    """Blender's numbers of the vertices that the report tells, found by their places at rest.

    The importer carries skinned vertices through the pose at rest, which rounds them. Vertices at one place have the
    same weights, so any of them will do.
    """
    told = {
        name: [one["vertex"] for one in vertices]
        for clip in questions.values()
        for name, vertices in clip["poses"][0]["vertices"].items()
    }
    numbers = {}
    for mesh in Document(path).meshes:
        if mesh.name not in told or mesh.name not in bpy.data.meshes:
            continue
        vertices = bpy.data.meshes[mesh.name].vertices
        # Where states part vertices that stand at one place, numbers are those of the file, if nothing was left out.
        if mesh.targets and len(vertices) == len(mesh.positions):
            numbers[mesh.name] = told[mesh.name]
            continue
        tree = KDTree(len(vertices))
        for vertex in vertices:
            tree.insert(vertex.co, vertex.index)
        tree.balance()
        places = mesh.positions[told[mesh.name]].tolist()
        numbers[mesh.name] = [tree.find((x, -z, y))[1] for x, y, z in places]
    return numbers
