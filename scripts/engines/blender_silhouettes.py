"""Silhouettes by Blender's Cycles, many files by one process: `blender_silhouettes.py ASKED.json FOUND.json`.

ASKED: `{"size", "view": [AZIMUTH, ELEVATION], "files": [{"path", "hidden": [MESH], "out": PICTURE.npy}]}`. FOUND: for
each file its camera, in the axes of the file: `right`, `up`, `back`, `middle`, `extent`, `depth`.

The camera is parallel and holds the projections of all vertices with six percent of the picture free on each side,
as the preview's does; a picture is the opacity of its pixels. Materials are set aside: what is asked is where things
are.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy  # isort: skip -- the wheel makes mathutils importable
import numpy as np
from mathutils import Matrix, Vector

from checks.blender import open_still

FREE = 0.06


def main() -> None:
    """Draw the silhouettes that are asked for."""
    asked = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    cameras = [draw(file, asked["size"], asked["view"]) for file in asked["files"]]
    Path(sys.argv[2]).write_text(json.dumps(cameras), encoding="utf-8")


def draw(file: dict[str, Any], size: int, view: list[float]) -> dict[str, Any]:
    """One file: its picture to its place, its camera as the result."""
    open_still(Path(file["path"]))
    bpy.context.view_layer.update()
    for item in bpy.context.scene.objects:
        item.hide_render = item.type == "MESH" and item.data.name in file["hidden"]
    camera = camera_of(*view)
    look(size)
    with tempfile.TemporaryDirectory() as folder:
        bpy.context.scene.render.filepath = str(Path(folder) / "picture.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(bpy.context.scene.render.filepath)
        pixels = np.array(picture.pixels[:], dtype=np.float32).reshape(size, size, 4)
    np.save(file["out"], pixels[::-1, :, 3])
    return camera


def camera_of(azimuth: float, elevation: float) -> dict[str, Any]:
    """Puts the camera into the scene; where it stands."""
    turn, raised = math.radians(azimuth), math.radians(elevation)
    # Blender's z is up: the glTF axes (x, y, z) are (x, z, -y) here, so the front is -y.
    back = Vector((math.sin(turn) * math.cos(raised), -math.cos(turn) * math.cos(raised), math.sin(raised)))
    right = Vector((math.cos(turn), math.sin(turn), 0.0))
    up = back.cross(right)
    graph = bpy.context.evaluated_depsgraph_get()
    axes = np.array([right, up, back])
    spans = [axes @ points.T for points in shown(graph)]
    low, high = (np.min([span.min(axis=1) for span in spans], axis=0), np.max([s.max(axis=1) for s in spans], axis=0))
    middle, wide, tall, depth = Vector((low + high) / 2 @ axes), *(high - low)
    extent = float(max(wide, tall))
    data = bpy.data.cameras.new("camera")
    data.type = "ORTHO"
    data.ortho_scale = extent / (1.0 - 2.0 * FREE)
    data.clip_start, data.clip_end = 1e-4 * (extent + depth), 10.0 * (extent + depth)
    item = bpy.data.objects.new("camera", data)
    place = middle + back * (extent + depth)
    item.matrix_world = Matrix.Translation(place) @ Matrix((right, up, back)).transposed().to_4x4()
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item

    def in_file(vector: Vector) -> list[float]:
        return [vector.x, vector.z, -vector.y]

    directions = {"right": in_file(right), "up": in_file(up), "back": in_file(back)}
    return {**directions, "middle": in_file(middle), "extent": extent, "depth": float(depth)}


def shown(graph: bpy.types.Depsgraph) -> list[np.ndarray]:
    """The vertices of each mesh that is drawn, where joints and weights bring them."""
    found = []
    for item in bpy.context.scene.objects:
        if item.type != "MESH" or item.hide_render:
            continue
        own = item.evaluated_get(graph)
        places = np.empty(3 * len(own.data.vertices))
        own.data.vertices.foreach_get("co", places)
        matrix = np.array(own.matrix_world)
        found.append(places.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
    return [points for points in found if len(points)]


def look(size: int) -> None:
    """How the scene is drawn."""
    scene = bpy.context.scene
    scene.view_layers[0].material_override = bpy.data.materials.new("plain")
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 16
    scene.cycles.max_bounces = 0
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = size


if __name__ == "__main__":
    main()
