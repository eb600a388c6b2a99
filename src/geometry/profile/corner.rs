//! Corners of flat curves, rounded by tangent arcs or cut off.

use glam::DVec2;

use crate::geometry::curve::{
    AnyCurve, Curve as _, EllipseArc, Path, Polyline, Side, Trimmed, length_between,
};
use crate::geometry::number::atan2;

/// What a corner becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerShape {
    /// An arc of this radius that is tangent to both sides.
    Round(f64),
    /// A straight cut between the two places that lie this far from the corner along its sides.
    Cut(f64),
}

impl CornerShape {
    fn measure(self) -> f64 {
        match self {
            Self::Round(radius) => radius,
            Self::Cut(distance) => distance,
        }
    }

    fn with(self, measure: f64) -> Self {
        match self {
            Self::Round(_) => Self::Round(measure),
            Self::Cut(_) => Self::Cut(measure),
        }
    }
}

/// A corner that has no room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerFault {
    /// Which corner, counted from 0.
    pub corner: usize,
    /// Where it is.
    pub place: DVec2,
    /// The largest measure for which there is room, the same at the corners beside it; 0 where there is none.
    pub largest: f64,
}

/// Where the direction of a flat curve jumps, in order; a closed one may have its first corner where it starts.
#[must_use]
pub fn corners(curve: &AnyCurve) -> Vec<DVec2> {
    Outline::new(curve).places.iter().map(|place| curve.point(*place).truncate()).collect()
}

/// The curve with the named corners changed; all of them where `chosen` is empty. Arcs are tangent to 1e-12 of the
/// size, and what is left of the sides is as it was.
///
/// # Errors
/// The first corner that has no room, and how much it has.
///
/// # Panics
/// When a chosen corner is not there.
pub fn cut_corners(
    curve: &AnyCurve,
    shape: CornerShape,
    chosen: &[usize],
) -> Result<Option<AnyCurve>, CornerFault> {
    let outline = Outline::new(curve);
    let mut wanted = vec![chosen.is_empty(); outline.places.len()];
    chosen.iter().for_each(|corner| wanted[*corner] = true);
    let work = Work { outline: &outline, wanted };
    if let Some(corner) = (0..outline.places.len()).find(|corner| !work.has_room(*corner, shape)) {
        let place = curve.point(outline.places[corner]).truncate();
        return Err(CornerFault { corner, place, largest: work.largest(corner, shape) });
    }
    Ok(work.assemble(shape))
}

/// A curve as sides between corners.
struct Outline {
    /// Smooth pieces. Side k ends in corner k of an open curve; of a closed one it begins in corner k.
    sides: Vec<AnyCurve>,
    /// Parameters of the corners.
    places: Vec<f64>,
    closed: bool,
    size: f64,
}

impl Outline {
    fn new(curve: &AnyCurve) -> Self {
        let (domain, closed) = (curve.domain(), curve.is_closed());
        let mut places: Vec<f64> =
            curve.joints().into_iter().filter(|t| turn(curve, *t, *t).abs() > STRAIGHT).collect();
        let seam = closed && turn(curve, domain.end, domain.start).abs() > STRAIGHT;
        if seam {
            places.insert(0, domain.start);
        }
        let part = |from: f64, to: f64| Trimmed::new(curve.clone(), from, to).map(AnyCurve::Trimmed);
        let mut stops = places.clone();
        if !seam {
            stops.insert(0, domain.start);
        }
        stops.push(domain.end);
        let mut sides: Vec<AnyCurve> = stops.windows(2).filter_map(|pair| part(pair[0], pair[1])).collect();
        // Without a corner at the seam the last side goes on in the first.
        if closed && !seam && sides.len() > 1 {
            let first = sides.remove(0);
            if let Some(last) = sides.pop() {
                sides.extend(Path::new(vec![last, first]).map(AnyCurve::Path));
            }
        }
        let size = super::boolean::extent(std::iter::once(curve));
        Self { sides, places, closed, size }
    }

