"""A .glb with a report beside it that Kiln had no part in: the known-good input of verify.py's own tests.

Two meshes, a crate with hard edges (shown twice) and a smooth ring, with closed forms for what they are.
"""

from __future__ import annotations

import json
import struct
from itertools import pairwise, product
from typing import TYPE_CHECKING, Any

import numpy as np
from blake3 import blake3

from checks.document import Document
from checks.written import cache_figures

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

Vertices = tuple["NDArray[np.float64]", "NDArray[np.float64]", "NDArray[np.int64]"]

SIZE = np.array([2.0, 1.0, 0.5])
CENTER = np.array([0.25, 0.5, -0.125])
RING, TUBE, AROUND, ACROSS = 1.0, 0.25, 24, 12
TURN = [0.0, 0.0, 0.6, 0.8]  # a quaternion about z with cos = 0.28 and sin = 0.96
TURNED = np.array([[0.28, -0.96, 0.0], [0.96, 0.28, 0.0], [0.0, 0.0, 1.0]])
BEHIND = [0.0, 0.0, -2.0]
RAISED = [0.0, 0.0, 3.0]


def crate() -> Vertices:
    """A box: positions, normals, triangles; four vertices a face."""
    positions, normals, triangles = [], [], []
    for axis, side in product(range(3), (-1.0, 1.0)):
        normal = np.eye(3)[axis] * side
        right, up = np.eye(3)[(axis + 1) % 3] * side, np.eye(3)[(axis + 2) % 3]
        first = len(positions)
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            positions.append(CENTER + (normal + a * right + b * up) * SIZE / 2)
            normals.append(normal)
        triangles += [[first, first + 1, first + 2], [first, first + 2, first + 3]]
    return np.array(positions), np.array(normals), np.array(triangles)


def ring() -> Vertices:
    """A polygonal torus about the y axis: positions, normals, triangles."""
    u, v = np.meshgrid(np.arange(AROUND), np.arange(ACROSS), indexing="ij")
    a, b = u.ravel() * 2 * np.pi / AROUND, v.ravel() * 2 * np.pi / ACROSS
    out = np.stack([np.cos(a), 0 * a, np.sin(a)], axis=1)
    normals = np.cos(b)[:, None] * out + np.sin(b)[:, None] * np.array([0.0, 1.0, 0.0])
    index = lambda i, j: (i % AROUND) * ACROSS + j % ACROSS  # noqa: E731 -- a formula, used four times
    corners = [index(u + i, v + j).ravel() for i, j in ((0, 0), (0, 1), (1, 1), (1, 0))]
    triangles = np.concatenate([np.stack([corners[0], corners[i], corners[i + 1]], axis=1) for i in (1, 2)])
    return RING * out + TUBE * normals, normals, triangles


def write(folder: Path) -> Path:
    """Write made.glb and made.report.json; returns the .glb."""
    path = folder / "made.glb"
    path.write_bytes(glb({"crate": crate(), "ring": ring()}))
    report = claims(path)
    path.with_name("made.report.json").write_text(json.dumps(report), encoding="utf-8")
    return path


