//! The first triangles: each cell is filled with tetrahedra, each tetrahedron holds one or two triangles.
//!
//! Promise: the tetrahedra fill the cells face to face, whatever the sizes of neighbors, so the triangles form a closed
//! surface without branches in which no two triangles cross: each lies inside its own tetrahedron, and where its
//! corners lie on edges they do not reach the ends. The surface is open only where it leaves the cells.
//!
//! Source: A. Doi, A. Koide, An efficient method of triangulating equivalued surfaces by using tetrahedral cells, 1991.

use glam::DVec3;

use super::cells::{Cell, Cells, DEEPEST, Quick};
use crate::geometry::field::{AnyField, Field};
use crate::geometry::mesh;

/// Triangles with corners near the surface.
#[derive(Debug, Default)]
pub(super) struct Rough {
    pub(super) points: Vec<DVec3>,
    /// For each point the ends of the edge it lies on: inside, then outside.
    pub(super) brackets: Vec<[DVec3; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Where the field has no value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoValue(pub(super) DVec3);

/// Corners keep this share of an edge from its ends: triangles do not become needles.
const KEPT: f64 = 0.12;

struct Marcher<'a> {
    field: &'a AnyField,
    cells: &'a Cells,
    /// Places by key: index into `values` and `places`.
    known: Quick<u32>,
    places: Vec<DVec3>,
    values: Vec<f64>,
    edges: Quick<u32>,
    rough: Rough,
    limit: usize,
    lost: Option<DVec3>,
}

/// Fills cells with triangles; none when they would be more than `limit`.
pub(super) fn march(field: &AnyField, cells: &Cells, limit: usize) -> Result<Option<Rough>, NoValue> {
    let mut marcher = Marcher {
        field,
        cells,
        known: Quick::default(),
        places: Vec::new(),
        values: Vec::new(),
        edges: Quick::default(),
        rough: Rough::default(),
        limit,
        lost: None,
    };
    for cell in &cells.leaves {
        marcher.cell(*cell);
        if let Some(place) = marcher.lost {
            return Err(NoValue(place));
        }
        if marcher.rough.triangles.len() > marcher.limit {
            return Ok(None);
        }
    }
    Ok(Some(marcher.rough))
}

impl Marcher<'_> {
    fn place(&mut self, place: [u32; 3]) -> u32 {
        let [x, y, z] = place.map(u64::from);
        let key = (x << 42) | (y << 21) | z;
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let point = self.cells.lattice.point(place);
        let value = self.field.value(point);
        if value.is_nan() {
            self.lost = Some(point);
        }
        let index = mesh::index(self.places.len());
        self.places.push(point);
        self.values.push(value);
        self.known.insert(key, index);
        index
    }

    fn cell(&mut self, cell: Cell) {
        let (half, corner) = cell.corner();
        let center = self.place(corner.map(|x| x + half));
        for axis in 0..3 {
            for up in [false, true] {
                self.side(center, cell.level, cell.place, (axis, up));
            }
        }
    }

