//! Parallels of closed curves: outlines moved outward or inward by a distance.
//!
//! Each smooth piece is moved along its normal; where corners open a gap it is filled, elsewhere the moved pieces cross,
//! and what then turns the wrong way around is cut off: X. Chen, S. `McMains`, Polygon offsetting by computing winding
//! numbers, ASME DETC 2005. Where a curve bends more sharply than it is moved, it is moved only to its centers of
//! curvature: beyond them another part of it is nearer. So the strips between the curve and where it is moved to never
//! turn over, and the windings of what they do not cover are right.

use core::f64::consts::SQRT_2;

use glam::{DVec2, DVec3};

use super::boolean::{extent, thinnest};
use super::chords::{Loop, reach};
use super::span::{Span, span};
use super::trace::Tracer;
use super::{CHORDS, ProfileError, ROUGH};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Curve as _, EllipseArc, Path, Polyline, Reversed, Side, Trimmed,
};
use crate::geometry::number::atan2;
use crate::geometry::planar::{SetOperation, Winding, encloses, overlay, twice_area};
use crate::geometry::tessellate::{Density, discretize};

/// What fills the gap that a corner opens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetCorner {
    /// An arc around the corner.
    Round,
    /// The sides, drawn on until they meet; where that is further from the corner than this many distances, a bevel.
    Miter(f64),
    /// A straight cut.
    Bevel,
}

/// Free curves are followed to this part of the size.
const FOLLOWED: f64 = 1e-9;

/// Pieces that are no longer than this part of the size are not halved.
const SHORT: f64 = 1e-7;

/// The outlines of what closed curves enclose, moved outward by `distance`, which is negative inward. The curves do not
/// cross each other; those inside an odd number of others are holes, and shrink where outlines grow.
///
/// # Errors
/// Where nothing is left, or where curves are too intricate.
pub fn offset(
    curves: &[AnyCurve],
    distance: f64,
    corner: OffsetCorner,
) -> Result<Vec<AnyCurve>, ProfileError> {
    let size = extent(curves.iter());
    let mover = Mover { distance, corner, size: size + 2.0 * distance.abs() };
    let mut loops = Vec::new();
    // Corners are rounded by arcs much smaller than the whole.
    let accuracy = (distance.abs() / 100.0).clamp(1e-6 * mover.size, ROUGH * mover.size);
    for curve in oriented(curves, ROUGH * size)? {
        if let Some(moved) = Path::closed(mover.around(&curve)) {
            loops.push(Loop::new(AnyCurve::Path(moved), accuracy)?);
        }
    }
    let places: Vec<_> = loops.iter().map(Loop::places).collect();
    let made = overlay(&places, &[], SetOperation::Union, Winding::Positive);
    let size = reach(&loops);
    Tracer { loops: &loops, size, thin: thinnest(&loops, size) }.trace(&made)
}

/// The curves, outlines counter-clockwise and holes clockwise.
fn oriented(curves: &[AnyCurve], accuracy: f64) -> Result<Vec<AnyCurve>, ProfileError> {
    let mut places: Vec<Vec<DVec2>> = Vec::new();
    for curve in curves {
        let stations = discretize(curve, Density::Tolerance(accuracy), CHORDS)?;
        places.push(stations.iter().map(|station| station.point.truncate()).collect());
    }
    let turned = |(k, curve): (usize, &AnyCurve)| {
        let around = (0..places.len()).filter(|j| *j != k && encloses(&places[*j], places[k][0])).count();
        let right = (twice_area(&places[k]) > 0.0) == (around % 2 == 0);
        if right { curve.clone() } else { AnyCurve::Reversed(Reversed::new(curve.clone())) }
    };
    Ok(curves.iter().enumerate().map(turned).collect())
}

struct Mover {
    distance: f64,
    corner: OffsetCorner,
    size: f64,
}

/// A part of the way around, or a place that it passes.
enum Step {
    Curve(AnyCurve),
    Place(DVec3),
}

