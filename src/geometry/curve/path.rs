//! A curve made of curves, end to start.

use glam::DVec3;

use super::{AnyCurve, Continuity, Curve, Domain, Jet, Meeting, Polyline, Side};
use crate::geometry::number::{Bounds, floor_index};

/// Curves end to start; curve k covers parameters k to k + 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    curves: Vec<AnyCurve>,
    closed: bool,
    joints: Vec<Corner>,
}

/// A place where the direction jumps, in the parameter of the path and in that of its curve. Both are kept:
/// the way from one to the other rounds, and a joint must be met exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    t: f64,
    curve: usize,
    /// `None` between two curves.
    inner: Option<f64>,
}

impl Path {
    /// A path of at least one curve whose ends meet; `None` for no curve.
    #[must_use]
    pub fn new(curves: Vec<AnyCurve>) -> Option<Self> {
        let start = curves.first()?.evaluate(curves[0].domain().start, Side::After).point;
        let last = curves.last()?;
        let end = last.evaluate(last.domain().end, Side::Before).point;
        let closed = start == end;
        let mut path = Self { curves, closed, joints: Vec::new() };
        path.joints = path.find_joints();
        Some(path)
    }

    /// A path of at least one curve that is closed: by a line where its end is not its start. A gap of rounding
    /// alone stays; the end of the path is then its start all the same. `None` for no curve.
    #[must_use]
    pub fn closed(mut curves: Vec<AnyCurve>) -> Option<Self> {
        /// Of the way around: sums of relative steps round by far less.
        const ROUNDING: f64 = 1e-10;
        let end = |curve: &AnyCurve| curve.evaluate(curve.domain().end, Side::Before).point;
        let start = curves.first()?.evaluate(curves[0].domain().start, Side::After).point;
        let last = end(curves.last()?);
        let size = curves.iter().map(|curve| end(curve).distance(start)).fold(0.0, f64::max);
        if last.distance(start) > ROUNDING * size {
            curves.extend(Polyline::new(vec![last, start], false).map(AnyCurve::Polyline));
        }
        Self::new(curves).map(|path| Self { closed: true, ..path })
    }

    fn find_joints(&self) -> Vec<Corner> {
        let mut joints = Vec::new();
        for (index, curve) in self.curves.iter().enumerate() {
            let domain = curve.domain();
            if index > 0 && !self.meeting(index).holds(Continuity::G1) {
                joints.push(Corner { t: index as f64, curve: index, inner: None });
            }
            joints.extend(curve.joints().into_iter().map(|inner| Corner {
                t: index as f64 + (inner - domain.start) / domain.span(),
                curve: index,
                inner: Some(inner),
            }));
        }
        joints
    }

    /// The curves it is made of.
    #[must_use]
    pub fn curves(&self) -> &[AnyCurve] {
        &self.curves
    }

    /// How the curve before joint `k` (1 to count - 1) meets the one after. At 0 the seam of a closed path.
    #[must_use]
    pub fn meeting(&self, joint: usize) -> Meeting {
        let count = self.curves.len();
        let before = if joint == 0 { count } else { joint };
        let size = self.curves.iter().map(|curve| {
            let domain = curve.domain();
            curve.point(domain.start).distance(curve.evaluate(domain.end, Side::Before).point)
        });
        Meeting::of(self, before as f64, joint as f64, size.fold(0.0, f64::max))
    }

    /// The curve of a parameter and its own parameter there.
    fn locate(&self, t: f64, side: Side) -> (usize, f64) {
        let last = self.curves.len() - 1;
        let t = t.clamp(0.0, (last + 1) as f64);
        let near = self.joints.partition_point(|joint| joint.t < t);
        if let Some(Corner { curve, inner: Some(inner), .. }) =
            self.joints.get(near).filter(|joint| joint.t == t)
        {
            return (*curve, *inner);
        }
        let mut index = t.floor();
        if side == Side::Before && index == t && t > 0.0 {
            index -= 1.0;
        }
        let index = index.min(last as f64);
        let at = floor_index(index);
        (at, self.curves[at].domain().at(t - index))
    }
}

impl Curve for Path {
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: self.curves.len() as f64 }
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let (index, inner) = self.locate(t, side);
        let curve = &self.curves[index];
        let jet = curve.evaluate(inner, side);
        let rate = curve.domain().span();
        // A closed path ends where it starts, to the bit.
        let seam = self.closed && t >= self.curves.len() as f64 && self.curves.len() > 1;
        let point = if seam { self.curves[0].point(self.curves[0].domain().start) } else { jet.point };
        Jet { point, first: jet.first * rate, second: jet.second * (rate * rate) }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.t).collect()
    }

    fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.joints();
        for (index, curve) in self.curves.iter().enumerate() {
            let domain = curve.domain();
            breaks.extend((index > 0).then_some(index as f64));
            let place = |inner: f64| index as f64 + (inner - domain.start) / domain.span();
            breaks.extend(curve.breaks().into_iter().map(place));
        }
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        breaks
    }

    fn has_curvature(&self) -> bool {
        self.curves.iter().all(Curve::has_curvature)
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let (index, inner) = self.locate(t, side);
        self.curves[index].direction(inner, side)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let ((first, start), (last, end)) = (self.locate(from, Side::After), self.locate(to, Side::Before));
        let part = |index: usize, start: f64, end: f64| self.curves[index].chord_deviation(start, end);
        if first >= last {
            return part(first, start, end);
        }
        let chord = (self.point(from), self.evaluate(to, Side::Before).point);
        let mut deviation = 0.0_f64;
        let mut previous = 0.0;
        for index in first..=last {
            let curve = &self.curves[index];
            let start = if index == first { start } else { curve.domain().start };
            let end = if index == last { end } else { curve.domain().end };
            let reached = curve.evaluate(end, Side::Before).point;
            let distance = super::pieces::distance_to_segment(reached, chord);
            deviation = deviation.max(distance.max(previous) + part(index, start, end));
            previous = distance;
        }
        deviation
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let ((first, start), (last, end)) = (self.locate(from, Side::After), self.locate(to, Side::Before));
        let mut range = Bounds::EMPTY;
        for index in first..=last.max(first) {
            let curve = &self.curves[index];
            let domain = curve.domain();
            let start = if index == first { start } else { domain.start };
            let end = if index == last { end } else { domain.end };
            let part = curve.second_range(start, end)?;
            let rate = domain.span() * domain.span();
            range = range.union(Bounds { min: part.min * rate, max: part.max * rate });
        }
        Some(range)
    }
}
