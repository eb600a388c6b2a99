//! Polygons that cross or touch themselves, by cutting the ears that do the least harm.
//!
//! Holes are joined to the outer ring by bridges, then corners are cut off one by one. So whatever the input, each edge
//! of the polygon gets one triangle and the number of triangles is right; how good they are depends on the order:
//! 1. corners on the place of a neighbour, and tips of spikes: nothing is lost with them;
//! 2. proper ears, those of large angles first;
//! 3. corners on the line between their neighbours;
//! 4. the rest by the damage they do: how deep other parts of the polygon reach into the triangle, or how wide a
//!    triangle is that is turned over.
//!
//! Where a polygon crosses itself by a little, as rounded coordinates do, triangles are turned over by about as much.
//!
//! Source: the idea of ears of least cost for polygons that are valid within a tolerance is that of E. Lalish, Manifold
//! (2021), after D. Eberly, Triangulation by ear clipping (2002).

mod bridge;
mod grid;

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::Polygon;
use crate::geometry::mesh::index;
use crate::geometry::planar::distance_to_segment;
use grid::Grid;

/// Triangles of any polygon. O(n log n) while ears are small; O(n^2) at worst.
pub(super) fn cut(polygon: &Polygon) -> Vec<[u32; 3]> {
    let outline = bridge::joined(polygon);
    Clip::new(polygon, outline).run()
}

/// Distances below this part of the polygon are none: what computing with it rounds off.
const ROUNDING: f64 = 1e-12;

/// Corners still to be cut, as a ring.
struct Clip<'a> {
    polygon: &'a Polygon,
    /// The corner at each node; nodes of bridges stand on corners that have others.
    corner: Vec<u32>,
    before: Vec<u32>,
    after: Vec<u32>,
    active: Vec<bool>,
    /// Counts changes of each node's cost: entries of the queue that count otherwise are stale.
    version: Vec<u32>,
    grid: Grid,
    rounding: f64,
    left: usize,
}

/// How much harm a cut does: its tier, then a value, then the node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost {
    tier: u8,
    value: f64,
}

/// Harm does that in this tier and above, which the cutting of others may undo.
const HARM: u8 = 3;

/// The tier of cuts that lose a part of the ring.
const LOSS: u8 = 4;

/// An entry of the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    cost: Cost,
    node: u32,
    version: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |entry: &Self| (entry.cost.tier, entry.node, entry.version);
        (self.cost.tier.cmp(&other.cost.tier))
            .then(self.cost.value.total_cmp(&other.cost.value))
            .then(key(self).cmp(&key(other)))
    }
}

type Queue = BinaryHeap<Reverse<Entry>>;

impl<'a> Clip<'a> {
    fn new(polygon: &'a Polygon, corner: Vec<u32>) -> Self {
        let count = corner.len();
        let nodes = || 0..index(count);
        let places: Vec<DVec2> = corner.iter().map(|corner| polygon.corners[*corner as usize]).collect();
        let grid = Grid::new(&places);
        Self {
            polygon,
            before: nodes().map(|node| if node == 0 { index(count) - 1 } else { node - 1 }).collect(),
            after: nodes().map(|node| if node as usize + 1 == count { 0 } else { node + 1 }).collect(),
            active: vec![true; count],
            version: vec![0; count],
            rounding: ROUNDING * grid.reach(),
            grid,
            left: count,
            corner,
        }
    }

