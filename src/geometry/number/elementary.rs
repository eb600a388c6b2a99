//! Transcendental functions by `libm`: equal bits on every machine.

macro_rules! door {
    ($($(#[$doc:meta])* $name:ident ( $($argument:ident),+ ) = $function:path;)+) => {$(
        $(#[$doc])*
        #[must_use]
        pub fn $name($($argument: f64),+) -> f64 {
            $function($($argument),+)
        }
    )+};
}

door! {
    /// Sine of an angle in radians.
    sin(x) = libm::sin;
    /// Cosine of an angle in radians.
    cos(x) = libm::cos;
    /// Tangent of an angle in radians.
    tan(x) = libm::tan;
    /// Angle in radians, in [-π/2, π/2], whose sine is `x`; NaN outside [-1, 1].
    asin(x) = libm::asin;
    /// Angle in radians, in [0, π], whose cosine is `x`; NaN outside [-1, 1].
    acos(x) = libm::acos;
    /// Angle in radians, in (-π/2, π/2), whose tangent is `x`.
    atan(x) = libm::atan;
    /// Angle in radians, in [-π, π], of the point (x, y).
    atan2(y, x) = libm::atan2;
    /// Hyperbolic sine.
    sinh(x) = libm::sinh;
    /// Hyperbolic cosine.
    cosh(x) = libm::cosh;
    /// Hyperbolic tangent.
    tanh(x) = libm::tanh;
    /// The number whose hyperbolic sine is `x`.
    asinh(x) = libm::asinh;
    /// e to the power `x`.
    exp(x) = libm::exp;
    /// Natural logarithm; NaN below zero.
    ln(x) = libm::log;
    /// `x` to the power `y`.
    pow(x, y) = libm::pow;
    /// Cube root.
    cbrt(x) = libm::cbrt;
    /// Length of (x, y) without overflow.
    hypot(x, y) = libm::hypot;
}

/// The light of a number for a screen, both from 0 to 1: the transfer function of sRGB (IEC 61966-2-1, 1999).
#[must_use]
pub fn srgb_to_linear(screen: f64) -> f64 {
    if screen <= 0.040_45 { screen / 12.92 } else { pow((screen + 0.055) / 1.055, 2.4) }
}

/// The number for a screen of a light, both from 0 to 1: the inverse of [`srgb_to_linear`].
#[must_use]
pub fn linear_to_srgb(light: f64) -> f64 {
    if light <= 0.040_45 / 12.92 { light * 12.92 } else { 1.055 * pow(light, 1.0 / 2.4) - 0.055 }
}

/// Sine and cosine of an angle in radians.
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}
