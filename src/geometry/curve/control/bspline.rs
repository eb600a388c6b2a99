//! B-splines: one control point for each basis function over [`Knots`].

use super::{Control, KnotError, Knots, between};

/// A B-spline of any degree; closed ones have their first control points repeated at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline<P> {
    knots: Knots,
    points: Vec<P>,
    closed: bool,
}

impl<P: Control> BSpline<P> {
    /// A B-spline with one control point for each basis function; `None` when the counts differ.
    #[must_use]
    pub fn new(knots: Knots, points: Vec<P>) -> Option<Self> {
        (knots.points() == points.len()).then_some(Self { knots, points, closed: false })
    }

    /// A closed B-spline: as many steps of `period` as control points; its parameter runs from the first to the
    /// last number of `period`, and control point 0 weighs most half a degree before the start.
    ///
    /// # Errors
    /// When the knots do not fit the degree or the points.
    pub fn closed(degree: usize, points: &[P], period: &[f64]) -> Result<Self, KnotError> {
        if period.len() != points.len() + 1 {
            return Err(KnotError::Few { least: points.len() + 1, found: period.len() });
        }
        let knots = Knots::periodic(degree, period)?;
        let wrapped = (0..points.len() + degree).map(|k| points[k % points.len()]).collect();
        Ok(Self { knots, points: wrapped, closed: true })
    }

    /// Bezier pieces as a B-spline: inner knots have the multiplicity of the degree. `breaks` has one number
    /// more than there are pieces; ends of neighbours stand once among the points.
    ///
    /// # Errors
    /// When the numbers do not increase or do not fit the points.
    pub fn from_bezier(degree: usize, points: Vec<P>, breaks: &[f64]) -> Result<Self, KnotError> {
        let pieces = breaks.len().saturating_sub(1);
        if pieces == 0 || points.len() != pieces * degree + 1 {
            return Err(KnotError::Few { least: 2, found: breaks.len() });
        }
        let times = |k: usize| degree + usize::from(k == 0 || k == pieces);
        let values = breaks.iter().enumerate().flat_map(|(k, knot)| std::iter::repeat_n(*knot, times(k)));
        Ok(Self { knots: Knots::new(degree, values.collect())?, points, closed: false })
    }

    /// The knots.
    #[must_use]
    pub fn knots(&self) -> &Knots {
        &self.knots
    }

    /// The control points.
    #[must_use]
    pub fn points(&self) -> &[P] {
        &self.points
    }

    /// The point at `t` by de Boor's scheme: O(degree^2) after finding the span.
    ///
    /// Source: C. de Boor, On calculating with B-splines, J. Approx. Theory 6 (1972).
    #[must_use]
    pub fn de_boor(&self, t: f64) -> P {
        let (start, end) = self.knots.domain();
        let t = t.clamp(start, end);
        self.blossom(self.knots.span(t), |_| t)
    }

    /// The polar form of the piece over a span: the value is symmetric and affine in each of its `degree`
    /// arguments, and where all are equal it is the point.
    fn blossom(&self, span: usize, argument: impl Fn(usize) -> f64) -> P {
        let (p, u) = (self.knots.degree(), self.knots.values());
        let mut d = self.points[span - p..=span].to_vec();
        for level in 1..=p {
            let t = argument(level - 1);
            for j in 0..=p - level {
                let (low, high) = (u[span - p + level + j], u[span + 1 + j]);
                d[j] = between(d[j], d[j + 1], (t - low) / (high - low));
            }
        }
        d[0]
    }

    /// The pieces in Bezier form, ends of neighbours once, and the parameters at which they begin and end.
    ///
    /// Each control point is a value of the polar form at the ends of its piece, so only convex combinations
    /// are made of the given points. Cost: O(degree^3) a piece.
    #[must_use]
    pub fn to_bezier(&self) -> (Vec<P>, Vec<f64>) {
        let (p, u) = (self.knots.degree(), self.knots.values());
        let (mut points, mut breaks) = (Vec::new(), Vec::new());
        for span in self.knots.spans() {
            let (start, end) = (u[span], u[span + 1]);
            let first = usize::from(!points.is_empty());
            if first == 0 {
                breaks.push(start);
            }
            breaks.push(end);
            let control = |j: usize| self.blossom(span, |k| if k < p - j { start } else { end });
            points.extend((first..=p).map(control));
        }
        if self.closed {
            // The same point by other sums: equal to the bit, so that the seam is none.
            let last = points.len() - 1;
            points[last] = points[0];
        }
        (points, breaks)
    }

