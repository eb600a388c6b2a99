"""The `growth` part of the bench: time and memory of one face from ten thousand triangles to ten million."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from peers import nets
from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

TOLERANCES = (1.6e-4, 5e-5, 1.6e-5, 5e-6, 1.6e-6, 5e-7, 1.6e-7)
WIDTH, HEIGHT, MARGIN = 640, 360, 56


def measure(kiln: Path, folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Whole processes from document to file, report included, and the exponents of their growth."""
    rows = []
    control = [[list(point) for point in row] for row in nets.face()]
    for tolerance in TOLERANCES:
        text = f"tolerance = {tolerance}\n[shape.face.b-spline]\ncontrol = {control}\n"
        (folder / "growth.toml").write_text(text, encoding="utf-8")
        line = [str(kiln), "bake", "growth.toml", "--out", "growth", "--quiet"]
        entry = Runs("Kiln", line, folder / "growth" / "growth.glb")
        together([entry], runs, folder, tell)
        row: dict[str, Any] = {"tolerance": tolerance, "failure": entry.failure}
        if entry.failure is None:
            row |= {"seconds": entry.median, "peak": entry.peak, "bytes": entry.output.stat().st_size}
            row["triangles"] = triangles(entry.output.with_suffix(".report.json"))
        rows.append(row)
    done = [row for row in rows if row["failure"] is None]
    exponents = {key: exponent([(row["triangles"], row[key]) for row in done[-4:]]) for key in ("seconds", "peak")}
    return {"rows": rows, "exponents": exponents}


def triangles(report: Path) -> int:
    """What the report counts."""
    return int(json.loads(report.read_text(encoding="utf-8"))["totals"]["triangles"])


def exponent(points: list[tuple[float, float]]) -> float:
    """The slope of a line through the logarithms: 1 is linear growth."""
    x, y = ([math.log(point[axis]) for point in points] for axis in (0, 1))
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    rise = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True))
    return rise / sum((a - mean_x) ** 2 for a in x)


def plot(part: dict[str, Any]) -> str:
    """Time and memory over triangles, both logarithmic, as SVG."""
    rows = [row for row in part["rows"] if row["failure"] is None]
    lines = [("seconds", "time, s", 1.0, "#c2410c"), ("peak", "peak memory, GB", 1e-9, "#1d4ed8")]
    values = [row[key] * scale for row in rows for key, _, scale, _ in lines]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    first, last = (round(math.log10(row["triangles"]), 3) for row in (rows[0], rows[-1]))

    def at(count: float, value: float) -> tuple[float, float]:
        across = (math.log10(count) - first) / (last - first)
        up = (math.log10(value) - low) / (high - low)
        return MARGIN + across * (WIDTH - 2 * MARGIN), HEIGHT - MARGIN - up * (HEIGHT - 2 * MARGIN)

    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" '
        'font-size="12"><rect width="100%" height="100%" fill="#fff"/>'
    ]
    for power in range(low, high + 1):
        _, y = at(rows[0]["triangles"], 10.0**power)
        parts.append(f'<path d="M{MARGIN} {y:.1f}H{WIDTH - MARGIN}" stroke="#ddd"/>')
        parts.append(f'<text x="{MARGIN - 8}" y="{y + 4:.1f}" text-anchor="end">{10.0**power:g}</text>')
    for row in rows:
        x, _ = at(row["triangles"], 10.0**low)
        label = f"{row['triangles'] / 1e6:.3g} M"
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - MARGIN + 18}" text-anchor="middle">{label}</text>')
    for number, (key, name, scale, color) in enumerate(lines):
        places = [at(row["triangles"], row[key] * scale) for row in rows]
        path = "L".join(f"{x:.1f} {y:.1f}" for x, y in places)
        parts.append(f'<path d="M{path}" fill="none" stroke="{color}" stroke-width="2"/>')
        label = f"{name}, growth {part['exponents'][key]:.2f}"
        parts.append(f'<text x="{MARGIN + 8}" y="{MARGIN + 16 * number}" fill="{color}">{label}</text>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 10}" text-anchor="middle">triangles</text></svg>')
    return "\n".join(parts) + "\n"
