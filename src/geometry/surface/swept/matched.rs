//! Curves made to correspond: one parameter for all of them, by length.
//!
//! Where all have the same number of corners, corner meets corner and the lengths between two corners are
//! shared evenly; else the lengths of the whole curves are. Closed curves run counter-clockwise, and each begins
//! where it lies nearest to the one before, so that nothing is wrung.

use glam::DVec2;

use crate::geometry::curve::{AnyCurve, Curve, Reversed, Side, length_of_step};

/// A place of a section: where it is, and its derivative by the section's parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Position in the section's plane.
    pub point: DVec2,
    /// Derivative; never zero, at a cusp of any length.
    pub across: DVec2,
}

/// A plane curve under a parameter that it shares with others.
#[derive(Clone, Debug)]
pub struct Matched {
    curve: AnyCurve,
    /// The way from the common parameter to the curve's; none where it keeps its own.
    way: Option<Way>,
}

#[derive(Clone, Debug)]
struct Way {
    table: Lengths,
    /// Common parameter and share of the curve's length, both increasing; the share may pass 1 and begin again.
    knots: Vec<(f64, f64)>,
    /// Common parameters that have an exact parameter of the curve.
    joints: Vec<(f64, f64)>,
}

/// Common parameters nearer than this are one.
const SAME: f64 = 1e-9;

/// The way along a curve by the share of its length.
///
/// Lengths are found once, at even steps of the curve's parameter; between two of them the parameter is a cubic of the
/// share with the slopes that the curve's speed gives it. The cubic never turns back, and follows the length itself to
/// the fourth order of the step.
#[derive(Clone, Debug)]
struct Lengths {
    /// Parameter and length up to it.
    stops: Vec<(f64, f64)>,
    /// For each step the derivative of the parameter by the length, where it begins and where it ends.
    slopes: Vec<(f64, f64)>,
}

impl Lengths {
    fn new(curve: &AnyCurve) -> Self {
        const STEPS: u32 = 32;
        let domain = curve.domain();
        let mut cuts = vec![domain.start];
        cuts.extend(curve.breaks());
        cuts.push(domain.end);
        let mut table = Self { stops: vec![(domain.start, 0.0)], slopes: Vec::new() };
        for pair in cuts.windows(2) {
            let at = |k: u32| {
                if k == STEPS {
                    pair[1]
                } else {
                    pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(STEPS)
                }
            };
            for k in 0..STEPS {
                table.step(curve, at(k), at(k + 1));
            }
        }
        table
    }

    fn step(&mut self, curve: &AnyCurve, from: f64, to: f64) {
        let length = length_of_step(curve, from, to).max(f64::MIN_POSITIVE);
        let even = (to - from) / length;
        // Slopes up to three times the even one never make a cubic turn back. Source: F. Fritsch, R. Carlson, Monotone
        // piecewise cubic interpolation, SIAM J. Numer. Anal. 17 (1980), lemma 2.
        let slope = |t: f64, side: Side| (1.0 / curve.evaluate(t, side).first.length()).min(3.0 * even);
        self.slopes.push((slope(from, Side::After), slope(to, Side::Before)));
        self.stops.push((to, self.whole() + length));
    }

    fn whole(&self) -> f64 {
        self.stops[self.stops.len() - 1].1
    }

    /// Share of the length up to a parameter.
    fn share(&self, curve: &AnyCurve, t: f64) -> f64 {
        let next = self.stops.partition_point(|stop| stop.0 <= t);
        let (from, walked) = self.stops[next.saturating_sub(1)];
        let further = if t > from { length_of_step(curve, from, t) } else { 0.0 };
        (walked + further) / self.whole()
    }

    /// The parameter at a share of the length, and its derivative by the share.
    fn parameter(&self, share: f64, side: Side) -> (f64, f64) {
        let walked = share * self.whole();
        let next = self.stops.partition_point(|stop| match side {
            Side::After => stop.1 <= walked,
            Side::Before => stop.1 < walked,
        });
        let next = next.clamp(1, self.stops.len() - 1);
        let ((start, before), (end, reached)) = (self.stops[next - 1], self.stops[next]);
        let length = reached - before;
        let part = ((walked - before) / length).clamp(0.0, 1.0);
        let (out, into) = (self.slopes[next - 1].0 * length, self.slopes[next - 1].1 * length);
        let span = end - start;
        let (square, cube) = (3.0 * span - 2.0 * out - into, out + into - 2.0 * span);
        let t = start + (out + (square + cube * part) * part) * part;
        let rate = (out + (2.0 * square + 3.0 * cube * part) * part) / length;
        (if part == 1.0 { end } else { t }, rate * self.whole())
    }
}

