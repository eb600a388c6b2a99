//! Rotation-minimizing frames along a curve.
//!
//! A frame moves along the path without turning about it. Source: W. Wang, B. Juettler, D. Zheng, Y. Liu,
//! Computation of rotation minimizing frames, ACM TOG 27 (2008): the double reflection method, whose error
//! falls with the fourth power of the step. Steps are halved until the frame at the end of each smooth piece
//! changes by less than 1e-10, so frames are those of the exact field to about that many radians.
//!
//! At a corner the frame takes the least rotation from one direction to the other. Around a closed path the
//! frame comes back turned by some angle; the opposite turn is spread evenly over the length.

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, Curve, Side, length_of_step};
use crate::geometry::number::{atan2, sin_cos};

/// Three perpendicular unit vectors on a path: `side` x `up` = `along`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// A section's x.
    pub side: DVec3,
    /// A section's y.
    pub up: DVec3,
    /// The direction of the path.
    pub along: DVec3,
}

impl Frame {
    fn new(side: DVec3, along: DVec3) -> Self {
        let side = (side - along * side.dot(along)).normalize_or(along.any_orthonormal_vector());
        Self { side, up: along.cross(side), along }
    }

    fn turned(self, radians: f64) -> Self {
        if radians == 0.0 {
            return self;
        }
        let (sin, cos) = sin_cos(radians);
        Self { side: self.side * cos + self.up * sin, up: self.up * cos - self.side * sin, along: self.along }
    }
}

/// A frame at a known parameter, and the length walked so far.
#[derive(Clone, Copy, Debug)]
struct Stop {
    t: f64,
    point: DVec3,
    frame: Frame,
    walked: f64,
}

/// Frames along a path.
#[derive(Clone, Debug)]
pub struct FrameField {
    path: AnyCurve,
    stops: Vec<Stop>,
    /// Turn about the path over its whole length, radians: what closes the frame plus what is asked for.
    turn: f64,
}

impl FrameField {
    /// Frames along `path` that turn by `twist` degrees from its start to its end.
    ///
    /// At the start, up is as near to +y as can be; where the path itself runs along y, side is +x.
    #[must_use]
    pub fn new(path: &AnyCurve, twist: f64) -> Self {
        let domain = path.domain();
        let along = path.direction(domain.start, Side::After);
        let mut field = Self { path: path.clone(), stops: Vec::new(), turn: twist.to_radians() };
        let point = path.point(domain.start);
        field.stops.push(Stop { t: domain.start, point, frame: first_frame(along), walked: 0.0 });
        let mut cuts = path.joints();
        cuts.push(domain.end);
        for cut in cuts {
            field.walk_to(cut);
            if cut < domain.end {
                field.turn_corner(path.direction(cut, Side::After));
            }
        }
        if path.is_closed() {
            field.turn += field.closing_turn(along);
        }
        field
    }

    /// Length of the path as walked, metres.
    fn length(&self) -> f64 {
        self.stops[self.stops.len() - 1].walked
    }

    /// The turn that brings the transported frame back to the first, radians.
    fn closing_turn(&self, along: DVec3) -> f64 {
        let last = self.stops[self.stops.len() - 1].frame;
        let back = least_rotation(last, along);
        let first = self.stops[0].frame;
        atan2(first.side.dot(back.up), first.side.dot(back.side))
    }

    /// Transports the last frame to `end` over one smooth piece.
    fn walk_to(&mut self, end: f64) {
        let start = self.stops[self.stops.len() - 1];
        let straight = self.path.chord_deviation(start.t, end) == 0.0;
        let mut steps = if straight { 1 } else { self.first_steps(start.t, end) };
        let mut walked = self.walk(start, end, steps);
        let most = steps.saturating_mul(64).clamp(8192, 1 << 20);
        while !straight && steps < most {
            steps *= 2;
            let finer = self.walk(start, end, steps);
            let change = finer[finer.len() - 1].frame.side.distance(walked[walked.len() - 1].frame.side);
            walked = finer;
            // Halving divides the error by 16.
            if change < 1e-9 {
                break;
            }
        }
        self.stops.extend(walked);
    }

    /// Steps over which the path turns little: frames at whole turns from each other would look alike. At most
    /// 2^20; the frames of a path with more bends than that are rough.
    fn first_steps(&self, start: f64, end: f64) -> u32 {
        // An arc of half a radian deviates by a sixteenth of its length.
        const BENT: f64 = 1.0 / 16.0;
        let mut steps = 32_u32;
        while steps < 1 << 20 {
            let at = |k: u32| start + (end - start) * f64::from(k) / f64::from(steps);
            let bent = |k: u32| {
                let bound = self.path.chord_deviation(at(k), at(k + 1));
                bound > BENT * length_of_step(&self.path, at(k), at(k + 1))
            };
            if !(0..steps).any(bent) {
                break;
            }
            steps *= 2;
        }
        steps
    }

    fn walk(&self, start: Stop, end: f64, steps: u32) -> Vec<Stop> {
        let mut stops = Vec::with_capacity(steps as usize);
        let mut last = start;
        for k in 1..=steps {
            let t =
                if k == steps { end } else { start.t + (end - start.t) * f64::from(k) / f64::from(steps) };
            let jet = self.path.evaluate(t, Side::Before);
            let frame = reflect_twice(&last, jet.point, self.path.direction(t, Side::Before));
            let walked = last.walked + length_of_step(&self.path, last.t, t);
            last = Stop { t, point: jet.point, frame, walked };
            stops.push(last);
        }
        stops
    }

