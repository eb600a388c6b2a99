"""Files of other makers, optimized: what is drawn and how it moves, held against the file that came in.

The compressed views are read by meshoptimizer's own decoder, all else by numpy. Every corner of every triangle must be
found within what the report says, in the scene at rest and, with skins, at times of every clip.
"""

from __future__ import annotations

import json
import math
import struct
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from checks import played
from checks.document import COMPONENTS, Document, joined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

HERE = Path(__file__).parent
PLAIN = HERE / "plain.mjs"
VALIDATOR = HERE.parents[1] / "scripts" / "checks" / "validator.mjs"
PROFILES = ["core", "quantized", "web", "bevy", "three"]
FILES = [
    "AnimatedMorphCube/AnimatedMorphCube.gltf",
    "AnimatedTriangle.gltf",
    "BoxInterleaved.glb",
    "BoxTexcoords/boxTexcoords.gltf",
    "CesiumMan.glb",
    "Fox.glb",
    "RiggedSimple.glb",
    "SimpleMorph/SimpleMorph.gltf",
    "SimpleSkin.gltf",
    "bevy_animations.gltf",
    "boolean.glb",
    "cubevc.glb",
    "monkey.glb",
    *(f"primitive_mode/Mesh_PrimitiveMode_{number:02}.gltf" for number in (0, 2, 4, 6, 8, 10, 12, 14)),
]
SINGLE = 2.0**-21
"""The share of a size that single precision may come to, of a few sums."""
BYTE = math.degrees(1 / 127)
"""By how much decoders of directions differ, degrees: one step of a byte."""


@dataclass(frozen=True)
class Optimized:
    """A file before and after."""

    before: Document
    after: Document
    shipped: dict[str, Any]
    """The JSON as it is shipped."""
    report: dict[str, Any]


def optimize(kiln: Kiln, source: Path, *options: str) -> Optimized:
    """Optimize a file that must be right."""
    done = kiln.run("optimize", str(source), "-o", "out.glb", "--report", "out.json", *options)
    assert done.returncode == 0, done.stderr
    out = kiln.folder / "out.glb"
    plain = kiln.folder / "plain.glb"
    subprocess.run(["node", str(PLAIN), str(out), str(plain)], check=True)
    report = json.loads((kiln.folder / "out.json").read_text(encoding="utf-8"))
    return Optimized(Document(source), Document(plain), Document(out).json, report)


def numbers(document: Document, index: int) -> NDArray[np.float64]:
    """An accessor as numbers, normalized ones divided."""
    own = document.json["accessors"][index]
    found = document.accessor(index).astype(float)
    if own.get("normalized"):
        found = np.maximum(found / np.iinfo(np.dtype(COMPONENTS[own["componentType"]])).max, -1.0)
    return found