impl Matched {
    /// A curve that keeps its own parameter.
    #[must_use]
    pub fn alone(curve: AnyCurve) -> Self {
        Self { curve, way: None }
    }

    /// Curves of one section, all closed or all open, under one parameter from 0 to 1.
    #[must_use]
    pub fn all(curves: Vec<AnyCurve>) -> Vec<Self> {
        let closed = curves.iter().all(Curve::is_closed);
        let mut drafts: Vec<Draft> = curves.into_iter().map(|curve| Draft::new(curve, closed)).collect();
        let corners = drafts[0].corners.len();
        let alike = corners > 0 && drafts.iter().all(|draft| draft.corners.len() == corners);
        for index in 1..drafts.len() {
            if closed {
                let (before, rest) = drafts.split_at_mut(index);
                rest[0].begin_near(&before[index - 1], alike);
            }
        }
        let common = if alike { drafts[0].knots() } else { Vec::new() };
        drafts.into_iter().map(|draft| draft.finish(&common)).collect()
    }

    /// The curve.
    #[must_use]
    pub fn curve(&self) -> &AnyCurve {
        &self.curve
    }

    /// Common parameters strictly inside where the direction jumps or the curve begins anew.
    #[must_use]
    pub fn joints(&self) -> Vec<f64> {
        match &self.way {
            None => self.curve.joints(),
            Some(way) => {
                let inside = |u: &f64| *u > SAME && *u < 1.0 - SAME;
                way.joints.iter().map(|joint| joint.0).filter(inside).collect()
            }
        }
    }

    /// The curve's own parameter at a common one, and the side that it is to be seen from.
    fn own(&self, u: f64, side: Side) -> f64 {
        match &self.way {
            None => u,
            Some(way) => {
                way.joint(&self.curve, u, side).unwrap_or_else(|| way.table.parameter(way.share(u), side).0)
            }
        }
    }

    /// The point at a common parameter.
    #[must_use]
    pub fn point(&self, u: f64) -> DVec2 {
        self.curve.point(self.own(u, Side::Before)).truncate()
    }

    /// The place at a common parameter, at a joint from the named side.
    #[must_use]
    pub fn spot(&self, u: f64, side: Side) -> Spot {
        let Some(way) = &self.way else {
            let jet = self.curve.evaluate(u, side);
            return Spot { point: jet.point.truncate(), across: self.across(jet.first.truncate(), u, side) };
        };
        let joint = way.joint(&self.curve, u, side);
        let (inside, pace) = way.table.parameter(way.share(u), side);
        let t = joint.unwrap_or(inside);
        let jet = self.curve.evaluate(t, side);
        let across = if joint.is_some() {
            // The share may stand on the other side of the joint by rounding: there the length itself is the guide.
            self.curve.direction(t, side).truncate() * way.table.whole()
        } else {
            self.across(jet.first.truncate() * pace, t, side)
        };
        Spot { point: jet.point.truncate(), across: across * way.rate(u, side) }
    }

    /// A derivative, or where it vanishes or is not the direction the direction.
    fn across(&self, first: DVec2, t: f64, side: Side) -> DVec2 {
        let direction = self.curve.direction(t, side).truncate();
        let parallel = first.perp_dot(direction).abs() <= 1e-9 * first.length();
        if parallel && first != DVec2::ZERO { first } else { direction }
    }

    /// A bound on how far the points between two common parameters lie from those of the chord at the same share
    /// of its length. Without a common parameter it is the proved bound on the distance; else it is the greatest
    /// of samples with a margin, and no less than half of the proved bound.
    #[must_use]
    pub fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let (start, end) = (self.own(from, Side::After), self.own(to, Side::Before));
        if self.way.is_none() {
            return self.curve.chord_deviation(start, end);
        }
        let proved = if start < end { self.curve.chord_deviation(start, end) } else { 0.0 };
        let (low, high) = (self.spot(from, Side::After).point, self.spot(to, Side::Before).point);
        let away = |part: f64| {
            let spot = self.spot(from + (to - from) * part, Side::After);
            spot.point.distance(low.lerp(high, part))
        };
        [0.25, 0.5, 0.75].map(away).into_iter().fold(proved / 2.0, |most, found| most.max(1.1 * found))
    }
}

impl Way {
    /// The exact parameter of the curve at a joint.
    fn joint(&self, curve: &AnyCurve, u: f64, side: Side) -> Option<f64> {
        let near = self.joints.partition_point(|joint| joint.0 < u - SAME);
        let (_, t) = self.joints.get(near).filter(|joint| (joint.0 - u).abs() <= SAME)?;
        let domain = curve.domain();
        Some(match side {
            // The seam of the curve itself.
            Side::Before if *t == domain.start && u > SAME => domain.end,
            Side::After if *t == domain.end && u < 1.0 - SAME => domain.start,
            _ => *t,
        })
    }

