//! A second set of texture coordinates, by which no two places of a mesh share a place of a picture.
//!
//! Promise: what is laid out lies in the unit square, and no two triangles overlap there by more than rounding, or there is no
//! result. Vertices at seams are split; each keeps all that it carries.

use glam::DVec2;

use crate::geometry::mesh::VertexIndex;
use crate::geometry::mesh::overlap::overlaps;
use crate::packing::unwrapped;
use crate::scene::{Geometry, Lightmap};

/// The most triangles that are laid out: the time grows faster than their number.
const MOST_UNWRAPPED: usize = 200_000;

/// How deep triangles may overlap that share a side: rounding to single precision.
const ROUNDING: f64 = 1e-6;

/// Gives a geometry a second set of texture coordinates for a square picture of so many texels a side, and so many around each
/// of its pieces.
///
/// # Errors
/// What speaks against it, as the end of a sentence about the shape.
pub fn lay_out(geometry: &mut Geometry, (size, padding): (u32, u32)) -> Result<(), String> {
    let mesh = &mut geometry.mesh;
    if mesh.triangles.len() > MOST_UNWRAPPED {
        let count = mesh.triangles.len();
        return Err(format!("has {count} triangles, and at most {MOST_UNWRAPPED} can be laid out"));
    }
    let positions: Vec<[f32; 3]> = mesh
        .vertices
        .iter()
        .map(|vertex| mesh.points[vertex.point.subscript()].as_vec3().to_array())
        .collect();
    let corners: Vec<u32> = mesh.triangles.iter().flatten().map(|vertex| vertex.0).collect();
    let made = unwrapped(&positions, &corners, (size, padding))
        .map_err(|error| format!("cannot be laid out: {error}"))?;
    let places: Vec<DVec2> =
        made.places.iter().map(|place| DVec2::from_array(place.map(f64::from))).collect();
    let triangles: Vec<[u32; 3]> = made.indices.as_chunks::<3>().0.to_vec();
    let crowded = overlaps(&places, &triangles, ROUNDING);
    if crowded > 0 {
        return Err(format!("has {crowded} pairs of triangles that lie on each other when it is laid out"));
    }
    mesh.triangles = triangles.into_iter().map(|corners| corners.map(VertexIndex)).collect();
    mesh.vertices = made.from.iter().map(|from| mesh.vertices[*from as usize]).collect();
    for target in &mut geometry.targets {
        target.normals = made.from.iter().map(|from| target.normals[*from as usize]).collect();
    }
    geometry.lightmap = Some(Lightmap { size, charts: made.charts, places: made.places });
    Ok(())
}
