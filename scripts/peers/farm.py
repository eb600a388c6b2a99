"""The `farm` part of the bench: a thousand documents, anew, from the cache, and when nothing is left to do."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING, Any

from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

DOCUMENTS = 1000


def write(specs: Path) -> None:
    """Small documents that all differ."""
    for number in range(DOCUMENTS):
        folder = specs / f"{number // 100:02}"
        folder.mkdir(parents=True, exist_ok=True)
        points = f"[[0, 0], [{1 + number / 1000}, 0], [0.4, 2]]"
        text = f"[shape.part.revolve]\nprofile = {{ polyline = {{ points = {points} }} }}\n"
        (folder / f"part-{number:03}.toml").write_text(text, encoding="utf-8")


def measure(kiln: Path, ninja: Path, folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Cold bakes on one and two jobs, then no-ops of Kiln and of Ninja on the same graph, in turn."""
    specs = folder / "farm"
    write(specs)
    bake = [str(kiln), "bake", "farm", "--quiet"]
    cold = []
    for jobs in ("1", "2"):
        out = folder / f"farm-{jobs}"
        cold.append(Runs(f"Kiln, anew, {jobs} jobs", [*bake, "--jobs", jobs, "--out", out.name], out / "none"))
    together(cold, runs, folder, tell)
    cached = [*bake, "--out", "farm-cached", "--cache", "farm-cache"]
    subprocess.run(cached, cwd=folder, check=True)
    plan = [str(kiln), "plan", "farm", "--out", "farm-ninja", "--as", "ninja"]
    text = subprocess.run(plan, cwd=folder, check=True, capture_output=True, text=True).stdout
    text = text.replace("bake = kiln ", f"bake = {kiln} ")
    (folder / "farm.ninja").write_text(text, encoding="utf-8")
    line = [str(ninja), "-f", "farm.ninja", "--quiet"]
    if ninja.is_file():
        subprocess.run(line, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    nothing = [
        Runs("Kiln, nothing to do", cached, folder / "none"),
        Runs("Ninja, nothing to do", line, folder / "none"),
    ]
    together(nothing, 4 * runs, folder, tell)
    rows = [
        {
            "work": entry.name,
            "failure": entry.failure,
            "seconds": entry.median if entry.failure is None else None,
            "cpu": sorted(entry.cpu)[len(entry.cpu) // 2] if entry.failure is None else None,
        }
        for entry in [*cold, *nothing]
    ]
    for row in rows:
        base = rows[-1]["seconds"]
        row["times-ninja"] = row["seconds"] / base if base and row["seconds"] and "nothing" in row["work"] else None
    return {"rows": rows}
