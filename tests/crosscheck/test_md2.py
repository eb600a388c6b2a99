"""Quake II models held against their bytes, unpacked here field by field."""

from __future__ import annotations

import gzip
import json
import shutil
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from checks import played

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kiln import Baked, Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"
REAL = ["dolphin.md2", "sydney.md2"]


class Model:
    """A file's frames, faces and texture coordinates; z up as in the file."""

    def __init__(self, data: bytes) -> None:
        header = struct.unpack_from("<17i", data)
        width, height, size, _, points, places, triangles, _, frames = header[2:11]
        self.rows = np.frombuffer(data, "<u2", triangles * 6, header[13]).reshape(-1, 6)
        at = np.frombuffer(data, "<i2", places * 2, header[12]).reshape(-1, 2)
        self.places = at / np.array([width, height])
        self.names, self.frames = [], []
        for start in range(header[14], header[14] + frames * size, size):
            numbers = np.frombuffer(data, "<f4", 6, start).astype(float)
            packed = np.frombuffer(data, "u1", points * 4, start + 40).reshape(-1, 4)
            self.names.append(data[start + 24 : start + 40].split(b"\0")[0].decode())
            self.frames.append(packed[:, :3] * numbers[:3] + numbers[3:])


def up(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """From z up to y up."""
    return points[:, [0, 2, 1]] * np.array([1.0, 1.0, -1.0])


def baked(kiln: Kiln, source: Path, extra: str = "") -> tuple[Baked, Model]:
    """A model at a hundredth of its size, and what stands in the file."""
    shutil.copy(source, kiln.folder / source.name)
    spec = f'[shape.m]\nuv = "always"\n[shape.m.import]\nfile = "{source.name}"\nscale = 0.01\n{extra}'
    return kiln.bake(spec, name=source.stem), Model(source.read_bytes())


def rounded(rows: NDArray[np.float64]) -> set[tuple[int, ...]]:
    """Rows that differ by more than rounding."""
    return {tuple(row) for row in np.round(rows * 2e3).astype(int).tolist()}


def check(made: Baked, model: Model) -> None:
    """Every frame's points, faces and places on the picture."""
    mesh = made.document.meshes[0]
    assert len(mesh.targets) == len(model.frames) - 1
    attributes = mesh.surfaces[0].attributes
    first = up(model.frames[0]) / 100
    for number, target in enumerate(mesh.targets, start=1):
        moved = up(model.frames[number]) / 100
        places = mesh.positions + target.attributes["POSITION"]
        # Each corner is a point of the file with its place on the picture, here and there.
        corners, at = model.rows[:, :3].ravel(), model.rows[:, 3:].ravel()
        wanted = rounded(np.hstack([first[corners], moved[corners], model.places[at]]))
        found = rounded(np.hstack([mesh.positions, places, attributes["TEXCOORD_0"]]))
        away = found ^ wanted
        # Halves may round to either side.
        assert len(away) <= 0.05 * len(wanted), (number, len(away), len(wanted))
    volume = np.einsum(
        "ij,ij->i",
        mesh.positions[mesh.triangles[:, 0]],
        np.cross(*(mesh.positions[mesh.triangles[:, k]] for k in (1, 2))),
    )
    assert volume.sum() > 0, "triangles look outward"


def check_clips(made: Baked, model: Model, sequences: dict[str, range]) -> None:
    """At the times of its frames a clip shows them, and halfway between their means."""
    stage = played.Stage(made.document)
    names = {one["name"]: one for one in made.document.json["animations"]}
    assert set(names) == set(sequences)
    mesh = made.document.meshes[0]
    vertices = list(range(0, len(mesh.positions), 7))
    first = up(model.frames[0]) / 100
    # A vertex may be any point of the file that stands where it does in the first frame.
    numbers = [np.flatnonzero(np.linalg.norm(first - mesh.positions[v], axis=1) < 1e-5) for v in vertices]
    for name, frames in sequences.items():
        for step, share in ((0, 0.0), (len(frames) // 2, 0.0), (0, 0.5)):
            if share and len(frames) < 2:
                continue
            time = (step + share) / 10
            question = {"time": time + 1e-9, "nodes": [], "vertices": {"m": [{"vertex": v} for v in vertices]}}
            found = np.array(stage.pose(names[name], question)["vertices"]["m"])
            there = [up(model.frames[frames[min(step + k, len(frames) - 1)]]) / 100 for k in (0, 1)]
            wanted = there[0] * (1 - share) + there[1] * share
            size = np.ptp(wanted, axis=0).max()
            for at, own in zip(found, numbers, strict=True):
                near = np.linalg.norm(wanted[own] - at, axis=1).min()
                assert near < 2e-4 * size, (name, time, near)


def test_the_caterpillar_is_its_file(kiln: Kiln) -> None:
    """The gallery's own model: names, frames, clips."""
    made, model = baked(kiln, INPUTS / "caterpillar.md2", 'loop = ["run", "stand"]\n')
    check(made, model)
    counts = {
        name: [k for k, own in enumerate(model.names) if own.rstrip("0123456789") == name]
        for name in ("stand", "run", "jump")
    }
    check_clips(made, model, {name: range(own[0], own[-1] + 1) for name, own in counts.items()})
    clips = made.report["clips"]
    assert clips["run"]["duration"] == pytest.approx(len(counts["run"]) / 10)
    assert clips["jump"]["duration"] == pytest.approx((len(counts["jump"]) - 1) / 10)
    looped = {one["name"]: (one.get("extras") or {}).get("loop") for one in made.document.json["animations"]}
    assert looped == {"stand": True, "run": True, "jump": None}


@pytest.mark.cases
@pytest.mark.parametrize("name", REAL)
def test_real_models_are_their_files(kiln: Kiln, cases: Path, name: str) -> None:
    """Frames of points and their clips."""
    facts = json.loads(gzip.decompress((cases / "md2" / "md2_facts.json.gz").read_bytes()))[name]
    made, model = baked(kiln, cases / "md2" / name)
    assert model.names == facts["frame_names"]
    check(made, model)
    sequences: dict[str, list[int]] = {}
    for number, frame in enumerate(model.names):
        sequences.setdefault(frame.rstrip("0123456789"), []).append(number)
    check_clips(made, model, {name: range(own[0], own[-1] + 1) for name, own in sequences.items()})


@pytest.mark.cases
def test_a_player_has_standard_sequences(kiln: Kiln, cases: Path) -> None:
    """Twenty of the twenty-one names, by their places."""
    made, _ = baked(kiln, cases / "md2" / "sydney.md2", 'sequences = "standard"\nframe = "run003"\n')
    clips = made.report["clips"]
    assert len(clips) == 20
    assert list(clips)[:4] == ["stand", "run", "attack", "pain-a"]
    assert clips["stand"]["duration"] == pytest.approx(3.9)
    assert clips["death-fall-back-slow"]["duration"] == pytest.approx(0.7)


@pytest.mark.cases
def test_broken_files_are_refused(kiln: Kiln, cases: Path) -> None:
    """Each with a code and what is wrong; nothing is written."""
    files = [*(cases / "hostile" / "md2").glob("*.md2"), *(cases / "md2").glob("bad*.md2")]
    assert len(files) >= 5
    for file in files:
        shutil.copy(file, kiln.folder / file.name)
        kiln.write(f'[shape.m.import]\nfile = "{file.name}"\n', name="broken")
        done = kiln.run("bake", "broken.toml", "--out", "out")
        good = file.name.startswith("good")
        assert done.returncode == (0 if good else 1), (file.name, done.stderr)
        assert good or "error[K0851]" in done.stderr, done.stderr
        assert "panic" not in done.stderr