def glb(meshes: dict[str, Vertices]) -> bytes:
    """The bytes of the file: one primitive and one material a mesh; the crate is shown twice."""
    views, accessors, blob = [], [], b""
    described = []
    for number, (name, arrays) in enumerate(meshes.items()):
        indices = []
        for array, kind, target in zip(arrays, ("<f4", "<f4", "<u2"), (34962, 34962, 34963), strict=True):
            data = array.astype(kind)
            data = data.reshape(-1) if kind == "<u2" else data
            indices.append(len(accessors))
            accessors.append(
                {
                    "bufferView": len(views),
                    "componentType": 5123 if kind == "<u2" else 5126,
                    "count": len(data),
                    "type": "SCALAR" if kind == "<u2" else "VEC3",
                }
            )
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": data.nbytes, "target": target})
            blob += data.tobytes() + bytes(-data.nbytes % 4)
        low, high = arrays[0].astype("<f4").min(axis=0), arrays[0].astype("<f4").max(axis=0)
        accessors[indices[0]].update(min=low.tolist(), max=high.tolist())
        attributes = {"POSITION": indices[0], "NORMAL": indices[1]}
        primitive = {"attributes": attributes, "indices": indices[2], "material": number}
        described.append({"name": name, "primitives": [primitive]})
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"name": "low", "mesh": 0, "rotation": TURN, "children": [2]},
            {"name": "ring", "mesh": 1, "translation": BEHIND},
            {"name": "high", "mesh": 0, "translation": RAISED},
        ],
        "meshes": described,
        "materials": [{"name": name} for name in meshes],
        "buffers": [{"byteLength": len(blob)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def claims(path: Path) -> dict[str, Any]:
    """The right report for the file."""
    data = path.read_bytes()
    meshes = {mesh.name: mesh for mesh in Document(path).meshes}
    shapes = {"crate": crate_claims(), "ring": ring_claims()}
    for name, shape in shapes.items():
        shape["acmr"], shape["atvr"] = cache_figures(meshes[name])
    return {
        "kiln": "0.1.0",
        "asset": "made",
        "file": {"name": path.name, "bytes": len(data), "blake3": blake3(data).hexdigest()},
        "totals": {
            "meshes": 2,
            "primitives": 2,
            "triangles": sum(shape["triangles"] for shape in shapes.values()),
            "vertices": sum(shape["vertices"] for shape in shapes.values()),
            "materials": 2,
            "images": 0,
            "nodes": 3,
            "draw-calls": 3,
            "drawn-triangles": 2 * shapes["crate"]["triangles"] + shapes["ring"]["triangles"],
            "bounds": world_box(),
        },
        "shapes": shapes,
        "nodes": [
            {"name": "low", "parent": None, "mesh": "crate", "matrix": column_by_column(TURNED, [0.0, 0.0, 0.0])},
            {"name": "ring", "parent": None, "mesh": "ring", "matrix": column_by_column(np.eye(3), BEHIND)},
            {"name": "high", "parent": "low", "mesh": "crate", "matrix": column_by_column(TURNED, RAISED)},
        ],
    }


def column_by_column(turn: NDArray[np.float64], place: list[float]) -> list[float]:
    """A matrix as the report writes it."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, place
    return matrix.T.ravel().tolist()


def world_box() -> dict[str, list[float]]:
    """The box of both crates and the ring."""
    corners = np.array(list(product(*zip(CENTER - SIZE / 2, CENTER + SIZE / 2, strict=True))))
    low_crate = corners @ TURNED.T
    points = np.concatenate([low_crate, low_crate + RAISED, ring()[0] + BEHIND])
    return {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}


def crate_claims() -> dict[str, Any]:
    """Closed forms for the box."""
    x, y, z = SIZE
    volume = x * y * z
    return {
        **common(crate(), points=8, euler=2, genus=0),
        "area": 2 * (x * y + y * z + z * x),
        "volume": volume,
        "centroid": CENTER.tolist(),
        "inertia": np.diag(volume / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])).tolist(),
    }


def ring_claims() -> dict[str, Any]:
    """The ring's triangles summed: tetrahedra to the origin, in double precision on the written numbers."""
    positions, _, triangles = ring()
    a, b, c = (positions.astype("<f4").astype(float)[triangles[:, i]] for i in range(3))
    volumes = np.einsum("ti,ti->t", a, np.cross(b, c)) / 6
    volume = volumes.sum()
    centroid = (volumes[:, None] * (a + b + c)).sum(axis=0) / 4 / volume
    s = a + b + c
    second = sum(np.einsum("t,ti,tj->ij", volumes, p, p) for p in (a, b, c, s)) / 20
    second -= volume * np.outer(centroid, centroid)
    return {
        **common(ring(), points=AROUND * ACROSS, euler=0, genus=1),
        "area": float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2),
        "volume": float(volume),
        "centroid": centroid.tolist(),
        "inertia": (np.trace(second) * np.eye(3) - second).tolist(),
    }


def common(arrays: Vertices, points: int, euler: int, genus: int) -> dict[str, Any]:
    """Counts and topology of a closed shape of one part."""
    positions, _, triangles = arrays
    written = positions.astype("<f4").astype(float)
    return {
        "primitives": 1,
        "triangles": len(triangles),
        "vertices": len(positions),
        "points": points,
        "bounds": {"min": written.min(axis=0).tolist(), "max": written.max(axis=0).tolist()},
        "inertia-of": "solid",
        "closed": True,
        "manifold": True,
        "components": 1,
        "euler": euler,
        "genus": genus,
        "boundary-edges": 0,
        "boundary-loops": 0,
        "crowded-edges": 0,
        "misoriented-edges": 0,
        "degenerate-triangles": 0,
        "deviation": {"tolerance": 0.01, "bound": 0.005, "kind": "proved", "measured": 0.004},
    }


def paths(value: Any, at: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """The paths of all leaves of nested tables and lists."""
    if isinstance(value, dict):
        return [leaf for key, item in value.items() for leaf in paths(item, (*at, key))]
    if isinstance(value, list):
        return [leaf for key, item in enumerate(value) for leaf in paths(item, (*at, key))]
    return [at]


def changed(value: Any, path: tuple[str | int, ...], edit: Any) -> Any:
    """A copy of nested tables with one leaf replaced by `edit(leaf)`."""
    copy = json.loads(json.dumps(value))
    place = copy
    for key, _ in pairwise(path):
        place = place[key]
    place[path[-1]] = edit(place[path[-1]])
    return copy
