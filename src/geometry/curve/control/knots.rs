//! Knots: where the pieces of a B-spline meet, and the B-spline basis over them.
//!
//! For n control points of degree p there are n + p + 1 knots `u[0] <= u[1] <= ...`; the parameter runs from
//! `u[p]` to `u[n]`. A knot of multiplicity m inside leaves p - m continuous derivatives.

use thiserror::Error;

/// Why numbers are not knots.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum KnotError {
    /// The degree is zero.
    #[error("the degree must be at least 1")]
    Degree,
    /// Too few knots for any control points.
    #[error("{found} knots are fewer than the {least} that the degree needs")]
    Few {
        /// Least number.
        least: usize,
        /// Number given.
        found: usize,
    },
    /// A knot is less than the one before.
    #[error("knot {index} is less than the one before")]
    Decrease {
        /// Index of the lesser knot.
        index: usize,
    },
    /// Two different knots stand so close that the curve between them is rounding.
    #[error("knots {index} and {} are different, but too close", index - 1)]
    Close {
        /// Index of the second.
        index: usize,
    },
    /// A knot is repeated so often that the curve breaks, or a control point has no effect.
    #[error("knot {index} is repeated {times} times, more than {most}")]
    Multiplicity {
        /// Index of the first of the equal knots.
        index: usize,
        /// How often it stands there.
        times: usize,
        /// How often it may.
        most: usize,
    },
    /// The parameter has no room: `u[p] = u[n]`.
    #[error("all knots of the domain are equal")]
    Empty,
}

/// Knots that fit their degree.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    degree: usize,
    values: Vec<f64>,
}

/// Different knots are at least this share of the domain apart.
const CLOSEST: f64 = 1e-12;

impl Knots {
    /// Knots as given: inside the domain none may be repeated more often than the degree, which keeps the
    /// curve in one piece, and nowhere more often than the degree plus one.
    ///
    /// # Errors
    /// As [`KnotError`] says.
    pub fn new(degree: usize, values: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 {
            return Err(KnotError::Degree);
        }
        if values.len() < 2 * degree + 2 {
            return Err(KnotError::Few { least: 2 * degree + 2, found: values.len() });
        }
        if let Some(before) =
            values.windows(2).position(|pair| pair[0].partial_cmp(&pair[1]).is_none_or(|order| order.is_gt()))
        {
            return Err(KnotError::Decrease { index: before + 1 });
        }
        let knots = Self { degree, values };
        knots.check_multiplicities()?;
        Ok(knots)
    }

    /// Knots that were made from good ones.
    pub(super) fn trusted(degree: usize, values: Vec<f64>) -> Self {
        Self { degree, values }
    }

    fn check_multiplicities(&self) -> Result<(), KnotError> {
        let (start, end) = self.domain();
        if start >= end {
            return Err(KnotError::Empty);
        }
        let mut index = 0;
        for run in self.values.chunk_by(|a, b| a == b) {
            let inside = run[0] > start && run[0] < end;
            let most = self.degree + usize::from(!inside);
            if run.len() > most {
                return Err(KnotError::Multiplicity { index, times: run.len(), most });
            }
            index += run.len();
            let close = self.values.get(index).is_some_and(|next| *next - run[0] < CLOSEST * (end - start));
            if close {
                return Err(KnotError::Close { index });
            }
        }
        Ok(())
    }

    /// 0, ..., 0, 1, 2, ..., with ends of multiplicity degree + 1: the curve begins and ends at its first and
    /// last control point (open uniform). `None` where there are too few points for the degree.
    #[must_use]
    pub fn clamped(degree: usize, points: usize) -> Option<Self> {
        let pieces = points.checked_sub(degree).filter(|pieces| *pieces > 0 && degree > 0)?;
        let value = |k: usize| k.saturating_sub(degree).min(pieces) as f64;
        Some(Self { degree, values: (0..=points + degree).map(value).collect() })
    }

