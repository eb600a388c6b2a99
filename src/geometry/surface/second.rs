//! Second derivatives of surfaces: at a place, and bounds on them over a rectangle of parameters.

use glam::DVec3;

use super::{Surface, SurfaceJet};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::Bounds;

/// Second derivatives of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondJet {
    /// Twice by u.
    pub uu: DVec3,
    /// By u and v: the twist.
    pub uv: DVec3,
    /// Twice by v.
    pub vv: DVec3,
}

/// Boxes that hold the second derivatives over a rectangle of parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondRange {
    /// Twice by u.
    pub uu: Bounds,
    /// By u and v.
    pub uv: Bounds,
    /// Twice by v.
    pub vv: Bounds,
}

/// The share of a domain over which differences are taken.
const STEP: f64 = 1e-5;

/// Second derivatives as differences of tangents, into the named sides.
pub(super) fn by_differences<S: Surface + ?Sized>(surface: &S, u: (f64, Side), v: (f64, Side)) -> SecondJet {
    let (step_u, step_v) = (step(surface.domain_u(), u), step(surface.domain_v(), v));
    let here = surface.sided(u, v);
    let by_u: SurfaceJet = surface.sided((u.0 + step_u, u.1), v);
    let by_v: SurfaceJet = surface.sided(u, (v.0 + step_v, v.1));
    SecondJet {
        uu: (by_u.du - here.du) / step_u,
        uv: (by_v.du - here.du) / step_v,
        vv: (by_v.dv - here.dv) / step_v,
    }
}

fn step(domain: Domain, (t, side): (f64, Side)) -> f64 {
    let step = domain.span() * STEP;
    let backward = (side == Side::Before && t - step >= domain.start) || t + step > domain.end;
    if backward { -step } else { step }
}

/// The box of sums of a vector from each of two boxes.
pub(super) fn sum(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min + b.min, max: a.max + b.max }
}

/// The box of a vector of one box, times a factor that is not negative.
pub(super) fn times(range: &Bounds, factor: f64) -> Bounds {
    Bounds { min: range.min * factor, max: range.max * factor }
}

/// The box of differences of a vector of the first box and one of the second.
pub(super) fn difference(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min - b.max, max: a.max - b.min }
}

/// The corners of a box.
pub(super) fn corners(bounds: &Bounds) -> [DVec3; 8] {
    let pick = |bit: usize, low: f64, high: f64| if bit == 0 { low } else { high };
    let (low, high) = (bounds.min, bounds.max);
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k: usize| {
        DVec3::new(pick(k & 1, low.x, high.x), pick(k & 2, low.y, high.y), pick(k & 4, low.z, high.z))
    })
}
