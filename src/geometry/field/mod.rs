//! Fields: a number at every point of space. Where it is zero lies a surface, where it is negative the inside.
//!
//! Promise: gradients are the derivatives of the values; ranges over a box hold every value inside it, up to
//! rounding of a few units in the last place. Not promised: that the value is a distance.

mod any;
mod bump;
mod distance;
#[cfg(test)]
mod distance_tests;
mod element;
mod join;
mod line;
mod normal_cone;
mod owner;
mod primitive;
pub mod quadric;
mod relief;
mod shapes;
mod sheet;
mod skeleton;
#[cfg(test)]
mod tests;
mod tree;

pub use any::AnyField;
pub use bump::{Bump, Perturbed};
pub use distance::Distance;
pub use element::{Element, Form};
pub use join::{Blend, Join};
pub use line::Line;
pub use primitive::Primitive;
pub use quadric::Quadric;
pub use relief::{Relief, ReliefBump, Zone};
pub use sheet::Sheet;
pub use skeleton::{Potential, Skeleton};
pub use tree::{Joined, Placed, Sum};

use glam::DVec3;

use super::formula::Interval;
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

/// What is known of a field over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Study {
    /// Bounds on its values; their quality says how the field behaves.
    pub value: Interval,
    /// Bounds on its derivatives.
    pub gradient: [Interval; 3],
}

impl Study {
    /// Whether gradients at any two places of the box point less than a right angle apart, so that the surface in it is
    /// the graph of one function.
    #[must_use]
    pub fn turns_little(&self) -> bool {
        let product = |part: &Interval| {
            let (low, high) = (part.low, part.high);
            if low <= 0.0 && high >= 0.0 { low * high } else { (low * low).min(high * high) }
        };
        let least: f64 = self.gradient.iter().map(product).sum();
        least > 0.0
    }
}
