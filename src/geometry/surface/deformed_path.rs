//! The map that lays a straight shape along a curve.

use glam::{DMat3, DVec3};

use super::deformation::Warped;
use super::{Carry, Frame, FrameField};
use crate::geometry::curve::{AnyCurve, Curve, Side, nearest_within};
use crate::geometry::number::{Bounds, floor_index};

/// The line of a shape that is laid on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The point that comes to the start of the path.
    pub origin: DVec3,
    /// Unit direction that comes along the path.
    pub axis: DVec3,
    /// Unit direction across it that comes to the side of the frames.
    pub side: DVec3,
    /// From where to where the shape reaches, by length of the path from its start on.
    pub reach: (f64, f64),
    /// Length on the path for a unit of length on the line.
    pub scale: f64,
}

/// Lays the line through `origin` along `axis` on a smooth path, by length: what lies beside the line goes along
/// with frames that turn about the path no more than it makes them. An open path ends where it ends: what lies a
/// rounding beyond goes straight on. A closed path is gone around again.
#[derive(Clone, Debug)]
pub struct PathDeformation {
    path: AnyCurve,
    carry: Carry,
    frames: FrameField,
    line: Line,
    up: DVec3,
    /// Lengths where the path begins, where its curvature may jump, and where it ends.
    stops: Vec<f64>,
    /// Points at even parameters.
    places: Vec<DVec3>,
}

impl PartialEq for PathDeformation {
    /// Frames and lengths follow from the path.
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && self.carry == other.carry && self.line == other.line
    }
}

/// Rounds of a closed path to each side that are told apart; what is wound more often is split by its bends anyway.
const ROUNDS: f64 = 64.0;

/// Pieces of the path from which the nearest place is looked for.
const STRETCHES: usize = 256;

/// The place on the path of a place on the line.
struct Place {
    point: DVec3,
    frame: Frame,
    /// Curvature vector.
    curvature: DVec3,
    /// Turn about the path for each unit of length.
    twist: f64,
}

impl PathDeformation {
    /// The map that lays a line on a path, which has no corner.
    #[must_use]
    pub fn new(path: AnyCurve, carry: &Carry, line: Line) -> Self {
        // No section has to keep clear of a corner.
        let frames = FrameField::new(&path, carry, 0.0);
        let whole = frames.length();
        let mut stops = vec![0.0];
        stops.extend(path.breaks().into_iter().map(|t| frames.share(t) * whole));
        stops.extend(frames.joints().into_iter().map(|t| frames.share(t) * whole));
        stops.push(whole);
        stops.sort_by(f64::total_cmp);
        stops.dedup();
        let domain = path.domain();
        let place = |k: usize| path.point(domain.at(k as f64 / STRETCHES as f64));
        let places = (0..=STRETCHES).map(place).collect();
        Self { carry: *carry, frames, up: line.axis.cross(line.side), line, path, stops, places }
    }

    pub(super) fn axis(&self) -> (DVec3, DVec3) {
        (self.line.origin, self.line.axis)
    }

    /// Place along the path of a point.
    fn reached(&self, point: DVec3) -> f64 {
        (point - self.line.origin).dot(self.line.axis) * self.line.scale
    }

    pub(super) fn turn_rate(&self, point: DVec3) -> f64 {
        let place = self.at(self.reached(point));
        (place.curvature.length() + place.twist.abs()) * self.line.scale
    }

    pub(super) fn bend(&self, point: DVec3) -> Option<(f64, f64)> {
        let place = self.at(self.reached(point));
        let away = point - self.line.origin;
        let offset = place.frame.side * away.dot(self.line.side) + place.frame.up * away.dot(self.up);
        let curvature = place.curvature.length();
        (curvature > 0.0).then(|| (1.0 / curvature, offset.dot(place.curvature) / curvature))
    }

