//! Values with their first and second derivatives.
//!
//! Source: A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed. 2008, ch. 3 and 13: the chain rule to
//! second order, carried through every operation.

use super::algebra::{Algebra, Binary, Unary, minus, plus, times};
use super::interval::{Interval, Quality};
use super::noise::Cells;

/// A value and its derivatives by `N` variables; the second ones are symmetric. Without `BENDS` only the first are carried,
/// and the second stay 0: a third of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T, const N: usize, const BENDS: bool = true> {
    /// The value.
    pub value: T,
    /// First derivative by each variable.
    pub first: [T; N],
    /// Second derivative by each pair.
    pub second: [[T; N]; N],
}

/// Numbers that can tell which side of a choice they are on.
pub trait Decide: Cells {
    /// Whether the first is less: certainly, certainly not, or neither.
    fn less(self, other: Self) -> Option<bool>;

    /// The truth that it certainly is.
    fn truth(self) -> Option<bool>;

    /// Whether it is 0 and nothing else.
    fn is_zero(self) -> bool;

    /// Numbers that hold both, from a formula that is no better than this.
    #[must_use]
    fn either(self, other: Self, quality: Quality) -> Self;
}

impl Decide for f64 {
    fn less(self, other: Self) -> Option<bool> {
        Some(self < other)
    }

    fn truth(self) -> Option<bool> {
        if self.is_nan() { None } else { Some(self != 0.0) }
    }

    fn is_zero(self) -> bool {
        self == 0.0
    }

    /// Reached for what is not a number alone.
    fn either(self, _: Self, _: Quality) -> Self {
        Self::NAN
    }
}

impl Decide for Interval {
    fn less(self, other: Self) -> Option<bool> {
        // Ends that touch decide for either, since both then are equal there.
        match (Self::less(self, other), Self::less(other, self)) {
            (None, Some(false)) => Some(true),
            (known, _) => known,
        }
    }

    fn truth(self) -> Option<bool> {
        self.known()
    }

    fn is_zero(self) -> bool {
        self.low == 0.0 && self.high == 0.0
    }

    fn either(self, other: Self, quality: Quality) -> Self {
        self.hull(other).at_best(quality)
    }
}

/// How many second derivatives of a row are carried.
const fn carried<const BENDS: bool>(count: usize) -> usize {
    if BENDS { count } else { 0 }
}

impl<T: Decide, const N: usize, const BENDS: bool> Jet<T, N, BENDS> {
    /// The variable of an index, at a place.
    #[must_use]
    pub fn variable(value: T, index: usize) -> Self {
        let mut jet = Self::flat(value);
        jet.first[index] = T::constant(1.0);
        jet
    }

    /// A value that does not vary.
    #[must_use]
    pub fn flat(value: T) -> Self {
        let zero = T::constant(0.0);
        Self { value, first: [zero; N], second: [[zero; N]; N] }
    }

    /// Whether nothing here varies; then infinite slopes of what is made from it do not count.
    fn is_flat(&self) -> bool {
        let zero = |parts: &[T; N]| parts.iter().all(|part| part.is_zero());
        zero(&self.first) && (!BENDS || self.second.iter().all(zero))
    }

    /// A function of this jet, by its value and two derivatives here.
    fn chain(&self, value: T, slope: T, bend: T) -> Self {
        let mut jet = Self::flat(value);
        if self.is_flat() {
            return jet;
        }
        for i in 0..N {
            jet.first[i] = times(slope, self.first[i]);
            for j in 0..carried::<BENDS>(i + 1) {
                let squares = times(self.first[i], self.first[j]);
                jet.second[i][j] = plus(times(slope, self.second[i][j]), times(bend, squares));
                jet.second[j][i] = jet.second[i][j];
            }
        }
        jet
    }

    /// Each part of two jets put together.
    fn zip(&self, other: &Self, value: T, part: impl Fn(T, T) -> T) -> Self {
        let mut jet = Self::flat(value);
        for i in 0..N {
            jet.first[i] = part(self.first[i], other.first[i]);
            for j in 0..carried::<BENDS>(N) {
                jet.second[i][j] = part(self.second[i][j], other.second[i][j]);
            }
        }
        jet
    }

    fn product(&self, other: &Self) -> Self {
        let mut jet = Self::flat(times(self.value, other.value));
        for i in 0..N {
            jet.first[i] = plus(times(self.value, other.first[i]), times(other.value, self.first[i]));
            for j in 0..carried::<BENDS>(i + 1) {
                let straight =
                    plus(times(self.value, other.second[i][j]), times(other.value, self.second[i][j]));
                let crossed =
                    plus(times(self.first[i], other.first[j]), times(self.first[j], other.first[i]));
                jet.second[i][j] = plus(straight, crossed);
                jet.second[j][i] = jet.second[i][j];
            }
        }
        jet
    }