    /// The same curve with one knot more.
    ///
    /// Source: W. Boehm, Inserting new knots into B-spline curves, CAD 12 (1980).
    ///
    /// # Errors
    /// When `t` would stand more often than the degree allows; a `t` outside the domain is taken as its end.
    pub fn insert(&self, t: f64) -> Result<Self, KnotError> {
        let (start, end) = self.knots.domain();
        let t = t.clamp(start, end);
        let (p, u) = (self.knots.degree(), self.knots.values());
        let span = self.knots.span(t);
        let mut values = u.to_vec();
        let place = values.partition_point(|knot| *knot <= t);
        values.insert(place, t);
        let knots = Knots::new(p, values)?;
        let point = |i: usize| {
            if i + p <= span {
                return self.points[i];
            }
            if i > span || u[i] >= t {
                return self.points[i - 1];
            }
            between(self.points[i - 1], self.points[i], (t - u[i]) / (u[i + p] - u[i]))
        };
        Ok(Self { points: (0..=self.points.len()).map(point).collect(), knots, closed: self.closed })
    }

    /// The same curve one degree higher, every knot repeated once more.
    ///
    /// A control point of the higher degree is the mean of the polar form over the arguments that are left when
    /// one of its knots is omitted. Source: W. Liu, A simple, efficient degree raising algorithm for B-spline
    /// curves, CAGD 14 (1997), by the polar forms of L. Ramshaw.
    #[must_use]
    pub fn elevated(&self) -> Self {
        let q = self.knots.degree() + 1;
        let values = self.raised_knots();
        let count = values.len() - q - 1;
        let point = |i: usize| {
            let span = self.knots.span(middle_of(&values[i..=i + q + 1], self.knots.domain()));
            let omit = |out: usize| self.blossom(span, |k| values[i + 1 + if k < out { k } else { k + 1 }]);
            (0..q).map(omit).fold(P::default(), |sum, part| sum + part * (1.0 / q as f64))
        };
        let points = (0..count).map(point).collect();
        Self { knots: Knots::trusted(q, values), points, closed: self.closed }
    }

    /// Each knot once more; beyond the ends no more than the higher degree needs.
    fn raised_knots(&self) -> Vec<f64> {
        let (start, end) = self.knots.domain();
        let raised = |run: &[f64]| std::iter::repeat_n(run[0], run.len() + 1).collect::<Vec<_>>();
        let all: Vec<f64> = self.knots.values().chunk_by(|a, b| a == b).flat_map(raised).collect();
        let (low, high) = (all.partition_point(|u| *u <= start), all.partition_point(|u| *u < end));
        let keep = self.knots.degree() + 2;
        all[low - keep..high + keep].to_vec()
    }

    /// The same curve run backwards over the same domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let (start, end) = self.knots.domain();
        let values = self.knots.values().iter().rev().map(|knot| start + (end - knot)).collect();
        let points = self.points.iter().rev().copied().collect();
        Self { knots: Knots::trusted(self.knots.degree(), values), points, closed: self.closed }
    }
}

