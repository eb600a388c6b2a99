"""Pictures of materials that files of other programs name: they arrive, and lie where the other program lays them."""

from __future__ import annotations

import io
import json
import struct
from typing import TYPE_CHECKING, Any

import assimp
import numpy as np
import pymeshlab
import pytest
import trimesh
from PIL import Image

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from kiln import Baked, Kiln

SIZE = 8


def picture(seed: int) -> Image.Image:
    """Random colors, which no two pictures share."""
    colors = np.random.default_rng(seed).integers(0, 256, (SIZE, SIZE, 3), dtype=np.uint8)
    return Image.fromarray(colors)


def square() -> trimesh.Trimesh:
    """A square of two triangles whose texture coordinates are no others' mirror images; v counts from below."""
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    places = np.array([(0.1, 0.2), (0.8, 0.1), (0.9, 0.7), (0.2, 0.6)])
    return trimesh.Trimesh(points, [(0, 1, 2), (0, 2, 3)], visual=trimesh.visual.TextureVisuals(places), process=False)


def written(made: Baked, index: int) -> NDArray[np.uint8]:
    """The pixels of a texture of a written file."""
    image = made.document.json["images"][made.document.json["textures"][index]["source"]]
    view = made.document.json["bufferViews"][image["bufferView"]]
    data = made.path.read_bytes()
    start = data.index(b"BIN\0") + 4 + view.get("byteOffset", 0)
    return np.array(Image.open(io.BytesIO(data[start : start + view["byteLength"]])).convert("RGB"))


def material(made: Baked) -> dict[str, Any]:
    """The only material."""
    [own] = made.document.json["materials"]
    return own


def color(made: Baked) -> NDArray[np.uint8]:
    """The picture that multiplies the color."""
    return written(made, material(made)["pbrMetallicRoughness"]["baseColorTexture"]["index"])


def shown(made: Baked) -> dict[tuple[float, ...], tuple[float, ...]]:
    """For each point its texture coordinates, v counted from below."""
    [mesh] = trimesh.load(made.path).geometry.values()
    return {
        tuple(np.round(at, 6)): tuple(np.round(uv, 6)) for at, uv in zip(mesh.vertices, mesh.visual.uv, strict=True)
    }


def laid() -> dict[tuple[float, ...], tuple[float, ...]]:
    """As `shown`, of the square."""
    own = square()
    return {tuple(at): tuple(uv) for at, uv in zip(own.vertices, own.visual.uv, strict=True)}


@pytest.mark.parametrize("beside", [False, True])
def test_all_pictures_of_a_gltf_file_arrive(kiln: Kiln, beside: bool) -> None:
    """Trimesh writes five pictures, inside the file or beside it."""
    names = ("baseColorTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture", "emissiveTexture")
    pictures = {name: picture(seed) for seed, name in enumerate(names)}
    own = square()
    own.visual.material = trimesh.visual.material.PBRMaterial(
        name="brick", roughnessFactor=0.5, emissiveFactor=[1, 1, 1], doubleSided=True, **pictures
    )
    if beside:
        for name, data in trimesh.exchange.gltf.export_gltf(own.scene()).items():
            (kiln.folder / name).write_bytes(data)
        source = "model.gltf"
    else:
        (kiln.folder / "square.glb").write_bytes(trimesh.exchange.gltf.export_glb(own.scene()))
        source = "square.glb"
    made = kiln.bake(f'[shape.s.import]\nfile = "{source}"\n', name="baked")
    found = material(made)
    assert (found["name"], found["doubleSided"]) == ("brick", True)
    for name, wanted in pictures.items():
        place = found if name in found else found["pbrMetallicRoughness"]
        assert np.array_equal(written(made, place[name]["index"]), np.array(wanted)), name
    assert found["pbrMetallicRoughness"]["roughnessFactor"] == 0.5
    assert shown(made) == laid()


def obj(folder: Path, line: str) -> None:
    """The square as OBJ with a material library, which has a line for its picture."""
    own = square()
    text = "mtllib square.mtl\nusemtl brick\n"
    text += "".join(f"v {x} {y} {z}\n" for x, y, z in own.vertices) + "".join(f"vt {u} {v}\n" for u, v in own.visual.uv)
    text += "".join("f " + " ".join(f"{k + 1}/{k + 1}" for k in face) + "\n" for face in own.faces)
    (folder / "square.obj").write_text(text, encoding="utf-8")
    (folder / "square.mtl").write_text(f"newmtl brick\nKd 1 1 1\n{line}\n", encoding="utf-8")


