//! Turns about the path that are added to the frames of a rule.
//!
//! Beside a corner the section goes on straight to the bisecting plane, so there it must not turn: each piece
//! turns between the lengths that the section reaches beyond its corners.

use super::transport::Transport;
use crate::geometry::curve::{AnyCurve, Curve, Side};
use crate::geometry::number::{acos, tan};

/// The turn over one smooth piece: it holds, grows evenly with the length, and holds again.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// Parameters between which it grows.
    t: (f64, f64),
    /// Lengths of the path there, metres.
    walked: (f64, f64),
    /// Radians before and after.
    angle: (f64, f64),
}

/// The turns of all smooth pieces; empty where nothing is turned.
#[derive(Clone, Debug, Default)]
pub(super) struct Turns(Vec<Turn>);

/// At least this share of a piece turns, however far the section reaches beyond its corners.
const LEAST: f64 = 0.2;

impl Turns {
    /// Turns by the angles at the ends of each piece, radians, of a section that reaches so far from its path.
    pub(super) fn new(path: &AnyCurve, transport: &Transport, angles: &[(f64, f64)], reach: f64) -> Self {
        if angles.iter().all(|(start, end)| *start == 0.0 && *end == 0.0) {
            return Self::default();
        }
        let domain = path.domain();
        let mut corners = vec![if path.is_closed() { mitre(path, domain.end, domain.start) } else { 0.0 }];
        corners.extend(path.joints().into_iter().map(|t| mitre(path, t, t)));
        corners.push(corners[0]);
        let turn = |(index, stops): (usize, &[super::transport::Stop])| {
            let (first, last) = (&stops[0], &stops[stops.len() - 1]);
            let length = last.walked - first.walked;
            // A hair more, so that a row at the end of the hold stands clear of the mitre.
            let hold = (corners[index] * reach * 1.001, corners[index + 1] * reach * 1.001);
            let share = ((1.0 - LEAST) * length / (hold.0 + hold.1)).min(1.0);
            let walked = (first.walked + hold.0 * share, last.walked - hold.1 * share);
            let at = |held: f64, end: f64, walked: f64| {
                if held == 0.0 { end } else { transport.parameter(path, walked) }
            };
            let t = (at(hold.0, first.t, walked.0), at(hold.1, last.t, walked.1));
            Turn { t, walked, angle: angles[index] }
        };
        Self(transport.pieces().enumerate().map(turn).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Radians at a place of a piece.
    pub(super) fn angle(&self, piece: usize, t: f64, walked: impl FnOnce() -> f64) -> f64 {
        let Some(turn) = self.0.get(piece) else { return 0.0 };
        if t <= turn.t.0 {
            turn.angle.0
        } else if t >= turn.t.1 {
            turn.angle.1
        } else {
            let share = (walked() - turn.walked.0) / (turn.walked.1 - turn.walked.0);
            turn.angle.0 + (turn.angle.1 - turn.angle.0) * share
        }
    }

    /// Radians for each metre at a place of a piece.
    pub(super) fn rate(&self, piece: usize, t: f64, side: Side) -> f64 {
        let Some(turn) = self.0.get(piece) else { return 0.0 };
        let inside = match side {
            Side::After => t >= turn.t.0 && t < turn.t.1,
            Side::Before => t > turn.t.0 && t <= turn.t.1,
        };
        let rate = (turn.angle.1 - turn.angle.0) / (turn.walked.1 - turn.walked.0);
        if inside && rate.is_finite() { rate } else { 0.0 }
    }

    /// Where inside a piece a turn begins or ends: the surface has an edge there.
    pub(super) fn joints<'a>(&'a self, transport: &'a Transport) -> impl Iterator<Item = f64> + 'a {
        self.0.iter().zip(transport.pieces()).flat_map(|(turn, stops)| {
            let ends = (stops[0].t, stops[stops.len() - 1].t);
            let turns = turn.angle.0 != turn.angle.1;
            [turn.t.0, turn.t.1].into_iter().filter(move |t| turns && *t > ends.0 && *t < ends.1)
        })
    }
}

/// How far the mitre of a corner reaches along the path, for each metre that a section reaches to its side.
fn mitre(path: &AnyCurve, before: f64, after: f64) -> f64 {
    let (one, other) = (path.direction(before, Side::Before), path.direction(after, Side::After));
    let cosine = one.dot(other).clamp(-1.0, 1.0);
    // Smooth seams leave rounding.
    if cosine > 1.0 - 1e-12 { 0.0 } else { tan(acos(cosine) / 2.0) }
}
