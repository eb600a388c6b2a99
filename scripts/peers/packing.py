"""The `packing` part of the bench: `kiln optimize --profile web` beside gltfpack and glTF-Transform on large inputs.

The terrain has positions, normals and UVs, of which gltfpack is told to keep the last (`-kv`), for Kiln keeps them; the
surface is smooth and closed and comes in the order in which subdivision makes it. Errors are measured on what
meshoptimizer's own decoder reads: each vertex of the output is held against the nearest of the input.
"""

from __future__ import annotations

import base64
import struct
import subprocess
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import cKDTree

from checks.document import Document, joined
from peers.process import Runs, together

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

CELLS = 708  # of each side: a million triangles
CACHE = 16
TRANSFORM = Path(__file__).with_name("peer_transform.mjs")


def measure(
    kiln: Path, tools: tuple[Path, Path], folder: Path, runs: int, tell: Callable[[str], None]
) -> dict[str, Any]:
    """Time, bytes, ACMR and errors of each tool on each input, all in turn."""
    programs, plain = tools
    rows = []
    for case, make in (("terrain", terrain), ("surface", surface)):
        source = folder / f"{case}.in.glb"
        make(source)
        keep = ["-kv"] if case == "terrain" else []
        entries = []
        for name, own in (
            ("Kiln", [str(kiln), "optimize", "{in}", "-o", "{out}", "--profile", "web", "--quiet"]),
            ("Kiln, codec 1", [str(kiln), "optimize", "{in}", "-o", "{out}", "--codec", "1", "--quiet"]),
            ("gltfpack -cc", [str(programs / "gltfpack"), "-i", "{in}", "-o", "{out}", "-cc", *keep]),
            ("gltfpack -cz", [str(programs / "gltfpack"), "-i", "{in}", "-o", "{out}", "-cz", *keep]),
            ("glTF-Transform", ["node", str(TRANSFORM), "{in}", "{out}"]),
        ):
            out = folder / f"{case}-{len(entries)}.glb"
            entries.append(Runs(name, [part.format(**{"in": source, "out": out}) for part in own], out))
        together(entries, runs, folder, tell)
        tell(f"errors on the {case}")
        base = entries[0].median if entries[0].failure is None else None
        for entry in entries:
            row: dict[str, Any] = {"input": case, "tool": entry.name, "failure": entry.failure}
            if entry.failure is None:
                row |= {"seconds": entry.median, "bytes": entry.output.stat().st_size}
                row["times-kiln"] = entry.median / base if base else None
                row |= quality(source, entry.output, plain)
            rows.append(row)
    return {"rows": rows}


def terrain(path: Path) -> None:
    """A height field of nine octaves, row by row."""
    chance = np.random.default_rng(1)
    heights = np.zeros((CELLS + 1, CELLS + 1))
    for octave in range(9):
        count = 2**octave
        knots = chance.normal(size=(count + 2, count + 2)) / count**1.1
        place = np.linspace(0, count, CELLS + 1)
        cell = place.astype(int)
        share = place - cell
        share = share * share * (3 - 2 * share)
        rows = [knots[cell + k] for k in (0, 1)]
        low, high = (row[:, cell] * (1 - share) + row[:, cell + 1] * share for row in rows)
        heights += low * (1 - share)[:, None] + high * share[:, None]
    heights *= 60
    x, z = np.meshgrid(np.arange(CELLS + 1), np.arange(CELLS + 1))
    down, across = np.gradient(heights)
    normals = np.stack([-across, np.ones_like(heights), -down], -1)
    corner = (np.arange(CELLS)[:, None] * (CELLS + 1) + np.arange(CELLS)).ravel()
    below = corner + CELLS + 1
    write(
        path,
        {
            "POSITION": np.stack([x - CELLS / 2, heights, z - CELLS / 2], -1),
            "NORMAL": normals / np.linalg.norm(normals, axis=-1, keepdims=True),
            "TEXCOORD_0": np.stack([x, z], -1) / CELLS,
        },
        np.stack([corner, below, corner + 1, corner + 1, below, below + 1], 1),
    )


