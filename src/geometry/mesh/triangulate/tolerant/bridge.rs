//! Holes joined to the outer ring: one ring that goes around everything once.
//!
//! From its rightmost corner each hole gets a bridge to the nearest corner that can be seen from there, the rightmost
//! hole first: what lies further left cannot stand in the way then (D. Eberly, Triangulation by ear clipping, 2002).
//! Where nothing can be seen, because the rings cross, it is the nearest corner of all.

use glam::DVec2;

use crate::geometry::mesh::triangulate::Polygon;
use crate::geometry::planar::turn;

/// The corners of all rings as one ring; the corners of bridges come twice.
pub(super) fn joined(polygon: &Polygon) -> Vec<u32> {
    let mut rings = polygon.rings();
    let mut outline: Vec<u32> = rings.next().map(Iterator::collect).unwrap_or_default();
    let place = |corner: u32| polygon.corners[corner as usize];
    let mut holes: Vec<Vec<u32>> = rings.map(|ring| from_rightmost(ring.collect(), place)).collect();
    holes.sort_by(|a, b| place(b[0]).x.total_cmp(&place(a[0]).x).then(a[0].cmp(&b[0])));
    for hole in holes {
        let at = anchor(polygon, &outline, &hole);
        let back = [hole[0], outline[at]];
        outline.splice(at + 1..at + 1, hole.into_iter().chain(back));
    }
    outline
}

fn from_rightmost(mut ring: Vec<u32>, place: impl Fn(u32) -> DVec2) -> Vec<u32> {
    let rightmost =
        (0..ring.len()).max_by(|&a, &b| place(ring[a]).x.total_cmp(&place(ring[b]).x).then(b.cmp(&a)));
    ring.rotate_left(rightmost.unwrap_or(0));
    ring
}

/// Where in the outline the bridge to the first corner of a hole ends.
fn anchor(polygon: &Polygon, outline: &[u32], hole: &[u32]) -> usize {
    let place = |corner: u32| polygon.corners[corner as usize];
    let start = place(hole[0]);
    let mut nearest: Vec<(f64, usize)> =
        outline.iter().enumerate().map(|(k, corner)| (place(*corner).distance_squared(start), k)).collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let seen = nearest.iter().find(|(distance, k)| {
        let end = place(outline[*k]);
        let before = place(outline[(k + outline.len() - 1) % outline.len()]);
        let after = place(outline[(k + 1) % outline.len()]);
        let opens = |here: DVec2, before: DVec2, after: DVec2, there: DVec2| {
            if turn(before, here, after) > 0.0 {
                turn(before, here, there) > 0.0 && turn(here, after, there) > 0.0
            } else {
                turn(before, here, there) > 0.0 || turn(here, after, there) > 0.0
            }
        };
        *distance == 0.0
            || (opens(end, before, after, start)
                && opens(start, place(hole[hole.len() - 1]), place(hole[1]), end)
                && clear(polygon, outline, hole, [start, end]))
    });
    seen.or(nearest.first()).map_or(0, |(_, k)| *k)
}

/// Whether no edge of the outline or of the hole crosses a bridge.
fn clear(polygon: &Polygon, outline: &[u32], hole: &[u32], [a, b]: [DVec2; 2]) -> bool {
    let place = |corner: u32| polygon.corners[corner as usize];
    let crosses = |p: DVec2, q: DVec2| {
        let apart = p.max(q).cmplt(a.min(b)).any() || a.max(b).cmplt(p.min(q)).any();
        let own = p == a || p == b || q == a || q == b;
        !apart && !own && turn(a, b, p) * turn(a, b, q) <= 0.0 && turn(p, q, a) * turn(p, q, b) <= 0.0
    };
    [outline, hole]
        .into_iter()
        .all(|ring| (0..ring.len()).all(|k| !crosses(place(ring[k]), place(ring[(k + 1) % ring.len()]))))
}
