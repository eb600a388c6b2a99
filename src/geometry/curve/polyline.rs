//! Straight segments from point to point.

use glam::DVec3;

use super::{Curve, Domain, Jet, Side};
use crate::geometry::number::{Bounds, floor_index};

/// Straight segments; segment k covers parameters k to k + 1. A closed one returns to its first point.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// Corners; a closed polyline repeats the first at the end.
    points: Vec<DVec3>,
    closed: bool,
}

impl Polyline {
    /// A polyline through at least two points; `closed` adds the segment back to the first, unless the last
    /// point already stands there. `None` for fewer than two points.
    #[must_use]
    pub fn new(mut points: Vec<DVec3>, closed: bool) -> Option<Self> {
        if points.len() < 2 {
            return None;
        }
        if closed && points[0] != points[points.len() - 1] {
            points.push(points[0]);
        }
        let closed = points[0] == points[points.len() - 1];
        Some(Self { points, closed })
    }

    /// Corners; a closed polyline repeats the first at the end.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }
}

impl Curve for Polyline {
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: (self.points.len() - 1) as f64 }
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let last = self.points.len() - 2;
        let t = t.clamp(0.0, (last + 1) as f64);
        let mut segment = t.floor();
        if side == Side::Before && segment == t && t > 0.0 {
            segment -= 1.0;
        }
        let segment = segment.min(last as f64);
        let at = floor_index(segment);
        let (start, end) = (self.points[at], self.points[at + 1]);
        let local = t - segment;
        Jet { point: start * (1.0 - local) + end * local, first: end - start, second: DVec3::ZERO }
    }

    fn joints(&self) -> Vec<f64> {
        (1..self.points.len() - 1).map(|index| index as f64).collect()
    }

    fn chord_deviation(&self, _from: f64, _to: f64) -> f64 {
        0.0
    }

    fn second_range(&self, _from: f64, _to: f64) -> Option<Bounds> {
        Some(Bounds { min: DVec3::ZERO, max: DVec3::ZERO })
    }
}
