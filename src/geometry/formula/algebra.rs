//! What a formula computes with: one set of operations for numbers, intervals and jets of both.

use crate::geometry::number;

/// Operations on one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// With the other sign.
    Negate,
    /// Sine of degrees.
    Sin,
    /// Cosine of degrees.
    Cos,
    /// Tangent of degrees.
    Tan,
    /// Degrees whose sine it is.
    Asin,
    /// Degrees whose cosine it is.
    Acos,
    /// Degrees whose tangent it is.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Square root.
    Sqrt,
    /// e to its power.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Size without sign.
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// The whole number at or below.
    Floor,
    /// The nearest whole number, halves away from 0.
    Round,
    /// 3 t^2 - 2 t^3 between 0 and 1, constant outside; its first derivative is continuous.
    Smoothstep,
    /// 1 where it is 0, else 0: truths are 1 and 0.
    Not,
}

/// Operations on two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// Sum.
    Add,
    /// Difference.
    Subtract,
    /// Product.
    Multiply,
    /// Quotient.
    Divide,
    /// Power; the exponent varies, so the base must not be negative.
    Power,
    /// Degrees of the point (second, first).
    Atan2,
    /// The lesser.
    Minimum,
    /// The greater.
    Maximum,
    /// 1 where the first is less, else 0.
    Less,
    /// 1 where the first is less or equal, else 0.
    LessOrEqual,
    /// 1 where both are equal, else 0.
    Equal,
    /// 1 where both truths are.
    And,
    /// 1 where one of the truths is.
    Or,
}

/// Numbers that a formula can be evaluated in.
pub trait Algebra: Copy {
    /// An exact constant.
    fn constant(value: f64) -> Self;

    /// A constant that stands for a number within one unit in the last place of it, such as pi.
    fn rounded(value: f64) -> Self {
        Self::constant(value)
    }

    /// Applies an operation to one operand.
    fn unary(operation: Unary, x: Self) -> Self;

    /// Applies an operation to two operands.
    fn binary(operation: Binary, x: Self, y: Self) -> Self;

    /// `x` to a power that does not vary.
    fn power(x: Self, exponent: f64) -> Self;

    /// The second operand where the first is 1, the third where it is 0.
    fn select(condition: Self, yes: Self, no: Self) -> Self;

    /// Gradient noise.
    fn noise(seed: f64, x: Self, y: Self) -> Self;
}

/// Sum.
#[must_use]
pub fn plus<T: Algebra>(x: T, y: T) -> T {
    T::binary(Binary::Add, x, y)
}

/// Difference.
#[must_use]
pub fn minus<T: Algebra>(x: T, y: T) -> T {
    T::binary(Binary::Subtract, x, y)
}

/// Product.
#[must_use]
pub fn times<T: Algebra>(x: T, y: T) -> T {
    T::binary(Binary::Multiply, x, y)
}

/// A truth as a number.
pub(super) fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// `x` to a power; small whole powers are multiplied out.
pub(super) fn power(x: f64, exponent: f64) -> f64 {
    if exponent == 2.0 {
        x * x
    } else if exponent == 3.0 {
        x * x * x
    } else if exponent == 1.0 {
        x
    } else {
        number::pow(x, exponent)
    }
}

impl Algebra for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn unary(operation: Unary, x: Self) -> Self {
        match operation {
            Unary::Negate => -x,
            Unary::Sin => number::sin_degrees(x),
            Unary::Cos => number::cos_degrees(x),
            Unary::Tan => number::tan_degrees(x),
            Unary::Asin => number::asin(x).to_degrees(),
            Unary::Acos => number::acos(x).to_degrees(),
            Unary::Atan => number::atan(x).to_degrees(),
            Unary::Sinh => number::sinh(x),
            Unary::Cosh => number::cosh(x),
            Unary::Tanh => number::tanh(x),
            Unary::Sqrt => x.sqrt(),
            Unary::Exp => number::exp(x),
            Unary::Ln => number::ln(x),
            Unary::Abs => x.abs(),
            Unary::Sign if x == 0.0 || x.is_nan() => x,
            Unary::Sign => x.signum(),
            Unary::Floor => x.floor(),
            Unary::Round => x.round(),
            Unary::Smoothstep => {
                let t = if x.is_nan() { x } else { x.clamp(0.0, 1.0) };
                t * t * (3.0 - 2.0 * t)
            }
            Unary::Not if x.is_nan() => x,
            Unary::Not => truth(x == 0.0),
        }
    }

    fn binary(operation: Binary, x: Self, y: Self) -> Self {
        match operation {
            Binary::Add => x + y,
            Binary::Subtract => x - y,
            Binary::Multiply => x * y,
            Binary::Divide => x / y,
            Binary::Power => number::pow(x, y),
            // Zero has one sign, or the angle behind the origin would have two.
            Binary::Atan2 => number::atan2(x + 0.0, y).to_degrees(),
            // What has no value keeps having none: a comparison would hide it.
            _ if x.is_nan() || y.is_nan() => Self::NAN,
            Binary::Minimum => x.min(y),
            Binary::Maximum => x.max(y),
            Binary::Less => truth(x < y),
            Binary::LessOrEqual => truth(x <= y),
            Binary::Equal => truth(x == y),
            Binary::And => truth(x != 0.0 && y != 0.0),
            Binary::Or => truth(x != 0.0 || y != 0.0),
        }
    }

    fn power(x: Self, exponent: f64) -> Self {
        power(x, exponent)
    }

    fn select(condition: Self, yes: Self, no: Self) -> Self {
        if condition == 1.0 {
            yes
        } else if condition == 0.0 {
            no
        } else {
            Self::NAN
        }
    }

    fn noise(seed: f64, x: Self, y: Self) -> Self {
        number::noise(seed, x, y)
    }
}
