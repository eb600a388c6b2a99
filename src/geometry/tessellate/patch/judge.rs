//! How far a triangle may lie from its surface.
//!
//! # The proof
//! Let n be the normal of the triangle and pair each of its points with the surface point of the same
//! parameters (the triangle's own are linear in them). The difference vanishes at the corners, so it is
//! bounded by second derivatives (D. Filip, R. Magedson, R. Markot, Surface algorithms using bounds on
//! derivatives, CAGD 3, 1986; exactly for constant ones, S. Waldron, The error in linear interpolation at the
//! vertices of a simplex, SIAM J. Numer. Anal. 35, 1998). Its part along n is G, the rest T. So the distance is
//! at most hypot(G, T), and this needs no more.
//!
//! The rest only shifts along the surface. Where the tangents in the plane of the triangle stay away from being
//! parallel by s over parameters an eighth beyond the triangle, the surface point straight above each point
//! of the triangle is found within T / s of the paired one (inverse function theorem), or the way to it leaves
//! the surface across a rim whose own chord is that close. On the way the height changes by at most the slope
//! there, so G + slope T / s bounds the distance too.
//!
//! Where the bounds on derivatives are not known, or too loose to show what the tolerance asks for, distances are
//! taken from the tangent planes at quarters of the sides and at the centroid: exact for quadratic surfaces, and
//! `Sampled`.

use glam::DVec3;

use super::rows::{Corner, Free};
use crate::geometry::number::{Bounds, hypot};
use crate::geometry::surface::{SecondRange, SurfaceJet};
use crate::geometry::tessellate::Evidence;

/// What triangles are held against: a smooth surface over a rectangle of parameters.
pub(in crate::geometry::tessellate) trait Chart {
    /// Point, tangents and normal.
    fn jet(&self, u: f64, v: f64) -> SurfaceJet;

    /// Boxes of the second derivatives over a rectangle; none where none are known.
    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange>;

    /// The rectangle, in u and v.
    fn limits(&self) -> ((f64, f64), (f64, f64));
}

/// The verdict on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::geometry::tessellate) struct Verdict {
    /// A bound by proof; infinite where there is none.
    pub(in crate::geometry::tessellate) proved: f64,
    /// A bound by samples.
    pub(in crate::geometry::tessellate) sampled: f64,
    /// How much each side bends away, as seen by the samples; side k lies opposite of corner k.
    pub(in crate::geometry::tessellate) sides: [f64; 3],
}

/// Samples are raised by this share: a smooth surface may exceed them by terms of the next order.
const MARGIN: f64 = 1.05;

/// The most of t (1 - t) (1 - 2t), as a share of its value at a quarter.
const MOST_OF_THE_ODD: f64 = 1.0265;

/// A triangle whose normal and that of the surface have a cosine below this stands across the surface.
const FOLDED: f64 = 0.25;

/// Share of a triangle's extent in parameters by which its range is widened for the proof.
const WIDER: f64 = 0.125;

impl Verdict {
    /// The bound for a tolerance: the proof where it is good enough.
    pub(in crate::geometry::tessellate) fn bound(&self, tolerance: f64) -> (f64, Evidence) {
        if self.proved <= tolerance || self.proved <= self.sampled {
            (self.proved, Evidence::Proved)
        } else {
            (self.sampled, Evidence::Sampled)
        }
    }
}

/// Judges a triangle by its corners, the surface's normals there, and their places.
pub(in crate::geometry::tessellate) fn judge(
    chart: &impl Chart,
    (corners, normals): ([Corner; 3], [DVec3; 3]),
    places: [DVec3; 3],
    wanted: f64,
) -> Verdict {
    let normal = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
    let proved = prove(chart, &corners, normal);
    if proved <= wanted && proved.is_finite() {
        // What the samples would say is no more.
        return Verdict { proved, sampled: proved, sides: [0.0; 3] };
    }
    let tilted = normals.iter().any(|own| own.dot(normal) <= 0.0);
    let (sampled, sides) = sample(chart, &corners, &places, (normal, tilted));
    Verdict { proved, sampled, sides }
}

