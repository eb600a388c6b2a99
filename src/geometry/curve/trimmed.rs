//! A part of a curve.

use glam::DVec3;

use super::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::number::Bounds;

/// The part of a curve between two of its parameters, with the curve's own parameter: nothing about it is
/// approximated.
#[derive(Clone, Debug, PartialEq)]
pub struct Trimmed {
    curve: Box<AnyCurve>,
    domain: Domain,
}

impl Trimmed {
    /// `curve` from parameter `from` to `to`; `None` where nothing of it lies between.
    #[must_use]
    pub fn new(curve: AnyCurve, from: f64, to: f64) -> Option<Self> {
        let whole = curve.domain();
        let domain = Domain { start: from.max(whole.start), end: to.min(whole.end) };
        (domain.start < domain.end).then(|| Self { curve: Box::new(curve), domain })
    }

    fn inside(&self, list: Vec<f64>) -> Vec<f64> {
        list.into_iter().filter(|t| *t > self.domain.start && *t < self.domain.end).collect()
    }

    /// At the ends the side is that of the part.
    fn place(&self, t: f64, side: Side) -> (f64, Side) {
        if t <= self.domain.start {
            (self.domain.start, Side::After)
        } else if t >= self.domain.end {
            (self.domain.end, Side::Before)
        } else {
            (t, side)
        }
    }
}

impl Curve for Trimmed {
    fn domain(&self) -> Domain {
        self.domain
    }

    fn is_closed(&self) -> bool {
        self.domain == self.curve.domain() && self.curve.is_closed()
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let (t, side) = self.place(t, side);
        self.curve.evaluate(t, side)
    }

    fn joints(&self) -> Vec<f64> {
        self.inside(self.curve.joints())
    }

    fn breaks(&self) -> Vec<f64> {
        self.inside(self.curve.breaks())
    }

    fn has_curvature(&self) -> bool {
        self.curve.has_curvature()
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let (t, side) = self.place(t, side);
        self.curve.direction(t, side)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curve.chord_deviation(from, to)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        self.curve.second_range(from, to)
    }

    fn first_range(&self, from: f64, to: f64) -> Option<Bounds> {
        self.curve.first_range(from, to)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Trimmed;
    use crate::geometry::curve::{AnyCurve, Curve, EllipseArc, Polyline, Side};

    #[test]
    fn a_part_is_the_curve_where_it_is() {
        let circle = AnyCurve::Ellipse(EllipseArc::full(DVec3::ZERO, 1.0, 1.0));
        let domain = circle.domain();
        let part = Trimmed::new(circle.clone(), domain.at(0.25), domain.at(0.5)).unwrap();
        for k in 0..=8 {
            let t = part.domain().at(f64::from(k) / 8.0);
            assert_eq!(part.point(t), circle.point(t));
        }
        assert!(!part.is_closed() && part.point(-1e9) == circle.point(domain.at(0.25)));
        assert!(Trimmed::new(circle, 2.0, 1.0).is_none());
    }

    #[test]
    fn ends_at_a_corner_have_the_direction_inside() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::ONE];
        let line = AnyCurve::Polyline(Polyline::new(corners, false).unwrap());
        let joint = line.joints()[0];
        let part = Trimmed::new(line.clone(), joint, line.domain().end).unwrap();
        assert!(part.joints().is_empty());
        assert_eq!(part.direction(joint, Side::Before), line.direction(joint, Side::After));
    }
}