impl Step {
    fn start(&self) -> DVec3 {
        match self {
            Self::Curve(curve) => curve.point(curve.domain().start),
            Self::Place(place) => *place,
        }
    }

    fn end(&self) -> DVec3 {
        match self {
            Self::Curve(curve) => curve.evaluate(curve.domain().end, Side::Before).point,
            Self::Place(place) => *place,
        }
    }
}

/// The direction to the right.
fn right(along: DVec3) -> DVec2 {
    DVec2::new(along.y, -along.x)
}

impl Mover {
    /// The moved pieces of a closed curve, joined end to end.
    fn around(&self, curve: &AnyCurve) -> Vec<AnyCurve> {
        let domain = curve.domain();
        let mut stops = vec![domain.start];
        stops.extend(curve.breaks());
        stops.push(domain.end);
        let mut steps = Vec::new();
        for (k, pair) in stops.windows(2).enumerate() {
            let Some(piece) = Trimmed::new(curve.clone(), pair[0], pair[1]) else { continue };
            steps.extend(self.piece(&AnyCurve::Trimmed(piece)));
            let next = if k + 2 == stops.len() { domain.start } else { pair[1] };
            let directions = [curve.direction(pair[1], Side::Before), curve.direction(next, Side::After)];
            steps.extend(self.join(curve.point(next).truncate(), directions));
        }
        self.linked(steps)
    }

    /// Curves with lines where the end of one is not the start of the next.
    fn linked(&self, steps: Vec<Step>) -> Vec<AnyCurve> {
        let mut linked = Vec::new();
        let Some(mut place) = steps.last().map(Step::end) else { return linked };
        for step in steps {
            if place.distance(step.start()) > 1e-11 * self.size {
                linked.extend(line(place, step.start()));
            }
            place = step.end();
            if let Step::Curve(curve) = step {
                linked.push(curve);
            }
        }
        linked
    }

    fn piece(&self, piece: &AnyCurve) -> Option<Step> {
        let domain = piece.domain();
        let moved = match span(piece) {
            Span::Line => {
                let along = piece.direction(domain.start, Side::After);
                let away = (right(along) * self.distance).extend(0.0);
                line(piece.point(domain.start) + away, piece.point(domain.end) + away)
            }
            Span::Arc { center, sweep } => {
                let spoke = piece.point(domain.start).truncate() - center;
                let moved = spoke.length() + self.distance * sweep.signum();
                if moved <= 1e-11 * self.size {
                    return Some(Step::Place(center.extend(0.0)));
                }
                Some(AnyCurve::Ellipse(arc(center, spoke * (moved / spoke.length()), sweep)))
            }
            Span::Free => self.free(piece),
        };
        moved.map(Step::Curve)
    }

    /// Cubic pieces with the places and directions of the parallel, halved until they follow it.
    fn free(&self, piece: &AnyCurve) -> Option<AnyCurve> {
        const HALVINGS: u32 = 14;
        const FIRST: u32 = 4;
        let domain = piece.domain();
        let at = |k: u32| domain.at(f64::from(k) / f64::from(FIRST));
        let mut knots = vec![domain.start];
        let mut points = vec![self.moved(piece, domain.start, Side::After).0];
        let mut waiting: Vec<(f64, f64, u32)> =
            (0..FIRST).rev().map(|k| (at(k), at(k + 1), HALVINGS)).collect();
        while let Some((from, to, halvings)) = waiting.pop() {
            let control = self.cubic(piece, from, to);
            let at = |share: f64| self.moved(piece, from + (to - from) * share, Side::After);
            let follows = [0.25, 0.5, 0.75]
                .into_iter()
                .all(|share| cubic_point(&control, share).distance(at(share).0) <= FOLLOWED * self.size);
            // Centers of curvature bound nothing in the end, so a rough way along them will do.
            let beyond = [0.0, 0.5, 1.0].into_iter().all(|share| at(share).1 == DVec3::ZERO);
            // Where the curve itself is rounding, so is what is moved.
            let short = control[0].distance(control[3]) <= SHORT * self.size;
            if follows || short || halvings == 0 || (beyond && halvings + 6 <= HALVINGS) {
                knots.push(to);
                points.extend(&control[1..]);
            } else {
                let middle = (from + to) / 2.0;
                waiting.push((middle, to, halvings - 1));
                waiting.push((from, middle, halvings - 1));
            }
        }
        BezierSpline::with_knots(3, points, knots).ok().map(AnyCurve::Bezier)
    }