/// Parameters halfway between two corners.
pub(super) fn halfway(a: &Corner, b: &Corner) -> (f64, f64) {
    between(a, b, 0.5)
}

/// Parameters at a part of the way between two corners. A pole takes the free one of its partner.
fn between(a: &Corner, b: &Corner, part: f64) -> (f64, f64) {
    let mix = |a: f64, b: f64| a * (1.0 - part) + b * part;
    let u = match (a.free, b.free) {
        (Free::U, Free::U) | (Free::Neither | Free::V, Free::Neither | Free::V) => mix(a.u, b.u),
        (Free::U, _) => b.u,
        (_, Free::U) => a.u,
    };
    let v = match (a.free, b.free) {
        (Free::V, Free::V) | (Free::Neither | Free::U, Free::Neither | Free::U) => mix(a.v, b.v),
        (Free::V, _) => b.v,
        (_, Free::V) => a.v,
    };
    (u, v)
}

fn sample(
    chart: &impl Chart,
    corners: &[Corner; 3],
    places: &[DVec3; 3],
    (normal, tilted): (DVec3, bool),
) -> (f64, [f64; 3]) {
    let mut least = f64::INFINITY;
    let mut away = |(u, v): (f64, f64), place: DVec3| {
        let jet = chart.jet(u, v);
        least = least.min(jet.normal.dot(normal));
        (place - jet.point).dot(jet.normal)
    };
    let mut odd = 0.0_f64;
    let sides = [0, 1, 2].map(|side| {
        let (i, j) = ((side + 1) % 3, (side + 2) % 3);
        let mut at =
            |part: f64| away(between(&corners[i], &corners[j], part), places[i].lerp(places[j], part));
        let (near, far) = (at(0.25), at(0.75));
        // A quadratic bend leaves out three quarters of its most here; what differs is of the third order.
        odd = odd.max((near - far).abs() / 2.0 * MOST_OF_THE_ODD);
        (near + far) / 1.5
    });
    let center = away(centroid(corners), (places[0] + places[1] + places[2]) / 3.0).abs();
    if least < FOLDED || tilted {
        return (f64::INFINITY, [0.0; 3]);
    }
    // At the centroid of a quadratic surface the sides contribute four ninths each.
    let expected = (sides[0] + sides[1] + sides[2]).abs() * 4.0 / 9.0;
    let bound = greatest(sides.map(|side| 4.0 * side)) + odd + (center - expected).max(0.0);
    (bound * MARGIN, sides.map(|side| side.abs() + odd * 0.1))
}

fn centroid(corners: &[Corner; 3]) -> (f64, f64) {
    let mut sum = (0.0, 0.0);
    for k in 0..3 {
        let (one, other) = (&corners[(k + 1) % 3], &corners[(k + 2) % 3]);
        let (mut u, mut v) = (corners[k].u, corners[k].v);
        match corners[k].free {
            Free::U => u = (one.u + other.u) / 2.0,
            Free::V => v = (one.v + other.v) / 2.0,
            Free::Neither => {}
        }
        sum = (sum.0 + u / 3.0, sum.1 + v / 3.0);
    }
    sum
}

/// The greatest size over a triangle of a quadratic function that vanishes at the corners: the sum of `m[k]` times
/// the product of the two other barycentric coordinates.
pub(super) fn greatest([a, b, c]: [f64; 3]) -> f64 {
    let sides = a.abs().max(b.abs()).max(c.abs()) / 4.0;
    let weights = [a * (b + c - a), b * (c + a - b), c * (a + b - c)];
    let inside = weights.iter().all(|weight| *weight > 0.0) || weights.iter().all(|weight| *weight < 0.0);
    let sum: f64 = weights.iter().sum();
    if inside && sum != 0.0 { sides.max((a * b * c / sum).abs()) } else { sides }
}

