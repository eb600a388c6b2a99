//! Curves into stations: the fewest chords that stay within a tolerance.
//!
//! Between two joints the longest chord within the tolerance is taken greedily, which gives the fewest
//! chords; then the tolerance of that piece is lowered as far as the same number allows, so that the last
//! chord is no stump and all deviate alike. Cost: O(chords) bound evaluations, about 30 a chord.

use glam::DVec3;

use super::TessellateError;
use crate::geometry::curve::{Curve, Side, length_between};
use crate::geometry::number::{atan2, cos_degrees, floor_count, floor_large};

/// A point of a curve that a mesh will use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Parameter.
    pub t: f64,
    /// Position.
    pub point: DVec3,
    /// Unit direction of what comes before.
    pub before: DVec3,
    /// Unit direction of what comes after.
    pub after: DVec3,
    /// Proved bound on the deviation of the chord that starts here; zero at the last station.
    pub deviation: f64,
}

impl Station {
    /// Degrees by which the direction jumps here.
    #[must_use]
    pub fn turn(&self) -> f64 {
        if self.before == self.after {
            return 0.0;
        }
        atan2(self.before.cross(self.after).length(), self.before.dot(self.after)).to_degrees()
    }
}

/// How finely a curve is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Chords within this many metres.
    Tolerance(f64),
    /// This many chords, even in the parameter; more where joints demand it.
    Count(u32),
}

/// No chord spans a greater change of direction than this, so that a coarse tolerance does not flatten a
/// circle to a line.
const GREATEST_TURN: f64 = 90.0;

/// Stations along the whole curve, first and last included; all joints are stations.
///
/// # Errors
/// When more than `limit` chords are needed.
pub fn discretize(curve: &impl Curve, density: Density, limit: u64) -> Result<Vec<Station>, TessellateError> {
    let domain = curve.domain();
    let mut stops = vec![domain.start];
    stops.extend(curve.joints());
    stops.push(domain.end);
    let parameters = match density {
        Density::Tolerance(tolerance) => {
            check(lower_estimate(curve, &stops, tolerance), limit)?;
            let mut all = vec![domain.start];
            for pair in stops.windows(2) {
                all.extend(balanced(curve, (pair[0], pair[1]), tolerance, limit)?);
                check(all.len() as u64 - 1, limit)?;
            }
            all
        }
        Density::Count(count) => {
            check(u64::from(count), limit)?;
            spread(&stops, count)
        }
    };
    Ok(stations(curve, &parameters))
}

fn check(needed: u64, limit: u64) -> Result<(), TessellateError> {
    if needed > limit { Err(TessellateError::TooMany { needed, limit }) } else { Ok(()) }
}

/// Fewer chords than will be needed, found at once so that what cannot be made is refused at once.
///
/// A chord over a part that deviates by d has to be cut into about the root of d / tolerance pieces. The
/// bounds of long parts are up to six times what the curve does, so a quarter of the sum is safe.
fn lower_estimate(curve: &impl Curve, stops: &[f64], tolerance: f64) -> u64 {
    const PARTS: u32 = 16;
    let mut chords = 0.0;
    for pair in stops.windows(2) {
        let at = |k: u32| pair[0] + (pair[1] - pair[0]) * (f64::from(k) / f64::from(PARTS));
        let parts = (0..PARTS).map(|k| (curve.chord_deviation(at(k), at(k + 1)) / tolerance).sqrt());
        chords += parts.sum::<f64>();
    }
    floor_large(chords / 4.0)
}

/// `count` steps over the stops in proportion to their lengths, at least one for each.
fn spread(stops: &[f64], count: u32) -> Vec<f64> {
    let span = stops[stops.len() - 1] - stops[0];
    let mut parameters = vec![stops[0]];
    let mut used = 0;
    for pair in stops.windows(2) {
        let reached = floor_count(((pair[1] - stops[0]) / span * f64::from(count)).round());
        let steps = reached.saturating_sub(used).max(1);
        used += steps;
        let at = |k: u32| {
            let fraction = f64::from(k) / f64::from(steps);
            if k == steps { pair[1] } else { pair[0] + (pair[1] - pair[0]) * fraction }
        };
        parameters.extend((1..=steps).map(at));
    }
    parameters
}

fn stations(curve: &impl Curve, parameters: &[f64]) -> Vec<Station> {
    let last = parameters.len() - 1;
    let mut stations: Vec<Station> = parameters
        .iter()
        .enumerate()
        .map(|(index, t)| Station {
            t: *t,
            point: curve.evaluate(*t, if index == last { Side::Before } else { Side::After }).point,
            before: curve.direction(*t, Side::Before),
            after: curve.direction(*t, Side::After),
            deviation: if index == last { 0.0 } else { curve.chord_deviation(*t, parameters[index + 1]) },
        })
        .collect();
    if curve.is_closed() {
        stations[last].point = stations[0].point;
        stations[0].before = stations[last].before;
        stations[last].after = stations[0].after;
    } else {
        stations[0].before = stations[0].after;
        stations[last].after = stations[last].before;
    }
    stations
}

/// Ends of the chords over one smooth piece, its start left out.
fn balanced(
    curve: &impl Curve,
    piece: (f64, f64),
    tolerance: f64,
    limit: u64,
) -> Result<Vec<f64>, TessellateError> {
    let mut best = greedy(curve, piece, tolerance, limit)?;
    let count = best.len();
    if count < 2 {
        return Ok(best);
    }
    // With one chord fewer the tolerance would have to grow by about (n / (n - 1))^2.
    let fewer = (count - 1) as f64 / count as f64;
    let (mut low, mut high) = (tolerance * fewer * fewer * fewer, tolerance);
    for _ in 0..7 {
        let middle = (low + high) / 2.0;
        let tried = greedy(curve, piece, middle, limit.max(count as u64 + 1))?;
        if tried.len() > count {
            low = middle;
        } else {
            high = middle;
            best = tried;
        }
    }
    Ok(best)
}

