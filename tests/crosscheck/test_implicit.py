"""Implicit curves: every place lies on the curve, and as many parts are found as a fine grid of signs shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.ndimage import label

if TYPE_CHECKING:
    from collections.abc import Callable

    from kiln import Kiln

# Formula, the same in numpy, and the box: low and high in x, then in y.
CURVES: dict[str, tuple[str, Callable[[Any, Any], Any], tuple[float, float, float, float]]] = {
    "cassini, two ovals": (
        "(x^2 + y^2)^2 - 2 * (x^2 - y^2) + 0.2",
        lambda x, y: (x**2 + y**2) ** 2 - 2 * (x**2 - y**2) + 0.2,
        (-2, 2, -1, 1),
    ),
    "an elliptic curve of two parts": ("y^2 - x^3 + x", lambda x, y: y**2 - x**3 + x, (-1.5, 2, -2.5, 2.5)),
    "quartic with four ovals": (
        "(x^2 + 4 * y^2 - 4) * (4 * x^2 + y^2 - 4) + 0.3",
        lambda x, y: (x**2 + 4 * y**2 - 4) * (4 * x**2 + y**2 - 4) + 0.3,
        (-3, 3, -3, 3),
    ),
    "waves": (
        "sin(200 * x) + sin(170 * y) + 0.4",
        lambda x, y: np.sin(np.radians(200 * x)) + np.sin(np.radians(170 * y)) + 0.4,
        (-2.1, 2.3, -1.9, 2.2),
    ),
}


@pytest.mark.parametrize("name", CURVES)
def test_parts_are_those_of_the_signs(kiln: Kiln, name: str) -> None:
    formula, f, (left, right, low, high) = CURVES[name]
    box = f"min = [{left}, {low}]\nmax = [{right}, {high}]"
    kiln.write(f'[curve.a.implicit]\nf = "= {formula}"\n{box}\n[shape.s.sphere]\nradius = 1\n')
    found = kiln.sample("--curve", "a", "--count", "400")
    parts = found.get("parts", [found])
    step = 1e-6
    for part in parts:
        x, y = np.array([place["point"][:2] for place in part["samples"]]).T
        slope = np.hypot(f(x + step, y) - f(x - step, y), f(x, y + step) - f(x, y - step)) / (2 * step)
        # A first-order distance from the curve; cubic pieces follow it to 1e-9 of the box.
        assert (np.abs(f(x, y)) / slope).max() <= 2e-9 * max(right - left, high - low)
    # In a plane region cut by curves: each simple arc or oval adds one region to the one there is without any.
    grid = f(*np.meshgrid(np.linspace(left, right, 1501), np.linspace(low, high, 1501))) < 0
    regions = label(grid)[1] + label(~grid)[1]
    assert len(parts) == regions - 1
