//! Closed curves that begin somewhere else.

use glam::DVec3;

use super::pieces::turns;
use super::{AnyCurve, Curve, Domain, Jet, Side};
use crate::geometry::number::Bounds;

/// A closed curve run through once from another of its points; the domain stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Restarted {
    curve: Box<AnyCurve>,
    /// Where it begins, in the curve's own parameter.
    start: f64,
    /// Where the curve itself begins and ends, in the new parameter.
    seam: f64,
    /// Joints in the new parameter and in the curve's own, which must be met exactly; the seam among them where
    /// the curve has a corner there.
    joints: Vec<(f64, f64)>,
    /// The same of its breaks; the seam is always one.
    breaks: Vec<(f64, f64)>,
}

impl Restarted {
    /// `curve` from `start` on, a parameter strictly inside its domain; `None` for an open curve.
    #[must_use]
    pub fn new(curve: AnyCurve, start: f64) -> Option<Self> {
        let domain = curve.domain();
        if !curve.is_closed() || start <= domain.start || start >= domain.end {
            return None;
        }
        let seam = domain.start + (domain.end - start);
        let moved = |t: f64| if t > start { domain.start + (t - start) } else { seam + (t - domain.start) };
        let place = |list: Vec<f64>, with_seam: bool| {
            let mut all: Vec<(f64, f64)> =
                list.into_iter().filter(|t| *t != start).map(|t| (moved(t), t)).collect();
            if with_seam {
                all.push((seam, domain.end));
            }
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all
        };
        let corner =
            turns(curve.direction(domain.end, Side::Before), curve.direction(domain.start, Side::After));
        let (joints, breaks) = (place(curve.joints(), corner), place(curve.breaks(), true));
        Some(Self { curve: Box::new(curve), start, seam, joints, breaks })
    }

    fn own(&self, u: f64, side: Side) -> f64 {
        let domain = self.curve.domain();
        if u == self.seam {
            return if side == Side::Before { domain.end } else { domain.start };
        }
        let near = self.breaks.partition_point(|(place, _)| *place < u);
        if let Some((_, t)) = self.breaks.get(near).filter(|(place, _)| *place == u) {
            return *t;
        }
        if u <= domain.start || u >= domain.end {
            return self.start;
        }
        if u < self.seam {
            (self.start + (u - domain.start)).min(domain.end)
        } else {
            (domain.start + (u - self.seam)).min(self.start)
        }
    }

    /// The two parts of a range, in the curve's own parameter.
    fn parts(&self, from: f64, to: f64) -> Vec<(f64, f64)> {
        if to <= self.seam || from >= self.seam {
            return vec![(self.own(from, Side::After), self.own(to, Side::Before))];
        }
        let domain = self.curve.domain();
        vec![(self.own(from, Side::After), domain.end), (domain.start, self.own(to, Side::Before))]
    }
}

impl Curve for Restarted {
    fn domain(&self) -> Domain {
        self.curve.domain()
    }

    fn is_closed(&self) -> bool {
        true
    }

    fn evaluate(&self, u: f64, side: Side) -> Jet {
        self.curve.evaluate(self.own(u, side), side)
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.iter().map(|(u, _)| *u).collect()
    }

    fn breaks(&self) -> Vec<f64> {
        self.breaks.iter().map(|(u, _)| *u).collect()
    }

    fn has_curvature(&self) -> bool {
        self.curve.has_curvature()
    }

    fn direction(&self, u: f64, side: Side) -> DVec3 {
        self.curve.direction(self.own(u, side), side)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let parts = self.parts(from, to);
        let [(a, b), (c, d)] = parts.as_slice() else {
            return self.curve.chord_deviation(parts[0].0, parts[0].1);
        };
        // Each part lies near its own chord, and both chords no further from the whole one than the seam.
        let seam = self.curve.evaluate(*b, Side::Before).point;
        let chord = (self.curve.point(*a), self.curve.evaluate(*d, Side::Before).point);
        let within = self.curve.chord_deviation(*a, *b).max(self.curve.chord_deviation(*c, *d));
        within + super::pieces::distance_to_segment(seam, chord)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let parts = self.parts(from, to);
        let ranges: Option<Vec<Bounds>> =
            parts.iter().map(|(from, to)| self.curve.second_range(*from, *to)).collect();
        Some(ranges?.into_iter().fold(Bounds::EMPTY, Bounds::union))
    }
}
