//! Bezier curves of any degree, and splines made of them.
//!
//! Sources: P. de Casteljau's algorithm and the hull property as in G. Farin, Curves and Surfaces for CAGD,
//! 5th ed. 2002, ch. 4 to 5; the chord bound is the second-difference bound of D. Filip, R. Magedson,
//! R. Markot, Surface algorithms using bounds on derivatives, CAGD 3 (1986), applied to the components
//! across the chord.

use glam::DVec3;
use thiserror::Error;

use super::control::{self, hodograph, jet, stops, with_part};
use super::pieces::{Pieces, direction_within, turns};
use super::{Curve, Domain, Jet, Side};
use crate::geometry::number::Bounds;

/// Why control points do not make a Bezier spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum BezierError {
    /// The degree is zero.
    #[error("the degree must be at least 1")]
    Degree,
    /// The count does not fit the degree.
    #[error("{points} control points do not make pieces of degree {degree}")]
    Count {
        /// Number of control points.
        points: usize,
        /// Degree of each piece.
        degree: usize,
    },
    /// The knots do not fit.
    #[error("knots must increase and be one more than the pieces")]
    Knots,
}

/// Pieces of one degree, each sharing its end point with the next; piece k covers knots k to k + 1.
///
/// Joints are the knots where the direction jumps, and the cusps inside pieces: where the derivative vanishes
/// for an instant and the curve turns. Evaluation costs O(degree^2); finding the piece O(log pieces).
#[derive(Clone, Debug, PartialEq)]
pub struct BezierSpline {
    degree: usize,
    points: Vec<DVec3>,
    pieces: Pieces,
    joints: Vec<f64>,
}

impl BezierSpline {
    /// Pieces over unit intervals 0, 1, 2, ...
    ///
    /// # Errors
    /// When the count of points is not a multiple of the degree plus one.
    pub fn new(degree: usize, points: Vec<DVec3>) -> Result<Self, BezierError> {
        let pieces = points.len().saturating_sub(1).checked_div(degree).unwrap_or(0);
        let knots = (0..=pieces).map(|knot| knot as f64).collect();
        Self::with_knots(degree, points, knots)
    }

    /// Pieces over given knots.
    ///
    /// # Errors
    /// When counts do not fit or the knots do not increase.
    pub fn with_knots(degree: usize, points: Vec<DVec3>, knots: Vec<f64>) -> Result<Self, BezierError> {
        if degree == 0 {
            return Err(BezierError::Degree);
        }
        let count = points.len();
        if count < degree + 1 || !(count - 1).is_multiple_of(degree) {
            return Err(BezierError::Count { points: count, degree });
        }
        if knots.len() != (count - 1) / degree + 1 {
            return Err(BezierError::Knots);
        }
        let pieces = Pieces::new(knots).ok_or(BezierError::Knots)?;
        let mut spline = Self { degree, points, pieces, joints: Vec::new() };
        spline.joints = spline.find_joints();
        Ok(spline)
    }

    /// Degree of the pieces.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Control points of all pieces; ends of neighbours stand once.
    #[must_use]
    pub fn control_points(&self) -> &[DVec3] {
        &self.points
    }

