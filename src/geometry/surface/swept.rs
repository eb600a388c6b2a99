//! The surface that a section sweeps along a path.

use glam::DVec3;

use super::{Carry, Frame, FrameField, Surface, SurfaceJet};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Side};

/// A section (x along the frame's side, y along its up) carried along a path. u is the section's parameter,
/// v the path's. The normal is to the right of the section.
#[derive(Clone, Debug)]
pub struct SweptSurface {
    /// The section.
    pub profile: AnyCurve,
    /// The path.
    pub path: AnyCurve,
    /// Frames along the path.
    pub frames: FrameField,
}

/// The frame of a path at one place, with what its normals need.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Place on the path.
    pub origin: DVec3,
    /// Axes.
    pub frame: Frame,
    /// Curvature vector of the path, one over metres.
    pub curvature: DVec3,
    /// Speed of the path, metres for a unit of its parameter.
    pub speed: f64,
    /// Turn about the path for each metre, radians.
    pub twist: f64,
}

impl Section {
    /// Where a point of the section stands.
    #[must_use]
    pub fn point(&self, x: f64, y: f64) -> DVec3 {
        self.origin + self.frame.side * x + self.frame.up * y
    }

    /// Derivative by the path's parameter of a point of the section.
    #[must_use]
    pub fn onward(&self, x: f64, y: f64) -> DVec3 {
        let offset = self.frame.side * x + self.frame.up * y;
        let around = self.frame.up * x - self.frame.side * y;
        (self.frame.along * (1.0 - offset.dot(self.curvature)) + around * self.twist) * self.speed
    }

    /// Unit normal where the section passes (x, y) in direction (dx, dy).
    #[must_use]
    pub fn normal(&self, (x, y): (f64, f64), (dx, dy): (f64, f64)) -> DVec3 {
        let flat = self.frame.side * dy - self.frame.up * dx;
        if self.twist == 0.0 {
            return flat.normalize_or(self.frame.side);
        }
        let across = self.frame.side * dx + self.frame.up * dy;
        across.cross(self.onward(x, y)).normalize_or(flat)
    }
}

impl SweptSurface {
    /// The surface of `profile` along `path`.
    #[must_use]
    pub fn new(profile: AnyCurve, path: AnyCurve, carry: &Carry) -> Self {
        let frames = FrameField::new(&path, carry, reach(&profile));
        Self { profile, path, frames }
    }

    /// The path's frame at `v` from one side.
    #[must_use]
    pub fn section(&self, v: f64, side: Side) -> Section {
        let jet = self.path.evaluate(v, side);
        let frame = self.frames.at(v, side);
        let square = jet.first.length_squared().max(f64::MIN_POSITIVE);
        let across = jet.second - frame.along * jet.second.dot(frame.along);
        Section {
            origin: jet.point,
            frame,
            curvature: across / square,
            speed: square.sqrt(),
            twist: self.frames.turn_rate(v, side),
        }
    }
}

/// About how far a section reaches from its path, metres.
fn reach(profile: &AnyCurve) -> f64 {
    const SAMPLES: u32 = 64;
    let domain = profile.domain();
    let samples = (0..=SAMPLES).map(|k| domain.at(f64::from(k) / f64::from(SAMPLES)));
    samples.chain(profile.joints()).map(|t| profile.point(t).length()).fold(0.0, f64::max)
}

impl Surface for SweptSurface {
    fn domain_u(&self) -> Domain {
        self.profile.domain()
    }

    fn domain_v(&self) -> Domain {
        self.path.domain()
    }

    fn evaluate(&self, u: f64, v: f64) -> SurfaceJet {
        let side_of = |t: f64, domain: Domain| if t >= domain.end { Side::Before } else { Side::After };
        let section = self.section(v, side_of(v, self.domain_v()));
        let side = side_of(u, self.domain_u());
        let jet = self.profile.evaluate(u, side);
        let direction = self.profile.direction(u, side);
        let place = (jet.point.x, jet.point.y);
        SurfaceJet {
            point: section.point(place.0, place.1),
            du: section.frame.side * jet.first.x + section.frame.up * jet.first.y,
            dv: section.onward(place.0, place.1),
            normal: section.normal(place, (direction.x, direction.y)),
        }
    }
}
