//! Whether the two ends of a direction are one line in space.

use super::{AnySurface, Surface as _};

/// Places along a side that are compared; ends by no plain share, where waves of formulas meet by chance.
const PLACES: [f64; 7] = [0.0, 0.118, 0.314, 0.5, 0.686, 0.882, 1.0];

/// Ends within this share of the size of the surface are one.
const SAME: f64 = 1e-9;

/// Whether u, and v, come round: whether both ends have the same points at the same parameters, as seen at seven places.
/// A seam with a twist, as a Moebius band has, does not come round in this sense. Cost: 35 evaluations.
#[must_use]
pub fn closed_directions(surface: &AnySurface) -> [bool; 2] {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let point = |x: f64, y: f64| surface.evaluate(u.at(x), v.at(y)).point;
    let corner = point(0.0, 0.0);
    let size = PLACES.iter().map(|part| point(*part, *part).distance(corner)).fold(0.0, f64::max);
    let same = |one: (f64, f64), other: (f64, f64)| {
        point(one.0, one.1).distance(point(other.0, other.1)) <= SAME * size
    };
    [
        PLACES.iter().all(|part| same((0.0, *part), (1.0, *part))),
        PLACES.iter().all(|part| same((*part, 0.0), (*part, 1.0))),
    ]
}
