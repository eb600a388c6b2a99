//! Second derivatives of a surface through curves over a rectangle of its parameters.

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::number::Bounds;
use crate::geometry::surface::SecondRange;

/// What is known of a curve on an interval of u.
#[derive(Clone, Copy, Default)]
pub(super) struct Stretch {
    /// Middle of the box of the second derivative, and half its size.
    center: DVec3,
    radius: DVec3,
    /// Place and derivative in the middle of the interval.
    point: DVec3,
    first: DVec3,
}

impl Stretch {
    pub(super) fn new(curve: &AnyCurve, u: (f64, f64)) -> Option<Self> {
        let range = curve.second_range(u.0, u.1)?;
        let jet = curve.evaluate((u.0 + u.1) / 2.0, Side::After);
        let radius = (range.max - range.min) / 2.0;
        Some(Self { center: range.center(), radius, point: jet.point, first: jet.first })
    }
}

/// An interval of v where every weight is one cubic.
pub(super) struct Piece {
    step: f64,
    /// The weights that matter.
    pub(super) weights: Vec<Weight>,
}

/// The weight of a curve with its derivatives, at both ends of an interval where it is cubic.
pub(super) struct Weight {
    /// Which curve.
    pub(super) curve: usize,
    start: [f64; 3],
    end: [f64; 3],
    /// Greatest sizes in between.
    most: [f64; 3],
}

impl Weight {
    pub(super) fn new(curve: usize, (start, end): ([f64; 3], [f64; 3]), step: f64) -> Self {
        let ends = |k: usize| start[k].abs().max(end[k].abs());
        let most = [
            ends(0) + ends(2) * step * step / 8.0,
            ends(1) + (end[2] - start[2]).abs() * step / 8.0,
            ends(2),
        ];
        Self { curve, start, end, most }
    }
}

impl Piece {
    pub(super) fn new(step: f64, weights: Vec<Weight>) -> Self {
        Self { step, weights }
    }

    /// Ranges over the piece. With u = m + d around the middle of a range of half width h, and each curve's second
    /// derivatives within r of a center c, both by coordinates:
    ///
    /// - `P_uu = sum w C''` lies within `sum |w| r` of `sum w c`;
    /// - `P_uv = sum w' C'` within `h (|sum w' c| + sum |w'| r)` of `sum w' C'(m)`;
    /// - `P_vv = sum w'' C` within `h |sum w'' C'(m)| + h^2 / 2 (|sum w'' c| + sum |w''| r)` of `sum w'' C(m)`.
    ///
    /// Sums are taken before sizes, so what cancels does not count; over v they are polynomials.
    pub(super) fn range<'a>(&self, half: f64, stretch: impl Fn(usize) -> &'a Stretch) -> SecondRange {
        let step = self.step;
        let mut bends = [Ends::default(); 3];
        let mut speeds = [Ends::default(); 2];
        let mut places = Ends::default();
        let mut loose = [DVec3::ZERO; 3];
        for weight in &self.weights {
            let Stretch { center, radius, point, first } = stretch(weight.curve);
            for k in 0..3 {
                bends[k].add(*center, weight, k);
                loose[k] += *radius * weight.most[k];
            }
            speeds[0].add(*first, weight, 1);
            speeds[1].add(*first, weight, 2);
            places.add(*point, weight, 2);
        }
        // Values between the ends are those of a chord, and what a bounded second derivative adds; a first derivative
        // of a cubic has a second one that is the same all over; a second derivative is linear.
        let uu = widened(&bends[0].range(), bends[2].size() * (step * step / 8.0) + loose[0]);
        let bend_1 = bends[1].size() + bends[2].change() * (step / 8.0) + loose[1];
        let bend_2 = bends[2].size() + loose[2];
        let uv = widened(&speeds[0].range(), speeds[1].change() * (step / 8.0) + bend_1 * half);
        let vv = widened(&places.range(), speeds[1].size() * half + bend_2 * (half * half / 2.0));
        SecondRange { uu, uv, vv }
    }
}

/// A sum of vectors by one derivative of their weights, at both ends of a piece.
#[derive(Clone, Copy, Default)]
struct Ends {
    start: DVec3,
    end: DVec3,
}

impl Ends {
    fn add(&mut self, vector: DVec3, weight: &Weight, derivative: usize) {
        self.start += vector * weight.start[derivative];
        self.end += vector * weight.end[derivative];
    }

    fn range(&self) -> Bounds {
        Bounds { min: self.start.min(self.end), max: self.start.max(self.end) }
    }

    /// The greater size, by coordinates.
    fn size(&self) -> DVec3 {
        self.start.abs().max(self.end.abs())
    }

    fn change(&self) -> DVec3 {
        (self.end - self.start).abs()
    }
}

/// The boxes that hold those of both.
pub(super) fn union(one: SecondRange, other: SecondRange) -> SecondRange {
    SecondRange { uu: one.uu.union(other.uu), uv: one.uv.union(other.uv), vv: one.vv.union(other.vv) }
}

fn widened(range: &Bounds, by: DVec3) -> Bounds {
    Bounds { min: range.min - by, max: range.max + by }
}
