//! Lines that run along both ends of a closed surface get the same places on both.

use glam::DVec2;

use crate::geometry::curve::Domain;
use crate::geometry::surface::{AnySurface, Surface as _};

/// Which opposite sides of a surface are one line in space.
pub(super) struct Seams {
    u: Domain,
    v: Domain,
    /// Of u, then of v.
    closed: [bool; 2],
}

/// Places along a side that are compared.
const PROBES: u32 = 16;

impl Seams {
    pub(super) fn new(surface: &AnySurface) -> Self {
        let (u, v) = (surface.domain_u(), surface.domain_v());
        let point = |place: DVec2| surface.evaluate(place.x, place.y).point;
        let probe = |k: u32, along: Domain| along.at(f64::from(k) / f64::from(PROBES));
        let size = (0..=PROBES)
            .map(|k| {
                point(DVec2::new(probe(k, u), probe(k, v))).distance(point(DVec2::new(u.start, v.start)))
            })
            .fold(0.0, f64::max);
        let same = |one: DVec2, other: DVec2| point(one).distance(point(other)) <= 1e-9 * size;
        let closed_u =
            (0..=PROBES).all(|k| same(DVec2::new(u.start, probe(k, v)), DVec2::new(u.end, probe(k, v))));
        let closed_v =
            (0..=PROBES).all(|k| same(DVec2::new(probe(k, u), v.start), DVec2::new(probe(k, u), v.end)));
        Self { u, v, closed: [closed_u, closed_v] }
    }

    /// Gives both ends of a closed direction the places that either has.
    pub(super) fn match_up(&self, loops: &mut [Vec<DVec2>]) {
        for (axis, domain, along) in [(0, self.u, self.v), (1, self.v, self.u)] {
            if !self.closed[axis] {
                continue;
            }
            let on = |place: &DVec2| place[axis] == domain.start || place[axis] == domain.end;
            let mut values: Vec<f64> =
                loops.iter().flatten().filter(|place| on(place)).map(|place| place[1 - axis]).collect();
            values.sort_by(f64::total_cmp);
            let near = 1e-9 * along.span();
            values.dedup_by(|next, kept| *next - *kept <= near);
            for places in loops.iter_mut() {
                *places = with_values(places, axis, &values, near, &on);
            }
        }
    }
}

fn with_values(
    places: &[DVec2],
    axis: usize,
    values: &[f64],
    near: f64,
    on: &dyn Fn(&DVec2) -> bool,
) -> Vec<DVec2> {
    let nearest = |value: f64| {
        let after = values.partition_point(|known| *known < value - near);
        values.get(after).copied().filter(|known| (known - value).abs() <= near).unwrap_or(value)
    };
    let moved = |place: DVec2| {
        let mut place = place;
        if on(&place) {
            place[1 - axis] = nearest(place[1 - axis]);
        }
        place
    };
    let mut made = Vec::with_capacity(places.len());
    for (k, place) in places.iter().enumerate() {
        let (from, to) = (moved(*place), moved(places[(k + 1) % places.len()]));
        made.push(from);
        if !(on(&from) && on(&to) && from[axis] == to[axis]) {
            continue;
        }
        let (low, high) = (from[1 - axis].min(to[1 - axis]), from[1 - axis].max(to[1 - axis]));
        let mut between: Vec<f64> =
            values.iter().copied().filter(|value| *value > low + near && *value < high - near).collect();
        if from[1 - axis] > to[1 - axis] {
            between.reverse();
        }
        made.extend(between.into_iter().map(|value| {
            let mut place = from;
            place[1 - axis] = value;
            place
        }));
    }
    made.dedup();
    made
}
