//! Frames along a curve, by one of three rules.
//!
//! *Rotation-minimizing* frames move along the path without turning about it (see [`transport`]). *Frenet* frames
//! hold their side toward the center of the bend. *Up* frames hold their up as near to one direction as the path
//! lets them.
//!
//! Frames of every rule are continuous along each smooth piece of the path. At a corner the section stands in the
//! bisecting plane, so the frames before and after must agree under the least rotation from one direction to
//! the other: where a rule does not give that, and where a closed path does not come back to the frame it began
//! with, the difference is spread evenly over the length, as a twist.

mod field;
mod frenet;
#[cfg(test)]
mod tests;
mod transport;
mod turns;

pub use field::FrameField;

use glam::DVec3;

use crate::geometry::number::{atan2, sin_cos};

/// Three perpendicular unit vectors on a path: `side` x `up` = `along`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// A section's x.
    pub side: DVec3,
    /// A section's y.
    pub up: DVec3,
    /// The direction of the path.
    pub along: DVec3,
}

/// What decides how a section stands across its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrameRule {
    /// It turns about the path no more than the path makes it.
    RotationMinimizing,
    /// The side looks to the center of the bend. Where the path bends the other way after an inflection it looks
    /// from the center instead of jumping; straight parts turn evenly from the bend before to the one after, and
    /// a path that bends nowhere has rotation-minimizing frames.
    Frenet,
    /// The section's up is as near to this direction as can be. The path must not run along it.
    Up(DVec3),
}

/// How a section is carried along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carry {
    /// The rule of the frames.
    pub rule: FrameRule,
    /// Turn about the path from start to end on top of that, degrees.
    pub twist: f64,
}

impl Carry {
    /// Rotation-minimizing frames without a twist.
    pub const PLAIN: Self = Self { rule: FrameRule::RotationMinimizing, twist: 0.0 };
}

impl Frame {
    fn new(side: DVec3, along: DVec3) -> Self {
        let side = (side - along * side.dot(along)).normalize_or(along.any_orthonormal_vector());
        Self { side, up: along.cross(side), along }
    }

    /// The frame at a start: up is as near to +y as can be; where the path itself runs along y, side is +x.
    fn first(along: DVec3) -> Self {
        let level = DVec3::Y.cross(along);
        // Nearer than this to the vertical, "up" is no guide.
        if level.length() > 1e-6 { Self::new(level, along) } else { Self::new(DVec3::X, along) }
    }

    fn turned(self, radians: f64) -> Self {
        if radians == 0.0 {
            return self;
        }
        let (sin, cos) = sin_cos(radians);
        Self { side: self.side * cos + self.up * sin, up: self.up * cos - self.side * sin, along: self.along }
    }

    /// Angle in radians about the path, from this frame's side to a direction.
    fn angle_to(&self, direction: DVec3) -> f64 {
        atan2(direction.dot(self.up), direction.dot(self.side))
    }
}

/// An angle in radians brought into [-π, π] by whole turns.
fn wrapped(angle: f64) -> f64 {
    let turn = core::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}
