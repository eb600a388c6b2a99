"""What stands in the file itself: counts, hashes, topology by exact edge counting, cache statistics.

No library measures here: numpy reads the arrays and this module counts. It covers the claims that no tool
measures in the report's own terms (`closed` counts directed edges; ACMR is a simulated cache).
"""

from __future__ import annotations

from collections import deque
from functools import cached_property
from importlib.metadata import version
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np
from blake3 import blake3
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from checks import finding, played
from checks.document import Cloud, Document, Mesh, Primitive, Target

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

TOOL = "written"
CACHE_ENTRIES = 16  # vertices in the simulated first-in-first-out cache; meshoptimizer's usual figure


def measure(path: Path) -> finding.Measured:
    """The facts of one file."""
    data = path.read_bytes()
    document = Document(path)
    totals = count(document)
    totals["bytes"] = len(data)
    totals["blake3"] = blake3(data).hexdigest()
    totals["bounds"] = world_bounds(document)
    totals["required-extensions"] = document.json.get("extensionsRequired", [])
    totals["used-extensions"] = document.json.get("extensionsUsed", [])
    totals["pictures"] = [unquote(one["uri"]) for one in document.json.get("images", []) if "uri" in one]
    shapes = {mesh.name: shape(mesh) for mesh in document.meshes}
    nodes = {name: world.T.ravel().tolist() for name, world in document.worlds.items()}
    totals["weight-faults"] = played.weight_faults(document)
    clips = played.clips(path)
    reaches, drivers = played.reaches(path), played.drivers(path)
    return finding.Measured(TOOL, version("numpy"), str(path), totals, shapes, nodes, clips, reaches, drivers)


def count(document: Document) -> dict[str, Any]:
    """Counts of the whole file; draw calls count every instance, the other sums every mesh once."""
    meshes = document.meshes
    totals = {key: len(document.json.get(key, [])) for key in ("materials", "images", "nodes")}
    totals["nodes"] -= len(document.carriers)
    totals["meshes"] = len(meshes)
    totals["primitives"] = sum(len(mesh.primitives) for mesh in meshes)
    totals["triangles"] = sum(len(mesh.triangles) for mesh in meshes)
    totals["segments"] = sum(len(mesh.lines.indices) for mesh in meshes)
    totals["vertices"] = sum(len(mesh.places) for mesh in meshes)
    totals["drawn-vertices"] = sum(drawn_vertices(mesh) for mesh in meshes)
    totals["draw-calls"] = sum(len(meshes[i].primitives) for i, _ in document.instances)
    totals["drawn-triangles"] = sum(len(meshes[i].triangles) for i, _ in document.instances)
    totals["drawn-segments"] = sum(len(meshes[i].lines.indices) for i, _ in document.instances)
    return totals


def drawn_vertices(mesh: Mesh) -> int:
    """Vertices by primitive: those that several share count once for each, as tools count that split a mesh."""
    return sum(len(p.attributes["POSITION"]) for p in mesh.primitives)


def world_bounds(document: Document) -> dict[str, list[float]]:
    """The box of all instances in world coordinates."""
    corners = []
    for index, world in document.instances:
        points = document.meshes[index].places @ world[:3, :3].T + world[:3, 3]
        corners += [points.min(axis=0), points.max(axis=0)]
    box = np.array(corners)
    return {"min": box.min(axis=0).tolist(), "max": box.max(axis=0).tolist()}


def shape(mesh: Mesh) -> dict[str, Any]:
    """The facts of one mesh."""
    points, triangles = mesh.merged
    edges = Edges(triangles)
    facts: dict[str, Any] = {
        "primitives": len(mesh.primitives),
        "triangles": len(mesh.triangles),
        "vertices": len(mesh.positions),
        "drawn-vertices": sum(len(p.attributes["POSITION"]) for p in mesh.surfaces),
        "separate-vertices": sum(len(np.unique(p.triangles)) for p in mesh.surfaces),
        "points": len(points),
        "bounds": box(mesh.places),
        "closed": len(triangles) > 0 and edges.closed,
        "manifold": len(triangles) > 0 and edges.paired and one_fan_each(len(points), triangles, edges),
        "components": components(triangles, edges),
        "euler": len(points) - edges.distinct + len(triangles),
        "boundary-edges": edges.boundary,
        "crowded-edges": edges.crowded,
        "misoriented-edges": edges.misoriented,
        "degenerate-triangles": degenerate(points, triangles),
        "collapsed-triangles": int(
            (np.sort(triangles, axis=1)[:, :-1] == np.sort(triangles, axis=1)[:, 1:]).any(axis=1).sum()
        ),
        "repeated-triangles": len(triangles) - len(np.unique(np.sort(triangles, axis=1), axis=0)),
        "largest-normal-error": max((normal_error(p) for p in mesh.surfaces), default=0.0),
        "unused-vertices": unused(mesh.surface) + unused(mesh.lines),
        "attributes": sorted({name for p in mesh.primitives for name in p.attributes}),
    }
    facts["acmr"], facts["atvr"] = cache_figures(mesh)
    facts.update(line_facts(mesh.lines))
    for target in mesh.targets:
        facts.update(morph_facts(mesh, target))
    return facts


def line_facts(lines: Cloud) -> dict[str, Any]:
    """The facts of the lines of one mesh; none where it has none. Lines hang together at shared vertices."""
    ends = lines.indices
    if not len(ends):
        return {}
    graph = coo_array((np.ones(len(ends), np.int8), (ends[:, 0], ends[:, 1])), shape=(len(lines.positions),) * 2)
    count, label = connected_components(graph, directed=False)
    joined = np.bincount(ends.ravel(), minlength=len(lines.positions))
    steps = lines.positions[ends[:, 1]] - lines.positions[ends[:, 0]]
    return {
        "lines.curves": int(count),
        "lines.closed-curves": int(count - len(np.unique(label[joined != 2]))),
        "lines.segments": len(ends),
        "lines.vertices": len(lines.positions),
        "lines.length": float(np.linalg.norm(steps, axis=1).sum()),
        "lines.bounds": box(lines.positions),
    }


