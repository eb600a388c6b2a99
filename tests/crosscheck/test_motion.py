"""Motion held against scipy's rotations, closed forms and published values; files are played by numpy alone."""

from __future__ import annotations

import gzip
import json
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from checks import played

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Baked, Kiln

BOX = '[node.n]\nshape = "b"\n[shape.b.box]\nsize = [1, 1, 1]\n'


def keys(times: list[float], values: list[Any]) -> str:
    """Keys as a document has them."""
    return "keys = [" + ", ".join(f"{{ at = {t}, value = {v} }}" for t, v in zip(times, values, strict=True)) + "]\n"


def played_at(baked: Baked, clip: str, node: str, times: list[float]) -> list[np.ndarray]:
    """World matrices of a node."""
    stage = played.Stage(baked.document)
    animation = next(one for one in baked.document.json["animations"] if one["name"] == clip)
    poses = [stage.pose(animation, {"time": t, "nodes": [node], "vertices": {}}) for t in times]
    return [np.array(pose["nodes"][node]).reshape(4, 4).T for pose in poses]


@pytest.mark.parametrize("order", ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx"])
def test_orders_of_angles_are_those_of_scipy(kiln: Kiln, order: str) -> None:
    """Lower-case orders of scipy are about fixed axes, as ours are."""
    angles = {"x": 20.0, "y": -35.0, "z": 50.0}
    values = [[0, 0, 0], [angles["x"], angles["y"], angles["z"]]]
    track = f'[[clip.c.track]]\nnode = "n"\npath = "rotation"\norder = "{order}"\n{keys([0, 1], values)}'
    baked = kiln.bake(BOX + track)
    (found,) = played_at(baked, "c", "n", [1.0])
    wanted = Rotation.from_euler(order, [angles[axis] for axis in order], degrees=True).as_matrix()
    assert np.abs(found[:3, :3] - wanted).max() < 1e-6
    (half,) = played_at(baked, "c", "n", [0.5])
    wanted = Rotation.from_euler(order, [angles[axis] / 2 for axis in order], degrees=True).as_matrix()
    assert np.abs(half[:3, :3] - wanted).max() < 4 * baked.report["clips"]["c"]["tolerance"]


def test_joints_turn_about_x_then_z_then_y(kiln: Kiln) -> None:
    """The order of limits: intrinsic x, z, y, which scipy writes in capitals."""
    spec = "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n"
    track = f'[[clip.c.track]]\njoint = "a"\npath = "rotation"\n{keys([0, 1], [[0, 0, 0], [25, -40, 65]])}'
    (found,) = played_at(kiln.bake(spec + track), "c", "a", [1.0])
    wanted = Rotation.from_euler("XZY", [25, 65, -40], degrees=True).as_matrix()
    assert np.abs(found[:3, :3] - wanted).max() < 1e-6


def test_the_shorter_way_is_that_of_slerp(kiln: Kiln) -> None:
    """Between two quaternions of opposite sign."""
    first = Rotation.from_euler("xyz", [10, 20, 30], degrees=True)
    second = Rotation.from_euler("xyz", [80, -40, 100], degrees=True)
    values = [first.as_quat().tolist(), (-second.as_quat()).tolist()]
    spec = BOX + f'[clip.c]\ntolerance = 1e-5\n[[clip.c.track]]\nnode = "n"\npath = "rotation"\n{keys([0, 1], values)}'
    baked = kiln.bake(spec)
    turn = first.inv() * second
    for time, matrix in zip(times := [0.0, 0.3, 0.77, 1.0], played_at(baked, "c", "n", times), strict=True):
        wanted = first * Rotation.from_rotvec(turn.as_rotvec() * time)
        assert np.abs(matrix[:3, :3] - wanted.as_matrix()).max() < 3e-5


def test_cubic_keys_are_those_of_hermite(kiln: Kiln) -> None:
    """Slopes of chords between neighbours, uneven times; numpy builds the polynomial."""
    times, values = [0.0, 0.4, 1.5, 2.0], [0.0, 1.0, -0.5, 0.25]
    spec = BOX + (
        '[clip.c]\ntolerance = 1e-5\n[[clip.c.track]]\nnode = "n"\npath = "translation"\naxis = "y"\n'
        'between = "cubic"\n' + keys(times, values)
    )
    baked = kiln.bake(spec)
    t, v = np.array(times), np.array(values)
    slopes = np.concatenate(
        [[(v[1] - v[0]) / (t[1] - t[0])], (v[2:] - v[:-2]) / (t[2:] - t[:-2]), [(v[-1] - v[-2]) / (t[-1] - t[-2])]]
    )
    curve = CubicHermiteSpline(t, v, slopes)
    asked = np.linspace(0, 2, 41).tolist()
    found = [matrix[1, 3] for matrix in played_at(baked, "c", "n", asked)]
    assert np.abs(found - curve(asked)).max() < 2e-5


def test_a_bezier_law_is_followed(kiln: Kiln) -> None:
    """Ease in and out: y over x of a cubic, x solved by numpy."""
    points = np.array([[0, 0], [0.7, 0.1], [0.2, 0.9], [1, 1]])
    law = "curve = { bezier = { points = [[0, 0], [0.7, 0.1], [0.2, 0.9], [1, 1]] } }\n"
    spec = BOX + f'[clip.c]\ntolerance = 1e-5\n[[clip.c.track]]\nnode = "n"\npath = "translation"\naxis = "x"\n{law}'
    baked = kiln.bake(spec)
    basis = lambda t: np.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3], axis=-1)  # noqa: E731
    dense = basis(np.linspace(0, 1, 20001)) @ points
    asked = np.linspace(0, 1, 33).tolist()
    found = [matrix[0, 3] for matrix in played_at(baked, "c", "n", asked)]
    assert np.abs(found - np.interp(asked, dense[:, 0], dense[:, 1])).max() < 2e-5


