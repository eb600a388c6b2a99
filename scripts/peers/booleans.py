"""Booleans: one ball of 100 352 triangles without another, from nothing to a file.

Every tool makes its own balls, all of the same number of triangles, and writes a binary glTF file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SPEC = """[shape.a]
segments = [224, 225]
[shape.a.sphere]
radius = 1
[shape.b]
segments = [224, 225]
at = [0.7, 0.2, 0.1]
[shape.b.sphere]
radius = 1
[shape.c.difference]
of = ["a", "b"]
"""


def measure(
    kiln: Path, peers: list[tuple[str, list[str]]], folder: Path, runs: int, tell: Callable[[str], None]
) -> dict[str, Any]:
    """The times of all tools in turn, and Kiln's share of the fastest other."""
    (folder / "booleans.toml").write_text(SPEC, encoding="utf-8")
    entries = []
    for name, extra in (("Kiln", []), ("Kiln, no report", ["--no-report"])):
        out = folder / name.replace(", ", "-").replace(" ", "-").lower()
        line = [str(kiln), "bake", "booleans.toml", "--out", str(out), "--quiet", *extra]
        entries.append(Runs(name, line, out / "booleans.glb"))
    for name, line in peers:
        out = folder / f"booleans-{name}.glb"
        entries.append(Runs(name, [*line, str(out)], out))
    together(entries, runs, folder, tell)
    others = [entry.median for entry in entries[2:] if entry.failure is None]
    rows = []
    for entry in entries:
        done = entry.failure is None
        row = {"tool": entry.name, "failure": entry.failure, "seconds": entry.median if done else None}
        row["cpu"] = sorted(entry.cpu)[len(entry.cpu) // 2] if done else None
        row["peak"] = entry.peak if done else None
        row["of-fastest"] = entry.median / min(others) if done and others else None
        rows.append(row)
    return {"rows": rows}
