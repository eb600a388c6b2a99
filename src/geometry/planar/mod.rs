//! Points and segments in the plane: on which side, whether they cross, what encloses what.
//!
//! Promise: every answer of yes or no is exact (but for set operations, which first round to a fine grid), by the orientation predicate of J. Shewchuk, Adaptive precision
//! floating-point arithmetic and fast robust geometric predicates, 1997; places that are told with it are rounded.
//! This is the one owner of such questions: meshes and tessellations ask here.

mod contact;
mod overlay;
mod region;
mod sweep;

pub use contact::{Contact, Crossing, crossing, crossing_segments, first_contact, first_crossing};
pub use overlay::{SetOperation, Winding, overlay};
pub use region::{Regions, regions};

use glam::DVec2;
use robust::{Coord, orient2d};

/// Twice the area of triangle abc, positive when it turns counter-clockwise; the sign is exact.
#[must_use]
pub fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |point: DVec2| Coord { x: point.x, y: point.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Twice the signed area of a closed outline; positive when it turns counter-clockwise. Summed from the first point,
/// so that the distance from the origin costs no accuracy.
#[must_use]
pub fn twice_area(outline: &[DVec2]) -> f64 {
    let Some(&origin) = outline.first() else { return 0.0 };
    outline.windows(2).map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin)).sum()
}

/// Whether a closed outline goes around a point (an odd number of times); exact unless the point lies on it.
/// O(points).
#[must_use]
pub fn encloses(outline: &[DVec2], point: DVec2) -> bool {
    let next = outline.iter().cycle().skip(1);
    let crosses = |(a, b): (&DVec2, &DVec2)| {
        let upward = a.y <= point.y && b.y > point.y;
        let downward = b.y <= point.y && a.y > point.y;
        (upward && turn(*a, *b, point) > 0.0) || (downward && turn(*a, *b, point) < 0.0)
    };
    outline.iter().zip(next).filter(|edge| crosses(*edge)).count() % 2 == 1
}

/// Distance of a point from a segment.
#[must_use]
pub fn distance_to_segment(point: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let length = along.length_squared();
    let part = if length > 0.0 { ((point - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + along * part)
}
