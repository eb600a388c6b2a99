//! Small polygons without holes, by cutting ears: quicker than anything that needs a table.
//!
//! Exact: an ear is cut only where no other corner lies in its triangle or on its border, so the result is right or
//! there is none. Of the ears, the one with the greatest least angle goes first.
//!
//! Source: G. Meisters, Polygons have ears, American Mathematical Monthly 82 (1975).

use glam::DVec2;

use super::Polygon;
use crate::geometry::planar::turn;

/// Most corners that are cut so: the work grows with their third power.
pub(super) const MOST: usize = 12;

/// Triangles of a ring of few corners; `None` where it touches or crosses itself, or has holes or many corners.
pub(super) fn cut(polygon: &Polygon) -> Option<Vec<[u32; 3]>> {
    if polygon.ring_ends.len() > 1 || polygon.corners.len() > MOST {
        return None;
    }
    let mut left: Vec<u32> = (0..crate::geometry::mesh::index(polygon.corners.len())).collect();
    let mut triangles = Vec::with_capacity(left.len());
    while left.len() > 3 {
        let ears = (0..left.len()).filter_map(|k| Some((quality(polygon, &left, k)?, k)));
        // The first of equal ears, whatever the order of comparing.
        let (_, best) = ears.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
        triangles.push(around(&left, best));
        left.remove(best);
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    (polygon.turn(last) > 0.0).then_some(triangles)
}

fn around(left: &[u32], k: usize) -> [u32; 3] {
    [left[(k + left.len() - 1) % left.len()], left[k], left[(k + 1) % left.len()]]
}

/// How good the triangle of an ear is: the sine of its least angle, about. `None` where corner k is no ear.
fn quality(polygon: &Polygon, left: &[u32], k: usize) -> Option<f64> {
    let ear = around(left, k);
    let area = polygon.turn(ear);
    let [a, b, c] = ear.map(|corner| polygon.corners[corner as usize]);
    let outside =
        |point: DVec2| turn(a, b, point) < 0.0 || turn(b, c, point) < 0.0 || turn(c, a, point) < 0.0;
    let clear = || {
        let others = left.iter().filter(|corner| !ear.contains(corner));
        others.into_iter().all(|corner| outside(polygon.corners[*corner as usize]))
    };
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (area > 0.0 && clear()).then(|| area / longest)
}
