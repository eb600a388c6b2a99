"""Blender's automatic weights: `blender_weights.py IN.npz OUT.npz`, in a process of its own.

In: points, triangles, heads and tails of bones. Out: the weights of each point for each bone, of sum 1 where Blender
gives any, and how many seconds its weights took.
"""

from __future__ import annotations

import sys
import time

import bpy
import numpy as np


def armature(heads: np.ndarray, tails: np.ndarray) -> bpy.types.Object:
    """Bones without parents: weights depend on where they are."""
    item = bpy.data.objects.new("armature", bpy.data.armatures.new("armature"))
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    for number, (head, tail) in enumerate(zip(heads, tails, strict=True)):
        bone = item.data.edit_bones.new(f"bone-{number}")
        bone.head, bone.tail = head.tolist(), tail.tolist()
    bpy.ops.object.mode_set(mode="OBJECT")
    return item


def main() -> None:
    """Bind the mesh and read the groups."""
    source, target = sys.argv[1:]
    given = np.load(source)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rig = armature(given["heads"], given["tails"])
    data = bpy.data.meshes.new("mesh")
    data.from_pydata(given["points"].tolist(), [], given["triangles"].tolist())
    item = bpy.data.objects.new("mesh", data)
    bpy.context.scene.collection.objects.link(item)
    item.select_set(True)
    rig.select_set(True)
    bpy.context.view_layer.objects.active = rig
    started = time.perf_counter()
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    seconds = time.perf_counter() - started
    weights = np.zeros((len(data.vertices), len(given["heads"])))
    bones = {group.index: int(group.name.removeprefix("bone-")) for group in item.vertex_groups}
    for vertex in data.vertices:
        for element in vertex.groups:
            weights[vertex.index, bones[element.group]] = element.weight
    sums = weights.sum(1, keepdims=True)
    np.savez(target, weights=np.divide(weights, sums, where=sums > 0, out=weights), seconds=seconds)


if __name__ == "__main__":
    main()
