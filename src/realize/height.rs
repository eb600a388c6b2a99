//! Distance to height maps.

use glam::DVec3;

use crate::geometry::number::Bounds;
use crate::geometry::tessellate::{Closing, HeightMap, TwoSided};

/// Distance from a point to a nearest point of the surface, from the place below it downhill along the tangent planes;
/// never less than the distance to the whole surface.
pub(super) fn distance(map: &HeightMap, point: DVec3) -> f64 {
    let inside = |point: DVec3| {
        let [right, bottom] = map.field.extent();
        let [x, y] = map.place(point);
        [x.clamp(0.0, right), y.clamp(0.0, bottom)]
    };
    let foot = |place: [f64; 2]| map.point(place, map.field.value(place[0], place[1]));
    let mut place = inside(point);
    let mut nearest = foot(place);
    let mut best = nearest.distance(point);
    for _ in 0..6 {
        let slopes = map.slopes(place);
        let normal = DVec3::new(-slopes.x, 1.0, -slopes.y).normalize();
        // The foot of the perpendicular on the tangent plane.
        let aim = point - normal * (point - nearest).dot(normal);
        let next = inside(aim);
        let reached = foot(next);
        let away = reached.distance(point);
        if away >= best {
            break;
        }
        (place, nearest, best) = (next, reached, away);
    }
    best
}

/// The box around a map with what closes it.
pub(super) fn extent(map: &HeightMap) -> Bounds {
    let (mut low, high) = map.field.range();
    match map.close {
        Closing::None => {}
        Closing::Base(base) => low = low.min(base),
        Closing::Thickness(depth) => low -= depth,
    }
    let half = map.size / 2.0;
    Bounds { min: DVec3::new(-half.x, low, -half.y), max: DVec3::new(half.x, high, half.y) }
}

/// The box around both sides of a plane.
pub(super) fn extent_of_two(body: &TwoSided) -> Bounds {
    let [front, back] = [&body.front, &body.back].map(|map| map.field.range().1.max(0.0));
    let half = body.front.size / 2.0;
    Bounds { min: DVec3::new(-half.x, -back, -half.y), max: DVec3::new(half.x, front, half.y) }
}
