"""Drawings (DXF) held against what was drawn, against trimesh, and against meshes that pymeshlab and assimp know."""

from __future__ import annotations

import math
import shutil
import struct
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import assimp
import numpy as np
import pymeshlab
import pytest
import trimesh

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

from inputs import plate  # noqa: E402 -- after the path is set

if TYPE_CHECKING:
    from kiln import Kiln

AREA = 120 * 80 - (4 - math.pi) * 100
HOLES = 4 * math.pi * 16
SLOT = 30 * 10 + math.pi * 25


def binary(pairs: list[tuple[int, object]], *, short: bool) -> bytes:
    """A drawing in binary: codes of two bytes, or of one as before 1994."""
    data = b"AutoCAD Binary DXF\r\n\x1a\0"
    for code, value in pairs:
        data += (struct.pack("<Bh", 255, code) if code > 254 else bytes([code])) if short else struct.pack("<h", code)
        if 10 <= code < 60 or 210 <= code < 240:
            data += struct.pack("<d", value)
        elif 60 <= code < 80:
            data += struct.pack("<h", value)
        elif 90 <= code < 100:
            data += struct.pack("<i", value)
        else:
            data += str(value).encode() + b"\0"
    return data


def spec(layer: str) -> str:
    """The extrusion of a layer by 1."""
    return (
        f'tolerance = 0.001\n[curve.c.dxf]\nfile = "plate.dxf"\n{layer}[shape.s.extrude]\nprofile = "c"\nheight = 1\n'
    )


@pytest.mark.parametrize("form", ["text", "long", "short"])
def test_layers_enclose_what_was_drawn(kiln: Kiln, form: str) -> None:
    """The volume of each is its area, in closed form; all together are the plate with its holes."""
    path = kiln.folder / "plate.dxf"
    if form == "text":
        path.write_text(plate.dxf(), encoding="utf-8")
    else:
        path.write_bytes(binary(plate.pairs(), short=form == "short"))
    whole = AREA - HOLES - SLOT - window_area()
    for layer, area in (("outline", AREA), ("slot", SLOT), ("holes", HOLES), ("window", window_area()), ("", whole)):
        facts = kiln.bake(spec(f'layer = "{layer}"\n' if layer else "")).shape("s")
        assert facts["closed"], layer
        assert facts["volume"] == pytest.approx(area, rel=5e-4), layer


def window_area() -> float:
    """Four quadratic Bezier arches through the middles of the rectangle's sides: by Green's theorem, summed finely."""
    middles = [(60, 16), (84, 32), (60, 48), (36, 32)]
    corners = [(84, 16), (84, 48), (36, 48), (36, 16)]
    t = np.linspace(0, 1, 4001)[:, None]
    area = 0.0
    for k in range(4):
        a, b, c = (np.array(p, float) for p in (middles[k], corners[k], middles[(k + 1) % 4]))
        points = a * (1 - t) ** 2 + 2 * b * t * (1 - t) + c * t**2
        x, y = points.T
        area += (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2
    return float(area)


def test_trimesh_sees_the_same_outline(kiln: Kiln) -> None:
    """It knows its lines and arcs: they are as long as those of the curve."""
    shutil.copy(ROOT / "specs" / "inputs" / "plate.dxf", kiln.folder / "plate.dxf")
    path = trimesh.load_path(kiln.folder / "plate.dxf")
    outlines = [entity for entity in path.entities if entity.layer == "OUTLINE"]
    length = sum(entity.length(path.vertices) for entity in outlines)
    assert length == pytest.approx(2 * (100 + 60) + 20 * math.pi, rel=1e-3)
    facts = kiln.bake(spec('layer = "outline"\n')).shape("s")
    # The walls of an extrusion by 1 have the area of its outline.
    assert facts["area"] - 2 * facts["volume"] == pytest.approx(length, rel=1e-3)


def test_faces_that_meshlab_writes_are_read(kiln: Kiln) -> None:
    """3DFACE entities, joined into a closed ball."""
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1.0, subdiv=3)
    meshes.save_current_mesh(str(kiln.folder / "ball.dxf"))
    facts = kiln.bake('[shape.b.import]\nfile = "ball.dxf"\n').shape("b")
    own, measures = meshes.current_mesh(), meshes.get_geometric_measures()
    assert (facts["points"], facts["triangles"]) == (own.vertex_number(), own.face_number())
    assert facts["closed"]
    assert facts["volume"] == pytest.approx(measures["mesh_volume"], rel=1e-5)


def test_assimp_reads_the_same_polyface_mesh(kiln: Kiln) -> None:
    """A pyramid, on a layer that is a group and a material."""
    points = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 3)]
    faces = [(4, 3, 2, 1), (1, 2, 5, 0), (2, 3, 5, 0), (3, 4, 5, 0), (4, 1, 5, 0)]
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "ENTITIES")]
    pairs += [(0, "POLYLINE"), (8, "roof"), (66, 1), (70, 64), (71, 5), (72, 5)]
    for x, y, z in points:
        pairs += [(0, "VERTEX"), (8, "roof"), (10, x), (20, y), (30, z), (70, 192)]
    for face in faces:
        pairs += [(0, "VERTEX"), (8, "roof"), (10, 0), (20, 0), (30, 0), (70, 128)]
        pairs += [(71 + k, corner) for k, corner in enumerate(face) if corner]
    pairs += [(0, "SEQEND"), (8, "roof"), (0, "ENDSEC"), (0, "EOF")]
    path = kiln.folder / "roof.dxf"
    path.write_text("".join(f"{code:3}\n{value}\n" for code, value in pairs), encoding="utf-8")
    made = kiln.bake('[shape.r.import]\nfile = "roof.dxf"\ngroup = "roof"\n')
    facts = made.shape("r")
    assert facts["closed"]
    assert facts["volume"] == pytest.approx(4.0)
    other = assimp.triangles(path)
    assert len(other) == facts["triangles"]
    volume = np.einsum("ij,ij->i", other[:, 0], np.cross(other[:, 1], other[:, 2])).sum() / 6
    assert abs(volume) == pytest.approx(4.0, rel=1e-5)


def test_broken_drawings_are_refused(kiln: Kiln) -> None:
    """With the line and what is wrong there."""
    good = plate.dxf()
    for name, text, told in (
        ("cut", good[: good.index("CIRCLE") + 20], "no radius above 0"),
        ("end", good[: good.index("  0\nEOF")], "without `EOF`"),
        ("half", good[: good.index(" 40\n10") + 4], "the drawing ends inside a pair"),
        ("number", good.replace(" 40\n10\n", " 40\nten\n", 1), "expected a number for code 40, found `ten`"),
        ("circle", good.replace("CIRCLE\n", "INSERT\n  2\nHOLE\n"), "block `HOLE` holds itself"),
        ("other", "solid x\nendsolid x\n", "this is no DXF drawing"),
    ):
        (kiln.folder / "plate.dxf").write_text(text, encoding="utf-8")
        kiln.write(spec(""))
        done = kiln.run("bake", "model.toml", "--out", "out")
        assert done.returncode == 1, name
        assert "panic" not in done.stderr
        assert told in done.stderr, done.stderr
