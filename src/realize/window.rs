//! Where on a surface or curve the nearest point is looked for: around the parameters of a triangle's corners.

use glam::DVec3;

use crate::geometry::curve::{Curve, Domain, nearest_within};

/// Parameters of the corners of a triangle: the nearest point is looked for around them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// u of each corner.
    pub u: [f64; 3],
    /// v of each corner.
    pub v: [f64; 3],
}

impl Window {
    pub(super) fn of(corners: [(f64, f64); 3]) -> Self {
        Self { u: corners.map(|(u, _)| u), v: corners.map(|(_, v)| v) }
    }
}

/// Least and greatest parameter of the corners of a triangle. Where they stand on both sides of the seam of a
/// closed curve, those after it count from the end of the domain on.
pub(super) fn unwrapped(domain: Domain, closed: bool, corners: [f64; 3]) -> (f64, f64) {
    let wide = |values: [f64; 3]| {
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max);
        (low, high)
    };
    let (low, high) = wide(corners);
    let half = domain.span() / 2.0;
    if !closed || high - low <= half {
        return (low, high);
    }
    wide(corners.map(|value| if value < domain.start + half { value + domain.span() } else { value }))
}

/// Ranges of a curve's parameter around those of a triangle's corners, as wide again to both sides: a chord
/// lies inside its arc, and the point nearest to it may belong to the next. Around a closed curve the corners
/// may stand on both sides of the seam, and a range that leaves the domain comes back at the other end.
pub(super) fn ranges(curve: &impl Curve, corners: [f64; 3]) -> Vec<(f64, f64)> {
    let domain = curve.domain();
    let period = domain.span();
    let closed = curve.is_closed();
    let (mut low, mut high) = unwrapped(domain, closed, corners);
    let margin = (high - low).max(1e-6 * period);
    // Each range is one stretch between stations or nearly so: over several a few samples might miss the place.
    let inside = |t: f64| t.clamp(domain.start, domain.end);
    let around = [(low, high), (low - margin, low), (high, high + margin)];
    let mut ranges: Vec<(f64, f64)> = around.iter().map(|(from, to)| (inside(*from), inside(*to))).collect();
    (low, high) = (low - margin, high + margin);
    if closed && low < domain.start {
        ranges.push(((low + period).max(domain.start), domain.end));
    }
    if closed && high > domain.end {
        ranges.push((domain.start, (high - period).min(domain.end)));
    }
    ranges
}

/// Distance and parameter of the nearest point around the corners.
pub(super) fn nearest_near(curve: &impl Curve, point: DVec3, corners: [f64; 3]) -> (f64, f64) {
    let ranges = ranges(curve, corners);
    let found = ranges.iter().map(|(from, to)| nearest_within(curve, point, *from, *to));
    found.fold((f64::INFINITY, corners[0]), |best, next| if next.0 < best.0 { next } else { best })
}
