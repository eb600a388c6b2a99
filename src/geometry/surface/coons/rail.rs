//! Curves that carry a surface, run through from 0 to 1.

use glam::{DAffine3, DVec3};

use crate::geometry::curve::{AnyCurve, Curve, Jet, Reversed, Side, Transformed};
use crate::geometry::number::Bounds;

/// A curve, or a part of one, under a parameter from 0 to 1 that grows smoothly with the curve's own. A part of a
/// closed curve may go on beyond its end, from its start again.
///
/// Between stops the curve's parameter is a monotone cubic of the new one; with two stops it is linear. Source:
/// F. N. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J.
/// Sci. Stat. Comput. 5 (1984).
#[derive(Clone, Debug, PartialEq)]
pub struct Rail {
    curve: AnyCurve,
    stops: Vec<Stop>,
    /// Joints of the curve with both parameters: the way from one to the other rounds, and a joint must be met
    /// exactly.
    joints: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Stop {
    /// The new parameter.
    u: f64,
    /// The curve's own.
    t: f64,
    /// How fast the curve's own grows.
    rate: f64,
}

/// Ranges of a curve's derivatives over an interval.
#[derive(Clone, Copy, Debug)]
pub(super) struct RailRange {
    pub(super) first: Bounds,
    pub(super) second: Bounds,
}

impl Rail {
    /// The whole of a curve.
    #[must_use]
    pub fn new(curve: AnyCurve) -> Self {
        let domain = curve.domain();
        Self::through(curve, &[(0.0, domain.start), (1.0, domain.end)])
    }

    /// The part of a curve between two of its parameters, `from` < `to`; on a closed curve `to` may lie beyond the
    /// end of its domain by less than a turn.
    #[must_use]
    pub fn part(curve: AnyCurve, from: f64, to: f64) -> Self {
        Self::through(curve, &[(0.0, from), (1.0, to)])
    }

    /// The curve with its own parameter `t` where the new one is `u`, for each given (u, t), both increasing, u
    /// from 0 to 1.
    pub(super) fn through(curve: AnyCurve, stops: &[(f64, f64)]) -> Self {
        let stops = monotone(stops);
        let mut rail = Self { curve, stops, joints: Vec::new() };
        rail.joints = rail.find_joints(&[]);
        rail
    }

    /// The same backwards.
    pub(super) fn backward(&self) -> Self {
        let domain = self.curve.domain();
        let mirrored = |t: f64| domain.start + (domain.end - t);
        let back = if self.goes_around() { domain.span() } else { 0.0 };
        let stops: Vec<(f64, f64)> =
            self.stops.iter().rev().map(|stop| (1.0 - stop.u, mirrored(stop.t) + back)).collect();
        Self::through(AnyCurve::Reversed(Reversed::new(self.curve.clone())), &stops)
    }

    /// The same under a map.
    pub(super) fn mapped(&self, map: &DAffine3) -> Self {
        let curve = AnyCurve::Transformed(Transformed::new(self.curve.clone(), *map));
        Self { curve, ..self.clone() }
    }

    /// The same with joints that miss one of `others` by rounding alone moved onto it.
    pub(super) fn with_joints_at(mut self, others: &[f64]) -> Self {
        self.joints = self.find_joints(others);
        self
    }

    fn find_joints(&self, others: &[f64]) -> Vec<(f64, f64)> {
        /// Joints nearer than this share of the domain are one line of the surface.
        const SAME: f64 = 1e-9;
        let (first, last) = (self.stops[0], self.stops[self.stops.len() - 1]);
        let inside = |t: &f64| *t > first.t && *t < last.t;
        let placed = |t: f64| {
            let u = self.inverse(t);
            let near = others.iter().copied().find(|other| (other - u).abs() <= SAME);
            (near.unwrap_or(u), t)
        };
        let mut joints = self.curve.joints();
        let domain = self.curve.domain();
        if last.t > domain.end {
            // The seam counts as a joint, so that no stretch between two of them leaves the domain.
            joints.push(domain.end);
            let again: Vec<f64> = self.curve.joints().into_iter().map(|t| t + domain.span()).collect();
            joints.extend(again);
        }
        joints.into_iter().filter(inside).map(placed).collect()
    }

    /// A parameter within the curve's domain.
    fn wrapped(&self, t: f64, side: Side) -> f64 {
        let domain = self.curve.domain();
        let beyond = t > domain.end || (t == domain.end && side == Side::After && self.goes_around());
        if beyond && self.goes_around() { domain.start + (t - domain.end) } else { t }
    }

    fn goes_around(&self) -> bool {
        self.stops[self.stops.len() - 1].t > self.curve.domain().end
    }

