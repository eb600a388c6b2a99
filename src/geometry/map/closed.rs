//! Fields over surfaces that close in themselves.
//!
//! A spline around a closed surface is periodic: it is made through samples that go on over the seam on both sides, far
//! enough that the ends have no weight left (it falls by 2 + sqrt 3 with each sample; C. de Boor, "A Practical Guide to
//! Splines", 1978, chapter IV).

use super::slopes::Slopes;
use super::{GridField, Interpolation};

/// Samples beyond the seam: (2 + sqrt 3)^-40 is below 1e-22.
const BEYOND: usize = 40;

/// How a field closes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Closes {
    /// Whether its first and last column are one line.
    pub columns: bool,
    /// Whether its first and last row are one line.
    pub rows: bool,
    /// Whether its first row is a point.
    pub first: bool,
    /// Whether its last row is a point.
    pub last: bool,
}

impl GridField {
    /// The field as it closes: where the last column of a closed one does not repeat the first, the first follows it, and
    /// so for rows; a row that is a point has the mean of its samples,
    /// and no value where one of them has none. Splines are smooth across the seam.
    #[must_use]
    pub fn closed(&self, how: Closes) -> Self {
        let Self { columns, rows, .. } = *self;
        let differs = |one: &dyn Fn(usize) -> usize, other: &dyn Fn(usize) -> usize, count: usize| {
            (0..count).any(|k| {
                self.values[one(k)].to_bits() != self.values[other(k)].to_bits()
                    || self.unknown.get(one(k)) != self.unknown.get(other(k))
            })
        };
        let more_columns = how.columns && differs(&|k| k * columns, &|k| k * columns + columns - 1, rows);
        let more_rows = how.rows && differs(&|k| k, &|k| (rows - 1) * columns + k, columns);
        let (wide, high) = (columns + usize::from(more_columns), rows + usize::from(more_rows));
        let from = |i: usize, j: usize| (j % rows) * columns + i % columns;
        let places = || (0..high).flat_map(|j| (0..wide).map(move |i| (i, j)));
        let mut values: Vec<f64> = places().map(|(i, j)| self.values[from(i, j)]).collect();
        let mut unknown = if self.unknown.is_empty() {
            Vec::new()
        } else {
            places().map(|(i, j)| self.unknown[from(i, j)]).collect()
        };
        for (row, point) in [(0, how.first), (high - 1, how.last)] {
            if point {
                let mean = self.point_of(row.min(rows - 1), how.columns).0;
                values[row * wide..(row + 1) * wide].fill(mean);
                if let Some(unknown) = unknown.get_mut(row * wide..(row + 1) * wide) {
                    let any = unknown.contains(&true);
                    unknown.fill(any);
                }
            }
        }
        let slopes = match self.interpolation() {
            Interpolation::Bilinear => None,
            Interpolation::Bicubic => Some(around(wide, &values, how)),
        };
        Self { columns: wide, rows: high, values, slopes, unknown }
    }

    /// The mean of a row that is one point, and how far its samples are from it at the most. Samples without a value count
    /// as little as the last of a row that repeats the first.
    #[must_use]
    pub fn point_of(&self, row: usize, around: bool) -> (f64, f64) {
        let start = row * self.columns;
        let samples = &self.values[start..start + self.columns];
        let repeats = around && samples[0].to_bits() == samples[self.columns - 1].to_bits();
        let count = self.columns - usize::from(repeats);
        let known: Vec<f64> = (0..count).filter(|k| self.is_known(*k, row)).map(|k| samples[k]).collect();
        let known = if known.is_empty() { samples[..count].to_vec() } else { known };
        // About the first, so that equal samples have exactly their value as the mean.
        let more: f64 = known.iter().map(|value| value - known[0]).sum();
        let mean = known[0] + more / known.len() as f64;
        (mean, known.iter().map(|value| (value - mean).abs()).fold(0.0, f64::max))
    }

    /// A bound on the derivatives of a cell by x and by y, in size.
    #[must_use]
    pub fn steepest(&self, column: usize, row: usize) -> (f64, f64) {
        match self.net(column, row) {
            None => {
                let [a, b, c, d] = self.corners(column, row);
                ((b - a).abs().max((d - c).abs()), (c - a).abs().max((d - b).abs()))
            }
            Some(net) => {
                let steps = |line: [f64; 4]| (0..3).map(move |k| 3.0 * (line[k + 1] - line[k]).abs());
                let columns = (0..4).map(|k| net.map(|row| row[k]));
                let across = net.into_iter().flat_map(steps).fold(0.0, f64::max);
                (across, columns.flat_map(steps).fold(0.0, f64::max))
            }
        }
    }
}

