//! Triangles moved along their normals by heights, cut until they follow them.
//!
//! Promise: what shared a point shares it still, so a closed mesh stays closed; at each place checked between the corners
//! (so many to a side as the heights have detail there) the result is within the tolerance of the mesh moved exactly; and
//! triangles that run through each other are refused, decided exactly. The bound is sampled. Not promised: that a height
//! which changes wildly within a fraction of a triangle is seen where its detail is not known.
//!
//! Where a mesh is smooth, points go along the one normal there. At a sharp edge or corner they go along the miter: the
//! shortest way on which every face that meets there moves by the height along its own normal, so a box moved evenly is a
//! larger box. Miters are limited to [`MITER`] heights, as for strokes of drawings.
//!
//! Sources: R. Cook, "Shade trees", 1984 (displacement); M.-C. Rivara, "Algorithms for refining triangular grids suitable
//! for adaptive and multigrid techniques", 1984 (the longest side is split with any other).

mod direction;
mod field;
mod normals;
mod picture;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};

use glam::{DVec2, DVec3};
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::deform::{Splitter, key};
use super::{Deviation, Evidence, TessellateError};
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::crossing::crossings;
pub use picture::{PictureFault, normal_picture};

use direction::Directions;
use field::Facet;

/// Greatest length of a miter, in heights.
const MITER: f64 = 3.0;

/// Heights over a mesh, and how fine their detail is.
pub struct Heights<'a> {
    /// The height at a place and its texture coordinates, metres.
    pub height: &'a (dyn Fn(DVec3, DVec2) -> f64 + Sync),
    /// How many steps of detail lie between two places; 0 where that is not known.
    pub detail: &'a (dyn Fn([DVec3; 2], [DVec2; 2]) -> f64 + Sync),
}

/// What is asked of a triangle.
struct Verdict {
    /// Sides to be split, each after its corner.
    split: [bool; 3],
    error: f64,
    /// Whether the height jumps in it.
    jumps: bool,
}

/// Moves a mesh. `periods` are the parameters after which u and v of each source come round again.
///
/// # Errors
/// When more triangles than `limit` are needed, heights on both sides of a seam of the texture differ by more than the
/// tolerance, or the result crosses itself.
pub fn displace(
    mesh: Mesh,
    heights: &Heights<'_>,
    periods: &[(f64, f64)],
    aim: f64,
    limit: u64,
) -> Result<(Mesh, Deviation), TessellateError> {
    let mut directions = Directions::new(&mesh);
    let mut splitter = Splitter::new(mesh, HashSet::new(), periods);
    let mut known: Vec<Option<f64>> = vec![None; splitter.mesh.triangles.len()];
    loop {
        let moved = lifted(&splitter.mesh, heights, aim)?;
        let verdicts = judged(&splitter.mesh, &directions, heights, &moved, &known, aim);
        for (slot, verdict) in known.iter_mut().zip(&verdicts) {
            *slot = (!verdict.split.contains(&true)).then_some(verdict.error);
        }
        if let Some(triangle) = verdicts.iter().position(|verdict| verdict.jumps) {
            let corner = splitter.mesh.triangles[triangle][0];
            let place = splitter.mesh.points[splitter.mesh.vertices[corner.subscript()].point.subscript()];
            return Err(TessellateError::TornSeam { place, gap: verdicts[triangle].error });
        }
        let marks = marked(&splitter.mesh, &verdicts);
        if marks.is_empty() {
            let error = known.into_iter().flatten().fold(0.0, f64::max);
            return finished(splitter.mesh, &directions, heights, &moved, error);
        }
        let needed = (splitter.mesh.triangles.len() + marks.len()) as u64;
        if needed > limit {
            return Err(TessellateError::TooMany { needed, limit });
        }
        let parts = splitter.split(&marks);
        directions.follow(&splitter);
        let old = known;
        let kept = |part: &super::deform::Part| if part.whole { old[part.of as usize] } else { None };
        known = parts.iter().map(kept).collect();
    }
}

