//! Fields perturbed by bumps, after the free forms of S. Vyatkin and B. Dolgovesov.
//!
//! Promise: where a perturbation Q is positive its square is added to the body, elsewhere nothing; the square makes
//! the join smooth to the rim (the first derivative is continuous). Q is a quadric or a perturbed field itself. Ranges
//! use the bound max(Q + R) <= max Q + max R of the source, so that a bump that does not reach into a box costs
//! nothing there.
//!
//! In the source the inside is where F > 0 and F' = F + sum of f R; here, as everywhere in this crate, it is negative:
//! F' = F - sum of f R.
//!
//! Source: S. Vyatkin, Complex surface modeling using perturbation functions, Optoelectronics, Instrumentation and
//! Data Processing 43 (2007); S. Vyatkin, B. Dolgovesov, Synthesis of virtual environment with object-space recursive
//! subdivision, Graphicon 1998.

use glam::DVec3;

use super::any::Space;
use super::{AnyField, Study};
use crate::geometry::formula::{Algebra, Binary, Interval, minus, times};
use crate::geometry::number::Bounds;

/// A field with bumps on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Perturbed {
    /// What is perturbed.
    pub base: Box<AnyField>,
    /// What is added.
    pub bumps: Vec<Bump>,
}

/// A perturbation: the square of a field where that is negative (inside), times a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Bump {
    /// Its field, Q of the source with the other sign.
    pub field: AnyField,
    /// Positive makes a hill, negative a hollow.
    pub factor: f64,
}

impl Bump {
    /// What it adds at a point: the factor times the square of its depth, nothing outside.
    #[must_use]
    pub fn perturbation(&self, point: DVec3) -> f64 {
        let (depth, _) = self.field.value_gradient(point);
        if depth < 0.0 { self.factor * depth * depth } else { 0.0 }
    }
}

impl Perturbed {
    /// The field in any kind of number.
    pub(super) fn evaluate<S: Space>(&self, place: [S; 3]) -> S {
        self.bumps.iter().fold(self.base.evaluate(place), |sum, bump| {
            let depth = S::binary(Binary::Minimum, bump.field.evaluate(place), S::constant(0.0));
            minus(sum, times(S::constant(bump.factor), S::power(depth, 2.0)))
        })
    }

    /// Value and derivative.
    pub(super) fn value_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let (mut value, mut gradient) = self.base.value_gradient(point);
        for bump in &self.bumps {
            let (depth, slope) = bump.field.value_gradient(point);
            if depth < 0.0 {
                value -= bump.factor * depth * depth;
                gradient -= slope * (2.0 * bump.factor * depth);
            }
        }
        (value, gradient)
    }

    /// Bounds over a box.
    pub(super) fn study(&self, within: &Bounds) -> Study {
        let mut study = self.base.study(within);
        for bump in &self.bumps {
            let own = bump.field.study(within);
            if own.value.low >= 0.0 {
                continue;
            }
            // Its square is smooth where it begins, and everywhere else as smooth as the field itself.
            let depth = Interval::new(own.value.low, own.value.high.min(0.0)).at_best(own.value.quality);
            let square = <Interval as Algebra>::power(depth, 2.0);
            study.value = minus(study.value, times(Interval::new(bump.factor, bump.factor), square));
            let factor = 2.0 * bump.factor;
            for (sum, slope) in study.gradient.iter_mut().zip(own.gradient) {
                let part = times(depth, slope);
                *sum = minus(*sum, times(Interval::new(factor, factor), part));
            }
        }
        study
    }

    /// A box around the body: no box is known where bumps reach out of that of the base.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        let mut all = self.base.bounds()?;
        for bump in self.bumps.iter().filter(|bump| bump.factor > 0.0) {
            all = all.union(bump.field.bounds()?);
        }
        Some(all)
    }
}
