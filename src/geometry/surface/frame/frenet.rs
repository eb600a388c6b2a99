//! The angle from rotation-minimizing frames to Frenet's.
//!
//! The principal normal has no direction where the path is straight, and jumps to the other side at an
//! inflection. So that sections do not jump, the angle is that of the normal or of its opposite, whichever goes
//! on without a jump; over a straight part it goes evenly from what comes before to what comes after, by the
//! least turn that meets the line of the normal. Source of the frame: F. Frenet, Sur les courbes a double
//! courbure, 1852.

use core::f64::consts::{FRAC_PI_2, PI};

use super::transport::{Stop, Transport};
use super::wrapped;
use crate::geometry::curve::{AnyCurve, Curve, Side};

/// A part of the path on which one rule gives the angle. Parts follow each other without gaps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Last parameter.
    end: f64,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// The angle of the normal plus this many radians, a multiple of π.
    Bent(f64),
    /// From the first angle at the first length to the second at the second.
    Straight { angles: (f64, f64), walked: (f64, f64) },
}

/// Angles along one smooth piece, and whether it bends anywhere.
#[derive(Clone, Debug)]
pub(super) struct Angles {
    parts: Vec<Part>,
    pub(super) bends: bool,
}

/// Samples of a piece between two stops.
const SAMPLES: u32 = 4;

impl Angles {
    /// The angles of the smooth piece that has these stops.
    pub(super) fn new(path: &AnyCurve, transport: &Transport, stops: &[Stop]) -> Self {
        let ends = (stops[0].t, stops[stops.len() - 1].t);
        let search = Search { path, transport, length: transport.length(), ends };
        let mut parts = search.parts(stops);
        let bends = parts.iter().any(|part| matches!(part.kind, Kind::Bent(_)));
        search.join(&mut parts);
        Self { parts, bends }
    }

    /// Angle in radians from the transported frame to Frenet's.
    pub(super) fn at(&self, path: &AnyCurve, transport: &Transport, (t, side): (f64, Side)) -> f64 {
        match self.part(t, side).kind {
            Kind::Bent(half_turns) => principal(path, transport, t, side).unwrap_or(0.0) + half_turns,
            Kind::Straight { angles, walked } => {
                let share = (transport.walked(path, t) - walked.0) / (walked.1 - walked.0);
                angles.0 + (angles.1 - angles.0) * if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
            }
        }
    }

    fn part(&self, t: f64, side: Side) -> &Part {
        let next = self.parts.partition_point(|part| match side {
            Side::After => part.end <= t,
            Side::Before => part.end < t,
        });
        &self.parts[next.min(self.parts.len() - 1)]
    }

    /// Turn for each metre against the transported frame, radians: the torsion, by differences.
    pub(super) fn rate(&self, path: &AnyCurve, transport: &Transport, (t, side): (f64, Side)) -> f64 {
        let part = self.part(t, side);
        if let Kind::Straight { angles, walked } = part.kind {
            let rate = (angles.1 - angles.0) / (walked.1 - walked.0);
            return if rate.is_finite() { rate } else { 0.0 };
        }
        let domain = path.domain();
        let step = 1e-5 * domain.span();
        let index = self.parts.iter().position(|other| other.end == part.end).unwrap_or(0);
        let start = if index > 0 { self.parts[index - 1].end } else { domain.start };
        // Right at an end the normal may still be that of the part beside it.
        let (low, high) = (start + 2.0 * step, (part.end - 2.0 * step).max(start + 2.0 * step));
        let rate = |middle: f64| difference(path, transport, (middle - step, middle + step));
        let middle = t.clamp(low, high);
        if middle == t || high - low < step {
            return rate(middle);
        }
        // Beside an end the rate goes on as it does further inside.
        let inner = if t < middle { middle + step } else { middle - step };
        let (here, there) = (rate(middle), rate(inner));
        here + (there - here) * (t - middle) / (inner - middle)
    }
}

/// Mean rate of the principal angle between two parameters, radians for each metre.
fn difference(path: &AnyCurve, transport: &Transport, (before, after): (f64, f64)) -> f64 {
    let angle = |t: f64| principal(path, transport, t, Side::After);
    let walked = transport.walked(path, after) - transport.walked(path, before);
    match (angle(before), angle(after)) {
        (Some(first), Some(second)) if walked > 0.0 => wrapped(second - first) / walked,
        _ => 0.0,
    }
}

/// Angle from the transported frame's side to the principal normal, where the path bends.
fn principal(path: &AnyCurve, transport: &Transport, t: f64, side: Side) -> Option<f64> {
    let jet = path.evaluate(t, side);
    let frame = transport.frame(path, t, side);
    let inward = jet.second - frame.along * jet.second.dot(frame.along);
    (inward.length_squared() > 0.0).then(|| frame.angle_to(inward))
}

