//! Cubic pieces from points and derivatives, and the rules that find derivatives from neighbours.
//!
//! Sources: J. Ferguson, Multivariable curve interpolation, J. ACM 11 (1964); E. Catmull, R. Rom, A class of local
//! interpolating splines, 1974; P. Barry, R. Goldman, A recursive evaluation algorithm for a class of Catmull-Rom
//! splines, SIGGRAPH 1988; D. Kochanek, R. Bartels, Interpolating splines with local tension, continuity, and bias
//! control, SIGGRAPH 1984; C. Yuksel, S. Schaefer, J. Keyser, Parameterization and applications of Catmull-Rom
//! curves, CAD 43 (2011).

use glam::DVec3;

use super::spline::{SplineError, check};
use super::{BezierSpline, RationalError, RationalSpline};
use crate::geometry::number::pow;

/// A point that a curve goes through, with its derivatives on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HermiteKnot {
    /// Where it is.
    pub point: DVec3,
    /// The derivative with which the curve arrives.
    pub before: DVec3,
    /// The derivative with which it leaves.
    pub after: DVec3,
}

/// The cubic Hermite (Ferguson) curve over `parameters`; C1 where the two derivatives of a knot agree. O(points).
///
/// # Errors
/// For fewer than two knots, a wrong number of parameters, or parameters that do not increase.
pub fn hermite(knots: &[HermiteKnot], parameters: &[f64]) -> Result<BezierSpline, SplineError> {
    if knots.len() < 2 {
        return Err(SplineError::Few { least: 2, found: knots.len() });
    }
    check(parameters, knots.len())?;
    let mut control = vec![knots[0].point];
    for (pair, ends) in knots.windows(2).zip(parameters.windows(2)) {
        let third = (ends[1] - ends[0]) / 3.0;
        control.push(pair[0].point + pair[0].after * third);
        control.push(pair[1].point - pair[1].before * third);
        control.push(pair[1].point);
    }
    Ok(BezierSpline::with_knots(3, control, parameters.to_vec())
        .expect("three control points a step plus one, and parameters were checked to increase"))
}

/// The rational Hermite curve: a cubic in homogeneous coordinates that takes the points with the derivatives, and
/// whose weight takes `weights` with the derivatives `rates`. With equal weights and no rates it is the Hermite
/// curve itself.
///
/// # Errors
/// As of [`RationalSpline::new`]: weights that rates pull below zero.
pub fn rational_hermite(
    knots: &[HermiteKnot],
    weights: &[(f64, f64)],
    parameters: &[f64],
) -> Result<RationalSpline, RationalError> {
    let lifted = |k: usize, derivative: DVec3| {
        let (weight, rate) = weights[k];
        let point = knots[k].point;
        (RationalSpline::homogeneous(point, weight), (derivative * weight + point * rate).extend(rate))
    };
    let mut control = vec![lifted(0, DVec3::ZERO).0];
    for k in 1..knots.len() {
        let third = (parameters[k] - parameters[k - 1]) / 3.0;
        let (start, leaving) = lifted(k - 1, knots[k - 1].after);
        let (end, arriving) = lifted(k, knots[k].before);
        control.extend([start + leaving * third, end - arriving * third, end]);
    }
    RationalSpline::new(3, control, parameters.to_vec())
}

/// How an open curve through points begins and ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndRule {
    /// The second derivative is zero.
    Natural,
    /// The first and last piece are parabolas.
    Quadratic,
    /// As if the polygon went straight on: `p[-1] = 2 p[0] - p[1]`.
    Reflect,
    /// As if the end stood twice: `p[-1] = p[0]`.
    Duplicate,
    /// The first and the last point only guide: the curve runs from the second to the last but one.
    Guides,
}

/// What shapes a Kochanek-Bartels curve at a point; all zero is Catmull-Rom.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bartels {
    /// Shortens derivatives: 1 stops at the point, -1 doubles the swing.
    pub tension: f64,
    /// Makes corners: 0 is C1; towards -1 the polygon, towards 1 buckling outward.
    pub continuity: f64,
    /// Leans to what comes before (above 0) or after (below 0).
    pub bias: f64,
}

impl Bartels {
    /// Arriving and leaving derivative between a step with derivative `v` over `h` and one with `w` over `k`.
    ///
    /// With tension, continuity and bias 0 both are that of the parabola through the three points, which is the
    /// derivative of Barry and Goldman's Catmull-Rom curves of every parametrization.
    fn derivatives(&self, (v, h): (DVec3, f64), (w, k): (DVec3, f64)) -> (DVec3, DVec3) {
        let Self { tension, continuity, bias } = *self;
        let (before, after) = (v * (k / (h + k)), w * (h / (h + k)));
        let loose = 1.0 - tension;
        let arriving = before * (1.0 - continuity) * (1.0 + bias) + after * (1.0 + continuity) * (1.0 - bias);
        let leaving = before * (1.0 + continuity) * (1.0 + bias) + after * (1.0 - continuity) * (1.0 - bias);
        (arriving * loose, leaving * loose)
    }
}