@pytest.mark.cases
def test_published_key_frames(kiln: Kiln, cases: Path) -> None:
    """Steps, lines, slerps and cubics with written tangents, at the sample times of the references."""
    references = json.loads((cases / "skeleton" / "skeleton_refs.json").read_text())["cases"]
    played_cases = [one for one in references if one["kind"] == "keyframes"]
    assert len(played_cases) == 5
    for case in played_cases:
        between = {"LINEAR": "linear", "STEP": "step", "CUBICSPLINE": "cubic"}[case["interpolation"]]
        slopes = case["out_tangents"]
        if slopes is not None and case["in_tangents"] != slopes:
            slopes = (
                None if any(a != b for a, b in zip(case["in_tangents"][1:-1], slopes[1:-1], strict=True)) else slopes
            )
            if slopes is None:
                continue
            slopes = [*slopes[:-1], case["in_tangents"][-1]]
        rows = [
            f"{{ at = {t}, value = {v}" + (f", slope = {slopes[i]}" if slopes else "") + " }"
            for i, (t, v) in enumerate(zip(case["times"], case["values"], strict=True))
        ]
        spec = BOX + (
            f'[clip.c]\ntolerance = 1e-5\n[[clip.c.track]]\nnode = "n"\npath = "{case["target"]}"\n'
            f'between = "{between}"\n'
            f"keys = [{', '.join(rows)}]\n"
        )
        baked = kiln.bake(spec, name=case["name"].replace("_", "-"))
        times = [sample["t"] for sample in case["samples"]]
        for sample, matrix in zip(case["samples"], played_at(baked, "c", "n", times), strict=True):
            if case["target"] == "translation":
                off = np.abs(matrix[:3, 3] - sample["v"]).max()
            else:
                off = np.abs(matrix[:3, :3] - Rotation.from_quat(sample["v"]).as_matrix()).max()
            at_a_jump = between == "step" and any(abs(sample["t"] - t) < 1e-6 for t in case["times"])
            assert at_a_jump or off < 5e-5, (case["name"], sample, off)