def surface(path: Path) -> None:
    """A bumpy ring in patches of eight by eight quadrilaterals, as levels of subdivision leave them."""
    sides = 710
    u, v = np.meshgrid(*[np.arange(sides) * 2 * np.pi / sides] * 2)
    tube = 0.4 + 0.08 * np.sin(5 * u) * np.cos(7 * v)
    away = 1 + tube * np.cos(v)
    points = np.stack([away * np.cos(u), tube * np.sin(v), away * np.sin(u)], -1)
    ways = [np.roll(points, -1, axis) - np.roll(points, 1, axis) for axis in (0, 1)]
    normals = np.cross(*ways)
    names = np.arange(sides * sides).reshape(sides, sides)
    beside, below = np.roll(names, -1, 1), np.roll(names, -1, 0)
    cells = np.stack([names, below, beside, beside, below, np.roll(below, -1, 1)], -1).reshape(-1, 6)
    patch = (np.arange(sides)[:, None] // 8 * sides + np.arange(sides) // 8).ravel()
    write(
        path,
        {"POSITION": points, "NORMAL": normals / np.linalg.norm(normals, axis=-1, keepdims=True)},
        cells[np.argsort(patch, kind="stable")],
    )


def write(path: Path, attributes: dict[str, Any], indices: NDArray[np.int64]) -> None:
    """A file of floats and 32-bit indices, one mesh in one node."""
    parts = {name: rows.reshape(-1, rows.shape[-1]).astype("<f4") for name, rows in attributes.items()}
    arrays = [*parts.values(), indices.astype("<u4").ravel()]
    starts = np.cumsum([0, *(array.nbytes for array in arrays)]).tolist()
    views = [
        {"buffer": 0, "byteOffset": start, "byteLength": array.nbytes}
        for start, array in zip(starts, arrays, strict=False)
    ]
    accessors: list[dict[str, Any]] = [
        {"bufferView": at, "componentType": 5126, "count": len(rows), "type": f"VEC{rows.shape[1]}"}
        for at, rows in enumerate(parts.values())
    ]
    accessors[0] |= {"min": arrays[0].min(0).tolist(), "max": arrays[0].max(0).tolist()}
    accessors.append({"bufferView": len(parts), "componentType": 5125, "count": indices.size, "type": "SCALAR"})
    primitive = {"attributes": {name: at for at, name in enumerate(parts)}, "indices": len(parts)}
    look: dict[str, Any] = {}
    if "TEXCOORD_0" in parts:
        # Without a texture, gltfpack would not look at what the UVs say.
        primitive["material"] = 0
        look = {
            "images": [{"uri": f"data:image/png;base64,{base64.b64encode(picture()).decode()}"}],
            "textures": [{"source": 0}],
            "materials": [{"name": "ground", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        }
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": starts[-1]}],
        "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"name": "m", "primitives": [primitive]}],
        "nodes": [{"name": "n", "mesh": 0}],
        **look,
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    path.write_bytes(joined(document, b"".join(array.tobytes() for array in arrays)))


def picture() -> bytes:
    """A PNG of one gray pixel."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", 1, 1, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"\0\x80")) + chunk(b"IEND", b"")


def quality(source: Path, packed: Path, plain: Path) -> dict[str, Any]:
    """Triangles, ACMR, and how far vertices are from the nearest of the input."""
    out = packed.with_suffix(".plain.glb")
    subprocess.run(["node", str(plain), str(packed), str(out)], check=True)
    before, after = Document(source), Document(out)
    out.unlink()
    given = before.meshes[0].primitives[0]
    tree = cKDTree(given.attributes["POSITION"].astype(float))
    worst, triangles, misses, normals, uvs = 0.0, 0, 0, 0.0, 0.0
    for mesh, world in after.instances:
        for told, primitive in zip(
            after.json["meshes"][mesh]["primitives"], after.meshes[mesh].primitives, strict=True
        ):
            points = numbers(after, told["attributes"]["POSITION"]) @ world[:3, :3].T + world[:3, 3]
            apart, nearest = tree.query(points)
            worst = max(worst, float(apart.max()))
            triangles += len(primitive.triangles)
            misses += missed(primitive.triangles)
            found = numbers(after, told["attributes"]["NORMAL"])
            found /= np.linalg.norm(found, axis=1, keepdims=True)
            cosines = np.einsum("vi,vi->v", found, given.attributes["NORMAL"][nearest].astype(float))
            normals = max(normals, float(np.degrees(np.arccos(cosines.clip(-1, 1).min()))))
            if primitive.attributes.get("TEXCOORD_0", np.zeros(0)).dtype == np.dtype("<f4"):
                texture = primitive.attributes["TEXCOORD_0"] - given.attributes["TEXCOORD_0"][nearest]
                uvs = max(uvs, float(np.abs(texture).max()))
    return {
        "triangles": triangles,
        "acmr": misses / triangles,
        "position-error": worst,
        "normal-error": normals,
        "uv-error": uvs or None,
    }


def numbers(document: Document, index: int) -> NDArray[np.float64]:
    """An accessor as numbers, normalized ones divided."""
    found = document.accessor(index)
    if document.json["accessors"][index].get("normalized"):
        return np.maximum(found.astype(float) / np.iinfo(found.dtype).max, -1.0)
    return found.astype(float)


def missed(triangles: NDArray[np.int64]) -> int:
    """Vertices that are transformed, by a cache of 16, first in and first out."""
    entered = [0] * (int(triangles.max()) + 1)
    clock = CACHE + 1
    for vertex in triangles.ravel().tolist():
        if clock - entered[vertex] > CACHE:
            entered[vertex] = clock
            clock += 1
    return clock - CACHE - 1
