"""SVG paths against svg.path, and what they fill against areas of circles."""

from __future__ import annotations

import json
import math
import random
from typing import TYPE_CHECKING

import numpy as np
import pytest
from svg.path import Close, Move, parse_path

if TYPE_CHECKING:
    from kiln import Kiln

PLACES = 16
# svg.path finds the center of an arc that is stretched to its ends as the root of what rounding left.
NEAR = 1e-6


def drawing(seed: int) -> str:
    """A path of every command, absolute and relative, in long and in short forms; no segment is without length."""
    dice = random.Random(seed)
    coordinate = lambda: f"{dice.uniform(-9, 9):.3f}"  # noqa: E731 -- a formula
    numbers = {"L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2}
    words = []
    for _ in range(dice.randint(1, 4)):
        words.append(f"{dice.choice('Mm')}{coordinate()},{coordinate()}")
        for _ in range(dice.randint(2, 9)):
            command = dice.choice("LHVCSQTA")
            if command == "A":
                flags = f"{dice.randint(0, 1)}{dice.choice(['', ' ', ','])}{dice.randint(0, 1)}"
                radii = f"{dice.uniform(0.5, 9):.2f} {dice.uniform(0.5, 9):.2f}"
                body = f"{radii} {dice.randint(-180, 180)} {flags} {coordinate()} {coordinate()}"
            else:
                body = dice.choice([" ", ","]).join(coordinate() for _ in range(numbers[command]))
            words.append((command if dice.random() < 0.5 else command.lower()) + body)
        words.append(dice.choice(["Z", "z", ""]))
    return dice.choice(["", " ", "\n"]).join(words)


@pytest.mark.parametrize("seed", range(12))
def test_paths_are_those_of_another_reader(kiln: Kiln, seed: int) -> None:
    text = drawing(seed)
    kiln.write(f"[curve.a.svg]\nd = {json.dumps(text)}\ny-up = true\n[shape.s.sphere]\nradius = 1\n")
    found = kiln.sample("--curve", "a", "--count", str(PLACES))
    parts = found.get("parts", [found])
    strokes: list[list] = []
    for segment in parse_path(text):
        if isinstance(segment, Move):
            strokes.append([])
        elif not isinstance(segment, Close) or segment.length() > 0:
            strokes[-1].append(segment)
    strokes = [stroke for stroke in strokes if stroke]
    assert len(parts) == len(strokes)
    for part, stroke in zip(parts, strokes, strict=True):
        assert part["domain"] == [0, len(stroke)]
        for place in part["samples"]:
            index = min(int(place["t"]), len(stroke) - 1)
            expected = stroke[index].point(place["t"] - index)
            assert math.isclose(place["point"][0], expected.real, abs_tol=NEAR), (text, place, expected)
            assert math.isclose(place["point"][1], expected.imag, abs_tol=NEAR), (text, place, expected)


def ring(x: float, y: float, radius: float, turn: int) -> str:
    """A circle of four arcs that turns as told."""
    sweep = 1 if turn > 0 else 0
    steps = [(radius, radius), (-radius, radius), (-radius, -radius), (radius, -radius)]
    steps = steps if turn > 0 else [(-dx, dy) for dx, dy in steps]
    arcs = "".join(f"a{radius} {radius} 0 0 {sweep} {dx} {dy}" for dx, dy in steps)
    return f"M{x} {y - radius}{arcs}z"


@pytest.mark.parametrize("fill", ["even-odd", "nonzero"])
def test_rings_in_rings_fill_as_they_should(kiln: Kiln, fill: str) -> None:
    dice = random.Random(7)
    rings = [(0.0, 0.0, 9.0 - k, dice.choice([-1, 1])) for k in range(6)]
    rings += [(30.0, 0.0, 9.0 - 2 * k, dice.choice([-1, 1])) for k in range(4)]
    dice.shuffle(rings)
    text = " ".join(ring(*one) for one in rings)
    spec = f'tolerance = 0.0001\n[shape.a.sheet]\nfill = "{fill}"\nprofile = {{ svg = {{ d = "{text}" }} }}'
    area = 0.0
    for x in (0.0, 30.0):
        turns = sorted(((radius, turn) for at, _, radius, turn in rings if at == x), reverse=True)
        edges = [radius for radius, _ in turns] + [0.0]
        winding = np.cumsum([turn for _, turn in turns])
        for k, around in enumerate(winding):
            inside = (k + 1) % 2 == 1 if fill == "even-odd" else around != 0
            area += math.pi * (edges[k] ** 2 - edges[k + 1] ** 2) if inside else 0.0
    found = kiln.bake(spec).shape("a")["area"]
    length = sum(2 * math.pi * radius for _, _, radius, _ in rings)
    assert abs(found - area) <= 0.0001 * length
