//! Sections that change on their way to a mitre.
//!
//! A section that stays as it is goes on straight to the plane that halves a corner. One that changes would be another
//! there than at the corner, so between two corners of a straight part of the way it leans evenly from one mitre to the
//! other. Where its size changes evenly, its points go on in straight lines.

use glam::DVec3;

use super::SweptSurface;
use super::carrier::{Carrier, Slope};
use crate::geometry::curve::{AnyCurve, Curve, Side};

/// A part of the way, without a joint of way or change inside, on which the section leans.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaning {
    pub(super) from: f64,
    pub(super) to: f64,
    /// How it leans at both ends: a point `away` from the way stands `away . lean` back.
    leans: [DVec3; 2],
    /// Size at both ends, where it changes evenly between them, else 1.
    sizes: [f64; 2],
}

/// How the section leans at a parameter, at a joint on the named side.
pub(super) fn slope(parts: &[Leaning], v: f64, side: Side) -> Option<Slope> {
    let next = parts.partition_point(|part| match side {
        Side::After => part.to <= v,
        Side::Before => part.to < v,
    });
    match parts.get(next) {
        Some(part) if part.from < v || (part.from == v && side == Side::After) => Some(part.slope(v)),
        _ => None,
    }
}

impl Leaning {
    fn slope(&self, v: f64) -> Slope {
        let span = self.to - self.from;
        let part = (v - self.from) / span;
        let ([first, last], [one, other]) = (self.leans, self.sizes);
        // A size of zero is a tip, which has no lean of its own.
        match (one == 0.0, other == 0.0) {
            (true, false) => return Slope { lean: last, rate: DVec3::ZERO },
            (false, true) => return Slope { lean: first, rate: DVec3::ZERO },
            (true, true) => return Slope { lean: DVec3::ZERO, rate: DVec3::ZERO },
            _ => {}
        }
        let size = one + (other - one) * part;
        let sum = (first * one).lerp(last * other, part);
        let lean = sum / size;
        Slope { lean, rate: ((last * other - first * one) - lean * (other - one)) / (size * span) }
    }
}

/// The parts of the straight stretches of a path that end at corners.
pub(super) fn find(surface: &SweptSurface) -> Vec<Leaning> {
    let Carrier::Path { path, .. } = &surface.carrier else { return Vec::new() };
    let domain = path.domain();
    let mut corners = vec![domain.start];
    corners.extend(path.joints());
    corners.push(domain.end);
    let knots: Vec<f64> = surface.joints();
    let mut parts = Vec::new();
    for pair in corners.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let leans = [lean(path, from, Side::After), lean(path, to, Side::Before)];
        if path.chord_deviation(from, to) != 0.0 || leans == [DVec3::ZERO; 2] {
            continue;
        }
        let at = |v: f64| leans[0].lerp(leans[1], (v - from) / (to - from));
        let mut stops = vec![from];
        stops.extend(knots.iter().copied().filter(|knot| *knot > from && *knot < to));
        stops.push(to);
        for pair in stops.windows(2) {
            let leans = [at(pair[0]), at(pair[1])];
            parts.push(Leaning {
                from: pair[0],
                to: pair[1],
                leans,
                sizes: sizes(surface, pair[0], pair[1]),
            });
        }
    }
    parts
}

/// What the section leans at an end of a stretch: across the plane that halves the corner there.
fn lean(path: &AnyCurve, v: f64, side: Side) -> DVec3 {
    let domain = path.domain();
    let (end, start) = match v {
        _ if v > domain.start && v < domain.end => (v, v),
        _ if path.is_closed() => (domain.end, domain.start),
        _ => return DVec3::ZERO,
    };
    let (before, after) = (path.direction(end, Side::Before), path.direction(start, Side::After));
    let along = if side == Side::After { after } else { before };
    let bisector = before + after;
    let lean = bisector / along.dot(bisector);
    lean - along * lean.dot(along)
}

fn sizes(surface: &SweptSurface, from: f64, to: f64) -> [f64; 2] {
    let (one, other) = (surface.share(from), surface.share(to));
    if !surface.change.is_even(one, other) {
        return [1.0; 2];
    }
    [surface.change.mix(one, Side::After), surface.change.mix(other, Side::Before)].map(|mix| mix.scale.x)
}
