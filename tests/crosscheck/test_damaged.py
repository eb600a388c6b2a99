"""Files of other writers, cut off and with flipped bits: the program reads or refuses them, and nothing else."""

from __future__ import annotations

import json
import math
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import assimp
import numpy as np
import pymeshlab
import pytest
import trimesh

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kiln import Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"
CUTS, FLIPS = 9, 16
SHAPE = '[shape.s.import]\nfile = "{file}"\n'
MOVING = (
    SHAPE.replace("{file}", "lamp.md5mesh") + '[skeleton.k.import]\nfile = "lamp.md5mesh"\n[skin.m]\nshape = "s"\n'
    'skeleton = "k"\nweights = "imported"\n[clip.c.import]\nfile = "{file}"\n'
)
BVH = (
    '[shape.s.box]\nsize = [1, 1, 1]\n[skeleton.k.import]\nfile = "{file}"\n[skin.m]\nshape = "s"\nskeleton = "k"\n'
    'weights = "rigid"\n[clip.c.import]\nfile = "{file}"\n'
)


def ball(path: Path) -> None:
    """A bumpy ball as MeshLab writes it."""
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1.0, subdiv=2)
    meshes.compute_coord_by_function(x="x * (1 + 0.1 * sin(5 * y))", y="y", z="z * 1.5")
    meshes.save_current_mesh(str(path))


def by_assimp(path: Path) -> None:
    """The ball as assimp writes it."""
    source = path.with_name("source.ply")
    ball(source)
    assimp.export(source, path)


def by_trimesh(path: Path) -> None:
    """A ball with a picture as trimesh writes it."""
    made = trimesh.creation.icosphere(subdivisions=1)
    made.visual = trimesh.visual.TextureVisuals(
        made.vertices[:, :2], trimesh.visual.material.PBRMaterial(baseColorFactor=[200, 30, 40, 255])
    )
    path.write_bytes(trimesh.exchange.gltf.export_glb(made.scene()))


def of_gallery(path: Path) -> None:
    """What no other program here writes is an input of the gallery, which assimp reads as Kiln does."""
    for own in INPUTS.glob(f"{path.stem.split('-')[0]}*"):
        shutil.copy(own, path.parent / own.name)


def walker(path: Path) -> None:
    """A motion of a chain of three, as programs of animators write it."""
    turns = "Zrotation Xrotation Yrotation"
    joints = f"HIERARCHY\nROOT hips\n{{\nOFFSET 0 1 0\nCHANNELS 6 Xposition Yposition Zposition {turns}\n"
    joints += f"JOINT knee\n{{\nOFFSET 0 -0.5 0\nCHANNELS 3 {turns}\nEnd Site\n{{\nOFFSET 0 -0.5 0\n}}\n}}\n}}\n"
    rows = np.random.default_rng(3).normal(0, 10, (6, 9)).round(3)
    motion = f"MOTION\nFrames: {len(rows)}\nFrame Time: 0.04\n" + "\n".join(" ".join(map(str, row)) for row in rows)
    path.write_text(joints + motion + "\n", encoding="utf-8")


# What writes a file, its name, and a document that reads it.
SAMPLES = {
    "3ds by assimp": (by_assimp, "ball.3ds", SHAPE),
    "3ds by meshlab": (ball, "ball.3ds", SHAPE),
    "3ds scene": (of_gallery, "windmill.3ds", '[node.n.import]\nfile = "{file}"\n'),
    "dxf by meshlab": (ball, "ball.dxf", SHAPE),
    "ply by meshlab": (ball, "ball.ply", SHAPE),
    "ply by assimp": (by_assimp, "ball.ply", SHAPE),
    "obj by meshlab": (ball, "ball.obj", SHAPE),
    "stl by meshlab": (ball, "ball.stl", SHAPE),
    "glb by trimesh": (by_trimesh, "ball.glb", SHAPE),
    "md2": (of_gallery, "caterpillar.md2", SHAPE),
    "md3": (of_gallery, "beetle.md3", SHAPE),
    "md5 mesh": (of_gallery, "lamp.md5mesh", SHAPE),
    "md5 motion": (of_gallery, "lamp-bow.md5anim", MOVING),
    "bvh": (walker, "walk.bvh", BVH),
}


def damages(data: bytes) -> Iterator[tuple[str, bytes]]:
    """The file cut off, and with one bit changed, at places that each run has alike; more of them near its start."""
    chance = np.random.default_rng(len(data))
    for end in sorted({0, 1, len(data) - 1, *(chance.uniform(0, 1, CUTS) * len(data)).astype(int).tolist()}):
        yield f"cut at {end}", data[:end]
    for at in (chance.uniform(0, 1, FLIPS) ** 3 * len(data)).astype(int).tolist():
        bit = int(chance.integers(0, 8))
        yield f"bit {bit} of byte {at}", data[:at] + bytes([data[at] ^ (1 << bit)]) + data[at + 1 :]


def numbers(value: Any) -> Iterator[float]:
    """All numbers of a report."""
    if isinstance(value, dict):
        for one in value.values():
            yield from numbers(one)
    elif isinstance(value, list):
        for one in value:
            yield from numbers(one)
    elif isinstance(value, (int, float)):
        yield value


@pytest.mark.parametrize("sample", SAMPLES)
def test_damaged_files_are_read_or_refused(kiln: Kiln, sample: str) -> None:
    """A refusal names the file and writes nothing; what is read has finite numbers."""
    write, name, spec = SAMPLES[sample]
    path = kiln.folder / name
    write(path)
    data = path.read_bytes()
    kiln.write(spec.replace("{file}", name))
    whole = kiln.run("bake", "model.toml", "--out", "out")
    assert whole.returncode == 0, whole.stderr
    refused = 0
    for what, damaged in damages(data):
        shutil.rmtree(kiln.folder / "out", ignore_errors=True)
        path.write_bytes(damaged)
        done = kiln.run("bake", "model.toml", "--out", "out")
        assert done.returncode in (0, 1), (what, done.returncode, done.stderr)
        assert "panicked" not in done.stderr, (what, done.stderr)
        report = kiln.folder / "out" / "model.report.json"
        if done.returncode == 0:
            found = json.loads(report.read_text(encoding="utf-8"))
            assert all(math.isfinite(number) for number in numbers(found)), what
            continue
        refused += 1
        assert re.search(r"error\[K\d{4}\]", done.stderr), (what, done.stderr)
        assert name in done.stderr, (what, done.stderr)
        assert not report.exists(), what
        assert not (kiln.folder / "out" / "model.glb").exists(), what
    assert refused >= 3, refused
