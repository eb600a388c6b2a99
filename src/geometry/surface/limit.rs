//! Normals where tangents vanish: limits from inside.

use glam::DVec3;

use super::SecondJet;
use crate::geometry::curve::Side;

/// Tangents shorter than this share of what second derivatives make of them are zero but for rounding.
const VANISHES: f64 = 1e-9;

/// The unit normal by tangents that surely do not vanish, given that the sum of the squares of the second derivatives is
/// no greater than `second`; then it is what [`normal`] gives.
pub(super) fn plain_normal((du, dv): (DVec3, DVec3), second: f64) -> Option<DVec3> {
    // The squares settle almost every place, without a root.
    let (least, across) = (12.0 * VANISHES * VANISHES * second, du.cross(dv));
    let (square_u, square_v) = (du.length_squared(), dv.length_squared());
    let spread = across.length_squared() > VANISHES * VANISHES * square_u * square_v;
    if square_u > least && square_v > least && spread { across.try_normalize() } else { None }
}

/// The unit normal by the tangents at a place; where one vanishes (a pole, a cusp) by its change into the
/// surface: there it points, but for its length, where it points near by. All derivatives by parameters from
/// 0 to 1 or the like; `None` where even these do not span a plane.
pub(super) fn normal(
    (du, dv): (DVec3, DVec3),
    second: &SecondJet,
    (side_u, side_v): (Side, Side),
) -> Option<DVec3> {
    let squares = second.uu.length_squared() + second.uv.length_squared() + second.vv.length_squared();
    if let Some(plain) = plain_normal((du, dv), squares) {
        return Some(plain);
    }
    let into = |side: Side, change: DVec3| if side == Side::After { change } else { -change };
    let reach = second.uu.length() + second.uv.length() + second.vv.length();
    let lasting = |tangent: DVec3, changes: [DVec3; 2]| {
        let least = VANISHES * (reach + tangent.length());
        let first = [tangent, changes[0], changes[1]].into_iter().find(|vector| vector.length() > least);
        first.unwrap_or(DVec3::ZERO)
    };
    let along_u = lasting(du, [into(side_v, second.uv), into(side_u, second.uu)]);
    let along_v = lasting(dv, [into(side_u, second.uv), into(side_v, second.vv)]);
    let across = along_u.cross(along_v);
    if across.length() > VANISHES * along_u.length() * along_v.length() {
        across.try_normalize()
    } else {
        None
    }
}
