"""Times scipy (or numpy, where a formula is all) and geomdl on the same curves, points and first derivatives.

`peer_curves.py SAMPLES.json POINTS OUT.json`: SAMPLES holds what Kiln says of each curve (`kiln sample`), and every
peer must agree with it before it is timed. geomdl gets every `STRIDE`th of the points: it takes minutes for all.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from curves import families
from geomdl import NURBS, BSpline
from numpy.typing import NDArray
from scipy import interpolate

PASSES = 5
STRIDE = 1000
AGREEMENT = 1e-9  # of the greatest coordinate

Array = NDArray[np.float64]
Evaluation = Callable[[Array], tuple[Array, Array]]


def vectorized(kind: str, fields: dict[str, Any], domain: tuple[float, float]) -> Evaluation:
    """Points and first derivatives of many parameters by scipy or numpy."""
    points = np.array(fields.get("points", []), dtype=float)
    if kind in ("circle", "helix"):
        return formula(fields, domain)
    if kind == "nurbs":
        return rational(fields)
    if kind == "polyline":
        curve = interpolate.PPoly(np.stack([np.diff(points, axis=0), points[:-1]]), np.arange(len(points)))
    elif kind == "natural-spline":
        curve = interpolate.CubicSpline(np.array(fields["parameters"]), points, bc_type="natural")
    elif kind == "bezier":
        degree = int(fields.get("degree", 3))
        pieces = [points[k : k + degree + 1] for k in range(0, len(points) - 1, degree)]
        curve = interpolate.BPoly(np.stack(pieces, axis=1), np.arange(len(pieces) + 1))
    else:
        curve = interpolate.BSpline(np.array(fields["knots"]), points, int(fields.get("degree", 3)))
    slope = curve.derivative()
    return lambda t: (curve(t), slope(t))


def formula(fields: dict[str, Any], domain: tuple[float, float]) -> Evaluation:
    """Circle in x and y, helix around y, over Kiln's own parameter."""
    radius, turns = float(fields["radius"]), float(fields.get("turns", 1))
    rate = 2.0 * np.pi * turns / (domain[1] - domain[0])
    climb = float(fields.get("pitch", 0)) * turns / (domain[1] - domain[0])

    def evaluate(t: Array) -> tuple[Array, Array]:
        angle = rate * (t - domain[0])
        cos, sin = radius * np.cos(angle), radius * np.sin(angle)
        if fields["kind"] == "circle":
            zero = np.zeros_like(t)
            return np.stack([cos, sin, zero], 1), np.stack([-rate * sin, rate * cos, zero], 1)
        rise = climb * (t - domain[0])
        steady = np.full_like(t, climb)
        return np.stack([cos, rise, -sin], 1), np.stack([-rate * sin, steady, -rate * cos], 1)

    return evaluate


def rational(fields: dict[str, Any]) -> Evaluation:
    """A NURBS as a B-spline in four dimensions and the rule of quotients."""
    weights = np.array(fields["weights"])[:, None]
    lifted = np.hstack([np.array(fields["points"]) * weights, weights])
    curve = interpolate.BSpline(np.array(fields["knots"]), lifted, int(fields.get("degree", 3)))
    slope = curve.derivative()

    def evaluate(t: Array) -> tuple[Array, Array]:
        value, change = curve(t), slope(t)
        point = value[:, :3] / value[:, 3:]
        return point, (change[:, :3] - point * change[:, 3:]) / value[:, 3:]

    return evaluate


def by_geomdl(kind: str, fields: dict[str, Any]) -> Evaluation | None:
    """One point after the other by geomdl, for the kinds that it has."""
    points, degree = fields.get("points", []), int(fields.get("degree", 3))
    if kind in ("b-spline", "nurbs"):
        knots = fields["knots"]
    elif kind == "bezier" and len(points) == degree + 1:
        knots = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    else:
        return None
    curve = NURBS.Curve() if kind == "nurbs" else BSpline.Curve()
    curve.degree = degree
    if kind == "nurbs":
        curve.ctrlpts, curve.weights = points, fields["weights"]
    else:
        curve.ctrlpts = points
    curve.knotvector = knots

    def evaluate(t: Array) -> tuple[Array, Array]:
        found = np.array([curve.derivatives(float(u), 1) for u in t])
        return found[:, 0], found[:, 1]

    return evaluate


def nanoseconds(evaluate: Evaluation, places: Array, passes: int) -> float:
    """The fastest pass, by point."""
    fastest = float("inf")
    for _ in range(passes):
        started = time.perf_counter()
        evaluate(places)
        fastest = min(fastest, time.perf_counter() - started)
    return fastest * 1e9 / len(places)


def check(name: str, peer: str, evaluate: Evaluation, sample: dict[str, Any]) -> None:
    """Ends the run when a peer's points or derivatives are not Kiln's.

    Joints are left out: there the derivative depends on the side.
    """
    inside = [one for one in sample["samples"] if not any(abs(one["t"] - joint) < 1e-9 for joint in sample["joints"])]
    places = np.array([one["t"] for one in inside])
    for field, found in zip(("point", "first"), evaluate(places), strict=True):
        wanted = np.array([one[field] for one in inside])
        away = float(np.abs(found - wanted).max() / np.abs(wanted).max())
        if away > AGREEMENT:
            sys.exit(f"{peer} disagrees with Kiln on {field} of {name} by {away:.1e}")


def main() -> None:
    """Check and time every curve."""
    samples = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    figures: dict[str, dict[str, float | None]] = {}
    for name, fields in families().items():
        kind, sample = str(fields["kind"]), samples[name]
        start, end = sample["domain"]
        places = np.linspace(start, end, int(sys.argv[2]))
        fast, slow = vectorized(kind, fields, (start, end)), by_geomdl(kind, fields)
        check(name, "scipy", fast, sample)
        figures[name] = {"scipy": nanoseconds(fast, places, PASSES), "geomdl": None}
        if slow:
            check(name, "geomdl", slow, sample)
            figures[name]["geomdl"] = nanoseconds(slow, places[::STRIDE], 1)
    Path(sys.argv[3]).write_text(json.dumps(figures), encoding="utf-8")


if __name__ == "__main__":
    main()
