//! Cutting the faces of a mesh along common planes, into ladders.
//!
//! Two triangles in one plane are cut as the quadrilateral they form, so that their common side adds no points.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::levels::Levels;
use super::lines::lines;
use super::split::{Splitter, between, key};
use crate::geometry::mesh::{Mesh, PointIndex, Run, VertexIndex, index};
use crate::geometry::tessellate::TessellateError;

/// Corners of a face as far as two triangles are one: of the size of the face.
const FLAT: f64 = 1e-9;

/// Cuts a mesh by planes.
///
/// # Errors
/// When the limit would be passed.
pub(super) fn slice<'a>(
    mesh: &Mesh,
    levels: &Levels,
    periods: &'a [(f64, f64)],
    triangle_limit: u64,
) -> Result<Splitter<'a>, TessellateError> {
    let hard = lines(mesh);
    let faces = faces(mesh, levels, &hard);
    let mut slicer = Slicer {
        levels,
        periods,
        mesh: Mesh { triangles: Vec::new(), runs: Vec::new(), ..mesh.clone() },
        points: HashMap::new(),
        vertices: HashMap::new(),
    };
    let mut start = 0;
    for run in &mesh.runs {
        for face in &faces[start as usize..run.end as usize] {
            slicer.face(face);
            let needed = slicer.mesh.triangles.len() as u64;
            if needed > triangle_limit {
                return Err(TessellateError::TooMany { needed, limit: triangle_limit });
            }
        }
        start = run.end;
        slicer.mesh.runs.push(Run { end: index(slicer.mesh.triangles.len()), ..*run });
    }
    let hard = slicer.cut_lines(mesh, hard);
    Ok(Splitter::new(slicer.mesh, hard, periods))
}

/// For each triangle the corners of the face that it begins: its own, those of a quadrilateral, or none where it is
/// the second half of one.
fn faces(mesh: &Mesh, levels: &Levels, hard: &HashSet<(u32, u32)>) -> Vec<Vec<VertexIndex>> {
    let mut faces: Vec<Vec<VertexIndex>> = mesh.triangles.iter().map(|triangle| triangle.to_vec()).collect();
    let mut paired = vec![false; faces.len()];
    for (_, one, other, side) in pairs(mesh, levels, hard) {
        if paired[one] || paired[other] {
            continue;
        }
        (paired[one], paired[other]) = (true, true);
        let [a, b, c] = rotated(mesh.triangles[one], side);
        let far = far_corner(mesh.triangles[other], (a, b));
        faces[one] = vec![a, far, b, c];
        faces[other] = Vec::new();
    }
    faces
}

/// A triangle that begins with one of its sides; side k goes from corner k.
fn rotated(triangle: [VertexIndex; 3], side: usize) -> [VertexIndex; 3] {
    [triangle[side], triangle[(side + 1) % 3], triangle[(side + 2) % 3]]
}

fn far_corner(triangle: [VertexIndex; 3], (a, b): (VertexIndex, VertexIndex)) -> VertexIndex {
    triangle.into_iter().find(|corner| *corner != a && *corner != b).unwrap_or(a)
}

/// Neighbors that may be one face, those with the most cuts on their common side first.
fn pairs(mesh: &Mesh, levels: &Levels, hard: &HashSet<(u32, u32)>) -> Vec<(usize, usize, usize, usize)> {
    let mut open: HashMap<(VertexIndex, VertexIndex), (usize, usize)> = HashMap::new();
    let mut found = Vec::new();
    let mut start = 0;
    for run in &mesh.runs {
        open.clear();
        for number in start as usize..run.end as usize {
            let triangle = mesh.triangles[number];
            for side in 0..3 {
                let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
                let (p, q) = (mesh.vertices[a.subscript()].point, mesh.vertices[b.subscript()].point);
                if hard.contains(&key(p.0, q.0)) {
                    continue;
                }
                let Some((other, from)) = open.remove(&(b, a)) else {
                    open.insert((a, b), (number, side));
                    continue;
                };
                let cuts = levels.cuts(mesh.points[p.subscript()], mesh.points[q.subscript()]).len();
                let known = rotated(mesh.triangles[other], from);
                let far = far_corner(triangle, (known[0], known[1]));
                if cuts > 0 && is_flat(mesh, [known[0], far, known[1], known[2]]) {
                    found.push((cuts, other, number, from));
                }
            }
        }
        start = run.end;
    }
    found.sort_by_key(|(cuts, one, other, side)| (std::cmp::Reverse(*cuts), *one, *other, *side));
    found
}

/// Whether a quadrilateral is flat and convex.
fn is_flat(mesh: &Mesh, corners: [VertexIndex; 4]) -> bool {
    let places = corners.map(|corner| mesh.points[mesh.vertices[corner.subscript()].point.subscript()]);
    let sides: [DVec3; 4] = std::array::from_fn(|k| places[(k + 1) % 4] - places[k]);
    let size = sides.iter().map(|side| side.length()).fold(0.0, f64::max);
    let Some(normal) = sides[0].cross(sides[1]).try_normalize() else { return false };
    (places[3] - places[0]).dot(normal).abs() <= FLAT * size
        && (0..4).all(|k| sides[k].cross(sides[(k + 1) % 4]).dot(normal) > FLAT * size * size)
}

