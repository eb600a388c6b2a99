//! States of a geometry, as a file holds them.

use glam::DVec3;

use super::Geometry;
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::Deviation;

/// A state: where everything is at weight 1. The triangles are those of the geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTarget {
    /// Its name.
    pub name: String,
    /// The weight where no motion changes it.
    pub weight: f64,
    /// For each point of the mesh its place.
    pub points: Vec<DVec3>,
    /// For each vertex of the mesh its unit normal.
    pub normals: Vec<DVec3>,
    /// For each vertex its tangent, where the geometry has tangents.
    pub tangents: Option<Vec<[f32; 3]>>,
    /// Distance from the exact state before rounding.
    pub deviation: Deviation,
    /// Distance that was asked for, metres; `None` where a fixed grid or no surface made the mesh.
    pub tolerance: Option<f64>,
}

impl MorphTarget {
    /// How far the furthest point is from where it is at weight 0, metres.
    #[must_use]
    pub fn furthest(&self, points: &[DVec3]) -> f64 {
        self.points.iter().zip(points).map(|(to, from)| to.distance(*from)).fold(0.0, f64::max)
    }
}

impl Geometry {
    /// The greatest bound of the distances from the exact shape, at rest and in every state, metres.
    #[must_use]
    pub fn deviation_of_all(&self) -> f64 {
        self.targets.iter().map(|target| target.deviation.bound).fold(self.deviation.bound, f64::max)
    }

    /// The box of all points, at rest and in every state.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let states = self.targets.iter().flat_map(|target| &target.points);
        Bounds::of_points(self.mesh.points.iter().chain(states).copied()).union(self.wire.bounds())
    }
}