/// A range as its middle and how far it reaches from it along a direction.
fn along(range: &Bounds, direction: DVec3) -> (f64, f64) {
    let reach = (range.max - range.min).dot(direction.abs()) / 2.0;
    (range.center().dot(direction), reach)
}

fn prove(chart: &impl Chart, corners: &[Corner; 3], normal: DVec3) -> f64 {
    let extent = |values: [f64; 3]| {
        let low = values.into_iter().fold(f64::INFINITY, f64::min);
        (low, values.into_iter().fold(f64::NEG_INFINITY, f64::max))
    };
    let (u, v) = (extent(corners.map(|corner| corner.u)), extent(corners.map(|corner| corner.v)));
    let (h, k) = (u.1 - u.0, v.1 - v.0);
    let limits = chart.limits();
    let Some(range) = chart.second_range(widened(u, limits.0), widened(v, limits.1)) else {
        return f64::INFINITY;
    };
    if corners.iter().any(|corner| corner.free != Free::Neither) {
        let (height, shift) = at_pole(&range, normal, (h, k));
        return hypot(height, shift);
    }
    let middle = || chart.jet((u.0 + u.1) / 2.0, (v.0 + v.1) / 2.0);
    bound(&range, middle, (normal, steps(corners)), (h, k), 0.0)
}

/// An interval of parameters as it is widened for the proof.
pub(super) fn widened((low, high): (f64, f64), within: (f64, f64)) -> (f64, f64) {
    let more = WIDER * (high - low);
    ((low - more).max(within.0), (high + more).min(within.1))
}

/// The sides of a triangle as steps of the parameters; side k lies opposite of corner k.
pub(super) fn steps(corners: &[Corner; 3]) -> [(f64, f64); 3] {
    [0, 1, 2].map(|k| {
        let (a, b) = (&corners[(k + 1) % 3], &corners[(k + 2) % 3]);
        (b.u - a.u, b.v - a.v)
    })
}

/// A proved bound for a triangle by its normal and its steps: from the range over its widened rectangle of parameters,
/// which is h wide and k high before it is widened, and the jet in the middle of that. A bound no greater than `enough`
/// need not be the least.
pub(super) fn bound(
    range: &SecondRange,
    middle: impl FnOnce() -> SurfaceJet,
    (normal, steps): (DVec3, [(f64, f64); 3]),
    (h, k): (f64, f64),
    enough: f64,
) -> f64 {
    let (height, shift) = plain(range, normal, steps, (h, k));
    let simple = hypot(height, shift);
    if simple <= enough {
        return simple;
    }
    let middle = middle();
    let (across, up) = (middle.du * h, middle.dv * k);
    // How the tangents change over the widened range, from its middle.
    let size = |range: &Bounds| range.min.abs().max(range.max.abs()).length();
    let reach = 0.5 + WIDER;
    let (uu, uv, vv) = (size(&range.uu) * h * h, size(&range.uv) * h * k, size(&range.vv) * k * k);
    let change = hypot(uu + uv, uv + vv) * reach;
    let flat = |vector: DVec3| vector - normal * vector.dot(normal);
    let apart = flat(across).cross(flat(up)).length() / hypot(across.length(), up.length());
    let apart = apart - change;
    if apart <= 0.0 || shift > WIDER * apart {
        return simple;
    }
    let most = |range: &Bounds| {
        let (middle, reach) = along(range, normal);
        middle.abs() + reach
    };
    let (nuu, nuv, nvv) = (most(&range.uu) * h * h, most(&range.uv) * h * k, most(&range.vv) * k * k);
    let slope =
        hypot(across.dot(normal).abs() + (nuu + nuv) * reach, up.dot(normal).abs() + (nuv + nvv) * reach);
    simple.min(height + slope * shift / apart)
}