fn greedy(
    curve: &impl Curve,
    (start, end): (f64, f64),
    tolerance: f64,
    limit: u64,
) -> Result<Vec<f64>, TessellateError> {
    let mut ends = Vec::new();
    let mut t = start;
    let mut step = end - start;
    while t < end {
        check(ends.len() as u64 + 1, limit)?;
        step = longest_step(curve, (t, end), step, tolerance);
        let next = if t + step >= end || t + step <= t { end } else { t + step };
        ends.push(next);
        t = next;
    }
    Ok(ends)
}

/// The longest step from `t` within the tolerance, to a few percent, starting from the guess `step`.
fn longest_step(curve: &impl Curve, (t, end): (f64, f64), step: f64, tolerance: f64) -> f64 {
    let room = end - t;
    let mut step = step.min(room);
    let mut accepted = 0.0_f64;
    let mut refused = f64::INFINITY;
    for _ in 0..40 {
        let deviation = curve.chord_deviation(t, t + step);
        let fits = deviation <= tolerance && turns_little(curve, t, t + step);
        if fits {
            accepted = accepted.max(step);
            if step >= room || deviation >= 0.95 * tolerance || refused <= accepted * 1.02 {
                return accepted;
            }
        } else {
            refused = refused.min(step);
            if accepted > 0.0 && refused <= accepted * 1.02 {
                return accepted;
            }
        }
        step = next_guess(step, deviation / tolerance, (accepted, refused)).min(room);
    }
    if accepted > 0.0 { accepted } else { step }
}

/// A chord's deviation grows as the square of its length: aim a little below the tolerance, inside what is
/// known to fit and not to fit.
fn next_guess(step: f64, ratio: f64, (accepted, refused): (f64, f64)) -> f64 {
    let aim = if ratio > 0.0 { step * (0.98 / ratio).sqrt() } else { step * 4.0 };
    let aim = aim.clamp(step * 0.05, step * 4.0);
    if aim > accepted && aim < refused {
        aim
    } else if refused.is_finite() {
        (accepted + refused) / 2.0
    } else {
        accepted * 2.0
    }
}

fn turns_little(curve: &impl Curve, from: f64, to: f64) -> bool {
    let (start, end) = (curve.direction(from, Side::After), curve.direction(to, Side::Before));
    start.dot(end) >= cos_degrees(GREATEST_TURN) - 1e-12
        && start.dot(curve.direction((from + to) / 2.0, Side::After)) >= -1e-12
}

/// Length of the curve from the first station to each.
#[must_use]
pub fn arc_lengths(curve: &impl Curve, stations: &[Station]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in stations.windows(2) {
        let reached = lengths[lengths.len() - 1];
        lengths.push(reached + length_between(curve, pair[0].t, pair[1].t));
    }
    lengths
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Density, discretize};
    use crate::geometry::curve::{BezierSpline, EllipseArc, Polyline};
    use crate::geometry::tessellate::TessellateError;

    #[test]
    fn circle_gets_the_fewest_even_chords() {
        let circle = EllipseArc::full(DVec3::ZERO, 1.0, 1.0);
        for tolerance in [0.1, 0.01, 1e-3, 1e-4, 1e-5] {
            let stations = discretize(&circle, Density::Tolerance(tolerance), 1 << 20).unwrap();
            let ideal = core::f64::consts::PI / crate::geometry::number::acos(1.0 - tolerance);
            let count = (stations.len() - 1) as f64;
            assert!(count >= ideal && count <= ideal * 1.05 + 1.0, "{count} for {ideal}");
            let longest = stations.iter().map(|station| station.deviation).fold(0.0, f64::max);
            assert!(longest <= tolerance);
            assert_eq!(stations[0].point, stations[stations.len() - 1].point);
        }
    }

    #[test]
    fn joints_are_kept_and_straight_pieces_stay_whole() {
        let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let line = Polyline::new(points.to_vec(), false).unwrap();
        let stations = discretize(&line, Density::Tolerance(1e-6), 100).unwrap();
        assert_eq!(stations.iter().map(|station| station.t).collect::<Vec<_>>(), [0.0, 1.0, 2.0]);
        let counted = discretize(&line, Density::Count(8), 100).unwrap();
        assert_eq!(counted.len(), 9);
        assert!(counted.iter().any(|station| station.point == points[1]));
    }

    #[test]
    fn chords_deviate_alike_on_a_curve_of_uneven_bend() {
        let points = [(0.0, 0.0), (0.9, 0.0), (1.2, 0.5), (1.0, 1.0), (0.8, 1.5), (0.5, 1.6), (0.0, 2.0)];
        let curve = BezierSpline::new(3, points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec()).unwrap();
        let stations = discretize(&curve, Density::Tolerance(1e-4), 1000).unwrap();
        let inner = &stations[..stations.len() - 2];
        let least = inner.iter().map(|station| station.deviation).fold(f64::INFINITY, f64::min);
        assert!(least > 0.5e-4, "{least}");
    }

    #[test]
    fn too_many_is_refused_early() {
        let circle = EllipseArc::full(DVec3::ZERO, 1.0, 1.0);
        let refused = discretize(&circle, Density::Tolerance(1e-12), 1000);
        assert!(matches!(refused, Err(TessellateError::TooMany { limit: 1000, .. })));
    }
}
