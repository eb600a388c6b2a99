"""Blender's inverse kinematics, baked: `peer_ik.py IN.npz OUT.npz`, in a process of its own.

In: heads and tails of a chain of bones, limits of each about its x, y and z in degrees, places of the target for each
frame. Out: how many seconds the bake of all frames took, and how far the tip of the chain is from the target then.
"""

from __future__ import annotations

import sys
import time

import bpy
import numpy as np


def chain(heads: np.ndarray, tails: np.ndarray, limits: np.ndarray) -> bpy.types.Object:
    """A chain of connected bones with limits."""
    rig = bpy.data.objects.new("chain", bpy.data.armatures.new("chain"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    rig.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    before = None
    for number, (head, tail) in enumerate(zip(heads, tails, strict=True)):
        bone = rig.data.edit_bones.new(f"bone-{number}")
        bone.head, bone.tail = head.tolist(), tail.tolist()
        bone.parent, bone.use_connect = before, before is not None
        before = bone
    bpy.ops.object.mode_set(mode="POSE")
    for number, ranges in enumerate(np.radians(limits)):
        bone = rig.pose.bones[f"bone-{number}"]
        for axis, (least, most) in zip("xyz", ranges, strict=True):
            setattr(bone, f"use_ik_limit_{axis}", True)
            setattr(bone, f"ik_min_{axis}", least)
            setattr(bone, f"ik_max_{axis}", most)
    return rig


def target(places: np.ndarray) -> bpy.types.Object:
    """An object that is at a place in each frame."""
    item = bpy.data.objects.new("target", None)
    bpy.context.scene.collection.objects.link(item)
    for frame, place in enumerate(places, start=1):
        item.location = place.tolist()
        item.keyframe_insert("location", frame=frame)
    return item


def main() -> None:
    """Bake, then look at where the tip is."""
    source, out = sys.argv[1:]
    given = np.load(source)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    places = given["places"]
    goal = target(places)
    rig = chain(given["heads"], given["tails"], given["limits"])
    last = rig.pose.bones[len(given["heads"]) - 1]
    reach = last.constraints.new("IK")
    reach.target = goal
    started = time.perf_counter()
    bpy.ops.nla.bake(
        frame_start=1,
        frame_end=len(places),
        step=1,
        only_selected=False,
        visual_keying=True,
        clear_constraints=True,
        use_current_action=True,
        bake_types={"POSE"},
    )
    seconds = time.perf_counter() - started
    distances = []
    for frame, place in enumerate(places, start=1):
        bpy.context.scene.frame_set(frame)
        found = np.array(rig.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones[last.name].tail)
        distances.append(np.linalg.norm(found - place))
    np.savez(out, seconds=seconds, distances=distances)


if __name__ == "__main__":
    main()
