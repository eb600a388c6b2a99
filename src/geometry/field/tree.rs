//! Fields made of fields.

use glam::{DAffine3, DVec3};

use super::any::Space;
use super::join::Slopes;
use super::{AnyField, Join, Study};
use crate::geometry::formula::{Interval, plus, times};
use crate::geometry::number::Bounds;

/// Value and derivative of a part.
type Slope = fn(&AnyField, DVec3) -> (f64, DVec3);

/// Several fields joined, from the first on.
#[derive(Clone, Debug, PartialEq)]
pub struct Joined {
    /// How.
    pub join: Join,
    /// The fields.
    pub of: Vec<AnyField>,
}

/// Several fields added up.
#[derive(Clone, Debug, PartialEq)]
pub struct Sum {
    /// The fields and their factors.
    pub of: Vec<(f64, AnyField)>,
    /// What is added.
    pub constant: f64,
}

/// A field somewhere else, turned and scaled. Its values are scaled with it, so that distances stay distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The field.
    pub of: Box<AnyField>,
    /// From here to the space of the field.
    pub back: DAffine3,
    /// Factor of its values.
    pub scale: f64,
}

impl Joined {
    pub(super) fn evaluate<S: Space>(&self, place: [S; 3]) -> S {
        let mut values = self.of.iter().map(|field| field.evaluate(place));
        let first = values.next().unwrap_or_else(|| S::constant(1.0));
        values.fold(first, |all, one| self.join.apply(all, one))
    }

    pub(super) fn value_gradient(&self, point: DVec3, each: Slope) -> (f64, DVec3) {
        let mut all = self.of.iter().map(|field| each(field, point));
        let first = all.next().unwrap_or((1.0, DVec3::ZERO));
        all.fold(first, |one, other| self.join.apply_with_slopes(one, other))
    }

    pub(super) fn study(&self, within: &Bounds) -> Study {
        let mut all = self.of.iter().map(|field| field.study(within));
        let nothing = || Study { value: Interval::new(1.0, 1.0), gradient: [Interval::new(0.0, 0.0); 3] };
        let first = all.next().unwrap_or_else(nothing);
        all.fold(first, |one, other| {
            // Jets in one variable after another would cost as much as those of three: second derivatives are left out.
            let jet = |study: &Study| Slopes { value: study.value, first: study.gradient };
            let joined = self.join.apply_in_boxes(&jet(&one), &jet(&other));
            Study { value: joined.value, gradient: joined.first }
        })
    }

    pub(super) fn bounds(&self) -> Option<Bounds> {
        let mut boxes = self.of.iter().map(AnyField::bounds);
        match self.join {
            Join::Union(blend) => {
                let all: Option<Vec<Bounds>> = boxes.collect();
                let all = all?.into_iter().fold(Bounds::EMPTY, Bounds::union);
                // Each fillet may reach a little further out.
                let reach = blend.reach() * self.of.len() as f64;
                Some(Bounds { min: all.min - reach, max: all.max + reach })
            }
            Join::Intersection(_) => {
                let meet = |a: Bounds, b: Bounds| Bounds { min: a.min.max(b.min), max: a.max.min(b.max) };
                boxes.flatten().reduce(meet)
            }
            Join::Difference(_) => boxes.next().flatten(),
        }
    }
}

impl Sum {
    pub(super) fn evaluate<S: Space>(&self, place: [S; 3]) -> S {
        self.of.iter().fold(S::constant(self.constant), |sum, (factor, field)| {
            plus(sum, times(S::constant(*factor), field.evaluate(place)))
        })
    }

    pub(super) fn value_gradient(&self, point: DVec3, each: Slope) -> (f64, DVec3) {
        self.of.iter().fold((self.constant, DVec3::ZERO), |(value, gradient), (factor, field)| {
            let (own, slope) = each(field, point);
            (value + factor * own, gradient + slope * *factor)
        })
    }
}

impl Placed {
    /// A field under a map that scales all lengths alike.
    #[must_use]
    pub fn new(of: AnyField, map: &DAffine3) -> Self {
        let scale = map.matrix3.x_axis.length();
        Self { of: Box::new(of), back: map.inverse(), scale }
    }

    pub(super) fn evaluate<S: Space>(&self, [x, y, z]: [S; 3]) -> S {
        let (matrix, move_by) = (self.back.matrix3, self.back.translation);
        let row = |a: f64, b: f64, c: f64, d: f64| {
            // Zeros would make wide intervals of nothing.
            let terms = [(a, x), (b, y), (c, z)].into_iter().filter(|(factor, _)| *factor != 0.0);
            terms.fold(S::constant(d), |sum, (factor, part)| {
                plus(sum, if factor == 1.0 { part } else { times(S::constant(factor), part) })
            })
        };
        let rows = [
            row(matrix.x_axis.x, matrix.y_axis.x, matrix.z_axis.x, move_by.x),
            row(matrix.x_axis.y, matrix.y_axis.y, matrix.z_axis.y, move_by.y),
            row(matrix.x_axis.z, matrix.y_axis.z, matrix.z_axis.z, move_by.z),
        ];
        times(S::constant(self.scale), self.of.evaluate(rows))
    }

    pub(super) fn value_gradient(&self, point: DVec3, each: Slope) -> (f64, DVec3) {
        let (value, slope) = each(&self.of, self.back.transform_point3(point));
        (value * self.scale, self.back.matrix3.transpose() * slope * self.scale)
    }

    pub(super) fn study(&self, within: &Bounds) -> Study {
        let (center, half) = (within.center(), (within.max - within.min) / 2.0);
        let (middle, reach) = (self.back.transform_point3(center), self.back.matrix3.abs() * half);
        // What rounding may move the box by.
        let reach = reach + (middle.abs() + reach) * 1e-15;
        let study = self.of.study(&Bounds { min: middle - reach, max: middle + reach });
        let factor = |x: f64| Interval::new(x, x);
        let columns = [self.back.matrix3.x_axis, self.back.matrix3.y_axis, self.back.matrix3.z_axis];
        let gradient = columns.map(|column| {
            let parts = column.to_array().into_iter().zip(study.gradient);
            let terms = parts
                .filter(|(entry, _)| *entry != 0.0)
                .map(|(entry, slope)| times(factor(entry * self.scale), slope));
            terms.reduce(plus).unwrap_or(factor(0.0))
        });
        Study { value: times(study.value, factor(self.scale)), gradient }
    }

    pub(super) fn bounds(&self) -> Option<Bounds> {
        let (inner, map) = (self.of.bounds()?, self.back.inverse());
        let corner = |k: usize| {
            let pick = |bit: usize, low: f64, high: f64| if k & bit == 0 { low } else { high };
            let (low, high) = (inner.min, inner.max);
            DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
        };
        Some(Bounds::of_points((0..8).map(|k| map.transform_point3(corner(k)))))
    }
}