    /// A side of a cell, or a part of it that a smaller neighbor shares.
    fn side(&mut self, center: u32, level: u32, place: [u32; 3], (axis, up): (usize, bool)) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        if level < DEEPEST && self.cells.is_side_cut(level, place, axis, up) {
            for bits in 0..4_u32 {
                let mut child = place.map(|x| 2 * x);
                child[axis] += u32::from(up);
                child[b] += bits & 1;
                child[c] += bits >> 1;
                self.side(center, level + 1, child, (axis, up));
            }
            return;
        }
        let (half, mut corner) = Cell { level, place }.corner();
        corner[axis] += if up { 2 * half } else { 0 };
        let mut start = place;
        start[axis] += u32::from(up);
        let shifted = |db: u32, dc: u32| {
            let mut place = start;
            place[b] += db;
            place[c] += dc;
            place
        };
        let mut ring: Vec<[u32; 3]> = Vec::with_capacity(8);
        let edges = [
            (shifted(0, 0), b, false),
            (shifted(1, 0), c, false),
            (shifted(0, 1), b, true),
            (shifted(0, 0), c, true),
        ];
        for (from, along, back) in edges {
            let first = ring.len();
            self.edge(level, from, along, &mut ring);
            if back {
                // The end of the edge comes first, and its own start belongs to the next.
                let mut end = Cell { level, place: from }.corner().1;
                end[along] += 2 * half;
                ring.remove(first);
                ring.push(end);
                ring[first..].reverse();
            }
        }
        let ring: Vec<u32> = ring.into_iter().map(|place| self.place(place)).collect();
        if let [p, q, r, s] = ring[..] {
            // Which way it is halved depends on its place alone, so that both sides see the same.
            let even = (corner[0] ^ corner[1] ^ corner[2]) / (2 * half) % 2 == 0;
            let halves = if even { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] };
            for [p, q, r] in halves {
                self.tetrahedron(if up { [center, p, q, r] } else { [center, p, r, q] });
            }
            return;
        }
        let mut middle = corner;
        middle[b] += half;
        middle[c] += half;
        let middle = self.place(middle);
        for (k, from) in ring.iter().enumerate() {
            let to = ring[(k + 1) % ring.len()];
            let sides = if up { [*from, to] } else { [to, *from] };
            self.tetrahedron([center, middle, sides[0], sides[1]]);
        }
    }

    /// The start of an edge of cells, and the places at which smaller cells cut it.
    fn edge(&self, level: u32, start: [u32; 3], along: usize, ring: &mut Vec<[u32; 3]>) {
        if level < DEEPEST && self.cells.is_edge_cut(level, start, along) {
            let first = start.map(|x| 2 * x);
            let mut second = first;
            second[along] += 1;
            self.edge(level + 1, first, along, ring);
            self.edge(level + 1, second, along, ring);
        } else {
            ring.push(Cell { level, place: start }.corner().1);
        }
    }

    /// The triangles in a tetrahedron whose second to fourth corner run counter-clockwise seen from outside.
    fn tetrahedron(&mut self, corners: [u32; 4]) {
        let inside = corners.map(|corner| self.values[corner as usize] < 0.0);
        let count = inside.iter().filter(|inside| **inside).count();
        if count == 0 || count == 4 {
            return;
        }
        let mut order = [0, 1, 2, 3];
        order.sort_by_key(|k: &usize| !inside[*k]);
        let swaps =
            (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|(j, i)| order[*j] > order[*i]).count();
        if swaps % 2 == 1 {
            // Two of the same kind change places.
            if count == 3 { order.swap(0, 1) } else { order.swap(2, 3) }
        }
        let [a, b, c, d] = order.map(|k| corners[k]);
        match count {
            1 => {
                let triangle = [(a, b), (a, c), (a, d)].map(|(from, to)| self.crossing(from, to));
                self.rough.triangles.push(triangle);
            }
            2 => {
                let [p, q, r, s] = [(a, c), (a, d), (b, d), (b, c)].map(|(from, to)| self.crossing(from, to));
                let short = |p: u32, r: u32, rough: &Rough| {
                    rough.points[p as usize].distance_squared(rough.points[r as usize])
                };
                if short(p, r, &self.rough) <= short(q, s, &self.rough) {
                    self.rough.triangles.extend([[p, q, r], [p, r, s]]);
                } else {
                    self.rough.triangles.extend([[p, q, s], [q, r, s]]);
                }
            }
            _ => {
                let [p, q, r] = [(a, d), (b, d), (c, d)].map(|(from, to)| self.crossing(from, to));
                self.rough.triangles.push([p, q, r]);
            }
        }
    }

    /// The point where the surface crosses an edge from inside to outside.
    fn crossing(&mut self, inside: u32, outside: u32) -> u32 {
        let (low, high) = (u64::from(inside.min(outside)), u64::from(inside.max(outside)));
        let next = mesh::index(self.rough.points.len());
        let index = *self.edges.entry((low << 32) | high).or_insert(next);
        if index == next {
            let (from, to) = (self.places[inside as usize], self.places[outside as usize]);
            let (low, high) = (self.values[inside as usize], self.values[outside as usize]);
            let share = low / (low - high);
            let share = if share.is_finite() { share.clamp(KEPT, 1.0 - KEPT) } else { 0.5 };
            self.rough.points.push(from.lerp(to, share));
            self.rough.brackets.push([from, to]);
        }
        index
    }
}
