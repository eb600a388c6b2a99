//! The directions in which the distance to triangles can grow where a plane, an edge or a corner is nearest.
//!
//! Notation: a place p whose nearest point is a corner q lies in the polar cone of the edges e that leave q: (p - q) . e ≤ 0
//! for all of them. Its rays are among the ± e × f.

use glam::DVec3;

use crate::geometry::number::atan2;

/// Rounding of unit vectors.
const SLACK: f64 = 1e-12;
/// How far a ray may lie beyond an edge for rounding of its corners.
const BESIDE: f64 = 1e-7;
/// Cosine of the half angle of a cone of which nothing is told.
const WIDE: f64 = 0.05;
/// More edges at a corner are not paired.
const MOST_EDGES: usize = 24;

/// A box of unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cone {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Cone {
    /// All directions.
    pub(super) const ALL: Self = Self { low: DVec3::NEG_ONE, high: DVec3::ONE };

    /// One direction.
    pub(super) fn of_one(direction: DVec3) -> Self {
        Self { low: direction - SLACK, high: direction + SLACK }
    }

    /// Those of both.
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Those of both alone; none where there are none.
    fn meet(self, other: Self) -> Option<Self> {
        let both = Self { low: self.low.max(other.low), high: self.high.min(other.high) };
        both.low.cmple(both.high).all().then_some(both)
    }

    /// Those of them in which places lead that lie no further than `room` from one that is `away` from its nearest point; none
    /// where that is the nearest point of no place. `outward` is outside.
    pub(super) fn seen(self, away: DVec3, room: f64, outward: DVec3) -> Option<Self> {
        let distance = away.length();
        if distance <= 2.0 * room {
            return Some(self);
        }
        // What moves by less than it is away turns by less than the sine says.
        let sine = room / distance + SLACK;
        let (axis, upright) = (away / distance, away.dot(outward) / (distance * outward.length()));
        if upright.is_nan() || upright.abs() <= sine {
            return Some(self);
        }
        self.meet(Self::around(axis * upright.signum(), (1.0 - sine * sine).sqrt()))
    }

    /// Whether it holds one direction alone.
    pub(super) fn is_one(self) -> bool {
        (self.high - self.low).max_element() <= 4.0 * SLACK
    }

    /// The directions no further from an axis than an angle, by its cosine.
    fn around(axis: DVec3, cosine: f64) -> Self {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let across = |part: f64| (1.0 - part * part).max(0.0).sqrt() * sine;
        let high = |part: f64| if part >= cosine { 1.0 } else { part * cosine + across(part) };
        let low = |part: f64| if part <= -cosine { -1.0 } else { part * cosine - across(part) };
        let of = |end: &dyn Fn(f64) -> f64| DVec3::new(end(axis.x), end(axis.y), end(axis.z));
        Self { low: of(&low) - SLACK, high: of(&high) + SLACK }
    }
}

/// The angle between unit vectors.
pub(super) fn angle(one: DVec3, other: DVec3) -> f64 {
    atan2(one.cross(other).length(), one.dot(other))
}

/// How far a point is from a segment, and its way from the line through it.
pub(super) fn far(from: DVec3, to: DVec3, point: DVec3) -> (f64, DVec3) {
    let along = to - from;
    let square = along.length_squared();
    let share = if square > 0.0 { (point - from).dot(along) / square } else { 0.0 };
    ((from + along * share.clamp(0.0, 1.0)).distance(point), point - (from + along * share))
}

/// The directions at an edge: the arc from the one normal to the other.
pub(super) fn of_edge(planes: &[DVec3]) -> Cone {
    let [one, other] = *planes else { return Cone::ALL };
    let Some(middle) = (one + other).try_normalize().filter(|middle| middle.dot(one) > WIDE) else {
        return Cone::ALL;
    };
    let ends = Cone::of_one(one).union(Cone::of_one(other));
    let aside = other - middle * other.dot(middle);
    let (cosine, sine) = (other.dot(middle), aside.length());
    let Some(aside) = aside.try_normalize() else { return ends };
    let (mut low, mut high) = (ends.low, ends.high);
    for axis in 0..3 {
        // u cos t + w sin t over the arc: between its ends where its slope changes sign.
        let (u, w) = (middle[axis], aside[axis]);
        let slopes = [u * sine + w * cosine, w * cosine - u * sine];
        let most = (u * u + w * w).sqrt() + SLACK;
        if slopes[0] > 0.0 && slopes[1] < 0.0 {
            high[axis] = high[axis].max(most);
        }
        if slopes[0] < 0.0 && slopes[1] > 0.0 {
            low[axis] = low[axis].min(-most);
        }
    }
    Cone { low, high }
}

/// The directions at a corner with these planes around it and edges that leave it; `outward` is outside.
pub(super) fn of_corner(planes: &[DVec3], edges: &[DVec3], outward: DVec3) -> Cone {
    let Some(outward) = outward.try_normalize() else { return Cone::ALL };
    if planes.iter().all(|plane| plane.distance(outward) <= SLACK) {
        return Cone::of_one(outward);
    }
    if edges.len() > MOST_EDGES {
        return Cone::ALL;
    }
    let mut rays: Vec<DVec3> = Vec::new();
    for (number, one) in edges.iter().enumerate() {
        for other in &edges[number + 1..] {
            let Some(ray) = one.cross(*other).try_normalize() else { continue };
            let is_ray = |ray: DVec3| edges.iter().all(|edge| ray.dot(*edge) <= BESIDE);
            rays.extend([ray, -ray].into_iter().filter(|ray| is_ray(*ray)));
        }
    }
    // Nothing is nearest to a corner whose edges lie to all sides of it.
    if rays.is_empty() {
        return planes.iter().map(|plane| Cone::of_one(*plane)).reduce(Cone::union).unwrap_or(Cone::ALL);
    }
    let upright = rays.iter().all(|ray| ray.dot(outward).abs() > 0.9);
    let side = rays.iter().map(|ray| ray.dot(outward)).sum::<f64>();
    for ray in &mut rays {
        // Of a nearly flat corner rays look to both sides; those of others all to one.
        if if upright { ray.dot(outward) } else { side } < 0.0 {
            *ray = -*ray;
        }
    }
    let Some(axis) = rays.iter().sum::<DVec3>().try_normalize() else { return Cone::ALL };
    let cosine = rays.iter().map(|ray| ray.dot(axis)).fold(1.0, f64::min);
    if cosine > WIDE { Cone::around(axis, cosine) } else { Cone::ALL }
}
