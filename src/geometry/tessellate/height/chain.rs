//! The borders of a map: chains of points that depend on the samples of their border alone.
//!
//! Source of the splitting: U. Ramer, "An iterative procedure for the polygonal approximation of plane curves", 1972.

use super::delaunay::Place;
use super::ground::Value;
use super::lattice::refinement;
use crate::geometry::map::{GridField, Interpolation};

/// One border.
#[derive(Clone, Copy, Debug)]
pub(super) enum Side {
    /// The first row.
    Top,
    /// The last row.
    Bottom,
    /// The first column.
    Left,
    /// The last column.
    Right,
}

/// Places along a border in steps of the field, both ends among them, and how far the chords are from the field.
pub(super) struct Chain {
    pub(super) steps: Vec<f64>,
    pub(super) bound: f64,
    /// Its places are whole numbers of this part of a step.
    pub(super) refine: u64,
}

impl Side {
    pub(super) const ALL: [Self; 4] = [Self::Top, Self::Bottom, Self::Left, Self::Right];

    pub(super) fn is_row(self) -> bool {
        matches!(self, Self::Top | Self::Bottom)
    }

    /// The side on which two places of a rectangle from 0 to `far` lie.
    pub(super) fn of(a: Place, b: Place, far: Place) -> Self {
        let both = |axis: usize, at: i32| a[axis] == at && b[axis] == at;
        match () {
            () if both(1, 0) => Self::Top,
            () if both(1, far[1]) => Self::Bottom,
            () if both(0, 0) => Self::Left,
            () => Self::Right,
        }
    }

    /// The place of a number of units along it.
    pub(super) fn place(self, far: Place, along: i32) -> Place {
        match self {
            Self::Top => [along, 0],
            Self::Bottom => [along, far[1]],
            Self::Left => [0, along],
            Self::Right => [far[0], along],
        }
    }

    /// Steps along it.
    pub(super) fn length(self, field: &GridField) -> usize {
        (if self.is_row() { field.columns() } else { field.rows() }) - 1
    }

    /// The place of a number of steps along it.
    pub(super) fn at(self, field: &GridField, along: f64) -> [f64; 2] {
        let [right, bottom] = field.extent();
        match self {
            Self::Top => [along, 0.0],
            Self::Bottom => [along, bottom],
            Self::Left => [0.0, along],
            Self::Right => [right, along],
        }
    }

    /// A bound on the second derivative along it in a step, which depends on its own samples alone.
    fn bend(self, field: &GridField, step: usize) -> f64 {
        let at = |along: f64| {
            let [x, y] = self.at(field, along);
            let jet = field.jet(x, y);
            (jet.value, if self.is_row() { jet.dx } else { jet.dy })
        };
        let ((a, a_slope), (b, b_slope)) = (at(step as f64), at((step + 1) as f64));
        // The second derivative is linear: greatest at an end of the step.
        let near = 6.0 * (b - a) - 4.0 * a_slope - 2.0 * b_slope;
        let far = 6.0 * (a - b) + 2.0 * a_slope + 4.0 * b_slope;
        near.abs().max(far.abs())
    }

    /// The greatest bound on the second derivative along it.
    fn most_bend(self, field: &GridField) -> f64 {
        if field.interpolation() == Interpolation::Bilinear {
            return 0.0;
        }
        (0..self.length(field)).map(|step| self.bend(field, step)).fold(0.0, f64::max)
    }

    /// The chain within a tolerance of the field everywhere.
    pub(super) fn chain(self, field: &GridField, tolerance: f64) -> Chain {
        let bend = self.most_bend(field);
        let parts = refinement(bend, tolerance);
        let slack = bend / 8.0 / (parts as f64 * parts as f64);
        self.split(field, parts, tolerance - slack, slack)
    }

    /// The chain of samples within a tolerance at the samples. Its bound holds everywhere.
    pub(super) fn sampled_chain(self, field: &GridField, tolerance: f64) -> Chain {
        self.split(field, 1, tolerance, self.most_bend(field) / 8.0)
    }

    /// The chain of all samples.
    pub(super) fn whole_chain(self, field: &GridField) -> Chain {
        let steps = (0..=self.length(field)).map(|step| step as f64).collect();
        Chain { steps, bound: self.most_bend(field) / 8.0, refine: 1 }
    }

    fn split(self, field: &GridField, parts: u64, tolerance: f64, slack: f64) -> Chain {
        let (length, refine) = (self.length(field), parts);
        let parts = refine as f64;
        let count = crate::geometry::number::floor_index(length as f64 * parts);
        let heights: Vec<f64> = (0..=count)
            .map(|k| {
                let [x, y] = self.at(field, k as f64 / parts);
                field.value(x, y)
            })
            .collect();
        let (kept, bound) = split(&heights, vec![(0, count)], tolerance);
        Chain { steps: kept.into_iter().map(|k| k as f64 / parts).collect(), bound: bound + slack, refine }
    }
}

/// Nodes, the first among them, such that chords between them are within a tolerance of all others, and how near they
/// are. The ranges given, the last first, are cut further.
pub(super) fn split<V: Value>(
    values: &[V],
    mut open: Vec<(usize, usize)>,
    tolerance: f64,
) -> (Vec<usize>, f64) {
    let mut bound = 0.0_f64;
    let mut kept = vec![0];
    while let Some((from, to)) = open.pop() {
        let (error, at) = farthest(values, from, to);
        if error > tolerance {
            open.extend([(at, to), (from, at)]);
        } else {
            bound = bound.max(error);
            kept.push(to);
        }
    }
    (kept, bound)
}

/// The node farthest from the chord between two others.
fn farthest<V: Value>(heights: &[V], from: usize, to: usize) -> (f64, usize) {
    let (a, b) = (heights[from], heights[to]);
    let length = (to - from) as f64;
    let mut worst = (0.0, from);
    for (k, height) in heights.iter().enumerate().take(to).skip(from + 1) {
        let error = (*height - (a + (b - a) * ((k - from) as f64 / length))).size();
        if error > worst.0 {
            worst = (error, k);
        }
    }
    worst
}