struct Slicer<'a> {
    levels: &'a Levels,
    periods: &'a [(f64, f64)],
    mesh: Mesh,
    /// Points made on sides, by the plane.
    points: HashMap<((u32, u32), u32), u32>,
    /// Vertices made between two.
    vertices: HashMap<((u32, u32), u32), u32>,
}

impl Slicer<'_> {
    fn place(&self, vertex: VertexIndex) -> DVec3 {
        self.mesh.points[self.mesh.vertices[vertex.subscript()].point.subscript()]
    }

    /// The vertices on the way from a corner to the next, without the next.
    fn side(&mut self, a: VertexIndex, b: VertexIndex) -> Vec<VertexIndex> {
        let (one, other) = (self.mesh.vertices[a.subscript()], self.mesh.vertices[b.subscript()]);
        // Counted from the lesser point on, so that both faces see the same.
        let forward = one.point <= other.point;
        let (first, last) = if forward { (a, b) } else { (b, a) };
        let (start, end) = (self.mesh.vertices[first.subscript()], self.mesh.vertices[last.subscript()]);
        let (from, to) = (self.mesh.points[start.point.subscript()], self.mesh.points[end.point.subscript()]);
        let mut made = Vec::new();
        for cut in self.levels.cuts(from, to) {
            let vertex = *self.vertices.entry(((first.0, last.0), cut.level)).or_insert_with(|| {
                let side = (key(start.point.0, end.point.0), cut.level);
                let point = *self.points.entry(side).or_insert_with(|| {
                    self.mesh.points.push(from.lerp(to, cut.part));
                    index(self.mesh.points.len() - 1)
                });
                let vertex = between((&start, &end), cut.part, PointIndex(point), self.periods);
                self.mesh.vertices.push(vertex);
                index(self.mesh.vertices.len() - 1)
            });
            made.push(VertexIndex(vertex));
        }
        if !forward {
            made.reverse();
        }
        let mut all = vec![a];
        all.extend(made);
        all
    }

    /// Cuts a convex face of three or four corners.
    fn face(&mut self, corners: &[VertexIndex]) {
        let count = corners.len();
        let mut ring = Vec::new();
        for k in 0..count {
            ring.extend(self.side(corners[k], corners[(k + 1) % count]));
        }
        if ring.len() == 3 {
            self.mesh.triangles.push([ring[0], ring[1], ring[2]]);
        } else if ring.len() > 3 {
            self.ladder(&ring);
        }
    }

    /// Triangles of a ring of vertices around a convex face, from its lowest to its highest place.
    fn ladder(&mut self, ring: &[VertexIndex]) {
        let axis = self.levels.axis();
        let heights: Vec<f64> = ring.iter().map(|vertex| self.place(*vertex).dot(axis)).collect();
        let by = |a: &usize, b: &usize| heights[*a].total_cmp(&heights[*b]);
        let count = ring.len();
        let lowest = (0..count).min_by(by).unwrap_or(0);
        let highest = (0..count).max_by(by).unwrap_or(0);
        let chain = |step: usize| {
            let mut chain = vec![lowest];
            while chain[chain.len() - 1] != highest {
                chain.push((chain[chain.len() - 1] + step) % count);
            }
            chain
        };
        // The ring runs counterclockwise: up on the right, and down on the left.
        let (right, left) = (chain(1), chain(count - 1));
        let (mut i, mut j) = (0, 0);
        let mut made: Vec<[usize; 3]> = Vec::with_capacity(count);
        // Both chains begin and end in one place: the first and the last triangle have it once.
        while i + 1 < right.len() || j + 1 < left.len() {
            let ahead = |chain: &[usize], at: usize| chain.get(at + 1).copied();
            let (up_right, up_left) = (ahead(&right, i), ahead(&left, j));
            let on_right = match (up_right, up_left) {
                (Some(one), Some(other)) if one == highest => other == highest || left.len() == 2,
                (Some(_), Some(other)) if other == highest => true,
                (Some(one), Some(other)) => heights[one] <= heights[other],
                (one, _) => one.is_some(),
            };
            let (here, there) = (right[i], left[j]);
            let next = if on_right { up_right } else { up_left }.unwrap_or(highest);
            if here != there && next != here && next != there {
                made.push([here, next, there]);
            }
            if on_right { i += 1 } else { j += 1 }
        }
        self.mesh.triangles.extend(made.into_iter().map(|triangle| triangle.map(|k| ring[k])));
    }

    /// The parts of lines after the cuts.
    fn cut_lines(&self, mesh: &Mesh, hard: HashSet<(u32, u32)>) -> HashSet<(u32, u32)> {
        let mut all = HashSet::with_capacity(hard.len());
        let mut sorted: Vec<(u32, u32)> = hard.into_iter().collect();
        sorted.sort_unstable();
        for (a, b) in sorted {
            let (from, to) = (mesh.points[a as usize], mesh.points[b as usize]);
            let mut last = a;
            for cut in self.levels.cuts(from, to) {
                // A line that no face has is not cut.
                let Some(point) = self.points.get(&((a, b), cut.level)) else { continue };
                all.insert(key(last, *point));
                last = *point;
            }
            all.insert(key(last, b));
        }
        all
    }
}
