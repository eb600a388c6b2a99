//! The bicubic spline through samples, as values and derivatives at them.
//!
//! Source: C. de Boor, "Bicubic spline interpolation", Journal of Mathematics and Physics 41 (1962): derivatives by x from
//! splines along rows, by y from splines along columns, mixed ones from splines along columns through those by x. The
//! ends are not-a-knot (C. de Boor, "A Practical Guide to Splines", 1978, chapter IV): cubics are reproduced.

use super::GridJet;

/// Derivatives at the samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slopes {
    x: Vec<f64>,
    y: Vec<f64>,
    xy: Vec<f64>,
}

/// Where a cell begins among the samples, and how many samples a row has.
type Cell = (usize, usize);

impl Slopes {
    pub(super) fn new(columns: usize, values: &[f64]) -> Self {
        let x = along_rows(columns, values);
        let y = along_columns(columns, values);
        let xy = along_columns(columns, &x);
        Self { x, y, xy }
    }

    /// Those of a part of the samples: for each axis the first and how many.
    pub(super) fn part(
        &self,
        columns: usize,
        (left, wide): (usize, usize),
        (top, high): (usize, usize),
    ) -> Self {
        let part = |slopes: &[f64]| {
            let rows = slopes.chunks_exact(columns).skip(top).take(high);
            rows.flat_map(|row| row[left..left + wide].iter().copied()).collect()
        };
        Self { x: part(&self.x), y: part(&self.y), xy: part(&self.xy) }
    }

    /// Copies the slopes at the first of so many pairs of samples to the second.
    pub(super) fn repeat(&mut self, pair: impl Fn(usize) -> (usize, usize), count: usize) {
        for slopes in [&mut self.x, &mut self.y, &mut self.xy] {
            for (from, to) in (0..count).map(&pair) {
                slopes[to] = slopes[from];
            }
        }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        let scale = |values: &[f64]| values.iter().map(|value| value * factor).collect();
        Self { x: scale(&self.x), y: scale(&self.y), xy: scale(&self.xy) }
    }

    pub(super) fn value(&self, values: &[f64], (at, columns): Cell, (s, t): (f64, f64)) -> f64 {
        let (across, along) = (basis(s), basis(t));
        let row = |values: &[f64], slopes: &[f64], at: usize| {
            across[0] * values[at]
                + across[1] * slopes[at]
                + across[2] * values[at + 1]
                + across[3] * slopes[at + 1]
        };
        let below = at + columns;
        along[0] * row(values, &self.x, at)
            + along[1] * row(&self.y, &self.xy, at)
            + along[2] * row(values, &self.x, below)
            + along[3] * row(&self.y, &self.xy, below)
    }

    pub(super) fn jet(&self, values: &[f64], cell: Cell, (s, t): (f64, f64)) -> GridJet {
        let (at, columns) = cell;
        let row = |weights: [f64; 4], values: &[f64], slopes: &[f64], at: usize| {
            weights[0] * values[at]
                + weights[1] * slopes[at]
                + weights[2] * values[at + 1]
                + weights[3] * slopes[at + 1]
        };
        let mix = |across: [f64; 4], along: [f64; 4]| {
            along[0] * row(across, values, &self.x, at)
                + along[1] * row(across, &self.y, &self.xy, at)
                + along[2] * row(across, values, &self.x, at + columns)
                + along[3] * row(across, &self.y, &self.xy, at + columns)
        };
        GridJet {
            value: self.value(values, cell, (s, t)),
            dx: mix(basis_slope(s), basis(t)),
            dy: mix(basis(s), basis_slope(t)),
        }
    }

    /// The Bezier net of a cell, row by row.
    pub(super) fn net(&self, values: &[f64], (at, columns): Cell) -> [[f64; 4]; 4] {
        let row = |values: &[f64], slopes: &[f64], at: usize| {
            let (a, b) = (values[at], values[at + 1]);
            [a, a + slopes[at] / 3.0, b - slopes[at + 1] / 3.0, b]
        };
        let [a, b] = [at, at + columns].map(|at| row(values, &self.x, at));
        let [a_slope, b_slope] = [at, at + columns].map(|at| row(&self.y, &self.xy, at));
        let after = core::array::from_fn(|k| a[k] + a_slope[k] / 3.0);
        let before = core::array::from_fn(|k| b[k] - b_slope[k] / 3.0);
        [a, after, before, b]
    }

