//! Curves run through at other times: piecewise even changes of the parameter.

use glam::DVec3;

use super::bezier::merged;
use super::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::number::Bounds;

/// A curve under a new parameter u: between two stops the curve's own parameter t goes evenly with u. The path
/// is the same; the speed jumps at inner stops.
#[derive(Clone, Debug, PartialEq)]
pub struct Retimed {
    curve: Box<AnyCurve>,
    /// (u, t), both increasing; the first and last t are the ends of the curve's domain.
    stops: Vec<(f64, f64)>,
    /// Joints of the curve, each with both parameters: the way from one to the other rounds, and a joint must be
    /// met exactly.
    joints: Vec<(f64, f64)>,
    /// The same of its breaks and of inner stops.
    breaks: Vec<(f64, f64)>,
}

impl Retimed {
    /// `curve` with the parameter u that is `stops[k].0` where its own parameter is `stops[k].1`. The stops
    /// must increase in both, and begin and end with the domain; `None` where they do not.
    #[must_use]
    pub fn new(curve: AnyCurve, stops: Vec<(f64, f64)>) -> Option<Self> {
        let domain = curve.domain();
        let ends = (stops.first()?.1, stops.last()?.1) == (domain.start, domain.end);
        let grows = stops.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 < pair[1].1);
        if !ends || !grows || stops.len() < 2 {
            return None;
        }
        let mut retimed = Self { curve: Box::new(curve), stops, joints: Vec::new(), breaks: Vec::new() };
        retimed.joints = retimed.timed(&retimed.curve.joints());
        let inner: Vec<f64> = retimed.stops[1..retimed.stops.len() - 1].iter().map(|stop| stop.1).collect();
        retimed.breaks = retimed.timed(&merged(&retimed.curve.breaks(), &inner));
        Some(retimed)
    }

    /// `curve` with a parameter from 0 to 1.
    #[must_use]
    pub fn unit(curve: AnyCurve) -> AnyCurve {
        let domain = curve.domain();
        if domain == (Domain { start: 0.0, end: 1.0 }) {
            return curve;
        }
        let stops = vec![(0.0, domain.start), (1.0, domain.end)];
        match Self::new(curve.clone(), stops) {
            Some(retimed) => AnyCurve::Retimed(retimed),
            None => curve,
        }
    }

    /// Parameters of the curve with those of this one.
    fn timed(&self, own: &[f64]) -> Vec<(f64, f64)> {
        let time = |t: &f64| {
            let next = self.stops.partition_point(|(_, stop)| stop < t).clamp(1, self.stops.len() - 1);
            let ((u0, t0), (u1, t1)) = (self.stops[next - 1], self.stops[next]);
            (if *t == t1 { u1 } else { u0 + (u1 - u0) * ((t - t0) / (t1 - t0)) }, *t)
        };
        own.iter().map(time).collect()
    }

    /// The curve's own parameter at `u`, and how fast it grows there.
    fn own(&self, u: f64, side: Side) -> (f64, f64) {
        let last = self.stops.len() - 1;
        let next = match side {
            Side::After => self.stops.partition_point(|(stop, _)| *stop <= u),
            Side::Before => self.stops.partition_point(|(stop, _)| *stop < u),
        };
        let next = next.clamp(1, last);
        let ((u0, t0), (u1, t1)) = (self.stops[next - 1], self.stops[next]);
        let rate = (t1 - t0) / (u1 - u0);
        let near = self.breaks.partition_point(|(place, _)| *place < u);
        if let Some((_, t)) = self.breaks.get(near).filter(|(place, _)| *place == u) {
            return (*t, rate);
        }
        let part = ((u - u0) / (u1 - u0)).clamp(0.0, 1.0);
        (t0 * (1.0 - part) + t1 * part, rate)
    }
}

impl Curve for Retimed {
    fn domain(&self) -> Domain {
        Domain { start: self.stops[0].0, end: self.stops[self.stops.len() - 1].0 }
    }

    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }

    fn evaluate(&self, u: f64, side: Side) -> Jet {
        let (t, rate) = self.own(u, side);
        let jet = self.curve.evaluate(t, side);
        Jet { point: jet.point, first: jet.first * rate, second: jet.second * (rate * rate) }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.iter().map(|(u, _)| *u).collect()
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.iter().map(|(u, _)| *u).collect()
    }

    fn has_curvature(&self) -> bool {
        self.curve.has_curvature()
    }

    fn direction(&self, u: f64, side: Side) -> DVec3 {
        self.curve.direction(self.own(u, side).0, side)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curve.chord_deviation(self.own(from, Side::After).0, self.own(to, Side::Before).0)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let ((start, rate), (end, _)) = (self.own(from, Side::After), self.own(to, Side::Before));
        let range = self.curve.second_range(start, end)?;
        Some(Bounds { min: range.min * (rate * rate), max: range.max * (rate * rate) })
    }
}

/// The breaks of a curve where its first derivative jumps, in direction or in speed alone.
#[must_use]
pub fn jumps(curve: &impl Curve) -> Vec<f64> {
    /// Smooth constructions leave about 1e-14 of the derivative.
    const ROUNDING: f64 = 1e-9;
    let jump = |t: &f64| {
        let (before, after) = (curve.evaluate(*t, Side::Before).first, curve.evaluate(*t, Side::After).first);
        before.distance(after) > ROUNDING * before.length().max(after.length())
    };
    let joints = curve.joints();
    curve.breaks().into_iter().filter(|t| joints.contains(t) || jump(t)).collect()
}
