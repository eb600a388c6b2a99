//! Interpolating cubic splines with two continuous derivatives.
//!
//! Open splines have natural ends (second derivative zero), closed ones are periodic. Source: C. de Boor,
//! A Practical Guide to Splines, rev. ed. 2001, ch. IV; parameters after E. Lee, Choosing nodes in parametric
//! curve interpolation, CAD 21 (1989). Both linear systems are diagonally dominant, so elimination without
//! pivoting is stable. Cost: O(points), memory the same.

use glam::DVec3;
use thiserror::Error;

use super::{BezierSpline, nielsen};

/// How parameters are given to the points of a spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parametrization {
    /// Equal steps of 1.
    Uniform,
    /// Steps as the distances between points.
    Chordal,
    /// Steps as the square roots of the distances.
    Centripetal,
    /// Steps that an affine map of the points does not change (Nielsen, Foley).
    Nielsen,
}

/// Why points do not make a spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum SplineError {
    /// Too few points.
    #[error("a spline needs at least {least} points, not {found}")]
    Few {
        /// Least number.
        least: usize,
        /// Number given.
        found: usize,
    },
    /// Two neighbours are equal.
    #[error("points {first} and {second} are equal")]
    Repeated {
        /// Index of the first of the two.
        first: usize,
        /// Index of the second.
        second: usize,
    },
    /// A list of parameters does not fit.
    #[error("{found} parameters were given where {expected} are needed")]
    Count {
        /// Number needed.
        expected: usize,
        /// Number given.
        found: usize,
    },
    /// Parameters do not increase.
    #[error("parameter {index} is not greater than the one before")]
    Order {
        /// Index of the parameter.
        index: usize,
    },
}

/// Parameters of `points`, from 0; a closed curve gets one more, for the return to the first point.
///
/// # Errors
/// When two neighbouring points are equal, whose step would be zero (not for uniform steps).
pub fn parameters(points: &[DVec3], closed: bool, rule: Parametrization) -> Result<Vec<f64>, SplineError> {
    let steps = if closed { points.len() } else { points.len().saturating_sub(1) };
    let mut parameters = vec![0.0];
    if rule == Parametrization::Nielsen && steps > 0 {
        for step in nielsen::steps(points, closed)? {
            parameters.push(parameters[parameters.len() - 1] + step);
        }
        return Ok(parameters);
    }
    for first in 0..steps {
        let second = (first + 1) % points.len();
        let distance = points[first].distance(points[second]);
        if distance == 0.0 && rule != Parametrization::Uniform {
            return Err(SplineError::Repeated { first, second });
        }
        let step = match rule {
            Parametrization::Uniform => 1.0,
            Parametrization::Chordal | Parametrization::Nielsen => distance,
            Parametrization::Centripetal => distance.sqrt(),
        };
        parameters.push(parameters[first] + step);
    }
    Ok(parameters)
}

pub(super) fn check(parameters: &[f64], expected: usize) -> Result<(), SplineError> {
    if parameters.len() != expected {
        return Err(SplineError::Count { expected, found: parameters.len() });
    }
    match parameters
        .windows(2)
        .position(|pair| pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less))
    {
        Some(before) => Err(SplineError::Order { index: before + 1 }),
        None => Ok(()),
    }
}

/// The natural cubic spline through `points` at `parameters`.
///
/// # Errors
/// For fewer than two points, a wrong number of parameters, or parameters that do not increase.
pub fn interpolate(points: &[DVec3], parameters: &[f64]) -> Result<BezierSpline, SplineError> {
    if points.len() < 2 {
        return Err(SplineError::Few { least: 2, found: points.len() });
    }
    check(parameters, points.len())?;
    let last = points.len() - 1;
    let steps: Vec<f64> = parameters.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut moments = vec![DVec3::ZERO; points.len()];
    if last > 1 {
        let inner = 1..last;
        let diagonal: Vec<f64> = inner.clone().map(|k| 2.0 * (steps[k - 1] + steps[k])).collect();
        let mut right: Vec<DVec3> = inner
            .map(|k| moment_right(points[k - 1], points[k], points[k + 1], steps[k - 1], steps[k]))
            .collect();
        let off: Vec<f64> = steps[1..last].to_vec();
        solve_tridiagonal(&off, diagonal, &mut right);
        moments[1..last].copy_from_slice(&right);
    }
    Ok(from_moments(points, parameters, &steps, &moments))
}

