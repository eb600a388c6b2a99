"""What light does at surfaces beyond color and roughness, as three.js and Blender read it from the written files."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from kiln import Kiln

LOOKS = Path(__file__).with_name("looks.mjs")
# One body for each material, in centimetres.
MATERIALS = """
[material.coat]
clearcoat = { factor = 0.75, roughness = 0.25 }
[material.glass]
ior = 1.52
dispersion = 0.31
transmission = { factor = 0.9 }
volume = { thickness = 5, attenuation-distance = 6, attenuation-color = [1, 0.5, 0.25] }
[material.velvet]
sheen = { color = [0.5, 0.25, 0.125], roughness = 0.375 }
specular = { factor = 0.5, color = [1, 0.75, 0.5] }
[material.film]
iridescence = { factor = 0.5, ior = 1.25, thickness = 480 }
[material.brass]
metallic = 1
anisotropy = { strength = 0.75, rotation = 90 }
[material.light]
emissive = [1, 0.5, 0]
emissive-strength = 4
[material.ink]
color = [0.25, 0.5, 0.75]
unlit = true
"""
NAMES = ("coat", "glass", "velvet", "film", "brass", "light", "ink")
SPEC = (
    'unit = "cm"\ntolerance = 0.05\n'
    + "".join(
        f'[shape.{name}]\nmaterial = "{name}"\nat = [{20 * number}, 0, 0]\n[shape.{name}.sphere]\nradius = 4\n'
        for number, name in enumerate(NAMES)
    )
    + MATERIALS
)
BLENDER = """
import json, sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
told = {}
for material in bpy.data.materials:
    own = told[material.name] = {"nodes": sorted({node.type for node in material.node_tree.nodes})}
    for node in material.node_tree.nodes:
        kept = {"BSDF_PRINCIPLED": "", "VOLUME_ABSORPTION": "Volume "}.get(node.type)
        for socket in node.inputs if kept is not None else ():
            if hasattr(socket, "default_value"):
                value = socket.default_value
                own[kept + socket.name] = list(value) if hasattr(value, "__len__") else value
