"""Changes of materials, lights and cameras: read from the bytes by struct alone, held against closed forms."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

SPEC = """
[shape.a]
material = "m"
[shape.a.box]
size = [1, 1, 1]
[node.a]
shape = "a"
[node.dark.light]
[node.lamp.light]
[node.eye.camera]
[node.plan.camera]
height = 3
aspect = 1.5
[material.m]
color = "#336699"
[clip.c]
duration = 4
"""


def track(**fields: str) -> str:
    """A track of clip `c`."""
    return "[[clip.c.track]]\n" + "".join(f"{name} = {value}\n" for name, value in fields.items())


def channels(path: Path) -> dict[str, tuple[str, np.ndarray, np.ndarray]]:
    """For each JSON pointer of a .glb how it goes from key to key, its times and its rows of values."""
    data = path.read_bytes()
    document, binary = document_of(path), data[28 + struct.unpack_from("<I", data, 12)[0] :]
    assert "KHR_animation_pointer" in document["extensionsUsed"]
    assert "KHR_animation_pointer" not in document.get("extensionsRequired", [])

    def numbers(index: int) -> np.ndarray:
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, "<f4", accessor["count"] * width, start).reshape(-1, width).astype(float)

    found = {}
    (animation,) = document["animations"]
    for channel in animation["channels"]:
        if channel["target"]["path"] != "pointer":
            continue
        assert "node" not in channel["target"]
        pointer = channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"]
        sampler = animation["samplers"][channel["sampler"]]
        way = sampler.get("interpolation", "LINEAR")
        found[pointer] = (way, numbers(sampler["input"]).ravel(), numbers(sampler["output"]))
    return found


def document_of(path: Path) -> dict[str, Any]:
    """The JSON of a .glb."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length])


def at(channel: tuple[str, np.ndarray, np.ndarray], times: np.ndarray) -> np.ndarray:
    """The values at some times, straight from key to key."""
    way, keys, values = channel
    assert way == "LINEAR"
    return np.stack([np.interp(times, keys, column) for column in values.T], axis=1)


