//! Rays through a face: along its normal, or from a center. One pair of plane coordinates names a ray, a third number the
//! place on it.

use glam::{DVec2, DVec3};

use crate::geometry::number::Bounds;

/// The rays of a face. A polygon on a plane, or on a ball by great circles, has straight sides in their coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rays {
    /// The center, or the point of the face with coordinates 0.
    pub(super) origin: DVec3,
    /// Directions of the coordinates, of length 1, across the axis.
    x: DVec3,
    y: DVec3,
    /// The ray with coordinates 0: from 0 to 1, or 1 long.
    axis: DVec3,
    central: bool,
}

impl Rays {
    /// All along a direction of length 1.
    pub(super) fn parallel(origin: DVec3, axis: DVec3) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        Self { origin, x, y, axis, central: false }
    }

    /// From a center; coordinates are those of the plane through the end of `axis`, across it.
    pub(super) fn central(origin: DVec3, axis: DVec3) -> Self {
        let (x, y) = axis.normalize().any_orthonormal_pair();
        Self { origin, x, y, axis, central: true }
    }

    /// Whether they come from a center.
    pub(super) fn is_central(&self) -> bool {
        self.central
    }

    /// The direction of a ray, in which the number counts.
    pub(super) fn direction(&self, at: DVec2) -> DVec3 {
        if self.central { self.axis + self.x * at.x + self.y * at.y } else { self.axis }
    }

    /// The place of a number on a ray.
    pub(super) fn point(&self, at: DVec2, number: f64) -> DVec3 {
        let start = if self.central { self.origin } else { self.origin + self.x * at.x + self.y * at.y };
        start + self.direction(at) * number
    }

    /// The ray through a point, and its number there; of rays from a center the point must lie before it.
    pub(super) fn drop(&self, point: DVec3) -> (DVec2, f64) {
        let away = point - self.origin;
        let number = away.dot(self.axis) / self.axis.length_squared();
        let across = DVec2::new(away.dot(self.x), away.dot(self.y));
        (if self.central { across / number } else { across }, number)
    }

    /// A box around a block of rays and numbers: the corners tell, since places depend on each of the three linearly.
    pub(super) fn block(&self, (low, high): (DVec2, DVec2), (from, to): (f64, f64)) -> Bounds {
        let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high];
        let places = corners.iter().flat_map(|at| [self.point(*at, from), self.point(*at, to)]);
        Bounds::of_points(places)
    }

    /// A box around the directions of a block of rays.
    pub(super) fn directions(&self, (low, high): (DVec2, DVec2)) -> Bounds {
        let corners = [low, DVec2::new(high.x, low.y), DVec2::new(low.x, high.y), high];
        Bounds::of_points(corners.iter().map(|at| self.direction(*at)))
    }

    /// Length in space of a step of 1 on a ray.
    pub(super) fn stretch(&self) -> f64 {
        self.axis.length()
    }

    /// The outward normal of the wall of rays over a side.
    pub(super) fn wall(&self, from: DVec2, to: DVec2) -> DVec3 {
        let along = self.point(to, 1.0) - self.point(from, 1.0);
        along.cross(self.direction(from)).normalize_or_zero()
    }

    /// A point of all walls over a side: the origin, or the side's start.
    pub(super) fn foot(&self, from: DVec2) -> DVec3 {
        if self.central { self.origin } else { self.point(from, 0.0) }
    }
}
