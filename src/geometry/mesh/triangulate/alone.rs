//! Corners that exist only because an edge is touched from outside are taken out again.
//!
//! ```text
//!        x3 ------ x2
//!       /  \     /   \          the triangles around v become those of x1, x2, x3, x4:
//!      /    \   /     \         nothing of the polygon stands at v on this side of its edge
//!    x4 ----- v ------ x1
//! ```

use std::collections::BTreeMap;

use super::{Polygon, tolerant};
use crate::geometry::mesh::index;

/// Triangles of which none uses a corner of `alone`; `None` where the triangles around one are no fan.
pub(super) fn without(
    polygon: &Polygon,
    mut triangles: Vec<[u32; 3]>,
    alone: &[u32],
) -> Option<Vec<[u32; 3]>> {
    for &corner in alone {
        let (around, others): (Vec<_>, Vec<_>) =
            triangles.into_iter().partition(|triangle| triangle.contains(&corner));
        triangles = others;
        triangles.extend(filled(polygon, &fan(corner, &around)?, alone)?);
    }
    Some(triangles)
}

/// The corners around a corner, counter-clockwise.
fn fan(corner: u32, around: &[[u32; 3]]) -> Option<Vec<u32>> {
    let mut next: BTreeMap<u32, u32> = BTreeMap::new();
    for triangle in around {
        let at = triangle.iter().position(|other| *other == corner)?;
        next.insert(triangle[(at + 1) % 3], triangle[(at + 2) % 3]);
    }
    let first = *next.keys().find(|corner| !next.values().any(|other| other == *corner))?;
    let mut way = vec![first];
    while let Some(&after) = next.get(way.last()?) {
        way.push(after);
        if way.len() > around.len() + 1 {
            return None;
        }
    }
    (way.len() == around.len() + 1).then_some(way)
}

/// Triangles of a ring of corners, least harm first. Corners on the way of edges have no position of their own in the
/// polygon: rings with more of them are left to the caller.
fn filled(polygon: &Polygon, ring: &[u32], alone: &[u32]) -> Option<Vec<[u32; 3]>> {
    if ring.len() < 3 || ring.iter().any(|corner| alone.contains(corner)) {
        return None;
    }
    let corners = ring.iter().map(|corner| polygon.corners[*corner as usize]).collect();
    let part = Polygon {
        corners,
        ring_ends: vec![index(ring.len())],
        names: Vec::new(),
        flipped: false,
        flat_ring: None,
    };
    let cut = tolerant::cut(&part);
    Some(cut.into_iter().map(|triangle| triangle.map(|corner| ring[corner as usize])).collect())
}
