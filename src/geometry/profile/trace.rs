//! From the polygons of a result back to the curves that they were made from.

use glam::DVec2;

use super::ProfileError;
use super::chords::{Chords, Loop, Place};
use crate::geometry::curve::{AnyCurve, Curve as _, Path, Reversed, Side, Trimmed, nearest_within};
use crate::geometry::planar::twice_area;

/// Consecutive edges of a contour on one curve.
struct Run {
    first: Place,
    last: Place,
    /// Chords from the first to the last.
    steps: usize,
    start: DVec2,
}

/// What is known of the curves.
pub(super) struct Tracer<'a> {
    pub(super) loops: &'a [Loop],
    /// Extent of all curves.
    pub(super) size: f64,
    /// Contours thinner than this are made by chords alone.
    pub(super) thin: f64,
}

impl Tracer<'_> {
    /// The closed curves of contours. Contours that only chords can see are left out.
    pub(super) fn trace(&self, contours: &[Vec<DVec2>]) -> Result<Vec<AnyCurve>, ProfileError> {
        let chords = Chords::new(self.loops, self.size);
        let mut traced = Vec::new();
        for contour in contours.iter().filter(|contour| !self.is_thin(contour)) {
            traced.extend(self.curve(&self.runs(contour, &chords), &chords)?);
        }
        if traced.is_empty() { Err(ProfileError::Nothing) } else { Ok(traced) }
    }

    fn is_thin(&self, contour: &[DVec2]) -> bool {
        let next = contour.iter().cycle().skip(1);
        let around: f64 = contour.iter().zip(next).map(|(a, b)| a.distance(*b)).sum();
        twice_area(contour).abs() <= around * self.thin
    }

    fn runs(&self, contour: &[DVec2], chords: &Chords<'_>) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let next = contour.iter().cycle().skip(1);
        for (a, b) in contour.iter().zip(next).filter(|(a, b)| a != b) {
            let before = runs.last().map(|run| run.last);
            let Some(place) = chords.at((*a + *b) / 2.0, *b - *a, before) else { continue };
            match (runs.last_mut(), before.and_then(|before| chords.steps(before, place))) {
                (Some(run), Some(steps)) => {
                    run.last = place;
                    run.steps += steps;
                }
                _ => runs.push(Run { first: place, last: place, steps: 0, start: *a }),
            }
        }
        // The contour may begin in the middle of a run.
        if runs.len() > 1
            && let Some(steps) = chords.steps(runs[runs.len() - 1].last, runs[0].first)
            && let Some(end) = runs.pop()
        {
            let begun = &mut runs[0];
            begun.steps += steps + end.steps;
            (begun.first, begun.start) = (end.first, end.start);
        }
        runs
    }

    fn curve(&self, runs: &[Run], chords: &Chords<'_>) -> Result<Option<AnyCurve>, ProfileError> {
        // A run that ends where it began without going on there is a loop of a curve that crosses itself.
        if let [run] = runs
            && chords.steps(run.last, run.first).is_some()
        {
            return Ok(Some(self.whole(run.first)));
        }
        let meetings: Result<Vec<(f64, f64)>, ProfileError> = (0..runs.len())
            .map(|k| self.meet(runs[(k + runs.len() - 1) % runs.len()].last, runs[k].first, runs[k].start))
            .collect();
        let meetings = meetings?;
        let mut pieces = Vec::new();
        for (k, run) in runs.iter().enumerate() {
            let (start, end) = (meetings[k].1, meetings[(k + 1) % runs.len()].0);
            pieces.extend(self.pieces(run, start, end));
        }
        Ok(Path::closed(pieces).map(AnyCurve::Path))
    }

    /// A curve that nothing crosses.
    fn whole(&self, place: Place) -> AnyCurve {
        let curve = self.loops[place.of].curve.clone();
        if place.forward { curve } else { AnyCurve::Reversed(Reversed::new(curve)) }
    }

    /// The parts of a curve that a run covers: two where it passes the seam.
    fn pieces(&self, run: &Run, start: f64, end: f64) -> Vec<AnyCurve> {
        let one = &self.loops[run.first.of];
        let domain = one.curve.domain();
        let part = |from: f64, to: f64| {
            let short = to - from <= 1e-9 * domain.span();
            if short && one.curve.point(from).distance(one.curve.point(to)) <= 1e-11 * self.size {
                return None;
            }
            let part = Trimmed::new(one.curve.clone(), from, to).map(AnyCurve::Trimmed)?;
            Some(if run.first.forward { part } else { AnyCurve::Reversed(Reversed::new(part)) })
        };
        let parts = if run.first.forward {
            let passes = run.first.step + run.steps >= one.count();
            if passes { [part(start, domain.end), part(domain.start, end)] } else { [part(start, end), None] }
        } else {
            let passes = run.steps > run.first.step;
            if passes { [part(domain.start, start), part(end, domain.end)] } else { [part(end, start), None] }
        };
        parts.into_iter().flatten().collect()
    }

    /// The parameters at which two curves meet near a crossing of their chords.
    fn meet(&self, from: Place, to: Place, point: DVec2) -> Result<(f64, f64), ProfileError> {
        let (mut s, mut t) = (self.parameter(from, point), self.parameter(to, point));
        let (range_s, range_t) = (self.range(from), self.range(to));
        let (one, other) = (&self.loops[from.of].curve, &self.loops[to.of].curve);
        // Curves that run along each other meet wherever they are asked to.
        let (away, nearest) = nearest_within(other, one.point(s), range_t.0, range_t.1);
        if away <= 1e-11 * self.size {
            return Ok((s, nearest));
        }
        for _ in 0..40 {
            let (a, b) = (one.evaluate(s, Side::Before), other.evaluate(t, Side::Before));
            let gap = (b.point - a.point).truncate();
            if gap.length() <= 1e-13 * self.size {
                return Ok((s, t));
            }
            let (along, across) = (a.first.truncate(), -b.first.truncate());
            let turn = along.perp_dot(across);
            if turn.abs() <= 1e-12 * along.length() * across.length() {
                break;
            }
            s = (s + gap.perp_dot(across) / turn).clamp(range_s.0, range_s.1);
            t = (t + along.perp_dot(gap) / turn).clamp(range_t.0, range_t.1);
        }
        let (away, nearest) = nearest_within(other, one.point(s), range_t.0, range_t.1);
        if away <= 1e-9 * self.size { Ok((s, nearest)) } else { Err(ProfileError::Touch(point)) }
    }

    /// The parameter on a chord nearest to a point.
    fn parameter(&self, place: Place, point: DVec2) -> f64 {
        let one = &self.loops[place.of];
        let [a, b] = one.chord(place.step);
        let along = b - a;
        let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let (from, to) = (one.stations[place.step].t, one.stations[place.step + 1].t);
        from + (to - from) * share
    }

    /// The parameters of a chord and of its neighbors: the curves may cross beyond its end.
    fn range(&self, place: Place) -> (f64, f64) {
        let stations = &self.loops[place.of].stations;
        (stations[place.step.saturating_sub(1)].t, stations[(place.step + 2).min(stations.len() - 1)].t)
    }
}
