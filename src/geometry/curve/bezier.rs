//! Bezier curves of any degree, and splines made of them.
//!
//! Sources: P. de Casteljau's algorithm and the hull property as in G. Farin, Curves and Surfaces for CAGD,
//! 5th ed. 2002, ch. 4 to 5; the chord bound is the second-difference bound of D. Filip, R. Magedson,
//! R. Markot, Surface algorithms using bounds on derivatives, CAGD 3 (1986), applied to the components
//! across the chord.

use glam::DVec3;
use thiserror::Error;

use super::{Curve, Domain, Jet, Side};

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
/// Evaluation costs O(degree^2); finding the piece O(log pieces).
#[derive(Clone, Debug, PartialEq)]
pub struct BezierSpline {
    degree: usize,
    points: Vec<DVec3>,
    knots: Vec<f64>,
    joints: Vec<f64>,
    closed: bool,
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
        if knots.len() != (count - 1) / degree + 1 || knots.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(BezierError::Knots);
        }
        let closed = points[0] == points[count - 1];
        let mut spline = Self { degree, points, knots, joints: Vec::new(), closed };
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

    fn find_joints(&self) -> Vec<f64> {
        // Directions that agree to this sine come from a smooth construction: rounding alone leaves about
        // 1e-14, a corner a person means starts far above.
        const SAME_DIRECTION: f64 = 1e-9;
        let inner = &self.knots[1..self.knots.len() - 1];
        let jumps = |t: &f64| {
            let before = self.direction(*t, Side::Before);
            let after = self.direction(*t, Side::After);
            before.cross(after).length() > SAME_DIRECTION || before.dot(after) < 0.0
        };
        inner.iter().copied().filter(jumps).collect()
    }

    fn piece(&self, index: usize) -> &[DVec3] {
        &self.points[index * self.degree..=(index + 1) * self.degree]
    }

    fn locate(&self, t: f64, side: Side) -> usize {
        let inner = &self.knots[1..self.knots.len() - 1];
        match side {
            Side::After => inner.partition_point(|knot| *knot <= t),
            Side::Before => inner.partition_point(|knot| *knot < t),
        }
    }

    /// Local parameter of `t` in piece `index`, 0 to 1.
    fn local(&self, index: usize, t: f64) -> f64 {
        let (start, end) = (self.knots[index], self.knots[index + 1]);
        ((t - start) / (end - start)).clamp(0.0, 1.0)
    }

    /// Bound for the part of one piece between local parameters.
    fn piece_deviation(&self, index: usize, from: f64, to: f64) -> f64 {
        let mut inline = [DVec3::ZERO; INLINE];
        let mut heap = Vec::new();
        let buffer = scratch(&mut inline, &mut heap, self.piece(index));
        restrict(buffer, from, to);
        deviation_of_control_polygon(buffer)
    }
}

impl Curve for BezierSpline {
    fn domain(&self) -> Domain {
        Domain { start: self.knots[0], end: self.knots[self.knots.len() - 1] }
    }

    fn is_closed(&self) -> bool {
        self.closed
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        let index = self.locate(t, side);
        let span = self.knots[index + 1] - self.knots[index];
        let jet = evaluate_bezier(self.piece(index), self.local(index, t));
        Jet { point: jet.point, first: jet.first / span, second: jet.second / (span * span) }
    }

    fn joints(&self) -> Vec<f64> {
        self.joints.clone()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let (first, last) = (self.locate(from, Side::After), self.locate(to, Side::Before));
        if first >= last {
            return self.piece_deviation(first, self.local(first, from), self.local(first, to));
        }
        let chord = (self.point(from), self.evaluate(to, Side::Before).point);
        let mut deviation = 0.0_f64;
        let mut previous = 0.0;
        for index in first..=last {
            let (start, end) = (self.local(index, from), self.local(index, to));
            let reached = if index == last { chord.1 } else { self.piece(index)[self.degree] };
            let distance = distance_to_segment(reached, chord);
            deviation = deviation.max(distance.max(previous) + self.piece_deviation(index, start, end));
            previous = distance;
        }
        deviation
    }
}

/// Distance from a point to a segment.
pub(super) fn distance_to_segment(point: DVec3, (start, end): (DVec3, DVec3)) -> f64 {
    let along = end - start;
    let square = along.length_squared();
    let place = if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(start + along * place)
}

/// Degrees up to this are evaluated without an allocation.
const INLINE: usize = 8;

fn scratch<'a>(
    inline: &'a mut [DVec3; INLINE],
    heap: &'a mut Vec<DVec3>,
    points: &[DVec3],
) -> &'a mut [DVec3] {
    if points.len() <= INLINE {
        inline[..points.len()].copy_from_slice(points);
        &mut inline[..points.len()]
    } else {
        heap.extend_from_slice(points);
        heap.as_mut_slice()
    }
}

/// Point and derivatives of one Bezier piece at `t` in 0 to 1, by de Casteljau's scheme.
pub(super) fn evaluate_bezier(points: &[DVec3], t: f64) -> Jet {
    let mut inline = [DVec3::ZERO; INLINE];
    let mut heap = Vec::new();
    let b = scratch(&mut inline, &mut heap, points);
    let degree = b.len() - 1;
    let (mut first, mut second) = (DVec3::ZERO, DVec3::ZERO);
    for level in (1..=degree).rev() {
        if level == 2 {
            second = (b[2] - 2.0 * b[1] + b[0]) * (degree * (degree - 1)) as f64;
        }
        if level == 1 {
            first = (b[1] - b[0]) * degree as f64;
        }
        for k in 0..level {
            b[k] = b[k] * (1.0 - t) + b[k + 1] * t;
        }
    }
    Jet { point: b[0], first, second }
}

/// Replaces control points by those of the part from `from` to `to` (0 to 1), by two de Casteljau cuts.
fn restrict(b: &mut [DVec3], from: f64, to: f64) {
    let degree = b.len() - 1;
    if to < 1.0 {
        for level in 1..=degree {
            for k in (level..=degree).rev() {
                b[k] = b[k - 1] * (1.0 - to) + b[k] * to;
            }
        }
    }
    if from > 0.0 && to > 0.0 {
        let cut = from / to;
        for level in 1..=degree {
            for k in 0..=degree - level {
                b[k] = b[k] * (1.0 - cut) + b[k + 1] * cut;
            }
        }
    }
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
                .map(|point| super::distance_to_segment(point, chord))
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
