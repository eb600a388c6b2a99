//! The normals of a moved mesh over its texture.

use glam::{DVec2, DVec3};

use super::Heights;
use super::direction::Directions;
use super::field::Facet;
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::texels::texels;

/// Why normals cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureFault {
    /// Texture coordinates.
    pub place: DVec2,
    /// Whether triangles overlap there; otherwise they leave the picture.
    pub overlap: bool,
}

/// The normal of a mesh moved by heights for each texel of a picture, none where the mesh has none.
///
/// # Errors
/// When texture coordinates lie outside of 0 to 1, or triangles cover more than a few texels twice.
pub fn normal_picture(
    mesh: &Mesh,
    heights: &Heights<'_>,
    size: [u32; 2],
) -> Result<Vec<Option<DVec3>>, PictureFault> {
    /// Beyond 0 and 1 by rounding.
    const SLACK: f64 = 1e-6;
    /// A center this deep inside of two triangles is covered twice.
    const DEEP: f64 = 1e-6;
    let directions = Directions::new(mesh);
    let moved: Vec<f64> = vec![0.0; mesh.points.len()];
    let count = size[0] as usize * size[1] as usize;
    let mut found: Vec<(Option<DVec3>, f64)> = vec![(None, f64::NEG_INFINITY); count];
    let mut fault = None;
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        let uvs = triangle.map(|corner| mesh.vertices[corner.subscript()].uv);
        let within = |part: f64| (-SLACK..=1.0 + SLACK).contains(&part);
        if let Some(place) = uvs.into_iter().find(|uv| !within(uv.x) || !within(uv.y)) {
            return Err(PictureFault { place, overlap: false });
        }
        let facet = Facet::of(mesh, &directions, heights, &moved, number);
        texels(uvs, size, |texel| {
            let (normal, inside) = &mut found[texel.at];
            if texel.inside > DEEP && *inside > DEEP {
                let place = (0..3).map(|k| uvs[k] * texel.weights[k]).sum();
                fault.get_or_insert(PictureFault { place, overlap: true });
            }
            if texel.inside > *inside
                && let Some(exact) = facet.normal_at(texel.weights)
            {
                (*normal, *inside) = (Some(exact), texel.inside);
            }
        });
        if let Some(fault) = fault {
            return Err(fault);
        }
    }
    Ok(found.into_iter().map(|(normal, _)| normal).collect())
}
