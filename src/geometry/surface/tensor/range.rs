//! Bounds on second derivatives of quotients A / w.
//!
//! With S = A / w, `S_u = (A_u - w_u S) / w`, `S_uu = (A_uu - w_uu S - 2 w_u S_u) / w` and
//! `S_uv = (A_uv - w_u S_v - w_v S_u - w_uv S) / w`. Each factor lies in the hull of the control points of its own polynomial over the part.
//! The surface is moved first so that the part lies about the origin: then S is as small as the part, and what
//! the boxes overestimate falls with its size.

use glam::{DVec3, DVec4};

use super::net::Net;
use super::patches::{Part, Patches};
use crate::geometry::number::Bounds;
use crate::geometry::surface::SecondRange;

/// How often a part is halved both ways until its weights are seen to be positive.
const HALVINGS: u32 = 6;

/// Numbers from the least to the greatest.
#[derive(Clone, Copy)]
struct Interval {
    low: f64,
    high: f64,
}

impl Interval {
    /// One over every number; none is zero or less.
    fn inverse(self) -> Self {
        Self { low: 1.0 / self.high, high: 1.0 / self.low }
    }

    fn scaled(self, factor: f64) -> Self {
        Self { low: self.low * factor, high: self.high * factor }
    }
}

/// The box of a vector of a box, times a number of an interval.
fn product(vectors: &Bounds, numbers: Interval) -> Bounds {
    let corners = [
        vectors.min * numbers.low,
        vectors.min * numbers.high,
        vectors.max * numbers.low,
        vectors.max * numbers.high,
    ];
    Bounds::of_points(corners)
}

fn difference(a: &Bounds, b: &Bounds) -> Bounds {
    Bounds { min: a.min - b.max, max: a.max - b.min }
}

/// The hull of a net of homogeneous points: box of A and interval of w.
struct Hull {
    vectors: Bounds,
    weights: Interval,
}

impl Hull {
    fn of(net: &Net<DVec4>) -> Self {
        let mut hull = Self {
            vectors: Bounds::EMPTY,
            weights: Interval { low: f64::INFINITY, high: f64::NEG_INFINITY },
        };
        for point in net.points() {
            hull.vectors = hull.vectors.with_point(point.truncate());
            hull.weights.low = hull.weights.low.min(point.w);
            hull.weights.high = hull.weights.high.max(point.w);
        }
        hull
    }
}

/// Boxes of the second derivatives by local parameters over a part of a piece of positive weights; `None` where
/// the weights come so near to zero that halving does not show them to be positive.
pub(super) fn second_range(patches: &Patches<DVec4>, part: &Part) -> Option<SecondRange> {
    halved(patches, part, HALVINGS)
}

fn halved(patches: &Patches<DVec4>, part: &Part, left: u32) -> Option<SecondRange> {
    if let Some(range) = whole(patches, part) {
        return Some(range);
    }
    let left = left.checked_sub(1)?;
    let halves = |(from, to): (f64, f64)| {
        let middle = f64::midpoint(from, to);
        [(from, middle), (middle, to)]
    };
    let quarters = halves(part.u).into_iter().flat_map(|u| halves(part.v).map(|v| Part { u, v, ..*part }));
    let mut all: Option<SecondRange> = None;
    for quarter in quarters {
        let range = halved(patches, &quarter, left)?;
        all = Some(all.map_or(range, |all| union(&all, &range)));
    }
    all
}

pub(super) fn union(one: &SecondRange, other: &SecondRange) -> SecondRange {
    SecondRange { uu: one.uu.union(other.uu), uv: one.uv.union(other.uv), vv: one.vv.union(other.vv) }
}

/// The bound without halving; `None` where a weight of the part's control points is not positive.
fn whole(patches: &Patches<DVec4>, part: &Part) -> Option<SecondRange> {
    let middle = (f64::midpoint(part.u.0, part.u.1), f64::midpoint(part.v.0, part.v.1));
    let center = patches.jet(part.piece, middle)[0];
    if center.w <= 0.0 {
        return None;
    }
    let origin = center.truncate() / center.w;
    let moved: Vec<DVec4> = patches
        .piece(part.piece)
        .iter()
        .map(|point| (point.truncate() - origin * point.w).extend(point.w))
        .collect();
    let net = || Net::new(&moved, patches.degree().0 + 1);
    let of = |net: Net<DVec4>| Hull::of(&net.restricted(part.u, part.v));
    let points = net().restricted(part.u, part.v);
    let weights = Hull::of(&points).weights;
    if weights.low <= 0.0 {
        return None;
    }
    // The surface lies in the hull of its control points, since all weights are positive.
    let s = Bounds::of_points(points.points().iter().map(|point| point.truncate() / point.w));
    let over = weights.inverse();
    let (u, v) = (of(net().derived_u()), of(net().derived_v()));
    let first = |hull: &Hull| product(&difference(&hull.vectors, &product(&s, hull.weights)), over);
    let (s_u, s_v) = (first(&u), first(&v));
    let twice = |hull: &Hull, first: &Hull, slope: &Bounds| {
        let rest = difference(&hull.vectors, &product(&s, hull.weights));
        product(&difference(&rest, &product(slope, first.weights.scaled(2.0))), over)
    };
    let uv = of(net().derived_u().derived_v());
    let mixed = difference(&uv.vectors, &product(&s, uv.weights));
    let mixed = difference(&mixed, &product(&s_v, u.weights));
    Some(SecondRange {
        uu: twice(&of(net().derived_u().derived_u()), &u, &s_u),
        uv: product(&difference(&mixed, &product(&s_u, v.weights)), over),
        vv: twice(&of(net().derived_v().derived_v()), &v, &s_v),
    })
}

/// Whether the weights of a piece are seen to be positive everywhere, by halving; what is zero anywhere is not.
pub(super) fn positive(weights: &[f64], columns: usize) -> bool {
    /// Weights that need more parts than this come nearer to zero than a person means.
    const PARTS: usize = 4096;
    let mut rest = vec![((0.0, 1.0), (0.0, 1.0))];
    for _ in 0..PARTS {
        let Some((u, v)) = rest.pop() else { return true };
        let net = Net::new(weights, columns).restricted(u, v);
        if net.points().iter().all(|weight| *weight > 0.0) {
            continue;
        }
        // At its corners a net is the surface.
        let last = net.points().len() - 1;
        let corners = [0, columns - 1, last + 1 - columns, last];
        if corners.iter().any(|corner| net.points()[*corner] <= 0.0) {
            return false;
        }
        let (x, y) = (f64::midpoint(u.0, u.1), f64::midpoint(v.0, v.1));
        for u in [(u.0, x), (x, u.1)] {
            rest.extend([(v.0, y), (y, v.1)].map(|v| (u, v)));
        }
    }
    false
}

/// Scales boxes of local derivatives to those by the parameters of the surface.
pub(super) fn scaled(range: &SecondRange, (across, up): (f64, f64)) -> SecondRange {
    let over = |bounds: &Bounds, by: f64| Bounds { min: bounds.min / by, max: bounds.max / by };
    SecondRange {
        uu: over(&range.uu, across * across),
        uv: over(&range.uv, across * up),
        vv: over(&range.vv, up * up),
    }
}

/// The point of homogeneous coordinates and its first derivatives, from those of the coordinates.
#[inline]
pub(super) fn projected([a, a_u, a_v]: [DVec4; 3]) -> [DVec3; 3] {
    let over = 1.0 / a.w;
    let point = a.truncate() * over;
    let slope = |by: DVec4| (by.truncate() - point * by.w) * over;
    [point, slope(a_u), slope(a_v)]
}
