"""Operations on profiles against shapely, on random outlines, with what chords explain."""

from __future__ import annotations

import json
import random
from typing import TYPE_CHECKING

import numpy as np
import pytest
from shapely import Polygon, unary_union
from shapely.affinity import rotate, scale, translate
from shapely.geometry import Point

if TYPE_CHECKING:
    from kiln import Kiln

ARC = 2000  # chords to a quarter circle in shapely
TOLERANCE = 1e-5


def star(dice: random.Random, corners: int) -> list[list[float]]:
    """A polygon that does not cross itself: any distances, in the order of their angles."""
    angles = np.sort([dice.uniform(0, 1) for _ in range(corners)]) * 2 * np.pi
    radii = [dice.uniform(0.6, 2.4) for _ in angles]
    return [[float(r * np.cos(a)), float(r * np.sin(a))] for r, a in zip(radii, angles, strict=True)]


def outline(dice: random.Random) -> tuple[str, Polygon]:
    """A curve in place, and the same for shapely."""
    x, y = dice.uniform(-1.5, 1.5), dice.uniform(-1.5, 1.5)
    if dice.random() < 0.4:
        radii = [dice.uniform(0.4, 2), dice.uniform(0.4, 2)]
        turn = dice.uniform(0, 180)
        inner = f"{{ ellipse = {{ radii = {radii} }} }}"
        text = f"{{ transform = {{ of = {inner}, rotate = [0, 0, {turn}], at = [{x}, {y}, 0] }} }}"
        disk = scale(Point(0, 0).buffer(1, quad_segs=ARC), *radii)
        return text, translate(rotate(disk, turn, origin=(0, 0)), x, y)
    moved = [[px + x, py + y] for px, py in star(dice, dice.randint(3, 12))]
    return f"{{ polyline = {{ points = {json.dumps(moved)}, closed = true }} }}", Polygon(moved)


def area(kiln: Kiln, curve: str) -> float:
    """The area of a sheet in a curve."""
    spec = f"tolerance = {TOLERANCE}\n[shape.a.sheet]\nprofile = {{ {curve} }}"
    return kiln.bake(spec).shape("a")["area"]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("operation", ["union", "difference", "intersection", "xor"])
def test_sets_are_those_of_shapely(kiln: Kiln, seed: int, operation: str) -> None:
    dice = random.Random(seed)
    made = [outline(dice) for _ in range(3)]
    regions = [region for _, region in made]
    assert all(region.is_valid for region in regions)
    expected = {
        "union": unary_union(regions),
        "difference": regions[0] - regions[1] - regions[2],
        "intersection": regions[0] & regions[1] & regions[2],
        "xor": regions[0] ^ regions[1] ^ regions[2],
    }[operation]
    around = sum(region.length for region in regions)
    if expected.area < TOLERANCE * around:
        return
    curve = f"{operation} = {{ of = [{', '.join(text for text, _ in made)}] }}"
    if operation == "xor":  # its parts touch where outlines cross: no sheet, but lines
        spec = f"tolerance = {TOLERANCE}\n[shape.a.wire]\ncurves = [{{ {curve} }}]"
        assert abs(kiln.bake(spec).shape("a")["lines"]["length"] - expected.length) <= 10 * TOLERANCE * around
    else:
        assert abs(area(kiln, curve) - expected.area) <= TOLERANCE * around


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("style", ["round", "bevel", "miter"])
def test_parallels_are_those_of_shapely(kiln: Kiln, seed: int, style: str) -> None:
    dice = random.Random(100 + seed)
    text, region = outline(dice)
    distance = dice.choice([-0.3, -0.1, 0.1, 0.5])
    join = {"round": 1, "miter": 2, "bevel": 3}[style]
    expected = region.buffer(distance, quad_segs=ARC, join_style=join, mitre_limit=1e6)
    if expected.area < 1e-3:
        return
    limit = "1000000" if style == "miter" else "4"
    found = area(kiln, f'offset = {{ of = {text}, distance = {distance}, corner = "{style}", miter-limit = {limit} }}')
    assert abs(found - expected.area) <= 2 * TOLERANCE * expected.length
