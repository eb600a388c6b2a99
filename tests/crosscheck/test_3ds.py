"""3D Studio scenes (3DS) that other programs write, and one packed here, held against what they hold."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path
from typing import TYPE_CHECKING

import assimp
import numpy as np
import pymeshlab
import pytest

from checks import played

if TYPE_CHECKING:
    from kiln import Baked, Kiln

INPUTS = Path(__file__).resolve().parents[2] / "specs" / "inputs"


def ball(path: Path) -> pymeshlab.MeshSet:
    """A bumpy ball."""
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1.0, subdiv=3)
    meshes.compute_coord_by_function(x="x * (1 + 0.1 * sin(5 * y))", y="y", z="z * 1.5")
    meshes.save_current_mesh(str(path))
    return meshes


@pytest.mark.parametrize("writer", ["pymeshlab", "assimp"])
def test_meshes_of_other_writers_are_read(kiln: Kiln, writer: str) -> None:
    """Points, faces, area and volume."""
    source = kiln.folder / ("ball.3ds" if writer == "pymeshlab" else "ball.ply")
    meshes = ball(source)
    if writer == "assimp":
        assimp.export(source, kiln.folder / "ball.3ds")
    facts = kiln.bake('[shape.b.import]\nfile = "ball.3ds"\n').shape("b")
    own, measures = meshes.current_mesh(), meshes.get_geometric_measures()
    assert (facts["points"], facts["triangles"]) == (own.vertex_number(), own.face_number())
    assert facts["closed"]
    assert facts["volume"] == pytest.approx(measures["mesh_volume"], rel=1e-5)
    assert facts["area"] == pytest.approx(measures["surface_area"], rel=1e-5)


def test_both_read_what_the_other_wrote(kiln: Kiln) -> None:
    """The same file by assimp and by Kiln: the same triangles, z up turned to y up."""
    ball(kiln.folder / "ball.3ds")
    made = kiln.bake('[shape.b.import]\nfile = "ball.3ds"\n')
    points, triangles = made.mesh("b")
    other = assimp.triangles(kiln.folder / "ball.3ds")
    assert len(other) == len(triangles)
    assert np.ptp(points, axis=0) == pytest.approx(np.ptp(other.reshape(-1, 3), axis=0), rel=1e-5)


def chunk(number: int, *parts: bytes) -> bytes:
    """A chunk with its length."""
    body = b"".join(parts)
    return struct.pack("<HI", number, len(body) + 6) + body


def roof(smoothing: list[int]) -> bytes:
    """Two squares that meet at a ridge; each face in the smoothing groups of its mask."""
    points = [(0, 0, 0), (0, 2, 0), (1, 2, 1), (1, 0, 1), (2, 2, 0), (2, 0, 0)]
    faces = [(0, 2, 1), (0, 3, 2), (3, 4, 2), (3, 5, 4)]
    mesh = chunk(
        0x4100,
        chunk(0x4110, struct.pack("<H", 6), *(struct.pack("<3f", *point) for point in points)),
        chunk(
            0x4120,
            struct.pack("<H", 4),
            *(struct.pack("<4H", *face, 7) for face in faces),
            chunk(0x4130, b"slate\0", struct.pack("<3H", 2, 0, 1)),
            chunk(0x4150, struct.pack("<4I", *smoothing)),
        ),
    )
    color = chunk(0xA020, chunk(0x0011, bytes([188, 64, 0])))
    material = chunk(0xAFFF, chunk(0xA000, b"slate\0"), color, chunk(0xA050, chunk(0x0030, struct.pack("<H", 50))))
    return chunk(0x4D4D, chunk(0x3D3D, material, chunk(0x4000, b"roof\0", mesh)))


@pytest.mark.parametrize(("smoothing", "smooth"), [([1, 1, 2, 2], False), ([3, 3, 6, 6], True), ([0, 0, 0, 0], False)])
def test_faces_that_share_a_group_are_smooth(kiln: Kiln, smoothing: list[int], smooth: bool) -> None:
    """Masks have a bit for each group: 3 and 6 share one."""
    (kiln.folder / "roof.3ds").write_bytes(roof(smoothing))
    made = kiln.bake('[shape.r.import]\nfile = "roof.3ds"\n')
    surface = made.document.meshes[0].surfaces[0]
    normals = np.concatenate([one.attributes["NORMAL"] for one in made.document.meshes[0].surfaces])
    up = (np.abs(normals - [0, 1, 0]).max(axis=1) < 1e-3).any()
    assert up == smooth, surface


def test_colors_are_those_of_a_screen(kiln: Kiln) -> None:
    """188 of 255 is half of the light; what is half transparent is blended."""
    (kiln.folder / "roof.3ds").write_bytes(roof([1, 1, 1, 1]))
    made = kiln.bake('[shape.r.import]\nfile = "roof.3ds"\n')
    material = next(one for one in made.document.json["materials"] if one["name"] == "slate")
    factor = material["pbrMetallicRoughness"]["baseColorFactor"]
    assert factor == pytest.approx([0.5029, 0.0513, 0.0, 0.5], abs=1e-3)
    assert material["alphaMode"] == "BLEND"


def test_a_file_that_is_cut_off_is_refused(kiln: Kiln) -> None:
    """With the chunk that has no room."""
    data = roof([1, 1, 1, 1])
    (kiln.folder / "roof.3ds").write_bytes(data[: len(data) // 2])
    kiln.write('[shape.r.import]\nfile = "roof.3ds"\n')
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 1
    assert "error[K0851]" in done.stderr
    assert "chunk 0x4d4d" in done.stderr


def windmill(kiln: Kiln) -> Baked:
    """The gallery's own scene."""
    shutil.copy(INPUTS / "windmill.3ds", kiln.folder / "windmill.3ds")
    return kiln.bake('[node.mill.import]\nfile = "windmill.3ds"\nloop = true\n', name="windmill")


