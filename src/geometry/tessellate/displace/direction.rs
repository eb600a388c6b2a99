//! The way that each point of a mesh is moved.

use glam::{DMat3, DVec3};

use super::super::deform::Splitter;
use super::MITER;
use crate::geometry::mesh::Mesh;

/// For each point its way for a height of 1, and whether the mesh is smooth there.
pub(super) struct Directions {
    ways: Vec<DVec3>,
    smooth: Vec<bool>,
}

/// Normals that differ by less are one.
const SAME: f64 = 1e-6;

impl Directions {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut normals: Vec<Vec<DVec3>> = vec![Vec::new(); mesh.points.len()];
        for corner in mesh.triangles.iter().flatten() {
            let vertex = mesh.vertices[corner.subscript()];
            let own = &mut normals[vertex.point.subscript()];
            if own.iter().all(|known| known.distance(vertex.normal) > SAME) {
                own.push(vertex.normal);
            }
        }
        let ways = normals.iter().map(|own| miter(own)).collect();
        let smooth = normals.iter().map(|own| own.len() <= 1).collect();
        Self { ways, smooth }
    }

    /// The way of a point.
    pub(super) fn at(&self, point: usize) -> DVec3 {
        self.ways[point]
    }

    pub(super) fn is_smooth(&self, point: usize) -> bool {
        self.smooth[point]
    }

    /// Ways of the points that the last split has made.
    pub(super) fn follow(&mut self, splitter: &Splitter<'_>) {
        for (a, b, part) in
            &splitter.parents[splitter.parents.len() - (splitter.mesh.points.len() - self.ways.len())..]
        {
            let (a, b) = (*a as usize, *b as usize);
            let way = self.ways[a].lerp(self.ways[b], *part);
            let smooth = self.smooth[a] && self.smooth[b];
            self.ways.push(if smooth { way.normalize_or(self.ways[a]) } else { way });
            self.smooth.push(smooth);
        }
    }
}

/// The shortest way w with w . n = 1 for all normals that meet, or nearest to that in the mean.
fn miter(normals: &[DVec3]) -> DVec3 {
    let Some(first) = normals.first() else { return DVec3::ZERO };
    if normals.len() == 1 {
        return *first;
    }
    let sum: DVec3 = normals.iter().sum();
    let mut matrix = DMat3::ZERO;
    for normal in normals {
        matrix += DMat3::from_cols(*normal * normal.x, *normal * normal.y, *normal * normal.z);
    }
    // A little of the unit matrix leaves directions out that no normal speaks of.
    let damped = matrix + DMat3::IDENTITY * (1e-9 * normals.len() as f64);
    let way = damped.inverse() * sum;
    let length = way.length();
    if length.is_finite() && length > 0.0 { way * (MITER / length).min(1.0) } else { *first }
}
