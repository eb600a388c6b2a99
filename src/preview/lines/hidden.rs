//! How many triangles hide an edge, along its way.

use glam::{DVec2, DVec3};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::feature::{Edge, Kind};
use crate::geometry::number::{count_of, floor_index};
use crate::preview::camera::{Camera, Projected};
use crate::preview::stage::Stage;

/// A part of an edge that is hidden by the same number of triangles all along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) kind: Kind,
    /// How many triangles hide it.
    pub(super) hidden: u32,
    pub(super) ends: [Projected; 2],
    /// Numbers of points at its ends; none inside of an edge.
    pub(super) points: [Option<u32>; 2],
}

/// A triangle in the picture that may hide something.
struct Blind {
    corners: [DVec2; 3],
    /// Depth is `slope` · place + `start`.
    slope: DVec2,
    start: f64,
    /// Depth of its nearest corner.
    nearest: f64,
    /// Depth by which something must lie behind it.
    slack: f64,
    name: u32,
}

/// Triangles by the squares of a picture.
struct Grid {
    blinds: Vec<Blind>,
    low: DVec2,
    cell: f64,
    across: usize,
    down: usize,
    cells: Vec<Vec<u32>>,
}

/// Share of the extent, in depth and in the picture, below which differences are rounding: positions in files have 24
/// bits.
const SLACK: f64 = 2e-6;

/// Parts of edges shorter than this, in pixels, are drawn as what is next to them.
const SHORT: f64 = 0.6;

/// Squares along the longer side of a picture.
const CELLS: u16 = 256;

/// All edges, cut where they become hidden or come out.
pub(super) fn pieces(stage: &Stage, camera: &Camera, edges: &[Edge]) -> Vec<Piece> {
    let grid = Grid::new(stage, camera);
    let cut: Vec<Vec<Piece>> = edges.par_iter().with_min_len(64).map(|edge| grid.cut(edge)).collect();
    cut.into_iter().flatten().collect()
}

impl Grid {
    fn new(stage: &Stage, camera: &Camera) -> Self {
        let place = |vertex: u32| camera.project(stage.vertices[vertex as usize].point);
        let mut corners = Vec::with_capacity(stage.triangles.len());
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (name, triangle) in (0_u32..).zip(&stage.triangles) {
            if let [Some(a), Some(b), Some(c)] = triangle.map(place) {
                low = low.min(a).min(b).min(c);
                high = high.max(a).max(b).max(c);
                corners.push((name, [a, b, c]));
            }
        }
        let extent = (high - low).max(DVec3::ZERO);
        let plane = extent.truncate().max_element();
        let blinds: Vec<Blind> =
            corners.into_iter().filter_map(|(name, corners)| blind(name, corners, plane, extent.z)).collect();
        let cell = (plane / f64::from(CELLS)).max(f64::MIN_POSITIVE);
        let count = |extent: f64| floor_index(extent / cell).min(CELLS.into()) + 1;
        let (across, down) = (count(extent.x), count(extent.y));
        let mut grid =
            Self { blinds, low: low.truncate(), cell, across, down, cells: vec![Vec::new(); across * down] };
        for number in 0..grid.blinds.len() {
            let own = grid.blinds[number].corners;
            let (first, last) =
                (grid.square(own[0].min(own[1]).min(own[2])), grid.square(own[0].max(own[1]).max(own[2])));
            for row in first.1..=last.1 {
                for column in first.0..=last.0 {
                    grid.cells[row * across + column].push(count_of(number));
                }
            }
        }
        grid
    }

    fn square(&self, place: DVec2) -> (usize, usize) {
        let at = (place - self.low) / self.cell;
        (floor_index(at.x).min(self.across - 1), floor_index(at.y).min(self.down - 1))
    }

