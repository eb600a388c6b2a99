//! Arc length.

use glam::DVec3;

use super::{Curve, Side};

/// Abscissas and weights of Gauss-Legendre quadrature with five points on -1 to 1.
///
/// Source: M. Abramowitz, I. Stegun, Handbook of Mathematical Functions, 1964, table 25.4.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Length of a short smooth step between two parameters, metres, by one rule of five points: where the
/// direction turns by a tenth of a radian the share that is wrong is below 1e-12. Five evaluations.
#[must_use]
pub fn length_of_step(curve: &impl Curve, from: f64, to: f64) -> f64 {
    gauss(curve, from, to)
}

fn gauss(curve: &impl Curve, from: f64, to: f64) -> f64 {
    let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
    let speed = |place: f64| curve.evaluate(middle + half * place, Side::After).first.length();
    half * GAUSS.iter().map(|(place, weight)| weight * speed(*place)).sum::<f64>()
}

/// Length of the curve between two parameters, metres, within about 1e-10 of itself where the curve is
/// smooth. Halves the interval until two estimates agree; at most 2^20 evaluations.
#[must_use]
pub fn length_between(curve: &impl Curve, from: f64, to: f64) -> f64 {
    if !curve.has_curvature() {
        return by_chords(curve, from, to);
    }
    refine(curve, (from, to), gauss(curve, from, to), 16)
}

/// Length of a curve whose speed no polynomial follows: sums of ever shorter chords, whose error falls with the
/// square of their length, corrected by one step of Richardson's extrapolation; within about 1e-9 of itself.
fn by_chords(curve: &impl Curve, from: f64, to: f64) -> f64 {
    const MOST: u32 = 1 << 13;
    let mut points = vec![curve.point(from), curve.point(to)];
    let sum = |points: &[DVec3]| points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
    let (mut chords, mut coarse, mut found) = (1, sum(&points), f64::INFINITY);
    while chords < MOST {
        let between = |k: u32| {
            let share = (2.0 * f64::from(k) + 1.0) / (2.0 * f64::from(chords));
            curve.point(from + (to - from) * share)
        };
        let inner = (0..chords).map(between);
        let mut finer: Vec<DVec3> =
            points.iter().zip(inner).flat_map(|(point, after)| [*point, after]).collect();
        finer.extend(points.last());
        let fine = sum(&finer);
        let better = fine + (fine - coarse) / 3.0;
        let settled = chords >= 8 && (better - found).abs() <= 1e-10 * better;
        (points, coarse, found, chords) = (finer, fine, better, 2 * chords);
        if settled {
            break;
        }
    }
    found
}

fn refine(curve: &impl Curve, (from, to): (f64, f64), whole: f64, depth: u32) -> f64 {
    let middle = (from + to) / 2.0;
    let (left, right) = (gauss(curve, from, middle), gauss(curve, middle, to));
    let sum = left + right;
    if depth == 0 || (sum - whole).abs() <= 1e-11 * sum.abs() {
        return sum;
    }
    refine(curve, (from, middle), left, depth - 1) + refine(curve, (middle, to), right, depth - 1)
}

/// Length of the whole curve, metres.
#[must_use]
pub fn length(curve: &impl Curve) -> f64 {
    let domain = curve.domain();
    let mut stops = vec![domain.start];
    stops.extend(curve.breaks());
    stops.push(domain.end);
    stops.windows(2).map(|pair| length_between(curve, pair[0], pair[1])).sum()
}

/// Length from the start of the curve to each of some parameters (its natural parameter), metres; they may
/// stand in any order. Parameters outside the domain are taken as its ends.
#[must_use]
pub fn lengths_at(curve: &impl Curve, parameters: &[f64]) -> Vec<f64> {
    let domain = curve.domain();
    let inside = |index: usize| parameters[index].clamp(domain.start, domain.end);
    let mut order: Vec<usize> = (0..parameters.len()).collect();
    order.sort_by(|a, b| inside(*a).total_cmp(&inside(*b)));
    let breaks = curve.breaks();
    let mut breaks = breaks.iter().copied().peekable();
    let mut lengths = vec![0.0; parameters.len()];
    let (mut reached, mut total) = (domain.start, 0.0);
    for index in order {
        let t = inside(index);
        while let Some(stop) = breaks.next_if(|stop| *stop < t) {
            total += length_between(curve, reached, stop);
            reached = stop;
        }
        if t > reached {
            total += length_between(curve, reached, t);
            reached = t;
        }
        lengths[index] = total;
    }
    lengths
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{length, lengths_at};
    use crate::geometry::curve::{BezierSpline, EllipseArc, Helix, Polyline};

    #[test]
    fn lengths_along_a_curve_add_up() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (4.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let line = Polyline::new(points.to_vec(), false).unwrap();
        assert_eq!(lengths_at(&line, &[3.0, 0.0, 0.5, 2.0, 9.0, -1.0]), [6.0, 0.0, 0.5, 3.0, 6.0, 0.0]);
    }

    #[test]
    fn closed_forms() {
        let circle = EllipseArc::full(DVec3::ZERO, 1.5, 1.5);
        assert!((length(&circle) / (3.0 * core::f64::consts::PI) - 1.0).abs() < 1e-12);
        let helix = Helix { radius: 0.5, end_radius: 0.5, pitch: 0.4, turns: 3.0 };
        let turn = (core::f64::consts::PI * core::f64::consts::PI + 0.16_f64).sqrt();
        assert!((length(&helix) / (3.0 * turn) - 1.0).abs() < 1e-12);
        let square = Polyline::new(vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y], true).unwrap();
        assert!((length(&square) - (2.0 + 2.0 * 2.0_f64.sqrt())).abs() < 1e-14);
        // y = x^2 from 0 to 1: sqrt(5)/2 + asinh(2)/4.
        let parabola = vec![DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 1.0, 0.0)];
        let parabola = BezierSpline::new(2, parabola).unwrap();
        assert!((length(&parabola) - 1.478_942_857_544_597).abs() < 1e-12);
        // An ellipse with half axes 2 and 1: 4 * 2 * E(3/4).
        let ellipse = EllipseArc::full(DVec3::ZERO, 2.0, 1.0);
        assert!((length(&ellipse) - 9.688_448_220_547_677).abs() < 1e-10);
    }
}
