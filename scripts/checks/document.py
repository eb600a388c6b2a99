"""A plain reader of glTF files for the checks that want arrays: triangles, attributes, node matrices.

Reads what profile `core` may hold (float attributes, triangles, buffers in the .glb, in a `data:` address
or beside the file) and refuses the rest by name. Not a validator.
"""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
TRIANGLES = 4


@dataclass(frozen=True)
class Primitive:
    """One draw call: attributes by glTF name, triangles as vertex indices of shape (n, 3)."""

    attributes: dict[str, NDArray[Any]]
    triangles: NDArray[np.int64]
    material: int | None


@dataclass(frozen=True)
class Mesh:
    """One glTF mesh and what follows from merging vertices at equal written positions."""

    name: str
    primitives: list[Primitive]

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """All vertices as written, primitive after primitive; shared accessors count once a primitive."""
        return np.concatenate([p.attributes["POSITION"] for p in self.primitives]).astype(float)

    @cached_property
    def triangles(self) -> NDArray[np.int64]:
        """All triangles, indices into `positions`."""
        starts = np.cumsum([0] + [len(p.attributes["POSITION"]) for p in self.primitives])
        parts = [p.triangles + start for p, start in zip(self.primitives, starts, strict=False)]
        return np.concatenate(parts)

    @cached_property
    def merged(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Distinct positions that some triangle uses, and the triangles over them."""
        used = (self.positions + 0.0)[self.triangles.ravel()]  # adding zero makes -0 equal to 0
        points, index = np.unique(used, axis=0, return_inverse=True)
        return points, index.reshape(-1, 3).astype(np.int64)


class Document:
    """A glTF file: its JSON, its meshes, and the world matrices of the nodes that show them."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.json, self.binary = split(path.read_bytes())
        self.buffers = [self._buffer(buffer) for buffer in self.json.get("buffers", [])]

    def _buffer(self, buffer: dict[str, Any]) -> bytes:
        uri = buffer.get("uri")
        if uri is None:
            return self.binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        return (self.path.parent / unquote(uri)).read_bytes()

    def accessor(self, index: int) -> NDArray[Any]:
        """The numbers of one accessor, shape (count, width); rows may be interleaved."""
        accessor = self.json["accessors"][index]
        if "sparse" in accessor:
            message = f"accessor {index} is sparse"
            raise ValueError(message)
        kind = np.dtype(COMPONENTS[accessor["componentType"]])
        width, count = WIDTHS[accessor["type"]], accessor["count"]
        if "bufferView" not in accessor:
            return np.zeros((count, width), kind)
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", width * kind.itemsize)
        return np.ndarray(
            (count, width),
            kind,
            self.buffers[view["buffer"]],
            start,
            (stride, kind.itemsize),
        )

    @cached_property
    def meshes(self) -> list[Mesh]:
        """The meshes in file order; an unnamed one is `mesh 0`, `mesh 1`..."""
        return [
            Mesh(mesh.get("name", f"mesh {i}"), [self._primitive(p) for p in mesh["primitives"]])
            for i, mesh in enumerate(self.json.get("meshes", []))
        ]

    def _primitive(self, primitive: dict[str, Any]) -> Primitive:
        mode = primitive.get("mode", TRIANGLES)
        if mode != TRIANGLES:
            message = f"primitive mode {mode} is not triangles"
            raise ValueError(message)
        attributes = {name: self.accessor(i) for name, i in primitive["attributes"].items()}
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"]).ravel()
        else:
            indices = np.arange(len(attributes["POSITION"]))
        triangles = indices.astype(np.int64).reshape(-1, 3)
        return Primitive(attributes, triangles, primitive.get("material"))

    @cached_property
    def placed(self) -> list[tuple[dict[str, Any], NDArray[np.float64]]]:
        """(node, world matrix) for each node of the scene, depth first."""
        scenes = self.json.get("scenes", [{}])
        roots = scenes[self.json.get("scene", 0)].get("nodes", [])
        return [found for root in roots for found in self._below(root, np.eye(4))]

    def _below(self, index: int, parent: NDArray[Any]) -> list[tuple[dict[str, Any], NDArray[np.float64]]]:
        node = self.json["nodes"][index]
        world = parent @ local_matrix(node)
        return [(node, world)] + [f for child in node.get("children", []) for f in self._below(child, world)]

    @property
    def instances(self) -> list[tuple[int, NDArray[np.float64]]]:
        """(mesh index, world matrix) for each node that shows a mesh."""
        return [(node["mesh"], world) for node, world in self.placed if "mesh" in node]

    @property
    def worlds(self) -> dict[str, NDArray[np.float64]]:
        """World matrices by node name."""
        return {node["name"]: world for node, world in self.placed if "name" in node}


def split(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary chunk of a .glb, or of a .gltf (no binary chunk)."""
    if data[:4] != b"glTF":
        return json.loads(data), b""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def local_matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    """A node's own matrix from `matrix` (column-major) or translation, rotation (x, y, z, w), scale."""
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = rotation * np.array(node.get("scale", [1, 1, 1]), float)
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix
