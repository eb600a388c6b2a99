"""Pictures beside the file: written, checked, restored and read by every tool as what stands within it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image

if TYPE_CHECKING:
    from kiln import Kiln

VERIFY = Path(__file__).parents[2] / "scripts" / "verify.py"
SPEC = """
[shape.a]
material = "m"
[shape.a.box]
size = [1, 1, 1]
[material.m]
color-texture = "stripes.png"
normal-texture = "bumps.png"
[output.textures]
beside = true
"""
BLENDER = """
import json, sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
found = {image.name: [*image.size, *[round(255 * part) for part in image.pixels[:3]]] for image in bpy.data.images}
print("told " + json.dumps(found))
"""


def pictures(kiln: Kiln) -> None:
    """Two pictures of one color each."""
    Image.new("RGB", (8, 4), (200, 40, 10)).save(kiln.folder / "stripes.png")
    Image.new("RGB", (4, 4), (128, 128, 255)).save(kiln.folder / "bumps.png")


def test_every_tool_finds_them(kiln: Kiln) -> None:
    pictures(kiln)
    baked = kiln.bake(SPEC, "--profile", "core,quantized,web")
    out = kiln.folder / "out"
    assert sorted(file.name for file in out.glob("*.png")) == sorted(
        f"model{end}.{name}.png" for end in ("", ".quantized", ".web") for name in ("bumps", "stripes")
    )
    assert (out / "model.stripes.png").read_bytes() == (kiln.folder / "stripes.png").read_bytes()
    assert [image["uri"] for image in baked.document.json["images"]] == ["model.stripes.png", "model.bumps.png"]
    done = subprocess.run([sys.executable, str(VERIFY), str(out)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-2000:]
    program = kiln.folder / "seen.py"
    program.write_text(BLENDER)
    done = subprocess.run([sys.executable, program, baked.path], capture_output=True, text=True, check=True)
    found = json.loads(next(line for line in done.stdout.splitlines() if line.startswith("told "))[5:])
    assert [8, 4, 200, 40, 10] in found.values(), found


def test_they_are_outputs_like_others(kiln: Kiln) -> None:
    """What is gone or changed is told by --check and made again, from a cache too; a depfile names them."""
    pictures(kiln)
    kiln.bake(SPEC, "--depfile", "made.d", "--cache", "cache")
    picture = kiln.folder / "out" / "model.stripes.png"
    assert "out/model.stripes.png" in (kiln.folder / "made.d").read_text().split(":")[0]
    bake = ("bake", "model.toml", "--out", "out")
    assert kiln.run(*bake, "--check").returncode == 0
    whole = picture.read_bytes()
    for cache in ((), ("--cache", "cache")):
        picture.write_bytes(b"other")
        done = kiln.run(*bake, "--check", *cache)
        assert done.returncode != 0
        assert "model.stripes.png is not what is baked" in done.stderr
        picture.unlink()
        assert kiln.run(*bake, "--check", *cache).returncode != 0
        assert kiln.run(*bake, *cache).returncode == 0
        assert picture.read_bytes() == whole
    # A picture of the document is drawn all the same where one file is looked at alone.
    done = kiln.run("render", "model.toml", "--size", "64x64", "-o", "seen.png")
    assert done.returncode == 0, done.stderr
    red, green, blue = Image.open(kiln.folder / "seen.png").convert("RGB").getpixel((32, 32))
    assert red > 2 * green > 2 * blue, (red, green, blue)


def test_optimize_takes_them_into_its_file(kiln: Kiln) -> None:
    pictures(kiln)
    kiln.bake(SPEC)
    done = kiln.run("optimize", "out/model.glb", "-o", "small.glb")
    assert done.returncode == 0, done.stderr
    data = (kiln.folder / "small.glb").read_bytes()
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert all("uri" not in image for image in document["images"])
    assert (kiln.folder / "stripes.png").read_bytes() in data
