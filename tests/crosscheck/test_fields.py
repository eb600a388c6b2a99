"""Surfaces of fields: closed forms by quadrature, the equation at every vertex, no self-intersection by MeshLab."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pymeshlab
import pytest

from sampled import exponent

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

ROOT = Path(__file__).resolve().parents[2]
CASES: list[dict[str, Any]] = json.loads((ROOT / "tests/data/fields/implicit.json").read_text(encoding="utf-8"))[
    "cases"
]
FALL_OFFS = {
    "wyvill6": ("wyvill", lambda s: np.where(s < 1, 1 - 22 / 9 * s + 17 / 9 * s**2 - 4 / 9 * s**3, 0.0)),
    "wyvill_cubed": ("power-3", lambda s: np.where(s < 1, (1 - s) ** 3, 0.0)),
    "blinn": ("gaussian", lambda s: np.exp(-s)),
}
BALLS = [case for case in CASES if case["kind"].startswith("metaballs")]
BODIES = {
    "sphere_r1": "sphere = { radius = 1 }",
    "torus_1_0.3": "torus = { radius = 1, tube-radius = 0.3 }",
    "rounded_box_half_(1,.6,.4)_r.2": "box = { size = [2.4, 1.6, 1.2], radius = 0.2 }",
}
CAPSULE = {"volume": np.pi * 0.16 * 1.4 + 4 / 3 * np.pi * 0.064, "area": 2 * np.pi * 0.4 * 1.4 + 4 * np.pi * 0.16}


def skeleton(case: dict[str, Any], tolerance: float) -> str:
    """A case of balls as a spec."""
    potential = FALL_OFFS[case["falloff"]][0]
    elements = ", ".join(
        f"{{ point = {[float(x) for x in ball['centre']]}, radius = {ball['radius']}, strength = {ball['weight']}, "
        f'potential = "{potential}" }}'
        for ball in case["balls"]
    )
    field = f"[field.balls.skeleton]\nlevel = {case['threshold']}\nelements = [{elements}]\n"
    return f'tolerance = {tolerance}\n{field}[shape.a.implicit]\nfield = "balls"\n'


def body(field: str, tolerance: float) -> str:
    """A spec of one body."""
    return f"tolerance = {tolerance}\n[shape.a.implicit]\nfield = {{ {field} }}\n"


def crossings(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> int:
    """How many triangles MeshLab finds to cross others."""
    layers = pymeshlab.MeshSet()
    layers.add_mesh(pymeshlab.Mesh(points, triangles))
    layers.compute_selection_by_self_intersections_per_face()
    return layers.current_mesh().selected_face_number()


def check_measures(baked: Baked, case: dict[str, Any]) -> tuple[NDArray[np.float64], float]:
    """Measures of the written triangles against those of the surface; the points and the bound."""
    points, triangles = baked.mesh("a")
    assert crossings(points, triangles) == 0
    bound = baked.report["shapes"]["a"]["deviation"]["bound"]
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert abs(volume - case["volume"]) <= bound * case["area"] + 1e-3 * case["volume"] * (case.get("how") is not None)
    # Sides of triangles turn by the root of the deviation, areas by its square.
    assert abs(area / case["area"] - 1) <= 8 * bound + 2e-3 * (case.get("how", "").startswith("marching"))
    edges = 3 * len(triangles) // 2
    euler = len(points) - edges + len(triangles)
    assert euler == case.get("euler", 2 - 2 * case.get("genus", 0))
    return points, bound


@pytest.mark.parametrize("case", BALLS, ids=lambda case: case["name"])
def test_balls_have_the_measures_of_quadrature(kiln: Kiln, case: dict[str, Any]) -> None:
    points, bound = check_measures(kiln.bake(skeleton(case, 2e-3)), case)
    fall_off = FALL_OFFS[case["falloff"]][1]
    sums = np.zeros(len(points))
    step = 1e-5
    slopes = np.zeros_like(points)
    for ball in case["balls"]:
        center, radius, weight = np.array(ball["centre"], float), ball["radius"], ball["weight"]
        sums += weight * fall_off(np.sum((points - center) ** 2, axis=1) / radius**2)
        for axis in range(3):
            ahead, behind = points - center, points - center
            ahead[:, axis] += step
            behind[:, axis] -= step
            values = [fall_off(np.sum(place**2, axis=1) / radius**2) for place in (ahead, behind)]
            slopes[:, axis] += weight * (values[0] - values[1]) / (2 * step)
    away = np.abs(sums - case["threshold"]) / np.linalg.norm(slopes, axis=1)
    assert away.max() <= 1e-6 * np.linalg.norm(np.ptp(points, axis=0))
    if "x_crossings" in case:
        reach = points[:, 0].min() - case["x_crossings"][0], case["x_crossings"][-1] - points[:, 0].max()
        assert min(reach) >= -1e-6
        assert max(reach) <= 1.01 * bound


@pytest.mark.parametrize("name", BODIES)
def test_bodies_have_the_measures_of_closed_forms(kiln: Kiln, name: str) -> None:
    case = next(case for case in CASES if case["name"] == name)
    check_measures(kiln.bake(body(BODIES[name], 2e-3)), case)


def test_a_box_closes_a_ball(kiln: Kiln) -> None:
    case = next(case for case in CASES if case["name"] == "sphere_clipped_by_box")
    field = "intersection = { of = [{ sphere = { radius = 1.2 } }, { box = { size = [2, 2, 2] } }] }"
    points, triangles = (baked := kiln.bake(body(field, 2e-3))).mesh("a")
    facts = baked.shape("a")
    assert facts["genus"] == 0
    assert facts["closed"]
    assert np.abs(np.abs(points).max(axis=0) - 1).max() <= 1e-6
    bound = baked.report["shapes"]["a"]["deviation"]["bound"]
    assert abs(facts["volume"] - case["volume_analytic"]) <= bound * facts["area"]
    assert crossings(points, triangles) == 0


@pytest.mark.parametrize(
    ("field", "volume", "area"),
    [
        ("sphere = { radius = 1 }", 4 / 3 * np.pi, 4 * np.pi),
        ("torus = { radius = 1, tube-radius = 0.3 }", 2 * np.pi**2 * 0.09, 4 * np.pi**2 * 0.3),
        ("capsule = { radius = 0.4, height = 2.2 }", CAPSULE["volume"], CAPSULE["area"]),
    ],
    ids=["sphere", "torus", "capsule"],
)
def test_measures_converge_with_the_tolerance(kiln: Kiln, field: str, volume: float, area: float) -> None:
    tolerances = [0.04, 0.01, 0.0025, 0.000625]
    facts = [kiln.bake(body(field, tolerance)).shape("a") for tolerance in tolerances]
    assert exponent(tolerances, [abs(one["volume"] - volume) for one in facts]) >= 0.9
    assert exponent(tolerances, [abs(one["area"] - area) for one in facts]) >= 0.9


@pytest.mark.parametrize("path", sorted((ROOT / "specs/fields").glob("*.toml")), ids=lambda path: path.stem)
def test_the_gallery_crosses_itself_nowhere(kiln: Kiln, path: Path) -> None:
    baked = kiln.bake(path.read_text(encoding="utf-8"))
    for mesh in baked.document.meshes:
        assert crossings(*mesh.merged) == 0, mesh.name
