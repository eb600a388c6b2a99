//! Places on a surface and on its edges, found by Newton's method.

use core::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use crate::geometry::field::{AnyField, Field};

/// What looks for places on a surface.
#[derive(Clone, Copy)]
pub(super) struct Probe<'a> {
    pub(super) field: &'a AnyField,
    /// About how large the body is.
    pub(super) size: f64,
    /// What was asked of the field.
    pub(super) work: &'a Work,
    /// Whether triangles in it stand for something smooth.
    faceted: bool,
}

/// Counts how often a field is asked. Sums do not depend on the order of what is added, so a budget that is compared
/// between parallel parts ends work at the same place for any number of threads.
#[derive(Debug, Default)]
pub(super) struct Work(AtomicU64);

impl Work {
    fn add(&self, times: u64) {
        self.0.fetch_add(times, Ordering::Relaxed);
    }

    /// How often the field was asked.
    pub(super) fn spent(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// How often parts of fields may be asked for one surface.
const BUDGET: u64 = 1 << 27;

/// Share of the size at which a step is the last: the next would be its square.
const LAST_STEP: f64 = 1e-8;

impl<'a> Probe<'a> {
    pub(super) fn new(field: &'a AnyField, size: f64, work: &'a Work) -> Self {
        Self { field, size, work, faceted: !field.distances().is_empty() }
    }

    /// The direction in which a surface looks, by the gradient near by.
    fn normal(&self, place: DVec3, gradient: DVec3) -> Option<DVec3> {
        let gradient = if self.faceted { self.field.value_normal(place).1 } else { gradient };
        gradient.try_normalize()
    }
    /// Whether the field was asked as often as it may be.
    pub(super) fn is_spent(&self) -> bool {
        self.work.spent().saturating_mul(self.field.weight()) > BUDGET
    }

    /// The place on the surface to which steps along the gradient lead, not further than `reach`, with the unit normal.
    pub(super) fn settle(&self, from: DVec3, reach: f64) -> Option<(DVec3, DVec3)> {
        let mut place = from;
        for _ in 0..16 {
            self.work.add(1);
            let (value, gradient) = self.field.value_gradient(place);
            let square = gradient.length_squared();
            let step = gradient * (value / square);
            let length = step.length();
            if !length.is_finite() || square == 0.0 {
                return None;
            }
            place -= if length > reach { step * (reach / length) } else { step };
            if place.distance_squared(from) > reach * reach {
                return None;
            }
            if length <= LAST_STEP * self.size {
                let normal = gradient / square.sqrt();
                return Some((
                    place,
                    self.normal(place, gradient).filter(|_| self.faceted).unwrap_or(normal),
                ));
            }
        }
        None
    }

    /// How far a place is from the surface by the slope there, where no place on the surface was found near by.
    pub(super) fn far(&self, place: DVec3) -> f64 {
        let (value, gradient) = self.field.value_gradient(place);
        let by_slope = (value / gradient.length()).abs();
        if by_slope.is_finite() { by_slope } else { 0.0 }
    }

    /// The place on the surface between two places, one inside and one outside, by halving.
    pub(super) fn between(&self, mut inside: DVec3, mut outside: DVec3) -> (DVec3, DVec3) {
        // False position with halved ends (Illinois), then halving: never more than sixty values.
        let (mut low, mut high) = (self.field.value(inside), self.field.value(outside));
        let mut before = 0;
        for step in 0..60 {
            if inside.distance(outside) <= 1e-11 * self.size || low == 0.0 || high == 0.0 {
                break;
            }
            let share = if step < 20 { (low / (low - high)).clamp(0.0, 1.0) } else { 0.5 };
            let share = if share.is_finite() { share } else { 0.5 };
            let middle = inside.lerp(outside, share);
            self.work.add(1);
            let value = self.field.value(middle);
            if value.abs() <= 1e-14 * (low.abs() + high.abs()) {
                (inside, outside) = (middle, middle);
                break;
            }
            if value < 0.0 {
                (inside, low) = (middle, value);
                if before < 0 {
                    high /= 2.0;
                }
                before = -1;
            } else {
                (outside, high) = (middle, value);
                if before > 0 {
                    low /= 2.0;
                }
                before = 1;
            }
        }
        let place = if low.abs() <= high.abs() { inside } else { outside };
        let normal = self.normal(place, self.field.gradient(place));
        let normal = normal.unwrap_or_else(|| (outside - inside).normalize_or(DVec3::Y));
        (place, normal)
    }

    /// The unit gradient a short way from `place` towards another: the normal of that side.
    pub(super) fn normal_towards(&self, place: DVec3, towards: DVec3, share: f64) -> DVec3 {
        self.work.add(1);
        let place = place.lerp(towards, share);
        self.normal(place, self.field.gradient(place)).unwrap_or_default()
    }

    /// The place on the edge between two sides of the surface, near `from`; each side by a place on it.
    pub(super) fn settle_on_edge(&self, from: DVec3, sides: [DVec3; 2]) -> Option<DVec3> {
        let mut place = from;
        for share in [0.3, 0.1, 0.03, 0.01, 0.002] {
            let planes = sides.map(|side| self.plane(place.lerp(side, share)));
            let next = meet(place, planes)?;
            // Sides are where they are: an edge far off is another one.
            let reach = 2.0 * sides[0].distance(from).max(sides[1].distance(from));
            if !next.is_finite() || next.distance(from) > reach {
                return None;
            }
            place = next;
        }
        let [one, other] = sides.map(|side| self.normal_towards(place, side, 0.002));
        Some(self.onto(place, one + other))
    }

    /// A place that was found by planes, moved along a direction onto the surface, which they only nearly tell where it
    /// bends; the place itself where the surface is not beside it.
    pub(super) fn onto(&self, place: DVec3, outward: DVec3) -> DVec3 {
        const CLOSE: f64 = 1e-8;
        const DOUBLINGS: u32 = 12;
        self.work.add(1);
        let (value, gradient) = self.field.value_gradient(place);
        let first = value.abs() / gradient.length();
        if !first.is_finite() || first <= CLOSE * self.size {
            return place;
        }
        for outward in [outward, gradient] {
            let Some(outward) = outward.try_normalize() else { continue };
            let side = if value < 0.0 { outward } else { -outward };
            let mut step = first;
            for _ in 0..DOUBLINGS {
                self.work.add(1);
                let beyond = place + side * step;
                if (self.field.value(beyond) < 0.0) != (value < 0.0) {
                    let (inside, outside) = if value < 0.0 { (place, beyond) } else { (beyond, place) };
                    return self.between(inside, outside).0;
                }
                step *= 2.0;
                if step > 1e-3 * self.size {
                    break;
                }
            }
        }
        place
    }

    /// The place where three sides of the surface meet.
    pub(super) fn settle_on_corner(&self, sides: [DVec3; 3]) -> Option<DVec3> {
        let middle = (sides[0] + sides[1] + sides[2]) / 3.0;
        let reach = sides.iter().map(|side| side.distance(middle)).fold(0.0, f64::max);
        let mut place = middle;
        for share in [1.0, 0.1, 0.03, 0.01, 0.002] {
            let [a, b, c] = sides.map(|side| self.plane(place.lerp(side, share)));
            let determinant = a.1.dot(b.1.cross(c.1));
            if determinant.abs() < 0.03 {
                return None;
            }
            place = (b.1.cross(c.1) * a.0 + c.1.cross(a.1) * b.0 + a.1.cross(b.1) * c.0) / determinant;
            if !place.is_finite() || place.distance(middle) > 3.0 * reach {
                return None;
            }
        }
        let outward = sides.iter().map(|side| self.normal_towards(place, *side, 0.002)).sum();
        Some(self.onto(place, outward))
    }

    /// The plane on which the field would be zero were it flat: n . x = offset.
    fn plane(&self, place: DVec3) -> (f64, DVec3) {
        self.work.add(1);
        let (value, gradient) = self.field.value_gradient(place);
        let length = gradient.length();
        let normal = gradient / length;
        (normal.dot(place) - value / length, normal)
    }
}

/// The place on both planes that is nearest to `from`.
pub(super) fn meet(from: DVec3, [(a, n), (b, m)]: [(f64, DVec3); 2]) -> Option<DVec3> {
    let cosine = n.dot(m);
    let rest = 1.0 - cosine * cosine;
    if rest.is_nan() || rest <= 1e-3 {
        return None;
    }
    let (da, db) = (a - n.dot(from), b - m.dot(from));
    Some(from + n * ((da - cosine * db) / rest) + m * ((db - cosine * da) / rest))
}
