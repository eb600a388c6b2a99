//! Maps that bend space: taper, twist, bend, and along a curve.
//!
//! Source: A. H. Barr, Global and local deformations of solid primitives, Computer Graphics 18 (SIGGRAPH 1984).
//! Each map has an axis; between two places on it the map does its work, beyond them it goes on as it is there.

use core::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};

use super::deformed_path::PathDeformation;
use crate::geometry::number::{Bounds, atan2, sin_cos};

/// Turns of a bend that are told apart when it is undone.
const MOST_TURNS: f64 = 1000.0;

/// A map of space.
#[derive(Clone, Debug, PartialEq)]
pub enum Deformation {
    /// Taper, twist or bend.
    Axial(AxialDeformation),
    /// Along a curve.
    Along(Box<PathDeformation>),
}

/// Where a point goes, and how the map acts near it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warped {
    /// The image.
    pub point: DVec3,
    /// Derivative of the map.
    pub jacobian: DMat3,
}

/// A map that acts along a straight axis.
///
/// [`AxialDeformation::origins`] undoes it.
#[derive(Clone, Debug, PartialEq)]
pub struct AxialDeformation {
    /// A point on the axis.
    pub origin: DVec3,
    /// Unit direction of the axis.
    pub axis: DVec3,
    /// Unit direction across it: toward which a bend goes.
    pub side: DVec3,
    /// Where the map begins, along the axis from the origin.
    pub from: f64,
    /// Where it has done what it does, more than `from`.
    pub to: f64,
    /// Whether it stops acting at `from`, and at `to`; otherwise it goes on beyond them.
    pub stops: (bool, bool),
    /// What it does.
    pub kind: AxialKind,
}

/// What a map does along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxialKind {
    /// Scales across the axis, by `start` up to where it begins and by `end` from where it ends, evenly between.
    Taper {
        /// Factor at the start, more than 0.
        start: f64,
        /// Factor at the end, more than 0.
        end: f64,
    },
    /// Turns about the axis by this many radians from start to end.
    Twist(f64),
    /// Bends the axis into an arc of this many radians that keeps its length.
    Bend(f64),
}

/// A point as the axis sees it.
struct Placed {
    /// Along the axis.
    along: f64,
    /// The same, kept to where the map acts.
    within: f64,
    /// What is left across the axis.
    across: DVec3,
}

impl Deformation {
    /// The image of a point. Beyond the places where the map acts it goes on evenly.
    #[must_use]
    pub fn apply(&self, point: DVec3) -> Warped {
        match self {
            Self::Axial(map) => map.apply(point),
            Self::Along(map) => map.apply(point),
        }
    }

    /// The second derivative at a point along two directions. `near` is a point of the same stretch between kinks, so
    /// that a point on a kink counts to its side.
    #[must_use]
    pub fn second(&self, point: DVec3, near: DVec3, (d, e): (DVec3, DVec3)) -> DVec3 {
        match self {
            Self::Axial(map) => {
                if map.acts(near) {
                    // The form is symmetric, so its values along sums and differences give those of pairs.
                    (map.second(point, d + e) - map.second(point, d - e)) / 4.0
                } else {
                    DVec3::ZERO
                }
            }
            Self::Along(map) => map.second(point, near, (d, e)),
        }
    }

    /// A bound on the size of the third derivative along unit directions, within `reach` of a point; none where none
    /// is known.
    #[must_use]
    pub fn third_bound(&self, point: DVec3, reach: f64) -> Option<f64> {
        match self {
            Self::Axial(map) => Some(if map.acts(point) { map.third_bound(point, reach) } else { 0.0 }),
            Self::Along(_) => None,
        }
    }

    /// Planes through a box across which derivatives jump: a unit normal and the distance from the origin along it.
    #[must_use]
    pub fn kinks(&self, bounds: &Bounds) -> Vec<(DVec3, f64)> {
        match self {
            Self::Axial(map) => {
                let offset = map.origin.dot(map.axis);
                let ends = [(map.stops.0, map.from), (map.stops.1, map.to)];
                ends.into_iter()
                    .filter(|(stops, _)| *stops)
                    .map(|(_, end)| (map.axis, offset + end))
                    .collect()
            }
            Self::Along(map) => map.kinks(bounds),
        }
    }

    /// Points whose image is `image`, as far as they are found.
    #[must_use]
    pub fn origins(&self, image: DVec3) -> Vec<DVec3> {
        match self {
            Self::Axial(map) => map.origins(image),
            Self::Along(map) => map.origins(image),
        }
    }

    /// Radians by which the map turns directions for a unit of length along its axis, about.
    #[must_use]
    pub fn turn_rate(&self, point: DVec3) -> f64 {
        match self {
            Self::Axial(map) => map.turn_rate(point),
            Self::Along(map) => map.turn_rate(point),
        }
    }

