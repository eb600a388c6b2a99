//! Finds edges of a polygon that cross, by exact predicates.

use glam::DVec2;

use super::turn;
use crate::geometry::mesh::index;

/// Two edges of closed rings that cross, overlap, or touch at other than their ends, as the corners (counted
/// through all rings) at which they begin; `None` when all rings are simple and apart.
///
/// Touching at a corner is allowed, as is a corner that lies on another edge without crossing it; edges that run
/// back along each other (the cut of a keyhole polygon) are not crossings. Exact. O(n log n) where edges are short
/// against the whole, O(n^2) at worst.
#[must_use]
pub fn crossing(rings: &[&[DVec2]]) -> Option<[u32; 2]> {
    let points: Vec<DVec2> = rings.iter().flat_map(|ring| ring.iter().copied()).collect();
    let mut edges = Vec::with_capacity(points.len());
    let mut start = 0;
    for ring in rings {
        let end = start + index(ring.len());
        edges.extend((start..end).map(|corner| [corner, if corner + 1 == end { start } else { corner + 1 }]));
        start = end;
    }
    let [a, b] = first_crossing(&points, &edges)?;
    Some([edges[a][0], edges[b][0]])
}

/// The first pair of crossing edges in the order of their left ends.
fn first_crossing(points: &[DVec2], edges: &[[u32; 2]]) -> Option<[usize; 2]> {
    let ends = |edge: usize| edges[edge].map(|corner| points[corner as usize]);
    let span = |edge: usize| {
        let [a, b] = ends(edge);
        (a.min(b), a.max(b))
    };
    let mut order: Vec<usize> = (0..edges.len()).collect();
    order.sort_by(|&a, &b| span(a).0.x.total_cmp(&span(b).0.x).then(a.cmp(&b)));
    let mut active: Vec<usize> = Vec::new();
    for &edge in &order {
        let (low, high) = span(edge);
        active.retain(|&other| span(other).1.x >= low.x);
        for &other in &active {
            let (other_low, other_high) = span(other);
            let apart = other_high.y < low.y || other_low.y > high.y;
            if !apart && cross(ends(edge), ends(other)) {
                return Some([edge.min(other), edge.max(other)]);
            }
        }
        active.push(edge);
    }
    None
}

/// Whether two segments meet in a point that is inside both.
fn cross([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let sides = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
    let opposite = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    if opposite(sides[0], sides[1]) && opposite(sides[2], sides[3]) {
        return true;
    }
    // On one line and running the same way over a common stretch.
    sides == [0.0; 4] && a != b && c != d && (b - a).dot(d - c) > 0.0 && overlap([a, b], [c, d])
}

/// Whether two segments on one line share more than a point.
fn overlap([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let wide = (b - a).abs();
    let along = |point: DVec2| if wide.x >= wide.y { point.x } else { point.y };
    let (low, high) = (along(a).min(along(b)), along(a).max(along(b)));
    let (other_low, other_high) = (along(c).min(along(d)), along(c).max(along(d)));
    low.max(other_low) < high.min(other_high)
}
