//! Distance from a point to a part of a curve.

use glam::DVec3;

use super::{Curve, Side};

/// Distance from `point` to the nearest point of the curve found between two parameters.
///
/// The range is sampled and the best sample polished by Newton's method on (C - p) . C' = 0, safeguarded by
/// the samples beside it. The result is never less than the true distance.
#[must_use]
pub fn distance_within(curve: &impl Curve, point: DVec3, from: f64, to: f64) -> f64 {
    const SAMPLES: u32 = 8;
    let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(SAMPLES);
    let square = |t: f64| curve.evaluate(t, Side::Before).point.distance_squared(point);
    let best = (0..=SAMPLES).min_by(|a, b| square(at(*a)).total_cmp(&square(at(*b)))).unwrap_or(0);
    let (low, high) = (at(best.saturating_sub(1)), at((best + 1).min(SAMPLES)));
    let mut t = at(best);
    let mut nearest = square(t);
    for _ in 0..8 {
        let jet = curve.evaluate(t, Side::Before);
        let away = jet.point - point;
        let slope = away.dot(jet.first);
        let bend = jet.first.length_squared() + away.dot(jet.second);
        if bend <= 0.0 {
            break;
        }
        t = (t - slope / bend).clamp(low.min(high), low.max(high));
        let reached = square(t);
        if reached >= nearest {
            break;
        }
        nearest = reached;
    }
    nearest.sqrt()
}
