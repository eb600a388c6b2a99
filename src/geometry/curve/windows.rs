//! Cubic pieces by a basis matrix over windows of points: beta-splines and cubics of any basis.

use glam::DVec3;

use super::control::BasisMatrix;
use super::{BezierError, BezierSpline};

/// Pieces over windows of four points, each `step` points after the one before, over unit intervals. Windows of a
/// closed curve run on over the first points.
///
/// A piece begins at the bit where the one before ends; that they do but for rounding is the caller's to know.
///
/// # Errors
/// When there are fewer than four points, or three when closed.
pub fn windows(
    basis: &BasisMatrix,
    points: &[DVec3],
    step: usize,
    closed: bool,
) -> Result<BezierSpline, BezierError> {
    let count = points.len();
    if count < if closed { 3 } else { 4 } || step == 0 {
        return Err(BezierError::Count { points: count, degree: 3 });
    }
    let last = if closed { count } else { count - 3 };
    let window = |start: usize| [0, 1, 2, 3].map(|k| points[(start + k) % count]);
    let mut control: Vec<DVec3> = Vec::new();
    for start in (0..last).step_by(step) {
        let piece = basis.to_bezier(&window(start));
        control.extend(&piece[usize::from(!control.is_empty())..]);
    }
    if closed {
        let last = control.len() - 1;
        control[last] = control[0];
    }
    BezierSpline::new(3, control)
}

/// The uniform beta-spline of control points: joints have one direction and one curvature (G2); the speed after
/// each joint is `bias` times that before. Its pieces cover unit intervals.
///
/// With `through_ends` an open curve runs from the first to the last point: the polygon is continued by the points
/// that make it so, `p[-1] = p[0] + (p[0] - p[1]) / bias^3` and `p[n] = p[n - 1] + (p[n - 1] - p[n - 2]) bias^3`,
/// which are reflections where the bias is 1. Source: B. Barsky, Computer Graphics and Geometric Modeling Using
/// Beta-splines, 1988.
///
/// # Errors
/// When there are too few points: four, three when closed, two with `through_ends`.
pub fn beta_spline(
    points: &[DVec3],
    (bias, tension): (f64, f64),
    closed: bool,
    through_ends: bool,
) -> Result<BezierSpline, BezierError> {
    let basis = BasisMatrix::beta(bias, tension);
    if closed || !through_ends || points.len() < 2 {
        return windows(&basis, points, 1, closed);
    }
    let count = points.len();
    let cube = bias * bias * bias;
    let before = points[0] + (points[0] - points[1]) / cube;
    let after = points[count - 1] + (points[count - 1] - points[count - 2]) * cube;
    let continued = [&[before], points, &[after]].concat();
    let spline = windows(&basis, &continued, 1, false)?;
    let mut control = spline.control_points().to_vec();
    let end = control.len() - 1;
    (control[0], control[end]) = (points[0], points[count - 1]);
    BezierSpline::new(3, control)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{beta_spline, windows};
    use crate::geometry::curve::control::{BSpline, BasisMatrix, Knots};
    use crate::geometry::curve::{Continuity, Curve, Meeting, Side};

    fn points() -> Vec<DVec3> {
        [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (2.2, 2.5), (0.7, 2.2), (-0.6, 1.4)]
            .map(|(x, y)| DVec3::new(x, y, 0.3 * x))
            .to_vec()
    }

    #[test]
    fn a_beta_spline_is_g2_with_the_ratio_of_speeds() {
        for (bias, tension) in [(1.0, 0.0), (2.0, 0.0), (0.4, 7.0), (1.0, 50.0)] {
            for closed in [false, true] {
                let curve = beta_spline(&points(), (bias, tension), closed, true).unwrap();
                assert!(curve.joints().is_empty(), "{bias} {tension}: {:?}", curve.joints());
                for t in curve.breaks() {
                    let (before, after) = (curve.evaluate(t, Side::Before), curve.evaluate(t, Side::After));
                    let ratio = after.first.length() / before.first.length();
                    assert!((ratio / bias - 1.0).abs() < 1e-12, "{ratio}");
                    let expected =
                        if bias == 1.0 && tension == 0.0 { Continuity::C2 } else { Continuity::G2 };
                    let found = Meeting::of(&curve, t, t, 5.0).continuity();
                    assert!(found == expected || (bias == 1.0 && found == Continuity::G2), "{found:?}");
                }
                if !closed {
                    assert_eq!(curve.point(0.0), points()[0]);
                    assert_eq!(curve.evaluate(9.0, Side::Before).point, points()[5]);
                }
            }
        }
    }

    #[test]
    fn bias_one_without_tension_is_the_b_spline() {
        let curve = beta_spline(&points(), (1.0, 0.0), false, false).unwrap();
        let spline = BSpline::new(Knots::uniform(3, 6).unwrap(), points()).unwrap();
        for step in 0..=30 {
            let t = f64::from(step) / 10.0;
            assert!(curve.point(t).distance(spline.de_boor(3.0 + t)) < 1e-14);
        }
    }

    #[test]
    fn much_tension_draws_the_curve_to_its_points() {
        let curve = beta_spline(&points(), (1.0, 1e6), true, false).unwrap();
        for (k, point) in points().iter().enumerate() {
            let place = ((k + 5) % 6) as f64;
            assert!(curve.point(place).distance(*point) < 1e-4);
        }
    }

    #[test]
    fn windows_step_over_the_points() {
        let bezier =
            windows(&BasisMatrix::BEZIER, &[points(), points()[..1].to_vec()].concat(), 3, false).unwrap();
        assert_eq!(bezier.control_points().len(), 7);
        assert!(bezier.control_points()[2].distance(points()[2]) < 1e-14);
        assert!(windows(&BasisMatrix::BEZIER, &points()[..3], 3, false).is_err());
    }
}
