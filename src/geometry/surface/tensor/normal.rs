//! Normals of tensor-product surfaces, at collapsed sides and corners too.

use glam::DVec3;

use crate::geometry::curve::Side;
use crate::geometry::surface::{SecondJet, limit};

/// Tangents, by parameters from 0 to 1, that are shorter than this share of the surface's size have lost their
/// direction to rounding.
const VANISHES: f64 = 1e-9;

/// The unit normal where both tangents have a length and do not lie on one line.
#[inline]
pub(super) fn regular(du: DVec3, dv: DVec3, size: f64) -> Option<DVec3> {
    let across = du.cross(dv);
    let (uu, vv, least) = (du.length_squared(), dv.length_squared(), VANISHES * size);
    let square = across.length_squared();
    let spans = uu.min(vv) > least * least && square > VANISHES * VANISHES * uu * vv;
    spans.then(|| across / square.sqrt())
}

/// The normal where tangents vanish or coincide: its limit from inside the piece.
///
/// First by the second derivatives, which settle a collapsed side. Where those vanish too (several rows of
/// control points in one place) by the tangents at two places inside, extrapolated to the limit: the direction
/// has an expansion in the distance, so that what is left is of second order.
pub(super) fn at_limit(
    tangents: (DVec3, DVec3),
    second: &SecondJet,
    sides: (Side, Side),
    local: (f64, f64),
    size: f64,
    inside: impl Fn(f64, f64) -> (DVec3, DVec3),
) -> DVec3 {
    if let Some(normal) = limit::normal(tangents, second, sides) {
        return normal;
    }
    let inward = |t: f64, side: Side| if side == Side::After && t < 1.0 || t <= 0.0 { 1.0 } else { -1.0 };
    let (x, y) = (inward(local.0, sides.0), inward(local.1, sides.1));
    // Into the piece across the one side or the other; at a corner where both fail, between them.
    for (x, y) in [(0.0, y), (x, 0.0), (x, y)] {
        let at = |step: f64| {
            let (du, dv) = inside(local.0 + x * step, local.1 + y * step);
            regular(du, dv, size * STEP * STEP)
        };
        if let (Some(near), Some(far)) = (at(STEP), at(2.0 * STEP)) {
            return (near * 2.0 - far).normalize_or(near);
        }
    }
    DVec3::Y
}

/// Distance of the nearer place, as a share of the piece: its square is what is left of the error, and tangents
/// that vanish to the second order still have six digits.
const STEP: f64 = 1.0 / 4096.0;
