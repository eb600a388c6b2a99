"""What trimesh finds: volume and moments, watertightness, Euler number, world bounds through its scene."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh

from checks import finding
from checks.document import Document, with_materials, without_lines

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

TOOL = "trimesh"
MOST_SAMPLES = 4000  # places at which the distance between two levels of detail is measured


def measure(path: Path) -> finding.Measured:
    """The facts of one file. A mesh of several primitives becomes several geometries, joined again here.

    Lines are taken out before: trimesh reads pairs of vertices as one strip. So it is silent on what has lines.
    """
    lines = {mesh.name for mesh in Document(path).meshes if len(mesh.lines.indices)}
    several = any(
        p.material is None for mesh in Document(path).meshes for p in mesh.primitives if len(mesh.primitives) > 1
    )
    opened: BytesIO | Path = path
    if lines or several:
        opened = BytesIO(with_materials(without_lines(path) if lines else path.read_bytes()))
    kind = None if opened is path else "glb"
    scene = trimesh.load_scene(opened, file_type=kind, process=False, merge_primitives=True)
    totals: dict[str, Any] = {"triangles": sum(len(mesh.faces) for mesh in scene.geometry.values())}
    if not lines:
        totals["meshes"] = len(scene.geometry)
    if not lines and not Document(path).json.get("skins"):  # which it does not know
        low, high = scene.bounds
        totals["bounds"] = {"min": low.tolist(), "max": high.tolist()}
    shapes = {name: shape(mesh) for name, mesh in scene.geometry.items()}
    for name, mesh in scene.geometry.items():
        finest = scene.geometry.get(name.rpartition("_LOD")[0])
        if finest is not None:
            shapes[name] |= {"level-distance": distance(mesh, finest), "level-lost": distance(finest, mesh)}
    for name in lines & set(shapes):
        del shapes[name]["bounds"]
    shapes |= {name: {} for name in lines - set(shapes)}
    nodes = {name: scene.graph[name][0].T.ravel().tolist() for name in scene.graph.nodes}
    totals["colliders"] = colliders(path, scene)
    return finding.Measured(TOOL, trimesh.__version__, str(path), totals, shapes, nodes)


def colliders(path: Path, scene: trimesh.Scene) -> dict[str, dict[str, Any]]:
    """The bodies in the extras of nodes, by name: volume, corners of hulls, and how far meshes reach out of them."""
    meshes = {name: np.asarray(mesh.vertices) for name, mesh in scene.geometry.items()}
    wholes: dict[str, list[dict[str, Any]]] = {}
    for node in Document(path).json.get("nodes", []):
        for told in node.get("extras", {}).get("colliders", []):
            wholes.setdefault(told.get("part-of", told["name"]), []).append(told)
    found = {}
    for whole, parts in wholes.items():
        made = [body(told) for told in parts]
        facts: dict[str, Any] = {"volume": float(sum(one.volume for one in made))}
        if "part-of" in parts[0]:
            facts["parts"] = len(parts)
        if parts[0]["shape"] == "hull":
            facts["vertices"] = sum(len(told["points"]) for told in parts)
            facts["convex"] = all(one.is_convex and one.is_watertight for one in made)
        facts["outside"] = {name: away(parts, made, points) for name, points in meshes.items()}
        found[whole] = facts
    return found


def away(parts: list[dict[str, Any]], made: list[Any], points: NDArray[np.float64]) -> float:
    """How far the farthest of some points is outside of all parts."""
    each = []
    for told, one in zip(parts, made, strict=True):
        x, y, z, w = told["rotation"]
        turn = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
        each.append(outside(told, one, (points - told["translation"]) @ turn))
    return max(0.0, float(np.min(each, axis=0).max()))


def body(told: dict[str, Any]) -> Any:
    """A body about its middle, round ones along z as trimesh has them."""
    if told["shape"] == "box":
        return trimesh.primitives.Box(extents=told["size"])
    if told["shape"] == "sphere":
        return trimesh.primitives.Sphere(radius=told["radius"])
    if told["shape"] == "hull":
        faces = np.reshape(told["indices"], (-1, 3))
        return trimesh.Trimesh(np.array(told["points"], float), faces, process=False)
    kind = {"capsule": trimesh.primitives.Capsule, "cylinder": trimesh.primitives.Cylinder}[told["shape"]]
    return kind(radius=told["radius"], height=told["height"])


def outside(told: dict[str, Any], made: Any, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far points are outside of a body, less than 0 inside; of hulls how far above the plane of a face."""
    height = told.get("height", 0.0)
    across, along = np.hypot(points[:, 0], points[:, 2]), np.abs(points[:, 1])
    if told["shape"] == "box":
        away = (np.abs(points) - np.array(told["size"]) / 2).max(axis=1)
    elif told["shape"] == "sphere":
        away = np.linalg.norm(points, axis=1) - told["radius"]
    elif told["shape"] == "capsule":
        away = np.hypot(across, np.maximum(along - height / 2, 0.0)) - told["radius"]
    elif told["shape"] == "cylinder":
        away = np.maximum(across - told["radius"], along - height / 2)
    else:
        planes = made.face_normals
        away = (points @ planes.T - np.einsum("ij,ij->i", planes, made.triangles[:, 0])).max(axis=1)
    return np.asarray(away)


