//! How many triangles a surface needs, told before they are made.
//!
//! Promise: a bound from below for smooth surfaces, of second order, and of surfaces with edges for what is smooth of
//! them. So what would pass a limit is refused before the work is done. Not promised: that so few are enough.
//!
//! With corners on the surface and the tolerance t between them, a triangle covers no more than 3 √3/2 · t / √|K| of a
//! surface with Gaussian curvature K: on a ball of radius 1 the triangle has a circle of radius √(2 t) around it.
//! So triangles are at least ∫ √|K| / (3 √3/2 · t), and √|K| dA is the root of dA times the area of its normals.
//!
//! Source: E. Nadler, Piecewise linear best L2 approximation on triangulations, 1986; P. Gruber, Asymptotic estimates
//! for best and stepwise approximation of convex bodies, 1993 (the integral of √K).

use glam::DVec3;

use super::skin::{NONE, Skin};
use crate::geometry::number::cos_degrees;

/// What is taken off for first triangles, on which the integral is a sum.
const SURE: f64 = 0.7;
/// Normals of a triangle on a smooth part differ by less than this many degrees where a surface has edges.
const SMOOTH: f64 = 20.0;

/// The least number of triangles for a tolerance, by first triangles with normals of the surface at their corners.
pub(super) fn least_triangles(skin: &Skin, kinks: bool, tolerance: f64) -> f64 {
    let parted = if kinks { cos_degrees(SMOOTH) } else { -1.0 };
    let share = |corners: &[u32; 3]| {
        if corners[0] == NONE {
            return 0.0;
        }
        let normals = corners.map(|corner| skin.normal(corner));
        if (0..3).any(|k| normals[k].dot(normals[(k + 1) % 3]) < parted) {
            return 0.0;
        }
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        (area(corners.map(|corner| skin.point(corner))) * area(normals)).sqrt()
    };
    let sum: f64 = skin.triangles.iter().map(share).sum();
    SURE * sum / (1.5 * 3.0_f64.sqrt() * tolerance)
}
