"""Curves as lines: what is written, held against closed forms and against the tools; and a wrong claim is caught."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

import made
from checks import tools
from checks.compare import compare

if TYPE_CHECKING:
    from checks.finding import Measured
    from kiln import Baked, Kiln

SPEC = """
tolerance = 0.0005
[material.red]
color = "#cc2211"
[curve.coil.helix]
radius = 0.5
pitch = 0.25
turns = 3
[curve.frame.polyline]
points = [[0, 0], [2, 0], [2, 0.5], [2, 1], [0, 1]]
closed = true
[shape.drawing.wire]
curves = ["coil", "frame"]
[shape.block.box]
size = [1, 1, 1]
[shape.edge]
material = "red"
[shape.edge.wire]
curves = [{ line = { from = [0, 0, 0], to = [0, 0, 1] } }]
[shape.both.group]
of = ["block", "edge"]
[node.left]
shape = "drawing"
[node.right]
shape = "both"
at = [5, 0, 0]
rotate = [0, 30, 0]
"""


@pytest.fixture
def baked(kiln: Kiln) -> tuple[Baked, list[Measured]]:
    asset = kiln.bake(SPEC, "--measure")
    return asset, tools.measure([asset.path])[asset.path]


def test_lines_have_the_lengths_of_their_curves(baked: tuple[Baked, list[Measured]]) -> None:
    lines = baked[0].shape("drawing")["lines"]
    coil = 3 * math.hypot(2 * math.pi * 0.5, 0.25)
    # An arc of radius r in chords of sagitta s is longer than they are by the part 2 s / 3 r.
    assert 0 <= coil + 6 - lines["length"] <= coil * 2 * 0.0005 / (3 * 0.5) + 1e-6
    assert (lines["curves"], lines["closed-curves"]) == (2, 1)
    mesh = next(mesh for mesh in baked[0].document.meshes if mesh.name == "drawing")
    corners = {(0, 0, 0), (2, 0, 0), (2, 0.5, 0), (2, 1, 0), (0, 1, 0)}
    assert corners <= {tuple(np.round(place, 6).tolist()) for place in mesh.lines.positions}


def test_tools_agree_and_catch_each_wrong_claim(baked: tuple[Baked, list[Measured]]) -> None:
    asset, measured = baked
    assert [f"{f.tool} {f.place} {f.message}" for f in compare("wires", asset.report, measured) if not f.holds] == []
    paths = [path for path in made.paths(asset.report) if "lines" in path or str(path[-1]).endswith("segments")]
    assert len(paths) > 12
    for path in paths:
        change = made.changed(
            asset.report, path, lambda value: value * 1.001 + 1 if isinstance(value, int) else value + 0.01
        )
        assert any(not finding.holds for finding in compare("wires", change, measured)), path