def screen(light: np.ndarray) -> np.ndarray:
    """Linear light as a screen shows it (IEC 61966-2-1)."""
    light = np.clip(light, 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


TIMES = np.linspace(0.0, 4.0, 481)


def test_a_color_runs_along_a_circle_at_constant_speed(kiln: Kiln) -> None:
    """Each key of the circle through colors is where its arc length says, and what is between is within half a step."""
    circle = "{ circle = { radius = 0.35, center = [0.5, 0.5] } }"
    baked = kiln.bake(SPEC + track(material='"m"', path='"emissive"', along=circle))
    found = at(channels(baked.path)["/materials/0/emissiveFactor"], TIMES)
    angle = 2.0 * np.pi * TIMES / 4.0
    wanted = np.stack([0.5 + 0.35 * np.cos(angle), 0.5 + 0.35 * np.sin(angle), 0.0 * angle], axis=1)
    assert np.abs(screen(found) - screen(wanted)).max() <= 1.02 * 0.5 / 255
    facts = baked.report["clips"]["c"]["properties"]["/materials/0/emissiveFactor"]
    assert facts["bound"] <= facts["tolerance"] == pytest.approx(0.5 / 255)
    # A circle in so many chords: the fewest by the error of chords, with room for the unevenness of screens.
    assert facts["keys"] < 60


def test_opacity_keeps_the_color_and_a_color_the_opacity(kiln: Kiln) -> None:
    """The color of a material is one property of four numbers in the file."""
    baked = kiln.bake(SPEC + track(material='"m"', path='"alpha"', formula='"= 1 - t / 8"'))
    found = at(channels(baked.path)["/materials/0/pbrMetallicRoughness/baseColorFactor"], TIMES)
    rest = np.array([int(part, 16) / 255 for part in ("33", "66", "99")])
    rest = np.where(rest <= 0.04045, rest / 12.92, ((rest + 0.055) / 1.055) ** 2.4)
    assert np.abs(found[:, :3] - rest).max() < 1e-6
    assert np.abs(found[:, 3] - (1.0 - TIMES / 8.0)).max() < 1e-6
    assert len(channels(baked.path)["/materials/0/pbrMetallicRoughness/baseColorFactor"][1]) == 2


def test_lights_and_cameras_change(kiln: Kiln) -> None:
    """Lights are counted among lights, cameras among cameras; angles become radians, heights halves."""
    baked = kiln.bake(
        SPEC
        + track(node='"lamp"', path='"intensity"', formula='"= 3 + 2 * sin(90 * t)"')
        + track(node='"eye"', path='"field-of-view"', formula='"= 40 + 5 * t"')
        + track(node='"plan"', path='"height"', formula='"= 3 - t / 4"')
    )
    found = channels(baked.path)
    intensity = at(found["/extensions/KHR_lights_punctual/lights/1/intensity"], TIMES)[:, 0]
    assert np.abs(intensity - (3.0 + 2.0 * np.sin(np.pi / 2 * TIMES))).max() <= 1.02 * 5.0 / 1000
    assert np.abs(at(found["/cameras/0/perspective/yfov"], TIMES)[:, 0] - np.radians(40.0 + 5.0 * TIMES)).max() < 1e-6
    assert np.abs(at(found["/cameras/1/orthographic/ymag"], TIMES)[:, 0] - (3.0 - TIMES / 4.0) / 2.0).max() < 1e-6
    assert np.abs(at(found["/cameras/1/orthographic/xmag"], TIMES)[:, 0] - (3.0 - TIMES / 4.0) * 0.75).max() < 1e-6
    assert set(found) == set(baked.report["clips"]["c"]["properties"])


def test_steps_stay_steps(kiln: Kiln) -> None:
    """Keys that step are written as they are, without those that change nothing."""
    keys = "[{ at = 0, value = 0.2 }, { at = 1, value = 0.2 }, { at = 2.5, value = 0.9 }]"
    baked = kiln.bake(SPEC + track(material='"m"', path='"metallic"', between='"step"', keys=keys))
    way, times, values = channels(baked.path)["/materials/0/pbrMetallicRoughness/metallicFactor"]
    assert way == "STEP"
    assert times.tolist()[:2] == [0.0, 2.5]
    assert values[:2, 0] == pytest.approx([0.2, 0.9])
    # The clip lasts as long as it says.
    assert times[-1] == 4.0


def test_the_profile_of_bevy_has_none_and_says_so(kiln: Kiln) -> None:
    """What the gltf crate cannot parse is left out, with a warning, and the rest of the clip stays."""
    spec = (
        SPEC
        + track(material='"m"', path='"roughness"', formula='"= 1 - t / 8"')
        + track(node='"a"', path='"scale"', formula='"= 1 + t"')
    )
    kiln.write(spec)
    done = kiln.run("bake", "model.toml", "--out", "out", "--profile", "bevy")
    assert "K1072" in done.stderr
    document = document_of(next((kiln.folder / "out").glob("*.glb")))
    assert "KHR_animation_pointer" not in document.get("extensionsUsed", [])
    assert [channel["target"]["path"] for channel in document["animations"][0]["channels"]] == ["scale"]


def test_optimize_keeps_what_changes_and_leaves_it_out_for_bevy(kiln: Kiln) -> None:
    """The same keys in the same order, to the bit; nothing of them for a loader that refuses them."""
    circle = "{ circle = { radius = 0.35, center = [0.5, 0.5] } }"
    spec = SPEC + track(material='"m"', path='"emissive"', along=circle)
    baked = kiln.bake(spec + track(node='"a"', path='"scale"', formula='"= 1 + t"'))
    before = channels(baked.path)
    done = kiln.run("optimize", "out/model.glb", "-o", "small.glb")
    assert done.returncode == 0, done.stderr
    after = channels(kiln.folder / "small.glb")
    assert {name: [part.tolist() for part in one[1:]] for name, one in before.items()} == {
        name: [part.tolist() for part in one[1:]] for name, one in after.items()
    }
    done = kiln.run("optimize", "out/model.glb", "-o", "bevy.glb", "--profile", "bevy")
    assert done.returncode == 0, done.stderr
    document = document_of(kiln.folder / "bevy.glb")
    assert "KHR_animation_pointer" not in document.get("extensionsUsed", [])
    (animation,) = document["animations"]
    assert [channel["target"]["path"] for channel in animation["channels"]] == ["scale"]
    assert len(animation["samplers"]) == 1


def test_a_moment_of_a_clip_is_drawn_in_its_colors(kiln: Kiln) -> None:
    """A glowing red at the start and blue at the end, against any light."""
    keys = '[{ at = 0, value = "#ff0000" }, { at = 4, value = "#0000ff" }]'
    kiln.bake(SPEC + track(material='"m"', path='"emissive"', keys=keys))
    for time, most in (("0", 0), ("4", 2)):
        done = kiln.run("render", "model.toml", "--clip", "c", "--time", time, "--size", "64x64", "-o", "seen.png")
        assert done.returncode == 0, done.stderr
        pixel = np.asarray(Image.open(kiln.folder / "seen.png").convert("RGB"))[32, 32]
        assert int(np.argmax(pixel)) == most, pixel