/// Slopes of samples that go on over their seams.
fn around(columns: usize, values: &[f64], how: Closes) -> Slopes {
    let rows = values.len() / columns;
    let beyond = |closed: bool| if closed { BEYOND } else { 0 };
    let (left, top) = (beyond(how.columns), beyond(how.rows));
    let wide = columns + 2 * left;
    let from = |k: usize, before: usize, count: usize| {
        let period = count - 1;
        if before == 0 { k } else { (k + period * before - before) % period }
    };
    let padded: Vec<f64> = (0..rows + 2 * top)
        .flat_map(|j| (0..wide).map(move |i| (i, j)))
        .map(|(i, j)| values[from(j, top, rows) * columns + from(i, left, columns)])
        .collect();
    let mut slopes = Slopes::new(wide, &padded).part(wide, (left, columns), (top, rows));
    if how.columns {
        slopes.repeat(|k| (k * columns, k * columns + columns - 1), rows);
    }
    if how.rows {
        slopes.repeat(|k| (k, (rows - 1) * columns + k), columns);
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::{Closes, GridField, Interpolation};
    use crate::geometry::number::cos_degrees;

    #[test]
    fn a_spline_around_is_smooth_across_its_seam() {
        let values: Vec<f64> = (0..5)
            .flat_map(|j| (0..24).map(move |i| cos_degrees(15.0 * f64::from(i) + 7.0) * f64::from(j + 1)))
            .collect();
        let field = GridField::new(24, values, Interpolation::Bicubic).unwrap();
        let closed = field.closed(Closes { columns: true, ..Closes::default() });
        assert_eq!((closed.columns(), closed.rows()), (25, 5));
        for y in [0.0, 0.3, 2.0, 3.7] {
            let (start, end) = (closed.jet(0.0, y), closed.jet(24.0, y));
            assert_eq!(start, end);
            let h = 1e-4;
            let second = |x: f64, h: f64| (closed.jet(x + h, y).dx - closed.jet(x, y).dx) / h;
            // Second derivatives agree from both sides, and the cosine's period is kept all around.
            assert!((second(0.0, h) - second(24.0, -h)).abs() < 1e-3);
            for x in 0..96 {
                let x = f64::from(x) / 4.0;
                let exact = cos_degrees(15.0 * x + 7.0) * (y + 1.0);
                assert!((closed.value(x, y) - exact).abs() < 2e-4 * (y + 1.0), "{x} {y}");
            }
        }
        // What repeats its first column already is not made longer.
        assert_eq!(closed.closed(Closes { columns: true, ..Closes::default() }), closed);
    }

    #[test]
    fn a_point_has_the_mean_of_its_row() {
        let field =
            GridField::new(3, vec![1.0, 2.0, 6.0, 0.0, 0.0, 0.0, 4.0, 4.0, 4.0], Interpolation::Bilinear)
                .unwrap();
        let how = Closes { columns: true, first: true, last: true, ..Closes::default() };
        assert_eq!(field.point_of(0, true), (3.0, 3.0));
        let closed = field.closed(how);
        assert_eq!(closed.samples(), &[3.0, 3.0, 3.0, 3.0, 0.0, 0.0, 0.0, 0.0, 4.0, 4.0, 4.0, 4.0]);
    }

    #[test]
    fn slopes_stay_below_their_bound() {
        let wild = |k: usize| ((k * 7919) % 101) as f64 / 50.0 - 1.0;
        for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
            let field = GridField::new(7, (0..42).map(wild).collect(), kind).unwrap();
            for (i, j) in (0..5).flat_map(|j| (0..6).map(move |i| (i, j))) {
                let most = field.steepest(i, j);
                for k in 1..8 {
                    let jet = field.jet(i as f64 + k as f64 / 8.0, j as f64 + (8 - k) as f64 / 8.0);
                    assert!(jet.dx.abs() <= most.0 + 1e-12 && jet.dy.abs() <= most.1 + 1e-12);
                }
            }
        }
    }
}
