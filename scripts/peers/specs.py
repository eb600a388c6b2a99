"""The same models in the languages of tools that read files: Kiln, OpenSCAD, JSCAD."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from peers import models

if TYPE_CHECKING:
    from pathlib import Path

# OpenSCAD has no sweep along a curve: the mesh is made in its own language, frames projected step by step.
OPENSCAD_SWEEP = """
n = {segments}; k = {sides}; r = {radius};
function p(t) = [2 * cos(t * 180 / PI), 2 * sin(t * 180 / PI), 0.5 * t + 0.3 * sin(3 * t * 180 / PI)];
T = [for (i = [0 : n]) let (t = {end} * i / n, e = 1e-4, d = p(t + e) - p(t - e)) d / norm(d)];
function unit(v) = v / norm(v);
function frames(i, u, found) =
    i > n ? found : let (v = unit(u - T[i] * (u * T[i]))) frames(i + 1, v, concat(found, [v]));
N = frames(0, unit(cross(T[0], [0, 0, 1])), []);
points = [for (i = [0 : n]) let (c = p({end} * i / n), B = cross(T[i], N[i]))
    for (j = [0 : k - 1]) c + r * cos(360 * j / k) * N[i] + r * sin(360 * j / k) * B];
sides = [for (i = [0 : n - 1]) for (j = [0 : k - 1])
    [i * k + j, (i + 1) * k + j, (i + 1) * k + (j + 1) % k, i * k + (j + 1) % k]];
polyhedron(points, concat([[for (j = [0 : k - 1]) j]], [[for (j = [k - 1 : -1 : 0]) n * k + j]], sides));
"""


def write(folder: Path) -> None:
    """Write every input file."""
    (folder / "vase.toml").write_text(kiln_vase(models.PROFILE_SEGMENTS, models.TURN_SEGMENTS))
    (folder / "sweep.toml").write_text(kiln_sweep())
    (folder / "loft.toml").write_text(kiln_loft())
    (folder / "tolerance.toml").write_text(kiln_vase_within(1e-4))
    profile = json.dumps(models.profile())
    (folder / "vase.scad").write_text(f"rotate_extrude($fn = {models.TURN_SEGMENTS}) polygon({profile});\n")
    (folder / "sweep.scad").write_text(
        OPENSCAD_SWEEP.format(
            segments=models.PATH_SEGMENTS,
            sides=models.TUBE_SEGMENTS,
            radius=models.TUBE_RADIUS,
            end=models.PATH_END,
        )
    )
    jscad = {
        "profile": models.profile(),
        "turns": models.TURN_SEGMENTS,
        "path": models.path(),
        "frames": models.frames(),
        "radius": models.TUBE_RADIUS,
        "sides": models.TUBE_SEGMENTS,
    }
    (folder / "jscad.json").write_text(json.dumps(jscad))


def kiln_profile() -> str:
    """The vase's outline."""
    points = [*models.BEZIERS[0], *models.BEZIERS[1][1:]]
    return f"[curve.outline.bezier]\npoints = {json.dumps(points)}\n\n"


def kiln_vase(along: int, around: int) -> str:
    """The vase on a fixed grid; of a turned surface u goes around and v along the profile."""
    return (
        f'{kiln_profile()}[shape.vase]\nsegments = [{around}, {along}]\n\n[shape.vase.revolve]\nprofile = "outline"\n'
    )


def kiln_vase_within(tolerance: float) -> str:
    """The vase within a tolerance."""
    return f'tolerance = {tolerance}\n\n{kiln_profile()}[shape.vase.revolve]\nprofile = "outline"\n'


def kiln_sweep() -> str:
    """The tube on a fixed grid along a spline through the path's points."""
    return (
        f"[curve.path.natural-spline]\npoints = {json.dumps(models.path())}\n\n"
        f"[shape.sweep]\nsegments = [{models.TUBE_SEGMENTS}, {models.PATH_SEGMENTS}]\n\n"
        "[shape.sweep.sweep]\n"
        f'profile = {{ circle = {{ radius = {models.TUBE_RADIUS} }} }}\npath = "path"\n'
    )


def kiln_loft() -> str:
    """The smooth loft through three circles on a fixed grid."""
    rings = ", ".join(
        f"{{ circle = {{ radius = {radius}, center = [0, 0, {height}] }} }}" for radius, height in models.LOFT_RINGS
    )
    return (
        f"[shape.loft]\nsegments = [{models.LOFT_AROUND}, {models.LOFT_ALONG}]\n\n"
        f"[shape.loft.loft]\nprofiles = [{rings}]\n"
    )
