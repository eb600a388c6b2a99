//! Which point of one curve goes with which of the next, for surfaces through several curves.

use glam::DVec3;
use thiserror::Error;

use super::ruled::with_joints_of;
use crate::geometry::curve::{AnyCurve, Curve, Restarted, Retimed, Reversed, Side, jumps, length_between};
use crate::geometry::number::atan2;

/// By what the points of curves are paired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matching {
    /// By corners where all curves have as many, else by length.
    Auto,
    /// Corner by corner, and between two corners by length.
    Corners,
    /// By the share of the length.
    Length,
    /// By the share of the parameters.
    Parameter,
}

/// Curves that cannot be paired.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MatchError {
    /// Some curve has more corners than another.
    #[error("curve {curve} has {corners} corners and the first has {first}")]
    Corners {
        /// The curve, counted from 0.
        curve: usize,
        /// Its corners.
        corners: usize,
        /// Corners of the first.
        first: usize,
    },
}

/// A turn by less than this many degrees is no corner.
const CORNER: f64 = 1.0;

/// Places at which curves are compared: divisible by the corners of most outlines.
const PLACES: u32 = 96;

/// Curves over 0 to 1 whose points of equal parameter belong together. All are open or all closed. With `align`
/// each curve after the first begins where, and runs in the sense in which, it lies closest to the one before,
/// both seen from their middles.
///
/// # Errors
/// When corners are to be paired and their numbers differ.
pub fn matched(curves: Vec<AnyCurve>, matching: Matching, align: bool) -> Result<Vec<AnyCurve>, MatchError> {
    let counts: Vec<usize> = curves.iter().map(|curve| corners(curve).len()).collect();
    let same = counts.iter().all(|count| *count == counts[0]);
    let matching = match matching {
        Matching::Auto if same && counts[0] > 0 => Matching::Corners,
        Matching::Auto => Matching::Length,
        other => other,
    };
    if matching == Matching::Corners && !same {
        let curve = counts.iter().position(|count| *count != counts[0]).unwrap_or(0);
        return Err(MatchError::Corners { curve, corners: counts[curve], first: counts[0] });
    }
    let mut aligned: Vec<AnyCurve> = Vec::with_capacity(curves.len());
    for curve in curves {
        let curve = match aligned.last() {
            Some(before) if align => closest(before, curve, matching),
            _ if matching == Matching::Corners && counts[0] > 0 => at_a_corner(curve),
            _ => curve,
        };
        aligned.push(curve);
    }
    Ok(with_common_joints(paired(aligned, matching)))
}

/// Gives all curves their common parameter.
fn paired(curves: Vec<AnyCurve>, matching: Matching) -> Vec<AnyCurve> {
    if matching == Matching::Parameter {
        return curves.into_iter().map(Retimed::unit).collect();
    }
    let ends = |curve: &AnyCurve| (curve.domain().start, curve.domain().end);
    let inner: Vec<Vec<f64>> = curves
        .iter()
        .map(|curve| if matching == Matching::Corners { inner_corners(curve) } else { Vec::new() })
        .collect();
    let common = average_shares(&curves, &inner);
    let timed = |(curve, inner): (AnyCurve, &Vec<f64>)| {
        let (start, end) = ends(&curve);
        let mut stops = vec![(0.0, start)];
        stops.extend(common.iter().copied().zip(inner.iter().copied()));
        stops.push((1.0, end));
        match Retimed::by_length(curve.clone(), &stops) {
            Some(retimed) => AnyCurve::Retimed(retimed),
            None => Retimed::unit(curve),
        }
    };
    curves.into_iter().zip(&inner).map(timed).collect()
}

/// Lets joints that differ by rounding alone be one line of the surface.
fn with_common_joints(curves: Vec<AnyCurve>) -> Vec<AnyCurve> {
    let mut joints: Vec<f64> = Vec::new();
    let joined = |curve: AnyCurve| {
        let curve = with_joints_of(curve, &joints);
        joints.extend(jumps(&curve));
        curve
    };
    curves.into_iter().map(joined).collect()
}

/// For each corner the share of the length at which it stands, on the average of all curves.
fn average_shares(curves: &[AnyCurve], inner: &[Vec<f64>]) -> Vec<f64> {
    let mut sums = vec![0.0; inner[0].len()];
    for (curve, inner) in curves.iter().zip(inner) {
        let domain = curve.domain();
        let mut stops = vec![domain.start];
        stops.extend(inner);
        stops.push(domain.end);
        let lengths: Vec<f64> = stops.windows(2).map(|pair| whole_length(curve, pair[0], pair[1])).collect();
        let whole: f64 = lengths.iter().sum();
        let mut reached = 0.0;
        for (sum, length) in sums.iter_mut().zip(&lengths) {
            reached += length;
            *sum += reached / whole;
        }
    }
    sums.iter().map(|sum| sum / curves.len() as f64).collect()
}

fn whole_length(curve: &AnyCurve, from: f64, to: f64) -> f64 {
    let mut stops = vec![from];
    stops.extend(curve.breaks().into_iter().filter(|t| *t > from && *t < to));
    stops.push(to);
    stops.windows(2).map(|pair| length_between(curve, pair[0], pair[1])).sum()
}

/// Corners inside the domain.
fn inner_corners(curve: &AnyCurve) -> Vec<f64> {
    jumps(curve).into_iter().filter(|t| turn(curve, *t, *t) > CORNER).collect()
}