    /// Length of the path.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.frames.length()
    }

    pub(super) fn apply(&self, point: DVec3) -> Warped {
        let away = point - self.line.origin;
        let place = self.at(away.dot(self.line.axis) * self.line.scale);
        let (x, y) = (away.dot(self.line.side), away.dot(self.up));
        let Frame { side, up, along } = place.frame;
        let offset = side * x + up * y;
        let around = up * x - side * y;
        let onward = (along * (1.0 - offset.dot(place.curvature)) + around * place.twist) * self.line.scale;
        let column = |unit: DVec3| {
            onward * unit.dot(self.line.axis) + side * unit.dot(self.line.side) + up * unit.dot(self.up)
        };
        Warped {
            point: place.point + offset,
            jacobian: DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)),
        }
    }

    /// By differences: frames have no closed form. They are taken inside the smooth stretch that holds `near`.
    pub(super) fn second(&self, point: DVec3, near: DVec3, (d, e): (DVec3, DVec3)) -> DVec3 {
        // The cube root of rounding gives half of the digits.
        let step = 1e-5 * self.length() / self.line.scale;
        let size = d.length();
        if size == 0.0 {
            return DVec3::ZERO;
        }
        let way = d * (step / size);
        let (low, high) = self.stretch_of(self.reached(near));
        let margin = (way.dot(self.line.axis) * self.line.scale).abs();
        let reached = self.reached(point);
        let inside =
            if high - low > 2.0 * margin { reached.clamp(low + margin, high - margin) } else { reached };
        let point = point + self.line.axis * ((inside - reached) / self.line.scale);
        let change = self.apply(point + way).jacobian - self.apply(point - way).jacobian;
        change * e * (size / (2.0 * step))
    }

    /// The smooth stretch around a place along the path; beyond the ends of an open path the last one.
    fn stretch_of(&self, length: f64) -> (f64, f64) {
        let whole = self.length();
        let rounds = if self.path.is_closed() { (length / whole).floor() * whole } else { 0.0 };
        let next = self.stops.partition_point(|stop| *stop <= length - rounds).clamp(1, self.stops.len() - 1);
        (self.stops[next - 1] + rounds, self.stops[next] + rounds)
    }

    /// Planes where the curvature of the path jumps, as far as a box reaches.
    pub(super) fn kinks(&self, bounds: &Bounds) -> Vec<(DVec3, f64)> {
        let whole = self.length();
        let offset = self.line.origin.dot(self.line.axis);
        let reached = super::second::corners(bounds)
            .map(|corner| (corner.dot(self.line.axis) - offset) * self.line.scale);
        let low = reached.iter().copied().fold(f64::INFINITY, f64::min);
        let high = reached.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let inner = &self.stops[1..self.stops.len() - 1];
        let mut all = inner.to_vec();
        if self.path.is_closed() {
            let seam = self.rounds().flat_map(|round| {
                let start = round * whole;
                std::iter::once(start).chain(inner.iter().map(move |stop| stop + start))
            });
            all = seam.collect();
        }
        all.retain(|place| *place > low && *place < high);
        all.into_iter().map(|length| (self.line.axis, offset + length / self.line.scale)).collect()
    }

    pub(super) fn stretch(&self, bounds: &Bounds) -> f64 {
        /// Places along the path that are looked at; a prime, so that equal bends are not met at equal places.
        const PLACES: u32 = 257;
        let across = |corner: &DVec3| {
            let away = *corner - self.line.origin;
            (away - self.line.axis * away.dot(self.line.axis)).length()
        };
        let reach = super::second::corners(bounds).iter().map(across).fold(0.0, f64::max);
        let bends = (0..PLACES).map(|k| {
            let place = self.at(self.length() * (f64::from(k) + 0.5) / f64::from(PLACES));
            self.line.scale * (1.0 + reach * (place.curvature.length() + place.twist.abs()))
        });
        bends.fold(self.line.scale.max(1.0), f64::max)
    }

    /// Rounds of a closed path on which the shape lies, from its start; of an open path the only one.
    fn rounds(&self) -> impl Iterator<Item = f64> + use<> {
        let whole = self.length();
        let round = |length: f64| (length / whole).floor().clamp(-ROUNDS, ROUNDS);
        let closed = self.path.is_closed();
        let (low, high) = self.line.reach;
        let (first, last) = if closed { (round(low), round(high)) } else { (0.0, 0.0) };
        (0..=floor_index(last - first)).map(move |k| first + k as f64)
    }

    fn at(&self, length: f64) -> Place {
        let whole = self.length();
        let within = if self.path.is_closed() { length.rem_euclid(whole) } else { length.clamp(0.0, whole) };
        let t = self.frames.parameter(within / whole);
        let side = if t >= self.path.domain().end { Side::Before } else { Side::After };
        let jet = self.path.evaluate(t, side);
        let frame = self.frames.at(t, side);
        let square = jet.first.length_squared().max(f64::MIN_POSITIVE);
        let beyond = if self.path.is_closed() { 0.0 } else { length - within };
        let across = jet.second - frame.along * jet.second.dot(frame.along);
        Place {
            point: jet.point + frame.along * beyond,
            frame,
            curvature: across / square,
            twist: self.frames.turn_rate(t, side),
        }
    }

    /// Points whose image is `image`: for each place of the path whose plane holds it, nearest ones first, then beyond
    /// its ends.
    pub(super) fn origins(&self, image: DVec3) -> Vec<DVec3> {
        let domain = self.path.domain();
        let part = |k: usize| domain.at(k as f64 / STRETCHES as f64);
        let away = |k: usize| self.places[k].distance(image);
        let last = self.places.len() - 1;
        let nearest = (0..=last).map(away).fold(f64::INFINITY, f64::min);
        // Between two places the path may come nearer by as much as they are apart.
        let step = |k: usize| self.places[k].distance(self.places[(k + 1).min(last)]);
        let lowest = |k: &usize| {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
            let found = away(*k);
            found <= away(before).min(away(after)) && found <= nearest + 2.0 * step(before).max(step(*k))
        };
        let starts: Vec<usize> = (0..=last).filter(lowest).collect();
        let around =
            |k: &usize| nearest_within(&self.path, image, part(k.saturating_sub(1)), part((k + 1).min(last)));
        let found: Vec<(f64, f64)> = starts.iter().map(around).collect();
        let mut all: Vec<DVec3> = Vec::new();
        let closed = self.path.is_closed();
        let ends = [(0, domain.start), (last, domain.end)];
        let ends = ends.into_iter().filter(|(k, _)| !closed && starts.contains(k)).map(|(_, t)| t);
        for t in found.iter().map(|(_, t)| *t).chain(ends) {
            let length = self.frames.share(t) * self.length();
            let place = self.at(length);
            let away = image - place.point;
            let along = away.dot(place.frame.along);
            let (x, y) = (away.dot(place.frame.side), away.dot(place.frame.up));
            for round in self.rounds() {
                let run = (length + along + round * self.length()) / self.line.scale;
                all.push(self.line.origin + self.line.axis * run + self.line.side * x + self.up * y);
            }
        }
        all
    }
}
