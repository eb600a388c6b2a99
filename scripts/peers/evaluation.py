"""The `curves` part of the bench: how long a point with its first derivative takes, beside scipy and geomdl."""

from __future__ import annotations

import json
import statistics
import subprocess
from typing import TYPE_CHECKING, Any

from peers import curves

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

POINTS = 1_000_000
CHECKED = 50  # steps at which peers must agree with Kiln before they are timed


def measure(kiln: Path, peer: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Nanoseconds a point of each curve: Kiln and the peers in turn, medians of all rounds."""
    (folder / "curves.toml").write_text(curves.document(), encoding="utf-8")
    samples = folder / "samples.json"
    names = list(curves.families())
    samples.write_text(json.dumps({name: sampled(kiln, folder, name, "--count", str(CHECKED)) for name in names}))
    rounds: list[dict[str, dict[str, Any]]] = []
    for number in range(runs):
        tell(f"round {number + 1} of {runs}: curves")
        own = {name: sampled(kiln, folder, name, "--count", str(POINTS - 1), "--time") for name in names}
        found = folder / "peer-curves.json"
        subprocess.run([*peer, str(samples), str(POINTS), str(found)], check=True, cwd=folder)
        others = json.loads(found.read_text(encoding="utf-8"))
        rounds.append({name: {"kiln": own[name]["nanoseconds"], **others[name]} for name in names})
    return {"rows": [row(name, [one[name] for one in rounds]) for name in names]}


def sampled(kiln: Path, folder: Path, name: str, *more: str) -> dict[str, Any]:
    """What `kiln sample` says of a curve."""
    line = [str(kiln), "sample", "curves.toml", "--curve", name, *more]
    done = subprocess.run(line, cwd=folder, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def row(name: str, rounds: list[dict[str, float | None]]) -> dict[str, Any]:
    """Medians of one curve and how many times longer the peers take."""
    found: dict[str, Any] = {"curve": name}
    for tool in ("kiln", "scipy", "geomdl"):
        times = [one[tool] for one in rounds if one[tool] is not None]
        found[tool] = statistics.median(times) if times else None
    for tool in ("scipy", "geomdl"):
        found[f"{tool}-times-kiln"] = found[tool] / found["kiln"] if found[tool] else None
    return found