    fn cubic(&self, piece: &AnyCurve, from: f64, to: f64) -> [DVec3; 4] {
        let third = (to - from) / 3.0;
        let (start, leaving) = self.moved(piece, from, Side::After);
        let (end, arriving) = self.moved(piece, to, Side::Before);
        [start, start + leaving * third, end - arriving * third, end]
    }

    /// Place and derivative of the parallel: the speed changes by the factor 1 + distance * curvature. Where that is
    /// not positive, the center of curvature, and no derivative.
    fn moved(&self, piece: &AnyCurve, t: f64, side: Side) -> (DVec3, DVec3) {
        let jet = piece.evaluate(t, side);
        let speed = jet.first.length();
        let normal = right(piece.direction(t, side)).extend(0.0);
        let bend = jet.first.truncate().perp_dot(jet.second.truncate());
        let curvature = if speed > 0.0 { bend / (speed * speed * speed) } else { 0.0 };
        let factor = 1.0 + self.distance * curvature;
        if factor <= 0.0 {
            return (jet.point - normal / curvature, DVec3::ZERO);
        }
        (jet.point + normal * self.distance, jet.first * factor)
    }

    /// What joins the moved pieces before and after a corner.
    fn join(&self, corner: DVec2, [before, after]: [DVec3; 2]) -> Vec<Step> {
        let (turn, ahead) = (before.truncate().perp_dot(after.truncate()), before.dot(after));
        if turn.abs() <= 1e-12 && ahead > 0.0 {
            return Vec::new();
        }
        let (first, last) = (right(before) * self.distance, right(after) * self.distance);
        let through = |places: &[DVec2]| -> Vec<Step> {
            let all: Vec<DVec2> = [&[corner + first], places, &[corner + last]].concat();
            all.into_iter().map(|place| Step::Place(place.extend(0.0))).collect()
        };
        let back = turn.abs() <= 1e-12;
        if !back && turn * self.distance < 0.0 {
            // The pieces cross; by way of the corner what they enclose turns backward.
            return through(&[corner]);
        }
        match self.corner {
            OffsetCorner::Round => {
                let sweep =
                    if back { 180.0_f64.copysign(self.distance) } else { atan2(turn, ahead).to_degrees() };
                vec![Step::Curve(AnyCurve::Ellipse(arc(corner, first, sweep)))]
            }
            // The tip is 1 / cos(half the turn) distances away.
            OffsetCorner::Miter(limit) if !back && SQRT_2 / (1.0 + ahead).sqrt() <= limit => {
                through(&[corner + (first + last) / (1.0 + ahead)])
            }
            OffsetCorner::Miter(_) | OffsetCorner::Bevel => through(&[]),
        }
    }
}

fn line(from: DVec3, to: DVec3) -> Option<AnyCurve> {
    Polyline::new(vec![from, to], false).map(AnyCurve::Polyline)
}

/// An arc of a circle from the end of a spoke.
fn arc(center: DVec2, spoke: DVec2, sweep: f64) -> EllipseArc {
    let (x, y) = (spoke.extend(0.0), spoke.perp().extend(0.0));
    EllipseArc { center: center.extend(0.0), x, y, from: 0.0, to: sweep }
}

fn cubic_point(control: &[DVec3; 4], share: f64) -> DVec3 {
    let rest = 1.0 - share;
    control[0] * (rest * rest * rest)
        + control[1] * (3.0 * rest * rest * share)
        + control[2] * (3.0 * rest * share * share)
        + control[3] * (share * share * share)
}
