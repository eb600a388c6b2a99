//! Corners of a polygon that stand on one place.
//!
//! At each place the sectors of the polygon lead from the corner X whose edge leaves to the corner Y whose edge
//! comes in. Together with edges of no length they make rings of corners: X to Y, and corner to corner. A ring of one
//! is an ordinary corner; others are filled with triangles of one place, so that all edges between them have two
//! sides. Corners that exist only because an edge runs over the place are taken out of their ring.

use super::Polygon;
use crate::geometry::mesh::index;

/// What lies between two edges of the polygon at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    /// The corner whose edge leaves; triangles of the sector name it.
    pub(super) out: u32,
    /// The corner whose edge comes in.
    pub(super) back: u32,
    /// The corner at which the edge that comes in starts.
    pub(super) from: u32,
}

/// What each corner is called in the end.
pub(super) struct Names {
    pub(super) of: Vec<u32>,
    /// Corners that exist only on the way of an edge, where it is touched from outside: they have to go.
    pub(super) alone: Vec<u32>,
}

/// No entry.
const NONE: u32 = u32::MAX;

/// The rings of corners at all places.
pub(super) struct Coincident {
    /// The next corner of the ring.
    next: Vec<u32>,
    /// Corners of the polygon; those beyond exist only on the way of an edge.
    real: usize,
    sectors: Vec<Sector>,
}

impl Coincident {
    /// With `places` the place of each corner of the polygon, and `passing` corners on the way of edges.
    pub(super) fn new(polygon: &Polygon, places: &[u32], passing: usize) -> Self {
        let real = polygon.corners.len();
        let mut next = vec![NONE; real + passing];
        for [from, to] in polygon.edges() {
            if places[from as usize] == places[to as usize] {
                next[from as usize] = to;
            }
        }
        Self { next, real, sectors: Vec::new() }
    }

    /// A sector that is filled already, or needs no filling.
    pub(super) fn link(&mut self, out: u32, back: u32) {
        self.next[out as usize] = back;
    }

    /// A sector whose triangles all name the corner that leaves.
    pub(super) fn sector(&mut self, sector: Sector) {
        self.link(sector.out, sector.back);
        if sector.out != sector.back {
            self.sectors.push(sector);
        }
    }

    /// Adds the triangles of one place and those that join them to the others; gives for each corner its name, which
    /// is another's for corners that exist only on the way, or its own where it is alone. `None` where several such
    /// corners are alone together: edges back to back are touched from outside.
    pub(super) fn close(self, triangles: &mut Vec<[u32; 3]>) -> Option<Names> {
        let mut names: Vec<u32> = (0..index(self.next.len())).collect();
        let mut alone = Vec::new();
        let mut seen = vec![false; self.next.len()];
        for start in 0..self.next.len() {
            let mut ring = Vec::new();
            let mut corner = start;
            while !seen[corner] {
                seen[corner] = true;
                ring.push(index(corner));
                let next = self.next[corner];
                if next == NONE {
                    return None;
                }
                corner = next as usize;
            }
            if ring.is_empty() {
                continue;
            }
            let real: Vec<u32> =
                ring.iter().copied().filter(|corner| (*corner as usize) < self.real).collect();
            let Some(&first) = real.first() else {
                if ring.len() > 1 {
                    return None;
                }
                alone.push(ring[0]);
                continue;
            };
            // A corner on the way becomes the one after it in the ring.
            let mut name = first;
            for &corner in ring.iter().rev() {
                name = if (corner as usize) < self.real { corner } else { name };
                names[corner as usize] = name;
            }
            triangles.extend(real.windows(2).skip(1).map(|pair| [first, pair[0], pair[1]]));
        }
        triangles.extend(self.sectors.iter().map(|sector| [sector.from, sector.back, sector.out]));
        Some(Names { of: names, alone })
    }
}
