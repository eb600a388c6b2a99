//! Curves in a skeleton: the nearest place on a curve, and bounds on it over a ball.
//!
//! Promise: nearest places are exact to rounding: chords tell which pieces may hold them, Newton's method finds the
//! place on each. Bounds hold for every point of the ball, where nearest places jump from one part of the curve to
//! another too. They shrink with the ball, unless a center of curvature lies in it.
//!
//! Where the squared distance is convex along a part of the curve for all points x of a ball, with a second derivative
//! of at least m, the nearest place c on that part moves by |c'|²/m times the way of x at most (implicit function
//! theorem), and x - c by 1 or |c'|²/m - 1 times, whichever is more.

use core::ops::Range;

use glam::DVec3;

use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::number::Bounds;

use super::element::{Ways, share_of};

/// A curve and chords along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    curve: AnyCurve,
    pieces: Vec<Piece>,
    /// Boxes around so many pieces in a row.
    boxes: Vec<Bounds>,
}

/// A part of a curve with its chord.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    /// Parameters and places of its ends.
    ends: [(f64, DVec3); 2],
    /// From end to end, and that by the square of its length: 0 where there is none.
    along: DVec3,
    inverse: DVec3,
    /// How far it is from its chord at most; 0 where it is straight.
    out: f64,
    /// Squares of the least and the greatest speed.
    speeds: [f64; 2],
    /// A box that holds its second derivatives.
    second: Option<Bounds>,
    /// Whether it does not go on in the direction of the piece before.
    turns: bool,
}

/// Chords between joints of a curve.
const CHORDS: u32 = 24;
/// Pieces that share a box.
const GROUP: usize = 8;

impl Line {
    /// A curve of the language.
    #[must_use]
    pub fn new(curve: &AnyCurve) -> Self {
        let (domain, joints) = (curve.domain(), curve.joints());
        let mut stops = vec![domain.start];
        stops.extend(curve.breaks());
        stops.push(domain.end);
        // A curve of many joints has short pieces.
        let chords = (CHORDS * 4 / u32::try_from(stops.len()).unwrap_or(CHORDS)).clamp(1, CHORDS);
        let mut pieces = Vec::new();
        let mut from = (domain.start, curve.point(domain.start));
        for pair in stops.windows(2) {
            for k in 1..=chords {
                let share = f64::from(k) / f64::from(chords);
                let t = if k == chords { pair[1] } else { pair[0] + (pair[1] - pair[0]) * share };
                let to = (t, curve.evaluate(t, Side::Before).point);
                let turns = k == 1 && (pieces.is_empty() || joints.contains(&pair[0]));
                pieces.push(Piece::new(curve, [from, to], turns));
                from = to;
            }
        }
        let around = |group: &[Piece]| group.iter().map(Piece::bounds).fold(Bounds::EMPTY, Bounds::union);
        let boxes = pieces.chunks(GROUP).map(around).collect();
        Self { curve: curve.clone(), pieces, boxes }
    }

    /// Its nearest point to a place.
    pub(super) fn nearest(&self, point: DVec3) -> DVec3 {
        let apart =
            |group: usize| point.distance_squared(point.clamp(self.boxes[group].min, self.boxes[group].max));
        let groups = 0..self.boxes.len();
        let seed = groups
            .clone()
            .fold((0, f64::INFINITY), |best, k| if apart(k) < best.1 { (k, apart(k)) } else { best })
            .0;
        let (mut first, mut least) = (0, f64::INFINITY);
        for k in core::iter::once(seed).chain(groups.clone()) {
            if apart(k) >= least {
                continue;
            }
            for piece in self.group(k) {
                let square = self.pieces[piece].chord_square(point);
                if square < least {
                    (first, least) = (piece, square);
                }
            }
        }
        let mut best = self.nearest_of_piece(first, point);
        let mut least = best.distance_squared(point);
        for k in groups {
            if apart(k) >= least {
                continue;
            }
            for piece in self.group(k) {
                // Beside its chord another piece may be nearer.
                let Piece { out, .. } = self.pieces[piece];
                let reach = least.sqrt() + out;
                if piece != first && out > 0.0 && self.pieces[piece].chord_square(point) < reach * reach {
                    let other = self.nearest_of_piece(piece, point);
                    if other.distance_squared(point) < least {
                        (best, least) = (other, other.distance_squared(point));
                    }
                }
            }
        }
        best
    }

    fn group(&self, k: usize) -> Range<usize> {
        k * GROUP..self.pieces.len().min((k + 1) * GROUP)
    }

