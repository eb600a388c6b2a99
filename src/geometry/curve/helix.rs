//! Helices on a cylinder or a cone about the y axis.

use glam::DVec3;

use super::{Curve, Domain, Jet, Side};
use crate::geometry::number;
use crate::geometry::number::Bounds;

/// A helix that starts at (radius, 0, 0), turns about +y (right-handed) and climbs `pitch` a turn, while the
/// radius goes evenly to `end_radius`. The parameter counts turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Helix {
    /// Radius at the start, metres.
    pub radius: f64,
    /// Radius at the end, metres.
    pub end_radius: f64,
    /// Climb of a turn, metres.
    pub pitch: f64,
    /// Number of turns, more than zero.
    pub turns: f64,
}

const TURN: f64 = core::f64::consts::TAU;

impl Curve for Helix {
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: self.turns }
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn evaluate(&self, t: f64, _side: Side) -> Jet {
        let t = t.clamp(0.0, self.turns);
        let growth = (self.end_radius - self.radius) / self.turns;
        let radius = self.radius + growth * t;
        let (sin, cos) = number::sin_cos_degrees(360.0 * t);
        let outward = DVec3::new(cos, 0.0, -sin);
        let onward = DVec3::new(-sin, 0.0, -cos);
        Jet {
            point: outward * radius + DVec3::Y * (self.pitch * t),
            first: outward * growth + onward * (radius * TURN) + DVec3::Y * self.pitch,
            second: onward * (2.0 * growth * TURN) - outward * (radius * TURN * TURN),
        }
    }

    fn joints(&self) -> Vec<f64> {
        Vec::new()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let growth = (self.end_radius - self.radius) / self.turns;
        let radius = self.radius.max(self.end_radius);
        let second = number::hypot(2.0 * growth * TURN, radius * TURN * TURN);
        second * (to - from) * (to - from) / 8.0
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let middle = self.evaluate((from + to) / 2.0, Side::After).second;
        let growth = (self.end_radius - self.radius) / self.turns;
        let radius = self.radius.max(self.end_radius);
        let third = number::hypot(3.0 * growth * TURN * TURN, radius * TURN * TURN * TURN);
        let reach = DVec3::new(third, 0.0, third) * ((to - from).abs() / 2.0);
        Some(Bounds { min: middle - reach, max: middle + reach })
    }
}
