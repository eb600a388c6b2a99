//! Triangles of a surface that cross each other, found exactly.
//!
//! Promise: two triangles count as crossing when they share a point that they do not share as corners or as an edge:
//! they run through each other, touch, or lie on each other. Decided by signs of determinants that are exact whatever
//! the rounding; so an empty answer is a proof. Not promised: that triangles without area are told; their neighbors are.
//!
//! Source: J. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997.
//!
//! Cost: a tree of boxes, O(n log n), and a few determinants for each pair whose boxes meet.

use glam::DVec3;
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::index;
use super::tree::Tree;

/// Pairs of triangles that cross, each with the lesser index first, in order. Of one triangle that crosses very many
/// others of greater index no more than [`PAIRS`] are told, so that a heap of triangles takes no quadratic time.
#[must_use]
pub fn crossings(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let tree = Tree::new(points, triangles);
    let mut found: Vec<[u32; 2]> = (0..index(triangles.len()))
        .into_par_iter()
        .flat_map_iter(|one| {
            let mut pairs = Vec::new();
            tree.visit(one, |other| {
                let (a, b) = (triangles[one as usize], triangles[other as usize]);
                if cross(points, a, b) {
                    pairs.push([one, other]);
                }
                pairs.len() < PAIRS
            });
            pairs
        })
        .collect();
    found.sort_unstable();
    found
}

/// Most pairs that are told of one triangle.
pub const PAIRS: usize = 16;

fn solid(point: DVec3) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
}

/// On which side of the plane of a triangle a point lies.
fn side([a, b, c]: [DVec3; 3], point: DVec3) -> f64 {
    orient3d(solid(a), solid(b), solid(c), solid(point))
}

/// Whether two triangles cross, by their corners' numbers.
fn cross(points: &[DVec3], a: [u32; 3], b: [u32; 3]) -> bool {
    let place = |corner: u32| points[corner as usize];
    let shared = a.iter().filter(|corner| b.contains(corner)).count();
    match shared {
        0 => {
            let (p, q) = (a.map(place), b.map(place));
            if apart(p, q) || apart(q, p) {
                return false;
            }
            (0..3).any(|k| pierces([p[k], p[(k + 1) % 3]], q))
                || (0..3).any(|k| pierces([q[k], q[(k + 1) % 3]], p))
        }
        1 => {
            let turned = |triangle: [u32; 3], other: [u32; 3]| {
                let first = (0..3).find(|k| other.contains(&triangle[*k])).unwrap_or(0);
                [0, 1, 2].map(|k| place(triangle[(first + k) % 3]))
            };
            let (p, q) = (turned(a, b), turned(b, a));
            pierces([p[1], p[2]], q) || pierces([q[1], q[2]], p)
        }
        2 => {
            // Only triangles that lie on each other cross beside an edge they share.
            let lone = |triangle: [u32; 3], other: [u32; 3]| {
                triangle.into_iter().find(|corner| !other.contains(corner)).unwrap_or(triangle[0])
            };
            let (c, d) = (lone(a, b), lone(b, a));
            let edge: Vec<DVec3> =
                a.iter().filter(|corner| b.contains(corner)).map(|corner| place(*corner)).collect();
            let corners = [edge[0], edge[1], place(c)];
            side(corners, place(d)) == 0.0 && on_one_side(corners, place(d))
        }
        _ => true,
    }
}

/// Whether a triangle lies wholly on one side of the plane of another.
fn apart(p: [DVec3; 3], q: [DVec3; 3]) -> bool {
    let sides = q.map(|corner| side(p, corner));
    sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0)
}

/// In the plane of a triangle, whether a point lies on the same side of its first edge as its third corner.
fn on_one_side(corners: [DVec3; 3], point: DVec3) -> bool {
    let [a, b, c] = corners.map(|corner| flat(corner, corners));
    let point = flat(point, corners);
    orient2d(a, b, c) * orient2d(a, b, point) > 0.0
}

/// A point without the coordinate along which a triangle is seen largest.
fn flat(point: DVec3, [a, b, c]: [DVec3; 3]) -> Coord<f64> {
    let normal = (b - a).cross(c - a).abs();
    if normal.x >= normal.y && normal.x >= normal.z {
        Coord { x: point.y, y: point.z }
    } else if normal.y >= normal.z {
        Coord { x: point.z, y: point.x }
    } else {
        Coord { x: point.x, y: point.y }
    }
}

