//! Rotation-minimizing frames.
//!
//! Source: W. Wang, B. Juettler, D. Zheng, Y. Liu, Computation of rotation minimizing frames, ACM TOG 27
//! (2008): the double reflection method, whose error falls with the fourth power of the step. Steps are halved
//! until the frame at the end of each smooth piece changes by less than 1e-9, so frames are those of the exact
//! field to about 1e-10 radians. At a corner the frame takes the least rotation from one direction to the other.

use glam::DVec3;

use super::Frame;
use crate::geometry::curve::{AnyCurve, Curve, Side, length_of_step};

/// A frame at a known parameter, and the length walked so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub(super) t: f64,
    point: DVec3,
    pub(super) frame: Frame,
    pub(super) walked: f64,
}

/// Frames that do not turn about the path, from its start on.
#[derive(Clone, Debug)]
pub(super) struct Transport {
    stops: Vec<Stop>,
    /// Index of the first stop of each smooth piece. A corner has two stops.
    firsts: Vec<usize>,
}

impl Transport {
    pub(super) fn new(path: &AnyCurve) -> Self {
        let domain = path.domain();
        let along = path.direction(domain.start, Side::After);
        let point = path.point(domain.start);
        let start = Stop { t: domain.start, point, frame: Frame::first(along), walked: 0.0 };
        let mut all = Self { stops: vec![start], firsts: vec![0] };
        let mut cuts = path.joints();
        cuts.push(domain.end);
        for cut in cuts {
            all.walk_to(path, cut);
            if cut < domain.end {
                all.turn_corner(path.direction(cut, Side::After));
            }
        }
        all
    }

    /// Length of the path, metres.
    pub(super) fn length(&self) -> f64 {
        self.stops[self.stops.len() - 1].walked
    }

    /// The stops of each smooth piece.
    pub(super) fn pieces(&self) -> impl Iterator<Item = &[Stop]> {
        let ends = self.firsts.iter().skip(1).copied().chain([self.stops.len()]);
        self.firsts.iter().zip(ends).map(|(first, end)| &self.stops[*first..end])
    }

    /// The piece of a parameter; a corner belongs to the piece of its side.
    pub(super) fn piece(&self, t: f64, side: Side) -> usize {
        let count = self.firsts.partition_point(|first| match side {
            Side::After => self.stops[*first].t <= t,
            Side::Before => self.stops[*first].t < t,
        });
        count.saturating_sub(1)
    }

    /// The frame that came back around a closed path, turned to the direction of the start.
    pub(super) fn returned(&self) -> Frame {
        least_rotation(self.stops[self.stops.len() - 1].frame, self.stops[0].frame.along)
    }

    /// The frame of the start.
    pub(super) fn first(&self) -> Frame {
        self.stops[0].frame
    }

    /// Transports the last frame to `end` over one smooth piece.
    fn walk_to(&mut self, path: &AnyCurve, end: f64) {
        let start = self.stops[self.stops.len() - 1];
        let straight = path.chord_deviation(start.t, end) == 0.0;
        let mut steps = if straight { 1 } else { first_steps(path, start.t, end) };
        let mut walked = walk(path, start, end, steps);
        let most = steps.saturating_mul(64).clamp(8192, 1 << 20);
        while !straight && steps < most {
            steps *= 2;
            let finer = walk(path, start, end, steps);
            let change = finer[finer.len() - 1].frame.side.distance(walked[walked.len() - 1].frame.side);
            walked = finer;
            // Halving divides the error by 16.
            if change < 1e-9 {
                break;
            }
        }
        let mut last = start;
        for stop in &mut walked {
            stop.walked = last.walked + length_of_step(path, last.t, stop.t);
            last = *stop;
        }
        self.stops.extend(walked);
    }

    fn turn_corner(&mut self, along: DVec3) {
        let last = self.stops[self.stops.len() - 1];
        self.firsts.push(self.stops.len());
        self.stops.push(Stop { frame: least_rotation(last.frame, along), ..last });
    }

    /// The last stop at or before a parameter, and the stop at the parameter itself if there is one.
    fn near(&self, t: f64, side: Side) -> (&Stop, Option<&Stop>) {
        let after = self.stops.partition_point(|stop| match side {
            Side::After => stop.t <= t,
            Side::Before => stop.t < t,
        });
        let from = &self.stops[after.saturating_sub(1)];
        if from.t == t {
            return (from, Some(from));
        }
        (from, self.stops.get(after).filter(|next| next.t == t && side == Side::Before))
    }