def morph_facts(mesh: Mesh, target: Target) -> dict[str, Any]:
    """The facts of one morph target."""
    moved = target.attributes["POSITION"]
    normals = mesh.surfaces[0].attributes["NORMAL"] + target.attributes["NORMAL"]
    facts = {
        "weight": target.weight,
        "moved": int(moved.any(axis=1).sum()),
        "furthest": float(np.linalg.norm(moved, axis=1).max()),
        "bounds": box(mesh.positions + moved),
        "largest-normal-error": float(np.abs(np.linalg.norm(normals, axis=1) - 1).max()),
    }
    return {f"morphs.{target.name}.{fact}": value for fact, value in facts.items()}


def box(points: NDArray[np.float64]) -> dict[str, list[float]]:
    """The smallest box around points."""
    return {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}


class Edges:
    """Edges between merged points, counted in each direction; collapsed ones are left out."""

    def __init__(self, triangles: NDArray[np.int64]) -> None:
        directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        proper = directed[:, 0] != directed[:, 1]
        self.owner = np.repeat(np.arange(len(triangles)), 3)[proper]
        self.ends = directed[proper]
        forward = self.ends[:, 0] < self.ends[:, 1]
        _, which = np.unique(np.sort(self.ends, axis=1), axis=0, return_inverse=True)
        self.which = which.ravel()
        self.distinct = int(self.which.max(initial=-1)) + 1
        self.up = np.bincount(self.which[forward], minlength=self.distinct)
        self.down = np.bincount(self.which[~forward], minlength=self.distinct)

    @property
    def closed(self) -> bool:
        """Whether each edge is used equally often in both directions."""
        return bool((self.up == self.down).all())

    @property
    def paired(self) -> bool:
        """Whether each edge is used exactly once in each direction."""
        return bool(((self.up == 1) & (self.down == 1)).all())

    @property
    def boundary(self) -> int:
        """Edges that one triangle uses."""
        return int(((self.up + self.down) == 1).sum())

    @property
    def crowded(self) -> int:
        """Edges that more than two triangles use."""
        return int(((self.up + self.down) > 2).sum())

    @property
    def misoriented(self) -> int:
        """Edges that two triangles use in the same direction."""
        return int((((self.up + self.down) == 2) & (self.up != self.down)).sum())

    @cached_property
    def neighbors(self) -> NDArray[np.int64]:
        """Pairs of uses of one edge, as rows into `owner` and `ends`."""
        order = np.argsort(self.which, kind="stable")
        same = self.which[order[:-1]] == self.which[order[1:]]
        return np.stack([order[:-1][same], order[1:][same]], axis=1)


def components(triangles: NDArray[np.int64], edges: Edges) -> int:
    """Sets of triangles joined through edges."""
    return parts(len(triangles), edges.owner[edges.neighbors])


def one_fan_each(points: int, triangles: NDArray[np.int64], edges: Edges) -> bool:
    """Whether the triangles around each point are joined through edges at that point, in one fan."""
    first, second = edges.neighbors.T
    pairs = []
    for end in (0, 1):
        point = edges.ends[first, end]
        pairs.append(np.stack([corner(triangles, edges.owner[use], point) for use in (first, second)], axis=1))
    return parts(triangles.size, np.concatenate(pairs)) == points


def corner(triangles: NDArray[np.int64], which: NDArray[np.int64], point: NDArray[np.int64]) -> NDArray[np.int64]:
    """The number of the corner at which each named triangle has each named point."""
    return 3 * which + np.argmax(triangles[which] == point[:, None], axis=1)


def parts(nodes: int, pairs: NDArray[np.int64]) -> int:
    """Connected parts of a graph."""
    graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(nodes, nodes))
    return int(connected_components(graph, directed=False)[0])


def degenerate(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> int:
    """Triangles whose area is exactly zero in double precision."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return int((np.cross(b - a, c - a) == 0).all(axis=1).sum())


def normal_error(primitive: Primitive) -> float:
    """How far the longest or shortest written normal is from length one; infinite without normals."""
    normals = primitive.attributes.get("NORMAL")
    if normals is None:
        return float("inf")
    return float(np.abs(np.linalg.norm(normals.astype(float), axis=1) - 1).max())


def unused(cloud: Cloud) -> int:
    """Vertices that nothing uses."""
    used = np.zeros(len(cloud.positions), bool)
    used[cloud.indices.ravel()] = True
    return int((~used).sum())


def cache_figures(mesh: Mesh) -> tuple[float, float]:
    """(ACMR, ATVR) of the mesh's primitives: vertices shaded for each triangle, and for each vertex."""
    if not mesh.surfaces:
        return 0.0, 0.0
    shaded = sum(misses(p.triangles) for p in mesh.surfaces)
    return shaded / len(mesh.triangles), shaded / len(mesh.positions)


def misses(triangles: NDArray[np.int64]) -> int:
    """Vertices that a first-in-first-out cache has to shade."""
    held: set[int] = set()
    order: deque[int] = deque()
    shaded = 0
    for vertex in triangles.ravel().tolist():
        if vertex in held:
            continue
        shaded += 1
        held.add(vertex)
        order.append(vertex)
        if len(order) > CACHE_ENTRIES:
            held.discard(order.popleft())
    return shaded


if __name__ == "__main__":
    finding.run(TOOL, version("numpy"), measure)
