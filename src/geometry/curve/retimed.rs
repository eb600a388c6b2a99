//! Curves run through at other times.

use glam::DVec3;

use super::bezier::merged;
use super::{AnyCurve, Curve, Domain, Jet, Side, length_between};
use crate::geometry::number::{Bounds, floor_count};

/// A curve under a new parameter u. Between two stops its own parameter t is a cubic polynomial in u (Hermite), so
/// the path stays and only the speed changes.
///
/// Source of the condition that keeps t increasing: F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic
/// interpolation, SIAM J. Numer. Anal. 17 (1980).
#[derive(Clone, Debug, PartialEq)]
pub struct Retimed {
    curve: Box<AnyCurve>,
    stops: Vec<Stop>,
    /// Joints of the curve, each with both parameters: the way from one to the other rounds, and a joint must be
    /// met exactly.
    joints: Vec<(f64, f64)>,
    /// The same of its breaks and of inner stops.
    breaks: Vec<(f64, f64)>,
}

/// A place where both parameters are known, and how fast t grows with u before and after it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stop {
    u: f64,
    t: f64,
    before: f64,
    after: f64,
}

/// t and its derivatives by u.
struct Time {
    t: f64,
    first: f64,
    second: f64,
}

impl Retimed {
    /// `curve` with the parameter u that is `stops[k].0` where its own parameter is `stops[k].1`, and grows evenly
    /// between them. The stops must increase in both, and begin and end with the domain; `None` where they do not.
    #[must_use]
    pub fn new(curve: AnyCurve, stops: &[(f64, f64)]) -> Option<Self> {
        let slopes: Vec<f64> =
            stops.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
        let stop = |(k, (u, t)): (usize, &(f64, f64))| Stop {
            u: *u,
            t: *t,
            before: slopes[k.saturating_sub(1)],
            after: slopes[k.min(slopes.len() - 1)],
        };
        if slopes.is_empty() {
            return None;
        }
        Self::with_stops(curve, stops.iter().enumerate().map(stop).collect())
    }

    /// `curve` with a parameter that grows evenly with the length between two corners, which are given with both
    /// parameters: about so, since the lengths are met exactly only at stops.
    #[must_use]
    pub fn by_length(curve: AnyCurve, corners: &[(f64, f64)]) -> Option<Self> {
        let mut stops: Vec<Stop> = Vec::new();
        for pair in corners.windows(2) {
            let piece = even_speed(&curve, pair[0], pair[1]);
            let skip = usize::from(!stops.is_empty());
            if let (Some(last), Some(first)) = (stops.last_mut(), piece.first()) {
                last.after = first.after;
            }
            stops.extend(piece.into_iter().skip(skip));
        }
        Self::with_stops(curve, stops)
    }

    /// `curve` with a parameter from 0 to 1.
    #[must_use]
    pub fn unit(curve: AnyCurve) -> AnyCurve {
        let domain = curve.domain();
        if domain == (Domain { start: 0.0, end: 1.0 }) {
            return curve;
        }
        match Self::new(curve.clone(), &[(0.0, domain.start), (1.0, domain.end)]) {
            Some(retimed) => AnyCurve::Retimed(retimed),
            None => curve,
        }
    }

    fn with_stops(curve: AnyCurve, stops: Vec<Stop>) -> Option<Self> {
        let domain = curve.domain();
        let ends = (stops.first()?.t, stops.last()?.t) == (domain.start, domain.end);
        let grows = stops.windows(2).all(|pair| pair[0].u < pair[1].u && pair[0].t < pair[1].t);
        if !ends || !grows || stops.len() < 2 {
            return None;
        }
        let mut retimed = Self { curve: Box::new(curve), stops, joints: Vec::new(), breaks: Vec::new() };
        retimed.joints = retimed.timed(&retimed.curve.joints());
        let inner: Vec<f64> = retimed.stops[1..retimed.stops.len() - 1].iter().map(|stop| stop.t).collect();
        retimed.breaks = retimed.timed(&merged(&retimed.curve.breaks(), &inner));
        Some(retimed)
    }

    /// Parameters of the curve with those of this one.
    fn timed(&self, own: &[f64]) -> Vec<(f64, f64)> {
        own.iter().map(|t| (self.inverse(*t), *t)).collect()
    }

