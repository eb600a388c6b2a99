//! Cubic splines with end conditions of every kind.
//!
//! Unknown are the second derivatives M at the knots (moments). Inside the spline each row says that the first
//! derivative is continuous; the first and last row say what holds at the ends. Every system here is diagonally
//! dominant or becomes so when a not-a-knot row is eliminated, so that no pivoting is needed. Source: C. de Boor, A
//! Practical Guide to Splines, rev. ed. 2001, ch. IV. Cost: O(points).

use glam::DVec3;

use super::BezierSpline;
use super::spline::{SplineError, check, from_moments, interpolate, moment_right};

/// What holds at an end of a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplineEnd {
    /// The second derivative is zero.
    Natural,
    /// The first derivative is given (clamped).
    First(DVec3),
    /// The second derivative is given.
    Second(DVec3),
    /// The first two pieces (or the last two) are one cubic: the third derivative is continuous between them. With
    /// three points and this at both ends the curve is the parabola through them; with two points the third
    /// derivative is zero.
    NotAKnot,
}

/// Rows `a[k] M[k - 1] + b[k] M[k] + c[k] M[k + 1] = right[k]`.
struct Rows {
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
    right: Vec<DVec3>,
}

/// The cubic spline through `points` at `parameters` with an end condition at each end.
///
/// # Errors
/// For fewer than two points, a wrong number of parameters, or parameters that do not increase.
pub fn interpolate_with(
    points: &[DVec3],
    parameters: &[f64],
    (start, end): (SplineEnd, SplineEnd),
) -> Result<BezierSpline, SplineError> {
    if start == SplineEnd::Natural && end == SplineEnd::Natural {
        return interpolate(points, parameters);
    }
    if points.len() < 2 {
        return Err(SplineError::Few { least: 2, found: points.len() });
    }
    check(parameters, points.len())?;
    let steps: Vec<f64> = parameters.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let both_free = start == SplineEnd::NotAKnot && end == SplineEnd::NotAKnot;
    let moments = match steps.len() {
        1 if both_free => vec![DVec3::ZERO; 2],
        1 => two_points(points, steps[0], (start, end)),
        2 if both_free => {
            let right = moment_right(points[0], points[1], points[2], steps[0], steps[1]);
            vec![right / (3.0 * (steps[0] + steps[1])); 3]
        }
        _ => many_points(points, &steps, (start, end)),
    };
    Ok(from_moments(points, parameters, &steps, &moments))
}

/// Two points: a not-a-knot end takes the moment of the other, so that the piece is quadratic.
fn two_points(points: &[DVec3], step: f64, ends: (SplineEnd, SplineEnd)) -> Vec<DVec3> {
    let slope = (points[1] - points[0]) / step;
    let alone = |end: SplineEnd, outward: f64| match end {
        SplineEnd::Second(second) => second,
        SplineEnd::First(first) => (slope - first) * (2.0 * outward / step),
        _ => DVec3::ZERO,
    };
    match ends {
        (SplineEnd::NotAKnot, end) => vec![alone(end, -1.0); 2],
        (start, SplineEnd::NotAKnot) => vec![alone(start, 1.0); 2],
        _ => solve(rows(points, &[step], ends)),
    }
}

fn many_points(points: &[DVec3], steps: &[f64], ends: (SplineEnd, SplineEnd)) -> Vec<DVec3> {
    let last = steps.len();
    let mut moments = solve(rows(points, steps, ends));
    // A not-a-knot end says that the third derivative does not jump, which its neighbours then determine.
    let beyond = |near: DVec3, far: DVec3, step: f64, next: f64| near + (near - far) * (step / next);
    if ends.0 == SplineEnd::NotAKnot {
        moments[0] = beyond(moments[1], moments[2], steps[0], steps[1]);
    }
    if ends.1 == SplineEnd::NotAKnot {
        moments[last] = beyond(moments[last - 1], moments[last - 2], steps[last - 1], steps[last - 2]);
    }
    moments
}

fn rows(points: &[DVec3], steps: &[f64], (start, end): (SplineEnd, SplineEnd)) -> Rows {
    let last = steps.len();
    let mut rows = Rows {
        a: vec![0.0; last + 1],
        b: vec![1.0; last + 1],
        c: vec![0.0; last + 1],
        right: vec![DVec3::ZERO; last + 1],
    };
    for k in 1..last {
        rows.a[k] = steps[k - 1];
        rows.b[k] = 2.0 * (steps[k - 1] + steps[k]);
        rows.c[k] = steps[k];
        rows.right[k] = moment_right(points[k - 1], points[k], points[k + 1], steps[k - 1], steps[k]);
    }
    let slope = |k: usize| (points[k + 1] - points[k]) / steps[k];
    match start {
        SplineEnd::Natural => {}
        SplineEnd::Second(second) => rows.right[0] = second,
        SplineEnd::First(first) => {
            (rows.b[0], rows.c[0]) = (2.0 * steps[0], steps[0]);
            rows.right[0] = (slope(0) - first) * 6.0;
        }
        // M[0] is put into row 1 by what it is to M[1] and M[2], and drops out.
        SplineEnd::NotAKnot => {
            let (h, next) = (steps[0], steps[1]);
            (rows.a[1], rows.b[1]) = (0.0, (h + next) * (h / next + 2.0));
            rows.c[1] = (next + h) * (next - h) / next;
        }
    }
    match end {
        SplineEnd::Natural => {}
        SplineEnd::Second(second) => rows.right[last] = second,
        SplineEnd::First(first) => {
            (rows.a[last], rows.b[last]) = (steps[last - 1], 2.0 * steps[last - 1]);
            rows.right[last] = (first - slope(last - 1)) * 6.0;
        }
        SplineEnd::NotAKnot => {
            let (h, next) = (steps[last - 1], steps[last - 2]);
            (rows.c[last - 1], rows.b[last - 1]) = (0.0, (h + next) * (h / next + 2.0));
            rows.a[last - 1] = (next + h) * (next - h) / next;
        }
    }
    rows
}

