//! Surfaces: points, tangents and normals over two parameters.
//!
//! Promise: each surface is continuous over its domain, its tangents are the derivatives of its points, and
//! its normal is the unit cross product of the tangents, or at a pole the limit. Not promised: that the
//! surface does not cross itself.

mod extruded;
mod frame;
mod revolved;
mod swept;

pub use extruded::ExtrudedSurface;
pub use frame::{Frame, FrameField};
pub use revolved::RevolvedSurface;
pub use swept::{Section, SweptSurface};

use glam::DVec3;

use super::curve::Domain;

/// Point and first derivatives of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJet {
    /// Position, metres.
    pub point: DVec3,
    /// Derivative by u.
    pub du: DVec3,
    /// Derivative by v.
    pub dv: DVec3,
    /// Unit normal, outward.
    pub normal: DVec3,
}

/// A parametric surface.
pub trait Surface: Send + Sync {
    /// Interval of u.
    fn domain_u(&self) -> Domain;

    /// Interval of v.
    fn domain_v(&self) -> Domain;

    /// Point, tangents and normal; parameters outside the domain are taken as the nearer end.
    fn evaluate(&self, u: f64, v: f64) -> SurfaceJet;
}
