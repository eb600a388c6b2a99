//! Scalar fields over a rectangle: numbers on a grid, and what stands between them.
//!
//! Promise: a [`GridField`] is defined *between* its samples, not only at them: bilinear, or the cubic spline through all
//! samples (twice continuously differentiable). On a border it depends on the samples of that border alone, so fields
//! that share a row of samples share their border to the last bit.
//!
//! Notation: a place is (x, y) in steps of the grid: x counts columns from 0, y counts rows from 0.

mod closed;
mod gaps;
mod refined;
mod scattered;
mod slopes;

pub use closed::Closes;
pub use scattered::{Method, ScatterError, Scattered};

use thiserror::Error;

use super::number::floor_index;
use slopes::Slopes;

/// How a field goes on between its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight along both axes; it bends at the lines of the grid.
    Bilinear,
    /// The bicubic spline through all samples, with not-a-knot ends.
    Bicubic,
}

/// Why numbers are no field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum GridError {
    /// A single row or column spans no area.
    #[error("a map needs at least 2 rows and 2 columns, found {rows} x {columns}")]
    TooSmall {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A sample is NaN or infinite.
    #[error("the sample in row {row}, column {column} is not a finite number")]
    NotFinite {
        /// Its row, from 0.
        row: usize,
        /// Its column, from 0.
        column: usize,
    },
}

/// Numbers on a grid of at least two rows and two columns, all finite, with an interpolation.
#[derive(Clone, Debug, PartialEq)]
pub struct GridField {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
    slopes: Option<Slopes>,
    /// Samples whose value is not known and was made up; empty when all are known.
    unknown: Vec<bool>,
}

/// Value and derivatives by x and y, for each step of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridJet {
    /// The value.
    pub value: f64,
    /// Derivative by x.
    pub dx: f64,
    /// Derivative by y.
    pub dy: f64,
}

impl GridField {
    /// A field of samples row by row.
    ///
    /// # Errors
    /// See [`GridError`].
    ///
    /// # Panics
    /// When the number of samples is not a multiple of `columns`.
    pub fn new(columns: usize, values: Vec<f64>, interpolation: Interpolation) -> Result<Self, GridError> {
        let rows = values.len().checked_div(columns).unwrap_or(0);
        assert_eq!(rows * columns, values.len(), "samples fill whole rows");
        if rows < 2 || columns < 2 {
            return Err(GridError::TooSmall { rows, columns });
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(GridError::NotFinite { row: at / columns, column: at % columns });
        }
        let slopes = match interpolation {
            Interpolation::Bilinear => None,
            Interpolation::Bicubic => Some(Slopes::new(columns, &values)),
        };
        Ok(Self { columns, rows, values, slopes, unknown: Vec::new() })
    }

    /// A field whose marked samples have no value. What stands in for them goes on from those around, layer by layer,
    /// so that a spline does not swing; [`Self::knows`] tells the cells that depend on none.
    ///
    /// # Errors
    /// See [`GridError`]; a field without any value has no value in its first sample.
    ///
    /// # Panics
    /// When the number of samples is not a multiple of `columns`, or not that of the marks.
    pub fn with_gaps(
        columns: usize,
        mut values: Vec<f64>,
        unknown: Vec<bool>,
        interpolation: Interpolation,
    ) -> Result<Self, GridError> {
        assert_eq!(values.len(), unknown.len(), "a mark for each sample");
        if columns > 0 && unknown.contains(&true) {
            gaps::fill(columns, &mut values, &unknown);
        }
        let mut field = Self::new(columns, values, interpolation)?;
        if unknown.contains(&true) {
            field.unknown = unknown;
        }
        Ok(field)
    }

    /// Whether a sample has a value of its own.
    #[must_use]
    pub fn is_known(&self, column: usize, row: usize) -> bool {
        self.unknown.is_empty() || !self.unknown[row * self.columns + column]
    }

