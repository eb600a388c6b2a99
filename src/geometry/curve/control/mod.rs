//! Control points: Bernstein and B-spline polynomials, and the operations that change their form but not the
//! curve.
//!
//! Everything here is generic over the coefficient: numbers, points, points in homogeneous coordinates.
//!
//! Sources: G. Farin, Curves and Surfaces for CAGD, 5th ed. 2002; L. Piegl, W. Tiller, The NURBS Book, 2nd ed.
//! 1997; L. Ramshaw, Blossoms are polar forms, CAGD 6 (1989).

mod bernstein;
mod bspline;
mod knots;
mod matrix;
mod stop;

pub(crate) use bernstein::with_part;
pub use bernstein::{
    binomial, de_casteljau, elevate, evenly, from_power, hodograph, horner, jet, product, restrict, split,
    to_power,
};
pub use bspline::BSpline;
pub use knots::{KnotError, Knots};
pub use matrix::{BasisMatrix, coefficients, convert};
pub use stop::stops;

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

/// What can be a control point: anything that can be added and scaled.
pub trait Control:
    Copy + Debug + Default + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl<T> Control for T where
    T: Copy + Debug + Default + PartialEq + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>
{
}

/// The point that divides the way from `a` to `b` as `t` divides 0 to 1; exactly `a` at 0 and `b` at 1.
#[inline]
pub(crate) fn between<P: Control>(a: P, b: P, t: f64) -> P {
    a * (1.0 - t) + b * t
}
