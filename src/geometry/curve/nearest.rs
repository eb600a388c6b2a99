//! Distance from a point to a part of a curve.

use glam::DVec3;

use super::{Curve, Side};

/// Distance from `point` to the nearest point of the curve found between two parameters.
///
/// The range is sampled and the best sample polished by Newton's method on (C - p) . C' = 0, safeguarded by
/// the samples beside it. The result is never less than the true distance.
#[must_use]
pub fn distance_within(curve: &impl Curve, point: DVec3, from: f64, to: f64) -> f64 {
    nearest_within(curve, point, from, to).0
}

/// As [`distance_within`], with the parameter of the nearest point.
#[must_use]
pub fn nearest_within(curve: &impl Curve, point: DVec3, from: f64, to: f64) -> (f64, f64) {
    const SAMPLES: u32 = 8;
    let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(SAMPLES);
    let square = |t: f64| curve.point(t).distance_squared(point);
    let (mut best, mut nearest) = (0, f64::INFINITY);
    for k in 0..=SAMPLES {
        let found = square(at(k));
        if found < nearest {
            (best, nearest) = (k, found);
        }
    }
    let start = (nearest, at(best));
    let (low, high) = (at(best.saturating_sub(1)), at((best + 1).min(SAMPLES)));
    // The best sample may be a corner of the curve, which has another derivative to each side.
    let before = polished(curve, point, (low, at(best)), (start, Side::Before));
    let after = polished(curve, point, (at(best), high), (start, Side::After));
    let (square, t) = if after.0 < before.0 { after } else { before };
    (square.sqrt(), t)
}

/// Newton's method from one end of a range into it; the square of the distance and the parameter.
fn polished(
    curve: &impl Curve,
    point: DVec3,
    (from, to): (f64, f64),
    ((mut nearest, mut t), side): ((f64, f64), Side),
) -> (f64, f64) {
    let square = |t: f64| curve.point(t).distance_squared(point);
    let settled = 1e-9 * (to - from).abs();
    for _ in 0..8 {
        let jet = curve.evaluate(t, side);
        let away = jet.point - point;
        let slope = away.dot(jet.first);
        let bend = jet.first.length_squared() + away.dot(jet.second);
        let next = (t - slope / bend).clamp(from.min(to), from.max(to));
        if bend > 0.0 && (next - t).abs() <= settled {
            break;
        }
        let reached = if bend > 0.0 { square(next) } else { f64::INFINITY };
        if reached >= nearest {
            // Far from a parabola, as beside the tip of a slender ellipse.
            let (found, at) = sectioned(&square, (from, to));
            return if found < nearest { (found, at) } else { (nearest, t) };
        }
        (t, nearest) = (next, reached);
    }
    (nearest, t)
}

/// The least value of a function with one valley between two places, by golden sections: J. Kiefer, Sequential
/// minimax search for a maximum, 1953.
fn sectioned(value: &impl Fn(f64) -> f64, (mut from, mut to): (f64, f64)) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let inner = |from: f64, to: f64| (to - (to - from) * GOLDEN, from + (to - from) * GOLDEN);
    let (mut low, mut high) = inner(from, to);
    let (mut below, mut above) = (value(low), value(high));
    for _ in 0..48 {
        if below <= above {
            (to, high, above) = (high, low, below);
            low = inner(from, to).0;
            below = value(low);
        } else {
            (from, low, below) = (low, high, above);
            high = inner(from, to).1;
            above = value(high);
        }
    }
    if below <= above { (below, low) } else { (above, high) }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::distance_within;
    use crate::geometry::curve::{Curve as _, EllipseArc, Polyline, Side};
    use crate::geometry::number::{cos_degrees, sin_degrees};

    /// A quarter of an ellipse twenty times as long as wide, and places on its normals.
    #[test]
    fn slender_ellipses_are_found() {
        let (x, y) = (DVec3::new(0.01, 0.0, 0.0), DVec3::new(0.0, 0.2, 0.0));
        let arc = EllipseArc { center: DVec3::ZERO, x, y, from: 0.0, to: 90.0 };
        for k in 0..=60 {
            let t = 1.5 * f64::from(k);
            let (place, along) = (arc.point(t), arc.direction(t, Side::After));
            for away in [1e-6, 1e-4, 2e-4] {
                let point = place - DVec3::new(-along.y, along.x, 0.0) * away;
                let found = distance_within(&arc, point, 0.0, 90.0);
                assert!(found <= away * (1.0 + 1e-6), "{t} {away} {found}");
            }
        }
    }

    #[test]
    fn distance_to_an_arc_is_that_to_the_circle() {
        let arc = EllipseArc::circle(DVec3::ZERO, 0.5, -90.0, 90.0);
        for k in 0..=40 {
            for radius in [0.49, 0.4999, 0.5, 0.501] {
                let angle = -90.0 + 4.5 * f64::from(k);
                let point = DVec3::new(cos_degrees(angle), sin_degrees(angle), 0.0) * radius;
                let place = f64::from(k) / 40.0;
                let found = distance_within(&arc, point, (place - 0.05).max(0.0), (place + 0.03).min(1.0));
                assert!((found - (radius - 0.5).abs()).abs() < 1e-12, "{angle} {radius} {found}");
            }
        }
    }

    /// From a corner the nearest point is looked for to both sides.
    #[test]
    fn a_range_may_begin_at_a_corner() {
        let corner = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
        let line = Polyline::new(corner.to_vec(), false).expect("three points");
        for share in [0.01, 0.02, 0.06, 0.5] {
            let up = DVec3::new(1.0, share, 0.0);
            let left = DVec3::new(1.0 - share, 0.0, 0.0);
            for (point, from, to) in [(up, 1.0, 2.0), (left, 0.0, 1.0), (up, 0.0, 2.0), (left, 0.0, 2.0)] {
                assert!(distance_within(&line, point, from, to) < 1e-12, "{point} from {from} to {to}");
            }
        }
    }
}