    /// The parameters at which pieces begin and end.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        self.pieces.breaks()
    }

    /// Control points of one piece.
    #[must_use]
    pub fn piece(&self, index: usize) -> &[DVec3] {
        &self.points[index * self.degree..=(index + 1) * self.degree]
    }

    /// The same curve one degree higher.
    #[must_use]
    pub fn elevated(&self) -> Self {
        let mut points = vec![self.points[0]];
        for index in 0..self.pieces.count() {
            points.extend(control::elevate(self.piece(index)).into_iter().skip(1));
        }
        Self { degree: self.degree + 1, points, ..self.clone() }
    }

    /// The parts before and after a parameter strictly inside the domain, by de Casteljau's scheme; `None` at the
    /// ends and outside.
    #[must_use]
    pub fn split(&self, t: f64) -> Option<(Self, Self)> {
        let domain = self.domain();
        if !(t > domain.start && t < domain.end) {
            return None;
        }
        let index = self.pieces.locate(t, Side::Before);
        let (left, right) = control::split(self.piece(index), self.pieces.local(index, t));
        let (start, end) = (index * self.degree, (index + 1) * self.degree);
        let breaks = self.pieces.breaks();
        let before = [&self.points[..start], &left].concat();
        let before = Self::with_knots(self.degree, before, [&breaks[..=index], &[t]].concat()).ok()?;
        // At a break nothing is left of the piece that ends there.
        let rest = if breaks[index + 1] <= t {
            (self.points[end..].to_vec(), breaks[index + 1..].to_vec())
        } else {
            ([&right, &self.points[end + 1..]].concat(), [&[t], &breaks[index + 1..]].concat())
        };
        Some((before, Self::with_knots(self.degree, rest.0, rest.1).ok()?))
    }

    /// One curve of two, where the second begins at the point and the parameter at which the first ends; `None`
    /// where it does not, or where the degrees differ.
    #[must_use]
    pub fn join(&self, next: &Self) -> Option<Self> {
        let meets =
            self.points[self.points.len() - 1] == next.points[0] && self.domain().end == next.domain().start;
        if !meets || self.degree != next.degree {
            return None;
        }
        let points = [&self.points[..], &next.points[1..]].concat();
        Self::with_knots(self.degree, points, [self.knots(), &next.knots()[1..]].concat()).ok()
    }

    fn find_joints(&self) -> Vec<f64> {
        let mut joints = Vec::new();
        for index in 0..self.pieces.count() {
            if index > 0 {
                joints.push(self.pieces.breaks()[index]);
            }
            let cusps = stops(&hodograph(self.piece(index)));
            joints.extend(cusps.into_iter().map(|local| self.pieces.parameter(index, local)));
        }
        joints.retain(|t| turns(self.direction(*t, Side::Before), self.direction(*t, Side::After)));
        joints
    }

    fn local_jet(&self, index: usize, local: f64) -> Jet {
        let [point, first, second] = jet(self.piece(index), local);
        Jet { point, first, second }
    }

    /// Bound for the part of one piece between local parameters.
    fn piece_deviation(&self, index: usize, from: f64, to: f64) -> f64 {
        with_part(self.piece(index), (from, to), deviation_of_control_polygon)
    }

    /// The hull of the second derivative over a part of one piece: its control points are the second
    /// differences of those of the piece.
    fn second_hull(&self, index: usize, from: f64, to: f64) -> Bounds {
        if self.degree < 2 {
            return Bounds::of_points([DVec3::ZERO]);
        }
        let second = hodograph(&hodograph(self.piece(index)));
        let rate = 1.0 / (self.pieces.span(index) * self.pieces.span(index));
        with_part(&second, (from, to), |part| Bounds::of_points(part.iter().map(|point| *point * rate)))
    }
}

impl Curve for BezierSpline {
    fn domain(&self) -> Domain {
        self.pieces.domain()
    }

    fn is_closed(&self) -> bool {
        self.points[0] == self.points[self.points.len() - 1]
    }

    #[inline]
    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let index = self.pieces.locate(t, side);
        self.pieces.scaled(index, &self.local_jet(index, self.pieces.local(index, t)))
    }

    fn tangents(&self, parameters: &[f64], side: Side, found: &mut [(DVec3, DVec3)]) {
        let mut index = 0;
        for (t, found) in parameters.iter().zip(found) {
            if !self.pieces.holds(index, *t, side) {
                index = self.pieces.locate(*t, side);
            }
            let local = self.local_jet(index, self.pieces.local(index, *t));
            let jet = self.pieces.scaled(index, &local);
            *found = (jet.point, jet.first);
        }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.clone()
    }

    fn breaks(&self) -> Vec<f64> {
        merged(self.pieces.inner(), &self.joints)
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        self.pieces.chord_deviation(
            (from, to),
            |index, local| self.local_jet(index, local).point,
            |index, start, end| self.piece_deviation(index, start, end),
        )
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let index = self.pieces.locate(t, side);
        let local = self.pieces.local(index, t);
        let piece = self.piece(index);
        let leading = |at_end: bool| {
            let origin = piece[if at_end { self.degree } else { 0 }];
            let ways = piece.iter().map(|point| *point - origin);
            if at_end { ways.rev().collect() } else { ways.collect() }
        };
        direction_within(&self.local_jet(index, local), local, side, leading).unwrap_or(DVec3::X)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let pieces = &self.pieces;
        let (first, last) = (pieces.locate(from, Side::After), pieces.locate(to, Side::Before));
        let hull = |index: usize| self.second_hull(index, pieces.local(index, from), pieces.local(index, to));
        let hulls = (first..=last.max(first)).map(hull);
        Some(hulls.fold(Bounds::EMPTY, Bounds::union))
    }
}

