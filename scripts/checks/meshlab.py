"""What MeshLab finds: topology, geometry, self-intersections; the file is opened by its own reader too."""

from __future__ import annotations

import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pymeshlab

from checks import finding
from checks.document import Document, Mesh, points_at_properties, without_animations, without_lines

TOOL = "meshlab"
VERSION = version("pymeshlab")


def measure(path: Path) -> finding.Measured:
    """The facts of one file: totals by MeshLab's own reader, shapes from arrays with merged positions.

    Lines are taken out before: MeshLab reads their indices as those of triangles. So are animations with channels
    that name no node, which it refuses.
    """
    meshes = Document(path).meshes
    surfaces = [mesh for mesh in meshes if mesh.surfaces]
    totals = {"drawn-triangles": drawn(path, any(len(mesh.lines.indices) for mesh in meshes)) if surfaces else 0}
    shapes = {mesh.name: shape(mesh) if mesh.surfaces else {} for mesh in meshes}
    for mesh in surfaces:
        if len(mesh.lines.indices):
            del shapes[mesh.name]["bounds"]
    return finding.Measured(TOOL, VERSION, str(path), totals, shapes)


def drawn(path: Path, has_lines: bool) -> int:
    """The triangles that MeshLab's own reader finds."""
    opened = pymeshlab.MeshSet()
    with tempfile.TemporaryDirectory() as folder:
        shown = path
        if has_lines:
            shown = Path(folder) / "surfaces.glb"
            shown.write_bytes(without_lines(path))
        if points_at_properties(path):
            still = without_animations(shown)
            shown = Path(folder) / "still.glb"
            shown.write_bytes(still)
        opened.load_new_mesh(str(shown))
    return sum(opened.mesh(i).face_number() for i in range(opened.mesh_number()))


def shape(mesh: Mesh) -> dict[str, Any]:
    """The facts of one mesh."""
    points, triangles = mesh.merged
    layers = pymeshlab.MeshSet()
    layers.add_mesh(pymeshlab.Mesh(points, triangles))
    geometry = layers.get_geometric_measures()
    topology = layers.get_topological_measures()
    layers.compute_selection_by_self_intersections_per_face()
    box = geometry["bbox"]
    facts: dict[str, Any] = {
        "points": int(topology["vertices_number"]),
        "triangles": int(topology["faces_number"]),
        "bounds": {"min": box.min().tolist(), "max": box.max().tolist()},
        "area": float(geometry["surface_area"]),
        "boundary-edges": int(topology["boundary_edges"]),
        "components": int(topology["connected_components_number"]),
        "euler": int(topology["vertices_number"] - topology["edges_number"] + topology["faces_number"]),
        "self-intersections": layers.current_mesh().selected_face_number(),
    }
    two_manifold = bool(topology["is_mesh_two_manifold"])
    facts["edge-manifold"] = two_manifold and facts["boundary-edges"] == 0
    if two_manifold:
        facts["boundary-loops"] = int(topology["number_holes"])
    if two_manifold and facts["boundary-edges"] == 0:
        facts["closed-volume"] = float(geometry["mesh_volume"])
        facts["solid-centroid"] = geometry["center_of_mass"].tolist()
        facts["solid-inertia"] = geometry["inertia_tensor"].tolist()
        facts["manifold-genus"] = int(topology["genus"])
    return facts


if __name__ == "__main__":
    finding.run(TOOL, VERSION, measure)
