//! Fields of simple bodies: signed distances, negative inside.
//!
//! Promise: the value is the distance to the surface with its sign, exactly for every kind but [`Primitive::Cone`], which
//! near its rim and tip gives less outside; slopes are bounded by 1. Written once for every kind of number, so that
//! derivatives and ranges follow. Bodies without a round edge are given by their nearest side where only one is near,
//! which keeps their ranges tight along flat sides.
//!
//! Source: J. Hart, Sphere Tracing, The Visual Computer 12 (1996), appendix A.

use glam::DVec3;

use crate::geometry::formula::{Algebra, Binary, Unary, minus, plus, times};
use crate::geometry::number::{Bounds, hypot};

/// A body around the origin; those with an axis have it along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A box, its edges rounded by a radius.
    Box {
        /// Half of its edges' lengths, rounding included.
        half: DVec3,
        /// Radius of its edges.
        radius: f64,
    },
    /// A cylinder.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Half of its height.
        half: f64,
    },
    /// A cylinder with round ends.
    Capsule {
        /// Its radius.
        radius: f64,
        /// Half of the distance between the middles of its ends.
        half: f64,
    },
    /// A ring.
    Torus {
        /// From the middle to the middle of the tube.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// A cone, whole or cut off.
    Cone {
        /// Radius at the bottom.
        bottom: f64,
        /// Radius at the top.
        top: f64,
        /// Half of its height.
        half: f64,
    },
    /// A half space, the side that the normal points away from.
    Plane {
        /// Unit normal.
        normal: DVec3,
        /// Distance of the plane from the origin along it.
        offset: f64,
    },
}

fn less<S: Algebra>(x: S, y: S) -> S {
    S::binary(Binary::Less, x, y)
}

fn least<S: Algebra>(x: S, y: S) -> S {
    S::binary(Binary::Minimum, x, y)
}

fn most<S: Algebra>(x: S, y: S) -> S {
    S::binary(Binary::Maximum, x, y)
}

/// Length of what lies beyond zero.
fn beyond<S: Algebra>(parts: &[S]) -> S {
    let zero = S::constant(0.0);
    let squares = parts.iter().map(|part| S::power(most(*part, zero), 2.0));
    S::unary(Unary::Sqrt, squares.reduce(plus).unwrap_or(zero))
}

fn length<S: Algebra>(x: S, y: S) -> S {
    S::unary(Unary::Sqrt, plus(S::power(x, 2.0), S::power(y, 2.0)))
}

impl Primitive {
    /// The field in any kind of number.
    pub(super) fn evaluate<S: Algebra>(&self, [x, y, z]: [S; 3]) -> S {
        let constant = S::constant;
        let zero = constant(0.0);
        let abs = |x: S| S::unary(Unary::Abs, x);
        match *self {
            Self::Sphere { radius } => {
                let square = plus(plus(S::power(x, 2.0), S::power(y, 2.0)), S::power(z, 2.0));
                minus(S::unary(Unary::Sqrt, square), constant(radius))
            }
            Self::Box { half, radius } => {
                let [a, b, c] = [(x, half.x), (y, half.y), (z, half.z)]
                    .map(|(x, half)| minus(abs(x), constant(half - radius)));
                let greatest = most(most(a, b), c);
                // Where at most one of them is beyond its side, the distance is the greatest.
                let second = most(least(a, b), least(most(a, b), c));
                let distance = S::select(less(zero, second), beyond(&[a, b, c]), greatest);
                minus(distance, constant(radius))
            }
            Self::Cylinder { radius, half } => {
                let (a, b) = (minus(length(x, z), constant(radius)), minus(abs(y), constant(half)));
                S::select(less(zero, least(a, b)), beyond(&[a, b]), most(a, b))
            }
            Self::Capsule { radius, half } => {
                let along = minus(y, most(least(y, constant(half)), constant(-half)));
                let square = plus(plus(S::power(x, 2.0), S::power(along, 2.0)), S::power(z, 2.0));
                minus(S::unary(Unary::Sqrt, square), constant(radius))
            }
            Self::Torus { major, minor } => {
                minus(length(minus(length(x, z), constant(major)), y), constant(minor))
            }
            Self::Cone { bottom, top, half } => {
                let slant = hypot(bottom - top, 2.0 * half);
                let (out, up) = (2.0 * half / slant, (bottom - top) / slant);
                let middle = f64::midpoint(bottom, top);
                let side =
                    plus(times(constant(out), minus(length(x, z), constant(middle))), times(constant(up), y));
                most(side, minus(abs(y), constant(half)))
            }
            Self::Plane { normal, offset } => {
                let sum = plus(times(constant(normal.x), x), times(constant(normal.y), y));
                minus(plus(sum, times(constant(normal.z), z)), constant(offset))
            }
        }
    }

    /// Whether it has edges.
    pub(super) fn has_edges(&self) -> bool {
        match self {
            Self::Box { radius, .. } => *radius == 0.0,
            Self::Cylinder { .. } | Self::Cone { .. } => true,
            Self::Sphere { .. } | Self::Capsule { .. } | Self::Torus { .. } | Self::Plane { .. } => false,
        }
    }

    /// A box around the body; none where it has no end.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        let half = match *self {
            Self::Sphere { radius } => DVec3::splat(radius),
            Self::Box { half, .. } => half,
            Self::Cylinder { radius, half } => DVec3::new(radius, half, radius),
            Self::Capsule { radius, half } => DVec3::new(radius, half + radius, radius),
            Self::Torus { major, minor } => DVec3::new(major + minor, minor, major + minor),
            Self::Cone { bottom, top, half } => DVec3::new(bottom.max(top), half, bottom.max(top)),
            Self::Plane { .. } => return None,
        };
        Some(Bounds { min: -half, max: half })
    }
}
