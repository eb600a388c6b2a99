"""Real OBJ and STL files, against the facts that trimesh found in them."""

from __future__ import annotations

import gzip
import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln


def facts(cases: Path) -> dict[str, dict[str, Any]]:
    """What trimesh found in each file."""
    text = gzip.decompress((cases / "mesh" / "import_facts.json.gz").read_bytes())
    return json.loads(text)["files"]


def bring(cases: Path, name: str, folder: Path) -> str:
    """Copy a case into the project, unpacked; returns its file name."""
    data = (cases / name).read_bytes()
    plain = name.removesuffix(".gz").rpartition("/")[2]
    (folder / plain).write_bytes(gzip.decompress(data) if name.endswith(".gz") else data)
    return plain


def spec(file: str, more: str = "") -> str:
    return f'[shape.s.import]\nfile = "{file}"\nup = "y"\n{more}'


# Files that have no face: there is nothing to write, and the message says so.
NO_FACE = {
    "obj/assimp_point_cloud.obj", "obj/face_in_group_name.obj", "obj/obj_empty.obj", "obj/obj_points.obj",
    "stl/stl_empty_ascii.stl",
}  # fmt: skip
# Corners that name a vertex beyond the last one.
BROKEN = {"obj/bad/malformed.obj"}
# The distance within which the facts count points of an STL file as one.
MERGED = "weld = 1e-8\n"
# All triangles of this file have no area.
FLAT = {"obj/assimp_number_formats.obj", "csg/Cray_right.obj"}
# Faces with repeated corners or concave outlines, where fans (the facts' way) measure something else.
NOT_FANS = {
    "obj/assimp_box_longline.obj", "obj/assimp_concave_polygon.obj", "obj/wallhole.obj", "obj/rabbit.obj",
}  # fmt: skip


def wanted(found: dict[str, Any]) -> bool:
    return "merged_vertices" in found


@pytest.mark.cases
def test_real_files_measure_as_trimesh_does(kiln: Kiln, cases: Path) -> None:
    wrong, read = [], 0
    for name, found in facts(cases).items():
        if name in FLAT | BROKEN | NO_FACE or not wanted(found):
            continue
        kiln.write(spec(bring(cases, name, kiln.folder), MERGED if name.startswith("stl/") else ""))
        done = kiln.run("bake", "model.toml", "--out", "out")
        if done.returncode != 0:
            wrong.append(f"{name}: {done.stderr.splitlines()[0]}")
            continue
        asset = kiln.baked()
        read += 1
        shape = asset.shape("s")
        wrong += [f"{name}: {text}" for text in differences(name, shape, found)]
    assert not wrong, "\n".join(wrong)
    assert read >= 45


def differences(name: str, shape: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """In what a report and the facts disagree."""
    low, high = np.array(found["bounds"])
    size = float(np.linalg.norm(high - low))
    reach = float(np.abs([low, high]).max())
    wrong = []
    for key, value in (("min", low), ("max", high)):
        if np.abs(np.array(shape["bounds"][key]) - value).max() > 1e-6 * reach:
            wrong.append(f"bounds {shape['bounds']} {found['bounds']}")
    if name not in NOT_FANS:
        folded = 1e-3 if set(found.get("face_sizes", {"3": 0})) != {"3"} else 1e-5
        if abs(shape["area"] - found["area"]) > folded * found["area"]:
            wrong.append(f"area {shape['area']} {found['area']}")
        solid = found["watertight"] and found["winding_consistent"]
        if solid and not shape["closed"]:
            wrong.append("is not closed")
        elif solid and "volume" in found:
            off = abs(abs(shape["volume"]) - abs(found["volume"]))
            if off > folded * abs(found["volume"]) + 1e-6 * found["area"] * size:
                wrong.append(f"volume {shape['volume']} {found['volume']}")
    return wrong


@pytest.mark.cases
def test_files_without_faces_are_refused_by_name(kiln: Kiln, cases: Path) -> None:
    for name in sorted(NO_FACE | BROKEN):
        file = bring(cases, name, kiln.folder)
        kiln.write(spec(file))
        done = kiln.run("bake", "model.toml")
        assert done.returncode in (1, 3), name
        assert file in done.stdout + done.stderr, name
        assert "panicked" not in done.stderr, name


@pytest.mark.cases
def test_scale_and_axis_of_an_import(kiln: Kiln, cases: Path) -> None:
    file = bring(cases, "stl/7_8ths_cube.stl", kiln.folder)
    shape = kiln.bake(f'[shape.s.import]\nfile = "{file}"\nscale = 0.001\n').shape("s")
    assert shape["volume"] == pytest.approx(55999.996e-9, rel=1e-5)
    np.testing.assert_allclose(shape["bounds"]["min"], [-0.02, -0.02, -0.02], atol=1e-7)


@pytest.mark.cases
def test_smoothing_groups_of_an_obj_are_kept(kiln: Kiln) -> None:
    """Two roofs that bend alike: one lies in one group, the other in two."""
    points = ["-1 0 {z}", "-1 0 {w}", "0 1 {z}", "0 1 {w}", "1 0 {z}", "1 0 {w}"]
    lines = [f"v {p.format(z=z, w=z + 1)}" for z in (0, 5) for p in points]
    lines += ["s 1", "f 1 2 4 3", "f 3 4 6 5", "s 2", "f 7 8 10 9", "s 3", "f 9 10 12 11"]
    (kiln.folder / "roofs.obj").write_text("\n".join(lines) + "\n")
    assert kiln.bake(spec("roofs.obj")).shape("s")["vertices"] == 6 + 8