    /// A point on the axis and its unit direction: planes across it stay flat, and keep their form but for size.
    #[must_use]
    pub fn axis(&self) -> (DVec3, DVec3) {
        match self {
            Self::Axial(map) => (map.origin, map.axis),
            Self::Along(map) => map.axis(),
        }
    }

    /// The radius of the bend at a point, and how far the point reaches toward its center; none where nothing bends.
    #[must_use]
    pub fn bend(&self, point: DVec3) -> Option<(f64, f64)> {
        match self {
            Self::Axial(map) => {
                let curvature = map.rate();
                let bends = matches!(map.kind, AxialKind::Bend(_)) && curvature != 0.0;
                let inward = (point - map.origin).dot(map.side) * curvature.signum();
                bends.then(|| (1.0 / curvature.abs(), inward))
            }
            Self::Along(map) => map.bend(point),
        }
    }

    /// A bound on the factor by which lengths grow inside a box.
    #[must_use]
    pub fn stretch(&self, bounds: &Bounds) -> f64 {
        match self {
            Self::Axial(map) => map.stretch(bounds),
            Self::Along(map) => map.stretch(bounds),
        }
    }
}

impl AxialDeformation {
    fn place(&self, point: DVec3) -> Placed {
        let away = point - self.origin;
        let along = away.dot(self.axis);
        let within = along.clamp(self.first(), self.last());
        Placed { along, within, across: away - self.axis * along }
    }

    /// Where it begins to act.
    fn first(&self) -> f64 {
        if self.stops.0 { self.from } else { f64::NEG_INFINITY }
    }

    /// Where it ceases to act.
    fn last(&self) -> f64 {
        if self.stops.1 { self.to } else { f64::INFINITY }
    }

    fn acts(&self, point: DVec3) -> bool {
        let along = (point - self.origin).dot(self.axis);
        along >= self.first() && along <= self.last()
    }

    /// What is done by a unit of length along the axis.
    fn rate(&self) -> f64 {
        let span = self.to - self.from;
        match self.kind {
            AxialKind::Taper { start, end } => (end - start) / span,
            AxialKind::Twist(radians) | AxialKind::Bend(radians) => radians / span,
        }
    }

    fn turn_rate(&self, point: DVec3) -> f64 {
        match self.kind {
            AxialKind::Twist(_) | AxialKind::Bend(_) if self.acts(point) => self.rate().abs(),
            _ => 0.0,
        }
    }

    fn apply(&self, point: DVec3) -> Warped {
        let place = self.place(point);
        let rate = if place.along == place.within { self.rate() } else { 0.0 };
        let reached = self.rate() * (place.within - self.from);
        match self.kind {
            AxialKind::Taper { start, .. } => self.tapered(&place, start + reached, rate),
            AxialKind::Twist(_) => self.twisted(&place, reached, rate),
            AxialKind::Bend(_) => self.bent(&place, reached, rate),
        }
    }

    /// All points whose image is `image`: a bend by more than a full turn has several.
    #[must_use]
    pub fn origins(&self, image: DVec3) -> Vec<DVec3> {
        let away = image - self.origin;
        let along = away.dot(self.axis);
        let across = away - self.axis * along;
        let reached = self.rate() * (along.clamp(self.first(), self.last()) - self.from);
        match self.kind {
            AxialKind::Taper { start, .. } => vec![image - across + across / (start + reached)],
            AxialKind::Twist(_) => vec![image - across + self.turned(across, -reached)],
            AxialKind::Bend(_) => self.unbent(image, away),
        }
    }

    fn unbent(&self, image: DVec3, away: DVec3) -> Vec<DVec3> {
        let third = self.axis.cross(self.side);
        let curvature = self.rate();
        let flat = DVec2::new(away.dot(self.axis) - self.from, away.dot(self.side));
        let place = |run: f64, x: f64| {
            self.origin + self.axis * (self.from + run) + self.side * x + third * away.dot(third)
        };
        if curvature == 0.0 {
            return vec![image];
        }
        let mut all = Vec::new();
        let (first, last) = (self.first() - self.from, self.last() - self.from);
        // The straight ends.
        if flat.x < first.min(0.0) || (self.stops.0 && flat.x <= 0.0) {
            all.push(place(flat.x, flat.y));
        }
        if self.stops.1 {
            let radians = curvature * last;
            let (sin, cos) = sin_cos(radians);
            let (half, _) = sin_cos(radians / 2.0);
            let end = DVec2::new(sin, 2.0 * half * half) / curvature;
            let beyond = (flat - end).dot(DVec2::new(cos, sin));
            if beyond >= 0.0 {
                all.push(place(last + beyond, (flat - end).dot(DVec2::new(-sin, cos))));
            }
        }
        // The arc: the spoke from the center of the bend.
        let radius = 1.0 / curvature;
        let spoke = DVec2::new(flat.x, radius - flat.y) * curvature.signum();
        let angle = atan2(spoke.x, spoke.y);
        let x = radius - spoke.length() * curvature.signum();
        let turns = |run: f64| if run.is_finite() { run * curvature / TAU } else { 0.0 };
        let most = (turns(self.to - self.from).abs() + 1.0).min(MOST_TURNS);
        let mut turn = -most.ceil();
        while turn <= most.ceil() {
            let run = (angle + turn * TAU) / curvature;
            if run >= first && run <= last {
                all.push(place(run, x));
            }
            turn += 1.0;
        }
        all
    }

