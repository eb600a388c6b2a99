"""A plain reader of glTF files for the checks that want arrays: triangles, lines, attributes, node matrices.

Reads what profile `core` may hold (float attributes, triangles, lines, buffers in the .glb, in a `data:` address
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
LINES, TRIANGLES = 1, 4


@dataclass(frozen=True)
class Primitive:
    """One draw call: attributes by glTF name; indices of shape (n, 3) for triangles, (n, 2) for lines."""

    attributes: dict[str, NDArray[Any]]
    indices: NDArray[np.int64]
    material: int | None
    cloud: int
    """The accessor of its positions: primitives that name one share their vertices."""

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Its triangles; it has none where it holds lines."""
        return self.indices if self.indices.shape[1] == 3 else np.zeros((0, 3), np.int64)


@dataclass(frozen=True)
class Cloud:
    """Vertices with what is drawn between them, of primitives of one kind."""

    positions: NDArray[np.float64]
    indices: NDArray[np.int64]

    @classmethod
    def of(cls, primitives: list[Primitive], corners: int) -> Cloud:
        """The primitives together; vertices that some of them share stand once."""
        clouds = {p.cloud: p.attributes["POSITION"] for p in primitives}
        starts = dict(zip(clouds, np.cumsum([0, *map(len, clouds.values())]), strict=False))
        positions = [np.zeros((0, 3)), *(cloud.astype(float) for cloud in clouds.values())]
        indices = [np.zeros((0, corners), np.int64), *(p.indices + starts[p.cloud] for p in primitives)]
        return cls(np.concatenate(positions), np.concatenate(indices))


@dataclass(frozen=True)
class Target:
    """A morph target: its name, its weight where nothing moves it, and differences by glTF name."""

    name: str
    weight: float
    attributes: dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Mesh:
    """One glTF mesh and what follows from merging vertices at equal written positions."""

    name: str
    primitives: list[Primitive]
    targets: list[Target]

    @property
    def surfaces(self) -> list[Primitive]:
        """The primitives of triangles."""
        return [p for p in self.primitives if p.indices.shape[1] == 3]

    @cached_property
    def lines(self) -> Cloud:
        """All lines with their vertices."""
        return Cloud.of([p for p in self.primitives if p.indices.shape[1] == 2], 2)

    @cached_property
    def surface(self) -> Cloud:
        """All triangles with their vertices."""
        return Cloud.of(self.surfaces, 3)

    @property
    def positions(self) -> NDArray[np.float64]:
        """The vertices of triangles, as written."""
        return self.surface.positions

    @property
    def triangles(self) -> NDArray[np.int64]:
        """All triangles, indices into `positions`."""
        return self.surface.indices

    @property
    def places(self) -> NDArray[np.float64]:
        """The vertices of triangles and of lines."""
        return np.concatenate([self.surface.positions, self.lines.positions])

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
        kind = np.dtype(COMPONENTS[accessor["componentType"]])
        width, count = WIDTHS[accessor["type"]], accessor["count"]
        found = (
            self._rows(accessor, kind, (count, width)) if "bufferView" in accessor else np.zeros((count, width), kind)
        )
        if sparse := accessor.get("sparse"):
            found = found.copy()
            places = np.dtype(COMPONENTS[sparse["indices"]["componentType"]])
            rows = self._rows(sparse["indices"], places, (sparse["count"], 1)).ravel()
            found[rows] = self._rows(sparse["values"], kind, (sparse["count"], width))
        return found

    def _rows(self, where: dict[str, Any], kind: np.dtype[Any], shape: tuple[int, int]) -> NDArray[Any]:
        """Elements of a view from an offset on."""
        count, width = shape
        view = self.json["bufferViews"][where["bufferView"]]
        start = view.get("byteOffset", 0) + where.get("byteOffset", 0)
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
            Mesh(mesh.get("name", f"mesh {i}"), [self._primitive(p) for p in mesh["primitives"]], self._targets(mesh))
            for i, mesh in enumerate(self.json.get("meshes", []))
        ]

    def _targets(self, mesh: dict[str, Any]) -> list[Target]:
        """The morph targets, which all primitives of a mesh of ours share."""
        written = mesh["primitives"][0].get("targets", [])
        names = mesh.get("extras", {}).get("targetNames", [str(i) for i in range(len(written))])
        weights = mesh.get("weights", [0.0] * len(written))
        found = [{name: self.accessor(i).astype(float) for name, i in target.items()} for target in written]
        return [Target(*one) for one in zip(names, weights, found, strict=True)]

    def _primitive(self, primitive: dict[str, Any]) -> Primitive:
        mode = primitive.get("mode", TRIANGLES)
        if mode not in (LINES, TRIANGLES):
            message = f"primitive mode {mode} is neither triangles nor lines"
            raise ValueError(message)
        attributes = {name: self.accessor(i) for name, i in primitive["attributes"].items()}
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"]).ravel()
        else:
            indices = np.arange(len(attributes["POSITION"]))
        indices = indices.astype(np.int64).reshape(-1, 2 if mode == LINES else 3)
        return Primitive(attributes, indices, primitive.get("material"), primitive["attributes"]["POSITION"])

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

    @cached_property
    def coarser(self) -> set[int]:
        """Nodes that others name as their coarser levels of detail."""
        nodes = self.json.get("nodes", [])
        return {level for node in nodes for level in node.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])}

    @cached_property
    def carriers(self) -> set[int]:
        """Nodes without a name that only carry a mesh: coarser levels, and the finest beside them."""
        nodes = self.json.get("nodes", [])
        finest = {i for i, node in enumerate(nodes) if "MSFT_lod" in node.get("extensions", {}) and "name" not in node}
        return self.coarser | finest

    @property
    def coarser_meshes(self) -> set[str]:
        """The names of the meshes that only coarser levels show."""
        nodes = self.json.get("nodes", [])
        return {self.meshes[nodes[i]["mesh"]].name for i in self.coarser}

    @property
    def instances(self) -> list[tuple[int, NDArray[np.float64]]]:
        """(mesh index, world matrix) for each node that shows a mesh. What joints carry is at rest where they stand."""
        return [(node["mesh"], self._carried(node, world)) for node, world in self.placed if "mesh" in node]

    def _carried(self, node: dict[str, Any], world: NDArray[Any]) -> NDArray[np.float64]:
        if "skin" not in node:
            return world
        first = self.json["skins"][node["skin"]]["joints"][0]
        above = [one for one, _ in self.placed if first in one.get("children", [])]
        return next((own for one, own in self.placed if above and one is above[0]), world)

    @property
    def above_joints(self) -> set[str]:
        """The names of nodes that are no joints and carry some."""
        joints = {joint for skin in self.json.get("skins", []) for joint in skin["joints"]}
        nodes = enumerate(self.json.get("nodes", []))
        above = [node for index, node in nodes if index not in joints and joints & set(node.get("children", []))]
        return {node.get("name", "") for node in above}

    @property
    def worlds(self) -> dict[str, NDArray[np.float64]]:
        """World matrices by node name."""
        return {node["name"]: world for node, world in self.placed if "name" in node}


