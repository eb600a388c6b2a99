//! Curves put head to tail around a patch, and one closed curve cut into its sides.

use thiserror::Error;

use super::rail::Rail;
use crate::geometry::curve::{AnyCurve, Curve, Reversed, Side, length_between};
use crate::geometry::number::Bounds;

/// Two curves that should meet and do not.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("sides {first} and {second} do not meet: their nearest ends are {distance} apart")]
pub struct Gap {
    /// Index of the side before.
    pub first: usize,
    /// Index of the side after.
    pub second: usize,
    /// Distance of the ends, metres.
    pub distance: f64,
}

/// Ends nearer than this share of the size of all curves meet: constructions that mean one point leave about
/// 1e-15 of the size, a gap that a person leaves far more.
pub(super) const MEETS: f64 = 1e-9;

/// Turns curves around where needed, so that each starts where the one before ends and the last ends where the
/// first starts. The first keeps its direction where that can be.
///
/// # Errors
/// The widest gap between two neighbours.
pub fn ring(curves: Vec<AnyCurve>) -> Result<Vec<AnyCurve>, Gap> {
    let ends: Vec<_> = curves.iter().map(ends_of).collect();
    let size = size_of(&curves);
    let count = curves.len();
    // All curves after the first follow from its direction; both are tried.
    let laid = [false, true].map(|backward| lay(&ends, backward));
    let widest = |turned: &[bool]| {
        let start = |k: usize| if turned[k] { ends[k].1 } else { ends[k].0 };
        let end = |k: usize| if turned[k] { ends[k].0 } else { ends[k].1 };
        let gap = |k: usize| (k, end(k).distance(start((k + 1) % count)));
        (0..count).map(gap).fold((0, -1.0), |worst, next| if next.1 > worst.1 { next } else { worst })
    };
    let [(one, as_written), (other, turned)] = laid.map(|turned| (widest(&turned), turned));
    let keep = one.1 <= MEETS * size || one.1 <= other.1;
    let ((first, distance), turned) = if keep { (one, as_written) } else { (other, turned) };
    if distance > MEETS * size {
        return Err(Gap { first, second: (first + 1) % count, distance });
    }
    Ok(curves
        .into_iter()
        .zip(turned)
        .map(|(curve, turned)| if turned { reversed(curve) } else { curve })
        .collect())
}

fn ends_of(curve: &AnyCurve) -> (glam::DVec3, glam::DVec3) {
    let domain = curve.domain();
    (curve.evaluate(domain.start, Side::After).point, curve.evaluate(domain.end, Side::Before).point)
}

/// Which curves have to be turned when the first is turned or not.
fn lay(ends: &[(glam::DVec3, glam::DVec3)], first: bool) -> Vec<bool> {
    let mut turned = vec![first];
    let mut at = if first { ends[0].0 } else { ends[0].1 };
    for (start, end) in &ends[1..] {
        let backward = end.distance(at) < start.distance(at);
        at = if backward { *start } else { *end };
        turned.push(backward);
    }
    turned
}

/// A curve backwards; one that was turned before is turned back.
#[must_use]
pub(super) fn reversed(curve: AnyCurve) -> AnyCurve {
    AnyCurve::Reversed(Reversed::new(curve))
}

/// Diagonal of a box around samples of all curves.
pub(super) fn size_of(curves: &[AnyCurve]) -> f64 {
    const SAMPLES: u32 = 16;
    let along = |curve: &AnyCurve| {
        let domain = curve.domain();
        let points = (0..=SAMPLES).map(|k| curve.point(domain.at(f64::from(k) / f64::from(SAMPLES))));
        Bounds::of_points(points)
    };
    curves.iter().map(along).fold(Bounds::EMPTY, Bounds::union).diagonal()
}

/// A closed curve as sides: cut at its corners when it has two, three or four, else into four of equal length.
pub(super) fn cut(curve: &AnyCurve) -> Vec<Rail> {
    let domain = curve.domain();
    let mut corners = curve.joints();
    let (before, after) =
        (curve.direction(domain.end, Side::Before), curve.direction(domain.start, Side::After));
    let seam = before.dot(after) < 0.0 || before.cross(after).length() > 1e-9;
    if seam {
        corners.insert(0, domain.start);
    }
    let stops = match corners.len() {
        2..=4 => corners,
        1 => quarters(curve, corners[0]),
        _ => quarters(curve, domain.start),
    };
    let end = |k: usize| if k + 1 < stops.len() { stops[k + 1] } else { stops[0] + domain.span() };
    (0..stops.len()).map(|k| Rail::part(curve.clone(), stops[k], end(k))).collect()
}

/// Parameters at quarters of the length of a closed curve, counted from one of its parameters on; those beyond the
/// end of the domain come again from its start.
fn quarters(curve: &AnyCurve, start: f64) -> Vec<f64> {
    const PIECES: usize = 256;
    let domain = curve.domain();
    let span = domain.span();
    // Steps away from the start, no one across the seam or a joint.
    let ahead = |t: f64| if t < start { t + span - start } else { t - start };
    let mut steps: Vec<f64> = (0..=PIECES).map(|k| span * (k as f64 / PIECES as f64)).collect();
    steps.extend(curve.joints().into_iter().map(ahead));
    steps.push(domain.end - start);
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    let mut lengths = vec![0.0];
    for pair in steps.windows(2) {
        let (from, to) = (start + pair[0], start + pair[1]);
        let back = if from >= domain.end { span } else { 0.0 };
        lengths.push(lengths[lengths.len() - 1] + length_between(curve, from - back, to - back));
    }
    let whole = lengths[lengths.len() - 1];
    let at = |quarter: u32| {
        let wanted = whole * f64::from(quarter) / 4.0;
        let next = lengths.partition_point(|length| *length < wanted).clamp(1, lengths.len() - 1);
        let (low, high) = (lengths[next - 1], lengths[next]);
        let part = if high > low { (wanted - low) / (high - low) } else { 0.0 };
        start + steps[next - 1] + (steps[next] - steps[next - 1]) * part
    };
    (0..4).map(at).collect()
}
