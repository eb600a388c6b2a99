"""Blender: a first picture of a file, one sample a pixel by Cycles on the CPU, as a person sees it at once.

`peer_picture.py IN.glb OUT.png SIZE`
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bpy  # isort: skip -- the wheel makes the rest importable
from checks import pictures


def main() -> None:
    """Open the file, set the stage, render."""
    source, target, size = sys.argv[1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=source)
    pictures.SAMPLES = 1
    pictures.draw(Path(target), int(size))


if __name__ == "__main__":
    main()