    /// Whether all samples around a cell have values.
    #[must_use]
    pub fn knows(&self, column: usize, row: usize) -> bool {
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        self.unknown.is_empty() || corners.iter().all(|(i, j)| self.is_known(column + i, row + j))
    }

    /// Whether samples without a value are among them.
    #[must_use]
    pub fn has_gaps(&self) -> bool {
        !self.unknown.is_empty()
    }

    /// The same field times a factor, then lifted.
    #[must_use]
    pub fn scaled(&self, factor: f64, lift: f64) -> Self {
        let values = self.values.iter().map(|value| lift + factor * value).collect();
        let slopes = self.slopes.as_ref().map(|slopes| slopes.scaled(factor));
        Self { values, slopes, unknown: self.unknown.clone(), ..*self }
    }

    /// The field less another, which is stretched over the same rectangle and taken at the samples of the first. On equal
    /// grids with equal interpolation that is their difference everywhere.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let [right, bottom] = self.extent();
        let [other_right, other_bottom] = other.extent();
        let places = (0..self.rows).flat_map(|j| (0..self.columns).map(move |i| (i, j)));
        let mut unknown = self.unknown.clone();
        let mut values = Vec::with_capacity(self.values.len());
        for (at, (i, j)) in places.enumerate() {
            let (x, y) = (other_right * (i as f64 / right), other_bottom * (j as f64 / bottom));
            values.push(self.values[at] - other.value(x, y));
            if other.has_gaps() && !other.knows_at(x, y) {
                unknown.resize(self.values.len(), false);
                unknown[at] = true;
            }
        }
        let slopes = self.slopes.as_ref().map(|_| Slopes::new(self.columns, &values));
        Self { values, slopes, unknown, ..*self }
    }

    /// Whether what stands at a place depends on samples with values alone; a sample does not depend on others.
    #[must_use]
    pub fn knows_at(&self, x: f64, y: f64) -> bool {
        let (i, s) = cell(x, self.columns);
        let (j, t) = cell(y, self.rows);
        let across = [(i, s < 1.0), (i + 1, s > 0.0)];
        let along = [(j, t < 1.0), (j + 1, t > 0.0)];
        let mut corners = along
            .iter()
            .flat_map(|(j, used_j)| across.iter().map(move |(i, used_i)| (i, j, *used_i && *used_j)));
        corners.all(|(i, j, used)| !used || self.is_known(*i, *j))
    }

    /// The field seen from the other side: its columns in reverse.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let mut values = self.values.clone();
        values.chunks_exact_mut(self.columns).for_each(<[f64]>::reverse);
        let mut unknown = self.unknown.clone();
        unknown.chunks_exact_mut(self.columns).for_each(<[bool]>::reverse);
        let slopes = self.slopes.as_ref().map(|_| Slopes::new(self.columns, &values));
        Self { values, slopes, unknown, ..*self }
    }

    /// Samples in a row.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of samples.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The samples, row by row.
    #[must_use]
    pub fn samples(&self) -> &[f64] {
        &self.values
    }

    /// How it goes on between samples.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        if self.slopes.is_some() { Interpolation::Bicubic } else { Interpolation::Bilinear }
    }

    /// The greatest place: the last column and the last row.
    #[must_use]
    pub fn extent(&self) -> [f64; 2] {
        [(self.columns - 1) as f64, (self.rows - 1) as f64]
    }

    /// The value at a place; places outside are moved to the border.
    #[must_use]
    pub fn value(&self, x: f64, y: f64) -> f64 {
        let (i, s) = cell(x, self.columns);
        let (j, t) = cell(y, self.rows);
        match &self.slopes {
            None => {
                let [a, b, c, d] = self.corners(i, j);
                // A weight of exactly 0 or 1 leaves the sample as it is.
                let near = a * (1.0 - s) + b * s;
                let far = c * (1.0 - s) + d * s;
                near * (1.0 - t) + far * t
            }
            Some(slopes) => {
                let at = j * self.columns + i;
                slopes.value(&self.values, (at, self.columns), (s, t))
            }
        }
    }

    /// Value and derivatives. A bilinear field has jumps of its derivatives on the lines of its grid; there the mean of
    /// both sides stands.
    #[must_use]
    pub fn jet(&self, x: f64, y: f64) -> GridJet {
        let (i, s) = cell(x, self.columns);
        let (j, t) = cell(y, self.rows);
        match &self.slopes {
            None => {
                let value = self.value(x, y);
                let dx = mean(i, s, self.columns, |i| self.slope_x(i, j, t));
                let dy = mean(j, t, self.rows, |j| self.slope_y(i, j, s));
                GridJet { value, dx, dy }
            }
            Some(slopes) => slopes.jet(&self.values, (j * self.columns + i, self.columns), (s, t)),
        }
    }

    /// Bounds on the second derivatives of a cell by x and by y, in size; zero for bilinear fields.
    #[must_use]
    pub fn bends(&self, column: usize, row: usize) -> (f64, f64) {
        match &self.slopes {
            None => (0.0, 0.0),
            Some(slopes) => slopes.bends(&self.values, (row * self.columns + column, self.columns)),
        }
    }

    /// The Bezier net of a cell of a spline, row by row; none for bilinear fields.
    #[must_use]
    pub fn net(&self, column: usize, row: usize) -> Option<[[f64; 4]; 4]> {
        let slopes = self.slopes.as_ref()?;
        Some(slopes.net(&self.values, (row * self.columns + column, self.columns)))
    }

    /// A least and a greatest value that hold everywhere. They are reached by bilinear fields.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let wide = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let Some(slopes) = &self.slopes else {
            return self.values.iter().copied().fold((f64::INFINITY, f64::NEG_INFINITY), wide);
        };
        let cells = (0..self.rows - 1).flat_map(|j| (0..self.columns - 1).map(move |i| (i, j)));
        let nets = cells.map(|(i, j)| slopes.net(&self.values, (j * self.columns + i, self.columns)));
        nets.fold((f64::INFINITY, f64::NEG_INFINITY), |range, net| {
            net.into_iter().flatten().fold(range, wide)
        })
    }

    fn corners(&self, i: usize, j: usize) -> [f64; 4] {
        let at = j * self.columns + i;
        let [a, b] = [self.values[at], self.values[at + 1]];
        let [c, d] = [self.values[at + self.columns], self.values[at + self.columns + 1]];
        [a, b, c, d]
    }

    fn slope_x(&self, i: usize, j: usize, t: f64) -> f64 {
        let [a, b, c, d] = self.corners(i, j);
        (b - a) * (1.0 - t) + (d - c) * t
    }

    fn slope_y(&self, i: usize, j: usize, s: f64) -> f64 {
        let [a, b, c, d] = self.corners(i, j);
        (c - a) * (1.0 - s) + (d - b) * s
    }
}

