"""Weights by perturbations that are attached to joints, muscles that swell with an angle, and states along rays."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_morphs import inside, state

from checks import compare, played, written

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

STICK = """
[shape.b.box]
size = [0.2, 2, 0.2]
[node.b]
shape = "b"
[skeleton.s.joint.low]
head = [0, -1, 0]
tail = [0, 0, 0]
[skeleton.s.joint.high]
parent = "low"
tail = [0, 1, 0]
[skin.k]
shape = "b"
skeleton = "s"
weights = "perturbation"
"""


def bump(joint: str, center: list[float], factor: float = 1.0) -> str:
    """A ball of radius 2 that is attached to a joint."""
    quadric = "{ quadric = { xx = 0.25, yy = 0.25, zz = 0.25, constant = -1 }, at = " + str(center) + " }"
    return f'[[skin.k.bump]]\njoint = "{joint}"\nfield = {quadric}\nfactor = {factor}\n'


def weights(baked: Baked) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places of vertices, and for each joint its weight."""
    (mesh,) = baked.document.meshes
    attributes = mesh.surfaces[0].attributes
    found = np.zeros((len(mesh.positions), 2))
    joints, shares = attributes["JOINTS_0"].astype(int), attributes["WEIGHTS_0"] / 255.0
    for column in range(4):
        np.add.at(found, (np.arange(len(found)), joints[:, column]), shares[:, column])
    return mesh.positions, found


def share(places: NDArray[np.float64], centers: list[list[float]], factors: list[float]) -> NDArray[np.float64]:
    """Vyatkin's perturbation of each ball, as a share of all."""
    q = [(((places - center) ** 2).sum(axis=1) / 4.0) - 1.0 for center in centers]
    r = np.stack([abs(f) * np.minimum(one, 0.0) ** 2 for f, one in zip(factors, q, strict=True)], axis=1)
    return r / r.sum(axis=1, keepdims=True)


def test_weights_are_shares_of_the_perturbation(kiln: Kiln) -> None:
    """By the formula of the source; they sum to 1, and are the same on both sides of the middle."""
    centers = [[0.0, -0.8, 0.0], [0.0, 0.8, 0.0]]
    baked = kiln.bake(STICK + bump("low", centers[0]) + bump("high", centers[1]))
    places, found = weights(baked)
    assert np.abs(found.sum(axis=1) - 1.0).max() < 1e-9
    assert np.abs(found - share(places, centers, [1.0, 1.0])).max() <= 1.0 / 255
    for place, pair in zip(places, found, strict=True):
        other = np.abs(places - place * [1, -1, 1]).sum(axis=1).argmin()
        assert pair == pytest.approx(found[other][::-1])


def test_hollows_count_and_bumps_of_a_joint_add_up(kiln: Kiln) -> None:
    """A factor weighs its bump, whatever its sign."""
    centers = [[0.0, -0.8, 0.0], [0.0, 0.8, 0.0], [0.2, 0.6, 0.0]]
    spec = STICK + bump("low", centers[0]) + bump("high", centers[1], -0.5) + bump("high", centers[2], 2.0)
    places, found = weights(kiln.bake(spec))
    three = share(places, centers, [1.0, -0.5, 2.0])
    assert np.abs(found[:, 0] - three[:, 0]).max() <= 1.0 / 255


def test_one_bump_carries_wholly_and_what_none_reaches_is_told(kiln: Kiln) -> None:
    """Weight 1 inside; an error that counts the vertices outside."""
    _, found = weights(kiln.bake(STICK + bump("high", [0.0, 0.0, 0.0])))
    assert found[:, 1].tolist() == [1.0] * len(found)
    kiln.write(STICK + bump("high", [0.0, 1.5, 0.0]))
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode != 0
    assert "are carried by no joint" in done.stderr


