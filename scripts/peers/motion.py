"""Motion: weights by heat beside Blender's automatic weights.

A winding tube of 50 000 points with a chain of 50 bones inside. Both tools read the same points and triangles. What the
weights take is the whole bake with them less the same bake with the nearest bone; Blender times its operator itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

AROUND, ALONG, BONES = 100, 500, 50
RADIUS = 0.15


def middle(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """The line that the tube and its bones follow."""
    return np.stack([np.sin(share * 9.0), 6.0 * share - 3.0, 0.5 * np.cos(share * 7.0)], axis=-1)


def tube() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points and triangles, open at both ends."""
    share = np.linspace(0.0, 1.0, ALONG)
    turn = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    ring = np.stack([np.cos(turn), np.zeros(AROUND), np.sin(turn)], axis=-1) * RADIUS
    points = (middle(share)[:, None] + ring).reshape(-1, 3)
    row, column = np.meshgrid(np.arange(ALONG - 1), np.arange(AROUND), indexing="ij")
    a, b = row * AROUND + column, row * AROUND + (column + 1) % AROUND
    c, d = a + AROUND, b + AROUND
    corners = np.stack([np.stack([a, c, b], -1), np.stack([b, c, d], -1)], axis=2)
    return points, corners.reshape(-1, 3)


def measure(kiln: Path, peer: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Whole processes, and what the weights alone take."""
    points, triangles = tube()
    ends = middle(np.linspace(0.0, 1.0, BONES + 1))
    np.savez(folder / "tube.npz", points=points, triangles=triangles, heads=ends[:-1], tails=ends[1:])
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles.tolist()]
    (folder / "tube.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    entries = {rule: baking(kiln, folder, rule, ends) for rule in ("heat", "rigid")}
    out = folder / "blender-weights.npz"
    blender = Runs("Blender", [*peer, str(folder / "tube.npz"), str(out)], out)
    together([*entries.values(), blender], runs, folder, tell)
    heat, rigid = entries["heat"], entries["rigid"]
    failure = heat.failure or rigid.failure
    alone = None if failure else heat.median - rigid.median
    other = float(np.load(out)["seconds"]) if blender.failure is None else None
    rows = [
        {"tool": "Kiln", "failure": failure, "seconds": heat.median if failure is None else None, "weights": alone},
        {"tool": "Blender", "failure": blender.failure, "seconds": None, "weights": other},
    ]
    if blender.failure is None:
        rows[1]["seconds"] = blender.median
    if alone is not None and other is not None:
        rows[0]["of-blender"] = alone / other
    return {"rows": rows}


def baking(kiln: Path, folder: Path, rule: str, ends: NDArray[np.float64]) -> Runs:
    """The tube with weights by a rule, without a report."""
    chain = ", ".join(str(point) for point in ends.tolist())
    spec = f"""[shape.tube.import]
file = "tube.obj"
[skeleton.s.chain.c]
points = [{chain}]
[skin.k]
shape = "tube"
skeleton = "s"
weights = "{rule}"
"""
    (folder / f"tube-{rule}.toml").write_text(spec, encoding="utf-8")
    out = folder / f"tube-{rule}"
    line = [str(kiln), "bake", f"tube-{rule}.toml", "--out", str(out), "--quiet", "--no-report"]
    return Runs(f"Kiln, {rule}", line, out / f"tube-{rule}.glb")