    fn span(&self, u: f64, side: Side) -> ((f64, f64), (f64, f64)) {
        let next = self.knots.partition_point(|knot| match side {
            Side::After => knot.0 <= u,
            Side::Before => knot.0 < u,
        });
        let to = next.clamp(1, self.knots.len() - 1);
        (self.knots[to - 1], self.knots[to])
    }

    /// Share of the curve's length; past the seam it begins anew.
    fn share(&self, u: f64) -> f64 {
        let (from, to) = self.span(u, Side::After);
        let share = from.1 + (to.1 - from.1) * ((u - from.0) / (to.0 - from.0));
        if share >= 1.0 { share - 1.0 } else { share }
    }

    /// Derivative of the share.
    fn rate(&self, u: f64, side: Side) -> f64 {
        let (from, to) = self.span(u, side);
        (to.1 - from.1) / (to.0 - from.0)
    }
}

/// A curve while it is made to fit the others.
struct Draft {
    curve: AnyCurve,
    table: Lengths,
    /// Share and parameter of each corner; of a closed curve the start too, if it is one.
    corners: Vec<(f64, f64)>,
    /// Where it begins.
    start: f64,
    closed: bool,
}

impl Draft {
    fn new(curve: AnyCurve, closed: bool) -> Self {
        let curve =
            if closed && turns_clockwise(&curve) { AnyCurve::Reversed(Reversed::new(curve)) } else { curve };
        let table = Lengths::new(&curve);
        let mut corners: Vec<(f64, f64)> = (curve.joints().into_iter())
            .map(|t| (table.share(&curve, t), t))
            .filter(|(_, t)| bends(&curve, *t, *t))
            .collect();
        let domain = curve.domain();
        if closed && bends(&curve, domain.end, domain.start) {
            corners.insert(0, (0.0, domain.start));
        }
        Self { curve, table, corners, start: 0.0, closed }
    }

    fn point(&self, share: f64) -> DVec2 {
        self.curve.point(self.table.parameter(share - share.floor(), Side::After).0).truncate()
    }

    /// Samples that correspond to each other when both curves begin where they do.
    fn samples(&self, knots: &[f64]) -> Vec<DVec2> {
        const SAMPLES: u32 = 64;
        if knots.is_empty() {
            return (0..SAMPLES)
                .map(|k| self.point(self.start + f64::from(k) / f64::from(SAMPLES)))
                .collect();
        }
        knots.iter().map(|share| self.point(*share)).collect()
    }

    /// Shares of the corners from the start on, and of the middles between them.
    fn corner_shares(&self, first: usize) -> Vec<f64> {
        let count = self.corners.len();
        let share =
            |k: usize| self.corners[(first + k) % count].0 + if first + k >= count { 1.0 } else { 0.0 };
        (0..count)
            .flat_map(|k| {
                let next = if k + 1 < count { share(k + 1) } else { share(0) + 1.0 };
                [share(k), (share(k) + next) / 2.0]
            })
            .collect()
    }

    /// Sets the start of a closed curve where it lies nearest to another, from its start on.
    fn begin_near(&mut self, other: &Self, by_corners: bool) {
        if by_corners {
            let fixed = other.samples(&other.corner_shares(other.first_corner()));
            let cost = |first: usize| square(&self.samples(&self.corner_shares(first)), &fixed);
            let best = (0..self.corners.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(0);
            let (last, first) = other.around_start(other.first_corner());
            let part = if other.start == first { 1.0 } else { (other.start - last) / (first - last) };
            let (last, first) = self.around_start(best);
            let start = if part == 1.0 { first } else { last + (first - last) * part };
            self.start = start - start.floor();
            return;
        }
        let fixed = other.samples(&[]);
        let count = fixed.len();
        let own = self.samples(&[]);
        let turned =
            |k: usize| (0..count).map(|j| own[(j + k) % count].distance_squared(fixed[j])).sum::<f64>();
        let best = (0..count).min_by(|a, b| turned(*a).total_cmp(&turned(*b))).unwrap_or(0);
        let step = 1.0 / count as f64;
        self.start = self.polished(best as f64 * step, step, &fixed);
    }

    /// Shares of a corner and of the one before it, around the start where the corner is the first after that.
    fn around_start(&self, corner: usize) -> (f64, f64) {
        let count = self.corners.len();
        let first = self.corners[corner].0;
        let first = if first < self.start - SAME { first + 1.0 } else { first };
        let last = self.corners[(corner + count - 1) % count].0;
        let turns = if last >= first { (last - first).floor() + 1.0 } else { 0.0 };
        (last - turns, first)
    }

    /// The best start around a sampled one; the sampled one itself unless another is better by more than rounding.
    fn polished(&self, best: f64, step: f64, fixed: &[DVec2]) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let count = fixed.len() as f64;
        let cost = |start: f64| {
            let share = |k: usize| start + k as f64 / count;
            fixed
                .iter()
                .enumerate()
                .map(|(k, place)| self.point(share(k)).distance_squared(*place))
                .sum::<f64>()
        };
        let (mut low, mut high) = (best - step, best + step);
        for _ in 0..24 {
            let (left, right) = (high - (high - low) * GOLDEN, low + (high - low) * GOLDEN);
            if cost(left) < cost(right) {
                high = right;
            } else {
                low = left;
            }
        }
        let found = (low + high) / 2.0;
        let start = if cost(found) < cost(best) * (1.0 - 1e-6) { found } else { best };
        start - start.floor()
    }