/// The periodic cubic spline through `points`; `parameters` has one more entry, for the return to the first.
///
/// # Errors
/// For fewer than two points, a wrong number of parameters, or parameters that do not increase.
pub fn interpolate_closed(points: &[DVec3], parameters: &[f64]) -> Result<BezierSpline, SplineError> {
    let count = points.len();
    if count < 2 {
        return Err(SplineError::Few { least: 2, found: count });
    }
    check(parameters, count + 1)?;
    let steps: Vec<f64> = parameters.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let before = |k: usize| (k + count - 1) % count;
    let after = |k: usize| (k + 1) % count;
    let diagonal: Vec<f64> = (0..count).map(|k| 2.0 * (steps[before(k)] + steps[k])).collect();
    let right: Vec<DVec3> = (0..count)
        .map(|k| moment_right(points[before(k)], points[k], points[after(k)], steps[before(k)], steps[k]))
        .collect();
    let mut moments = if count == 2 {
        // Both neighbours of a point are the other one: h (2 M[0] + M[1]) = right[0], with h of the whole period.
        let third = 1.0 / (3.0 * (steps[0] + steps[1]));
        vec![(right[0] * 2.0 - right[1]) * third, (right[1] * 2.0 - right[0]) * third]
    } else {
        solve_cyclic(&steps, &diagonal, right)
    };
    moments.push(moments[0]);
    let mut ring = points.to_vec();
    ring.push(points[0]);
    Ok(from_moments(&ring, parameters, &steps, &moments))
}

pub(super) fn moment_right(a: DVec3, b: DVec3, c: DVec3, step_before: f64, step_after: f64) -> DVec3 {
    ((c - b) / step_after - (b - a) / step_before) * 6.0
}

/// Solves the symmetric tridiagonal system with `off` beside the `diagonal`, in place in `right`.
fn solve_tridiagonal(off: &[f64], mut diagonal: Vec<f64>, right: &mut [DVec3]) {
    let count = diagonal.len();
    for k in 1..count {
        let factor = off[k - 1] / diagonal[k - 1];
        diagonal[k] -= factor * off[k - 1];
        let previous = right[k - 1];
        right[k] -= previous * factor;
    }
    right[count - 1] /= diagonal[count - 1];
    for k in (0..count - 1).rev() {
        let next = right[k + 1];
        right[k] = (right[k] - next * off[k]) / diagonal[k];
    }
}

/// Solves the cyclic system (`steps[k]` couples k and k + 1, the last couples back to the first) by the
/// Sherman-Morrison formula: a tridiagonal system plus a rank-one correction at the corners.
fn solve_cyclic(steps: &[f64], diagonal: &[f64], mut right: Vec<DVec3>) -> Vec<DVec3> {
    let count = diagonal.len();
    let corner = steps[count - 1];
    let gamma = -diagonal[0];
    let mut changed = diagonal.to_vec();
    changed[0] -= gamma;
    changed[count - 1] -= corner * corner / gamma;
    let off = &steps[..count - 1];
    solve_tridiagonal(off, changed.clone(), &mut right);
    let mut correction = vec![DVec3::ZERO; count];
    correction[0] = DVec3::splat(gamma);
    correction[count - 1] = DVec3::splat(corner);
    solve_tridiagonal(off, changed, &mut correction);
    let ratio = corner / gamma;
    let weight =
        (right[0] + right[count - 1] * ratio) / (1.0 + correction[0].x + correction[count - 1].x * ratio);
    right.iter().zip(&correction).map(|(value, change)| *value - weight * change.x).collect()
}