    /// The second differences of the net bound the second derivatives.
    pub(super) fn bends(&self, values: &[f64], cell: Cell) -> (f64, f64) {
        let net = self.net(values, cell);
        let second = |a: f64, b: f64, c: f64| 6.0 * (a - 2.0 * b + c).abs();
        let mut most = (0.0_f64, 0.0_f64);
        for k in 0..4 {
            let row = net[k];
            let column = net.map(|row| row[k]);
            most.0 = most.0.max(second(row[0], row[1], row[2])).max(second(row[1], row[2], row[3]));
            most.1 = most.1.max(second(column[0], column[1], column[2]));
            most.1 = most.1.max(second(column[1], column[2], column[3]));
        }
        most
    }
}

/// Hermite's basis: value and slope at 0, value and slope at 1. Exact at both ends.
fn basis(t: f64) -> [f64; 4] {
    let rest = 1.0 - t;
    [rest * rest * (1.0 + 2.0 * t), t * rest * rest, t * t * (3.0 - 2.0 * t), -t * t * rest]
}

fn basis_slope(t: f64) -> [f64; 4] {
    let rest = 1.0 - t;
    [-6.0 * t * rest, rest * (1.0 - 3.0 * t), 6.0 * t * rest, t * (3.0 * t - 2.0)]
}

fn along_rows(columns: usize, values: &[f64]) -> Vec<f64> {
    let mut slopes = Vec::with_capacity(values.len());
    let system = System::new(columns);
    for row in values.chunks_exact(columns) {
        let start = slopes.len();
        slopes.extend_from_slice(row);
        system.solve(&mut slopes[start..]);
    }
    slopes
}

fn along_columns(columns: usize, values: &[f64]) -> Vec<f64> {
    let rows = values.len() / columns;
    let system = System::new(rows);
    let mut slopes = vec![0.0; values.len()];
    let mut column = vec![0.0; rows];
    for i in 0..columns {
        for (j, slot) in column.iter_mut().enumerate() {
            *slot = values[j * columns + i];
        }
        system.solve(&mut column);
        for (j, slope) in column.iter().enumerate() {
            slopes[j * columns + i] = *slope;
        }
    }
    slopes
}

/// The system of equations of a spline's slopes, eliminated once for all rows of one length.
struct System {
    /// For each row of the system the inverse of its diagonal, and its upper entry divided by it.
    factors: Vec<(f64, f64)>,
}

impl System {
    fn new(count: usize) -> Self {
        let mut factors = Vec::new();
        if count >= 4 {
            let mut upper = 0.0;
            for k in 0..count {
                let (lower, middle, next) = match k {
                    0 => (0.0, 1.0, 2.0),
                    k if k + 1 == count => (2.0, 1.0, 0.0),
                    _ => (1.0, 4.0, 1.0),
                };
                let inverse = 1.0 / (middle - lower * upper);
                upper = next * inverse;
                factors.push((inverse, upper));
            }
        }
        Self { factors }
    }

    /// Puts the slopes in the place of the values.
    fn solve(&self, values: &mut [f64]) {
        let count = values.len();
        match *values {
            [a, b] => values.fill(b - a),
            [a, b, c] => {
                values.copy_from_slice(&[
                    (-3.0 * a + 4.0 * b - c) / 2.0,
                    (c - a) / 2.0,
                    (a - 4.0 * b + 3.0 * c) / 2.0,
                ]);
            }
            _ => {
                let [a, b, c] = [values[count - 1], values[count - 2], values[count - 3]];
                let last = (5.0 * a - 4.0 * b - c) / 2.0;
                let mut before = values[0];
                values[0] = (-5.0 * values[0] + 4.0 * values[1] + values[2]) / 2.0 * self.factors[0].0;
                for k in 1..count - 1 {
                    let right = 3.0 * (values[k + 1] - before);
                    before = values[k];
                    values[k] = (right - values[k - 1]) * self.factors[k].0;
                }
                values[count - 1] = (last - 2.0 * values[count - 2]) * self.factors[count - 1].0;
                for k in (0..count - 1).rev() {
                    values[k] -= self.factors[k].1 * values[k + 1];
                }
            }
        }
    }
}
