"""The curves whose evaluation is timed: their numbers, and the same numbers as a document for Kiln."""

from __future__ import annotations

import json
import math

COUNT = 65  # control points; of Bezier curves the next count that makes whole pieces
HIGH_DEGREE = 7
Numbers = list[float]


def points(count: int) -> list[Numbers]:
    """Control points along a winding line."""
    return [[2.0 * math.cos(k), 0.3 * k + math.sin(3.0 * k), math.sin(0.7 * k)] for k in range(count)]


def weights(count: int) -> Numbers:
    """Weights between 1 and 3."""
    return [2.0 + math.sin(5.0 * k) for k in range(count)]


def knots(count: int, degree: int) -> Numbers:
    """Clamped knots, 0 to 1, uneven inside."""
    inner = count - degree - 1
    inside = [(k + 0.3 * math.sin(k)) / (inner + 1) for k in range(1, inner + 1)]
    return [*[0.0] * (degree + 1), *inside, *[1.0] * (degree + 1)]


def parameters(count: int) -> Numbers:
    """Parameters of points on a spline, uneven."""
    return [k + 0.3 * math.sin(k) for k in range(count)]


def families() -> dict[str, dict[str, object]]:
    """Each curve by its name: its kind and its fields as Kiln writes them."""
    pieces = 21 * 3 + 1
    return {
        "polyline": {"kind": "polyline", "points": points(COUNT)},
        "circle": {"kind": "circle", "radius": 2.0},
        "helix": {"kind": "helix", "radius": 2.0, "pitch": 0.5, "turns": 5},
        "cubic-spline": {"kind": "natural-spline", "points": points(COUNT), "parameters": parameters(COUNT)},
        "bezier": {"kind": "bezier", "points": points(pieces)},
        "bezier-7": {"kind": "bezier", "degree": HIGH_DEGREE, "points": points(HIGH_DEGREE + 1)},
        "b-spline": {"kind": "b-spline", "points": points(COUNT), "knots": knots(COUNT, 3)},
        "b-spline-5": {"kind": "b-spline", "degree": 5, "points": points(COUNT), "knots": knots(COUNT, 5)},
        "nurbs": {"kind": "nurbs", "points": points(COUNT), "weights": weights(COUNT), "knots": knots(COUNT, 3)},
    }


def document() -> str:
    """All of them for Kiln."""
    blocks = []
    for name, fields in families().items():
        lines = [f"{key} = {json.dumps(value)}" for key, value in fields.items() if key != "kind"]
        blocks.append("\n".join([f"[curve.{name}.{fields['kind']}]", *lines]))
    return "\n\n".join(blocks) + "\n\n[shape.block.box]\nsize = [1, 1, 1]\n"
