//! Polygons whose corners stand on one circle: the ends of what is turned, and of tubes.

use glam::DVec2;

use super::Polygon;
use crate::geometry::mesh::index;

/// How far corners may be off the circle, as a share of its radius.
const OFF: f64 = 1e-9;

/// Cut by halving arcs. On a circle every cut is Delaunay, and this one has the fewest slender triangles. `None` where
/// the corners stand otherwise, or do not go around once.
pub(super) fn cut(polygon: &Polygon) -> Option<Vec<[u32; 3]>> {
    let corners = &polygon.corners;
    let count = corners.len();
    if polygon.ring_ends.len() != 1 || count < 5 {
        return None;
    }
    let [first, second] = [count / 3, 2 * count / 3];
    let center = circumcenter(corners[0], corners[first], corners[second])?;
    let radius = center.distance(corners[0]);
    let on = |corner: &DVec2| (center.distance(*corner) - radius).abs() <= OFF * radius;
    let mut upward = 0;
    for (k, a) in corners.iter().enumerate() {
        let b = &corners[(k + 1) % count];
        upward += u32::from(a.y < center.y && b.y >= center.y);
        if !on(a) || (*a - center).perp_dot(*b - center) <= 0.0 {
            return None;
        }
    }
    let mut triangles = vec![[0, index(first), index(second)]];
    let mut arcs = vec![(0, first), (first, second), (second, count)];
    while let Some((start, end)) = arcs.pop() {
        if end - start < 2 {
            continue;
        }
        let middle = usize::midpoint(start, end);
        triangles.push([index(start), index(middle), index(end % count)]);
        arcs.extend([(start, middle), (middle, end)]);
    }
    let sound = upward == 1 && triangles.iter().all(|triangle| polygon.turn(*triangle) > 0.0);
    sound.then_some(triangles)
}

/// The center of the circle through three points; none where they stand on one line.
fn circumcenter(a: DVec2, b: DVec2, c: DVec2) -> Option<DVec2> {
    let (b, c) = (b - a, c - a);
    let twice = 2.0 * b.perp_dot(c);
    let center = a + (c.length_squared() * b - b.length_squared() * c).perp() / twice;
    (twice != 0.0 && center.is_finite()).then_some(center)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::{circumcenter, cut};
    use crate::geometry::mesh::triangulate::Polygon;
    use crate::geometry::number::sin_cos_degrees;

    fn around(angles: impl Iterator<Item = f64>) -> Vec<DVec2> {
        let at = |angle: f64| {
            let (sin, cos) = sin_cos_degrees(angle);
            DVec2::new(3.0 + 2.0 * cos, 2.0 * sin - 1.0)
        };
        angles.map(at).collect()
    }

    #[test]
    fn three_points_have_their_center() {
        let [a, b, c] = [10.0, 95.0, 300.0].map(|angle| around(std::iter::once(angle))[0]);
        assert!(circumcenter(a, b, c).unwrap().distance(DVec2::new(3.0, -1.0)) < 1e-14);
        assert_eq!(circumcenter(a, a, c), None);
    }

    #[test]
    fn only_rings_once_around_a_circle_are_taken() {
        let once = around((0..40).map(|k| f64::from(k * k) * 0.2));
        assert_eq!(cut(&Polygon::new(&[&once]).unwrap()).map(|triangles| triangles.len()), Some(38));
        let twice = around((0..9).map(|k| 80.0 * f64::from(k)));
        assert_eq!(cut(&Polygon::new(&[&twice]).unwrap()), None);
        let mut dented = once;
        dented[7] *= 1.0 + 1e-6;
        assert_eq!(cut(&Polygon::new(&[&dented]).unwrap()), None);
    }
}