/// Parameters with steps of distance^alpha: 0 is uniform, 0.5 centripetal, 1 chordal. A closed curve gets one more.
///
/// # Errors
/// When two neighbouring points are equal, unless `alpha` is 0.
pub fn alpha_parameters(points: &[DVec3], closed: bool, alpha: f64) -> Result<Vec<f64>, SplineError> {
    let steps = if closed { points.len() } else { points.len().saturating_sub(1) };
    let mut parameters = vec![0.0];
    for first in 0..steps {
        let second = (first + 1) % points.len();
        let distance = points[first].distance(points[second]);
        if distance == 0.0 && alpha != 0.0 {
            return Err(SplineError::Repeated { first, second });
        }
        let step = if alpha == 0.0 {
            1.0
        } else if alpha == 0.5 {
            distance.sqrt()
        } else {
            pow(distance, alpha)
        };
        parameters.push(parameters[first] + step);
    }
    Ok(parameters)
}

/// The closed curve through points with derivatives by [`Bartels`] (one for each point); `parameters` has one more.
///
/// # Errors
/// For fewer than three points, a wrong number of parameters, or parameters that do not increase.
pub fn through_closed(
    points: &[DVec3],
    shape: &[Bartels],
    parameters: &[f64],
) -> Result<BezierSpline, SplineError> {
    let count = points.len();
    if count < 3 {
        return Err(SplineError::Few { least: 3, found: count });
    }
    check(parameters, count + 1)?;
    let velocity = |k: usize| {
        let step = parameters[k + 1] - parameters[k];
        ((points[(k + 1) % count] - points[k]) / step, step)
    };
    let knot = |k: usize| {
        let (before, after) = shape[k].derivatives(velocity((k + count - 1) % count), velocity(k));
        HermiteKnot { point: points[k], before, after }
    };
    let mut knots: Vec<HermiteKnot> = (0..count).map(knot).collect();
    knots.push(knots[0]);
    hermite(&knots, parameters)
}

/// The open curve through points with derivatives by [`Bartels`] (one for each point) and a rule for the ends.
///
/// # Errors
/// For fewer than two points (four where ends only guide), a wrong number of parameters, or parameters that do not
/// increase.
pub fn through(
    points: &[DVec3],
    shape: &[Bartels],
    parameters: &[f64],
    ends: EndRule,
) -> Result<BezierSpline, SplineError> {
    let count = points.len();
    let least = if ends == EndRule::Guides { 4 } else { 2 };
    if count < least {
        return Err(SplineError::Few { least, found: count });
    }
    check(parameters, count)?;
    let velocity = |k: usize| {
        let step = parameters[k + 1] - parameters[k];
        ((points[k + 1] - points[k]) / step, step)
    };
    let mut knots: Vec<HermiteKnot> = points
        .iter()
        .enumerate()
        .map(|(k, point)| {
            let (before, after) = if k > 0 && k + 1 < count {
                shape[k].derivatives(velocity(k - 1), velocity(k))
            } else {
                (DVec3::ZERO, DVec3::ZERO)
            };
            HermiteKnot { point: *point, before, after }
        })
        .collect();
    if ends == EndRule::Guides {
        return hermite(&knots[1..count - 1], &parameters[1..count - 1]);
    }
    let (first, last) = (velocity(0), velocity(count - 2));
    let inner = count > 2;
    let next = if inner { knots[1].before } else { first.0 };
    let previous = if inner { knots[count - 2].after } else { last.0 };
    knots[0].after = end_derivative(ends, first, next, |beyond| shape[0].derivatives(beyond, first).1);
    knots[count - 1].before =
        end_derivative(ends, last, previous, |beyond| shape[count - 1].derivatives(last, beyond).0);
    hermite(&knots, parameters)
}

