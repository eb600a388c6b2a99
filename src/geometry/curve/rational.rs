//! Rational Bezier pieces: what NURBS and rational Hermite curves come down to.
//!
//! Homogeneous control points are (w x, w y, w z, w). A weight of zero puts the point at infinity in the
//! direction of the first three numbers: two such points and two finite ones make a full circle of degree 2.
//!
//! Sources: G. Farin, NURBS: From Projective Geometry to Practical Use, 2nd ed. 1999; L. Piegl, W. Tiller, A
//! menagerie of rational B-spline circles, IEEE CG&A 9 (1989). The chord bound is of this code; its proof stands
//! with [`deviation_of_control_polygon`].

use glam::{DVec3, DVec4};
use thiserror::Error;

use super::bezier::{BezierError, merged};
use super::control::{hodograph, jet, product, stops, with_part};
use super::pieces::{Pieces, direction_within, distance_to_segment, turns};
use super::{Curve, Domain, Jet, Side};

/// Why homogeneous control points do not make a rational curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum RationalError {
    /// The counts do not fit.
    #[error(transparent)]
    Shape(#[from] BezierError),
    /// A weight is negative or not a number.
    #[error("the weight of Bezier point {index} is negative")]
    Negative {
        /// Index of the point.
        index: usize,
    },
    /// An end of a piece has no weight: the curve runs to infinity.
    #[error("the curve runs to infinity where piece {piece} begins")]
    Infinite {
        /// The piece that begins there; one more than there are where the last one ends.
        piece: usize,
    },
}

/// Rational pieces of one degree, each sharing its homogeneous end point with the next.
///
/// All weights are at least zero and those at the ends of pieces greater, which keeps the curve finite. Joints are
/// as in [`BezierSpline`](super::BezierSpline). Evaluation costs O(degree^2); finding the piece O(log pieces).
#[derive(Clone, Debug, PartialEq)]
pub struct RationalSpline {
    degree: usize,
    points: Vec<DVec4>,
    pieces: Pieces,
    joints: Vec<f64>,
}

impl RationalSpline {
    /// Pieces over given knots from homogeneous control points; ends of neighbours stand once.
    ///
    /// # Errors
    /// When counts do not fit, knots do not increase, or weights are negative or missing at the end of a piece.
    pub fn new(degree: usize, points: Vec<DVec4>, knots: Vec<f64>) -> Result<Self, RationalError> {
        let count = points.len();
        if degree == 0 {
            return Err(BezierError::Degree.into());
        }
        if count < degree + 1 || !(count - 1).is_multiple_of(degree) {
            return Err(BezierError::Count { points: count, degree }.into());
        }
        if knots.len() != (count - 1) / degree + 1 {
            return Err(BezierError::Knots.into());
        }
        let pieces = Pieces::new(knots).ok_or(BezierError::Knots)?;
        if let Some(index) = points.iter().position(|point| point.w.is_nan() || point.w < 0.0) {
            return Err(RationalError::Negative { index });
        }
        if let Some(piece) = points.iter().step_by(degree).position(|point| point.w == 0.0) {
            return Err(RationalError::Infinite { piece });
        }
        let mut spline = Self { degree, points, pieces, joints: Vec::new() };
        spline.joints = spline.find_joints();
        Ok(spline)
    }

    /// A homogeneous control point: `point` with a weight, or, with weight 0, the point at infinity in the
    /// direction `point`.
    #[must_use]
    pub fn homogeneous(point: DVec3, weight: f64) -> DVec4 {
        if weight == 0.0 { point.extend(0.0) } else { (point * weight).extend(weight) }
    }

    /// Degree of the pieces.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Homogeneous control points of all pieces; ends of neighbours stand once.
    #[must_use]
    pub fn control_points(&self) -> &[DVec4] {
        &self.points
    }

    /// The parameters at which pieces begin and end.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        self.pieces.breaks()
    }

    /// Homogeneous control points of one piece.
    #[must_use]
    pub fn piece(&self, index: usize) -> &[DVec4] {
        &self.points[index * self.degree..=(index + 1) * self.degree]
    }

    fn local_jet(&self, index: usize, local: f64) -> Jet {
        let [value, first, second] = jet(self.piece(index), local);
        let inverse = 1.0 / value.w;
        let point = value.truncate() * inverse;
        let first_derivative = (first.truncate() - point * first.w) * inverse;
        let second_derivative =
            (second.truncate() - first_derivative * (2.0 * first.w) - point * second.w) * inverse;
        Jet { point, first: first_derivative, second: second_derivative }
    }

    fn find_joints(&self) -> Vec<f64> {
        let mut joints = Vec::new();
        for index in 0..self.pieces.count() {
            if index > 0 {
                joints.push(self.pieces.breaks()[index]);
            }
            let cusps = stops(&velocity(self.piece(index)));
            joints.extend(cusps.into_iter().map(|local| self.pieces.parameter(index, local)));
        }
        joints.retain(|t| turns(self.direction(*t, Side::Before), self.direction(*t, Side::After)));
        joints
    }
}