    fn turn_corner(&mut self, along: DVec3) {
        let last = self.stops[self.stops.len() - 1];
        self.stops.push(Stop { frame: least_rotation(last.frame, along), ..last });
    }

    /// The frame at `t`, at a corner of the side before or after.
    #[must_use]
    pub fn at(&self, t: f64, side: Side) -> Frame {
        let domain = self.path.domain();
        let t = t.clamp(domain.start, domain.end);
        let after = self.stops.partition_point(|stop| match side {
            Side::After => stop.t <= t,
            Side::Before => stop.t < t,
        });
        let from = &self.stops[after.saturating_sub(1)];
        let next = self.stops.get(after).filter(|next| next.t == t && side == Side::Before);
        let stop = if from.t == t { Some(from) } else { next };
        let frame = stop.map_or_else(
            || {
                let jet = self.path.evaluate(t, side);
                reflect_twice(from, jet.point, self.path.direction(t, side))
            },
            |stop| stop.frame,
        );
        if self.turn == 0.0 {
            return frame;
        }
        let walked = stop.map_or_else(
            || from.walked + length_of_step(&self.path, from.t, t.max(from.t)),
            |stop| stop.walked,
        );
        frame.turned(self.turn * (walked / self.length()))
    }

    /// Turn about the path between two parameters, radians.
    #[must_use]
    pub fn turn_between(&self, from: f64, to: f64) -> f64 {
        if self.turn == 0.0 {
            0.0
        } else {
            self.turn * ((self.walked_to(to) - self.walked_to(from)) / self.length())
        }
    }

    /// Length of the path up to a parameter, metres.
    fn walked_to(&self, t: f64) -> f64 {
        let after = self.stops.partition_point(|stop| stop.t <= t);
        let from = &self.stops[after.saturating_sub(1)];
        if from.t >= t { from.walked } else { from.walked + length_of_step(&self.path, from.t, t) }
    }

    /// Turn about the path for each metre of it, radians.
    #[must_use]
    pub fn twist_rate(&self) -> f64 {
        self.turn / self.length()
    }
}

fn first_frame(along: DVec3) -> Frame {
    let level = DVec3::Y.cross(along);
    // Nearer than this to the vertical, "up" is no guide.
    if level.length() > 1e-6 { Frame::new(level, along) } else { Frame::new(DVec3::X, along) }
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::FrameField;
    use crate::geometry::curve::{AnyCurve, Curve, EllipseArc, Helix, Polyline, Side};
    use crate::geometry::number::{atan2, cos, sin};

    #[test]
    fn a_straight_path_along_z_has_the_plane_of_the_profile() {
        let line = AnyCurve::Polyline(Polyline::new(vec![DVec3::ZERO, DVec3::Z], false).unwrap());
        let frame = FrameField::new(&line, 0.0).at(0.5, Side::After);
        assert_eq!((frame.side, frame.up, frame.along), (DVec3::X, DVec3::Y, DVec3::Z));
    }

    #[test]
    fn on_a_helix_the_frame_turns_back_against_the_torsion() {
        // Against the Frenet frame a rotation-minimizing frame turns by minus the torsion times the length.
        // Steps of whole turns would all look alike.
        for turns in [2.0, 32.0, 64.0] {
            assert_turns_back(turns);
        }
    }

    fn assert_turns_back(turns: f64) {
        let (radius, pitch) = (1.0, 1.0);
        let helix = Helix { radius, end_radius: radius, pitch, turns };
        let field = FrameField::new(&AnyCurve::Helix(helix.clone()), 0.0);
        let rise = pitch / core::f64::consts::TAU;
        let speed = (radius * radius + rise * rise).sqrt();
        let torsion = rise / (speed * speed);
        let angle_to_normal = |t: f64| {
            let frame = field.at(t, Side::After);
            let point = helix.point(t);
            let inward = -DVec3::new(point.x, 0.0, point.z).normalize();
            atan2(frame.up.dot(inward), frame.side.dot(inward))
        };
        let start = angle_to_normal(0.0);
        for k in 1..=64 {
            let t = turns * f64::from(k) / 64.0;
            let expected = start + torsion * speed * core::f64::consts::TAU * t;
            let found = angle_to_normal(t);
            assert!((sin(found) - sin(expected)).abs() < 1e-8, "{t}");
            assert!((cos(found) - cos(expected)).abs() < 1e-8, "{t}");
        }
    }

    #[test]
    fn around_closed_paths_the_frame_comes_back() {
        let bent = (0..7).map(|k| {
            let angle = f64::from(k) * 51.0_f64.to_radians();
            DVec3::new(cos(angle), sin(3.0 * angle), sin(angle))
        });
        let spline = {
            let points: Vec<DVec3> = bent.collect();
            let knots = crate::geometry::curve::parameters(
                &points,
                true,
                crate::geometry::curve::Parametrization::Chordal,
            )
            .unwrap();
            AnyCurve::Bezier(crate::geometry::curve::interpolate_closed(&points, &knots).unwrap())
        };
        let circle = AnyCurve::Ellipse(EllipseArc::full(DVec3::ZERO, 1.0, 1.0));
        for path in [spline, circle] {
            let field = FrameField::new(&path, 0.0);
            let domain = path.domain();
            let (start, end) = (field.at(domain.start, Side::After), field.at(domain.end, Side::Before));
            assert!(start.side.distance(end.side) < 1e-9);
            assert!(start.up.distance(end.up) < 1e-9);
        }
    }
}