/// Corners, the seam of a closed curve (as its start) among them.
fn corners(curve: &AnyCurve) -> Vec<f64> {
    let domain = curve.domain();
    let mut all = inner_corners(curve);
    if curve.is_closed() && turn(curve, domain.end, domain.start) > CORNER {
        all.insert(0, domain.start);
    }
    all
}

/// Degrees by which the direction jumps between the end of one part and the start of the next.
fn turn(curve: &AnyCurve, end: f64, start: f64) -> f64 {
    let (before, after) = (curve.direction(end, Side::Before), curve.direction(start, Side::After));
    atan2(before.cross(after).length(), before.dot(after)).to_degrees()
}

/// A closed curve that begins at a corner, if it has one.
fn at_a_corner(curve: AnyCurve) -> AnyCurve {
    let corners = corners(&curve);
    match corners.first() {
        Some(first) if curve.is_closed() && *first > curve.domain().start => restarted(&curve, *first),
        _ => curve,
    }
}

fn restarted(curve: &AnyCurve, start: f64) -> AnyCurve {
    Restarted::new(curve.clone(), start).map_or_else(|| curve.clone(), AnyCurve::Restarted)
}

/// The curve begun and turned so that it lies closest to the one before.
fn closest(before: &AnyCurve, curve: AnyCurve, matching: Matching) -> AnyCurve {
    let backward = AnyCurve::Reversed(Reversed::new(curve.clone()));
    let target = Places::new(before, matching);
    let mut best: Option<(f64, AnyCurve)> = None;
    for candidate in [curve, backward] {
        for (cost, start) in starts(&target, &candidate, matching) {
            // As it was written unless another is better by more than rounding.
            if best.as_ref().is_none_or(|(least, _)| cost < least - 1e-9 * target.size) {
                let begun = start.map_or_else(|| candidate.clone(), |start| restarted(&candidate, start));
                best = Some((cost, begun));
            }
        }
    }
    best.map_or_else(|| before.clone(), |(_, curve)| curve)
}

/// Costs of the ways in which a curve may begin; `None` is where it does.
fn starts(target: &Places, curve: &AnyCurve, matching: Matching) -> Vec<(f64, Option<f64>)> {
    let corners = corners(curve);
    let start = curve.domain().start;
    let own = |t: f64| if t == start { None } else { Some(t) };
    if !curve.is_closed() {
        return vec![(target.cost(&Places::new(curve, matching), 0), None)];
    }
    if matching == Matching::Corners && !corners.is_empty() {
        let begun = |t: &f64| own(*t).map_or_else(|| curve.clone(), |t| restarted(curve, t));
        return corners
            .iter()
            .map(|t| (target.cost(&Places::new(&begun(t), matching), 0), own(*t)))
            .collect();
    }
    let places = Places::new(curve, matching);
    (0..places.points.len())
        .map(|shift| (target.cost(&places, shift), own(places.parameters[shift])))
        .collect()
}

/// Points of a curve, as many for all curves, from their middle.
struct Places {
    points: Vec<DVec3>,
    parameters: Vec<f64>,
    size: f64,
}

impl Places {
    fn new(curve: &AnyCurve, matching: Matching) -> Self {
        let domain = curve.domain();
        let parameters = match matching {
            Matching::Parameter => (0..PLACES).map(|k| domain.at(f64::from(k) / f64::from(PLACES))).collect(),
            Matching::Corners if !inner_corners(curve).is_empty() => {
                let mut stops = vec![domain.start];
                stops.extend(inner_corners(curve));
                stops.push(domain.end);
                stops.windows(2).flat_map(|pair| by_length(curve, pair[0], pair[1], 4)).collect()
            }
            _ => by_length(curve, domain.start, domain.end, PLACES),
        };
        let points: Vec<DVec3> = parameters.iter().map(|t| curve.point(*t)).collect();
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let points: Vec<DVec3> = points.into_iter().map(|point| point - middle).collect();
        let size = points.iter().map(|point| point.length_squared()).sum();
        Self { points, parameters, size }
    }

    /// The sum of squares of distances to another curve begun `shift` places further on.
    fn cost(&self, other: &Self, shift: usize) -> f64 {
        let count = other.points.len();
        let pairs = self.points.iter().zip((0..count).map(|k| other.points[(k + shift) % count]));
        pairs.map(|(a, b)| a.distance_squared(b)).sum()
    }
}

/// Parameters at even lengths, the last left out.
fn by_length(curve: &AnyCurve, from: f64, to: f64, count: u32) -> Vec<f64> {
    const FINE: u32 = 8;
    let steps = count * FINE;
    let at = |k: u32| if k == steps { to } else { from + (to - from) * (f64::from(k) / f64::from(steps)) };
    let mut lengths = vec![0.0];
    for k in 0..steps {
        let step = curve.point(at(k)).distance(curve.evaluate(at(k + 1), Side::Before).point);
        lengths.push(lengths[lengths.len() - 1] + step);
    }
    let whole = lengths[lengths.len() - 1];
    (0..count)
        .map(|k| {
            let wanted = whole * (f64::from(k) / f64::from(count));
            let next = lengths.partition_point(|length| *length <= wanted).clamp(1, lengths.len() - 1);
            let part =
                (wanted - lengths[next - 1]) / (lengths[next] - lengths[next - 1]).max(f64::MIN_POSITIVE);
            let step = (to - from) / f64::from(steps);
            if k == 0 { from } else { from + step * ((next - 1) as f64 + part) }
        })
        .collect()
}