def test_formats_of_other_writers_bring_their_pictures(kiln: Kiln) -> None:
    """OBJ as it stands, 3DS as assimp writes it, PLY as MeshLab does."""
    obj(kiln.folder, "map_Kd brick.png")
    picture(7).save(kiln.folder / "brick.png")
    assimp.export(kiln.folder / "square.obj", kiln.folder / "square.3ds")
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(kiln.folder / "square.obj"))
    meshes.compute_texcoord_transfer_wedge_to_vertex()
    meshes.save_current_mesh(str(kiln.folder / "square.ply"), save_textures=False)
    assert b"TextureFile brick.png" in (kiln.folder / "square.ply").read_bytes()
    for ending in ("obj", "3ds", "ply"):
        up = '\nup = "y"' if ending == "3ds" else ""
        made = kiln.bake(f'[shape.s.import]\nfile = "square.{ending}"{up}\n', name=f"baked-{ending}")
        assert np.array_equal(color(made), np.array(picture(7))), ending
        assert shown(made) == laid(), ending


def test_a_whole_scene_brings_its_pictures(kiln: Kiln) -> None:
    """3DS once more, by a node."""
    obj(kiln.folder, "map_Kd brick.png")
    picture(7).save(kiln.folder / "BRICK.PNG")
    assimp.export(kiln.folder / "square.obj", kiln.folder / "square.3ds")
    made = kiln.bake('[node.n.import]\nfile = "square.3ds"\n', name="scene")
    assert np.array_equal(color(made), np.array(picture(7)))


def md3(shader: str) -> bytes:
    """The square as a Quake III model of one frame."""
    own = square()

    def text(name: str, size: int) -> bytes:
        return name.encode().ljust(size, b"\0")

    triangles = b"".join(struct.pack("<3i", a, c, b) for a, b, c in own.faces)
    places = b"".join(struct.pack("<2f", u, 1 - v) for u, v in own.visual.uv)
    points = b"".join(struct.pack("<3hH", *(int(part * 64) for part in at), 0) for at in own.vertices)
    offsets = np.cumsum([108, len(triangles), 68, len(places), len(points)])
    head = b"IDP3" + text("plate", 64) + struct.pack("<5i", 0, 1, 1, 4, 2) + struct.pack("<5i", *map(int, offsets))
    surface = head + triangles + text(shader, 64) + struct.pack("<i", 0) + places + points
    frame = struct.pack("<10f", 0, 0, 0, 1, 1, 1, 0, 0, 0, 1) + text("only", 16)
    start = 108 + len(frame)
    counts = struct.pack("<9i", 0, 1, 0, 1, 0, 108, start, start, start + len(surface))
    return b"IDP3" + struct.pack("<i", 15) + text("square", 64) + counts + frame + surface


@pytest.mark.parametrize("there", ["models/skin.png", "skin.png", "SKIN.PNG", "Skin.jpg", "models/SKIN.jpeg"])
def test_a_shader_finds_its_picture_by_any_ending_and_case(kiln: Kiln, there: str) -> None:
    """Quake III names pictures that games find in another folder, with another ending."""
    (kiln.folder / "square.md3").write_bytes(md3("models\\Skin.tga"))
    (kiln.folder / there).parent.mkdir(exist_ok=True)
    flat = Image.new("RGB", (SIZE, SIZE), (200, 40, 90))
    flat.save(kiln.folder / there)
    made = kiln.bake('[shape.s.import]\nfile = "square.md3"\nup = "y"\n')
    assert np.abs(color(made).astype(int) - [200, 40, 90]).max() <= 2
    assert shown(made) == {at: pytest.approx(uv, abs=1e-6) for at, uv in laid().items()}


@pytest.mark.parametrize(
    ("extra", "there", "words"),
    [
        ("", None, ["models/Skin.png or Skin.png was looked for", "K0852"]),
        ("", "models/Skin.tga", ["models/Skin.tga is neither PNG nor JPEG; convert it to models/Skin.png"]),
        ("", "models/Skin.png", ["models/Skin.png cannot be used: this is not a picture"]),
        ('materials = { plate = "red" }\n[material.red]\n', None, []),
        ('[shape.s]\nmaterial = "red"\n[material.red]\n', None, []),
    ],
)
def test_a_missing_picture_is_named(kiln: Kiln, extra: str, there: str | None, words: list[str]) -> None:
    """Unless the document gives another material."""
    (kiln.folder / "square.md3").write_bytes(md3("models/Skin.tga"))
    (kiln.folder / "models").mkdir(exist_ok=True)
    if there:
        (kiln.folder / there).write_bytes(b"no picture at all")
    kiln.write(f'[shape.s.import]\nfile = "square.md3"\n{extra}')
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 0, done.stderr
    told = " ".join(done.stderr.split()).replace("| ", "")
    assert all(word in told for word in words), done.stderr
    assert ("warning" in done.stderr) == bool(words), done.stderr
    document = json.loads((kiln.folder / "out" / "model.report.json").read_text(encoding="utf-8"))
    assert document["shapes"]["s"]["triangles"] == 2
