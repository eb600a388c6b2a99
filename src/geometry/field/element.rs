//! Elements of a skeleton: points, segments, polygons and curves, with the distances to them.
//!
//! Promise: nearest points are exact to rounding, of curves too (chords find the piece, Newton's method the place).
//! Bounds over a ball hold for every point in it: distances change no faster than places, and the way to the nearest
//! point of a convex set no faster either; of what is not convex every piece that may be nearest is looked at.

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::mesh::nearest::nearest_of_triangle;
use crate::geometry::number::Bounds;

use super::skeleton::Potential;

/// A part of a skeleton and the potential around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// What it is.
    pub form: Form,
    /// How the potential falls off with the distance.
    pub potential: Potential,
    /// Factor of the potential; negative takes away.
    pub strength: f64,
}

/// The form of an element.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A point.
    Point(DVec3),
    /// A segment.
    Segment(DVec3, DVec3),
    /// Flat polygons, as triangles.
    Triangles(Vec<[DVec3; 3]>),
    /// A curve, in one part or more.
    Curves(Vec<Line>),
}

/// A curve and chords along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    curve: AnyCurve,
    /// Parameters and places along it; joints among them.
    stops: Vec<(f64, DVec3)>,
    /// How far the curve is from its chords at most.
    out: f64,
}

/// Chords between joints of a curve.
const CHORDS: u32 = 24;

impl Line {
    /// A curve of the language.
    #[must_use]
    pub fn new(curve: &AnyCurve) -> Self {
        let domain = curve.domain();
        let mut ends = vec![domain.start];
        ends.extend(curve.joints());
        ends.push(domain.end);
        let mut stops = vec![(domain.start, curve.point(domain.start))];
        let mut out: f64 = 0.0;
        // A curve of many joints has short pieces.
        let chords = (CHORDS * 4 / u32::try_from(ends.len()).unwrap_or(CHORDS)).clamp(1, CHORDS);
        for pair in ends.windows(2) {
            for k in 1..=chords {
                let share = f64::from(k) / f64::from(chords);
                let t = if k == chords { pair[1] } else { pair[0] + (pair[1] - pair[0]) * share };
                let before = stops[stops.len() - 1].0;
                out = out.max(curve.chord_deviation(before, t));
                stops.push((t, curve.evaluate(t, Side::Before).point));
            }
        }
        Self { curve: curve.clone(), stops, out }
    }

    fn nearest(&self, point: DVec3) -> DVec3 {
        let mut best = (f64::INFINITY, 0, 0.0);
        for (k, pair) in self.stops.windows(2).enumerate() {
            let share = share_of(pair[0].1, pair[1].1, point);
            let square = point.distance_squared(pair[0].1.lerp(pair[1].1, share));
            if square < best.0 {
                best = (square, k, share);
            }
        }
        let (mut found, mut place) = self.polished(point, best.1, best.2);
        // Beside its chord the curve may be nearer to a neighbor.
        for k in [best.1.checked_sub(1), Some(best.1 + 1)].into_iter().flatten() {
            if k + 1 < self.stops.len() && self.out > 0.0 {
                let (square, other) = self.polished(point, k, if k < best.1 { 1.0 } else { 0.0 });
                if square < found {
                    (found, place) = (square, other);
                }
            }
        }
        place
    }

    /// The nearest point of one piece, from a share of its chord.
    fn polished(&self, point: DVec3, piece: usize, share: f64) -> (f64, DVec3) {
        let ((low, a), (high, b)) = (self.stops[piece], self.stops[piece + 1]);
        if self.out == 0.0 {
            let place = a.lerp(b, share);
            return (place.distance_squared(point), place);
        }
        let mut t = low + (high - low) * share;
        let at = |t: f64| self.curve.evaluate(t, if t >= high { Side::Before } else { Side::After });
        let mut jet = at(t);
        for _ in 0..12 {
            let away = jet.point - point;
            let slope = away.dot(jet.first);
            let bend = jet.first.length_squared() + away.dot(jet.second);
            let bend = if bend > 0.0 { bend } else { jet.first.length_squared() };
            let next = (t - slope / bend).clamp(low, high);
            if !(next - t).is_normal() || (next - t).abs() <= 1e-15 * (high - low) {
                break;
            }
            t = next;
            jet = at(t);
        }
        (jet.point.distance_squared(point), jet.point)
    }
}

/// Where on a segment the nearest point lies, from 0 to 1.
fn share_of(a: DVec3, b: DVec3, point: DVec3) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    if square > 0.0 { ((point - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

impl Form {
    /// The way from the nearest point of the element to a point.
    pub(super) fn away(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Point(center) => point - *center,
            Self::Segment(a, b) => point - a.lerp(*b, share_of(*a, *b, point)),
            Self::Triangles(all) => {
                let ways = all.iter().map(|corners| point - nearest_of_triangle(*corners, point));
                ways.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                    .unwrap_or(DVec3::INFINITY)
            }
            Self::Curves(lines) => {
                let ways = lines.iter().map(|line| point - line.nearest(point));
                ways.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                    .unwrap_or(DVec3::INFINITY)
            }
        }
    }

    /// A box that holds the ways of all points within `radius` of `center`.
    pub(super) fn ways(&self, center: DVec3, radius: f64) -> Bounds {
        let around = |way: DVec3| Bounds { min: way - radius, max: way + radius };
        let convex = self.pieces() == 1;
        let own = self.away(center);
        if convex {
            return around(own);
        }
        let reach = own.length() + 2.0 * radius;
        let out = if let Self::Curves(lines) = self {
            lines.iter().map(|line| line.out).fold(0.0, f64::max)
        } else {
            0.0
        };
        let mut all = around(own);
        for way in self.piece_ways(center) {
            if way.length() - out <= reach {
                let wide = around(way);
                all = all.union(Bounds { min: wide.min - 2.0 * out, max: wide.max + 2.0 * out });
            }
        }
        all
    }

    /// Whether the way to its nearest place never jumps.
    pub(super) fn is_convex(&self) -> bool {
        self.pieces() == 1
    }

    fn pieces(&self) -> usize {
        match self {
            Self::Point(_) | Self::Segment(..) => 1,
            Self::Triangles(all) => all.len(),
            Self::Curves(lines) => lines.iter().map(|line| line.stops.len() - 1).sum(),
        }
    }

    /// The ways from all pieces; of a curve from its chords.
    fn piece_ways(&self, point: DVec3) -> Vec<DVec3> {
        match self {
            Self::Point(_) | Self::Segment(..) => vec![self.away(point)],
            Self::Triangles(all) => {
                all.iter().map(|corners| point - nearest_of_triangle(*corners, point)).collect()
            }
            Self::Curves(lines) => lines
                .iter()
                .flat_map(|line| line.stops.windows(2))
                .map(|pair| point - pair[0].1.lerp(pair[1].1, share_of(pair[0].1, pair[1].1, point)))
                .collect(),
        }
    }

    /// A box around the element.
    pub(super) fn bounds(&self) -> Bounds {
        match self {
            Self::Point(center) => Bounds { min: *center, max: *center },
            Self::Segment(a, b) => Bounds::of_points([*a, *b]),
            Self::Triangles(all) => Bounds::of_points(all.iter().flatten().copied()),
            Self::Curves(lines) => {
                let of_line = |line: &Line| {
                    let chords = Bounds::of_points(line.stops.iter().map(|stop| stop.1));
                    Bounds { min: chords.min - line.out, max: chords.max + line.out }
                };
                lines.iter().map(of_line).fold(Bounds::EMPTY, Bounds::union)
            }
        }
    }
}