ARM = """
[parameters]
wide = 0.2
[shape.b.box]
size = ["= wide", 2, 0.2]
[node.b]
shape = "b"
[skeleton.s.joint.low]
head = [0, -1, 0]
tail = [0, 0, 0]
[skeleton.s.joint.high]
parent = "low"
tail = [0, 1, 0]
[skin.k]
shape = "b"
skeleton = "s"
weights = "rigid"
[morph.b.swollen]
with = { wide = 0.4 }
driver = { joint = "high", axis = "x", from = 20, to = 80 }
[clip.c]
tolerance = 0.0005
"""
TIMES = np.linspace(0.0, 2.0, 161)


def driven(baked: Baked) -> NDArray[np.float64]:
    """The weight of the state over time, from the bytes."""
    stage = played.Stage(baked.document)
    (animation,) = baked.document.json["animations"]
    (channel,) = [one for one in animation["channels"] if one["target"]["path"] == "weights"]
    sampler = animation["samplers"][channel["sampler"]]
    return np.array([stage.sample(sampler, "weights", time)[0] for time in TIMES])


@pytest.mark.parametrize("limits", ["", "limits = { x = [0, 50] }"])
def test_a_muscle_swells_with_the_angle_of_its_joint(kiln: Kiln, limits: str) -> None:
    """Scipy takes the rotation apart; clamped joints swell no further. At rest nothing swells."""
    spec = ARM.replace("tail = [0, 1, 0]\n", f"tail = [0, 1, 0]\n{limits}\n") + ('limits = "clamp"\n' if limits else "")
    track = '[[clip.c.track]]\njoint = "high"\npath = "rotation"\nformula = ["= 45 * t", "= 0", "= 0"]\n'
    baked = kiln.bake(spec.replace("[clip.c]\n", "[clip.c]\nduration = 2\n") + track)
    turned = [Rotation.from_euler("X", 45.0 * time, degrees=True).as_euler("XZY", degrees=True)[0] for time in TIMES]
    angles = np.minimum(turned, 50.0) if limits else np.array(turned)
    wanted = np.clip((angles - 20.0) / 60.0, 0.0, 1.0)
    # A weight that is wrong by e moves a side by 0.1 e.
    assert np.abs(driven(baked) - wanted).max() <= 1.1 * 0.0005 / 0.1
    assert driven(baked)[0] == 0.0
    assert baked.document.json["meshes"][0].get("weights", [0.0]) == [0.0]
    facts = baked.report["clips"]["c"]["drivers"]["b.swollen"]
    assert (facts["joint"], facts["axis"], facts["from"], facts["to"]) == ("high", "x", 20, 80)
    assert facts["worst"] <= 2.2 * 0.0005 / 0.1
    assert len(facts["frames"]) == 9
    for frame in facts["frames"]:
        angle = min(45.0 * frame["time"], 50.0) if limits else 45.0 * frame["time"]
        assert frame["angle"] == pytest.approx(angle, abs=0.05)
        assert frame["weight"] == pytest.approx(min(max(angle - 20.0, 0.0) / 60.0, 1.0), abs=0.006)
    # What the report tells is held against the bytes: another weight, angle or difference is found.
    for change, place in (("weight", "weight"), ("angle", "angle"), ("worst", "worst")):
        told = copy.deepcopy(baked.report)
        task = told["clips"]["c"]["drivers"]["b.swollen"]
        if change == "worst":
            task["worst"] += 0.01
        else:
            task["frames"][4][change] += 0.01
        findings = list(compare.drivers("a", ("c", told["clips"]["c"]), written.measure(baked.path)))
        wrong = [finding.place for finding in findings if not finding.holds]
        assert wrong == [f"clips.c.drivers.b.swollen.{place}"]