    /// The u of a parameter of the curve, by halving.
    fn inverse(&self, t: f64) -> f64 {
        let next = self.stops.partition_point(|stop| stop.t < t).clamp(1, self.stops.len() - 1);
        let (start, end) = (&self.stops[next - 1], &self.stops[next]);
        if t >= end.t {
            return end.u;
        }
        let (mut low, mut high) = (start.u, end.u);
        for _ in 0..64 {
            let middle = (low + high) / 2.0;
            if time_between(start, end, middle).t < t {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    fn piece(&self, u: f64, side: Side) -> (&Stop, &Stop) {
        let next = match side {
            Side::After => self.stops.partition_point(|stop| stop.u <= u),
            Side::Before => self.stops.partition_point(|stop| stop.u < u),
        };
        let next = next.clamp(1, self.stops.len() - 1);
        (&self.stops[next - 1], &self.stops[next])
    }

    /// The curve's own parameter at `u`, and how it grows there.
    fn own(&self, u: f64, side: Side) -> Time {
        let (start, end) = self.piece(u, side);
        let mut time = time_between(start, end, u.clamp(start.u, end.u));
        let near = self.breaks.partition_point(|(place, _)| *place < u);
        if let Some((_, t)) = self.breaks.get(near).filter(|(place, _)| *place == u) {
            time.t = *t;
        }
        time
    }
}

/// Hermite's polynomial between two stops.
fn time_between(start: &Stop, end: &Stop, u: f64) -> Time {
    let step = end.u - start.u;
    let part = (u - start.u) / step;
    let rise = end.t - start.t;
    let even = rise / step;
    if start.after == even && end.before == even {
        return Time { t: start.t * (1.0 - part) + end.t * part, first: even, second: 0.0 };
    }
    // t = start + rise h(part), with h the polynomial from 0 to 1 of the slopes a and b.
    let (a, b) = (start.after / even, end.before / even);
    let (c2, c3) = (3.0 - 2.0 * a - b, a + b - 2.0);
    let height = part * (a + part * (c2 + part * c3));
    let first = a + part * (2.0 * c2 + 3.0 * part * c3);
    let second = 2.0 * c2 + 6.0 * part * c3;
    let t = if part >= 1.0 { end.t } else { start.t + rise * height };
    Time { t, first: even * first, second: even / step * second }
}

/// Stops between two corners, with slopes that make the speed even.
fn even_speed(curve: &AnyCurve, (u0, t0): (f64, f64), (u1, t1): (f64, f64)) -> Vec<Stop> {
    /// Stops of a piece with nothing to show where they are needed.
    const PIECES: u32 = 16;
    /// Slopes beyond this many times that of the chord would turn back.
    const STEEPEST: f64 = 3.0;
    let mut places = vec![t0];
    let inner: Vec<f64> = curve.breaks().into_iter().filter(|t| *t > t0 && *t < t1).collect();
    let each = floor_count(f64::from(PIECES) / (inner.len() as f64 + 1.0)).max(2);
    for end in inner.into_iter().chain([t1]) {
        let start = places[places.len() - 1];
        places.extend(
            (1..=each).map(|k| {
                if k == each { end } else { start + (end - start) * (f64::from(k) / f64::from(each)) }
            }),
        );
    }
    let mut lengths = vec![0.0];
    for pair in places.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + length_between(curve, pair[0], pair[1]));
    }
    let whole = lengths[lengths.len() - 1];
    let last = places.len() - 1;
    let steady =
        lengths.iter().zip(&places).all(|(length, t)| (length / whole - (t - t0) / (t1 - t0)).abs() <= 1e-9);
    if whole <= 0.0 || steady {
        let even = (t1 - t0) / (u1 - u0);
        return vec![
            Stop { u: u0, t: t0, before: even, after: even },
            Stop { u: u1, t: t1, before: even, after: even },
        ];
    }
    let at = |k: usize| {
        if k == last { u1 } else { u0 + (u1 - u0) * (lengths[k] / whole) }
    };
    let chord = |k: usize| (places[k + 1] - places[k]) / (at(k + 1) - at(k)).max(f64::MIN_POSITIVE);
    let rate = whole / (u1 - u0);
    let slope = |k: usize, side: Side| {
        let speed = curve.evaluate(places[k], side).first.length();
        let near = if side == Side::After { chord(k) } else { chord(k - 1) };
        (rate / speed.max(f64::MIN_POSITIVE)).min(STEEPEST * near)
    };
    let stop = |k: usize| {
        let (before, after) = match k {
            0 => (slope(0, Side::After), slope(0, Side::After)),
            _ if k == last => (slope(k, Side::Before), slope(k, Side::Before)),
            _ => (slope(k, Side::Before), slope(k, Side::After)),
        };
        Stop { u: at(k), t: places[k], before, after }
    };
    (0..=last).map(stop).collect()
}

impl Curve for Retimed {
    fn domain(&self) -> Domain {
        Domain { start: self.stops[0].u, end: self.stops[self.stops.len() - 1].u }
    }

    fn is_closed(&self) -> bool {
        self.curve.is_closed()
    }

    fn evaluate(&self, u: f64, side: Side) -> Jet {
        let Time { t, first, second } = self.own(u, side);
        let jet = self.curve.evaluate(t, side);
        Jet {
            point: jet.point,
            first: jet.first * first,
            second: jet.second * (first * first) + jet.first * second,
        }
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
        self.curve.direction(self.own(u, side).t, side)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.curve.chord_deviation(self.own(from, Side::After).t, self.own(to, Side::Before).t)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let mut range = Bounds::EMPTY;
        for pair in self.stops.windows(2) {
            let (low, high) = (pair[0].u.max(from), pair[1].u.min(to));
            let empty = low > high || (low == high && from < to);
            if empty {
                continue;
            }
            let (start, end) =
                (time_between(&pair[0], &pair[1], low), time_between(&pair[0], &pair[1], high));
            let second = self.curve.second_range(start.t, end.t)?;
            if start.second == 0.0 && end.second == 0.0 {
                let rate = start.first * start.first;
                range = range.union(Bounds { min: second.min * rate, max: second.max * rate });
                continue;
            }
            let first = self.curve.first_range(start.t, end.t)?;
            // The second derivative of t is linear; the first is a parabola, at most half a step of it beyond its ends.
            let seconds = (start.second.min(end.second), start.second.max(end.second));
            let beyond = (seconds.1 - seconds.0) * (high - low) / 8.0;
            let firsts =
                ((start.first.min(end.first) - beyond).max(0.0), start.first.max(end.first) + beyond);
            let squares = (firsts.0 * firsts.0, firsts.1 * firsts.1);
            let (one, other) = (scaled(&second, squares), scaled(&first, seconds));
            range = range.union(Bounds { min: one.min + other.min, max: one.max + other.max });
        }
        Some(range)
    }
}

/// The box of vectors of a box times numbers of an interval.
fn scaled(range: &Bounds, (low, high): (f64, f64)) -> Bounds {
    let corners = [range.min * low, range.min * high, range.max * low, range.max * high];
    Bounds::of_points(corners)
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