impl Curve for RationalSpline {
    fn domain(&self) -> Domain {
        self.pieces.domain()
    }

    fn is_closed(&self) -> bool {
        let project = |point: DVec4| point.truncate() / point.w;
        project(self.points[0]) == project(self.points[self.points.len() - 1])
    }

    #[inline]
    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let index = self.pieces.locate(t, side);
        self.pieces.scaled(index, &self.local_jet(index, self.pieces.local(index, t)))
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
            |index, start, end| with_part(self.piece(index), (start, end), deviation_of_control_polygon),
        )
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let index = self.pieces.locate(t, side);
        let local = self.pieces.local(index, t);
        let piece = self.piece(index);
        let leading = |at_end: bool| {
            let end = piece[if at_end { self.degree } else { 0 }];
            let origin = end.truncate() / end.w;
            let ways = piece.iter().map(|point| point.truncate() - origin * point.w);
            if at_end { ways.rev().collect() } else { ways.collect() }
        };
        direction_within(&self.local_jet(index, local), local, side, leading).unwrap_or(DVec3::X)
    }
}

/// The derivative of a rational piece up to a positive factor, in Bernstein form: A' w - A w' for the curve
/// A / w. The origin is moved to the start first, so that less cancels.
fn velocity(piece: &[DVec4]) -> Vec<DVec3> {
    let start = piece[0].truncate() / piece[0].w;
    let numerator: Vec<DVec3> = piece.iter().map(|point| point.truncate() - start * point.w).collect();
    let weights: Vec<f64> = piece.iter().map(|point| point.w).collect();
    let gained = product(&hodograph(&numerator), &weights);
    let lost = product(&numerator, &hodograph(&weights));
    gained.into_iter().zip(lost).map(|(gain, loss)| gain - loss).collect()
}