/// The height of each point: the mean over its vertices, which agree.
fn lifted(mesh: &Mesh, heights: &Heights<'_>, aim: f64) -> Result<Vec<f64>, TessellateError> {
    let own: Vec<f64> = mesh
        .vertices
        .iter()
        .map(|vertex| (heights.height)(mesh.points[vertex.point.subscript()], vertex.uv))
        .collect();
    let mut range = vec![(f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0); mesh.points.len()];
    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|corner| used[corner.subscript()] = true);
    for ((vertex, height), _) in mesh.vertices.iter().zip(&own).zip(&used).filter(|(_, used)| **used) {
        if !height.is_finite() {
            return Err(TessellateError::NoHeight { place: mesh.points[vertex.point.subscript()] });
        }
        let (low, high, sum, count) = &mut range[vertex.point.subscript()];
        (*low, *high) = (low.min(*height), high.max(*height));
        *sum += height;
        *count += 1.0;
    }
    for (point, (low, high, ..)) in range.iter().enumerate() {
        if high - low > aim {
            return Err(TessellateError::TornSeam { place: mesh.points[point], gap: high - low });
        }
    }
    Ok(range.into_iter().map(|(_, _, sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect())
}

fn judged(
    mesh: &Mesh,
    directions: &Directions,
    heights: &Heights<'_>,
    moved: &[f64],
    known: &[Option<f64>],
    aim: f64,
) -> Vec<Verdict> {
    (0..mesh.triangles.len())
        .into_par_iter()
        .with_min_len(64)
        .map(|triangle| match known[triangle] {
            Some(error) => Verdict { split: [false; 3], error, jumps: false },
            None => Facet::of(mesh, directions, heights, moved, triangle).judge(aim),
        })
        .collect()
}

/// The sides that are split: those that ask for it, and the longest of each triangle that has one.
fn marked(mesh: &Mesh, verdicts: &[Verdict]) -> HashMap<(u32, u32), f64> {
    let points =
        |triangle: usize| mesh.triangles[triangle].map(|corner| mesh.vertices[corner.subscript()].point.0);
    let sides = |triangle: usize| {
        let [a, b, c] = points(triangle);
        [key(a, b), key(b, c), key(c, a)]
    };
    let length = |(a, b): (u32, u32)| mesh.points[a as usize].distance_squared(mesh.points[b as usize]);
    let longest = |triangle: usize| {
        let sides = sides(triangle);
        // Of equal ones the same for both triangles beside it.
        sides.into_iter().max_by(|one, other| length(*one).total_cmp(&length(*other)).then(one.cmp(other)))
    };
    let mut marks: HashSet<(u32, u32)> = HashSet::new();
    for (triangle, verdict) in verdicts.iter().enumerate() {
        let asked = sides(triangle).into_iter().zip(verdict.split).filter(|(_, split)| *split);
        marks.extend(asked.map(|(side, _)| side));
    }
    let mut grows = !marks.is_empty();
    while grows {
        grows = false;
        for triangle in 0..verdicts.len() {
            if sides(triangle).iter().any(|side| marks.contains(side)) {
                grows |= longest(triangle).is_some_and(|side| marks.insert(side));
            }
        }
    }
    marks.into_iter().map(|side| (side, 0.5)).collect()
}

/// The mesh moved, with normals of what it follows.
fn finished(
    mut mesh: Mesh,
    directions: &Directions,
    heights: &Heights<'_>,
    moved: &[f64],
    error: f64,
) -> Result<(Mesh, Deviation), TessellateError> {
    if let Some(place) = folded(&mesh, directions, heights, moved) {
        return Err(TessellateError::CrossesItself { place });
    }
    let before = enclosed(&mesh);
    let normals = normals::normals(&mesh, directions, heights, moved);
    for ((point, height), at) in mesh.points.iter_mut().zip(moved).zip(0..) {
        *point += directions.at(at) * *height;
    }
    for (vertex, normal) in mesh.vertices.iter_mut().zip(normals) {
        vertex.normal = normal;
    }
    let triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .map(|corners| corners.map(|corner| mesh.vertices[corner.subscript()].point.0))
        .collect();
    if let Some([one, _]) = crossings(&mesh.points, &triangles).first() {
        let corners = triangles[*one as usize].map(|corner| mesh.points[corner as usize]);
        return Err(TessellateError::CrossesItself { place: (corners[0] + corners[1] + corners[2]) / 3.0 });
    }
    // A body moved inward through its own middle crosses nothing, but is inside out.
    if before.is_some_and(|volume| volume > 0.0) && enclosed(&mesh).is_some_and(|volume| volume <= 0.0) {
        let middle = mesh.points.iter().sum::<DVec3>() / mesh.points.len() as f64;
        return Err(TessellateError::CrossesItself { place: middle });
    }
    Ok((mesh, Deviation::new(error, Evidence::Sampled)))
}

/// A place where the surface is turned over.
fn folded(mesh: &Mesh, directions: &Directions, heights: &Heights<'_>, moved: &[f64]) -> Option<DVec3> {
    (0..mesh.triangles.len()).into_par_iter().with_min_len(256).find_map_first(|triangle| {
        let facet = Facet::of(mesh, directions, heights, moved, triangle);
        (0..3).find(|corner| facet.is_folded(*corner)).map(|corner| facet.corners()[corner])
    })
}

/// The volume inside of a mesh whose sides all have another beside them; of an open one none.
fn enclosed(mesh: &Mesh) -> Option<f64> {
    // Only looked up, never walked.
    let mut open: HashSet<[u32; 2]> = HashSet::new();
    let mut volume = 0.0;
    for triangle in &mesh.triangles {
        let points = triangle.map(|corner| mesh.vertices[corner.subscript()].point);
        let [a, b, c] = points.map(|point| mesh.points[point.subscript()]);
        volume += a.dot(b.cross(c)) / 6.0;
        for k in 0..3 {
            let (from, to) = (points[k].0, points[(k + 1) % 3].0);
            if !open.remove(&[to, from]) {
                open.insert([from, to]);
            }
        }
    }
    open.is_empty().then_some(volume)
}