def pose(made: Baked, time: float, *names: str) -> list[np.ndarray]:
    """Matrices of nodes at a time."""
    clip = made.document.json["animations"][0]
    found = played.Stage(made.document).pose(clip, {"time": time, "nodes": list(names), "vertices": {}})
    return [np.array(found["nodes"][name]).reshape(4, 4).T for name in names]


def test_a_scene_stands_as_assimp_reads_it(kiln: Kiln) -> None:
    """At its first frame: as many triangles, each vertex near one of assimp's."""
    made = windmill(kiln)
    other = assimp.triangles(kiln.folder / "windmill.3ds")
    names = ("tower", "cap", "rotor", "lantern-shown")
    matrices = dict(zip(names, pose(made, 0.0, *names), strict=True))
    points, count = [], 0
    for mesh in made.document.meshes:
        node = mesh.name.removeprefix("mill.")
        matrix = matrices.get(node, matrices["lantern-shown"])
        points.append(mesh.positions @ matrix[:3, :3].T + matrix[:3, 3])
        count += len(mesh.triangles)
    assert count == len(other)
    wanted = other.reshape(-1, 3)
    for place in np.concatenate(points)[::3]:
        assert np.linalg.norm(wanted - place, axis=1).min() < 1e-4, place


def test_keys_move_what_they_name(kiln: Kiln) -> None:
    """The rotor turns once, clockwise seen from the end of its keys' axis; the lantern is there, gone, and there."""
    made = windmill(kiln)
    for second in range(4):
        cap, rotor = pose(made, second + 1e-6, "cap", "rotor")
        turned = np.linalg.inv(cap) @ rotor
        angle = -np.pi / 2 * second
        # y of the file is -z here: a turn clockwise about it is one counter-clockwise about z.
        wanted = [[np.cos(-angle), -np.sin(-angle)], [np.sin(-angle), np.cos(-angle)]]
        assert np.abs(turned[:2, :2] - wanted).max() < 2e-3, second
    sizes = [np.linalg.norm(pose(made, time, "lantern-shown")[0][:3, 0]) for time in (0.5, 1.5, 2.5, 3.5)]
    assert sizes == pytest.approx([1, 0, 0, 1])


def test_the_camera_looks_at_its_target_along_its_spline(kiln: Kiln) -> None:
    """Half way to its second key it is where the spline of Kochanek and Bartels with tension 1/2 has it."""
    made = windmill(kiln)
    keys = np.array([[14, -18, 6], [9, -20, 9], [14, -18, 6]], float)
    middle = 0.5 * 0.5 * (keys[2] - keys[0])  # the slope at the second key
    first = 0.5 * (1.5 * (keys[1] - keys[0]) - 0.5 * middle)
    s = 0.5
    at = keys[0] * (1 + 2 * s) * (1 - s) ** 2 + keys[1] * s * s * (3 - 2 * s)
    at += first * s * (1 - s) ** 2 - middle * s * s * (1 - s)
    (camera,) = pose(made, 1.0, "camera01")
    place = at[[0, 2, 1]] * [1, 1, -1]
    assert np.abs(camera[:3, 3] - place).max() < 2e-3
    along = np.array([0, 5, 0]) - place
    assert np.abs(-camera[:3, 2] - along / np.linalg.norm(along)).max() < 2e-3
    assert abs(camera[1, 0]) < 2e-3, "level"
    seen = made.document.json["cameras"][0]["perspective"]
    assert seen["yfov"] == pytest.approx(2 * np.arctan(18 / 35 * 3 / 4), rel=1e-5)
    assert (seen["znear"], seen["zfar"]) == pytest.approx((0.5, 200))


def test_lights_shine_where_the_file_says(kiln: Kiln) -> None:
    """A spot and a lamp, by the extension, which is used and not required."""
    made = windmill(kiln)
    document = made.document.json
    assert "KHR_lights_punctual" in document["extensionsUsed"]
    assert not document.get("extensionsRequired")
    spot, lamp = document["extensions"]["KHR_lights_punctual"]["lights"]
    assert (spot["type"], lamp["type"], lamp["range"]) == ("spot", "point", 20)
    assert np.degrees([spot["spot"]["innerConeAngle"], spot["spot"]["outerConeAngle"]]) == pytest.approx([20, 27.5])
    (sun,) = pose(made, 0.0, "sun")
    along = np.array([0, 5, 0]) - sun[:3, 3]
    assert np.abs(-sun[:3, 2] - along / np.linalg.norm(along)).max() < 1e-5


@pytest.mark.parametrize("place", [40, 2000, 4200, 5500])
def test_scenes_that_are_cut_off_are_refused(kiln: Kiln, place: int) -> None:
    """Nothing is written."""
    (kiln.folder / "half.3ds").write_bytes((INPUTS / "windmill.3ds").read_bytes()[:place])
    kiln.write('[node.mill.import]\nfile = "half.3ds"\n')
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 1
    assert "error[K0851]" in done.stderr