    /// 0, 1, 2, ...: all steps alike. `None` where there are too few points for the degree.
    #[must_use]
    pub fn uniform(degree: usize, points: usize) -> Option<Self> {
        (degree > 0 && points > degree)
            .then(|| Self { degree, values: (0..=points + degree).map(|k| k as f64).collect() })
    }

    /// Knots of a closed curve from those of one period, its start and end both included: they are continued to
    /// both sides by the degree.
    ///
    /// # Errors
    /// As [`KnotError`] says, of the continued knots.
    pub fn periodic(degree: usize, period: &[f64]) -> Result<Self, KnotError> {
        if period.len() < 2 {
            return Err(KnotError::Few { least: 2, found: period.len() });
        }
        if let Some(before) =
            period.windows(2).position(|pair| pair[0].partial_cmp(&pair[1]).is_none_or(|order| order.is_gt()))
        {
            return Err(KnotError::Decrease { index: before + 1 });
        }
        let count = period.len() - 1;
        let length = period[count] - period[0];
        let value = |k: usize| {
            // Shifted by whole periods so that the place is never negative.
            let turns = degree.div_ceil(count);
            let place = k + turns * count - degree;
            period[place % count] + length * ((place / count) as f64 - turns as f64)
        };
        Self::new(degree, (0..=count + 2 * degree).map(value).collect())
    }

    /// Degree of the pieces.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Number of control points that they are for.
    #[must_use]
    pub fn points(&self) -> usize {
        self.values.len() - self.degree - 1
    }

    /// Least and greatest parameter.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        (self.values[self.degree], self.values[self.points()])
    }

    /// The index k with `u[k] <= t < u[k + 1]` inside the domain; at its end the last span that has a length.
    #[must_use]
    pub fn span(&self, t: f64) -> usize {
        let (_, end) = self.domain();
        let inner = &self.values[self.degree + 1..self.points()];
        let found = if t < end {
            inner.partition_point(|knot| *knot <= t)
        } else {
            inner.partition_point(|knot| *knot < end)
        };
        self.degree + found
    }

    /// The spans of the domain that have a length, in order.
    #[must_use]
    pub fn spans(&self) -> Vec<usize> {
        (self.degree..self.points()).filter(|k| self.values[*k] < self.values[k + 1]).collect()
    }

    /// How often a value stands among the knots.
    #[must_use]
    pub fn multiplicity(&self, t: f64) -> usize {
        self.values.iter().filter(|knot| **knot == t).count()
    }

    /// The basis functions that are not zero at `t`, with first and second derivative, and the index of the
    /// first of them. They are degree + 1, none is negative, and they add to 1.
    ///
    /// Source: C. de Boor, On calculating with B-splines, J. Approx. Theory 6 (1972). Cost: O(degree^2).
    #[must_use]
    pub fn basis(&self, t: f64) -> (usize, Vec<[f64; 3]>) {
        let (start, end) = self.domain();
        let t = t.clamp(start, end);
        let (span, p) = (self.span(t), self.degree);
        let values = self.basis_values(span, p, t);
        let first = self.derive(span, p, &self.basis_values(span, p - 1, t));
        let second = if p > 1 {
            let below = self.derive(span, p - 1, &self.basis_values(span, p - 2, t));
            self.derive(span, p, &below)
        } else {
            vec![0.0; p + 1]
        };
        let functions = (0..=p).map(|j| [values[j], first[j], second[j]]).collect();
        (span - p, functions)
    }

    /// Values of the basis functions of `degree` that are not zero in a span.
    fn basis_values(&self, span: usize, degree: usize, t: f64) -> Vec<f64> {
        let u = &self.values;
        let mut values = vec![1.0];
        for p in 1..=degree {
            let mut next = vec![0.0; p + 1];
            for (j, value) in values.iter().enumerate() {
                let (low, high) = (u[span + j + 1 - p], u[span + j + 1]);
                let share = (t - low) / (high - low);
                next[j] += value * (1.0 - share);
                next[j + 1] += value * share;
            }
            values = next;
        }
        values
    }

    /// What combines functions of one degree less to the derivatives of those of `degree`.
    fn derive(&self, span: usize, degree: usize, below: &[f64]) -> Vec<f64> {
        let u = &self.values;
        let mut derived = vec![0.0; degree + 1];
        for (j, value) in below.iter().enumerate() {
            let rate = degree as f64 / (u[span + j + 1] - u[span + j + 1 - degree]) * value;
            derived[j] -= rate;
            derived[j + 1] += rate;
        }
        derived
    }
}

