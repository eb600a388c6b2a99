"""Silhouettes by Blender's Cycles: `blender_silhouette.py FILE.glb SIZE AZIMUTH ELEVATION OUT.npy`.

The camera is parallel and holds the projections of all vertices with six percent of the picture free on each side,
as the preview's does; the picture is what covers a pixel at all, by its opacity.
"""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

import bpy  # isort: skip -- the wheel makes mathutils importable
import numpy as np
from mathutils import Matrix, Vector

from checks.blender import open_file

FREE = 0.06


def main() -> None:
    """Draw the silhouette of a file."""
    file, size, azimuth, elevation, out = sys.argv[1:]
    open_file(Path(file))
    bpy.context.view_layer.update()
    turn, raised = math.radians(float(azimuth)), math.radians(float(elevation))
    # Blender's z is up: the glTF axes (x, y, z) are (x, z, -y) here, so the front is -y.
    back = Vector((math.sin(turn) * math.cos(raised), -math.cos(turn) * math.cos(raised), math.sin(raised)))
    right = Vector((math.cos(turn), math.sin(turn), 0.0))
    up = back.cross(right)
    points = [
        item.matrix_world @ v.co
        for item in bpy.context.scene.objects
        if item.type == "MESH"
        for v in item.data.vertices
    ]
    spans = [[point.dot(axis) for point in points] for axis in (right, up, back)]
    middle = [(min(span) + max(span)) / 2 for span in spans]
    extent = max(max(span) - min(span) for span in spans[:2])
    depth = max(spans[2]) - min(spans[2])
    data = bpy.data.cameras.new("camera")
    data.type = "ORTHO"
    data.ortho_scale = extent / (1.0 - 2.0 * FREE)
    data.clip_start, data.clip_end = 1e-4 * (extent + depth), 10.0 * (extent + depth)
    item = bpy.data.objects.new("camera", data)
    place = right * middle[0] + up * middle[1] + back * (max(spans[2]) + extent + depth)
    item.matrix_world = Matrix.Translation(place) @ Matrix((right, up, back)).transposed().to_4x4()
    bpy.context.scene.collection.objects.link(item)
    scene = bpy.context.scene
    scene.camera = item
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 16
    scene.cycles.use_denoising = False
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = int(size)
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.png")
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        pixels = np.array(picture.pixels[:], dtype=np.float32).reshape(int(size), int(size), 4)
    np.save(out, pixels[::-1, :, 3])


if __name__ == "__main__":
    main()