@pytest.mark.cases
def test_published_chains(kiln: Kiln, cases: Path) -> None:
    """Forward kinematics of chains about given axes, the angles brought into their limits."""
    references = json.loads((cases / "skeleton" / "skeleton_refs.json").read_text())["cases"]
    chains = [one for one in references if one["kind"] == "fk_chain"]
    assert len(chains) == 3
    for case in chains:
        lines, tracks, head = ["[shape.b.box]\nsize = [1, 1, 1]\n"], [], np.zeros(3)
        for index, joint in enumerate(case["joints"]):
            head = head + joint["offset"]
            tip = joint.get("tip") or case["joints"][index + 1]["offset"]
            tail = head + tip
            parent = f'parent = "j{index - 1}"\n' if index else ""
            lines.append(f"[skeleton.s.joint.j{index}]\n{parent}head = {head.tolist()}\ntail = {tail.tolist()}\n")
            # An axis in the scene is turned into the rest frame of the bone, which has y along it.
            along = np.array(tip) / np.linalg.norm(tip)
            axis = least_turn(along).T @ np.array(joint["axis"], float)
            angle = case["angles_after_limits"][index]
            tracks.append(
                f'[[clip.c.track]]\njoint = "j{index}"\npath = "rotation"\naxis = {axis.tolist()}\n'
                + keys([0, 1], [angle, angle])
            )
        baked = kiln.bake("".join(lines + tracks), name=case["name"].replace("_", "-"))
        for index, wanted in enumerate(case["joint_positions"]):
            (matrix,) = played_at(baked, "c", f"j{index}", [0.5])
            assert np.abs(matrix[:3, 3] - wanted).max() < 1e-5, (case["name"], index)
        length = np.linalg.norm(case["joints"][-1]["tip"])
        end = matrix @ np.array([0, length, 0, 1])
        assert np.abs(end[:3] - case["tip"]).max() < 1e-5, case["name"]


def least_turn(along: np.ndarray) -> np.ndarray:
    """The rotation that brings y onto a direction by the shortest way."""
    axis = np.cross([0, 1, 0], along)
    sine, cosine = np.linalg.norm(axis), along[1]
    if sine < 1e-12:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return Rotation.from_rotvec(axis / sine * np.arctan2(sine, cosine)).as_matrix()


@pytest.mark.cases
def test_a_recorded_walk(kiln: Kiln, cases: Path) -> None:
    """A motion capture of 120 frames: places of all joints in the sampled frames as scipy and three.js have them."""
    reference = json.loads(gzip.decompress((cases / "bvh" / "01_01_first120.fk.json.gz").read_bytes()))
    (kiln.folder / "walk.bvh").write_bytes(gzip.decompress((cases / "bvh" / "01_01_first120.bvh.gz").read_bytes()))
    baked = kiln.bake(
        '[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.import]\nfile = "walk.bvh"\nscale = 0.1\n'
        '[clip.walk]\ntolerance = 1e-5\n[clip.walk.import]\nfile = "walk.bvh"\n'
    )
    names = {node.get("name") for node in baked.document.json["nodes"]}
    stage = played.Stage(baked.document)
    (animation,) = baked.document.json["animations"]
    checked = 0
    for sample in reference["samples"]:
        time = float(np.float32(sample["frame"] * reference["frame_time"]))
        told = [kebab(joint["name"]) for joint in reference["joints"]]
        pose = stage.pose(animation, {"time": time, "nodes": [name for name in told if name in names], "vertices": {}})
        for name, place in zip(told, sample["world_position"], strict=True):
            if name in pose["nodes"]:
                off = np.abs(np.array(pose["nodes"][name][12:15]) - 0.1 * np.array(place)).max()
                assert off < 5e-5, (name, sample["frame"], off)
                checked += 1
    assert checked >= 31 * len(reference["samples"])


@pytest.mark.cases
def test_damaged_motions_are_refused(kiln: Kiln, cases: Path) -> None:
    """Cut off anywhere, or with flipped bits: a diagnostic with the line, or a motion that can be read."""
    whole = gzip.decompress((cases / "bvh" / "01_01_first120.bvh.gz").read_bytes())
    spec = (
        '[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.import]\nfile = "walk.bvh"\n'
        '[clip.walk.import]\nfile = "walk.bvh"\n'
    )
    kiln.write(spec)
    dice = np.random.default_rng(7)
    for cut in dice.integers(0, len(whole) - 400, 12):
        (kiln.folder / "walk.bvh").write_bytes(whole[:cut])
        done = kiln.run("bake", "model.toml", "--out", "out")
        assert done.returncode == 1, cut
        assert "is no BVH motion, line" in done.stdout + done.stderr, cut
    for place in dice.integers(0, len(whole), 12):
        damaged = bytearray(whole)
        damaged[place] ^= 1 << int(dice.integers(0, 7))
        (kiln.folder / "walk.bvh").write_bytes(damaged)
        done = kiln.run("bake", "model.toml", "--out", "out")
        assert done.returncode in (0, 1), place
        assert "panicked" not in done.stdout + done.stderr, place


def kebab(name: str) -> str:
    """`LeftUpLeg` is `left-up-leg`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).lower()
