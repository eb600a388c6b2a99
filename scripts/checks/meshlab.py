"""What MeshLab finds: topology, geometry, self-intersections; the file is opened by its own reader too."""

from __future__ import annotations

from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import pymeshlab

from checks import finding
from checks.document import Document, Mesh

if TYPE_CHECKING:
    from pathlib import Path

TOOL = "meshlab"
VERSION = version("pymeshlab")


def measure(path: Path) -> finding.Measured:
    """The facts of one file: totals by MeshLab's own reader, shapes from arrays with merged positions."""
    opened = pymeshlab.MeshSet()
    opened.load_new_mesh(str(path))
    layers = [opened.mesh(i) for i in range(opened.mesh_number())]
    totals = {"drawn-triangles": sum(layer.face_number() for layer in layers)}
    shapes = {mesh.name: shape(mesh) for mesh in Document(path).meshes}
    return finding.Measured(TOOL, VERSION, str(path), totals, shapes)


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
