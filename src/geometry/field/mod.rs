//! Fields: a number at every point of space. Where it is zero lies a surface, where it is negative the inside.
//!
//! Promise: gradients are the derivatives of the values; ranges over a box hold every value inside it, up to
//! rounding of a few units in the last place. Not promised: that the value is a distance.

pub mod quadric;

pub use quadric::Quadric;

use glam::DVec3;

use super::number::Bounds;

/// A field with what a proof needs to know of it.
pub trait Field: Send + Sync {
    /// The value at a point.
    fn value(&self, point: DVec3) -> f64;

    /// Its derivative.
    fn gradient(&self, point: DVec3) -> DVec3;

    /// Least and greatest value over a box.
    fn range(&self, within: &Bounds) -> (f64, f64);

    /// A box that holds the gradients over a box.
    fn gradient_range(&self, within: &Bounds) -> Bounds;

    /// A bound on the size of the second derivative in any direction, over a box.
    fn bend(&self, within: &Bounds) -> f64;
}