    /// A function of two jets, by its value, its slopes and its bends (both by the first, mixed, both by the
    /// second) here.
    fn chain_of_two(&self, other: &Self, value: T, slopes: [T; 2], bends: [T; 3]) -> Self {
        let mut jet = Self::flat(value);
        if self.is_flat() && other.is_flat() {
            return jet;
        }
        for i in 0..N {
            jet.first[i] = plus(times(slopes[0], self.first[i]), times(slopes[1], other.first[i]));
            for j in 0..carried::<BENDS>(i + 1) {
                let straight =
                    plus(times(slopes[0], self.second[i][j]), times(slopes[1], other.second[i][j]));
                let mixed = plus(times(self.first[i], other.first[j]), times(self.first[j], other.first[i]));
                let own = plus(
                    times(bends[0], times(self.first[i], self.first[j])),
                    times(bends[2], times(other.first[i], other.first[j])),
                );
                jet.second[i][j] = plus(straight, plus(own, times(bends[1], mixed)));
                jet.second[j][i] = jet.second[i][j];
            }
        }
        jet
    }

    fn either(&self, other: &Self, value: T, quality: Quality) -> Self {
        self.zip(other, value, |a, b| a.either(b, quality))
    }

    /// The jet of the lesser or the greater of two, whose value is known.
    fn extreme(&self, other: &Self, value: T, first: Option<bool>) -> Self {
        match first {
            Some(true) => Self { value, ..*self },
            Some(false) => Self { value, ..*other },
            None => self.either(other, value, Quality::Continuous),
        }
    }

    fn abs(&self, value: T) -> Self {
        let zero = T::constant(0.0);
        let negative = self.negative(value);
        match self.value.less(zero) {
            Some(true) => negative,
            Some(false) => Self { value, ..*self },
            None => self.either(&negative, value, Quality::Continuous),
        }
    }

    fn negative(&self, value: T) -> Self {
        let minus = |part: T| T::unary(Unary::Negate, part);
        self.zip(self, value, |part, _| minus(part))
    }
}

fn over<T: Algebra>(x: T, y: T) -> T {
    T::binary(Binary::Divide, x, y)
}

fn negate<T: Algebra>(x: T) -> T {
    T::unary(Unary::Negate, x)
}

/// Radians of a degree.
fn radian<T: Algebra>() -> T {
    T::rounded(core::f64::consts::PI / 180.0)
}

/// Degrees of a radian.
fn degree<T: Algebra>() -> T {
    T::rounded(180.0 / core::f64::consts::PI)
}

/// First and second derivative of a smooth function at `x`, where its value is `y`.
fn derivatives<T: Decide>(operation: Unary, x: T, y: T) -> (T, T) {
    let one = T::constant(1.0);
    let square = |x: T| T::power(x, 2.0);
    match operation {
        Unary::Sin => {
            let k = radian::<T>();
            (times(k, T::unary(Unary::Cos, x)), negate(times(square(k), y)))
        }
        Unary::Cos => {
            let k = radian::<T>();
            (negate(times(k, T::unary(Unary::Sin, x))), negate(times(square(k), y)))
        }
        Unary::Tan => {
            let k = radian::<T>();
            let slope = times(k, plus(one, square(y)));
            (slope, times(T::constant(2.0), times(k, times(y, slope))))
        }
        Unary::Asin | Unary::Acos => {
            let rest = minus(one, square(x));
            let slope = over(degree::<T>(), T::unary(Unary::Sqrt, rest));
            let slope = if operation == Unary::Acos { negate(slope) } else { slope };
            (slope, over(times(slope, x), rest))
        }
        Unary::Atan => {
            let sum = plus(one, square(x));
            let slope = over(degree::<T>(), sum);
            (slope, negate(over(times(T::constant(2.0), times(slope, x)), sum)))
        }
        Unary::Sinh => (T::unary(Unary::Cosh, x), y),
        Unary::Cosh => (T::unary(Unary::Sinh, x), y),
        Unary::Tanh => {
            let slope = minus(one, square(y));
            (slope, negate(times(T::constant(2.0), times(y, slope))))
        }
        Unary::Sqrt => {
            let slope = over(T::constant(0.5), y);
            (slope, negate(over(times(T::constant(0.5), slope), x)))
        }
        Unary::Exp => (y, y),
        Unary::Ln => {
            let slope = over(one, x);
            (slope, negate(square(slope)))
        }
        Unary::Smoothstep => smoothstep(x),
        // Operations that have no slope, or one that is not found by a formula.
        Unary::Negate | Unary::Abs | Unary::Sign | Unary::Floor | Unary::Round | Unary::Not => {
            (T::constant(0.0), T::constant(0.0))
        }
    }
}

