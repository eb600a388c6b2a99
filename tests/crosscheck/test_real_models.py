"""Real files of other makers, baked and then held to verify.py like the gallery."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from test_import import bring, spec
from test_verify import VERIFY

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln

# Closed and open, one body and many, triangles and polygons, with seams, with faces that touch along edges.
FILES = [
    "obj/common_spot.obj.gz", "obj/common_suzanne.obj", "obj/common_teapot.obj.gz", "obj/common_cow.obj.gz",
    "obj/fuze.obj", "obj/rabbit.obj", "obj/quadknot.obj.gz", "obj/wallhole.obj", "obj/assimp_WusonOBJ.obj.gz",
    "obj/capsule.obj.gz", "obj/two_objects.obj", "obj/assimp_concave_polygon.obj",
    "stl/featuretype.STL.gz", "stl/angle_block.STL", "stl/multibody.stl", "stl/round.stl", "stl/soup.stl",
    "stl/teapot.stl", "csg/hull-body.obj.gz", "csg/Havocglass8_left.obj",
]  # fmt: skip


@pytest.mark.cases
def test_real_files_pass_every_tool(kiln: Kiln, cases: Path) -> None:
    for name in FILES:
        stem = name.rpartition("/")[2].partition(".")[0]
        kiln.bake(spec(bring(cases, name, kiln.folder)), name=f"{name.partition('/')[0]}-{stem}")
    done = subprocess.run(
        [sys.executable, str(VERIFY), str(kiln.folder / "out")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-6000:] + done.stderr[-2000:]
    findings = json.loads((kiln.folder / "out" / "verify.json").read_text(encoding="utf-8"))["findings"]
    assert len({finding["asset"] for finding in findings}) == len(FILES)