/// Whether a segment meets a triangle.
fn pierces([from, to]: [DVec3; 2], triangle: [DVec3; 3]) -> bool {
    let (one, other) = (side(triangle, from), side(triangle, to));
    if (one > 0.0 && other > 0.0) || (one < 0.0 && other < 0.0) {
        return false;
    }
    if one == 0.0 && other == 0.0 {
        return lies_on([from, to], triangle);
    }
    let turns = [0, 1, 2].map(|k| side([from, to, triangle[k]], triangle[(k + 1) % 3]));
    turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
}

/// Whether a segment in the plane of a triangle meets it.
fn lies_on(segment: [DVec3; 2], triangle: [DVec3; 3]) -> bool {
    let corners = triangle.map(|corner| flat(corner, triangle));
    let [from, to] = segment.map(|point| flat(point, triangle));
    let inside = |point: Coord<f64>| {
        let turns = [0, 1, 2].map(|k| orient2d(corners[k], corners[(k + 1) % 3], point));
        turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
    };
    let meets = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (one, other) = (orient2d(from, to, a), orient2d(from, to, b));
        let (low, high) = (orient2d(a, b, from), orient2d(a, b, to));
        one * other <= 0.0 && low * high <= 0.0 && (one != 0.0 || other != 0.0)
    };
    inside(from) || inside(to) || (0..3).any(meets)
}

/// The end of a segment in which two triangles cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pierced {
    /// Where.
    pub point: DVec3,
    /// Whose side runs through the other triangle: 0 is the first.
    pub triangle: usize,
    /// Which side: that from this corner to the next.
    pub side: usize,
}

