"""States of shapes held against formulas by numpy, in every profile, and tracks of weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from checks import played

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kiln import Baked, Kiln

Points = Any


def state(baked: Baked, name: str, target: str) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Places and normals of a mesh at weight 1 of a target, and its triangles."""
    mesh = next(mesh for mesh in baked.document.meshes if mesh.name == name)
    found = next(one for one in mesh.targets if one.name == target)
    normals = mesh.surfaces[0].attributes["NORMAL"].astype(float) + found.attributes["NORMAL"]
    return mesh.positions + found.attributes["POSITION"], normals, mesh.triangles


def inside(places: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Points over every triangle."""
    steps = np.linspace(0, 1, 6)
    weights = np.array([(a, b, 1 - a - b) for a in steps for b in steps if a + b <= 1 + 1e-9])
    return np.einsum("wk,tkx->twx", weights, places[triangles]).reshape(-1, 3)


def tight(places: NDArray[np.float64], surface: Callable[[Points, Points], Points]) -> float:
    """The greatest distance of points from a graph z(x, y): along z, over the slope there."""
    x, y, z = places.T
    step = 1e-6
    dx = (surface(x + step, y) - surface(x - step, y)) / (2 * step)
    dy = (surface(x, y + step) - surface(x, y - step)) / (2 * step)
    return float((np.abs(z - surface(x, y)) / np.sqrt(1 + dx**2 + dy**2)).max())


def wave(phase: float) -> Callable[[Points, Points], Points]:
    """The flag of the tests."""
    return lambda x, y: 0.12 * x * np.sin(np.radians(400 * x + 60 * y + phase))


FLAG = """
tolerance = 0.001
[parameters]
phase = 0
[shape.flag.parametric]
x = "= u"
y = "= v"
z = "= 0.12 * u * sin(400 * u + 60 * v + phase)"
u = [0, 1.5]
v = [0, 1]
[morph.flag.a]
with = { phase = 90 }
[morph.flag.b]
with = { phase = 180 }
[morph.flag.c]
with = { phase = 270 }
"""


def test_all_phases_of_a_flag_are_on_one_mesh(kiln: Kiln) -> None:
    """Each is within the tolerance of its own formula, everywhere on its triangles; normals are the formula's."""
    baked = kiln.bake(FLAG)
    facts = baked.shape("flag")
    base, triangles = baked.mesh("flag")
    assert tight(inside(base, triangles), wave(0)) <= min(facts["deviation"]["bound"], 0.001)
    for name, phase in (("a", 90.0), ("b", 180.0), ("c", 270.0)):
        places, normals, triangles = state(baked, "flag", name)
        surface = wave(phase)
        assert np.abs(places[:, 2] - surface(places[:, 0], places[:, 1])).max() < 1e-6
        bound = facts["morphs"][name]["deviation"]["bound"]
        found = tight(inside(places, triangles), surface)
        assert found <= bound <= 0.001, (found, bound)
        assert found > bound / 4, "finer than needed"
        x, y = places[:, 0], places[:, 1]
        step = 1e-5
        dx = (surface(x + step, y) - surface(x - step, y)) / (2 * step)
        dy = (surface(x, y + step) - surface(x, y - step)) / (2 * step)
        wanted = np.stack([-dx, -dy, np.ones_like(x)], axis=1)
        wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
        assert np.abs(normals - wanted).max() < 1e-5


@pytest.mark.parametrize(
    ("kind", "inner"),
    [
        ("sphere = { radius = 1 }", lambda p, s: np.abs(np.linalg.norm(p / s, axis=1) - 1).max()),
        ("torus = { radius = 1, tube-radius = 0.3 }", None),
        ("cylinder = { radius = 0.5, height = 2 }", None),
        ("capsule = { radius = 0.5, height = 2 }", None),
        ("extrude = { profile = { circle = { radius = 1 } }, height = 0.5 }", None),
        (
            "sweep = { profile = { circle = { radius = 0.1 } }, path = { arc = { radius = 1, from = 0, to = 200 } } }",
            None,
        ),
    ],
)
def test_squashed_bodies_are_affine_images(
    kiln: Kiln, kind: str, inner: Callable[[NDArray[np.float64], NDArray[np.float64]], float] | None
) -> None:
    """A state that is scaled is the image of the shape, point by point, whatever its triangulation alone would be."""
    head = 'tolerance = 0.002\n[parameters]\nhigh = 1\n[shape.s]\nscale = ["= high", "= 1 / high", 1]\n'
    baked = kiln.bake(f"{head}{kind}\n[morph.s.squashed]\nwith = {{ high = 3 }}\n")
    mesh = baked.document.meshes[0]
    scale = np.array([3.0, 1 / 3, 1.0])
    places, normals, _ = state(baked, "s", "squashed")
    assert np.abs(places - mesh.positions * scale).max() < 2e-6
    wanted = mesh.surfaces[0].attributes["NORMAL"] / scale
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert np.abs(normals - wanted).max() < 1e-5
    facts = baked.shape("s")["morphs"]["squashed"]["deviation"]
    assert facts["bound"] <= facts["tolerance"]
    if inner is not None:
        assert inner(places, scale) < 1e-6


@pytest.mark.parametrize("bend", [30, 90])
def test_a_bent_body_is_its_bending(kiln: Kiln, bend: int) -> None:
    """A cylinder bent by another angle: a torus' sector, of known radii."""
    spec = """
tolerance = 0.004
[parameters]
turn = 10
[shape.s.bend]
of = { revolve = { profile = { line = { from = [0.2, -1], to = [0.2, 1] } } } }
angle = "= turn"
[morph.s.more]
"""
    baked = kiln.bake(spec + f"with = {{ turn = {bend} }}\n")
    places, _, triangles = state(baked, "s", "more")
    radius = 2 / np.radians(bend)
    facts = baked.shape("s")["morphs"]["more"]["deviation"]
    assert facts["bound"] <= facts["tolerance"] == pytest.approx(0.004)

    def off(points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance from the tube about a circle in the plane of the bend, by its nearest axis."""
        best = np.full(len(points), np.inf)
        for axis in (0, 2):
            for sign in (-1, 1):
                center = np.array([0.0, -1.0, 0.0])
                center[axis] = sign * radius
                away = points - center
                flat = np.hypot(away[:, axis], away[:, 1])
                other = away[:, 2 - axis]
                tube = np.abs(np.hypot(flat - radius, other) - 0.2)
                best = tube if tube.max() < best.max() else best
        return best

    assert off(places).max() < 1e-5
    assert off(inside(places, triangles)).max() <= facts["bound"]


@pytest.mark.parametrize("between", ["step", "linear", "cubic"])
def test_tracks_of_weights_follow_their_keys(kiln: Kiln, between: str) -> None:
    """The place of a vertex over time is what the weights by numpy make of it."""
    times, values = [0.0, 0.5, 1.5, 2.0], [0.0, 1.0, -0.5, 0.25]
    keys = ", ".join(f"{{ at = {t}, value = {v} }}" for t, v in zip(times, values, strict=True))
    clip = f'[clip.c]\ntolerance = 1e-4\n[[clip.c.track]]\nmorph = "flag.b"\nbetween = "{between}"\nkeys = [{keys}]\n'
    baked = kiln.bake(FLAG + clip)
    stage = played.Stage(baked.document)
    mesh = baked.document.meshes[0]
    target = mesh.targets[1].attributes["POSITION"]
    vertex = int(np.abs(target).max(axis=1).argmax())
    t, v = np.array(times), np.array(values)
    if between == "cubic":
        scipy = pytest.importorskip("scipy.interpolate")
        slopes = np.concatenate(
            [[(v[1] - v[0]) / (t[1] - t[0])], (v[2:] - v[:-2]) / (t[2:] - t[:-2]), [(v[-1] - v[-2]) / (t[-1] - t[-2])]]
        )
        law = scipy.CubicHermiteSpline(t, v, slopes)
    elif between == "linear":
        law = lambda time: np.interp(time, t, v)  # noqa: E731
    else:
        law = lambda time: v[np.searchsorted(t, time, side="right") - 1]  # noqa: E731
    for time in np.linspace(0.01, 1.99, 37):
        question = {"time": float(time), "nodes": [], "vertices": {"flag": [{"vertex": vertex}]}}
        (found,) = stage.pose(baked.document.json["animations"][0], question)["vertices"]["flag"]
        wanted = mesh.positions[vertex] + float(law(time)) * target[vertex]
        assert np.abs(np.array(found) - wanted).max() < 1.01e-4
    assert baked.report["clips"]["c"]["bound"] <= 1e-4