/// Height and shift of the difference where both parameters are linear on the triangle.
fn plain(range: &SecondRange, normal: DVec3, steps: [(f64, f64); 3], (h, k): (f64, f64)) -> (f64, f64) {
    let ((uu, ruu), (uv, ruv), (vv, rvv)) =
        (along(&range.uu, normal), along(&range.uv, normal), along(&range.vv, normal));
    let bends = steps.map(|(du, dv)| (uu * du * du + 2.0 * uv * du * dv + vv * dv * dv) / 2.0);
    let rest = (h * h * ruu + 2.0 * h * k * ruv + k * k * rvv) / 8.0;
    let height = greatest(bends) + rest;
    let flat = |vector: DVec3| vector - normal * vector.dot(normal);
    let centers = [range.uu, range.uv, range.vv].map(|range| flat(range.center()));
    let shifts = steps.map(|(du, dv)| {
        (centers[0] * (du * du) + centers[1] * (2.0 * du * dv) + centers[2] * (dv * dv)).length() / 2.0
    });
    let most = shifts.into_iter().fold(0.0, f64::max);
    // The products of two barycentric coordinates are at most a quarter each, and a third together.
    let shift = (most / 3.0).min(shifts.iter().sum::<f64>() / 4.0);
    let half = |range: &Bounds| (range.max - range.min).length() / 2.0;
    let rest = (h * h * half(&range.uu) + 2.0 * h * k * half(&range.uv) + k * k * half(&range.vv)) / 8.0;
    (height, shift + rest)
}

/// The same for a triangle with one corner on a pole. It is paired as the quadrilateral that has this corner
/// twice, whose parameters are bilinear on it: then the twist does not count.
fn at_pole(range: &SecondRange, normal: DVec3, (h, k): (f64, f64)) -> (f64, f64) {
    let most = |range: &Bounds| {
        let (middle, reach) = along(range, normal);
        middle.abs() + reach
    };
    let height = (h * h * most(&range.uu) + k * k * most(&range.vv)) / 8.0;
    let flat = |range: &Bounds| {
        let center = range.center();
        let half = (range.max - range.min).length() / 2.0;
        (center - normal * center.dot(normal)).length() + half
    };
    let shift = (h * h * flat(&range.uu) + k * k * flat(&range.vv)) / 8.0;
    (height, shift)
}

/// How far the line of a rim may lie from its chord between two corners: along the whole line the component
/// across the chord vanishes at both ends.
pub(in crate::geometry::tessellate) fn judge_chord(
    chart: &impl Chart,
    (a, b): (&Corner, &Corner),
    places: [DVec3; 2],
    tolerance: f64,
) -> (f64, Evidence) {
    let direction = (places[1] - places[0]).normalize_or_zero();
    let across = |vector: DVec3| vector - direction * vector.dot(direction);
    let order = |a: f64, b: f64| (a.min(b), a.max(b));
    let (start, end) = (between(a, b, 0.0), between(a, b, 1.0));
    let (u, v) = (order(start.0, end.0), order(start.1, end.1));
    let (h, k) = (end.0 - start.0, end.1 - start.1);
    let proved = chart.second_range(u, v).map_or(f64::INFINITY, |range| {
        let center =
            range.uu.center() * (h * h) + range.uv.center() * (2.0 * h * k) + range.vv.center() * (k * k);
        let half = |range: &Bounds| (range.max - range.min).length() / 2.0;
        let rest = half(&range.uu) * h * h + 2.0 * half(&range.uv) * (h * k).abs() + half(&range.vv) * k * k;
        (across(center).length() + rest) / 8.0
    });
    if proved <= tolerance {
        return (proved, Evidence::Proved);
    }
    let at = |part: f64| {
        let (u, v) = between(a, b, part);
        across(chart.jet(u, v).point - places[0]).length()
    };
    let sampled = [0.25, 0.5, 0.75].into_iter().map(at).fold(0.0, f64::max) * MARGIN;
    if proved <= sampled { (proved, Evidence::Proved) } else { (sampled, Evidence::Sampled) }
}