def corners(document: Document, primitive: dict[str, Any]) -> NDArray[np.int64]:
    """The vertices of each triangle, or of each line or point, of any mode."""
    count = document.json["accessors"][primitive["attributes"]["POSITION"]]["count"]
    indices = document.accessor(primitive["indices"]).ravel().astype(int) if "indices" in primitive else range(count)
    all_ = np.asarray(indices)
    match primitive.get("mode", 4):
        case 0:
            return all_.reshape(-1, 1)
        case 1:
            return all_[: len(all_) // 2 * 2].reshape(-1, 2)
        case 2:
            return np.stack([all_, np.roll(all_, -1)], 1)
        case 3:
            return np.stack([all_[:-1], all_[1:]], 1)
        case 4:
            return all_[: len(all_) // 3 * 3].reshape(-1, 3)
        case 5:
            rows = [(k, k + 1 + k % 2, k + 2 - k % 2) for k in range(len(all_) - 2)]
            return all_[np.array(rows)]
        case _:
            return np.array([(all_[k + 1], all_[k + 2], all_[0]) for k in range(len(all_) - 2)])


@dataclass(frozen=True)
class Shown:
    """A primitive where a node shows it."""

    document: Document
    node: int
    shower: int
    """The node that holds the mesh: itself, or the one below it that carries it."""
    primitive: dict[str, Any]

    @cached_property
    def corners(self) -> NDArray[np.int64]:
        """What is drawn."""
        return corners(self.document, self.primitive)

    def attribute(self, name: str, target: int | None = None) -> NDArray[np.float64] | None:
        """Numbers of an attribute, or of what a target changes of it."""
        slots = self.primitive["attributes"] if target is None else self.primitive["targets"][target]
        return numbers(self.document, slots[name]) if name in slots else None

    def positions(self, worlds: list[NDArray[np.float64]], weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where the vertices stand in a pose."""
        places = self.attribute("POSITION")
        for target, weight in enumerate(weights[: len(self.primitive.get("targets", []))]):
            change = self.attribute("POSITION", target)
            places = places if change is None else places + weight * change
        node = self.document.json["nodes"][self.shower]
        points = np.concatenate([places, np.ones((len(places), 1))], 1)
        if "skin" not in node:
            return (points @ worlds[self.shower].T)[:, :3]
        skin = self.document.json["skins"][node["skin"]]
        count = len(skin["joints"])
        back = np.tile(np.eye(4), (count, 1, 1))
        if "inverseBindMatrices" in skin:
            back = numbers(self.document, skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)[:count]
        maps = np.array([worlds[joint] @ bind for joint, bind in zip(skin["joints"], back, strict=True)])
        joints, shares = self.attribute("JOINTS_0").astype(int), self.attribute("WEIGHTS_0")
        return np.einsum("vi,vijk,vk->vj", shares, maps[joints], points)[:, :3]


def shown(optimized: Optimized) -> list[tuple[Shown, Shown]]:
    """Each primitive that a node shows, before and after."""
    pairs = []
    before, after = optimized.before.json, optimized.after.json
    for index, node in enumerate(before.get("nodes", [])):
        if "mesh" not in node:
            continue
        shower = index if "mesh" in after["nodes"][index] else after["nodes"][index]["children"][-1]
        assert shower == index or shower >= len(before["nodes"]), "nodes keep their numbers"
        own = before["meshes"][node["mesh"]]["primitives"]
        found = after["meshes"][after["nodes"][shower]["mesh"]]["primitives"]
        assert len(own) == len(found)
        for one, other in zip(own, found, strict=True):
            assert set(one["attributes"]) == set(other["attributes"])
            assert len(one.get("targets", [])) == len(other.get("targets", []))
            pairs.append((Shown(optimized.before, index, index, one), Shown(optimized.after, index, shower, other)))
    return pairs


class Played(played.Stage):
    """A file that can be played with normalized keys and splines, too."""

    def sample(self, sampler: dict[str, Any], path: str, time: float) -> NDArray[np.float64]:
        """A sampler's value."""
        times = numbers(self.document, sampler["input"]).ravel()
        values = numbers(self.document, sampler["output"])
        spline = sampler.get("interpolation") == "CUBICSPLINE"
        rows = values.reshape(len(times), 3 if spline else 1, -1)
        key = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1))
        if time <= times[0] or key + 1 == len(times) or sampler.get("interpolation") == "STEP":
            return rows[key, 1 if spline else 0]
        span = times[key + 1] - times[key]
        t = (time - times[key]) / span
        if spline:
            (_, start, leaves), (arrives, end, _) = rows[key], rows[key + 1]
            value = (2 * t**3 - 3 * t**2 + 1) * start + (t**3 - 2 * t**2 + t) * span * leaves
            value = value + (3 * t**2 - 2 * t**3) * end + (t**3 - t**2) * span * arrives
            return value / np.linalg.norm(value) if path == "rotation" else value
        start, end = rows[key, 0], rows[key + 1, 0]
        if path != "rotation":
            return start + (end - start) * t
        start, end = start / np.linalg.norm(start), end / np.linalg.norm(end)
        dot = float(start @ end)
        end, dot = (-end, -dot) if dot < 0 else (end, dot)
        angle = math.acos(min(dot, 1.0))
        if angle < 1e-6:
            return start
        return (math.sin(angle * (1 - t)) * start + math.sin(angle * t) * end) / math.sin(angle)

    def posed(self, animation: dict[str, Any] | None, time: float) -> tuple[list[NDArray[np.float64]], dict[int, Any]]:
        """World matrices and weights of all nodes."""
        locals_ = [dict(node) for node in self.nodes]
        weights = {}
        for index, node in enumerate(self.nodes):
            mesh = self.document.json["meshes"][node["mesh"]] if "mesh" in node else {}
            count = len(mesh["primitives"][0].get("targets", [])) if mesh else 0
            weights[index] = np.array(node.get("weights", mesh.get("weights", [0.0] * count)), float)
        for channel in animation["channels"] if animation else []:
            value = self.sample(animation["samplers"][channel["sampler"]], channel["target"]["path"], time)
            if channel["target"]["path"] == "weights":
                weights[channel["target"]["node"]] = value
            else:
                locals_[channel["target"]["node"]][channel["target"]["path"]] = value.tolist()
        return [self.world(index, locals_) for index in range(len(self.nodes))], weights


def matched(one: Shown, other: Shown, errors: dict[str, float], places: tuple[Any, Any]) -> NDArray[np.int64]:
    """For each element after, its vertices and those of the element before that it is, in the same turn."""
    columns = [(places[0], places[1], errors["positions"])]
    for name, error in (("TEXCOORD_0", "uvs"), ("TEXCOORD_1", "uvs"), ("COLOR_0", "colors")):
        if name in one.primitive["attributes"]:
            columns.append((one.attribute(name), other.attribute(name), errors[error]))
    for name, error in (("NORMAL", "normals"), ("TANGENT", "tangents")):
        if name in one.primitive["attributes"]:
            chord = math.radians(errors[error] + (BYTE if errors[error] else 0.0))
            pair = [shown.attribute(name).copy() for shown in (one, other)]
            for rows in pair:
                length = np.linalg.norm(rows[:, :3], axis=1, keepdims=True)
                rows[:, :3] /= np.where(length > 0, length, 1)
            # What has no direction may be read as any.
            if (np.linalg.norm(pair[0][:, :3], axis=1) > 0.5).all():
                columns.append((pair[0], pair[1], chord))
    scaled = [
        np.concatenate(
            [column[which] / (column[2] + SINGLE * max(1.0, np.abs(column[0]).max())) for column in columns], 1
        )
        for which in (0, 1)
    ]
    before = one.corners
    width = before.shape[1]
    turns = 3 if width == 3 else 1
    elements = np.concatenate([np.roll(before, -turn, axis=1) for turn in range(turns)])
    tree = cKDTree(scaled[0][elements].reshape(len(elements), -1))
    after = other.corners
    distance, found = tree.query(scaled[1][after].reshape(len(after), -1), p=np.inf)
    assert distance.max() <= 1.001, f"something is drawn {distance.max():.3f} times the reported error off"
    # What went had two corners at one place, or stands there as another.
    back = cKDTree(scaled[1][after].reshape(len(after), -1))
    left, _ = back.query(scaled[0][elements].reshape(len(elements), -1), p=np.inf)
    missing = (left.reshape(turns, -1) > 1.001).all(0)
    sides = places[0][before]
    if width == 3:
        shortest = np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=2).min(1)
        allowed = 2 * errors["positions"] + SINGLE * np.abs(places[0]).max()
        assert (shortest[missing] <= allowed).all(), "a triangle is gone"
    else:
        assert not missing.any()
    return np.stack([after, elements[found]], 2).reshape(-1, 2)


