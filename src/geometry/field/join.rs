//! Fields put together: sums, unions, intersections, differences, sharp or blended.
//!
//! Sources: V. Rvachev, Theory of R-functions, 1982 (the system R0: a + b - sqrt(a² + b²)); I. Quilez, Smooth minimum,
//! 2013 (the quadratic blend: within a distance k of equality a parabola takes the place of the kink, lowered by k / 4
//! at most).

use glam::DVec3;

use crate::geometry::formula::{Algebra, Binary, Interval, Quality, Unary, minus, plus, times};

/// How fields are put together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// All points of any.
    Union(Blend),
    /// The points of all.
    Intersection(Blend),
    /// The points of the first that belong to no other.
    Difference(Blend),
}

/// What happens where surfaces meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blend {
    /// A sharp edge, by the lesser or the greater value.
    Sharp,
    /// A sharp edge on the surface; smooth everywhere else (R-functions).
    Rvachev,
    /// A fillet, where values differ by less than this.
    Smooth(f64),
}

impl Join {
    /// Two fields put together.
    pub(super) fn apply<S: Algebra>(self, one: S, other: S) -> S {
        let negative = |x: S| S::unary(Unary::Negate, x);
        match self {
            Self::Union(blend) => blend.union(one, other),
            Self::Intersection(blend) => negative(blend.union(negative(one), negative(other))),
            Self::Difference(blend) => negative(blend.union(negative(one), other)),
        }
    }
}

/// Bounds on a value and its slopes.
pub(super) struct Slopes {
    pub(super) value: Interval,
    pub(super) first: [Interval; 3],
}

impl Slopes {
    fn negative(&self) -> Self {
        let negative = |x: Interval| <Interval as Algebra>::unary(Unary::Negate, x);
        Self { value: negative(self.value), first: self.first.map(negative) }
    }
}

impl Join {
    /// Two values with their gradients put together.
    pub(super) fn apply_with_slopes(self, one: (f64, DVec3), other: (f64, DVec3)) -> (f64, DVec3) {
        let negative = |(value, slope): (f64, DVec3)| (-value, -slope);
        match self {
            Self::Union(blend) => blend.union_with_slopes(one, other),
            Self::Intersection(blend) => negative(blend.union_with_slopes(negative(one), negative(other))),
            Self::Difference(blend) => negative(blend.union_with_slopes(negative(one), other)),
        }
    }

    /// The same of bounds.
    pub(super) fn apply_in_boxes(self, one: &Slopes, other: &Slopes) -> Slopes {
        match self {
            Self::Union(blend) => blend.union_in_boxes(one, other),
            Self::Intersection(blend) => blend.union_in_boxes(&one.negative(), &other.negative()).negative(),
            Self::Difference(blend) => blend.union_in_boxes(&one.negative(), other).negative(),
        }
    }
}

impl Blend {
    fn union_with_slopes(self, (a, da): (f64, DVec3), (b, db): (f64, DVec3)) -> (f64, DVec3) {
        match self {
            // What has no value keeps having none.
            Self::Sharp if a.is_nan() || b.is_nan() => (f64::NAN, DVec3::NAN),
            Self::Sharp => {
                if a <= b {
                    (a, da)
                } else {
                    (b, db)
                }
            }
            Self::Rvachev => {
                let root = (a * a + b * b).sqrt();
                (a + b - root, da * (1.0 - a / root) + db * (1.0 - b / root))
            }
            Self::Smooth(size) => {
                // The factor of the share's own slope, a - b - size (1 - 2 share), is 0 wherever the share varies.
                let share = (0.5 + 0.5 * (b - a) / size).clamp(0.0, 1.0);
                (b + share * (a - b) - size * share * (1.0 - share), da * share + db * (1.0 - share))
            }
        }
    }

    fn union_in_boxes(self, a: &Slopes, b: &Slopes) -> Slopes {
        let number = |x: f64| Interval::new(x, x);
        let value = self.union(a.value, b.value);
        let mix = |share: Interval, other: Interval| {
            [0, 1, 2].map(|k| plus(times(share, a.first[k]), times(other, b.first[k])))
        };
        match self {
            Self::Sharp if a.value.high <= b.value.low => Slopes { value, first: a.first },
            Self::Sharp if b.value.high <= a.value.low => Slopes { value, first: b.first },
            Self::Sharp => Slopes {
                value: value.at_best(Quality::Continuous),
                first: [0, 1, 2].map(|k| a.first[k].hull(b.first[k]).at_best(Quality::Continuous)),
            },
            Self::Rvachev => {
                let root = <Interval as Algebra>::unary(
                    Unary::Sqrt,
                    plus(
                        <Interval as Algebra>::power(a.value, 2.0),
                        <Interval as Algebra>::power(b.value, 2.0),
                    ),
                );
                let share = |x: Interval| {
                    let part = <Interval as Algebra>::binary(Binary::Divide, x, root);
                    // A side of a triangle is no longer than the longest: from -1 to 1, whatever the bounds say.
                    minus(number(1.0), Interval::new(part.low.max(-1.0), part.high.min(1.0)))
                };
                let kinked = root.low <= 0.0;
                let first = mix(share(a.value), share(b.value));
                let quality = if kinked { Quality::Continuous } else { Quality::Smooth };
                Slopes { value: value.at_best(quality), first }
            }
            Self::Smooth(size) => {
                let raw = plus(number(0.5), times(number(0.5 / size), minus(b.value, a.value)));
                let (low, high) = (raw.low.clamp(0.0, 1.0), raw.high.clamp(0.0, 1.0));
                let first = mix(Interval::new(low, high), Interval::new(1.0 - high, 1.0 - low));
                // The blend is smooth though its parts are found by the lesser and the greater.
                let quality = a.value.quality.min(b.value.quality);
                Slopes { value: Interval { quality, ..value }, first }
            }
        }
    }

    fn union<S: Algebra>(self, one: S, other: S) -> S {
        match self {
            Self::Sharp => S::binary(Binary::Minimum, one, other),
            Self::Rvachev => {
                let square = plus(S::power(one, 2.0), S::power(other, 2.0));
                minus(plus(one, other), S::unary(Unary::Sqrt, square))
            }
            Self::Smooth(size) => {
                let (half, full) = (S::constant(0.5), S::constant(1.0));
                let raw = plus(half, times(S::constant(0.5 / size), minus(other, one)));
                let share =
                    S::binary(Binary::Maximum, S::binary(Binary::Minimum, raw, full), S::constant(0.0));
                let mixed = plus(other, times(share, minus(one, other)));
                minus(mixed, times(S::constant(size), times(share, minus(full, share))))
            }
        }
    }

    /// How far a union may reach beyond its parts.
    pub(super) fn reach(self) -> f64 {
        if let Self::Smooth(size) = self { size / 4.0 } else { 0.0 }
    }
}