struct Search<'a> {
    path: &'a AnyCurve,
    transport: &'a Transport,
    length: f64,
    ends: (f64, f64),
}

impl Search<'_> {
    fn side(&self, t: f64) -> Side {
        if t >= self.ends.1 { Side::Before } else { Side::After }
    }

    /// The principal angle, or nothing where the path is straight: where it would bend by less than a billionth of
    /// a radian over its whole length.
    fn angle(&self, t: f64) -> Option<f64> {
        const STRAIGHT: f64 = 1e-9;
        let jet = self.path.evaluate(t, self.side(t));
        let speed = jet.first.length();
        let bent = jet.first.cross(jet.second).length() * self.length > STRAIGHT * speed * speed * speed;
        if bent { principal(self.path, self.transport, t, self.side(t)) } else { None }
    }

    /// Bent and straight parts; each bent part ends where the normal jumps to the other side.
    fn parts(&self, stops: &[Stop]) -> Vec<Part> {
        let mut parts = Vec::new();
        let mut last = (stops[0].t, self.angle(stops[0].t));
        for t in self.samples(stops) {
            let next = (t, self.angle(t));
            if let Some(end) = self.change(last, next) {
                parts.push(Part { end, kind: kind(last.1) });
            }
            last = next;
        }
        parts.push(Part { end: self.ends.1, kind: kind(last.1) });
        parts
    }

    /// Parameters after the first stop, close enough to miss nothing: between two breaks at least one.
    fn samples(&self, stops: &[Stop]) -> Vec<f64> {
        let breaks: Vec<f64> =
            self.path.breaks().into_iter().filter(|t| *t > self.ends.0 && *t < self.ends.1).collect();
        let between = breaks.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
        let outer =
            [breaks.first().map(|t| (t + self.ends.0) / 2.0), breaks.last().map(|t| (t + self.ends.1) / 2.0)];
        let steps = stops.windows(2).flat_map(|pair| {
            let step = (pair[1].t - pair[0].t) / f64::from(SAMPLES);
            (1..=SAMPLES).map(move |k| if k == SAMPLES { pair[1].t } else { pair[0].t + step * f64::from(k) })
        });
        let mut all: Vec<f64> = steps.chain(between).chain(outer.into_iter().flatten()).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Where between two samples the kind changes or the normal jumps.
    fn change(&self, (from, before): (f64, Option<f64>), (to, after): (f64, Option<f64>)) -> Option<f64> {
        let like_before = |angle: Option<f64>| match (before, angle) {
            (Some(one), Some(other)) => wrapped(other - one).abs() <= FRAC_PI_2,
            (one, other) => one.is_some() == other.is_some(),
        };
        if like_before(after) {
            return None;
        }
        let (mut low, mut high) = (from, to);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if like_before(self.angle(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        // A normal that turns fast but steadily is no jump.
        match (self.angle(low), self.angle(high)) {
            (Some(one), Some(other)) if wrapped(other - one).abs() < FRAC_PI_2 => None,
            _ => Some((low + high) / 2.0),
        }
    }

    /// Sets the half turns of bent parts and the ends of straight ones so that the angle goes on without jumps.
    fn join(&self, parts: &mut [Part]) {
        let mut start = self.ends.0;
        let mut reached: Option<f64> = None;
        for index in 0..parts.len() {
            let end = parts[index].end;
            match parts[index].kind {
                Kind::Bent(_) => {
                    let entered = self.inside(start, end, true);
                    let half_turns = reached.map_or(0.0, |last| ((last - entered) / PI).round() * PI);
                    parts[index].kind = Kind::Bent(half_turns);
                    reached = Some(self.inside(start, end, false) + half_turns);
                }
                Kind::Straight { .. } => {
                    let next = parts.get(index + 1).map(|next| self.inside(end, next.end, true));
                    let first = reached.or(next).unwrap_or(0.0);
                    let turn = next.map_or(0.0, |next| {
                        let turn = next - first;
                        turn - PI * (turn / PI).round()
                    });
                    let length = |t: f64| self.transport.walked(self.path, t);
                    let (angles, walked) = ((first, first + turn), (length(start), length(end)));
                    parts[index].kind = Kind::Straight { angles, walked };
                    reached = Some(angles.1);
                }
            }
            start = end;
        }
    }

    /// The principal angle just inside the start or the end of a bent part.
    fn inside(&self, start: f64, end: f64, at_start: bool) -> f64 {
        let step = (end - start) * 1e-9;
        let t = if at_start { start + step } else { end - step };
        principal(self.path, self.transport, t, Side::After).unwrap_or(0.0)
    }
}

fn kind(angle: Option<f64>) -> Kind {
    match angle {
        Some(_) => Kind::Bent(0.0),
        None => Kind::Straight { angles: (0.0, 0.0), walked: (0.0, 0.0) },
    }
}
