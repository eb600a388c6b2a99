"""B-spline and NURBS surfaces: points and derivatives by geomdl, whole surfaces by Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from geomdl import NURBS

from test_blender import SINGLE, hausdorff, model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Kiln

ACCURACY = 1e-9


def net(columns: int, rows: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Control points of a bumpy sheet, a row for each step of v, and weights from a half to two."""
    chance = np.random.default_rng(seed)
    x, z = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    points = np.stack([x, chance.uniform(-1, 1, x.shape), -z], axis=2) + chance.uniform(-0.2, 0.2, (*x.shape, 3))
    return points, chance.uniform(0.5, 2.0, x.shape)


def knots(count: int, degree: int, seed: int) -> list[float]:
    """Clamped knots, uneven inside, one of them double."""
    inside = np.cumsum(np.random.default_rng(seed).uniform(0.2, 1.0, count - degree - 1))
    if len(inside) > 2:
        inside[2] = inside[1]
    last = (inside[-1] if len(inside) else 0.0) + 0.7
    return [0.0] * (degree + 1) + inside.tolist() + [float(last)] * (degree + 1)


@pytest.mark.parametrize(("degree", "size"), [((3, 3), (7, 6)), ((2, 4), (5, 8)), ((1, 2), (4, 3)), ((5, 3), (6, 9))])
def test_nurbs_are_geomdls(kiln: Kiln, degree: tuple[int, int], size: tuple[int, int]) -> None:
    (columns, rows), (p, q) = size, degree
    points, weights = net(columns, rows, seed=columns)
    along, across = knots(columns, p, 1), knots(rows, q, 2)
    kiln.write(
        f"[shape.s.nurbs]\ndegree = [{p}, {q}]\nknots-u = {along}\nknots-v = {across}\n"
        f"control = {points.tolist()}\nweights = {weights.tolist()}\n"
    )
    reference = NURBS.Surface(normalize_kv=False)
    reference.degree_u, reference.degree_v = p, q
    weighted = np.concatenate([points * weights[:, :, None], weights[:, :, None]], axis=2)
    # geomdl's u is the slow index of its list.
    reference.set_ctrlpts(weighted.transpose(1, 0, 2).reshape(-1, 4).tolist(), columns, rows)
    reference.knotvector_u, reference.knotvector_v = along, across
    chance = np.random.default_rng(9)
    at = [(float(u * along[-1]), float(v * across[-1])) for u, v in chance.uniform(0, 1, (60, 2))]
    found = kiln.sample("--shape", "s", *[f"--at={u!r},{v!r}" for u, v in at])["samples"]
    keys = {"point": (0, 0), "du": (1, 0), "dv": (0, 1), "duu": (2, 0), "duv": (1, 1), "dvv": (0, 2)}
    for (u, v), sample in zip(at, found, strict=True):
        derivatives = reference.derivatives(u, v, order=2)
        for key, (i, j) in keys.items():
            expected = np.array(derivatives[i][j])
            size_of_it = max(float(np.linalg.norm(expected)), 1.0)
            assert np.linalg.norm(np.array(sample[key]) - expected) <= ACCURACY * size_of_it, (key, u, v)


@pytest.mark.parametrize("cyclic", [False, True])
@pytest.mark.parametrize("weighted", [False, True])
def test_surfaces_are_blenders(kiln: Kiln, *, weighted: bool, cyclic: bool) -> None:
    columns, rows, tolerance = 7, 6, 2e-3
    points, weights = net(columns, rows, seed=4)
    if cyclic:
        turn = 2 * np.pi * np.arange(columns) / columns
        radius = 2 + points[:, :, 1] / 3
        points = np.stack([radius * np.cos(turn), points[:, :, 2], -radius * np.sin(turn)], axis=2)
    lines = f"control = {points.tolist()}\n" + ('closed = ["u"]\n' if cyclic else "")
    kind = f"nurbs]\nweights = {weights.tolist()}" if weighted else "b-spline]"
    asset = kiln.bake(f"tolerance = {tolerance}\n[shape.s.{kind}\n{lines}")
    request: dict[str, Any] = {"points": points.tolist(), "cyclic": cyclic}
    request["weights"] = weights.tolist() if weighted else np.ones_like(weights).tolist()
    rough, fine = (model(kiln.folder, make="nurbs", resolution=resolution, **request) for resolution in (12, 24))
    rough, fine = ((made["points"], made["triangles"]) for made in (rough, fine))
    # Half the step has a quarter of the error: what lies between the two is three times that of the finer.
    own = 1.25 * hausdorff(rough, fine) / 3
    assert own < 5e-3
    assert hausdorff(asset.mesh("s"), fine) <= asset.shape("s")["deviation"]["bound"] + own + SINGLE


def test_joints_of_networks_stand_in_the_report(kiln: Kiln) -> None:
    """Two flat patches and a third that folds up from them: facts known beforehand, and what `sample` says."""
    corners = ["[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]", "[[1, 0, 0], [2, 0, 0]], [[1, 1, 0], [2, 1, 0]]"]
    corners.append("[[2, 0, 0], [2, 0, 1]], [[2, 1, 0], [2, 1, 1]]")
    parts = ", ".join(f"{{ patches = {{ degree = 1, control = [{net}] }} }}" for net in corners)
    found = kiln.bake(f"[shape.a.joined]\nof = [{parts}]\n").report["networks"]["a"]
    assert (found["surfaces"], found["open-sides"], found["collapsed-sides"]) == (3, 8, 0)
    assert found["continuity"] == {"G0": 0, "C0": 1, "G1": 0, "C1": 0, "C2": 1}
    folded = next(joint for joint in found["joints"] if joint["continuity"] == "C0")
    assert folded["angle"] == pytest.approx(90, abs=1e-9)
    assert folded["at"][0] == pytest.approx(2, abs=1e-12)
    assert [line["surface"] for line in folded["between"]] == [1, 2]
    assert [line["side"] for line in folded["between"]] == ["u-end", "u-start"]
    said = kiln.sample("--shape", "a")
    assert said["continuity"] == found["continuity"]
    assert len(said["open-sides"]) == found["open-sides"]