    /// The sides before and after a corner.
    fn beside(&self, corner: usize) -> (usize, usize) {
        if self.closed {
            let count = self.sides.len();
            ((corner + count - 1) % count, corner)
        } else {
            (corner, corner + 1)
        }
    }
}

/// Degrees below which two directions are one.
const STRAIGHT: f64 = 1e-7;

/// Degrees by which the direction jumps, positive to the left.
fn turn(curve: &AnyCurve, before: f64, after: f64) -> f64 {
    let (before, after) = (curve.direction(before, Side::Before), curve.direction(after, Side::After));
    atan2(before.truncate().perp_dot(after.truncate()), before.dot(after)).to_degrees()
}

struct Work<'a> {
    outline: &'a Outline,
    wanted: Vec<bool>,
}

/// Where the sides of a corner end and begin.
#[derive(Clone, Copy)]
struct Room {
    before: f64,
    after: f64,
}

impl Work<'_> {
    /// Whether a corner can be changed, and its sides are long enough for their other ends too.
    fn has_room(&self, corner: usize, shape: CornerShape) -> bool {
        if !self.wanted[corner] {
            return true;
        }
        let (before, after) = self.outline.beside(corner);
        self.room(corner, shape).is_some()
            && [before, after]
                .into_iter()
                .all(|side| self.range(side, shape).is_some_and(|(from, to)| from <= to))
    }

    /// What is left of a side; `None` where a corner of it cannot be changed.
    fn range(&self, side: usize, shape: CornerShape) -> Option<(f64, f64)> {
        let domain = self.outline.sides[side].domain();
        let corners = self.outline.places.len();
        let (first, last) = if self.outline.closed {
            (Some(side), Some((side + 1) % corners.max(1)))
        } else {
            (side.checked_sub(1), Some(side).filter(|corner| *corner < corners))
        };
        let wanted = |corner: &usize| self.wanted.get(*corner).copied().unwrap_or(false);
        let from = match first.filter(wanted) {
            Some(corner) => self.room(corner, shape)?.after,
            None => domain.start,
        };
        let to = match last.filter(wanted) {
            Some(corner) => self.room(corner, shape)?.before,
            None => domain.end,
        };
        Some((from, to))
    }

    fn room(&self, corner: usize, shape: CornerShape) -> Option<Room> {
        let (before, after) = self.outline.beside(corner);
        let (before, after) = (&self.outline.sides[before], &self.outline.sides[after]);
        match shape {
            CornerShape::Round(radius) => self.tangent(before, after, radius),
            CornerShape::Cut(distance) => {
                Some(Room { before: along(before, distance, true)?, after: along(after, distance, false)? })
            }
        }
    }

    /// Newton's method on the crossing of the two parallels at a radius on the inner side.
    fn tangent(&self, before: &AnyCurve, after: &AnyCurve, radius: f64) -> Option<Room> {
        let (one, other) = (before.domain(), after.domain());
        let (arriving, leaving) =
            (before.direction(one.end, Side::Before), after.direction(other.start, Side::After));
        let (cross, dot) = (arriving.truncate().perp_dot(leaving.truncate()), arriving.dot(leaving));
        let reach = radius.copysign(cross);
        let back = radius * (cross.abs() / (1.0 + dot));
        let speed =
            |curve: &AnyCurve, t: f64| curve.evaluate(t, Side::Before).first.length().max(f64::MIN_POSITIVE);
        let mut s = (one.end - back / speed(before, one.end)).clamp(one.start, one.end);
        let mut t = (other.start + back / speed(after, other.start)).clamp(other.start, other.end);
        for _ in 0..60 {
            let (center, along, bends) = parallel(before, s, reach);
            let (target, across, bends_too) = parallel(after, t, reach);
            let gap = target - center;
            let turn = along.perp_dot(-across);
            let next = (s + gap.perp_dot(-across) / turn, t + along.perp_dot(gap) / turn);
            let next = (next.0.clamp(one.start, one.end), next.1.clamp(other.start, other.end));
            let settled = gap.length() <= 1e-14 * (self.outline.size + radius);
            if settled || next == (s, t) || turn == 0.0 {
                // What rounding leaves where coordinates are large. Where a side bends more sharply than the arc,
                // the arc would lie across it.
                let met = gap.length() <= 1e-11 * (self.outline.size + radius);
                return (met && bends && bends_too).then_some(Room { before: s, after: t });
            }
            (s, t) = next;
        }
        None
    }

    /// The largest measure for which a corner has room.
    fn largest(&self, corner: usize, shape: CornerShape) -> f64 {
        let (mut low, mut high) = (0.0, shape.measure());
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if self.has_room(corner, shape.with(middle)) { low = middle } else { high = middle }
        }
        low
    }

    fn assemble(&self, shape: CornerShape) -> Option<AnyCurve> {
        let outline = self.outline;
        let mut pieces = Vec::new();
        for (k, side) in outline.sides.iter().enumerate() {
            let (from, to) = self.range(k, shape)?;
            pieces.extend(Trimmed::new(side.clone(), from, to).map(AnyCurve::Trimmed));
            let corner = if outline.closed { (k + 1) % outline.sides.len() } else { k };
            if self.wanted.get(corner).copied().unwrap_or(false) {
                pieces.extend(self.bridge(corner, shape));
            }
        }
        let path = if outline.closed { Path::closed(pieces) } else { Path::new(pieces) };
        path.map(AnyCurve::Path)
    }

    /// What stands in the place of a corner.
    fn bridge(&self, corner: usize, shape: CornerShape) -> Option<AnyCurve> {
        let (before, after) = self.outline.beside(corner);
        let (before, after) = (&self.outline.sides[before], &self.outline.sides[after]);
        let room = self.room(corner, shape)?;
        let (from, to) = (before.point(room.before), after.point(room.after));
        let CornerShape::Round(radius) = shape else {
            return Polyline::new(vec![from, to], false).map(AnyCurve::Polyline);
        };
        let (arriving, leaving) =
            (before.direction(room.before, Side::Before), after.direction(room.after, Side::After));
        let cross = arriving.truncate().perp_dot(leaving.truncate());
        let sweep = atan2(cross, arriving.dot(leaving)).to_degrees();
        let center = from.truncate() + arriving.truncate().perp() * radius.copysign(sweep);
        let spoke = from.truncate() - center;
        let (x, y) = (spoke.extend(0.0), spoke.perp().extend(0.0));
        Some(AnyCurve::Ellipse(EllipseArc { center: center.extend(0.0), x, y, from: 0.0, to: sweep }))
    }
}

/// A place on the parallel to the left, its derivative, and whether it runs the way of the curve.
fn parallel(curve: &AnyCurve, t: f64, reach: f64) -> (DVec2, DVec2, bool) {
    let jet = curve.evaluate(t, Side::Before);
    let (point, first, second) = (jet.point.truncate(), jet.first.truncate(), jet.second.truncate());
    let speed = first.length().max(f64::MIN_POSITIVE);
    let factor = 1.0 - reach * first.perp_dot(second) / (speed * speed * speed);
    (point + first.perp() * (reach / speed), first * factor, factor >= 0.0)
}

/// The parameter at a distance along a side from one of its ends; `None` where the side is shorter.
fn along(side: &AnyCurve, distance: f64, from_end: bool) -> Option<f64> {
    let domain = side.domain();
    let length = |t: f64| {
        if from_end { length_between(side, t, domain.end) } else { length_between(side, domain.start, t) }
    };
    let (mut near, mut far) = if from_end { (domain.end, domain.start) } else { (domain.start, domain.end) };
    if length(far) < distance {
        return None;
    }
    for _ in 0..80 {
        let middle = (near + far) / 2.0;
        if length(middle) < distance { near = middle } else { far = middle }
    }
    Some(far)
}
