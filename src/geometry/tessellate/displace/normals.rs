//! Normals of what is moved: those of the exact surface in the triangles around a vertex, by their angles.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::Heights;
use super::direction::Directions;
use super::field::Facet;
use crate::geometry::mesh::Mesh;

/// A normal for each vertex. Vertices of one point that had one normal before have one after, whatever their texture.
pub(super) fn normals(
    mesh: &Mesh,
    directions: &Directions,
    heights: &Heights<'_>,
    moved: &[f64],
) -> Vec<DVec3> {
    let corners: Vec<[Option<(DVec3, f64)>; 3]> = (0..mesh.triangles.len())
        .into_par_iter()
        .with_min_len(256)
        .map(|triangle| {
            let facet = Facet::of(mesh, directions, heights, moved, triangle);
            [0, 1, 2].map(|corner| facet.normal(corner))
        })
        .collect();
    // Only looked up, never walked.
    let mut groups: HashMap<(u32, [u64; 3]), usize> = HashMap::new();
    let mut sums: Vec<DVec3> = Vec::new();
    let mut group = Vec::with_capacity(mesh.vertices.len());
    for vertex in &mesh.vertices {
        // Normals of one smooth place agree to many digits, but not to the last bit.
        let rounded = (vertex.normal * 1e5).round().to_array().map(|part| (part + 0.0).to_bits());
        let own = *groups.entry((vertex.point.0, rounded)).or_insert_with(|| {
            sums.push(DVec3::ZERO);
            sums.len() - 1
        });
        group.push(own);
    }
    for (triangle, found) in mesh.triangles.iter().zip(&corners) {
        for (corner, normal) in triangle.iter().zip(found) {
            if let Some((normal, angle)) = normal {
                sums[group[corner.subscript()]] += *normal * *angle;
            }
        }
    }
    let of =
        |(vertex, group): (&crate::geometry::mesh::Vertex, &usize)| sums[*group].normalize_or(vertex.normal);
    mesh.vertices.iter().zip(&group).map(of).collect()
}