/// A parameter inside a step of the knots, near their middle, that lies in the domain.
fn middle_of(knots: &[f64], (start, end): (f64, f64)) -> f64 {
    let half = knots.len() / 2;
    let steps = knots.windows(2).enumerate();
    let inside = steps.filter(|(_, pair)| pair[0] < pair[1] && pair[0] >= start && pair[1] <= end);
    let nearest = inside.min_by_key(|(index, _)| index.abs_diff(half));
    nearest.map_or(start, |(_, pair)| f64::midpoint(pair[0], pair[1]))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::BSpline;
    use crate::geometry::curve::control::{KnotError, Knots, de_casteljau};

    fn points(count: usize) -> Vec<DVec3> {
        let number = |k: usize| ((k * k * 5 + k * 3 + 2) % 13) as f64 - 5.0;
        (0..count).map(|k| DVec3::new(k as f64, number(k), 0.5 * number(k + 4))).collect()
    }

    fn splines() -> Vec<BSpline<DVec3>> {
        let of = |knots: Knots| BSpline::new(knots.clone(), points(knots.points())).unwrap();
        let mut all: Vec<_> = (1..=5).map(|degree| of(Knots::clamped(degree, degree + 4).unwrap())).collect();
        all.push(of(Knots::uniform(3, 8).unwrap()));
        all.push(of(Knots::uniform(2, 3).unwrap()));
        let uneven = vec![-1.0, -0.5, 0.0, 0.0, 0.5, 0.75, 0.75, 0.75, 2.0, 2.0, 3.0, 7.0];
        all.push(of(Knots::new(3, uneven).unwrap()));
        all.push(BSpline::closed(3, &points(6), &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap());
        all.push(BSpline::closed(4, &points(3), &[0.0, 0.25, 0.25, 2.0]).unwrap());
        all
    }

    fn places(spline: &BSpline<DVec3>) -> Vec<f64> {
        let (start, end) = spline.knots().domain();
        (0..=60).map(|k| start + (end - start) * f64::from(k) / 60.0).collect()
    }

    fn assert_same(a: &BSpline<DVec3>, b: &BSpline<DVec3>) {
        assert_eq!(a.knots().domain(), b.knots().domain());
        for t in places(a) {
            assert!(a.de_boor(t).distance(b.de_boor(t)) < 1e-12, "{t}");
        }
    }

    #[test]
    fn de_boor_is_the_sum_of_the_basis() {
        for spline in splines() {
            for t in places(&spline) {
                let (first, functions) = spline.knots().basis(t);
                let points = &spline.points()[first..];
                let sum: DVec3 = functions.iter().zip(points).map(|(f, point)| *point * f[0]).sum();
                assert!(spline.de_boor(t).distance(sum) < 1e-13);
            }
        }
    }

    #[test]
    fn bezier_pieces_and_the_way_back_are_the_same_curve() {
        for spline in splines() {
            let degree = spline.knots().degree();
            let (points, breaks) = spline.to_bezier();
            for (k, pair) in breaks.windows(2).enumerate() {
                let piece = &points[k * degree..=(k + 1) * degree];
                for step in 0..=6 {
                    let share = f64::from(step) / 6.0;
                    let t = pair[0] + (pair[1] - pair[0]) * share;
                    assert!(de_casteljau(piece, share).distance(spline.de_boor(t)) < 1e-12);
                }
            }
            assert_same(&spline, &BSpline::from_bezier(degree, points, &breaks).unwrap());
        }
    }

    #[test]
    fn more_knots_and_higher_degrees_are_the_same_curve() {
        for spline in splines() {
            let (start, end) = spline.knots().domain();
            let mut finer = spline.clone();
            for share in [0.5, 0.37, 0.37, 0.9, 0.01] {
                match finer.insert(start + (end - start) * share) {
                    Ok(inserted) => finer = inserted,
                    Err(error) => assert!(matches!(error, KnotError::Multiplicity { .. })),
                }
            }
            assert_same(&spline, &finer);
            let raised = spline.elevated();
            assert_eq!(raised.knots().degree(), spline.knots().degree() + 1);
            assert_same(&spline, &raised);
            assert_same(&finer, &finer.elevated().elevated());
        }
    }

    /// Inserted as often as the degree allows, a knot splits the curve: its control points are Bezier points.
    #[test]
    fn full_insertion_is_the_bezier_form() {
        for spline in splines() {
            let (p, (_, end)) = (spline.knots().degree(), spline.knots().domain());
            let (bezier, breaks) = spline.to_bezier();
            let mut full = spline.clone();
            for knot in breaks.iter().filter(|knot| **knot < end) {
                while full.knots().multiplicity(*knot) < p {
                    full = full.insert(*knot).unwrap();
                }
            }
            let first = full.knots().span(breaks[0]) - p;
            for (k, point) in bezier[..bezier.len() - p].iter().enumerate() {
                assert!(full.points()[first + k].distance(*point) < 1e-12, "degree {p}, point {k}");
            }
        }
    }

    #[test]
    fn a_reversed_spline_runs_backwards() {
        for spline in splines() {
            let (start, end) = spline.knots().domain();
            let back = spline.reversed();
            for t in places(&spline) {
                assert!(back.de_boor(start + (end - t)).distance(spline.de_boor(t)) < 1e-12);
            }
            assert_same(&spline, &back.reversed());
        }
    }

    #[test]
    fn closed_splines_meet_and_weigh_point_by_point() {
        let spline = BSpline::closed(3, &points(6), &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        assert!(spline.de_boor(0.0).distance(spline.de_boor(6.0)) < 1e-14);
        let p = points(6);
        assert!(spline.de_boor(0.0).distance((p[0] + p[1] * 4.0 + p[2]) / 6.0) < 1e-14);
    }
}