/// The segment in which two triangles run through each other: which sides end it is decided exactly, with corners on a plane
/// counted to its upper side. None where they touch only, or lie in one plane.
#[must_use]
pub fn segment(p: [DVec3; 3], q: [DVec3; 3]) -> Option<[Pierced; 2]> {
    let mut ends: Vec<Pierced> = Vec::new();
    for (triangle, (own, other)) in [(p, q), (q, p)].into_iter().enumerate() {
        let heights = own.map(|corner| side(other, corner));
        for k in 0..3 {
            let (from, to) = (heights[k], heights[(k + 1) % 3]);
            if (from >= 0.0) == (to >= 0.0) || !pierces([own[k], own[(k + 1) % 3]], other) {
                continue;
            }
            let point = own[k].lerp(own[(k + 1) % 3], from / (from - to));
            ends.push(Pierced { point, triangle, side: k });
        }
    }
    // Where a side meets a side there are more than two, in no more than two places.
    let first = *ends.first()?;
    let away = |end: &Pierced| end.point.distance_squared(first.point);
    let last = *ends.iter().max_by(|a, b| away(a).total_cmp(&away(b)))?;
    (last.point != first.point).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{PAIRS, Pierced, crossings, segment};

    #[test]
    fn a_segment_ends_where_sides_run_through_the_other_triangle() {
        let triangle = |list: [[f64; 3]; 3]| list.map(DVec3::from_array);
        let floor = triangle([[-2.0, 0.0, -2.0], [4.0, 0.0, -2.0], [-2.0, 0.0, 4.0]]);
        // From below to above: the left side rises through the floor at x = -0.5, the right one at x = 0.5.
        let wall = triangle([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]);
        let ends = segment(floor, wall).expect("they cross");
        let mut along: Vec<f64> = ends.iter().map(|end| end.point.x).collect();
        along.sort_by(f64::total_cmp);
        assert_eq!(along, [-0.5, 0.5]);
        assert!(ends.iter().all(|Pierced { point, triangle, .. }| *triangle == 1 && point.y == 0.0));
        // A wall that reaches over the border of the floor ends there.
        let long = wall.map(|corner| DVec3::new(4.0 * corner.x, corner.y, corner.z));
        let ends = segment(floor, long).expect("they cross");
        let far = ends.iter().map(|end| end.point.x).fold(f64::NEG_INFINITY, f64::max);
        assert!(
            (far - 2.0).abs() < 1e-14,
            "the slanted side of the floor crosses the wall at x = 2, not {far}"
        );
        // Beside it, above it, and with a corner that only touches it there is none.
        for moved in [DVec3::X * 9.0, DVec3::Y * 1.5, DVec3::Y] {
            assert_eq!(segment(floor, wall.map(|corner| corner + moved)), None);
        }
        assert_eq!(segment(floor, floor.map(|corner| corner + DVec3::X * 0.1)), None, "in one plane");
    }

    fn places(list: &[[f64; 3]]) -> Vec<DVec3> {
        list.iter().map(|place| DVec3::from_array(*place)).collect()
    }

    const BASE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn meet(other: [[f64; 3]; 3]) -> bool {
        let points = places(&[BASE, other].concat());
        !crossings(&points, &[[0, 1, 2], [3, 4, 5]]).is_empty()
    }

    #[test]
    fn triangles_that_pierce_touch_or_lie_on_each_other_cross() {
        assert!(meet([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [2.0, 2.0, 1.0]]), "pierced");
        assert!(meet([[0.2, 0.2, 0.0], [0.2, 0.2, 1.0], [2.0, 2.0, 1.0]]), "touched by a corner");
        assert!(meet([[0.2, 0.2, 0.0], [3.0, 0.2, 0.0], [0.2, 3.0, 0.0]]), "in one plane");
        assert!(meet([[-1.0, -1.0, 0.0], [3.0, -1.0, 0.0], [-1.0, 3.0, 0.0]]), "around it");
        assert!(meet([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 1.0]]), "at a corner that is not shared");
        assert!(!meet([[0.2, 0.2, 1e-300], [3.0, 0.2, 1.0], [0.2, 3.0, 1.0]]), "a hair above it");
        assert!(!meet([[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]), "beside it in one plane");
    }

    #[test]
    fn what_neighbors_share_is_no_crossing() {
        let points = places(&[
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.5, 0.5, 1.0],
            [0.2, 0.2, 0.0],
        ]);
        assert!(crossings(&points, &[[0, 1, 2], [2, 1, 3]]).is_empty(), "flat neighbors");
        assert!(crossings(&points, &[[0, 1, 2], [1, 3, 4]]).is_empty(), "a shared corner");
        assert_eq!(crossings(&points, &[[0, 1, 2], [1, 2, 5]]), [[0, 1]], "folded onto each other");
        let through =
            places(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.2, 1.0], [0.5, 0.2, -1.0]]);
        assert_eq!(
            crossings(&through, &[[0, 1, 2], [0, 3, 4]]),
            [[0, 1]],
            "a shared corner and a pierced face"
        );
    }

    /// A grid of many triangles: every pair that boxes let through is decided, none is lost in the tree.
    #[test]
    fn one_crossing_is_found_among_many_triangles() {
        let side = 40;
        let mut points = Vec::new();
        for i in 0..=side {
            points.extend(
                (0..=side).map(|j| DVec3::new(f64::from(i), f64::from(j), 0.1 * f64::from(i * j % 7))),
            );
        }
        let at = |i: u32, j: u32| i * 41 + j;
        let mut triangles = Vec::new();
        for i in 0..40 {
            for j in 0..40 {
                triangles.extend([
                    [at(i, j), at(i + 1, j), at(i, j + 1)],
                    [at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)],
                ]);
            }
        }
        assert!(crossings(&points, &triangles).is_empty());
        points.extend(places(&[[20.3, 20.3, -3.0], [20.3, 20.3, 3.0], [20.31, 20.3, 3.0]]));
        triangles.push([1681, 1682, 1683]);
        let found = crossings(&points, &triangles);
        assert!(!found.is_empty() && found.iter().all(|pair| pair[1] == 3200), "{found:?}");
    }

    /// What is told of one triangle is capped; of those with greater numbers that cross it nothing is lost.
    #[test]
    fn a_triangle_that_crosses_very_many_is_told_with_some_of_them() {
        let blades = 100;
        let wide = [[-1.0, -1.0, 0.0], [300.0, -1.0, 0.0], [-1.0, 300.0, 0.0]];
        let blade = |k: u32| {
            let x = f64::from(k);
            [[x, 0.2, -1.0], [x, 0.2, 1.0], [x, 0.8, 1.0]]
        };
        let all: Vec<[f64; 3]> = std::iter::once(wide).chain((0..blades).map(blade)).flatten().collect();
        let points = places(&all);
        let triangles: Vec<[u32; 3]> = (0..=blades).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let first = crossings(&points, &triangles);
        assert_eq!(first.len(), PAIRS);
        assert!(first.iter().all(|pair| pair[0] == 0), "{first:?}");
        let last: Vec<[u32; 3]> = triangles.iter().rev().copied().collect();
        let expected: Vec<[u32; 2]> = (0..blades).map(|k| [k, blades]).collect();
        assert_eq!(crossings(&points, &last), expected);
    }

    /// A heap of equal triangles has as many pairs as its square; the answer does not.
    #[test]
    fn a_heap_of_triangles_has_an_answer_of_its_own_size() {
        let count: usize = 3000;
        let points = places(&vec![BASE; count].concat());
        let corner = |k: usize| u32::try_from(k).expect("few");
        let triangles: Vec<[u32; 3]> =
            (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2].map(corner)).collect();
        let found = crossings(&points, &triangles);
        // Of the last ones fewer are left.
        assert_eq!(found.len(), PAIRS * (count - PAIRS) + PAIRS * (PAIRS - 1) / 2);
    }
}
