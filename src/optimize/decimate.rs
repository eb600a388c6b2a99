//! A coarser level of a mesh that has no surface to be cut anew.
//!
//! Promise: vertices of the result are vertices of the mesh, with all that they carry; each material keeps its border, and
//! open borders stay, so that nothing closed opens; the deviation covers the distance between the two meshes, sampled on both.
//! Not promised: that there are fewer triangles, or that parts stay what they were; callers look at both.
//! Source: see [`crate::packing::simplified`].

use super::compact::compact;
use crate::geometry::mesh::nearest::distance_between;
use crate::geometry::mesh::{Mesh, Run, VertexIndex, index};
use crate::geometry::number::single;
use crate::geometry::tessellate::{Deviation, Evidence};
use crate::packing::{Attributes, simplified};
use crate::scene::Geometry;

/// A difference of 1 in a normal counts as this many times the distance that is allowed.
const NORMAL: f64 = 0.5;

/// A difference of 1 in texture coordinates counts as this many times the distance that is allowed.
const UV: f64 = 8.0;

/// A difference of 1 in a part of a color counts as this many times the distance that is allowed.
const COLOR: f64 = 1.0;

/// Samples miss the greatest distance by less than this part of it: they lie that near to each other.
const MARGIN: f64 = 1.1;

/// Errors this near to each other, in parts of what is allowed, are one.
const CLOSE: f64 = 0.05;

/// How often another error is tried where the distance turns out greater than allowed.
const TRIES: u32 = 8;

/// Fewer triangles for a geometry: no further than `allowed` metres from what `finest` is, whose deviation is taken on top.
/// Lines stay as they are. `None` where that is not to be had. O(n log n).
#[must_use]
pub fn decimated(geometry: &Geometry, finest: &Geometry, allowed: f64) -> Option<Geometry> {
    let room = allowed - finest.deviation.bound;
    if room.is_nan() || room <= 0.0 || geometry.mesh.triangles.is_empty() || !geometry.targets.is_empty() {
        return None;
    }
    // The greatest error whose result stays within the room, halved in again and again.
    let (mut good, mut bad, mut best) = (0.0, f64::INFINITY, None);
    let mut error = room;
    for _ in 0..TRIES {
        let mesh = thinned(&geometry.mesh, (geometry.uv, geometry.colored), error);
        let distance = distance_between(&mesh, &finest.mesh) * MARGIN;
        if distance <= room {
            good = error;
            best = (mesh.triangles.len() < geometry.mesh.triangles.len()).then_some((mesh, distance));
        } else {
            bad = error;
        }
        if bad.is_infinite() || bad - good < CLOSE * room {
            break;
        }
        error = (good + bad) / 2.0;
    }
    let (mesh, distance) = best?;
    let deviation = Deviation::new(finest.deviation.bound + distance, Evidence::Sampled);
    let mut made = Geometry { mesh, deviation, tangents: None, ..geometry.clone() };
    compact(&mut made);
    Some(made)
}

/// The mesh with fewer triangles, run by run; vertices and points stay, used or not.
fn thinned(mesh: &Mesh, (uv, colored): (bool, bool), error: f64) -> Mesh {
    let center = mesh.bounds().center();
    let single3 = |vector: glam::DVec3| vector.as_vec3().to_array();
    let positions: Vec<[f32; 3]> =
        mesh.vertices.iter().map(|vertex| single3(mesh.points[vertex.point.subscript()] - center)).collect();
    let bounds = mesh.bounds();
    let size = (bounds.max - bounds.min).max_element();
    let share = |weight: f64| single(weight * error / size);
    let mut weights = vec![share(NORMAL); 3];
    weights.resize(if uv { 5 } else { 3 }, share(UV));
    weights.resize(weights.len() + if colored { 4 } else { 0 }, share(COLOR));
    let values: Vec<f32> = mesh
        .vertices
        .iter()
        .flat_map(|vertex| {
            let uv = uv.then(|| vertex.uv.as_vec2().to_array());
            let color = colored.then_some(vertex.color.0);
            single3(vertex.normal)
                .into_iter()
                .chain(uv.into_iter().flatten())
                .chain(color.into_iter().flatten())
        })
        .collect();
    let seams = if uv { seams(mesh) } else { vec![false; mesh.vertices.len()] };
    let attributes = Attributes { values: &values, weights: &weights };
    let mut made = Mesh { triangles: Vec::new(), runs: Vec::new(), ..mesh.clone() };
    let mut start = 0;
    for run in &mesh.runs {
        let own = &mesh.triangles[start as usize..run.end as usize];
        let indices: Vec<u32> = own.iter().flatten().map(|vertex| vertex.0).collect();
        let few = simplified(&indices, &positions, attributes, &seams, single(error));
        made.triangles.extend(few.as_chunks::<3>().0.iter().map(|corners| corners.map(VertexIndex)));
        let end = index(made.triangles.len());
        if made.runs.last().map_or(0, |last: &Run| last.end) < end {
            made.runs.push(Run { origin: run.origin, end });
        }
        start = run.end;
    }
    made
}

/// Vertices at whose points texture coordinates jump: pictures would be torn where their seam moved.
fn seams(mesh: &Mesh) -> Vec<bool> {
    let mut first: Vec<Option<glam::DVec2>> = vec![None; mesh.points.len()];
    let mut torn = vec![false; mesh.points.len()];
    for vertex in &mesh.vertices {
        let point = vertex.point.subscript();
        torn[point] |= first[point].is_some_and(|uv| uv != vertex.uv);
        first[point] = Some(vertex.uv);
    }
    mesh.vertices.iter().map(|vertex| torn[vertex.point.subscript()]).collect()
}
