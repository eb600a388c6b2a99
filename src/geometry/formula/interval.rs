//! Intervals of numbers, rounded outward.
//!
//! Source: R. Moore, R. Kearfott, M. Cloud, Introduction to Interval Analysis, 2009, ch. 2 to 5. Sums and
//! products are widened by one unit in the last place; transcendental functions by four, since `libm` is
//! within one and the way from degrees adds two.

use super::algebra::{Algebra, Binary, Unary, power, truth};
use super::noise::noise_over;
use crate::geometry::number;

/// How a formula behaves over a box, from worst to best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// It may have no value somewhere.
    Unknown,
    /// It has a value everywhere and may jump.
    Defined,
    /// It is continuous and may have kinks.
    Continuous,
    /// Where the bounds on its derivatives are finite these are continuous.
    Smooth,
}

/// All numbers from `low` to `high`, which may be infinite, and how they came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Least number.
    pub low: f64,
    /// Greatest number.
    pub high: f64,
    /// What is known of the formula that gave it.
    pub quality: Quality,
}

impl Interval {
    /// All numbers.
    pub const ENTIRE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY, quality: Quality::Smooth };

    /// The numbers from `low` to `high`.
    #[must_use]
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high, quality: Quality::Smooth }
    }

    /// Whether it holds a number.
    #[must_use]
    pub fn contains(&self, number: f64) -> bool {
        self.low <= number && number <= self.high
    }

    /// Whether both ends are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// The greatest size of its numbers.
    #[must_use]
    pub fn size(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// Distance from end to end.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.high - self.low
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            quality: self.quality.min(other.quality),
        }
    }

    /// The same numbers, known to be of this quality at best.
    #[must_use]
    pub fn at_best(self, quality: Quality) -> Self {
        Self { quality: self.quality.min(quality), ..self }
    }

    /// Nothing is known: an operation may have no value.
    fn unknown() -> Self {
        Self { quality: Quality::Unknown, ..Self::ENTIRE }
    }

    /// From rounded ends, widened by a few units in the last place and kept within `least` and `most`.
    fn outward(low: f64, high: f64, (least, most): (f64, f64), quality: Quality) -> Self {
        if low.is_nan() || high.is_nan() {
            return Self::unknown();
        }
        Self { low: down(low, 4).max(least), high: up(high, 4).min(most), quality }
    }

    /// A rising function of its ends.
    fn rising(self, function: fn(f64) -> f64, range: (f64, f64)) -> Self {
        Self::outward(function(self.low), function(self.high), range, self.quality)
    }

    fn sin(self) -> Self {
        if self.width() >= 360.0 || !self.is_finite() {
            return Self { low: -1.0, high: 1.0, quality: self.quality };
        }
        // The first place at or after the start where the sine is 1, and where it is -1.
        let next = |peak: f64| ((self.low - peak) / 360.0).ceil() * 360.0 + peak;
        let (a, b) = (number::sin_degrees(self.low), number::sin_degrees(self.high));
        let high = if next(90.0) <= self.high { 1.0 } else { a.max(b) };
        let low = if next(-90.0) <= self.high { -1.0 } else { a.min(b) };
        Self::outward(low, high, (-1.0, 1.0), self.quality)
    }

    fn cos(self) -> Self {
        if self.width() >= 360.0 || !self.is_finite() {
            return Self { low: -1.0, high: 1.0, quality: self.quality };
        }
        let next = |peak: f64| ((self.low - peak) / 360.0).ceil() * 360.0 + peak;
        let (a, b) = (number::cos_degrees(self.low), number::cos_degrees(self.high));
        let high = if next(0.0) <= self.high { 1.0 } else { a.max(b) };
        let low = if next(180.0) <= self.high { -1.0 } else { a.min(b) };
        Self::outward(low, high, (-1.0, 1.0), self.quality)
    }

    fn tan(self) -> Self {
        let pole = ((self.low + 90.0) / 180.0).floor();
        if !self.is_finite() || self.width() >= 180.0 || pole != ((self.high + 90.0) / 180.0).floor() {
            return Self::unknown();
        }
        let (low, high) = (number::tan_degrees(self.low), number::tan_degrees(self.high));
        if low <= high { Self::outward(low, high, ALL, self.quality) } else { Self::unknown() }
    }

    /// An inverse sine or cosine, which is defined from -1 to 1.
    fn arc(self, function: fn(f64) -> f64, falling: bool) -> Self {
        let inside = self.low >= -1.0 && self.high <= 1.0;
        let (low, high) = (self.low.clamp(-1.0, 1.0), self.high.clamp(-1.0, 1.0));
        let (low, high) = if falling { (high, low) } else { (low, high) };
        let range = if falling { (0.0, 180.0) } else { (-90.0, 90.0) };
        let quality = if inside { self.quality } else { Quality::Unknown };
        Self::outward(function(low).to_degrees(), function(high).to_degrees(), range, quality)
    }

    fn cosh(self) -> Self {
        let (a, b) = (number::cosh(self.low), number::cosh(self.high));
        let low = if self.contains(0.0) { 1.0 } else { a.min(b) };
        Self::outward(low, a.max(b), (1.0, f64::INFINITY), self.quality)
    }

    fn sqrt(self) -> Self {
        let quality = if self.low >= 0.0 { self.quality } else { Quality::Unknown };
        let (low, high) = (self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        let low = if low == 0.0 { 0.0 } else { down(low, 1) };
        Self { low, high: up(high, 1), quality }
    }

    fn ln(self) -> Self {
        if self.low > 0.0 {
            return self.rising(number::ln, ALL);
        }
        let high = if self.high > 0.0 { up(number::ln(self.high), 4) } else { f64::INFINITY };
        Self { low: f64::NEG_INFINITY, high, quality: Quality::Unknown }
    }

    fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            Self { low: -self.high, high: -self.low, ..self }
        } else {
            Self { low: 0.0, high: self.size(), quality: self.quality.min(Quality::Continuous) }
        }
    }

    /// A function that is constant but for jumps.
    fn stepped(self, function: fn(f64) -> f64) -> Self {
        let (low, high) = (function(self.low), function(self.high));
        let jumps = if low == high { Quality::Smooth } else { Quality::Defined };
        Self { low, high, quality: self.quality.min(jumps) }
    }

    fn smoothstep(self) -> Self {
        let step = |x: f64| f64::unary(Unary::Smoothstep, x);
        // At both ends of the step the second derivative jumps.
        let bends = (self.low < 0.0 && self.high > 0.0) || (self.low < 1.0 && self.high > 1.0);
        let quality = if bends { Quality::Continuous } else { Quality::Smooth };
        self.rising(step, (0.0, 1.0)).at_best(quality)
    }

    fn add(self, other: Self) -> Self {
        let quality = self.quality.min(other.quality);
        let (low, high) = (self.low + other.low, self.high + other.high);
        if low.is_nan() || high.is_nan() {
            return Self { quality, ..Self::ENTIRE };
        }
        // An operand that is 0 adds nothing, not even rounding.
        let exact = |a: f64, b: f64| a == 0.0 || b == 0.0;
        Self {
            low: if exact(self.low, other.low) { low } else { down(low, 1) },
            high: if exact(self.high, other.high) { high } else { up(high, 1) },
            quality,
        }
    }

    fn negate(self) -> Self {
        Self { low: -self.high, high: -self.low, ..self }
    }

    fn multiply(self, other: Self) -> Self {
        let quality = self.quality.min(other.quality);
        let ends = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        let low = ends.iter().map(|(low, _)| *low).fold(f64::INFINITY, f64::min);
        let high = ends.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
        Self { low, high, quality }
    }

    fn divide(self, other: Self) -> Self {
        if other.contains(0.0) {
            // One-sided quotients keep their sign, which shows that a formula with a pole runs one way.
            if other.low == 0.0 && other.high > 0.0 && (self.low > 0.0 || self.high < 0.0) {
                let near = self.divide(Self { low: other.high, ..other });
                let positive = self.low > 0.0;
                let (low, high) =
                    if positive { (near.low, f64::INFINITY) } else { (f64::NEG_INFINITY, near.high) };
                return Self { low, high, quality: Quality::Unknown };
            }
            return Self::unknown();
        }
        let quality = self.quality.min(other.quality);
        let ends = [
            quotient(self.low, other.low),
            quotient(self.low, other.high),
            quotient(self.high, other.low),
            quotient(self.high, other.high),
        ];
        let low = ends.iter().map(|(low, _)| *low).fold(f64::INFINITY, f64::min);
        let high = ends.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
        Self { low, high, quality }
    }

    /// A power that does not vary.
    fn power(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return Self { low: 1.0, high: 1.0, ..self };
        }
        let whole = exponent.fract() == 0.0;
        if exponent < 0.0 {
            let below = self.power(-exponent);
            return Self { low: 1.0, high: 1.0, quality: Quality::Smooth }.divide(below);
        }
        if !whole && self.low < 0.0 {
            let high = up(power(self.high.max(0.0), exponent), 4);
            return Self { low: 0.0, high, quality: Quality::Unknown };
        }
        let even = whole && (exponent / 2.0).fract() == 0.0;
        let (a, b) = (power(self.low, exponent), power(self.high, exponent));
        if !even {
            let least = if whole { f64::NEG_INFINITY } else { 0.0 };
            let low = if a == 0.0 { a } else { down(a, 4) };
            let high = if b == 0.0 { b } else { up(b, 4) };
            return Self { low: low.max(least), high, quality: self.quality };
        }
        let low = if self.contains(0.0) { 0.0 } else { down(a.min(b), 4).max(0.0) };
        Self { low, high: up(a.max(b), 4), quality: self.quality }
    }

    /// A power that varies: e to the power y ln x.
    fn power_of(self, exponent: Self) -> Self {
        if self.low > 0.0 {
            return exponent.multiply(self.ln()).rising(number::exp, (0.0, f64::INFINITY));
        }
        Self::unknown()
    }

    fn atan2(self, x: Self) -> Self {
        let quality = self.quality.min(x.quality);
        let around = self.contains(0.0) && x.contains(0.0);
        // Behind the origin the angle jumps by a full turn.
        let across = self.low < 0.0 && self.high >= 0.0 && x.low < 0.0;
        if around || across || !self.is_finite() || !x.is_finite() {
            let quality = if around { Quality::Unknown } else { quality.min(Quality::Defined) };
            return Self { low: -180.0, high: 180.0, quality };
        }
        let corners = [(self.low, x.low), (self.low, x.high), (self.high, x.low), (self.high, x.high)];
        let angles = corners.map(|(y, x)| number::atan2(y, x).to_degrees());
        let low = angles.iter().copied().fold(f64::INFINITY, f64::min);
        let high = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::outward(low, high, (-180.0, 180.0), quality)
    }

    /// Whether it is less than another: certainly, certainly not, or neither.
    pub(super) fn less(self, other: Self) -> Option<bool> {
        if self.high < other.low {
            Some(true)
        } else if self.low >= other.high {
            Some(false)
        } else {
            None
        }
    }

    fn comparison(self, other: Self, known: Option<bool>) -> Self {
        let quality = self.quality.min(other.quality);
        match known {
            Some(holds) => Self { low: truth(holds), high: truth(holds), quality },
            None => Self { low: 0.0, high: 1.0, quality: quality.min(Quality::Defined) },
        }
    }

    fn equal(self, other: Self) -> Option<bool> {
        if self.high < other.low || other.high < self.low {
            Some(false)
        } else {
            (self.low == self.high && other.low == other.high).then_some(true)
        }
    }

    /// The truth that it certainly is.
    pub(super) fn known(self) -> Option<bool> {
        if self.low >= 1.0 {
            Some(true)
        } else if self.high <= 0.0 {
            Some(false)
        } else {
            None
        }
    }
}

