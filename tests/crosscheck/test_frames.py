"""Rotation-minimizing frames and reference surfaces, against the reference cases."""

from __future__ import annotations

import gzip
import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sampled import volume

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln
    from sampled import Points, Triangles

RIBBON = """
tolerance = 0.001
{path}
[curve.section.line]
from = [0, 0]
to = [1, 0]
[shape.s.sweep]
profile = "section"
path = "p"
caps = false
"""
HELIX = "[curve.p.helix]\nradius = 1\npitch = 1\nturns = 2\n"


def sides(kiln: Kiln, path: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Points of the path at equal shares of its parameter, and the frame's side vectors there."""
    kiln.write(RIBBON.format(path=path))
    domain = kiln.sample("--shape", "s", "--count", "1")
    ends = []
    for u in domain["domain-u"]:
        at = [f"--at={u!r},{v!r}" for v in np.linspace(*domain["domain-v"], count).tolist()]
        samples = kiln.sample("--shape", "s", *at)["samples"]
        ends.append(np.array([sample["point"] for sample in samples]))
    return ends[0], ends[1] - ends[0]


def test_frame_of_a_helix_is_the_solution_of_its_equation(kiln: Kiln) -> None:
    """A rotation-minimizing side r obeys r' = -(c''.r) c' / |c'|^2; scipy integrates it."""
    count = 65
    points, side = sides(kiln, HELIX, count)
    hand = 1.0 if points[1, 2] > 0 else -1.0
    pitch = 1 / (2 * np.pi)

    def velocity(t: float) -> np.ndarray:
        return np.array([-np.sin(t), pitch, hand * np.cos(t)])

    def bend(t: float) -> np.ndarray:
        return np.array([-np.cos(t), 0.0, -hand * np.sin(t)])

    def rule(t: float, r: np.ndarray) -> np.ndarray:
        v = velocity(t)
        return -(bend(t) @ r) * v / (v @ v)

    turn = np.linspace(0, 4 * np.pi, count)
    exact = solve_ivp(rule, (0, turn[-1]), side[0], t_eval=turn, rtol=1e-11, atol=1e-12).y.T
    np.testing.assert_allclose(np.linalg.norm(side, axis=1), 1, atol=1e-9)
    np.testing.assert_allclose(side, exact, atol=1e-4)


@pytest.mark.cases
def test_frame_of_the_reference_helix(kiln: Kiln, cases: Path) -> None:
    (case,) = reference(cases, "rotation_minimising_frame")
    samples = case["samples"]
    points, side = sides(kiln, HELIX, len(samples))
    upright = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    turned = [np.array([s["p"] for s in samples]) @ (upright.T * flip) for flip in ([1, 1, 1], [1, 1, -1])]
    flip = min(([1, 1, 1], [1, 1, -1]), key=lambda f: np.abs(turned[f[2] < 0] - points).max())
    np.testing.assert_allclose(points, turned[flip[2] < 0], atol=1e-9)
    vectors = [np.array([s[key] for s in samples]) @ (upright.T * flip) for key in ("tangent", "r")]
    tangents, exact = vectors
    angle = np.arctan2(np.einsum("vi,vi->v", np.cross(exact, side), tangents), np.einsum("vi,vi->v", exact, side))
    np.testing.assert_allclose(np.unwrap(angle), angle[0], atol=1e-4)


def reference(cases: Path, kind: str) -> list[dict[str, Any]]:
    """The reference surfaces of one kind."""
    text = gzip.decompress((cases / "surfaces" / "surfaces.json.gz").read_bytes())
    return [case for case in json.loads(text)["cases"] if case["kind"] == kind]


def outline(profile: dict[str, Any]) -> str:
    """A reference profile as a curve of the language."""
    if "polyline_rz" in profile:
        return f"[curve.c.polyline]\npoints = {profile['polyline_rz']}\n"
    if "circle_rz" in profile:
        circle = profile["circle_rz"]
        return f"[curve.c.circle]\nradius = {circle['radius']}\ncenter = {circle['centre']}\n"
    if "cubic_bezier_rz" in profile:
        return f"[curve.c.bezier]\npoints = {profile['cubic_bezier_rz']}\n"
    points = profile["natural_cubic_spline_rz_uniform"]
    return f'[curve.c.natural-spline]\npoints = {points}\nparameters = "uniform"\n'


@pytest.mark.cases
def test_reference_revolutions(kiln: Kiln, cases: Path) -> None:
    found = [case for case in reference(cases, "revolution") if "slightly negative" not in case["note"]]
    assert len(found) >= 4
    for case in found:
        spec = f'tolerance = 0.0005\n{outline(case["profile"])}[shape.s.revolve]\nprofile = "c"\n'
        asset = kiln.bake(spec)
        assert asset.shape("s")["area"] == pytest.approx(case["lateral_area"], rel=1e-3), case["name"]
        volume = capped_volume(*asset.mesh("s"))
        assert volume == pytest.approx(case["volume_swept_to_axis"], rel=1e-3), case["name"]


def capped_volume(points: Points, triangles: Triangles) -> float:
    """The volume of a turned surface with flat discs laid over its open ends.

    A disc at height y adds y / 3 times its area, outward to both sides; the tetrahedra lead to the origin.
    """
    return abs(volume(points, triangles) + sum(disc(points, triangles)))


def disc(points: Points, triangles: Triangles) -> list[float]:
    """What the disc over each open ring adds to the volume, by its border's edges turned around."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, which, uses = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    border = edges[uses[which.ravel()] == 1][:, ::-1]
    a, b = points[border[:, 0]], points[border[:, 1]]
    center = np.column_stack([0 * a[:, 1], a[:, 1], 0 * a[:, 1]])
    return (np.einsum("ti,ti->t", a, np.cross(b, center)) / 6).tolist()


@pytest.mark.cases
def test_reference_sweeps(kiln: Kiln, cases: Path) -> None:
    for case in reference(cases, "sweep"):
        if "circle" not in case["section"]:
            continue
        spec = (
            f"tolerance = 0.0005\n{path_of(case['path'])}"
            f"[shape.s.sweep]\nprofile = {{ circle = {{ radius = {case['section']['circle']} }} }}\n"
            'path = "p"\n'
        )
        shape = kiln.bake(spec).shape("s")
        assert shape["volume"] == pytest.approx(case["volume"], rel=5e-3), case["name"]
        ends = 2 * np.pi * case["section"]["circle"] ** 2
        assert shape["area"] == pytest.approx(case["lateral_area"] + ends, rel=5e-3), case["name"]


@pytest.mark.cases
def test_reference_twisted_square(kiln: Kiln, cases: Path) -> None:
    (case,) = [case for case in reference(cases, "sweep") if "twist" in case]
    side, (start, end) = case["section"]["square"], case["path"]["line"]
    half = side / 2
    corners = [[-half, -half], [half, -half], [half, half], [-half, half]]
    square = f"{{ polyline = {{ points = {corners}, closed = true }} }}"
    turn = f"twist = {np.degrees(case['twist'])}\n"
    path = f"path = {{ line = {{ from = {start}, to = {end} }} }}\n"
    height = f"height = {np.linalg.norm(np.subtract(end, start))}\n"
    for kind, way in (("sweep", path), ("extrude", height)):
        shape = kiln.bake(f"tolerance = 0.0005\n[shape.s.{kind}]\nprofile = {square}\n{way}{turn}").shape("s")
        assert shape["closed"]
        assert shape["volume"] == pytest.approx(case["volume"], rel=1e-3), kind
        assert shape["area"] == pytest.approx(case["lateral_area"] + 2 * side**2, rel=1e-3), kind


@pytest.mark.cases
def test_reference_wine_glass(kiln: Kiln, cases: Path) -> None:
    """Its spline dips below the axis, which a turned profile must not; the spline itself gives the area and volume."""
    (case,) = [case for case in reference(cases, "revolution") if case["name"] == "wine_glass"]
    kiln.write(f'{outline(case["profile"])}[shape.s.revolve]\nprofile = "c"\n')
    refused = kiln.run("bake", "model.toml", "--out", "out")
    assert refused.returncode != 0
    assert "K0801" in refused.stderr
    samples = kiln.sample("--curve", "c", "--count", "2048")["samples"]
    points = np.array([sample["point"] for sample in samples])
    radius, height = points[:, 0], points[:, 1]
    steps = np.hypot(np.diff(radius), np.diff(height))
    middle = (radius[1:] + radius[:-1]) / 2
    assert 2 * np.pi * np.sum(np.abs(middle) * steps) == pytest.approx(case["lateral_area"], rel=1e-5)
    assert np.pi * np.sum(middle**2 * np.diff(height)) == pytest.approx(case["volume_swept_to_axis"], rel=1e-5)


def path_of(path: dict[str, Any]) -> str:
    """A reference path as a curve of the language."""
    if "line" in path:
        start, end = path["line"]
        return f"[curve.p.line]\nfrom = {start}\nto = {end}\n"
    if "arc" in path:
        arc = path["arc"]
        return f"[curve.p.arc]\ncenter = [0, 0]\nradius = {arc['radius']}\nfrom = 0\nto = {np.degrees(arc['angle'])}\n"
    helix = path["helix"]
    return f"[curve.p.helix]\nradius = {helix['radius']}\npitch = {helix['pitch']}\nturns = {helix['turns']}\n"