    /// The new parameter of one of the curve's own.
    fn inverse(&self, t: f64) -> f64 {
        let next = self.stops.partition_point(|stop| stop.t < t).clamp(1, self.stops.len() - 1);
        let (mut low, mut high) = (self.stops[next - 1].u, self.stops[next].u);
        if self.stops.len() == 2 {
            let (a, b) = (self.stops[0], self.stops[1]);
            return a.u + (b.u - a.u) * ((t - a.t) / (b.t - a.t));
        }
        // The cubic grows, so halving ends between two neighbouring numbers.
        for _ in 0..64 {
            let middle = f64::midpoint(low, high);
            if self.time(next - 1, middle).0 < t {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Parameters where the direction of the curve jumps, from 0 to 1.
    pub(super) fn joints(&self) -> Vec<f64> {
        self.joints.iter().map(|(u, _)| *u).collect()
    }

    fn piece(&self, u: f64, side: Side) -> usize {
        let inner = &self.stops[1..self.stops.len() - 1];
        match side {
            Side::After => inner.partition_point(|stop| stop.u <= u),
            Side::Before => inner.partition_point(|stop| stop.u < u),
        }
    }

    /// The curve's own parameter and its two derivatives.
    fn time(&self, piece: usize, u: f64) -> (f64, f64, f64) {
        let (a, b) = (self.stops[piece], self.stops[piece + 1]);
        let span = b.u - a.u;
        let x = ((u - a.u) / span).clamp(0.0, 1.0);
        let y = 1.0 - x;
        if self.stops.len() == 2 {
            return (a.t * y + b.t * x, (b.t - a.t) / span, 0.0);
        }
        let [p, q, r, s] = [a.t, a.t + a.rate * span / 3.0, b.t - b.rate * span / 3.0, b.t];
        let value = y * y * (y * p + 3.0 * x * q) + x * x * (3.0 * y * r + x * s);
        let first = 3.0 * (y * y * (q - p) + 2.0 * x * y * (r - q) + x * x * (s - r)) / span;
        let second = 6.0 * (y * (r - 2.0 * q + p) + x * (s - 2.0 * r + q)) / (span * span);
        (value, first, second)
    }

    /// Point and derivatives by the new parameter.
    pub(super) fn evaluate(&self, u: f64, side: Side) -> Jet {
        let (mut t, rate, bend) = self.time(self.piece(u, side), u);
        let near = self.joints.partition_point(|(joint, _)| *joint < u);
        if let Some((_, own)) = self.joints.get(near).filter(|(joint, _)| *joint == u) {
            t = *own;
        }
        let jet = self.curve.evaluate(self.wrapped(t, side), side);
        Jet {
            point: jet.point,
            first: jet.first * rate,
            second: jet.second * (rate * rate) + jet.first * bend,
        }
    }

    /// Place at `u`.
    #[must_use]
    pub fn point(&self, u: f64) -> DVec3 {
        self.evaluate(u, if u >= 1.0 { Side::Before } else { Side::After }).point
    }

    /// Boxes of the derivatives over an interval that no joint cuts; none where the curve knows no bound.
    pub(super) fn range(&self, (from, to): (f64, f64)) -> Option<RailRange> {
        let (first, last) = (self.piece(from, Side::After), self.piece(to, Side::Before));
        let mut range: Option<RailRange> = None;
        for piece in first..=last.max(first) {
            let (low, high) = (from.max(self.stops[piece].u), to.min(self.stops[piece + 1].u));
            let part = self.piece_range(piece, (low, high))?;
            range = Some(range.map_or(part, |whole| RailRange {
                first: whole.first.union(part.first),
                second: whole.second.union(part.second),
            }));
        }
        range
    }

    fn piece_range(&self, piece: usize, (from, to): (f64, f64)) -> Option<RailRange> {
        let (start, end) = (self.time(piece, from), self.time(piece, to));
        let (low, high) = (self.own(from, start.0), self.own(to, end.0));
        let (low, high) = (self.wrapped(low, Side::After), self.wrapped(high, Side::Before));
        let (first, second) = (self.curve.first_range(low, high)?, self.curve.second_range(low, high)?);
        if self.stops.len() == 2 {
            let rate = start.1;
            return Some(RailRange {
                first: Bounds { min: first.min * rate, max: first.max * rate },
                second: Bounds { min: second.min * (rate * rate), max: second.max * (rate * rate) },
            });
        }
        // The rate is a quadratic whose ends and middle control value bound it; its slope is linear.
        let half = (to - from) / 2.0;
        let middle = start.1 + start.2 * half;
        let rate = (start.1.min(end.1).min(middle), start.1.max(end.1).max(middle));
        let bend = (start.2.min(end.2), start.2.max(end.2));
        let square = (rate.0.max(0.0) * rate.0.max(0.0), rate.1 * rate.1);
        let (turned, drawn) = (scaled(&second, square), scaled(&first, bend));
        Some(RailRange {
            first: scaled(&first, rate),
            second: Bounds { min: turned.min + drawn.min, max: turned.max + drawn.max },
        })
    }

    /// The curve's own parameter, at a joint exactly.
    fn own(&self, u: f64, t: f64) -> f64 {
        let near = self.joints.partition_point(|(joint, _)| *joint < u);
        self.joints.get(near).filter(|(joint, _)| *joint == u).map_or(t, |(_, own)| *own)
    }
}

/// The box of the products of a number of an interval and a vector of a box.
pub(super) fn scaled(range: &Bounds, (low, high): (f64, f64)) -> Bounds {
    let [a, b, c, d] = [range.min * low, range.min * high, range.max * low, range.max * high];
    Bounds { min: a.min(b).min(c.min(d)), max: a.max(b).max(c.max(d)) }
}

fn monotone(stops: &[(f64, f64)]) -> Vec<Stop> {
    let last = stops.len() - 1;
    let slope = |k: usize| (stops[k + 1].1 - stops[k].1) / (stops[k + 1].0 - stops[k].0);
    let rate = |k: usize| {
        if k == 0 || k == last {
            return slope(k.min(last - 1));
        }
        let (before, after) = (stops[k].0 - stops[k - 1].0, stops[k + 1].0 - stops[k].0);
        let weight = (before + 2.0 * after) / (3.0 * (before + after));
        let (left, right) = (slope(k - 1), slope(k));
        left * right / (weight * right + (1.0 - weight) * left)
    };
    (0..stops.len()).map(|k| Stop { u: stops[k].0, t: stops[k].1, rate: rate(k) }).collect()
}

/// Moves joints of rails that miss each other by rounding alone together; all joints, increasing.
pub(super) fn matched(rails: &mut [Option<Rail>]) -> Vec<f64> {
    let mut joints: Vec<f64> = Vec::new();
    for rail in rails.iter_mut().flatten() {
        *rail = rail.clone().with_joints_at(&joints);
        joints.extend(rail.joints());
        joints.sort_by(f64::total_cmp);
        joints.dedup();
    }
    joints
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Rail;
    use crate::geometry::curve::{AnyCurve, BezierSpline, EllipseArc, Side};

    fn rails() -> Vec<Rail> {
        let arc = AnyCurve::Ellipse(EllipseArc::circle(DVec3::Y, 2.0, 10.0, 130.0));
        let points = [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 1.0)];
        let points = points.map(|(x, y)| DVec3::new(x, y, x * y)).to_vec();
        let cubic = AnyCurve::Bezier(BezierSpline::new(3, points).unwrap());
        let stops = [(0.0, 0.0), (0.2, 0.35), (0.7, 0.6), (1.0, 1.0)];
        vec![
            Rail::new(arc.clone()),
            Rail::part(arc, 0.2, 0.9),
            Rail::new(cubic.clone()),
            Rail::through(cubic, &stops),
            Rail::part(AnyCurve::Ellipse(EllipseArc::full(DVec3::X, 2.0, 1.0)), 0.8, 1.3),
        ]
    }

    #[test]
    fn derivatives_are_limits_and_lie_in_their_ranges() {
        for (index, rail) in rails().iter().enumerate() {
            for k in 0..20 {
                let u = (f64::from(k) + 0.37) / 20.0;
                let h = 1e-5;
                let at = |u: f64| rail.evaluate(u, Side::After);
                let first = (at(u + h).point - at(u - h).point) / (2.0 * h);
                let second = (at(u + h).first - at(u - h).first) / (2.0 * h);
                let here = at(u);
                if rail.joints().iter().any(|joint| (joint - u).abs() < 0.02) {
                    continue;
                }
                assert!(first.distance(here.first) < 1e-7 * (1.0 + here.first.length()), "{index} {u}");
                assert!(second.distance(here.second) < 1e-6 * (1.0 + here.second.length()), "{index} {u}");
                let range = rail.range((u - 0.01, u + 0.013)).expect("known");
                for k in 0..=8 {
                    let jet = at(u - 0.01 + 0.023 * f64::from(k) / 8.0);
                    let slack = DVec3::splat(1e-9);
                    assert!(jet.first.cmpge(range.first.min - slack).all(), "{index}");
                    assert!(jet.first.cmple(range.first.max + slack).all(), "{index}");
                    assert!(jet.second.cmpge(range.second.min - slack).all(), "{index}");
                    assert!(jet.second.cmple(range.second.max + slack).all(), "{index}");
                }
            }
        }
    }

    #[test]
    fn stops_are_met() {
        let rail = &rails()[3];
        let curve = &rails()[2];
        for (u, t) in [(0.0, 0.0), (0.2, 0.35), (0.7, 0.6), (1.0, 1.0)] {
            assert!(rail.point(u).distance(curve.point(t)) < 1e-14);
        }
    }
}
