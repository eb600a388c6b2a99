//! The way that the plane of a section moves.

use glam::{DVec2, DVec3};

use crate::geometry::curve::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::number::sin_cos_degrees;
use crate::geometry::surface::{Carry, Frame, FrameField};

/// A moving plane: along a path, or turning and rising about the y axis.
#[derive(Clone, Debug)]
pub enum Carrier {
    /// Across a path.
    Path {
        /// The path.
        path: AnyCurve,
        /// Its frames.
        frames: Box<FrameField>,
    },
    /// Through the y axis.
    Screw(Screw),
}

/// A plane through the y axis that turns about it and rises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// First angle, degrees from +x toward -z.
    pub start: f64,
    /// Turn, degrees, more than zero.
    pub angle: f64,
    /// Rise along y over the whole turn, metres.
    pub rise: f64,
}

/// The plane at one place, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The section's origin.
    pub origin: DVec3,
    /// The section's axes.
    pub frame: Frame,
    /// Derivative of the origin by the parameter.
    pub velocity: DVec3,
    /// Angular velocity by the parameter, radians.
    pub spin: DVec3,
    /// Whether points of the section move otherwise than across it.
    pub leans: bool,
    /// How it leans toward a mitre, where it does.
    pub slope: Option<Slope>,
}

/// A plane that leans: a point `away` from the origin stands `away . lean` further back along the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// What a point stands back for each metre.
    pub lean: DVec3,
    /// Derivative by the parameter.
    pub rate: DVec3,
}

impl Carrier {
    /// Sections across a path that reach up to `reach` metres from it.
    #[must_use]
    pub fn along(path: AnyCurve, carry: &Carry, reach: f64) -> Self {
        let frames = Box::new(FrameField::new(&path, carry, reach));
        Self::Path { path, frames }
    }

    /// The interval of the parameter: of a path its own, of a screw 0 to 1.
    #[must_use]
    pub fn domain(&self) -> Domain {
        match self {
            Self::Path { path, .. } => path.domain(),
            Self::Screw(_) => Domain { start: 0.0, end: 1.0 },
        }
    }

    /// The path, if it follows one.
    #[must_use]
    pub fn path(&self) -> Option<&AnyCurve> {
        match self {
            Self::Path { path, .. } => Some(path),
            Self::Screw(_) => None,
        }
    }