    /// The nearest point of one piece.
    fn nearest_of_piece(&self, piece: usize, point: DVec3) -> DVec3 {
        let Piece { ends: [(low, a), (high, b)], out, .. } = self.pieces[piece];
        let share = share_of(a, b, point);
        if out == 0.0 {
            return a.lerp(b, share);
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
        jet.point
    }

    /// Adds the ways from nearest places to points within `radius` of `center`, of all parts of the curve that are not
    /// further than `reach` from the center, to a box.
    pub(super) fn add_ways(&self, (center, radius): (DVec3, f64), reach: f64, all: &mut Ways) {
        let mut start = 0;
        while start < self.pieces.len() {
            let near =
                |piece: &Piece| piece.chord_square(center) <= (reach + piece.out) * (reach + piece.out);
            let Some(first) = self.pieces[start..].iter().position(near).map(|k| start + k) else { return };
            let mut end = first + 1;
            while self.pieces.get(end).is_some_and(|piece| near(piece) && !piece.turns) {
                end += 1;
            }
            all.add(self.ways_of(first..end, center, radius));
            start = end;
        }
    }

    /// The ways of connected pieces.
    fn ways_of(&self, run: Range<usize>, center: DVec3, radius: f64) -> Ways {
        let pieces = &self.pieces[run.clone()];
        let around = |piece: &Piece| {
            let own = piece.bounds();
            Bounds { min: center - radius - own.max, max: center + radius - own.min }
        };
        let mut wander: f64 = 1.0;
        for piece in pieces {
            let bend = piece.least_bend(&around(piece));
            if bend <= 0.0 {
                let within = pieces.iter().map(around).fold(Bounds::EMPTY, Bounds::union);
                return Ways { within, smooth: false };
            }
            wander = wander.max(piece.speeds[1] / bend - 1.0);
        }
        let way = |piece: usize| center - self.nearest_of_piece(piece, center);
        let ways = run.map(way);
        let own =
            ways.fold(
                DVec3::INFINITY,
                |best, way| {
                    if way.length_squared() < best.length_squared() { way } else { best }
                },
            );
        let within = Bounds { min: own - radius * wander, max: own + radius * wander };
        Ways { within, smooth: true }
    }

    /// Whether it is one segment.
    pub(super) fn is_straight(&self) -> bool {
        self.pieces.len() == 1 && self.pieces[0].out == 0.0
    }

    /// A box around it.
    pub(super) fn bounds(&self) -> Bounds {
        self.pieces.iter().map(Piece::bounds).fold(Bounds::EMPTY, Bounds::union)
    }
}

impl Piece {
    fn new(curve: &AnyCurve, ends: [(f64, DVec3); 2], turns: bool) -> Self {
        let (from, to) = (ends[0].0, ends[1].0);
        let out = curve.chord_deviation(from, to);
        let square = |low: DVec3, high: DVec3| {
            let least = DVec3::ZERO.clamp(low, high);
            let most = low.abs().max(high.abs());
            [least.length_squared(), most.length_squared()]
        };
        let speeds =
            curve.first_range(from, to).map_or([0.0, f64::INFINITY], |box_| square(box_.min, box_.max));
        let along = ends[1].1 - ends[0].1;
        let square = along.length_squared();
        let inverse = if square > 0.0 { along / square } else { DVec3::ZERO };
        Self { ends, along, inverse, out, speeds, second: curve.second_range(from, to), turns }
    }

    fn chord_square(&self, point: DVec3) -> f64 {
        let away = point - self.ends[0].1;
        away.distance_squared(self.along * away.dot(self.inverse).clamp(0.0, 1.0))
    }

    fn bounds(&self) -> Bounds {
        let chord = Bounds::of_points(self.ends.map(|end| end.1));
        Bounds { min: chord.min - self.out, max: chord.max + self.out }
    }

    /// The least second derivative of half the squared distance along the piece, of places with ways in a box.
    fn least_bend(&self, ways: &Bounds) -> f64 {
        if self.out == 0.0 {
            // However quickly it runs along its chord, what counts is the chord.
            return self.speeds[1];
        }
        let Some(second) = self.second else { return 0.0 };
        let (low, high) = (ways.min * second.min, ways.max * second.max);
        let (one, other) = (ways.min * second.max, ways.max * second.min);
        let most = low.max(high).max(one.max(other));
        self.speeds[0] - (most.x + most.y + most.z)
    }
}