    /// Triangles over the squares that a line crosses, each once.
    fn near(&self, start: DVec2, end: DVec2) -> Vec<u32> {
        let mut all = Vec::new();
        let ((left, top), (right, bottom)) = (self.square(start.min(end)), self.square(start.max(end)));
        let along = end - start;
        for row in top..=bottom {
            // The part of the line between the upper and the lower side of the row, a little longer.
            let sides = [row as f64 - 0.01, row as f64 + 1.01].map(|side| self.low.y + side * self.cell);
            let (mut from, mut to) = (0.0_f64, 1.0_f64);
            if along.y.abs() > 1e-12 {
                let cuts = sides.map(|side| (side - start.y) / along.y);
                (from, to) = (from.max(cuts[0].min(cuts[1])), to.min(cuts[0].max(cuts[1])));
            }
            if from > to {
                continue;
            }
            let (one, other) = (start.x + along.x * from, start.x + along.x * to);
            let margin = 0.01 * self.cell;
            let first = self.square(DVec2::new(one.min(other) - margin, sides[0])).0.max(left);
            let last = self.square(DVec2::new(one.max(other) + margin, sides[0])).0.min(right);
            for column in first..=last {
                all.extend(&self.cells[row * self.across + column]);
            }
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    fn cut(&self, edge: &Edge) -> Vec<Piece> {
        let [start, end] = edge.ends;
        let furthest = start.z.max(end.z);
        let mut changes: Vec<(f64, i32)> = Vec::new();
        for number in self.near(start.truncate(), end.truncate()) {
            let blind = &self.blinds[number as usize];
            if blind.nearest >= furthest || edge.own.contains(&blind.name) {
                continue;
            }
            if let Some((from, to)) = blind.hides(start, end) {
                changes.extend([(from, 1), (to, -1)]);
            }
        }
        changes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let length = (end - start).truncate().length();
        // Parts with the number of triangles that hide them.
        let mut parts: Vec<(f64, f64, u32)> = Vec::new();
        let (mut from, mut hidden) = (0.0, 0_i32);
        for (at, change) in changes.into_iter().chain([(1.0, 0)]) {
            if (at - from) * length > SHORT || (at >= 1.0 && parts.is_empty()) {
                let now = hidden.unsigned_abs();
                match parts.last_mut() {
                    Some(last) if last.2 == now => last.1 = at,
                    _ => parts.push((from, at, now)),
                }
                from = at;
            } else if let Some(last) = parts.last_mut() {
                last.1 = at;
                from = at;
            }
            hidden += change;
        }
        // What was too short at the start belongs to the first part, and at the end to the last.
        if let Some(first) = parts.first_mut() {
            first.0 = 0.0;
        }
        if let Some(last) = parts.last_mut() {
            last.1 = 1.0;
        }
        let at = |t: f64| start.lerp(end, t);
        parts
            .iter()
            .map(|(from, to, hidden)| Piece {
                kind: edge.kind,
                hidden: *hidden,
                ends: [at(*from), at(*to)],
                points: [(*from == 0.0).then_some(edge.points[0]), (*to == 1.0).then_some(edge.points[1])],
            })
            .collect()
    }
}

/// A triangle as it hides; none where it is seen from its edge.
fn blind(name: u32, corners: [DVec3; 3], plane: f64, deep: f64) -> Option<Blind> {
    let [a, b, c] = corners;
    let (u, v) = (b - a, c - a);
    let twice = u.truncate().perp_dot(v.truncate());
    if twice.abs() <= 1e-12 * plane * plane {
        return None;
    }
    let slope = DVec2::new(u.z * v.y - v.z * u.y, v.z * u.x - u.z * v.x) / twice;
    let mut flat = corners.map(|corner| corner.truncate());
    if twice < 0.0 {
        flat.swap(1, 2);
    }
    Some(Blind {
        corners: flat,
        slope,
        start: a.z - slope.dot(a.truncate()),
        nearest: a.z.min(b.z).min(c.z),
        slack: SLACK * (deep + slope.length() * plane),
        name,
    })
}

impl Blind {
    /// The part of a line that lies behind it.
    fn hides(&self, start: DVec3, end: DVec3) -> Option<(f64, f64)> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        // Where a linear function with these ends is positive.
        let mut keep = |at_start: f64, at_end: f64| {
            if at_start <= 0.0 && at_end <= 0.0 {
                to = -1.0;
            } else if at_start < 0.0 {
                from = from.max(at_start / (at_start - at_end));
            } else if at_end < 0.0 {
                to = to.min(at_start / (at_start - at_end));
            }
        };
        for k in 0..3 {
            let (a, b) = (self.corners[k], self.corners[(k + 1) % 3]);
            let side = |place: DVec3| (b - a).perp_dot(place.truncate() - a);
            keep(side(start), side(end));
        }
        let behind = |place: DVec3| place.z - self.slope.dot(place.truncate()) - self.start - self.slack;
        keep(behind(start), behind(end));
        (from < to).then_some((from, to))
    }
}