/// Slope and bend of 3 t^2 - 2 t^3, which is constant outside of 0 to 1.
fn smoothstep<T: Decide>(x: T) -> (T, T) {
    let (zero, one) = (T::constant(0.0), T::constant(1.0));
    let inside = T::binary(Binary::Minimum, T::binary(Binary::Maximum, x, zero), one);
    let slope = times(T::constant(6.0), times(inside, minus(one, inside)));
    let bend = minus(T::constant(6.0), times(T::constant(12.0), inside));
    let bend = match (x.less(zero), one.less(x)) {
        (Some(true), _) | (_, Some(true)) => zero,
        (Some(false), Some(false)) => bend,
        // Somewhere inside and somewhere out: the bend jumps, which leaves the slope continuous.
        _ => bend.either(zero, Quality::Smooth),
    };
    (slope, bend)
}

impl<T: Decide, const N: usize, const BENDS: bool> Algebra for Jet<T, N, BENDS> {
    fn constant(value: f64) -> Self {
        Self::flat(T::constant(value))
    }

    fn rounded(value: f64) -> Self {
        Self::flat(T::rounded(value))
    }

    fn unary(operation: Unary, x: Self) -> Self {
        let value = T::unary(operation, x.value);
        match operation {
            Unary::Negate => x.negative(value),
            Unary::Abs => x.abs(value),
            Unary::Sign | Unary::Floor | Unary::Round | Unary::Not => Self::flat(value),
            _ => {
                let (slope, bend) = derivatives(operation, x.value, value);
                x.chain(value, slope, bend)
            }
        }
    }

    fn binary(operation: Binary, x: Self, y: Self) -> Self {
        let value = T::binary(operation, x.value, y.value);
        match operation {
            Binary::Add => x.zip(&y, value, plus),
            Binary::Subtract => x.zip(&y, value, minus),
            Binary::Multiply => Self { value, ..x.product(&y) },
            Binary::Divide => {
                // x / y = x times 1 / y, whose derivatives are -1 / y^2 and 2 / y^3.
                let inverse = over(T::constant(1.0), y.value);
                let square = T::power(inverse, 2.0);
                let bend = times(T::constant(2.0), times(square, inverse));
                Self { value, ..x.product(&y.chain(inverse, negate(square), bend)) }
            }
            Binary::Power => {
                let exponent = y.product(&Self::unary(Unary::Ln, x));
                Self { value, ..Self::unary(Unary::Exp, exponent) }
            }
            Binary::Atan2 => x.angle(&y, value),
            Binary::Minimum => x.extreme(&y, value, x.value.less(y.value)),
            Binary::Maximum => x.extreme(&y, value, y.value.less(x.value)),
            Binary::Less | Binary::LessOrEqual | Binary::Equal | Binary::And | Binary::Or => {
                Self::flat(value)
            }
        }
    }

    fn power(x: Self, exponent: f64) -> Self {
        let value = T::power(x.value, exponent);
        if exponent == 0.0 {
            return Self::flat(value);
        }
        let scaled = |factor: f64, exponent: f64| {
            if factor == 0.0 {
                T::constant(0.0)
            } else {
                times(T::constant(factor), T::power(x.value, exponent))
            }
        };
        let slope = scaled(exponent, exponent - 1.0);
        let bend = scaled(exponent * (exponent - 1.0), exponent - 2.0);
        x.chain(value, slope, bend)
    }

    fn select(condition: Self, yes: Self, no: Self) -> Self {
        let value = T::select(condition.value, yes.value, no.value);
        match condition.value.truth() {
            Some(true) => Self { value, ..yes },
            Some(false) => Self { value, ..no },
            None => yes.either(&no, value, Quality::Defined),
        }
    }

    fn noise(seed: f64, x: Self, y: Self) -> Self {
        let value = T::noise(seed, x.value, y.value);
        let [dx, dy, dxx, dxy, dyy] = T::slopes(seed, x.value, y.value);
        x.chain_of_two(&y, value, [dx, dy], [dxx, dxy, dyy])
    }
}

impl<T: Decide, const N: usize, const BENDS: bool> Jet<T, N, BENDS> {
    /// The angle of the point (x, self), in degrees.
    fn angle(&self, x: &Self, value: T) -> Self {
        let (y, k) = (self.value, degree::<T>());
        let square = plus(T::power(y, 2.0), T::power(x.value, 2.0));
        // By y the slope is x / r^2, by x it is -y / r^2.
        let by_y = over(x.value, square);
        let by_x = negate(over(y, square));
        let mixed = over(minus(T::power(y, 2.0), T::power(x.value, 2.0)), T::power(square, 2.0));
        let own = times(T::constant(2.0), times(by_y, by_x));
        let scaled = |part: T| times(k, part);
        let bends = [scaled(own), scaled(mixed), scaled(negate(own))];
        self.chain_of_two(x, value, [scaled(by_y), scaled(by_x)], bends)
    }
}
