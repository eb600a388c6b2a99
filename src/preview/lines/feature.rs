//! Which edges of triangles are lines of a drawing.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::preview::camera::{Camera, Projected};
use crate::preview::stage::Stage;

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The border between what is seen of a surface and what faces away.
    Outline,
    /// Where a surface ends.
    Rim,
    /// Where it bends sharply.
    Crease,
    /// Where two surfaces run through each other.
    Intersection,
    /// Where one material ends and another begins.
    Border,
    /// A line of the file itself.
    Wire,
}

/// An edge in the picture.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) kind: Kind,
    /// Points at its ends: equal numbers stand at equal places.
    pub(super) points: [u32; 2],
    pub(super) ends: [Projected; 2],
    /// Triangles that it belongs to.
    pub(super) own: Vec<u32>,
}

/// Triangles without normals of their own bend sharply from this cosine on: 30 degrees.
const SHARP: f64 = 0.866;

/// Normals of one point are the same down to this cosine: 5 degrees.
const SAME: f64 = 0.9962;

/// A triangle's side: which triangle, and the vertices along it.
#[derive(Clone, Copy)]
struct Side {
    triangle: u32,
    vertices: [u32; 2],
}

/// The edges that are drawn, by the numbers of the points of vertices.
pub(super) fn edges(stage: &Stage, camera: &Camera, points: &[u32]) -> Vec<Edge> {
    let place = |vertex: u32| stage.vertices[vertex as usize].point;
    let mut sides: BTreeMap<[u32; 2], Vec<Side>> = BTreeMap::new();
    for (triangle, corners) in (0_u32..).zip(&stage.triangles) {
        let own = corners.map(|corner| points[corner as usize]);
        if own[0] == own[1] || own[1] == own[2] || own[2] == own[0] {
            continue;
        }
        for k in 0..3 {
            let (a, b) = (k, (k + 1) % 3);
            let flip = own[a] > own[b];
            let vertices = if flip { [corners[b], corners[a]] } else { [corners[a], corners[b]] };
            let key = if flip { [own[b], own[a]] } else { [own[a], own[b]] };
            sides.entry(key).or_default().push(Side { triangle, vertices });
        }
    }
    let mut materials = Vec::with_capacity(stage.triangles.len());
    for piece in &stage.pieces {
        materials.resize(piece.end, piece.material);
    }
    let across = |triangle: u32| {
        let [a, b, c] = stage.triangles[triangle as usize].map(place);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let faces = |triangle: u32| {
        let first = place(stage.triangles[triangle as usize][0]);
        across(triangle).dot(camera.towards(first)) > 0.0
    };
    let mut edges = Vec::new();
    for (key, sides) in &sides {
        let kind = match sides.as_slice() {
            [one, other] => {
                let (a, b) = (one.triangle, other.triangle);
                if sharp(stage, one, other, across(a).dot(across(b))) {
                    Some(Kind::Crease)
                } else if materials[a as usize] != materials[b as usize] {
                    Some(Kind::Border)
                } else {
                    (faces(a) != faces(b)).then_some(Kind::Outline)
                }
            }
            _ => Some(Kind::Rim),
        };
        let Some(kind) = kind else { continue };
        let ends = sides[0].vertices.map(|vertex| camera.project(place(vertex)));
        if let [Some(start), Some(end)] = ends {
            let own = sides.iter().map(|side| side.triangle).collect();
            edges.push(Edge { kind, points: *key, ends: [start, end], own });
        }
    }
    for line in &stage.lines {
        if let [Some(start), Some(end)] = line.map(|vertex| camera.project(place(vertex))) {
            let points = line.map(|vertex| points[vertex as usize]);
            edges.push(Edge { kind: Kind::Wire, points, ends: [start, end], own: Vec::new() });
        }
    }
    edges
}

/// Whether a surface bends sharply between two triangles: by the normals of their vertices, which say what is meant; by
/// the triangles where there are none.
fn sharp(stage: &Stage, one: &Side, other: &Side, cosine: f64) -> bool {
    let normal = |vertex: u32| stage.vertices[vertex as usize].normal;
    let apart = |k: usize| {
        let (a, b) = (normal(one.vertices[k]), normal(other.vertices[k]));
        (a != DVec3::ZERO && b != DVec3::ZERO).then(|| a.dot(b) < SAME)
    };
    match (apart(0), apart(1)) {
        (Some(start), Some(end)) => start && end,
        _ => cosine < SHARP,
    }
}

/// For each vertex the number of its point: vertices that stand at the same place share one.
pub(super) fn points(stage: &Stage) -> Vec<u32> {
    let mut known: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let number = |vertex: &crate::preview::stage::Vertex| {
        // Minus zero is zero.
        let key = (vertex.point + 0.0).to_array().map(f64::to_bits);
        let next = crate::geometry::number::count_of(known.len());
        *known.entry(key).or_insert(next)
    };
    stage.vertices.iter().map(number).collect()
}
