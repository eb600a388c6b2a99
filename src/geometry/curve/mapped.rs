//! Curves under an affine map, and curves run backwards.

use glam::{DAffine3, DVec3};

use super::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::number::Bounds;

/// A curve under an affine map, with the same parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Transformed {
    curve: Box<AnyCurve>,
    map: DAffine3,
    stretch: f64,
}

impl Transformed {
    /// `curve` under `map`.
    #[must_use]
    pub fn new(curve: AnyCurve, map: DAffine3) -> Self {
        // The Frobenius norm bounds the greatest stretch; for a rotation with one scale the columns are
        // perpendicular and equally long, so that the longest column is the stretch itself.
        let m = map.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis];
        let longest = columns.iter().map(|column| column.length()).fold(0.0, f64::max);
        let skew = m.x_axis.dot(m.y_axis).abs() + m.y_axis.dot(m.z_axis).abs() + m.z_axis.dot(m.x_axis).abs();
        let stretch = if skew <= 1e-12 * longest * longest {
            longest
        } else {
            columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
        };
        Self { curve: Box::new(curve), map, stretch }
    }
}

impl Curve for Transformed {
    fn domain(&self) -> Domain {
        self.curve.domain()
    }

    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let jet = self.curve.evaluate(t, side);
        Jet {
            point: self.map.transform_point3(jet.point),
            first: self.map.transform_vector3(jet.first),
            second: self.map.transform_vector3(jet.second),
        }
    }

    fn joints(&self) -> Vec<f64> {
        self.curve.joints()
    }

    fn breaks(&self) -> Vec<f64> {
        self.curve.breaks()
    }

    fn has_curvature(&self) -> bool {
        self.curve.has_curvature()
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let image = self.map.transform_vector3(self.curve.direction(t, side));
        image.normalize_or(DVec3::X)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curve.chord_deviation(from, to) * self.stretch
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let range = self.curve.second_range(from, to)?;
        let middle = self.map.transform_vector3(range.center());
        let half = (range.max - range.min) / 2.0;
        let reach = self.map.matrix3.abs() * half;
        Some(Bounds { min: middle - reach, max: middle + reach })
    }
}

/// A curve run from its end to its start over the same domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Reversed {
    curve: Box<AnyCurve>,
    /// Each joint with the parameter that the curve itself has there, increasing: the way from one to the
    /// other rounds, and a joint must be met exactly.
    joints: Vec<(f64, f64)>,
    /// The same of the breaks.
    breaks: Vec<(f64, f64)>,
}

impl Reversed {
    /// `curve`, backwards.
    #[must_use]
    pub fn new(curve: AnyCurve) -> Self {
        let domain = curve.domain();
        let mirrored = |list: Vec<f64>| {
            list.into_iter().rev().map(|t| (domain.start + (domain.end - t), t)).collect::<Vec<_>>()
        };
        let (joints, breaks) = (mirrored(curve.joints()), mirrored(curve.breaks()));
        Self { curve: Box::new(curve), joints, breaks }
    }

    fn mirrored(&self, t: f64) -> f64 {
        let domain = self.curve.domain();
        if t <= domain.start {
            return domain.end;
        }
        if t >= domain.end {
            return domain.start;
        }
        let near = self.breaks.partition_point(|(place, _)| *place < t);
        match self.breaks.get(near) {
            Some((place, own)) if *place == t => *own,
            _ => domain.start + (domain.end - t),
        }
    }
}

impl Curve for Reversed {
    fn domain(&self) -> Domain {
        self.curve.domain()
    }

    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let jet = self.curve.evaluate(self.mirrored(t), side.other());
        Jet { point: jet.point, first: -jet.first, second: jet.second }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.iter().map(|(joint, _)| *joint).collect()
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.iter().map(|(place, _)| *place).collect()
    }

    fn has_curvature(&self) -> bool {
        self.curve.has_curvature()
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        -self.curve.direction(self.mirrored(t), side.other())
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curve.chord_deviation(self.mirrored(to), self.mirrored(from))
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        self.curve.second_range(self.mirrored(to), self.mirrored(from))
    }
}
