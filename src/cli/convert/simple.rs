//! Faces whose corners are all different.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::geometry::mesh::PolygonMesh;
use crate::geometry::mesh::triangulate::triangulate_in_space;

/// The mesh with those faces in triangles that come back to one of their points, as files write a face with a hole by an
/// edge to and fro; and how many these were. Triangles that have a point twice are left out: they have no area.
pub(super) fn simple(mesh: PolygonMesh) -> (PolygonMesh, usize) {
    let twice = |face: &usize| {
        let mut seen = BTreeSet::new();
        !mesh.corners_of(*face).all(|corner| seen.insert(mesh.corners[corner].0))
    };
    let parted: BTreeSet<usize> = (0..mesh.faces.len()).filter(twice).collect();
    if parted.is_empty() {
        return (mesh, 0);
    }
    let mut out = PolygonMesh {
        corners: Vec::new(),
        loop_ends: Vec::new(),
        faces: Vec::new(),
        corner_uvs: Vec::new(),
        corner_normals: Vec::new(),
        corner_colors: Vec::new(),
        ..mesh.clone()
    };
    for face in 0..mesh.faces.len() {
        let rings: Vec<Vec<usize>> =
            mesh.loops_of(face).map(|ring| mesh.corners_of_loop(ring).collect()).collect();
        if !parted.contains(&face) {
            push(&mut out, &mesh, face, &rings);
            continue;
        }
        let places: Vec<Vec<DVec3>> =
            (rings.iter()).map(|ring| ring.iter().map(|&corner| mesh.position(corner)).collect()).collect();
        let places: Vec<&[DVec3]> = places.iter().map(Vec::as_slice).collect();
        let corners = rings.concat();
        let triangles = triangulate_in_space(&places).map(|found| found.0).unwrap_or_default();
        for triangle in triangles {
            let ring = triangle.map(|corner| corners[corner as usize]);
            let [a, b, c] = ring.map(|corner| mesh.corners[corner].0);
            if a != b && b != c && c != a {
                push(&mut out, &mesh, face, &[ring.to_vec()]);
            }
        }
    }
    (out, parted.len())
}

/// Adds a face made of corners of another mesh.
fn push(out: &mut PolygonMesh, mesh: &PolygonMesh, face: usize, rings: &[Vec<usize>]) {
    let points: Vec<Vec<u32>> =
        rings.iter().map(|ring| ring.iter().map(|&corner| mesh.corners[corner].0).collect()).collect();
    let loops: Vec<&[u32]> = points.iter().map(Vec::as_slice).collect();
    let written = mesh.faces[face];
    out.push_face(&loops, written.material, written.smoothing);
    for &corner in rings.iter().flatten() {
        out.corner_uvs.extend(mesh.corner_uvs.get(corner));
        out.corner_normals.extend(mesh.corner_normals.get(corner));
        out.corner_colors.extend(mesh.corner_colors.get(corner));
    }
}
