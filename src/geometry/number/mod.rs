//! Numbers: the one door to transcendental functions, angles in degrees, and tolerances.
//!
//! Promise: every function here gives the same bits on every machine (they are `libm`'s, plain IEEE
//! arithmetic without fused operations). The standard library's `sin`, `powf`, `hypot`, ... differ between
//! platforms and are banned by lint. Not promised: correctly rounded results; `libm` is within 1 ulp.

mod angle;
mod elementary;
mod fan;
mod noise;
mod sparse;
mod symmetric;
mod tolerance;
mod whole;

pub use angle::{cos_degrees, sin_cos_degrees, sin_degrees, tan_degrees};
pub use elementary::{
    acos, asin, asinh, atan, atan2, cbrt, cos, cosh, exp, hypot, linear_to_srgb, ln, pow, sin, sin_cos, sinh,
    srgb_to_linear, tan, tanh,
};
pub use fan::{FAN, in_fan};
pub use noise::{noise, noise_gradient};
pub use sparse::{Factors, NotPositive, Plan, Symmetric, dissection};
pub use symmetric::{PrincipalAxes, principal_axes};
pub use tolerance::{Bounds, single_rounding};
pub use whole::{count_of, floor_count, floor_index, floor_large, single, size};
