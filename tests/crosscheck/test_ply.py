"""PLY files that pymeshlab writes, held against what it knows of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pymeshlab
import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from kiln import Kiln


def written(path: Path, *, binary: bool, colored: bool) -> pymeshlab.MeshSet:
    """A bumpy ball with normals of its points, in a file."""
    meshes = pymeshlab.MeshSet()
    meshes.create_sphere(radius=1.0, subdiv=3)
    meshes.compute_coord_by_function(x="x * (1 + 0.1 * sin(5 * y))", y="y", z="z * 1.5")
    meshes.compute_normal_per_vertex()
    meshes.compute_color_by_function_per_vertex(x="120 + 100 * x", y="90 + 60 * y", z="130 + 80 * z", a="255")
    meshes.save_current_mesh(
        str(path), binary=binary, save_vertex_normal=True, save_vertex_color=colored, save_wedge_texcoord=False
    )
    return meshes


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("colored", [False, True])
def test_files_of_meshlab_are_read(kiln: Kiln, binary: bool, colored: bool) -> None:
    """Points, faces, normals and colors."""
    meshes = written(kiln.folder / "ball.ply", binary=binary, colored=colored)
    spec = '[shape.b.import]\nfile = "ball.ply"\n'
    baked = kiln.bake(spec)
    own = meshes.current_mesh()
    facts = baked.shape("b")
    assert (facts["points"], facts["triangles"]) == (own.vertex_number(), own.face_number())
    measures = meshes.get_geometric_measures()
    assert facts["volume"] == pytest.approx(measures["mesh_volume"], rel=1e-5)
    assert facts["area"] == pytest.approx(measures["surface_area"], rel=1e-5)
    mesh = baked.document.meshes[0]
    wanted = own.vertex_normal_matrix()
    wanted = wanted / np.linalg.norm(wanted, axis=1, keepdims=True)
    places = own.vertex_matrix()
    normals = mesh.surfaces[0].attributes["NORMAL"]
    for place, normal in zip(mesh.positions[::9], normals[::9], strict=True):
        nearest = int(np.linalg.norm(places - place, axis=1).argmin())
        assert np.abs(wanted[nearest] - normal).max() < 1e-4
    shades = mesh.surfaces[0].attributes.get("COLOR_0")
    assert (shades is not None) == colored
    if colored:
        screen = np.round(own.vertex_color_matrix()[:, :3] * 255) / 255
        for place, shade in zip(mesh.positions[::7], shades[::7], strict=True):
            nearest = int(np.linalg.norm(places - place, axis=1).argmin())
            # By the standard's own formula, to one step of the byte that a file holds.
            dark, light = screen[nearest] / 12.92, ((screen[nearest] + 0.055) / 1.055) ** 2.4
            assert np.abs(np.where(screen[nearest] <= 0.04045, dark, light) - shade).max() < 0.01


def test_a_file_that_is_cut_off_is_refused(kiln: Kiln) -> None:
    """With what is missing."""
    path = kiln.folder / "ball.ply"
    written(path, binary=True, colored=False)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 2])
    kiln.write('[shape.b.import]\nfile = "ball.ply"\n')
    done = kiln.run("bake", "model.toml", "--out", "out")
    assert done.returncode == 1
    assert "error[K0851]" in done.stderr
    assert "element `face`" in done.stderr or "element `vertex`" in done.stderr