    /// The frame at `t`, at a corner of the side before or after.
    pub(super) fn frame(&self, path: &AnyCurve, t: f64, side: Side) -> Frame {
        let (from, stop) = self.near(t, side);
        if let Some(stop) = stop {
            return stop.frame;
        }
        let jet = path.evaluate(t, side);
        reflect_twice(from, jet.point, path.direction(t, side))
    }

    /// Length of the path up to a parameter, metres.
    pub(super) fn walked(&self, path: &AnyCurve, t: f64) -> f64 {
        let (from, stop) = self.near(t, Side::After);
        stop.map_or_else(|| from.walked + length_of_step(path, from.t, t.max(from.t)), |stop| stop.walked)
    }

    /// The parameter at a walked length, metres: Newton's method between stops, to the last bit but a few.
    pub(super) fn parameter(&self, path: &AnyCurve, walked: f64) -> f64 {
        let after = self.stops.partition_point(|stop| stop.walked < walked);
        let (Some(to), true) = (self.stops.get(after), after > 0) else {
            return self.stops[after.min(self.stops.len() - 1)].t;
        };
        if to.walked == walked {
            return to.t;
        }
        let from = &self.stops[after - 1];
        let (mut low, mut high) = (from.t, to.t);
        let near = 2.0 * f64::EPSILON * (low.abs().max(high.abs()));
        let mut t = low + (high - low) * ((walked - from.walked) / (to.walked - from.walked));
        for _ in 0..60 {
            let missing = walked - (from.walked + length_of_step(path, from.t, t));
            if missing > 0.0 {
                low = t;
            } else {
                high = t;
            }
            let step = missing / path.evaluate(t, Side::After).first.length();
            // Where the path stands still, or a step leaves what is known, the middle is as good.
            let next = if t + step > low && t + step < high { t + step } else { f64::midpoint(low, high) };
            let moved = (next - t).abs();
            t = next;
            if moved <= near {
                break;
            }
        }
        t
    }
}

/// Steps over which the path turns little: frames at whole turns from each other would look alike. At most
/// 2^20; the frames of a path with more bends than that are rough.
fn first_steps(path: &AnyCurve, start: f64, end: f64) -> u32 {
    // An arc of half a radian deviates by a sixteenth of its length.
    const BENT: f64 = 1.0 / 16.0;
    let mut steps = 32_u32;
    while steps < 1 << 20 {
        let at = |k: u32| start + (end - start) * f64::from(k) / f64::from(steps);
        let bent = |k: u32| {
            let bound = path.chord_deviation(at(k), at(k + 1));
            bound > BENT * length_of_step(path, at(k), at(k + 1))
        };
        if !(0..steps).any(bent) {
            break;
        }
        steps *= 2;
    }
    steps
}

/// Frames after each of so many equal steps; lengths are left for those that stay.
fn walk(path: &AnyCurve, start: Stop, end: f64, steps: u32) -> Vec<Stop> {
    let mut stops = Vec::with_capacity(steps as usize);
    let mut last = start;
    for k in 1..=steps {
        let t = if k == steps { end } else { start.t + (end - start.t) * f64::from(k) / f64::from(steps) };
        let jet = path.evaluate(t, Side::Before);
        let frame = reflect_twice(&last, jet.point, path.direction(t, Side::Before));
        last = Stop { t, point: jet.point, frame, walked: start.walked };
        stops.push(last);
    }
    stops
}

/// One step of the double reflection method.
fn reflect_twice(from: &Stop, point: DVec3, along: DVec3) -> Frame {
    let chord = point - from.point;
    let square = chord.length_squared();
    if square == 0.0 {
        return least_rotation(from.frame, along);
    }
    let reflect = |vector: DVec3| vector - chord * (2.0 / square * chord.dot(vector));
    let (side, tangent) = (reflect(from.frame.side), reflect(from.frame.along));
    let second = along - tangent;
    let square = second.length_squared();
    let side = if square == 0.0 { side } else { side - second * (2.0 / square * second.dot(side)) };
    Frame::new(side, along)
}

/// The frame turned by the least rotation that takes its direction to `along`.
fn least_rotation(frame: Frame, along: DVec3) -> Frame {
    let sum = frame.along + along;
    let square = sum.length_squared();
    if square < 1e-20 {
        return Frame::new(frame.side, along);
    }
    // Two reflections: in the plane across the old direction, then across the bisector.
    let side = frame.side - sum * (2.0 / square * sum.dot(frame.side));
    Frame::new(side, along)
}