/// Bezier pieces from points and second derivatives at the knots.
pub(super) fn from_moments(
    points: &[DVec3],
    parameters: &[f64],
    steps: &[f64],
    moments: &[DVec3],
) -> BezierSpline {
    let mut control = Vec::with_capacity(3 * steps.len() + 1);
    control.push(points[0]);
    for (k, step) in steps.iter().enumerate() {
        let slope = (points[k + 1] - points[k]) / *step;
        let start = slope - (2.0 * moments[k] + moments[k + 1]) * (*step / 6.0);
        let end = slope + (moments[k] + 2.0 * moments[k + 1]) * (*step / 6.0);
        control.push(points[k] + start * (*step / 3.0));
        control.push(points[k + 1] - end * (*step / 3.0));
        control.push(points[k + 1]);
    }
    BezierSpline::with_knots(3, control, parameters.to_vec())
        .expect("three control points a step plus one, and parameters were checked to increase")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Parametrization, SplineError, interpolate, interpolate_closed, parameters};
    use crate::geometry::curve::{Curve, Side};

    fn zigzag() -> Vec<DVec3> {
        [(0.0, 0.0), (3.0, 4.0), (-1.0, 4.0), (-4.0, 0.0), (-4.0, -3.0)]
            .map(|(x, y)| DVec3::new(x, y, x - y))
            .to_vec()
    }

    fn assert_twice_smooth(curve: &impl Curve, knots: &[f64]) {
        for knot in knots {
            let (before, after) = (curve.evaluate(*knot, Side::Before), curve.evaluate(*knot, Side::After));
            assert!(before.point.distance(after.point) < 1e-13);
            assert!(before.first.distance(after.first) < 1e-12);
            assert!(before.second.distance(after.second) < 1e-11);
        }
    }

    #[test]
    fn natural_spline_interpolates_with_two_derivatives_and_free_ends() {
        let points = zigzag();
        let rules = [
            Parametrization::Uniform,
            Parametrization::Chordal,
            Parametrization::Centripetal,
            Parametrization::Nielsen,
        ];
        for rule in rules {
            let knots = parameters(&points, false, rule).unwrap();
            let curve = interpolate(&points, &knots).unwrap();
            for (knot, point) in knots.iter().zip(&points) {
                assert!(curve.point(*knot).distance(*point) < 1e-13);
            }
            assert_twice_smooth(&curve, &knots[1..4]);
            assert!(curve.evaluate(knots[0], Side::After).second.length() < 1e-12);
            assert!(curve.evaluate(knots[4], Side::Before).second.length() < 1e-12);
        }
    }

    #[test]
    fn closed_spline_is_twice_smooth_at_the_seam() {
        let points = zigzag();
        let knots = parameters(&points, true, Parametrization::Chordal).unwrap();
        let curve = interpolate_closed(&points, &knots).unwrap();
        assert_twice_smooth(&curve, &knots[1..5]);
        let (start, end) = (curve.evaluate(knots[0], Side::After), curve.evaluate(knots[5], Side::Before));
        assert!(start.point.distance(end.point) < 1e-13);
        assert!(start.first.distance(end.first) < 1e-12);
        assert!(start.second.distance(end.second) < 1e-11);
    }

    #[test]
    fn a_period_of_two_steps_is_twice_smooth() {
        let points = [DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, -2.0, 0.5)];
        let curve = interpolate_closed(&points, &[0.0, 0.5, 2.0]).unwrap();
        assert_twice_smooth(&curve, &[0.5]);
        let (start, end) = (curve.evaluate(0.0, Side::After), curve.evaluate(2.0, Side::Before));
        assert!(start.first.distance(end.first) < 1e-12 && start.second.distance(end.second) < 1e-11);
    }

    #[test]
    fn two_points_are_a_line_and_collinear_points_stay_straight() {
        let line = interpolate(&[DVec3::ZERO, DVec3::ONE], &[0.0, 2.0]).unwrap();
        assert!(line.chord_deviation(0.0, 2.0) < 1e-15);
        let points = [0.0, 1.0, 3.0].map(|x| DVec3::new(x, 2.0 * x, 0.0));
        let curve =
            interpolate(&points, &parameters(&points, false, Parametrization::Chordal).unwrap()).unwrap();
        assert!(curve.point(1.0).cross(DVec3::new(1.0, 2.0, 0.0)).length() < 1e-14);
    }

    #[test]
    fn bad_input_is_named() {
        let repeated = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert_eq!(
            parameters(&repeated, false, Parametrization::Chordal),
            Err(SplineError::Repeated { first: 1, second: 2 })
        );
        assert_eq!(interpolate(&repeated[..1], &[0.0]), Err(SplineError::Few { least: 2, found: 1 }));
        assert_eq!(interpolate(&repeated, &[0.0, 1.0]), Err(SplineError::Count { expected: 3, found: 2 }));
        assert_eq!(interpolate(&repeated, &[0.0, 1.0, 1.0]), Err(SplineError::Order { index: 2 }));
        assert_eq!(interpolate(&repeated, &[0.0, f64::NAN, 1.0]), Err(SplineError::Order { index: 1 }));
    }
}