/// Elimination without pivots.
fn solve(rows: Rows) -> Vec<DVec3> {
    let Rows { a, mut b, c, mut right } = rows;
    for k in 1..b.len() {
        let factor = a[k] / b[k - 1];
        b[k] -= factor * c[k - 1];
        let above = right[k - 1];
        right[k] -= above * factor;
    }
    for k in (0..b.len()).rev() {
        let below = right.get(k + 1).map_or(DVec3::ZERO, |next| *next * c[k]);
        right[k] = (right[k] - below) / b[k];
    }
    right
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{SplineEnd, interpolate_with};
    use crate::geometry::curve::{BezierSpline, Curve, Side};

    const ENDS: [SplineEnd; 4] = [
        SplineEnd::Natural,
        SplineEnd::First(DVec3::new(1.0, -2.0, 0.5)),
        SplineEnd::Second(DVec3::new(-3.0, 1.0, 2.0)),
        SplineEnd::NotAKnot,
    ];

    fn points(count: usize) -> (Vec<DVec3>, Vec<f64>) {
        let number = |k: usize| ((k * k * 5 + k * 3 + 2) % 13) as f64 - 5.0;
        let points = (0..count).map(|k| DVec3::new(k as f64, number(k), 0.5 * number(k + 4))).collect();
        let parameters = (0..count).map(|k| k as f64 + 0.3 * number(2 * k) / 5.0).collect();
        (points, parameters)
    }

    fn third(curve: &BezierSpline, from: f64, to: f64) -> DVec3 {
        let second = |t: f64, side| curve.evaluate(t, side).second;
        (second(to, Side::Before) - second(from, Side::After)) / (to - from)
    }

    #[test]
    fn every_pair_of_ends_holds_and_the_spline_is_twice_smooth() {
        for count in 2..8 {
            let (points, knots) = points(count);
            for start in ENDS {
                for end in ENDS {
                    let curve = interpolate_with(&points, &knots, (start, end)).unwrap();
                    for (knot, point) in knots.iter().zip(&points) {
                        assert!(curve.point(*knot).distance(*point) < 1e-12);
                    }
                    for knot in &knots[1..count - 1] {
                        let (a, b) =
                            (curve.evaluate(*knot, Side::Before), curve.evaluate(*knot, Side::After));
                        assert!(a.first.distance(b.first) < 1e-10 && a.second.distance(b.second) < 1e-9);
                    }
                    let sides = [(start, 0, Side::After), (end, count - 1, Side::Before)];
                    for (rule, at, side) in sides {
                        assert_end(&curve, &knots, rule, at, side);
                    }
                }
            }
        }
    }

    fn assert_end(curve: &BezierSpline, knots: &[f64], rule: SplineEnd, at: usize, side: Side) {
        let jet = curve.evaluate(knots[at], side);
        match rule {
            SplineEnd::Natural => assert!(jet.second.length() < 1e-10),
            SplineEnd::First(first) => assert!(jet.first.distance(first) < 1e-10),
            SplineEnd::Second(second) => assert!(jet.second.distance(second) < 1e-10),
            SplineEnd::NotAKnot if knots.len() == 2 => {
                assert!(third(curve, knots[0], knots[1]).length() < 1e-10);
            }
            SplineEnd::NotAKnot => {
                let k = if at == 0 { 0 } else { at - 2 };
                let jump = third(curve, knots[k], knots[k + 1]) - third(curve, knots[k + 1], knots[k + 2]);
                assert!(jump.length() < 1e-8, "{jump}");
            }
        }
    }

    /// Not-a-knot splines reproduce cubics, clamped ones too when their ends do.
    #[test]
    fn cubics_are_reproduced() {
        let cubic = |t: f64| DVec3::new(t, 2.0 - t + 3.0 * t * t - t * t * t, 0.5 * t * t * t);
        let slope = |t: f64| DVec3::new(1.0, -1.0 + 6.0 * t - 3.0 * t * t, 1.5 * t * t);
        let knots = [-1.0, -0.2, 0.5, 1.75, 2.0];
        let points = knots.map(cubic);
        let (first, last) = (SplineEnd::First(slope(-1.0)), SplineEnd::First(slope(2.0)));
        let free = SplineEnd::NotAKnot;
        for ends in [(free, free), (first, last), (first, free), (free, last)] {
            let curve = interpolate_with(&points, &knots, ends).unwrap();
            for step in 0..=60 {
                let t = -1.0 + f64::from(step) / 20.0;
                assert!(curve.point(t).distance(cubic(t)) < 1e-12);
            }
        }
    }
}
