"""Pictures of written files by Blender's Cycles on the CPU: `python -m checks.pictures FOLDER SIZE FILE...`.

Each file is shown on a plain ground in soft light, from the front, a little above; the picture is
`FOLDER/STEM.png`, SIZE pixels wide.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy  # isort: skip -- the wheel makes mathutils importable
from mathutils import Vector

from checks.blender import open_file

SAMPLES = 16  # the denoiser does the rest
LENS = 60.0  # millimeters; a mild telephoto
VIEW = Vector((0.62, -1.0, 0.52))  # from the model to the camera


def main() -> None:
    """Draw each file named on the command line."""
    folder, size, *files = sys.argv[1:]
    Path(folder).mkdir(parents=True, exist_ok=True)
    for file in map(Path, files):
        open_file(file)
        draw(Path(folder) / f"{file.stem}.png", int(size))


def draw(target: Path, size: int) -> None:
    """Set the stage around what is in the scene and render it."""
    low, high = bounds()
    center, radius = (low + high) / 2, max((high - low).length / 2, 1e-6)
    ground(center, low.z, radius)
    sky()
    light(center + radius * Vector((-3.0, -2.5, 4.0)), center, radius, 420.0)
    light(center + radius * Vector((3.5, 0.5, 2.0)), center, radius, 110.0)
    camera(center, radius)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = True
    scene.render.resolution_x, scene.render.resolution_y = size, size * 3 // 4
    scene.view_settings.view_transform = "AgX"
    scene.render.filepath = str(target)
    bpy.ops.render.render(write_still=True)


def bounds() -> tuple[Vector, Vector]:
    """The box of everything shown."""
    bpy.context.view_layer.update()
    shown = [item for item in bpy.context.scene.objects if item.type == "MESH"]
    points = [item.matrix_world @ Vector(corner) for item in shown for corner in item.bound_box]
    axes = list(zip(*points, strict=True))
    return Vector(map(min, axes)), Vector(map(max, axes))


def ground(center: Vector, height: float, radius: float) -> None:
    """A wide matte floor just below the model."""
    place = (center.x, center.y, height - 1e-4 * radius)
    bpy.ops.mesh.primitive_plane_add(size=200 * radius, location=place)
    material = bpy.data.materials.new("ground")
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"].inputs
    surface["Base Color"].default_value = (0.42, 0.44, 0.46, 1.0)
    surface["Roughness"].default_value = 0.9
    bpy.context.object.data.materials.append(material)


def sky() -> None:
    """An even gray surrounding."""
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.75, 0.82, 0.9, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.55
    bpy.context.scene.world = world


def light(place: Vector, aim: Vector, radius: float, strength: float) -> None:
    """A square lamp at `place` turned to `aim`; its power grows with the square of the model's size."""
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.energy = strength * radius * radius
    lamp.size = 2.0 * radius
    item = bpy.data.objects.new("lamp", lamp)
    item.location = place
    item.rotation_euler = (aim - place).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)


def camera(center: Vector, radius: float) -> None:
    """A camera that just holds the model's ball."""
    data = bpy.data.cameras.new("camera")
    data.lens = LENS
    data.clip_start, data.clip_end = 0.01 * radius, 1000.0 * radius
    upright = 2.0 * math.atan(data.sensor_width * 3 / 4 / 2 / LENS)
    item = bpy.data.objects.new("camera", data)
    item.location = center + VIEW.normalized() * (radius / math.sin(upright / 2))
    item.rotation_euler = (center - item.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item


if __name__ == "__main__":
    main()