def without_lines(path: Path) -> bytes:
    """The .glb without its primitives of lines, for tools that misread them; nodes of nothing else show no mesh."""
    document, binary = split(path.read_bytes())
    kept: dict[int, int] = {}
    meshes = []
    for number, mesh in enumerate(document.get("meshes", [])):
        mesh["primitives"] = [p for p in mesh["primitives"] if p.get("mode", TRIANGLES) != LINES]
        if mesh["primitives"]:
            kept[number] = len(meshes)
            meshes.append(mesh)
    document["meshes"] = meshes
    for node in document.get("nodes", []):
        mesh = kept.get(node.pop("mesh", -1))
        if mesh is not None:
            node["mesh"] = mesh
    if not meshes:
        del document["meshes"]
    return joined(document, binary)


def with_materials(data: bytes) -> bytes:
    """A .glb with a plain material on primitives that have none, for tools that cannot join such primitives."""
    document, binary = split(data)
    bare = [p for mesh in document.get("meshes", []) for p in mesh["primitives"] if "material" not in p]
    if not bare:
        return data
    materials = document.setdefault("materials", [])
    for primitive in bare:
        primitive["material"] = len(materials)
    materials.append({})
    return joined(document, binary)


def points_at_properties(path: Path) -> bool:
    """Whether an animation has channels that name no node (KHR_animation_pointer)."""
    animations = split(path.read_bytes())[0].get("animations", [])
    return any("node" not in channel["target"] for one in animations for channel in one["channels"])


def without_animations(path: Path) -> bytes:
    """The .glb without its animations, for tools that show a file as its first one begins."""
    document, binary = split(path.read_bytes())
    document.pop("animations", None)
    return joined(document, binary)


def joined(document: dict[str, Any], binary: bytes) -> bytes:
    """A .glb of its JSON and its binary chunk."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


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
