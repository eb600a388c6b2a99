"""Levels of detail, by distances that trimesh measures and by what meshoptimizer's way of thinning needs."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh

from checks import tools
from checks.compare import compare

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Baked, Kiln

VASE = """
tolerance = 0.0005
[curve.c.natural-spline]
points = [[0.1, 0], [0.3, 0.2], [0.12, 0.6], [0.2, 0.8]]
[shape.s.revolve]
profile = "c"
"""
RING = "tolerance = 0.0004\n[shape.s.torus]\nradius = 0.4\ntube-radius = 0.15\n"
HELIX = """
tolerance = 0.0004
[shape.s.sweep]
profile = { circle = { radius = 0.05 } }
path = { helix = { radius = 0.3, pitch = 0.25, turns = 2 } }
"""


def solid(asset: Baked, name: str) -> trimesh.Trimesh:
    points, triangles = asset.mesh(name)
    return trimesh.Trimesh(points, triangles, process=False)


def apart(one: trimesh.Trimesh, other: trimesh.Trimesh) -> float:
    """The greatest distance of corners and random places of either from the other."""
    places = [np.concatenate([m.vertices, trimesh.sample.sample_surface(m, 2000, seed=1)[0]]) for m in (one, other)]
    return max(float(b.nearest.on_surface(p)[1].max()) for p, b in zip(places, (other, one), strict=True))


@pytest.mark.parametrize("spec", [VASE, RING, HELIX])
def test_levels_are_as_near_as_they_say(kiln: Kiln, spec: str) -> None:
    asset = kiln.bake(f"{spec}\n[lod]\nlevels = 4\n")
    chain = asset.report["lods"]["s"]
    assert len(chain) == 4
    finest = solid(asset, "s")
    for level in chain[1:]:
        found = apart(solid(asset, level["mesh"]), finest)
        assert found <= level["error"] + chain[0]["error"]
        # The bound is no guess far above: levels are as coarse as they may be.
        assert found >= 0.25 * level["error"]


@pytest.mark.parametrize("spec", [VASE, RING, HELIX])
def test_the_surface_needs_no_more_triangles_than_thinning_at_equal_error(kiln: Kiln, spec: str) -> None:
    asset = kiln.bake(f"{spec}\n[lod]\nlevels = 4\n")
    chain = asset.report["lods"]["s"]
    mesh = solid(asset, "s")
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in mesh.vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces]
    (kiln.folder / "fine.obj").write_text("\n".join(lines), encoding="utf-8")
    tolerances = [level["error"] for level in chain[1:]]
    thin = kiln.bake(
        f'[shape.s]\nsmoothing = "smooth"\n[shape.s.import]\nfile = "fine.obj"\n[lod]\ntolerances = {tolerances}\n',
        name="thin",
    )
    for level, other in zip(chain[1:], thin.report["lods"]["s"][1:], strict=False):
        assert other["source"] == "triangles"
        measured = apart(solid(thin, other["mesh"]), mesh)
        # Of one surface, triangles times error hardly change.
        assert level["triangles"] * level["error"] <= other["triangles"] * measured


def findings(path: Path, report: dict[str, Any]) -> list[str]:
    return [f.place for f in compare("model", report, tools.measure([path])[path]) if not f.holds]


def test_verification_holds_levels_and_catches_wrong_ones(kiln: Kiln) -> None:
    asset = kiln.bake(f"{RING}\n[lod]\nlevels = 3\n")
    assert findings(asset.path, asset.report) == []
    wrong = copy.deepcopy(asset.report)
    wrong["lods"]["s"][2]["error"] *= 0.2
    wrong["lods"]["s"][1]["triangles"] += 1
    found = findings(asset.path, wrong)
    assert "lods.s.2.error" in found
    assert "lods.s.1.triangles" in found


def test_profiles_and_forms_are_verified(kiln: Kiln) -> None:
    for form in ("msft-lod", "nodes", "files"):
        kiln.bake(f'{VASE}\n[lod]\nlevels = 3\nform = "{form}"\n', "--profile", "core,quantized,web", name=form)
        files = sorted((kiln.folder / "out").glob(f"{form}*.glb"))
        assert len(files) == (9 if form == "files" else 3)
        for file in files:
            report = kiln.baked(file.stem).report
            assert findings(file, report) == [], file.name


BALLOON = """
tolerance = 0.001
[parameters]
high = 1
[shape.group.group]
of = ["balloon", "knot"]
[shape.balloon.revolve]
profile = { formula = { x = "= 0.2 * cos(t) / sqrt(high)", y = "= 0.2 * high * sin(t)", from = -90, to = 90 } }
[shape.knot]
at = [0, "= -0.2 * high - 0.05", 0]
[shape.knot.sphere]
radius = 0.03
[morph.group.drawn-out]
with = { high = 1.5 }
[node.balloon]
shape = "group"
[clip.bounce]
duration = 1
[[clip.bounce.track]]
morph = "group.drawn-out"
keys = [{ at = 0, value = 0 }, { at = 0.4, value = 1 }, { at = 1, value = 0.2 }]
[output]
merge = false
[lod]
levels = 3
"""


def test_levels_of_what_morphs_and_parts_are_verified(kiln: Kiln) -> None:
    """Blender and three.js play the levels with their weights; sizes and shapes are those of the report."""
    for form in ("msft-lod", "nodes", "files"):
        kiln.bake(f'{BALLOON}form = "{form}"\n', "--profile", "core,quantized,web", name=form)
        for file in sorted((kiln.folder / "out").glob(f"{form}*.glb")):
            report = kiln.baked(file.stem).report
            assert len(report["lods"]["group"]) == (1 if form == "files" else 3), file.name
            assert findings(file, report) == [], file.name
    # By closed form: the drawn-out state of each level is an ellipsoid with a ball below it.
    asset = kiln.baked("msft-lod")
    for level in asset.report["lods"]["group"]:
        mesh = next(mesh for mesh in asset.document.meshes if mesh.name == level["mesh"])
        assert [
            p["extras"]["part"] for p in asset.document.json["meshes"][asset.document.meshes.index(mesh)]["primitives"]
        ] == [
            "balloon",
            "knot",
        ]
        places = mesh.positions + mesh.targets[0].attributes["POSITION"]
        body = np.unique(mesh.primitives[0].indices)
        x, y, z = places[body].T
        wide, high = 0.2 / np.sqrt(1.5), 0.3
        assert np.abs((x / wide) ** 2 + (y / high) ** 2 + (z / wide) ** 2 - 1).max() < 1e-5
        end = np.unique(mesh.primitives[1].indices)
        assert np.abs(np.linalg.norm(places[end] - [0, -0.35, 0], axis=1) - 0.03).max() < 1e-6