print("told " + json.dumps(told))
"""


def three(path: Path) -> dict[str, dict[str, Any]]:
    """The materials that three.js makes, by their names."""
    return json.loads(subprocess.run(["node", LOOKS, path], capture_output=True, text=True, check=True).stdout)


def near(*wanted: float) -> Any:
    """Numbers to within the rounding of single precision."""
    return pytest.approx(wanted if len(wanted) > 1 else wanted[0], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("profile", ["core", "quantized", "web"])
def test_three_draws_what_is_written(kiln: Kiln, profile: str) -> None:
    """Each number by its name there; a thickness, which it multiplies by the scale of the node, is one of the scene."""
    kiln.write(SPEC)
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", profile)
    assert done.returncode == 0, done.stderr
    (path,) = (kiln.folder / "out").glob("*.glb")
    found = three(path)
    assert set(found) == set(NAMES)
    assert {look["type"] for name, look in found.items() if name not in ("light", "ink")} == {"MeshPhysicalMaterial"}
    coat, glass, velvet, film, brass, light, ink = (found[name] for name in NAMES)
    assert (coat["clearcoat"], coat["clearcoatRoughness"]) == near(0.75, 0.25)
    assert (glass["ior"], glass["dispersion"], glass["transmission"]) == near(1.52, 0.31, 0.9)
    assert glass["thickness"] * glass["scale"] == pytest.approx(0.05, rel=1e-5)
    assert glass["attenuationDistance"] == near(0.06)
    assert glass["attenuationColor"] == near(1, 0.5, 0.25)
    assert (velvet["sheen"], velvet["sheenRoughness"], velvet["specularIntensity"]) == near(1, 0.375, 0.5)
    assert velvet["sheenColor"] == near(0.5, 0.25, 0.125)
    assert velvet["specularColor"] == near(1, 0.75, 0.5)
    assert (film["iridescence"], film["iridescenceIOR"]) == near(0.5, 1.25)
    assert film["iridescenceThicknessMaximum"] == near(480)
    assert (brass["anisotropy"], brass["anisotropyRotation"]) == near(0.75, 1.5707963267948966)
    assert {name for name, look in found.items() if look["tangents"]} == {"brass"}
    assert light["emissiveIntensity"] == near(4)
    assert light["emissive"] == near(1, 0.5, 0)
    assert ink["type"] == "MeshBasicMaterial"
    assert ink["color"] == near(0.25, 0.5, 0.75)


def test_blender_reads_what_its_shader_has(kiln: Kiln) -> None:
    """The sockets of its principled shader and its volume; a warning says that it reads no films and no dispersion."""
    kiln.write(SPEC)
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", "blender")
    assert done.returncode == 0, done.stderr
    assert "K1016" in done.stderr
    assert "no `dispersion`, `iridescence`" in done.stderr
    program = kiln.folder / "looks.py"
    program.write_text(BLENDER)
    (path,) = (kiln.folder / "out").glob("*.glb")
    done = subprocess.run([sys.executable, program, path], capture_output=True, text=True, check=True)
    found = json.loads(next(line for line in done.stdout.splitlines() if line.startswith("told "))[5:])
    coat, glass, velvet, _, brass, light, ink = (found[name] for name in NAMES)
    assert (coat["Coat Weight"], coat["Coat Roughness"]) == near(0.75, 0.25)
    assert (glass["IOR"], glass["Transmission Weight"]) == near(1.52, 0.9)
    assert glass["Volume Density"] == pytest.approx(1 / 0.06, rel=1e-5)
    assert glass["Volume Color"][:3] == near(1, 0.5, 0.25)
    assert (velvet["Sheen Weight"], velvet["Sheen Roughness"]) == near(1, 0.375)
    assert velvet["Sheen Tint"][:3] == near(0.5, 0.25, 0.125)
    # Its level is one half where the format's factor is 1.
    assert velvet["Specular IOR Level"] == near(0.25)
    assert velvet["Specular Tint"][:3] == near(1, 0.75, 0.5)
    # It counts turns, and from the other way.
    assert brass["Anisotropic"] == near(0.75)
    assert brass["Anisotropic Rotation"] == near(0.25)
    assert light["Emission Strength"] == near(4)
    assert light["Emission Color"][:3] == near(1, 0.5, 0)
    assert "BSDF_PRINCIPLED" not in ink["nodes"]


def test_optimize_keeps_them(kiln: Kiln) -> None:
    """The same numbers in three.js from a file made small, which on a grid has other units for a thickness."""
    kiln.bake(SPEC)

    def looks(path: Path) -> dict[str, dict[str, Any]]:
        found = three(path)
        for look in found.values():
            scale = look.pop("scale")
            if "thickness" in look:
                look["thickness"] *= scale
        return found

    before = looks(kiln.folder / "out" / "model.glb")
    for profile in ("core", "web"):
        done = kiln.run("optimize", "out/model.glb", "-o", "small.glb", "--profile", profile)
        assert done.returncode == 0, done.stderr
        after = looks(kiln.folder / "small.glb")
        assert set(after) == set(before)
        for name, look in before.items():
            type_of = look.pop("type")
            assert after[name].pop("type") == type_of
            assert after[name] == {key: pytest.approx(value, rel=1e-5) for key, value in look.items()}, name
            look["type"] = type_of


def test_a_preview_shows_unlit_and_strong_light(kiln: Kiln) -> None:
    """An unlit surface has its color on the screen; a light four times as strong is no darker, and dim ones are."""

    def middle(material: str) -> np.ndarray:
        kiln.write(f'[shape.a]\nmaterial = "m"\n[shape.a.sphere]\nradius = 1\n[material.m]\n{material}\n')
        done = kiln.run("render", "model.toml", "--size", "64x64", "-o", "seen.png")
        assert done.returncode == 0, done.stderr
        return np.asarray(Image.open(kiln.folder / "seen.png").convert("RGB"))[32, 32].astype(int)

    assert middle('color = "#336699"\nunlit = true').tolist() == [0x33, 0x66, 0x99]
    levels = [middle(f'color = "#000000"\nemissive = "#404040"\nemissive-strength = {k}')[0] for k in (0, 1, 4)]
    assert levels[0] < levels[1] < levels[2], levels