const ALL: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn down(number: f64, steps: u32) -> f64 {
    (0..steps).fold(number, |number, _| number.next_down())
}

fn up(number: f64, steps: u32) -> f64 {
    (0..steps).fold(number, |number, _| number.next_up())
}

/// A product, rounded down and up; nothing times anything is nothing.
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let exact = a.abs() == 1.0 || b.abs() == 1.0;
    let value = a * b;
    if exact { (value, value) } else { (value.next_down(), value.next_up()) }
}

/// A quotient of a divisor that is not 0, rounded down and up.
fn quotient(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 {
        return (0.0, 0.0);
    }
    let value = a / b;
    if value.is_nan() {
        return ALL;
    }
    (value.next_down(), value.next_up())
}

impl Algebra for Interval {
    fn constant(value: f64) -> Self {
        Self::new(value, value)
    }

    fn rounded(value: f64) -> Self {
        Self::new(value.next_down(), value.next_up())
    }

    fn unary(operation: Unary, x: Self) -> Self {
        match operation {
            Unary::Negate => x.negate(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.arc(number::asin, false),
            Unary::Acos => x.arc(number::acos, true),
            Unary::Atan => x.rising(|x| number::atan(x).to_degrees(), (-90.0, 90.0)),
            Unary::Sinh => x.rising(number::sinh, ALL),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.rising(number::tanh, (-1.0, 1.0)),
            Unary::Sqrt => x.sqrt(),
            Unary::Exp => x.rising(number::exp, (0.0, f64::INFINITY)),
            Unary::Ln => x.ln(),
            Unary::Abs => x.abs(),
            Unary::Sign => x.stepped(|x| f64::unary(Unary::Sign, x)),
            Unary::Floor => x.stepped(f64::floor),
            Unary::Round => x.stepped(f64::round),
            Unary::Smoothstep => x.smoothstep(),
            Unary::Not => x.comparison(x, x.equal(Self::new(0.0, 0.0))),
        }
    }

    fn binary(operation: Binary, x: Self, y: Self) -> Self {
        match operation {
            Binary::Add => x.add(y),
            Binary::Subtract => x.add(y.negate()),
            Binary::Multiply => x.multiply(y),
            Binary::Divide => x.divide(y),
            Binary::Power => x.power_of(y),
            Binary::Atan2 => x.atan2(y),
            Binary::Minimum => y.negate().greater(x.negate()).negate(),
            Binary::Maximum => x.greater(y),
            Binary::Less => x.comparison(y, x.less(y)),
            Binary::LessOrEqual => x.comparison(y, y.less(x).map(|less| !less)),
            Binary::Equal => x.comparison(y, x.equal(y)),
            Binary::And => x.both(y),
            Binary::Or => {
                let not = |x: Self| Self { low: 1.0 - x.high, high: 1.0 - x.low, ..x };
                not(not(x).both(not(y)))
            }
        }
    }

    fn power(x: Self, exponent: f64) -> Self {
        Self::power(x, exponent)
    }

    fn select(condition: Self, yes: Self, no: Self) -> Self {
        match condition.known() {
            Some(true) => yes.at_best(condition.quality),
            Some(false) => no.at_best(condition.quality),
            None => yes.hull(no).at_best(condition.quality.min(Quality::Defined)),
        }
    }

    fn noise(seed: f64, x: Self, y: Self) -> Self {
        noise_over(seed, x, y)
    }
}

impl Interval {
    fn greater(self, other: Self) -> Self {
        let hidden = |winner: Self, loser: Self| {
            // The lesser has no say in how smooth the greater is, unless it may have no value.
            if loser.quality == Quality::Unknown { winner.at_best(Quality::Unknown) } else { winner }
        };
        match (self.less(other), other.less(self)) {
            (Some(true), _) | (None, Some(false)) => hidden(other, self),
            (Some(false), _) | (None, Some(true)) => hidden(self, other),
            (None, None) => Self {
                low: self.low.max(other.low),
                high: self.high.max(other.high),
                quality: self.quality.min(other.quality).min(Quality::Continuous),
            },
        }
    }

    fn both(self, other: Self) -> Self {
        let quality = self.quality.min(other.quality);
        Self { low: self.low.min(other.low), high: self.high.min(other.high), quality }
    }
}
