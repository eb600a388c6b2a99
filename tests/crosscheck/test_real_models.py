"""Real files of other makers, all there are: baked or refused with a reason, optimized, held to verify.py."""

from __future__ import annotations

import gzip
import json
import re
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from PIL import Image
from test_verify import VERIFY

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kiln import Kiln

MESHES = {"obj", "stl", "gltf", "glb", "md2"}
HEIGHTS = {"asc", "png"}
# Broken on purpose, by their folder.
BROKEN = {"hostile", "bad"}
# Files without faces, or whose triangles all have no area, which single precision cannot tell apart.
EMPTY = {
    "assimp_point_cloud", "face_in_group_name", "obj_empty", "obj_points", "stl_empty_ascii", "assimp_number_formats",
    "Cray_right", "Mesh_PrimitiveMode_00", "Mesh_PrimitiveMode_02", "Mesh_PrimitiveMode_08", "Mesh_PrimitiveMode_10",
}  # fmt: skip
# Baked, and not held against the tools: trimesh cannot join primitives of which some have no material, and MeshLab
# counts two borders that touch in a point as one.
APART = {"gltf/bevy_animations.gltf", "stl/assimp_Spider_ascii.stl.gz"}


def plain(path: Path) -> str:
    """The name of a file without what packs it."""
    return path.name.removesuffix(".gz")


def found(cases: Path) -> list[Path]:
    """The files, those of folders that hold other things left out."""
    every = [path for path in sorted(cases.rglob("*")) if path.is_file()]
    kinds = [(path, plain(path).rpartition(".")[2].lower()) for path in every]
    meshes = [path for path, kind in kinds if kind in MESHES]
    grounds = [(path, kind) for path, kind in kinds if path.parent.name == "height" and "mask" not in path.name]
    return meshes + [path for path, kind in grounds if kind in HEIGHTS]


def spec(folder: Path, file: str) -> str:
    """A document that shows a file."""
    kind = file.rpartition(".")[2].lower()
    if kind == "asc":
        map_ = f'{{ grid = {{ file = "{file}" }}, no-data = "marked" }}'
        return f"tolerance = 20\n[shape.s.height-map]\nmap = {map_}\nsize = [1000, 1000]\n"
    if kind == "png":
        across, down = Image.open(folder / file).size
        return (
            f'tolerance = 20\n[shape.s.height-map]\nmap = {{ image = {{ file = "{file}" }} }}\n'
            f"size = [{across}, {down}]\nrange = [0, 300]\n"
        )
    return f'[shape.s.import]\nfile = "{file}"\n'


def place(cases: Path, path: Path, folder: Path) -> str:
    """Put a file, and what it may open, where documents are; its path from there."""
    home = folder / "-".join(path.relative_to(cases).parent.parts)
    home.mkdir(exist_ok=True)
    for beside in path.parent.iterdir():
        if beside.suffix in {".bin", ".mtl"} or beside == path:
            data = beside.read_bytes()
            (home / plain(beside)).write_bytes(gzip.decompress(data) if beside.suffix == ".gz" else data)
    return f"{home.name}/{plain(path)}"


@pytest.mark.cases
def test_real_models_pass_every_tool(kiln: Kiln, cases: Path, tried: Callable[[str, int], None]) -> None:
    refused, baked, optimized, wrong = 0, 0, 0, []
    files = found(cases)
    for path in files:
        broken = bool(BROKEN & set(path.relative_to(cases).parts)) or path.name.startswith("bad_")
        file = place(cases, path, kiln.folder)
        name = re.sub("[^a-z0-9]+", "-", file.lower()).strip("-")
        kiln.write(spec(kiln.folder, file), name=name)
        done = kiln.run("bake", f"{name}.toml", "--out", "out")
        if done.returncode == 1:
            refused += 1
            if "panicked" in done.stderr or not re.search(r"error\[K\d{4}\]", done.stderr):
                wrong.append(f"{file}: {done.stderr[:400]}")
            elif not broken and path.name.partition(".")[0] not in EMPTY:
                wrong.append(f"{file}: refused: {done.stderr[:400]}")
        elif done.returncode == 0 and str(path.relative_to(cases)) in APART:
            (kiln.folder / "out" / f"{name}.glb").unlink()
        elif done.returncode == 0:
            baked += 1
        else:
            wrong.append(f"{file}: {done.returncode}: {done.stderr[:400]}")
        if plain(path).rpartition(".")[2].lower() in {"gltf", "glb"}:
            done = kiln.run("optimize", file, "-o", f"optimized/{name}.glb")
            optimized += done.returncode == 0
            if done.returncode not in ((0, 1) if broken else (0,)) or "panicked" in done.stderr:
                wrong.append(f"{file}: optimize: {done.stderr[:400]}")
    assert not wrong, "\n".join(wrong)
    done = subprocess.run(
        [sys.executable, str(VERIFY), str(kiln.folder / "out")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    findings = json.loads((kiln.folder / "out" / "verify.json").read_text(encoding="utf-8"))["findings"]
    assert len({finding["asset"] for finding in findings}) == baked
    tried("real-models", len(files))
    tried("real-models-baked", baked)
    tried("real-models-optimized", optimized)