/// Bound on the distance between a rational piece and the chord of its ends.
///
/// With weights `w[i]` >= 0, Bernstein polynomials `B[i]` and W the sum of `w[i] B[i]`, the curve is a convex
/// combination of its finite control points, moved by the sum of `B[i] V[i]` / W for the directions `V[i]` of those
/// at infinity. The distance to a segment is a convex function, so that of the curve is at most E / W, where E is
/// the sum of `e[i] B[i]` and `e[i]` is `w[i]` times the distance of control point i from the chord, or the length
/// of `V[i]`; it is zero at both ends. Then
///
/// - the inner `B[i]` add to 1 - q with q = `B[0] + B[n]` >= 2^(1 - n), so E / W is at most
///   e (1 - q) / (q v + (1 - q) w) with e the greatest `e[i]`, v the lesser weight of the ends and w the least
///   inner weight; this falls with q;
/// - E vanishes at both ends, so it is at most one eighth of its greatest second derivative, which is at most
///   n (n - 1) times the greatest second difference of the `e[i]`; W is at least the denominator above.
///
/// The first is sharp on long arcs, the second in the limit of short ones.
fn deviation_of_control_polygon(b: &[DVec4]) -> f64 {
    let degree = b.len() - 1;
    if degree < 2 {
        return 0.0;
    }
    let project = |point: DVec4| point.truncate() / point.w;
    let chord = (project(b[0]), project(b[degree]));
    let excess = |k: usize| match b[k] {
        _ if k == 0 || k == degree => 0.0,
        point if point.w == 0.0 => point.truncate().length(),
        point => point.w * distance_to_segment(project(point), chord),
    };
    let excess: Vec<f64> = (0..=degree).map(excess).collect();
    let greatest = excess.iter().copied().fold(0.0, f64::max);
    let bend = excess.windows(3).map(|run| (run[2] - 2.0 * run[1] + run[0]).abs()).fold(0.0, f64::max);
    let least = |range: &[DVec4]| range.iter().map(|point| point.w).fold(f64::INFINITY, f64::min);
    let ends = b[0].w.min(b[degree].w);
    let share = (1..degree).fold(1.0, |share, _| share / 2.0);
    let weight = share * ends + (1.0 - share) * least(&b[1..degree]);
    let by_hull = greatest * (1.0 - share);
    let by_bend = bend * (degree * (degree - 1)) as f64 / 8.0;
    by_hull.min(by_bend) / weight
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, DVec4};

    use super::{RationalError, RationalSpline};
    use crate::geometry::curve::pieces::distance_to_segment;
    use crate::geometry::curve::{Curve, Side, length};

    /// Four control points, two of them at infinity, and the first again.
    fn circle() -> RationalSpline {
        let points = vec![
            DVec4::new(1.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 1.0, 0.0, 0.0),
            DVec4::new(-1.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, -1.0, 0.0, 0.0),
            DVec4::new(1.0, 0.0, 0.0, 1.0),
        ];
        RationalSpline::new(2, points, vec![0.0, 1.0, 2.0]).unwrap()
    }

    fn waves() -> RationalSpline {
        let point = |x: f64, y: f64, z: f64, w: f64| RationalSpline::homogeneous(DVec3::new(x, y, z), w);
        let points = vec![
            point(0.0, 0.0, 0.0, 1.0),
            point(1.0, 2.0, 0.5, 0.2),
            point(2.0, -1.0, 1.0, 5.0),
            point(3.0, 1.0, 0.0, 1.5),
            point(4.0, 3.0, -1.0, 0.75),
            point(5.0, 0.0, 0.0, 0.0),
            point(6.0, 1.0, 1.0, 2.0),
        ];
        RationalSpline::new(3, points, vec![-1.0, 0.5, 4.0]).unwrap()
    }

    #[test]
    fn four_points_two_of_them_at_infinity_are_the_full_circle() {
        let circle = circle();
        assert!(circle.is_closed() && circle.joints().is_empty());
        for step in 0..=200 {
            let t = f64::from(step) / 100.0;
            let jet = circle.evaluate(t, Side::After);
            assert!((jet.point.length() - 1.0).abs() < 1e-15, "{t}");
            assert!(jet.point.dot(jet.first).abs() < 1e-15);
        }
        assert!((length(&circle) / core::f64::consts::TAU - 1.0).abs() < 1e-12);
        let half = circle.chord_deviation(0.0, 1.0);
        assert!((1.0..1.5).contains(&half), "{half}");
    }

    #[test]
    fn bounds_hold_and_are_sharp_on_short_arcs() {
        for curve in [circle(), waves()] {
            let domain = curve.domain();
            for (from, to) in [(0.0, 1.0), (0.0, 0.3), (0.1, 0.15), (0.6, 0.61), (0.48, 0.5), (0.2, 0.9)] {
                let (from, to) = (domain.at(from), domain.at(to));
                let bound = curve.chord_deviation(from, to);
                let point =
                    |t: f64| curve.evaluate(t, if t == to { Side::Before } else { Side::After }).point;
                let chord = (point(from), point(to));
                let worst = (0..=1000)
                    .map(|step| point(from + (to - from) * f64::from(step) / 1000.0))
                    .map(|point| distance_to_segment(point, chord))
                    .fold(0.0, f64::max);
                assert!(worst <= bound * (1.0 + 1e-12), "{from} {to}: {worst} > {bound}");
                let loose = if to - from < 0.2 { 1.1 } else { 12.0 };
                assert!(bound < loose * worst, "{from} {to}: {bound} is loose for {worst}");
            }
        }
    }

    /// Scaling all weights, or moving the parameter projectively, leaves the curve; the parameter moves.
    #[test]
    fn projective_changes_of_weights_leave_the_curve() {
        let curve = waves();
        let scaled = curve.control_points().iter().map(|point| *point * 3.7).collect();
        let scaled = RationalSpline::new(3, scaled, curve.knots().to_vec()).unwrap();
        for step in 0..=40 {
            let t = curve.domain().at(f64::from(step) / 40.0);
            assert!(scaled.point(t).distance(curve.point(t)) < 1e-14);
        }
        let first: Vec<DVec4> = curve.control_points()[..4].to_vec();
        let factor = 2.0_f64;
        let moved = first.iter().scan(1.0, |power, point| {
            let weighed = *point * *power;
            *power *= factor;
            Some(weighed)
        });
        let moved = RationalSpline::new(3, moved.collect(), vec![0.0, 1.0]).unwrap();
        let first = RationalSpline::new(3, first, vec![0.0, 1.0]).unwrap();
        for step in 0..=40 {
            let t = f64::from(step) / 40.0;
            let there = factor * t / (1.0 - t + factor * t);
            assert!(moved.point(t).distance(first.point(there)) < 1e-13);
        }
    }

    #[test]
    fn a_cusp_is_a_joint() {
        let point = |x: f64, y: f64, w: f64| RationalSpline::homogeneous(DVec3::new(x, y, 0.0), w);
        let points =
            vec![point(0.0, 0.0, 2.0), point(1.0, 1.0, 2.0), point(0.0, 1.0, 2.0), point(1.0, 0.0, 2.0)];
        let cusp = RationalSpline::new(3, points, vec![0.0, 2.0]).unwrap();
        assert_eq!(cusp.joints(), [1.0]);
        let (before, after) = (cusp.direction(1.0, Side::Before), cusp.direction(1.0, Side::After));
        assert!(before.distance(DVec3::Y) < 1e-12 && after.distance(-DVec3::Y) < 1e-12);
    }

    #[test]
    fn weights_that_lose_the_curve_are_errors() {
        let with = |weights: [f64; 3]| {
            let points = weights.map(|w| DVec4::new(1.0, 2.0 * w, 0.0, w));
            RationalSpline::new(2, points.to_vec(), vec![0.0, 1.0])
        };
        assert_eq!(with([1.0, -0.1, 1.0]), Err(RationalError::Negative { index: 1 }));
        assert_eq!(with([1.0, f64::NAN, 1.0]), Err(RationalError::Negative { index: 1 }));
        assert_eq!(with([0.0, 1.0, 1.0]), Err(RationalError::Infinite { piece: 0 }));
        assert_eq!(with([1.0, 1.0, 0.0]), Err(RationalError::Infinite { piece: 1 }));
    }
}