    fn run(mut self) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(self.left);
        let mut queue = self.queue();
        let mut since = 0;
        while self.left > 3 {
            let Some(Reverse(entry)) = queue.pop() else { break };
            let node = entry.node as usize;
            if !self.active[node] || entry.version != self.version[node] {
                continue;
            }
            // What did harm may do less now that others are gone.
            if entry.cost.tier >= HARM && since > self.left / 16 {
                queue = self.queue();
                since = 0;
                continue;
            }
            since += 1;
            triangles.push(self.triangle(entry.node));
            self.remove(entry.node);
            for neighbor in [self.before[node], self.after[node]] {
                self.version[neighbor as usize] += 1;
                queue.push(self.entry(neighbor));
            }
        }
        let last = (0..index(self.corner.len())).find(|node| self.active[*node as usize]);
        triangles.extend(last.map(|node| self.triangle(node)));
        triangles
    }

    fn queue(&self) -> Queue {
        (0..index(self.corner.len()))
            .filter(|node| self.active[*node as usize])
            .map(|node| self.entry(node))
            .collect()
    }

    fn entry(&self, node: u32) -> Reverse<Entry> {
        Reverse(Entry { cost: self.cost(node), node, version: self.version[node as usize] })
    }

    fn remove(&mut self, node: u32) {
        let (before, after) = (self.before[node as usize], self.after[node as usize]);
        self.after[before as usize] = after;
        self.before[after as usize] = before;
        self.active[node as usize] = false;
        self.left -= 1;
    }

    fn triangle(&self, node: u32) -> [u32; 3] {
        [self.before[node as usize], node, self.after[node as usize]].map(|node| self.corner[node as usize])
    }

    fn place(&self, node: u32) -> DVec2 {
        self.polygon.corners[self.corner[node as usize] as usize]
    }

    fn cost(&self, node: u32) -> Cost {
        let triangle = self.triangle(node);
        let [a, b, c] = triangle.map(|corner| self.polygon.corners[corner as usize]);
        if triangle[0] == triangle[2] {
            // Both ends of a bridge: with this corner all that lies behind the bridge would be lost.
            return Cost { tier: LOSS, value: 0.0 };
        }
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if a == b || b == c || a == c {
            return Cost { tier: 0, value: 0.0 };
        }
        let area = self.polygon.turn(triangle);
        let height = area.abs() / longest;
        if height <= self.rounding {
            let spike = (a - b).dot(c - b) > 0.0;
            return Cost { tier: if spike { 0 } else { 2 }, value: 0.0 };
        }
        if area < 0.0 {
            return Cost { tier: HARM, value: height };
        }
        let depth = self.depth(node, [a, b, c]);
        if depth > self.rounding {
            return Cost { tier: HARM, value: depth };
        }
        Cost { tier: 1, value: -area / (longest * longest) }
    }

    /// How deep the rest of the ring reaches into a triangle that turns counter-clockwise: by its corners and the
    /// middles of its edges.
    fn depth(&self, node: u32, ear: [DVec2; 3]) -> f64 {
        let mut deepest = 0.0_f64;
        let (before, after) = (self.before[node as usize], self.after[node as usize]);
        let low = ear[0].min(ear[1]).min(ear[2]);
        let high = ear[0].max(ear[1]).max(ear[2]);
        self.grid.visit(low, high, |other| {
            if !self.active[other as usize] || other == node {
                return;
            }
            let next = self.after[other as usize];
            let place = self.place(other);
            if other != before && other != after {
                deepest = deepest.max(inside(place, ear));
            }
            if other != before && next != node {
                deepest = deepest.max(inside((place + self.place(next)) / 2.0, ear));
            }
            let last = self.before[other as usize];
            if other != after && last != node {
                deepest = deepest.max(inside((place + self.place(last)) / 2.0, ear));
            }
        });
        deepest
    }
}

/// How far inside a triangle that turns counter-clockwise a point lies; 0 outside.
fn inside(point: DVec2, [a, b, c]: [DVec2; 3]) -> f64 {
    let left = |p: DVec2, q: DVec2| (q - p).perp_dot(point - p) > 0.0;
    if !left(a, b) || !left(b, c) || !left(c, a) {
        return 0.0;
    }
    [[a, b], [b, c], [c, a]]
        .into_iter()
        .map(|side| distance_to_segment(point, side))
        .fold(f64::INFINITY, f64::min)
}