def held(optimized: Optimized) -> None:
    """All that a person sees, at rest and at times of every clip."""
    errors = optimized.report["errors"]
    before, after = Played(optimized.before), Played(optimized.after)
    rest = before.posed(None, 0.0), after.posed(None, 0.0)
    pairs = []
    for one, other in shown(optimized):
        places = tuple(
            shown.positions(worlds, np.zeros_like(weights[shown.shower]))
            for shown, (worlds, weights) in zip((one, other), rest, strict=True)
        )
        shares = 4 * errors["weights"] * float(np.ptp(places[0], axis=0).max()) * 4
        loose = {**errors, "positions": errors["positions"] + shares}
        vertices = matched(one, other, loose, places)
        pairs.append((one, other, np.unique(vertices, axis=0)))
        for target in range(len(one.primitive.get("targets", []))):
            weights = np.eye(len(one.primitive["targets"]))[target]
            state = one.positions(rest[0][0], weights), other.positions(rest[1][0], weights)
            apart = np.abs(state[0][vertices[:, 1]] - state[1][vertices[:, 0]]).max()
            assert apart <= errors["positions"] * 1.001 + SINGLE * np.abs(state[0]).max()
    own, found = (document.json.get("animations", []) for document in (optimized.before, optimized.after))
    for one, other in zip(own, found, strict=True):
        times = np.unique(np.concatenate([numbers(optimized.before, s["input"]).ravel() for s in one["samplers"]]))
        asked = np.concatenate([times[:: max(1, len(times) // 5)], np.linspace(0, times[-1], 7)])
        for time in asked:
            moved(pairs, (before.posed(one, time), after.posed(other, time)), errors, depth=12)


def moved(pairs: list[Any], poses: tuple[Any, Any], errors: dict[str, float], depth: int) -> None:
    """Every vertex in a pose: joints of a chain add what each of them is off."""
    (worlds, weights), (other_worlds, other_weights) = poses
    for one, other, vertices in pairs:
        wanted = one.positions(worlds, weights[one.shower])[vertices[:, 1]]
        found = other.positions(other_worlds, other_weights[other.shower])[vertices[:, 0]]
        size = float(np.abs(wanted).max()) + float(np.ptp(wanted, axis=0).max())
        states = max(1.0, float(np.abs(weights[one.shower]).sum()))
        scale = max(np.linalg.norm(world[:3, :3], 2) for world in worlds)
        bound = errors["positions"] * states + 16 * errors["weights"] * size + SINGLE * size * depth
        chain = math.radians(errors["rotations"]) * size + errors["translations"] * scale + errors["scales"] * size
        bound += depth * chain + errors["morphs"] * size
        apart = np.linalg.norm(wanted - found, axis=1).max()
        assert apart <= bound, f"{apart} of {bound}"


def validated(folder: Path, *files: Path) -> list[set[str]]:
    """What the Khronos validator complains of: codes of errors and warnings."""
    out = folder / "validator.json"
    subprocess.run(["node", str(VALIDATOR), str(out), *map(str, files)], check=True)
    found = json.loads(out.read_text(encoding="utf-8"))
    assert all(one["error"] is None for one in found), found
    quiet = {"UNUSED_OBJECT", "UNSUPPORTED_EXTENSION", "URI_GLB", "NODE_EMPTY", "IO_ERROR", "UNUSED_MESH_TANGENT"}
    return [{line.split(" at ")[0] for line in one["totals"]["validator-messages"]} - quiet for one in found]


def alive(optimized: Optimized) -> None:
    """Names, extras and all that is not rewritten."""
    before, after = optimized.before.json, optimized.shipped
    for name in ("nodes", "skins", "animations", "cameras", "scenes"):
        for one, other in zip(before.get(name, []), after.get(name, []), strict=False):
            for key in ("name", "extras", "extensions", "translation", "rotation", "scale", "matrix", "camera"):
                assert one.get(key) == other.get(key), (name, key)
        assert len(after.get(name, [])) >= len(before.get(name, []))
    for name in ("meshes", "materials", "images"):
        told = [
            {(one.get("name"), json.dumps(one.get("extras"))) for one in each.get(name, [])} for each in (before, after)
        ]
        assert told[0] == told[1], name
    assert before.get("extras") == after.get("extras")


@pytest.mark.cases
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("name", FILES)
def test_samples_look_and_move_the_same(
    kiln: Kiln, cases: Path, name: str, profile: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every corner, every state, every clip; and the validator finds nothing that it did not find before."""
    source = cases / "gltf" / name
    made = optimize(kiln, source, "--profile", profile)
    held(made)
    alive(made)
    quantized = profile in ("quantized", "web", "three")
    assert ("KHR_mesh_quantization" in made.shipped.get("extensionsRequired", [])) <= quantized
    before, after = validated(kiln.folder, source, kiln.folder / "plain.glb")
    assert after <= before
    sizes = made.report["bytes"]
    with capsys.disabled():
        sys.stdout.write(f"\n{name}, {profile}: {sizes['before']} -> {sizes['after']} bytes\n")


@pytest.mark.cases
@pytest.mark.parametrize(
    ("name", "clip", "times"),
    [
        ("Fox.glb", "Run", "0,0.25,0.5"),
        ("CesiumMan.glb", "", "0"),
        ("BoxTexcoords/boxTexcoords.gltf", "", "0"),
        ("monkey.glb", "", "0"),
    ],
)
def test_blender_shows_the_same(kiln: Kiln, cases: Path, name: str, clip: str, times: str) -> None:
    """What its own importer makes of whole numbers, skins and packed keys, vertex by vertex."""
    source = cases / "gltf" / name
    made = optimize(kiln, source, "--profile", "web")
    out = kiln.folder / "played.npz"
    line = [sys.executable, str(HERE / "blender_played.py"), str(out), clip, times, str(source)]
    done = subprocess.run([*line, str(kiln.folder / "plain.glb")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    errors = made.report["errors"]
    found = np.load(out)
    for time in times.split(","):
        before, after = found[f"0/{time}"], found[f"1/{time}"]
        assert len(after) > 0
        size = float(np.ptp(before, axis=0).max())
        bound = errors["positions"] + 12 * math.radians(errors["rotations"]) * size + 16 * errors["weights"] * size
        bound += 12 * errors["translations"] + 1e-5 * size
        for one, other in ((before, after), (after, before)):
            assert cKDTree(one).query(other)[0].max() <= bound


@pytest.mark.cases
@pytest.mark.parametrize("name", ["CesiumMan.glb", "AnimatedMorphCube/AnimatedMorphCube.gltf", "monkey.glb"])
def test_what_is_packed_already_is_packed_again(kiln: Kiln, cases: Path, name: str) -> None:
    """From either version of the compression, and to none, without a further error of positions."""
    first = optimize(kiln, cases / "gltf" / name, "--profile", "web", "--codec", "1")
    assert "KHR_meshopt_compression" in first.shipped["extensionsRequired"]
    packed = kiln.folder / "packed.glb"
    (kiln.folder / "out.glb").rename(packed)
    plain = (kiln.folder / "plain.glb").rename(kiln.folder / "before.glb")
    for profile in ("web", "quantized", "core"):
        again = optimize(kiln, packed, "--profile", profile)
        assert again.report["errors"]["positions"] == 0.0
        assert ("extensionsRequired" in again.shipped) == (profile != "core")
        # Two decoders of directions differ by a step of a byte.
        again.report["errors"]["normals"] += 1e-9
        again.report["errors"]["tangents"] += 1e-9
        held(Optimized(Document(plain), again.after, again.shipped, again.report))


def test_a_finer_tolerance_is_met(kiln: Kiln) -> None:
    """On a mesh under scales and turns, whose positions are in other units."""
    path = kiln.folder / "scaled.glb"
    chance = np.random.default_rng(3)
    points = chance.uniform(-50, 90, (300, 3)).astype("<f4")
    triangles = chance.permutation(300).astype("<u2")
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 4200}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 3600, "target": 34962},
            {"buffer": 0, "byteOffset": 3600, "byteLength": 600, "target": 34963},
        ],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "type": "VEC3",
                "count": 300,
                "min": points.min(0).tolist(),
                "max": points.max(0).tolist(),
            },
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 300},
        ],
        "meshes": [{"name": "cloud", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [
            {"name": "near", "mesh": 0, "scale": [0.01, 0.01, 0.01], "rotation": [0.5, 0.5, 0.5, 0.5]},
            {"name": "far", "mesh": 0, "scale": [0.002, -0.03, 0.01], "translation": [3, 0, 0]},
        ],
        "scenes": [{"nodes": [0, 1]}],
    }
    path.write_bytes(joined(document, points.tobytes() + triangles.tobytes()))
    for tolerance in (1e-2, 1e-3, 2e-4):
        made = optimize(kiln, path, "--profile", "web", "--tolerance", str(tolerance))
        assert tolerance / 4 < made.report["errors"]["positions"] <= tolerance
        held(made)
    made = optimize(kiln, path, "--profile", "web", "--tolerance", "1e-6")
    assert made.report["errors"]["positions"] == 0.0
    assert made.report["notes"]


@pytest.mark.cases
def test_broken_files_are_refused(kiln: Kiln, cases: Path) -> None:
    """With a place in the JSON, exit code 1 and nothing written."""
    for name, words in (
        ("gltf/bad/IndexOutOfRange.gltf", "/meshes/0/primitives/0/indices: index 255"),
        ("gltf/bad/badArray.gltf", "/meshes/0/primitives: it is no list"),
        ("gltf/bad/BoxTextured.gltf", "/buffers/0/uri: "),
        ("gltf/bad/NoScene.gltf", "/scene: "),
        ("hostile/gltf/node_cycle.gltf", "/nodes/"),
        ("hostile/gltf/uri_traversal.gltf", "/buffers/0/uri: "),
        ("hostile/gltf/accessor_count_huge.gltf", "/accessors/"),
    ):
        done = kiln.run("optimize", str(cases / name), "-o", "out.glb")
        assert done.returncode == 1, (name, done.stdout, done.stderr)
        assert words in done.stderr, done.stderr
        assert list(kiln.folder.iterdir()) == []


@pytest.mark.cases
@pytest.mark.parametrize("name", ["Fox.glb", "AnimatedMorphCube/AnimatedMorphCube.gltf", "cubevc.glb"])
def test_damaged_files_end_well(kiln: Kiln, cases: Path, name: str) -> None:
    """Cut off anywhere, or with a bit turned: a file or a fault, never a crash or half a file."""
    source = optimize(kiln, cases / "gltf" / name, "--profile", "web")
    assert source.report["bytes"]["after"] > 0
    whole = (kiln.folder / "out.glb").read_bytes()
    (kiln.folder / "out.glb").unlink()
    length = struct.unpack_from("<I", whole, 12)[0]
    chance = np.random.default_rng(11)
    damaged = [whole[:at] for at in chance.integers(0, len(whole), 8)]
    # Half of the bits stand in the JSON, where they say the most.
    for at in [*chance.integers(0, 20 + length, 30), *chance.integers(20 + length, len(whole), 15)]:
        changed = bytearray(whole)
        changed[at] ^= 1 << int(chance.integers(0, 8))
        damaged.append(bytes(changed))
    for one in damaged:
        (kiln.folder / "damaged.glb").write_bytes(one)
        done = kiln.run("optimize", "damaged.glb", "-o", "again.glb", "--profile", "core")
        assert done.returncode in (0, 1), done.stderr
        assert "panicked" not in done.stderr
        assert (kiln.folder / "again.glb").exists() == (done.returncode == 0)
        (kiln.folder / "again.glb").unlink(missing_ok=True)