#[cfg(test)]
mod tests {
    use super::{KnotError, Knots};

    /// L. Piegl, W. Tiller, The NURBS Book, examples 2.3 and 2.4.
    #[test]
    fn the_basis_is_that_of_the_nurbs_book() {
        let knots = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0]).unwrap();
        for (t, span) in [(0.0, 2), (1.0, 3), (1.5, 3), (2.5, 4), (4.9, 7), (5.0, 7)] {
            assert_eq!(knots.span(t), span, "{t}");
        }
        let (first, functions) = knots.basis(2.5);
        assert_eq!(first, 2);
        assert_eq!(functions, [[0.125, -0.5, 1.0], [0.75, 0.0, -2.0], [0.125, 0.5, 1.0]]);
    }

    #[test]
    fn the_basis_is_a_partition_of_unity_and_never_negative() {
        let lists = [
            Knots::clamped(3, 9).unwrap(),
            Knots::uniform(4, 7).unwrap(),
            Knots::new(3, vec![-1.0, 0.0, 0.0, 0.5, 0.75, 0.75, 0.75, 2.0, 2.0, 3.0, 7.0]).unwrap(),
            Knots::periodic(3, &[0.0, 0.5, 2.0, 2.25]).unwrap(),
            Knots::clamped(1, 4).unwrap(),
        ];
        for knots in lists {
            let (start, end) = knots.domain();
            for step in 0..=60 {
                let (_, functions) = knots.basis(start + (end - start) * f64::from(step) / 60.0);
                let sum = |order: usize| functions.iter().map(|f| f[order]).sum::<f64>();
                assert!((sum(0) - 1.0).abs() < 1e-14);
                assert!(sum(1).abs() < 1e-12 && sum(2).abs() < 1e-10);
                assert!(functions.iter().all(|f| f[0] >= 0.0));
            }
        }
    }

    #[test]
    fn periods_are_continued() {
        let knots = Knots::periodic(3, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert_eq!(knots.values(), (-3..=9).map(f64::from).collect::<Vec<_>>());
        let short = Knots::periodic(4, &[1.0, 1.5, 4.0]).unwrap();
        assert_eq!(short.values(), [-5.0, -4.5, -2.0, -1.5, 1.0, 1.5, 4.0, 4.5, 7.0, 7.5, 10.0]);
        assert_eq!(short.domain(), (1.0, 4.0));
    }

    #[test]
    fn bad_knots_are_named() {
        let of = |values: &[f64]| Knots::new(2, values.to_vec());
        assert_eq!(of(&[0.0; 3]), Err(KnotError::Few { least: 6, found: 3 }));
        assert_eq!(of(&[0.0, 0.0, 1.0, 0.5, 2.0, 2.0]), Err(KnotError::Decrease { index: 3 }));
        assert_eq!(of(&[0.0, 0.0, f64::NAN, 0.5, 2.0, 2.0]), Err(KnotError::Decrease { index: 2 }));
        assert_eq!(of(&[0.0; 6]), Err(KnotError::Empty));
        let repeated = of(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(repeated, Err(KnotError::Multiplicity { index: 3, times: 3, most: 2 }));
        let ends = of(&[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(ends, Err(KnotError::Multiplicity { index: 0, times: 4, most: 3 }));
        let close = of(&[0.0, 0.0, 0.0, 1e-13, 1.0, 1.0, 1.0]);
        assert_eq!(close, Err(KnotError::Close { index: 3 }));
        assert_eq!(Knots::clamped(3, 3), None);
        assert_eq!(Knots::new(0, vec![0.0, 1.0]), Err(KnotError::Degree));
    }
}
