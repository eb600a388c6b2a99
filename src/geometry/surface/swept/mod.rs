//! Surfaces of moving sections: sweeps, twisted and tapered extrusions, screws.
//!
//! A section lies in a plane that moves along a [`Carrier`]. Its outlines may change on the way, by a
//! [`Change`]: from profile to profile, and in size.

mod carrier;
mod change;
mod law;
mod leaning;
mod matched;
mod outline;

pub use carrier::{Carrier, Plane, Screw, Slope};
pub use change::{Change, Mix};
pub use law::{Law, Stations};
use leaning::Leaning;
pub use matched::{Matched, Spot};
pub use outline::{Outline, Section, SectionPoint};

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Surface, SurfaceJet};
use crate::geometry::curve::{Domain, Side};

/// Outlines carried along.
#[derive(Clone, Debug)]
pub struct SweptSurface {
    /// The outlines, in the plane of the carrier.
    pub outlines: Vec<Outline>,
    /// How they change.
    pub change: Change,
    /// How their plane moves.
    pub carrier: Carrier,
    /// Parameter and share of the way where the change has a joint.
    knots: Vec<(f64, f64)>,
    /// Where sections lean toward mitres, in order.
    leaning: Vec<Leaning>,
}

/// The plane of a section and what the section is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// The plane.
    pub plane: Plane,
    /// Weights and factors.
    pub mix: Mix,
    /// Share of the way for a unit of the parameter.
    pace: f64,
}

impl SweptSurface {
    /// Outlines that change, carried along.
    #[must_use]
    pub fn new(outlines: Vec<Outline>, change: Change, carrier: Carrier) -> Self {
        let joints = carrier.joints();
        let reach = 1e-12 * carrier.domain().span();
        let knot = |share: f64| {
            let v = carrier.parameter(share);
            let near = joints.iter().find(|joint| (**joint - v).abs() <= reach);
            (near.copied().unwrap_or(v), share)
        };
        let knots = change.joints().into_iter().map(knot).collect();
        let mut surface = Self { outlines, change, carrier, knots, leaning: Vec::new() };
        if !surface.change.is_constant() {
            surface.leaning = leaning::find(&surface);
        }
        surface
    }

    /// Parameters strictly inside where the movement or the change is not smooth.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        let mut all = self.carrier.joints();
        all.extend(self.knots.iter().map(|knot| knot.0));
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// The share of the way up to a parameter; at a joint of the change exactly its share.
    #[must_use]
    pub fn share(&self, v: f64) -> f64 {
        let near = self.knots.partition_point(|knot| knot.0 < v);
        match self.knots.get(near) {
            Some((knot, share)) if *knot == v => *share,
            _ => self.carrier.share(v),
        }
    }

    /// The plane and the section at a parameter, at a joint from the named side.
    #[must_use]
    pub fn stand(&self, v: f64, side: Side) -> Stand {
        let mut plane = self.carrier.plane(v, side);
        if self.change.is_constant() {
            return Stand { plane, mix: self.change.mix(0.0, side), pace: 0.0 };
        }
        let pace = match self.carrier {
            Carrier::Path { .. } => plane.velocity.length() / self.carrier.length(0.0),
            Carrier::Screw(_) => 1.0,
        };
        plane.slope = leaning::slope(&self.leaning, v, side);
        plane.leans |= plane.slope.is_some();
        Stand { plane, mix: self.change.mix(self.share(v), side), pace }
    }

    /// Whether between two parameters without a joint between them the section goes on in straight lines, and flat
    /// parts of it stay flat.
    #[must_use]
    pub fn is_straight(&self, from: f64, to: f64) -> bool {
        self.carrier.is_straight(from, to)
            && !self.leaning.iter().any(|part| part.from < to && part.to > from)
            && (self.change.is_constant() || self.change.is_even(self.share(from), self.share(to)))
    }

    /// How far the section reaches from its origin, at its greatest factors, metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        let reach = self.outlines.iter().map(Outline::reach).fold(0.0, f64::max);
        reach * self.change.greatest_weight() * self.change.scale.greatest().max_element()
    }
}

impl Stand {
    /// Where a point of the section stands.
    #[must_use]
    pub fn point(&self, point: &SectionPoint) -> DVec3 {
        self.plane.point(point.place.x, point.place.y)
    }

    /// Derivative of a point by the parameter.
    #[must_use]
    pub fn onward(&self, point: &SectionPoint) -> DVec3 {
        self.plane.onward(point.place, point.rate * self.pace)
    }

    /// Unit normal, to the right of the section.
    #[must_use]
    pub fn normal(&self, point: &SectionPoint) -> DVec3 {
        let (frame, across) = (&self.plane.frame, point.across);
        let flat = frame.side * across.y - frame.up * across.x;
        if point.rate == DVec2::ZERO && !self.plane.leans {
            return flat.normalize_or(frame.side);
        }
        let onward = self.onward(point).normalize_or_zero();
        let across = self.plane.across(across).normalize_or_zero();
        across.cross(onward).normalize_or(flat.normalize_or(frame.side))
    }
}

/// One outline of a swept surface as a surface of its own: u is the outline's parameter, v the carrier's. The normal
/// is to the right of the outline.
#[derive(Clone, Debug)]
pub struct SweptWall {
    /// The surface.
    pub surface: Arc<SweptSurface>,
    /// Index of the outline.
    pub outline: usize,
}

impl SweptWall {
    fn outline(&self) -> &Outline {
        &self.surface.outlines[self.outline]
    }
}

impl Surface for SweptWall {
    fn domain_u(&self) -> Domain {
        self.outline().domain()
    }

    fn domain_v(&self) -> Domain {
        self.surface.carrier.domain()
    }

    fn sided(&self, (u, side_u): (f64, Side), (v, side_v): (f64, Side)) -> SurfaceJet {
        let (across, along) = (self.domain_u(), self.domain_v());
        let (u, v) = (u.clamp(across.start, across.end), v.clamp(along.start, along.end));
        let stand = self.surface.stand(v, side_v);
        let point = self.outline().at(u, side_u, &stand.mix);
        SurfaceJet {
            point: stand.point(&point),
            du: stand.plane.across(point.across),
            dv: stand.onward(&point),
            normal: stand.normal(&point),
        }
    }
}
