//! Distance to height maps.

use glam::DVec3;

use super::window::Window;
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::{BasedMap, Closing, HeightMap, Layer, TwoSided};

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
        Closing::None | Closing::Ends => {}
        Closing::Base(base) => low = low.min(base),
        Closing::Thickness(depth) => low -= depth,
    }
    let half = map.size / 2.0;
    Bounds { min: DVec3::new(-half.x, low, -half.y), max: DVec3::new(half.x, high, half.y) }
}

/// Distance from a point to a nearest point of a skin found around the corners of a triangle, by Gauss and Newton's method;
/// never less than the distance to the whole skin.
pub(super) fn distance_to_skin(map: &BasedMap, layer: Layer, point: DVec3, window: &Window) -> f64 {
    let [right, bottom] = map.heights().field.extent();
    let middle = |of: [f64; 3]| of.iter().sum::<f64>() / 3.0;
    let corners = [0, 1, 2].map(|k| [window.u[k], window.v[k]]);
    let starts = core::iter::once([middle(window.u), middle(window.v)]).chain(corners);
    let from = |mut place: [f64; 2]| {
        let mut best = f64::INFINITY;
        for _ in 0..8 {
            let jet = map.jet(layer, place);
            let away = point - jet.point;
            if away.length() >= best * (1.0 - 1e-9) {
                return best.min(away.length());
            }
            best = away.length();
            let (a, b, c) = (jet.dx.length_squared(), jet.dx.dot(jet.dy), jet.dy.length_squared());
            let (x, y) = (away.dot(jet.dx), away.dot(jet.dy));
            let determinant = a * c - b * b;
            let step = if determinant > 1e-15 * a * c {
                [(x * c - y * b) / determinant, (y * a - x * b) / determinant]
            } else if c > 0.0 {
                [0.0, y / c]
            } else {
                return best;
            };
            place = [(place[0] + step[0]).clamp(0.0, right), (place[1] + step[1]).clamp(0.0, bottom)];
        }
        best
    };
    starts.map(from).fold(f64::INFINITY, f64::min)
}

/// Points of a map over a curved base: its samples, no more than some thousands, on all of its skins.
pub(super) fn points_of_based(map: &BasedMap) -> Vec<DVec3> {
    const MOST: usize = 96;
    let field = &map.heights().field;
    let [right, bottom] = field.extent();
    let (m, n) = (field.columns().clamp(32, MOST), field.rows().clamp(32, MOST));
    let part = |k: usize, of: usize, end: f64| end * (k as f64 / (of - 1) as f64);
    let layers = map.layers();
    let places = (0..n).flat_map(|j| (0..m).map(move |i| [part(i, m, right), part(j, n, bottom)]));
    places.flat_map(|place| layers.iter().map(move |layer| map.jet(*layer, place).point)).collect()
}

/// The box around both sides of a plane.
pub(super) fn extent_of_two(body: &TwoSided) -> Bounds {
    let [front, back] = [&body.front, &body.back].map(|map| map.field.range().1.max(0.0));
    let half = body.front.size / 2.0;
    Bounds { min: DVec3::new(-half.x, -back, -half.y), max: DVec3::new(half.x, front, half.y) }
}