/// The mean of both sides on a line of the grid, the one side elsewhere.
fn mean(cell: usize, part: f64, count: usize, of: impl Fn(usize) -> f64) -> f64 {
    if part == 0.0 && cell > 0 {
        f64::midpoint(of(cell - 1), of(cell))
    } else if part == 1.0 && cell + 2 < count {
        f64::midpoint(of(cell), of(cell + 1))
    } else {
        of(cell)
    }
}

/// The cell of a place along one axis and the place in it, from 0 to 1.
fn cell(place: f64, count: usize) -> (usize, f64) {
    let index = floor_index(place).min(count - 2);
    (index, (place - index as f64).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::{GridError, GridField, Interpolation, floor_index};

    fn sampled(columns: usize, rows: usize, kind: Interpolation, f: impl Fn(f64, f64) -> f64) -> GridField {
        let values = (0..rows).flat_map(|j| (0..columns).map(move |i| (i as f64, j as f64)));
        GridField::new(columns, values.map(|(x, y)| f(x, y)).collect(), kind).unwrap()
    }

    fn places(field: &GridField) -> Vec<(f64, f64)> {
        let [w, h] = field.extent();
        let part = |k: usize, of: f64| of * k as f64 / 23.0;
        (0..24).flat_map(|j| (0..24).map(move |i| (part(i, w), part(j, h)))).collect()
    }

    #[test]
    fn a_bicubic_spline_reproduces_bicubic_polynomials() {
        let f =
            |x: f64, y: f64| (1.0 - x + 0.3 * x * x * x) * (2.0 + y * y - 0.1 * y * y * y) + 0.5 * x * x * y;
        for (columns, rows) in [(4, 4), (5, 9), (12, 6)] {
            let field = sampled(columns, rows, Interpolation::Bicubic, f);
            let (low, high) = field.range();
            for (x, y) in places(&field) {
                let (jet, scale) = (field.jet(x, y), 1.0 + high.abs().max(low.abs()));
                assert!((jet.value - f(x, y)).abs() < 1e-13 * scale, "{x} {y}");
                assert_eq!(jet.value, field.value(x, y));
                let h = 1e-5;
                let by_x = (f(x + h, y) - f(x - h, y)) / (2.0 * h);
                let by_y = (f(x, y + h) - f(x, y - h)) / (2.0 * h);
                assert!((jet.dx - by_x).abs() < 1e-7 * scale && (jet.dy - by_y).abs() < 1e-7 * scale);
                assert!(low <= jet.value + 1e-9 && jet.value <= high + 1e-9);
            }
        }
    }

    #[test]
    fn small_splines_are_polynomials_of_the_degree_that_is_left() {
        let f = |x: f64, y: f64| (1.0 + x - 2.0 * x * x) * (3.0 - y);
        let field = sampled(3, 2, Interpolation::Bicubic, f);
        for (x, y) in places(&field) {
            assert!((field.value(x, y) - f(x, y)).abs() < 1e-14);
        }
    }

    #[test]
    fn bends_bound_second_differences() {
        let wild = |x: f64, y: f64| ((x * 12.9898 + y * 78.233) * 43.7).rem_euclid(1.0);
        let field = sampled(9, 7, Interpolation::Bicubic, wild);
        let h = 1e-3;
        for (x, y) in places(&field).into_iter().filter(|(x, y)| *x > h && *y > h && *x < 7.9 && *y < 5.9) {
            let (i, j) = (floor_index(x), floor_index(y));
            if floor_index(x + h) != i || floor_index(x - h) != i {
                continue;
            }
            let second = (field.value(x + h, y) - 2.0 * field.value(x, y) + field.value(x - h, y)) / (h * h);
            assert!(second.abs() <= field.bends(i, j).0 + 1e-6, "{x} {y} {second}");
        }
    }

    #[test]
    fn borders_depend_on_their_own_samples_alone() {
        let one = sampled(6, 5, Interpolation::Bicubic, |x, y| x * x * y - y * y + (x * 1.7) % 1.0);
        let row = one.samples()[24..].to_vec();
        let mut values = row.clone();
        values.extend((0..18).map(|k| f64::from(k) * 0.37 % 1.0));
        let other = GridField::new(6, values, Interpolation::Bicubic).unwrap();
        for k in 0..=500 {
            let x = f64::from(k) * 0.01;
            assert_eq!(one.value(x, 4.0), other.value(x, 0.0));
        }
    }

    #[test]
    fn what_is_no_field_is_refused() {
        let bilinear = Interpolation::Bilinear;
        assert_eq!(
            GridField::new(3, vec![0.0; 3], bilinear),
            Err(GridError::TooSmall { rows: 1, columns: 3 })
        );
        let mut values = vec![0.0; 6];
        values[4] = f64::NAN;
        assert_eq!(GridField::new(3, values, bilinear), Err(GridError::NotFinite { row: 1, column: 1 }));
    }
}
