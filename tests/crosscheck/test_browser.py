"""`scripts/engines/run.py`: what browsers show of files in all profiles that they read; and that it finds faults."""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kiln import Kiln

ROOT = Path(__file__).parents[2]
RUN = ROOT / "scripts" / "engines" / "run.py"
PROFILES = "core,quantized,web,three,babylon"
# Solids, what joints carry, what stands in many places at once, what is turned and levels of detail.
SPECS = ["solids/mug", "motion/arm", "garden/orchard", "levels/amphora"]


def run(out: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(RUN), str(out)], capture_output=True, text=True, timeout=500, check=False
    )


def test_browsers_show_what_blender_shows(kiln: Kiln) -> None:
    paths = [str(ROOT / "specs" / f"{spec}.toml") for spec in SPECS]
    out = kiln.folder / "out"
    done = kiln.run("bake", *paths, "--root", str(ROOT), "--out", str(out), "--profile", PROFILES)
    assert done.returncode == 0, done.stderr
    found = run(out)
    assert found.returncode == 0, found.stdout + found.stderr
    assert f"{len(SPECS) * 5} files in three and babylon" in found.stdout


def test_what_stands_elsewhere_is_found(kiln: Kiln) -> None:
    """A file is changed so that one of two balls stands elsewhere, its report says as before."""
    balls = "[shape.ball.sphere]\nradius = 1\n[node.a]\nshape = 'ball'\n[node.b]\nshape = 'ball'\nat = [3, 0, 0]\n"
    kiln.bake(balls, "--profile", "core,quantized")
    file = kiln.folder / "out" / "model.quantized.glb"
    assert run(file.parent).returncode == 0
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    node = next(node for node in document["nodes"] if node["name"] == "b")
    node["translation"][1] += 0.3
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    file.write_bytes(head + text + rest)
    found = run(file.parent)
    assert found.returncode == 1
    for engine in ("three", "babylon"):
        assert f"model.quantized.glb: {engine} covers" in found.stdout, found.stdout
