"""The same shapes by Blender's modifiers, compared by Hausdorff distance (MeshLab's, both ways)."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pymeshlab

from sampled import bezier

if TYPE_CHECKING:
    from kiln import Kiln
    from sampled import Points, Triangles

MODELER = Path(__file__).with_name("blender_model.py")
VASE = [[0.0, 0.0], [0.9, 0.0], [1.2, 0.5], [1.0, 1.0], [0.8, 1.5], [0.5, 1.6], [0.0, 2.0]]
SINGLE = 1e-6  # Blender models in single precision


def model(folder: Path, **request: Any) -> dict[str, np.ndarray]:
    """What Blender makes, in a process of its own."""
    order, out = folder / "request.json", folder / "made.npz"
    order.write_text(json.dumps(request), encoding="utf-8")
    line = [sys.executable, str(MODELER), str(order), str(out)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return dict(np.load(out))


def hausdorff(one: tuple[Points, Triangles], other: tuple[Points, Triangles]) -> float:
    """The larger of both one-sided distances, from samples on vertices, edges and faces."""
    layers = pymeshlab.MeshSet()
    for points, triangles in (one, other):
        layers.add_mesh(pymeshlab.Mesh(points, triangles))
    options = {"samplevert": True, "sampleedge": True, "sampleface": True, "samplenum": 200_000}
    ways = ((0, 1), (1, 0))
    found = [layers.get_hausdorff_distance(sampledmesh=a, targetmesh=b, **options) for a, b in ways]
    return max(one["max"] for one in found)


def test_revolve_is_the_screw_modifier(kiln: Kiln) -> None:
    tolerance, rings, steps = 5e-4, 200, 360
    asset = kiln.bake(f'tolerance = {tolerance}\n[curve.c.bezier]\npoints = {VASE}\n[shape.s.revolve]\nprofile = "c"\n')
    t = np.linspace(0, 1, rings + 1)
    profile = np.concatenate([bezier(VASE[:4], t), bezier(VASE[3:], t)[1:]])
    made = model(kiln.folder, make="screw", profile=profile.tolist(), steps=steps)
    # Blender's own chords: those of its circle and of its profile, whose curvature stays below 12.
    own = 1.2 * (1 - np.cos(np.pi / steps)) + 12 * (3 / rings) ** 2 / 8
    bound = asset.shape("s")["deviation"]["bound"]
    assert hausdorff(asset.mesh("s"), (made["points"], made["triangles"])) <= bound + own + SINGLE


def test_sweep_is_the_curve_bevel(kiln: Kiln) -> None:
    tolerance, pieces, resolution = 1e-3, 1500, 62
    turn = np.linspace(0, 4, 65)
    knots = np.column_stack([2 * np.cos(turn), 0.5 * turn + 0.3 * np.sin(3 * turn), -2 * np.sin(turn)])
    asset = kiln.bake(
        f"tolerance = {tolerance}\n[curve.p.natural-spline]\npoints = {knots.tolist()}\n"
        '[shape.s.sweep]\nprofile = { circle = { radius = 0.15 } }\npath = "p"\n'
    )
    path = [sample["point"] for sample in kiln.sample("--curve", "p", "--count", str(pieces))["samples"]]
    made = model(kiln.folder, make="bevel", path=path, radius=0.15, resolution=resolution)
    own = 0.15 * (1 - np.cos(np.pi / (2 * resolution + 4))) + 3 * (9.5 / pieces) ** 2 / 8
    bound = asset.shape("s")["deviation"]["bound"]
    assert hausdorff(asset.mesh("s"), (made["points"], made["triangles"])) <= bound + own + SINGLE


def test_hausdorff_sees_a_difference(kiln: Kiln) -> None:
    one = kiln.bake("[shape.s.box]\nsize = [1, 1, 1]\n", name="one").mesh("s")
    other = kiln.bake("[shape.s.box]\nsize = [1, 1.02, 1]\n", name="other").mesh("s")
    assert abs(hausdorff(one, other) - 0.01) < 1e-5
