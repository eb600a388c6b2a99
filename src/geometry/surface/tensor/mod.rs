//! Tensor-product surfaces: sums of control points weighed by one polynomial in u and one in v.
//!
//! Promise: every kind is brought to Bezier pieces by convex combinations alone where that is possible, so that
//! the surface lies in the hull of its control points to the last bits; second derivatives are bounded by hulls,
//! rational ones too. Degrees go up to [`MOST_DEGREE`]. Not promised: that control points which tangle make
//! surfaces that do not.
//!
//! Sources: G. Farin, Curves and Surfaces for CAGD, 5th ed. 2002, chapters 14 to 16; L. Piegl, W. Tiller, The
//! NURBS Book, 2nd ed. 1997.

mod bernstein;
mod bicubic;
mod construct;
mod grid;
mod net;
mod normal;
mod patches;
mod polynomial;
mod range;
mod rational;
mod spline;

pub use bernstein::MOST_DEGREE;
pub use bicubic::{BicubicError, HermiteGrid, bicubic, hermite, reflected, wrapped};
pub use construct::{ConstructError, Motion, plain, revolved, ruled, swept, translational};
pub use grid::Grid;
pub use patches::PatchesError;
pub use polynomial::PolynomialSurface;
pub use rational::{RationalError, RationalSurface};
pub use spline::TensorSpline;