def test_heights_morph_on_one_grid_of_triangles(kiln: Kiln) -> None:
    """Every point of both states is within the tolerance of its own heights, and the base stays flat."""
    spec = """
tolerance = 0.004
[parameters]
high = 0.1
[map.hills.formula]
columns = 33
rows = 33
f = "= high * sin(360 * x) * cos(180 * y)"
[shape.land.height-map]
map = "hills"
size = [2, 2]
close = "base"
base = -0.5
[morph.land.steep]
with = { high = 0.3 }
[node.land]
shape = "land"
"""
    baked = kiln.bake(spec)
    places, _, triangles = state(baked, "land", "steep")
    (mesh,) = baked.document.meshes
    for points, high in ((mesh.positions, 0.1), (places, 0.3)):
        all_ = inside(points, triangles)
        top = all_[all_[:, 1] > -0.32]
        top = top[(np.abs(top[:, 0]) < 0.999) & (np.abs(top[:, 2]) < 0.999)]
        wanted = high * np.sin(np.pi * (top[:, 0] + 1.0)) * np.cos(np.pi / 2 * (top[:, 2] + 1.0))
        # The map is known at its samples, and smooth or straight between them.
        slope = np.sqrt(1.0 + (np.pi * high) ** 2 * 1.25)
        assert (np.abs(top[:, 1] - wanted) / slope).max() < 0.004 + high * (np.pi / 16) ** 2 / 8
        assert points[:, 1].min() == pytest.approx(-0.5)
    facts = baked.report["shapes"]["land"]
    assert facts["closed"]


def test_ellipsoids_morph_along_the_rays_from_their_centers(kiln: Kiln) -> None:
    """Every vertex solves the equation of its state, and triangles are within the tolerance of it."""
    spec = """
tolerance = 0.002
[parameters]
wide = 1
[shape.egg.quadric]
xx = "= 1 / wide^2"
yy = 4
zz = 2
constant = -1
[morph.egg.long]
with = { wide = 1.8 }
[node.egg]
shape = "egg"
"""
    baked = kiln.bake(spec)
    places, normals, triangles = state(baked, "egg", "long")
    sizes = np.array([1.8, 0.5, np.sqrt(0.5)])
    assert np.abs(((places / sizes) ** 2).sum(axis=1) - 1.0).max() < 1e-5
    gradients = places / sizes**2
    gradients /= np.linalg.norm(gradients, axis=1)[:, None]
    assert (gradients * normals).sum(axis=1).min() > 0.98
    chords = inside(places, triangles)
    value = np.sqrt(((chords / sizes) ** 2).sum(axis=1))
    off = np.abs(value - 1.0) / np.linalg.norm(chords / sizes**2, axis=1) * value
    assert off.max() < 0.0021


def test_bumps_of_patches_grow_along_the_rays_of_their_faces(kiln: Kiln) -> None:
    """A muscle on a ball: what its bump does not reach stays, and every vertex keeps its ray."""
    spec = """
tolerance = 0.005
[parameters]
flex = 0.1
[shape.a.perturbed]
points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
center = [0, 0, 0]
spherical = true
bumps = [{ field = { quadric = { xx = 4, yy = 4, zz = 4, constant = -1 }, at = [0, 0, 0.9] }, factor = "= flex" }]
[morph.a.flexed]
with = { flex = 0.5 }
[node.a]
shape = "a"
"""
    baked = kiln.bake(spec)
    places, _, _ = state(baked, "a", "flexed")
    (mesh,) = baked.document.meshes
    unit = [one / np.linalg.norm(one, axis=1)[:, None] for one in (mesh.positions, places)]
    assert np.abs(unit[0] - unit[1]).max() < 1e-5
    for points, flex in ((mesh.positions, 0.1), (places, 0.5)):
        ball = ((points**2).sum(axis=1) - 1.0) / 2.0
        q = 4.0 * ((points - [0, 0, 0.9]) ** 2).sum(axis=1) - 1.0
        assert np.abs(ball - flex * np.minimum(q, 0.0) ** 2).max() < 1e-5
    assert np.linalg.norm(places - mesh.positions, axis=1).max() > 0.1
