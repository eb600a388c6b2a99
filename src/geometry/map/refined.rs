//! The same field on a finer grid.

use super::slopes::Slopes;
use super::{GridField, Interpolation};

impl GridField {
    /// The field with each step cut into so many, across and along. It is the same function: a bilinear field is bilinear in
    /// every part of a cell, and the spline through samples of a spline that has more knots is that spline, since its third
    /// derivative does not jump where knots are new (C. de Boor, "A Practical Guide to Splines", 1978, chapter IV). Parts of
    /// cells that are not known are not known.
    ///
    /// # Panics
    /// When a number of parts is 0.
    #[must_use]
    pub fn refined(&self, across: usize, along: usize) -> Self {
        assert!(across > 0 && along > 0, "at least one part");
        if (across, along) == (1, 1) {
            return self.clone();
        }
        let (columns, rows) = ((self.columns - 1) * across + 1, (self.rows - 1) * along + 1);
        let place = |i: usize, j: usize| (i as f64 / across as f64, j as f64 / along as f64);
        let places = || (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let values: Vec<f64> = places()
            .map(|(i, j)| {
                let (x, y) = place(i, j);
                self.value(x, y)
            })
            .collect();
        let unknown = if self.unknown.is_empty() {
            Vec::new()
        } else {
            let lost = |(i, j)| {
                let (x, y) = place(i, j);
                !self.knows_at(x, y)
            };
            places().map(lost).collect()
        };
        let slopes = match self.interpolation() {
            Interpolation::Bilinear => None,
            Interpolation::Bicubic => Some(Slopes::new(columns, &values)),
        };
        Self { columns, rows, values, slopes, unknown }
    }
}

#[cfg(test)]
mod tests {
    use super::{GridField, Interpolation};

    #[test]
    fn a_finer_grid_is_the_same_function() {
        let wild = |k: usize| ((k * 7919) % 101) as f64 / 50.0 - 1.0;
        for kind in [Interpolation::Bilinear, Interpolation::Bicubic] {
            for (columns, rows) in [(6, 5), (3, 2)] {
                let field = GridField::new(columns, (0..columns * rows).map(wild).collect(), kind).unwrap();
                let fine = field.refined(3, 2);
                assert_eq!((fine.columns(), fine.rows()), (3 * (columns - 1) + 1, 2 * (rows - 1) + 1));
                for k in 0..=40 {
                    let [right, bottom] = field.extent();
                    let (x, y) = (right * k as f64 / 40.0, bottom * ((k * 7) % 41) as f64 / 40.0);
                    assert!((fine.value(3.0 * x, 2.0 * y) - field.value(x, y)).abs() < 1e-12, "{kind:?}");
                }
            }
        }
    }

    #[test]
    fn parts_of_lost_cells_are_lost() {
        let mut unknown = vec![false; 12];
        unknown[5] = true;
        let field = GridField::with_gaps(4, vec![1.0; 12], unknown, Interpolation::Bilinear).unwrap();
        let fine = field.refined(2, 3);
        for (i, j) in (0..6).flat_map(|j| (0..6).map(move |i| (i, j))) {
            assert_eq!(fine.knows(i, j), field.knows(i / 2, j / 3), "{i} {j}");
        }
    }
}