    /// Whether the last plane is the first one's place again; the frames may differ by whole or part turns.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Path { path, .. } => path.is_closed(),
            Self::Screw(_) => false,
        }
    }

    /// The plane at a parameter, at a corner of the named side.
    #[must_use]
    pub fn plane(&self, v: f64, side: Side) -> Plane {
        match self {
            Self::Path { path, frames } => {
                let jet = path.evaluate(v, side);
                let frame = frames.at(v, side);
                let square = jet.first.length_squared().max(f64::MIN_POSITIVE);
                let speed = square.sqrt();
                let turning = frame.along.cross(jet.second) / speed;
                let rate = frames.turn_rate(v, side);
                let spin = turning + frame.along * (speed * rate);
                Plane {
                    origin: jet.point,
                    frame,
                    velocity: frame.along * speed,
                    spin,
                    leans: rate != 0.0,
                    slope: None,
                }
            }
            Self::Screw(screw) => screw.plane(v.clamp(0.0, 1.0)),
        }
    }

    /// Place and derivatives of the origin; of a screw of a point that far from the axis.
    #[must_use]
    pub fn jet(&self, v: f64, side: Side, reach: f64) -> Jet {
        match self {
            Self::Path { path, .. } => path.evaluate(v, side),
            Self::Screw(screw) => {
                let plane = screw.plane(v.clamp(0.0, 1.0));
                let arm = plane.frame.side * reach;
                let first = plane.velocity + plane.spin.cross(arm);
                let second = plane.spin.cross(plane.spin.cross(arm));
                Jet { point: plane.origin + arm, first, second }
            }
        }
    }

    /// Parameters strictly inside where the movement is not smooth: corners, and where a turn begins or ends.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        let Self::Path { path, frames } = self else { return Vec::new() };
        let mut joints = path.joints();
        joints.extend(frames.joints());
        joints.sort_by(f64::total_cmp);
        joints
    }

    /// A bound on how far the origin leaves a chord; of a screw, a point that far from the axis.
    #[must_use]
    pub fn bend(&self, from: f64, to: f64, reach: f64) -> f64 {
        match self {
            Self::Path { path, .. } => path.chord_deviation(from, to),
            Self::Screw(screw) => {
                let half = (screw.angle * (to - from) / 2.0).min(180.0);
                reach * (1.0 - sin_cos_degrees(half).1)
            }
        }
    }

    /// Whether the plane only goes straight on between two parameters.
    #[must_use]
    pub fn is_straight(&self, from: f64, to: f64) -> bool {
        let Self::Path { path, frames } = self else { return false };
        path.chord_deviation(from, to) == 0.0
            && (frames.steady() || frames.turn_between(from, to).abs() < 1e-9)
    }

    /// Turn about the path between two parameters, radians, on top of what the path itself makes it; none of a
    /// screw, whose turn is seen by [`Carrier::bend`].
    #[must_use]
    pub fn turn_between(&self, from: f64, to: f64) -> f64 {
        match self {
            Self::Path { frames, .. } if !frames.steady() => frames.turn_between(from, to),
            _ => 0.0,
        }
    }

    /// The greatest turn for each metre, radians.
    #[must_use]
    pub fn greatest_turn_rate(&self) -> f64 {
        match self {
            Self::Path { frames, .. } => frames.greatest_turn_rate(),
            Self::Screw(_) => 0.0,
        }
    }

    /// The share of the way up to a parameter, 0 to 1.
    #[must_use]
    pub fn share(&self, v: f64) -> f64 {
        match self {
            Self::Path { frames, .. } => frames.share(v),
            Self::Screw(_) => v.clamp(0.0, 1.0),
        }
    }

    /// The parameter at a share of the way.
    #[must_use]
    pub fn parameter(&self, share: f64) -> f64 {
        match self {
            Self::Path { frames, .. } => frames.parameter(share),
            Self::Screw(_) => share.clamp(0.0, 1.0),
        }
    }

    /// Length of the way, metres; of a screw, of a point that far from the axis.
    #[must_use]
    pub fn length(&self, reach: f64) -> f64 {
        match self {
            Self::Path { frames, .. } => frames.length(),
            Self::Screw(screw) => {
                let around = screw.angle.to_radians() * reach;
                (around * around + screw.rise * screw.rise).sqrt()
            }
        }
    }
}

impl Screw {
    /// The parameter runs from the end of the turn to its start: so the plane moves along its own third axis.
    fn plane(&self, v: f64) -> Plane {
        let left = 1.0 - v;
        let (sin, cos) = sin_cos_degrees(self.start + self.angle * left);
        let side = DVec3::new(cos, 0.0, -sin);
        let frame = Frame { side, up: DVec3::Y, along: side.cross(DVec3::Y) };
        let spin = DVec3::Y * -self.angle.to_radians();
        let origin = DVec3::Y * (self.rise * left);
        Plane { origin, frame, velocity: DVec3::Y * -self.rise, spin, leans: true, slope: None }
    }
}

impl Plane {
    /// Where a point of the section stands.
    #[must_use]
    pub fn point(&self, x: f64, y: f64) -> DVec3 {
        let away = self.frame.side * x + self.frame.up * y;
        self.origin + self.leaned(away)
    }

    /// Derivative by the parameter of a point that moves in the section at a rate.
    #[must_use]
    pub fn onward(&self, place: DVec2, rate: DVec2) -> DVec3 {
        let Frame { side, up, along } = self.frame;
        let away = side * place.x + up * place.y;
        let moved = self.spin.cross(away) + side * rate.x + up * rate.y;
        match self.slope {
            None => self.velocity + moved,
            Some(slope) => self.velocity + self.leaned(moved) - along * away.dot(slope.rate),
        }
    }

    /// A direction of the section.
    #[must_use]
    pub fn across(&self, direction: DVec2) -> DVec3 {
        self.leaned(self.frame.side * direction.x + self.frame.up * direction.y)
    }

    fn leaned(&self, away: DVec3) -> DVec3 {
        match self.slope {
            None => away,
            Some(slope) => away - self.frame.along * away.dot(slope.lean),
        }
    }
}