def distance(one: trimesh.Trimesh, other: trimesh.Trimesh) -> float:
    """How far the farthest of corners and middles of a surface is from another."""
    return float(other.nearest.on_surface(samples(one))[1].max())


def samples(mesh: trimesh.Trimesh) -> NDArray[np.float64]:
    """Corners and middles of the triangles of a mesh, at most some thousands, evenly chosen."""
    points = np.concatenate([mesh.vertices[np.unique(mesh.faces)], mesh.triangles_center])
    return points[:: len(points) // MOST_SAMPLES + 1]


def shape(raw: trimesh.Trimesh) -> dict[str, Any]:
    """The facts of one mesh, after merging vertices at equal positions."""
    mesh = trimesh.Trimesh(raw.vertices, raw.faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    facts: dict[str, Any] = {
        "triangles": len(raw.faces),
        "drawn-vertices": len(raw.vertices),
        "points": len(mesh.vertices),
        "bounds": {"min": mesh.bounds[0].tolist(), "max": mesh.bounds[1].tolist()},
        "area": float(mesh.area),
        "edge-manifold": bool(mesh.is_watertight and mesh.is_winding_consistent),
        "euler": int(mesh.euler_number),
        "boundary-edges": len(trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)),
    }
    uses = np.unique(mesh.edges_sorted, axis=0, return_counts=True)[1]
    facts["crowded-edges"] = int((uses > 2).sum())
    if not facts["crowded-edges"]:  # trimesh joins no faces across such edges
        labels = trimesh.graph.connected_component_labels(mesh.face_adjacency, node_count=len(mesh.faces))
        facts["components"] = len(np.unique(labels))
    solid = trimesh.triangles.mass_properties(mesh.triangles)
    facts["closed-volume"] = float(solid["volume"])
    facts["solid-centroid"] = solid["center_mass"].tolist()
    facts["solid-inertia"] = solid["inertia"].tolist()
    sheet = np.average(mesh.triangles_center, axis=0, weights=mesh.area_faces)
    facts["surface-centroid"] = sheet.tolist()
    facts["surface-inertia"] = surface_inertia(mesh.triangles - sheet, mesh.area_faces).tolist()
    return facts


def surface_inertia(corners: NDArray[np.float64], areas: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inertia about the origin of a sheet that weighs one for each unit of area.

    For a triangle with corners a, b, c and area A the second moment is
    A / 12 (aa' + bb' + cc' + (a + b + c)(a + b + c)').
    """
    sums = corners.sum(axis=1)
    second = np.einsum("t,tci,tcj->ij", areas, corners, corners)
    second += np.einsum("t,ti,tj->ij", areas, sums, sums)
    second /= 12
    return np.trace(second) * np.eye(3) - second


if __name__ == "__main__":
    finding.run(TOOL, trimesh.__version__, measure)
