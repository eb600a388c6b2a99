"""The `gallery` part of the bench: every spec of the gallery by itself, and all of them on two cores."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

JOBS = "2"


def measure(kiln: Path, specs: Path, folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Time and memory of each whole process; rows are ordered by time, the whole gallery comes first."""
    out = folder / "gallery"

    def entry(name: str, documents: Path) -> Runs:
        line = [str(kiln), "bake", str(documents), "--out", str(out / name), "--jobs", JOBS, "--quiet"]
        return Runs(name, line, out / name)

    documents = sorted(path for path in specs.rglob("*.toml"))
    single = [entry(str(path.relative_to(specs).with_suffix("")), path) for path in documents]
    every = entry("all", specs)
    together([every, *single], runs, specs.parent, tell)
    rows = [row(one) for one in single if one.failure or list(one.output.rglob("*.glb"))]
    rows.sort(key=lambda one: -(one["seconds"] or 0.0))
    return {"rows": [row(every), *rows]}


def row(entry: Runs) -> dict[str, Any]:
    """The figures of one command: its time, its memory and what it wrote."""
    done = entry.failure is None
    written = list(entry.output.rglob("*.glb"))
    return {
        "asset": entry.name,
        "failure": entry.failure,
        "seconds": entry.median if done else None,
        "peak": entry.peak if done else None,
        "files": len(written),
        "bytes": sum(path.stat().st_size for path in written),
    }
