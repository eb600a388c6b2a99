"""Vertices of whole files as Blender shows them, at rest and in a clip. Runs in a process of its own.

`blender_played.py OUT.npz CLIP TIME,TIME... FILE...`: for each file and time an array of world positions, `FILE/TIME`;
no clip plays where CLIP is empty.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

from checks.blender_motion import start

RATE = 240


def shown() -> np.ndarray:
    """All vertices in the scene, with skins, shape keys and modifiers applied."""
    graph = bpy.context.evaluated_depsgraph_get()
    parts = [np.zeros((0, 3))]
    for item in sorted(bpy.context.scene.objects, key=lambda item: item.name):
        if item.type == "MESH":
            made = item.evaluated_get(graph)
            mesh = made.to_mesh()
            rows = np.zeros(3 * len(mesh.vertices))
            mesh.vertices.foreach_get("co", rows)
            world = np.array(made.matrix_world)
            parts.append(rows.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])
    return np.concatenate(parts)


def main() -> None:
    """Open each file, and go through the times."""
    out, clip, times, *files = sys.argv[1:]
    found = {}
    for number, file in enumerate(files):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.context.scene.render.fps = RATE
        bpy.ops.import_scene.gltf(filepath=file, disable_bone_shape=True)
        if clip:
            start(clip)
        for time in times.split(","):
            bpy.context.scene.frame_set(round(float(time) * RATE))
            found[f"{number}/{time}"] = shown()
    np.savez(out, **found)


main()