/// The derivative at an end, from that of the step beside it, the one at the step's other end, and what the rule
/// of the curve makes of a step beyond the end.
fn end_derivative(
    ends: EndRule,
    (velocity, step): (DVec3, f64),
    inner: DVec3,
    of_step_beyond: impl Fn((DVec3, f64)) -> DVec3,
) -> DVec3 {
    match ends {
        EndRule::Natural => (velocity * 3.0 - inner) / 2.0,
        EndRule::Quadratic => velocity * 2.0 - inner,
        EndRule::Reflect => of_step_beyond((velocity, step)),
        EndRule::Duplicate | EndRule::Guides => of_step_beyond((DVec3::ZERO, step)),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{
        Bartels, EndRule, HermiteKnot, alpha_parameters, hermite, rational_hermite, through, through_closed,
    };
    use crate::geometry::curve::control::BasisMatrix;
    use crate::geometry::curve::control::horner;
    use crate::geometry::curve::{Curve, Side};

    fn points() -> Vec<DVec3> {
        [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (2.2, 2.5), (0.7, 2.2), (-0.6, 1.4)]
            .map(|(x, y)| DVec3::new(x, y, x * y))
            .to_vec()
    }

    const PLAIN: [Bartels; 6] = [Bartels { tension: 0.0, continuity: 0.0, bias: 0.0 }; 6];

    #[test]
    fn uniform_catmull_rom_is_the_matrix_form() {
        let points = points();
        let parameters = alpha_parameters(&points, false, 0.0).unwrap();
        let curve = through(&points, &PLAIN, &parameters, EndRule::Guides).unwrap();
        assert_eq!((curve.domain().start, curve.domain().end), (1.0, 4.0));
        for k in 0..3 {
            let power =
                BasisMatrix::CATMULL_ROM.power(&[points[k], points[k + 1], points[k + 2], points[k + 3]]);
            for step in 0..=8 {
                let local = f64::from(step) / 8.0;
                assert!(curve.point(1.0 + k as f64 + local).distance(horner(&power, local)) < 1e-13);
            }
        }
    }

    /// Barry and Goldman's pyramid of linear interpolations, for every parametrization.
    #[test]
    fn catmull_rom_is_the_pyramid_of_barry_and_goldman() {
        let points = points();
        for alpha in [0.0, 0.25, 0.5, 1.0] {
            let t = alpha_parameters(&points, false, alpha).unwrap();
            let curve = through(&points, &PLAIN, &t, EndRule::Natural).unwrap();
            for k in 1..4 {
                for step in 0..=8 {
                    let at = t[k] + (t[k + 1] - t[k]) * f64::from(step) / 8.0;
                    let mix = |a: DVec3, b: DVec3, from: usize, to: usize| {
                        (a * (t[to] - at) + b * (at - t[from])) / (t[to] - t[from])
                    };
                    let line = |j: usize| mix(points[j], points[j + 1], j, j + 1);
                    let (a, b, c) = (line(k - 1), line(k), line(k + 1));
                    let (a, b) = (mix(a, b, k - 1, k + 1), mix(b, c, k, k + 2));
                    assert!(curve.point(at).distance(mix(a, b, k, k + 1)) < 1e-12, "{alpha} {k}");
                }
            }
        }
    }

    #[test]
    fn ends_are_what_their_rules_say() {
        let points = points();
        let t = alpha_parameters(&points, false, 0.5).unwrap();
        for count in [2, 3, 6] {
            let of = |ends| through(&points[..count], &PLAIN[..count], &t[..count], ends).unwrap();
            let ends = |ends| {
                let curve = of(ends);
                (curve.evaluate(t[0], Side::After), curve.evaluate(t[count - 1], Side::Before))
            };
            let (start, end) = ends(EndRule::Natural);
            assert!(start.second.length() < 1e-12 && end.second.length() < 1e-12);
            let curve = of(EndRule::Quadratic);
            let bend = |t: f64, side| curve.evaluate(t, side).second;
            assert!(bend(t[0], Side::After).distance(bend(t[1], Side::Before)) < 1e-11);
            let chord = (points[1] - points[0]) / (t[1] - t[0]);
            assert!(ends(EndRule::Reflect).0.first.distance(chord) < 1e-12);
            assert!(ends(EndRule::Duplicate).0.first.distance(chord / 2.0) < 1e-12);
        }
        assert!(through(&points[..3], &PLAIN[..3], &t[..3], EndRule::Guides).is_err());
    }

    #[test]
    fn continuity_makes_corners_and_tension_stops() {
        let points = points();
        let t = alpha_parameters(&points, true, 0.0).unwrap();
        let smooth = through_closed(&points, &PLAIN, &t).unwrap();
        assert!(smooth.joints().is_empty() && smooth.is_closed());
        let mut shape = PLAIN;
        shape[2].continuity = -0.5;
        assert_eq!(through_closed(&points, &shape, &t).unwrap().joints(), [2.0]);
        shape[2] = Bartels { tension: 1.0, ..Bartels::default() };
        let stopped = through_closed(&points, &shape, &t).unwrap();
        assert_eq!(stopped.evaluate(2.0, Side::After).first, DVec3::ZERO);
    }

    #[test]
    fn a_rational_hermite_curve_has_its_points_and_derivatives() {
        let knots: Vec<HermiteKnot> = points()
            .windows(2)
            .map(|pair| HermiteKnot { point: pair[0], before: pair[1] * 0.7, after: pair[1] * 0.7 })
            .collect();
        let parameters = [0.0, 0.5, 2.0, 2.25, 4.0];
        let weights = [(1.0, 0.5), (2.0, -1.0), (0.5, 0.0), (1.0, 0.25), (3.0, 1.0)];
        let curve = rational_hermite(&knots, &weights, &parameters).unwrap();
        for (knot, t) in knots.iter().zip(parameters) {
            let side = if t == 4.0 { Side::Before } else { Side::After };
            let jet = curve.evaluate(t, side);
            assert!(jet.point.distance(knot.point) < 1e-13 && jet.first.distance(knot.after) < 1e-12);
        }
        let plain = rational_hermite(&knots, &[(2.0, 0.0); 5], &parameters).unwrap();
        let polynomial = hermite(&knots, &parameters).unwrap();
        for step in 0..=40 {
            let t = f64::from(step) / 10.0;
            assert!(plain.point(t).distance(polynomial.point(t)) < 1e-13);
        }
    }
}