    fn tapered(&self, place: &Placed, factor: f64, rate: f64) -> Warped {
        let straight = outer(self.axis, self.axis);
        Warped {
            point: self.origin + self.axis * place.along + place.across * factor,
            jacobian: straight
                + (DMat3::IDENTITY - straight) * factor
                + outer(place.across * rate, self.axis),
        }
    }

    /// A vector across the axis, turned about it.
    fn turned(&self, across: DVec3, radians: f64) -> DVec3 {
        let (sin, cos) = sin_cos(radians);
        across * cos + self.axis.cross(across) * sin
    }

    fn twisted(&self, place: &Placed, radians: f64, rate: f64) -> Warped {
        let turned = self.turned(place.across, radians);
        let column = |unit: DVec3| {
            let along = unit.dot(self.axis);
            self.turned(unit - self.axis * along, radians)
                + (self.axis + self.axis.cross(turned) * rate) * along
        };
        Warped {
            point: self.origin + self.axis * place.along + turned,
            jacobian: DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)),
        }
    }

    fn bent(&self, place: &Placed, radians: f64, rate: f64) -> Warped {
        let (sin, cos) = sin_cos(radians);
        let (half, _) = sin_cos(radians / 2.0);
        let (onward, inward) = (self.axis * cos + self.side * sin, self.side * cos - self.axis * sin);
        let third = self.axis.cross(self.side);
        let (x, z) = (place.across.dot(self.side), place.across.dot(third));
        let curvature = self.rate();
        // Along the arc of the axis itself, then across it, then straight on behind its end.
        let (run, rise) = if curvature == 0.0 {
            (place.within - self.from, 0.0)
        } else {
            (sin / curvature, 2.0 * half * half / curvature)
        };
        let beyond = place.along - place.within;
        let center = self.axis * (self.from + run) + self.side * rise + onward * beyond;
        Warped {
            point: self.origin + center + inward * x + third * z,
            jacobian: outer(onward * (1.0 - rate * x), self.axis)
                + outer(inward, self.side)
                + outer(third, third),
        }
    }

    /// The second derivative along one direction where the map acts.
    fn second(&self, point: DVec3, d: DVec3) -> DVec3 {
        let place = self.place(point);
        let rate = self.rate();
        let along = d.dot(self.axis);
        let across = d - self.axis * along;
        let radians = rate * (place.within - self.from);
        match self.kind {
            AxialKind::Taper { .. } => across * (2.0 * rate * along),
            AxialKind::Twist(_) => {
                let (turned, spoke) = (self.turned(across, radians), self.turned(place.across, radians));
                self.axis.cross(turned) * (2.0 * rate * along) - spoke * (rate * rate * along * along)
            }
            AxialKind::Bend(_) => {
                let (sin, cos) = sin_cos(radians);
                let (onward, inward) = (self.axis * cos + self.side * sin, self.side * cos - self.axis * sin);
                let x = place.across.dot(self.side);
                inward * (rate * (1.0 - rate * x) * along * along)
                    - onward * (2.0 * rate * along * d.dot(self.side))
            }
        }
    }

    fn third_bound(&self, point: DVec3, reach: f64) -> f64 {
        let across = self.place(point).across;
        let rate = self.rate().abs();
        match self.kind {
            AxialKind::Taper { .. } => 0.0,
            AxialKind::Twist(_) => rate * rate * (rate * (across.length() + reach) + 3.0),
            AxialKind::Bend(_) => {
                let arm = (1.0 - self.rate() * across.dot(self.side)).abs() + rate * reach;
                rate * rate * (arm + 3.0)
            }
        }
    }

    fn stretch(&self, bounds: &Bounds) -> f64 {
        let corners = super::second::corners(bounds);
        let reach = |measure: fn(&Self, &Placed) -> f64| {
            corners.iter().map(|corner| measure(self, &self.place(*corner))).fold(0.0, f64::max)
        };
        let rate = self.rate().abs();
        match self.kind {
            AxialKind::Taper { start, .. } => {
                let factor = |map: &Self, place: &Placed| (map.rate() * (place.within - map.from)).abs();
                start.max(1.0) + reach(factor) + rate * reach(|_, place| place.across.length())
            }
            AxialKind::Twist(_) => {
                // The greatest singular value of a shear by w.
                let w = rate * reach(|_, place| place.across.length());
                (w + (w * w + 4.0).sqrt()) / 2.0
            }
            AxialKind::Bend(_) => {
                reach(|map, place| (1.0 - map.rate() * place.across.dot(map.side)).abs()).max(1.0)
            }
        }
    }
}

/// The matrix that takes v to a (b . v).
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
