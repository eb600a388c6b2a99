"""Height maps: dense grids on every base, rough and flat, and ground within a tolerance beside pydelatin.

Every map comes from a raw file of 32-bit numbers. Dense work is all samples to a file without a report.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import NDArray

DENSE = 2049
GROUND = 1024
RANGE = 100.0
ERRORS = (0.5, 0.1)

BASES = {
    "plane, rough": ("rough", "size = [2, 1]"),
    "plane, flat": ("flat", "size = [2, 1]"),
    "sphere": ("rough", "on = { sphere = { radius = 1, latitude = [80, -80] } }"),
    "ellipsoid": ("rough", "on = { ellipsoid = { radii = [1, 0.8, 1.2], latitude = [80, -80] } }"),
    "cylinder": ("rough", "on = { cylinder = { radius = 1, height = 2 } }"),
}


def ground(count: int, seed: int = 1) -> NDArray[np.float32]:
    """Hills by chance over 0 to 100: a spectrum that falls with the square of the frequency."""
    chance = np.random.default_rng(seed)
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(count), np.fft.rfftfreq(count), indexing="ij"))
    waves[0, 0] = 1
    spectrum = chance.normal(size=waves.shape) + 1j * chance.normal(size=waves.shape)
    heights = np.fft.irfft2(spectrum / waves**2, (count, count))
    low, high = heights.min(), heights.max()
    return ((heights - low) / (high - low) * RANGE).astype("<f4")


def measure(kiln: Path, peer: list[str], folder: Path, runs: int, tell: Callable[[str], None]) -> dict[str, Any]:
    """Times of dense grids set against the rough plane, and triangles and times of ground beside the peer."""
    (folder / "rough.raw").write_bytes((ground(DENSE, 2) / RANGE / 20).astype("<f4").tobytes())
    (folder / "flat.raw").write_bytes(np.zeros((DENSE, DENSE), "<f4").tobytes())
    heights = ground(GROUND)
    (folder / "ground.raw").write_bytes(heights.tobytes())
    np.save(folder / "ground.npy", heights)
    dense = [dense_runs(kiln, folder, name, *BASES[name]) for name in BASES]
    together(dense, runs, folder, tell)
    base = next((entry.median for entry in dense if entry.failure is None), None)
    rows = [row(entry, base, DENSE**2) for entry in dense]
    for error in ERRORS:
        entries = [ground_runs(kiln, folder, bound, error) for bound in ("samples", "surface")]
        out = folder / f"pydelatin-{error}.glb"
        entries.append(Runs("pydelatin", [*peer, str(folder / "ground.npy"), str(error), str(out)], out))
        together(entries, runs, folder, tell)
        other = entries[-1].median if entries[-1].failure is None else None
        for entry in entries:
            made = row(entry, other, GROUND**2)
            made["tool"] = f"{made['tool']}, error {error} of {RANGE:g}"
            if entry.failure is None:
                made["triangles"] = triangles(entry.output)
            rows.append(made)
    return {"rows": rows}


def dense_runs(kiln: Path, folder: Path, name: str, heights: str, base: str) -> Runs:
    """All samples of a map on a base."""
    stem = "dense-" + name.replace(", ", "-")
    (folder / f"{stem}.toml").write_text(
        f'[limits]\nimage-pixels = 20000000\n[map.m.raw]\nfile = "{heights}.raw"\ncolumns = {DENSE}\nrows = {DENSE}\n'
        f'number = "f32"\n[shape.a.height-map]\nmap = "m"\nbound = "dense"\n{base}\n',
        encoding="utf-8",
    )
    line = [str(kiln), "bake", f"{stem}.toml", "--out", "dense", "--quiet", "--no-report"]
    return Runs(name, line, folder / "dense" / f"{stem}.glb")


def ground_runs(kiln: Path, folder: Path, bound: str, error: float) -> Runs:
    """Ground within an error, at the samples or everywhere."""
    stem = f"ground-{bound}-{error}"
    (folder / f"{stem}.toml").write_text(
        f'tolerance = {error}\n[map.m.raw]\nfile = "ground.raw"\ncolumns = {GROUND}\nrows = {GROUND}\nnumber = "f32"\n'
        f'[shape.a.height-map]\nmap = "m"\nsize = [{GROUND - 1}, {GROUND - 1}]\nbound = "{bound}"\n',
        encoding="utf-8",
    )
    line = [str(kiln), "bake", f"{stem}.toml", "--out", "ground", "--quiet", "--no-report"]
    return Runs(f"Kiln, {bound}", line, folder / "ground" / f"{stem}.glb")


def row(entry: Runs, base: float | None, samples: int) -> dict[str, Any]:
    """One line of the table."""
    done = entry.failure is None
    return {
        "tool": entry.name,
        "failure": entry.failure,
        "seconds": entry.median if done else None,
        "peak": entry.peak if done else None,
        "samples": samples,
        "times": entry.median / base if done and base else None,
    }


def triangles(path: Path) -> int:
    """The triangles of a binary glTF file by its JSON."""
    data = path.read_bytes()
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    accessors = document["accessors"]
    parts = [part for mesh in document["meshes"] for part in mesh["primitives"]]
    return sum(accessors[part["indices"]]["count"] // 3 for part in parts)
