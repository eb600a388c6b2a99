//! MikkTSpace tangents.

use meshopt::TangentOptions;

use super::whole_triangles;

/// A tangent for each corner, as MikkTSpace has it: of unit length or zero, and the sign of the bitangent.
///
/// Source: M. Mikkelsen, Simulation of wrinkled surfaces revisited, 2008; the compatible mode agrees with the
/// reference implementation.
///
/// # Panics
/// When an index is not below the number of vertices, or attributes are not one for each vertex.
#[must_use]
pub fn corner_tangents(
    indices: &[u32],
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    uvs: &[[f32; 2]],
) -> Vec<[f32; 4]> {
    assert!(whole_triangles(indices, positions.len()), "a mesh's indices are in range");
    assert!(
        normals.len() == positions.len() && uvs.len() == positions.len(),
        "each vertex has a normal and texture coordinates"
    );
    meshopt::generate_tangents(Some(indices), positions, normals, uvs, TangentOptions::Compatible)
}