/// Two increasing lists as one, equal numbers once.
pub(super) fn merged(one: &[f64], other: &[f64]) -> Vec<f64> {
    let mut all = [one, other].concat();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Bound on the distance between a Bezier piece and the chord of its ends.
///
/// The component of the curve across the chord is a polynomial that vanishes at both ends, so it is at most
/// one eighth of its greatest second derivative. Where the control polygon turns back along the chord the
/// whole second difference counts, since the curve may then leave the chord lengthwise.
fn deviation_of_control_polygon(b: &[DVec3]) -> f64 {
    let degree = b.len() - 1;
    if degree < 2 {
        return 0.0;
    }
    let chord = b[degree] - b[0];
    let direction = chord.normalize_or_zero();
    let length = chord.length();
    let inside = b.iter().all(|point| {
        let place = (*point - b[0]).dot(direction);
        place >= -1e-12 * length && place <= length * (1.0 + 1e-12)
    });
    let across = |vector: DVec3| if inside { vector - direction * vector.dot(direction) } else { vector };
    let greatest = b
        .windows(3)
        .map(|run| across(run[2] - 2.0 * run[1] + run[0]).length_squared())
        .fold(0.0, f64::max)
        .sqrt();
    greatest * (degree * (degree - 1)) as f64 / 8.0
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{BezierError, BezierSpline};
    use crate::geometry::curve::pieces::distance_to_segment;
    use crate::geometry::curve::{Curve, Side};

    fn wave() -> BezierSpline {
        let points = [(0.0, 0.0), (1.0, 2.0), (3.0, -1.0), (4.0, 1.0), (5.0, 3.0), (5.0, 4.0), (6.0, 2.0)];
        BezierSpline::new(3, points.map(|(x, y)| DVec3::new(x, y, 0.3 * x * y)).to_vec()).unwrap()
    }

    #[test]
    fn matches_bernstein_polynomials() {
        let curve = wave();
        let p = curve.control_points();
        for step in 0..=20 {
            let t = f64::from(step) / 20.0;
            let s = 1.0 - t;
            let expected =
                p[0] * (s * s * s) + p[1] * (3.0 * s * s * t) + p[2] * (3.0 * s * t * t) + p[3] * (t * t * t);
            assert!(curve.evaluate(t, Side::Before).point.distance(expected) < 1e-14);
        }
    }

    #[test]
    fn a_corner_is_a_joint_and_a_smooth_knot_is_not() {
        assert_eq!(wave().joints(), vec![1.0]);
        let smooth = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, -1.0), (4.0, 0.0)];
        let smooth = BezierSpline::new(2, smooth.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec()).unwrap();
        assert!(smooth.joints().is_empty());
    }

    #[test]
    fn chord_bound_holds_and_is_sharp() {
        let curve = wave();
        for (from, to) in [(0.0, 1.0), (0.1, 0.3), (0.5, 0.51), (1.2, 1.9), (1.0, 2.0)] {
            let bound = curve.chord_deviation(from, to);
            let chord = (curve.point(from), curve.evaluate(to, Side::Before).point);
            let worst = (0..=1000)
                .map(|step| curve.evaluate(from + (to - from) * f64::from(step) / 1000.0, Side::Before).point)
                .map(|point| distance_to_segment(point, chord))
                .fold(0.0, f64::max);
            assert!(worst <= bound * (1.0 + 1e-12), "{from} {to}: {worst} > {bound}");
            assert!(bound < 6.0 * worst, "{from} {to}: {bound} is loose for {worst}");
        }
    }

    #[test]
    fn ranges_over_several_pieces_are_bounded() {
        let points: Vec<DVec3> = (0..=40)
            .map(|k| {
                let angle = f64::from(k) * 0.05;
                DVec3::new(crate::geometry::number::cos(angle), crate::geometry::number::sin(angle), 0.0)
            })
            .collect();
        let curve =
            crate::geometry::curve::interpolate(&points, &(0..=40).map(f64::from).collect::<Vec<_>>())
                .unwrap();
        let bound = curve.chord_deviation(0.0, 40.0);
        let sagitta = 1.0 - crate::geometry::number::cos(1.0);
        assert!(bound >= sagitta * (1.0 - 1e-6) && bound < sagitta * 1.01, "{bound} against {sagitta}");
    }

    #[test]
    fn wrong_counts_are_errors() {
        assert_eq!(BezierSpline::new(0, vec![DVec3::ZERO]), Err(BezierError::Degree));
        let three = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(BezierSpline::new(3, three), Err(BezierError::Count { points: 3, degree: 3 }));
    }
}