    /// The corner at the start, else the first after it.
    fn first_corner(&self) -> usize {
        let place = self.corners.partition_point(|corner| corner.0 < self.start - SAME);
        if place == self.corners.len() { 0 } else { place }
    }

    /// Common parameters of the corners: shares of the length from the start on.
    fn knots(&self) -> Vec<f64> {
        let first = if self.closed { self.first_corner() } else { 0 };
        let count = self.corners.len();
        (0..count)
            .map(|k| {
                let share = self.corners[(first + k) % count].0 - self.start;
                if share < -SAME { share + 1.0 } else { share.max(0.0) }
            })
            .collect()
    }

    /// The curve under the common parameter; `common` are those of its corners, if corners are to meet.
    fn finish(self, common: &[f64]) -> Matched {
        let mut knots = vec![(0.0, self.start)];
        let first = if self.closed { self.first_corner() } else { 0 };
        let count = self.corners.len();
        let unwrapped =
            |share: f64| if share < self.start - SAME { share + 1.0 } else { share.max(self.start) };
        for (k, u) in common.iter().enumerate() {
            let share = unwrapped(self.corners[(first + k) % count].0);
            if *u > SAME && *u < 1.0 - SAME {
                knots.push((*u, share));
            }
        }
        knots.push((1.0, self.start + 1.0));
        let mut way = Way { table: self.table, knots, joints: Vec::new() };
        let mut joints: Vec<(f64, f64)> = Vec::new();
        let domain = self.curve.domain();
        let mut stops: Vec<f64> = self.curve.joints();
        stops.push(domain.start);
        for t in stops {
            let share = unwrapped(way.table.share(&self.curve, t));
            joints.push((way.common(share), t));
        }
        joints.retain(|(u, _)| self.closed || (*u > SAME && *u < 1.0 - SAME));
        if self.start == 0.0 {
            joints.retain(|(u, _)| *u > SAME);
            joints.push((0.0, domain.start));
            joints.push((1.0, domain.end));
        } else if let Some((_, t)) = joints.iter().copied().find(|(u, _)| *u <= SAME) {
            joints.push((1.0, t));
        }
        joints.sort_by(|a, b| a.0.total_cmp(&b.0));
        way.joints = joints;
        Matched { curve: self.curve, way: Some(way) }
    }
}

impl Way {
    /// The common parameter at a share of the curve's length.
    fn common(&self, share: f64) -> f64 {
        let next = self.knots.partition_point(|knot| knot.1 <= share);
        let to = next.clamp(1, self.knots.len() - 1);
        let (from, to) = (self.knots[to - 1], self.knots[to]);
        from.0 + (to.0 - from.0) * ((share - from.1) / (to.1 - from.1))
    }
}

fn square(one: &[DVec2], other: &[DVec2]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.distance_squared(*b)).sum()
}

/// Whether the direction jumps by more than a degree.
fn bends(curve: &AnyCurve, before: f64, after: f64) -> bool {
    const LEAST: f64 = 0.999_847_695;
    curve.direction(before, Side::Before).dot(curve.direction(after, Side::After)) < LEAST
}

/// Whether a closed plane curve turns clockwise, by the area of a polygon along it.
pub(super) fn turns_clockwise(curve: &AnyCurve) -> bool {
    const STEPS: u32 = 256;
    let domain = curve.domain();
    let mut cuts: Vec<f64> = (0..STEPS).map(|k| domain.at(f64::from(k) / f64::from(STEPS))).collect();
    cuts.extend(curve.joints());
    cuts.sort_by(f64::total_cmp);
    let points: Vec<DVec2> = cuts.into_iter().map(|t| curve.point(t).truncate()).collect();
    let origin = points[0];
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| (*a - origin).perp_dot(*b - origin)).sum::<f64>() < 0.0
}
