//! Boxes, and what rounding to single precision costs.

use glam::DVec3;

/// An axis-aligned box; empty when `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least corner, metres.
    pub min: DVec3,
    /// Greatest corner, metres.
    pub max: DVec3,
}

impl Bounds {
    /// The box of no point.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box that holds all `points`.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// This box, grown to hold `point`.
    #[must_use]
    pub fn with_point(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether no point lies in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Length of the diagonal in metres, zero when empty.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { self.min.distance(self.max) }
    }

    /// Its eight corners; bit k of a corner's number is the far end of axis k.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        core::array::from_fn(|corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// Midpoint.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// The largest coordinate by size, zero when empty.
    #[must_use]
    pub fn reach(&self) -> f64 {
        if self.is_empty() { 0.0 } else { self.min.abs().max(self.max.abs()).max_element() }
    }
}

/// A bound on how far a point moves when each of its coordinates, at most `reach` in size, is rounded to
/// single precision: half a unit in the last place (2^-24 relative) along three axes.
#[must_use]
pub fn single_rounding(reach: f64) -> f64 {
    const HALF_ULP: f64 = 1.0 / 16_777_216.0;
    const SQRT_3: f64 = 1.732_050_807_568_877_2;
    reach * HALF_ULP * SQRT_3
}
