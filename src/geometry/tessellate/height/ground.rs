//! What lattices are laid over: heights above a plane, or points of a curved skin.
//!
//! Everything that searches a lattice needs of a value is that it can be interpolated and has a size; so heights and
//! points in space are approximated by one algorithm, and the bound on the difference is a height or a distance.

use core::ops::{Add, Div, Mul, Sub};
use std::borrow::Cow;

use glam::DVec3;

use super::greedy::Floor;
use super::lattice::most_bend;
use crate::geometry::map::{GridField, Interpolation};

/// What stands at a place of a lattice.
pub(super) trait Value:
    Copy
    + Send
    + Sync
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// By how much the greatest size, found again, may be less: squares and roots are rounded.
    const LOSS: f64;

    /// Its size as an error, metres.
    fn size(self) -> f64;

    /// The greatest size of `values[k] - (base + k slope)`.
    fn greatest(values: &[Self], base: Self, slope: Self) -> f64 {
        let error = |(k, value): (usize, &Self)| (*value - (base + slope * k as f64)).size();
        values.iter().enumerate().map(error).fold(0.0, f64::max)
    }

    /// The size of `near (1 - t) + far t - bend t (1 - t)` where it is greatest inside of 0 to 1, or somewhat more, with
    /// its t; nothing where it is greatest at an end.
    fn crest(near: Self, far: Self, bend: Self) -> Option<(f64, f64)>;
}

impl Value for f64 {
    const LOSS: Self = 0.0;

    fn size(self) -> f64 {
        self.abs()
    }

    /// Eight at a time, so that the machine can work on several at once.
    fn greatest(values: &[Self], base: Self, slope: Self) -> f64 {
        const LANES: usize = 8;
        const LANE: [f64; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let mut most = [0.0_f64; LANES];
        let chunks = values.chunks_exact(LANES);
        let rest = chunks.remainder();
        let mut offset = 0.0;
        for chunk in chunks {
            for (lane, value) in chunk.iter().enumerate() {
                let error = (value - (base + (offset + LANE[lane]) * slope)).abs();
                most[lane] = if error > most[lane] { error } else { most[lane] };
            }
            offset += LANES as Self;
        }
        let mut all = most.into_iter().fold(0.0, Self::max);
        for (lane, value) in rest.iter().enumerate() {
            all = Self::max(all, (value - (base + (offset + LANE[lane]) * slope)).abs());
        }
        all
    }

    fn crest(near: Self, far: Self, bend: Self) -> Option<(f64, f64)> {
        let t = 0.5 - (far - near) / (2.0 * bend);
        (t > 0.0 && t < 1.0).then(|| ((near * (1.0 - t) + far * t - bend * t * (1.0 - t)).abs(), t))
    }
}

impl Value for DVec3 {
    const LOSS: f64 = 1e-12;

    fn size(self) -> f64 {
        self.length()
    }

    fn greatest(values: &[Self], base: Self, slope: Self) -> f64 {
        let error = |(k, value): (usize, &Self)| (*value - (base + slope * k as f64)).length_squared();
        values.iter().enumerate().map(error).fold(0.0, f64::max).sqrt()
    }

    /// By the control points of the parabola's quarters, which it does not leave: a sixty-fourth of the bend too much at
    /// the most.
    fn crest(near: Self, far: Self, bend: Self) -> Option<(f64, f64)> {
        const PARTS: u32 = 4;
        let at = |t: f64| near * (1.0 - t) + far * t - bend * (t * (1.0 - t));
        let mut most = (0.0, 0.0);
        for part in 0..PARTS {
            let [from, to] = [part, part + 1].map(|part| f64::from(part) / f64::from(PARTS));
            // The middle control point of a piece: where the tangents at its ends meet.
            let middle = (at(from) + at(to)) / 2.0 - bend * ((to - from) * (to - from) / 2.0);
            for (point, t) in [(middle, f64::midpoint(from, to)), (at(to), to)] {
                let size = point.length();
                if size > most.0 {
                    most = (size, t);
                }
            }
        }
        (most.0 > near.length() && most.0 > far.length()).then_some(most)
    }
}

/// A function over the places of a grid.
pub(super) trait Ground: Sync {
    /// What it takes.
    type Value: Value;

    /// The grid, in whose steps places are counted.
    fn grid(&self) -> &GridField;

    /// The value at a place in steps.
    fn at(&self, x: f64, y: f64) -> Self::Value;

    /// The values at the samples, row by row.
    fn samples(&self) -> Cow<'_, [Self::Value]>;

    /// A bound on the sum of its second derivatives by x and by y inside of cells, in size.
    fn bend(&self) -> f64;

    /// The value where it may be raised to a base, or on a line set on it.
    fn standing(
        &self,
        place: [f64; 2],
        value: Self::Value,
        floor: Option<Floor>,
        on_line: bool,
    ) -> Self::Value;
}

impl Ground for GridField {
    type Value = f64;

    fn grid(&self) -> &GridField {
        self
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.value(x, y)
    }

    fn samples(&self) -> Cow<'_, [f64]> {
        Cow::Borrowed(Self::samples(self))
    }

    fn bend(&self) -> f64 {
        if self.interpolation() == Interpolation::Bilinear { 0.0 } else { most_bend(self) }
    }

    fn standing(&self, _: [f64; 2], height: f64, floor: Option<Floor>, on_line: bool) -> f64 {
        if on_line { Floor::on_line(floor, height) } else { Floor::raised(floor, height) }
    }
}
