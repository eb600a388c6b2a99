//! Texture coordinates by which no two places of a mesh share a place of a picture.

use uvunwrap::{Density, MeshInput, Options, generate};

use super::whole_triangles;

/// Places of a mesh on a picture of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Unwrapped {
    /// For each vertex the one that it was split from.
    pub from: Vec<u32>,
    /// For each vertex its place, from 0 to 1 along both sides.
    pub places: Vec<[f32; 2]>,
    /// The triangles, in their order, by the new vertices.
    pub indices: Vec<u32>,
    /// How many pieces lie apart from each other.
    pub charts: u32,
}

/// Lays a mesh out on a square picture of `size` texels a side, `padding` texels from its border and twice as many between
/// pieces. Triangles keep their order; vertices at seams become several. Every piece has the same texels for a metre, as near as
/// its bends allow. Without area a triangle has no place of its own.
///
/// Source: the crate uvunwrap: least squares conformal maps (B. Lévy and others, 2002), made as rigid as possible; its results
/// are the same on every machine.
///
/// # Errors
/// What the library says against it.
///
/// # Panics
/// When an index is not below the number of vertices.
pub fn unwrapped(
    positions: &[[f32; 3]],
    indices: &[u32],
    (size, padding): (u32, u32),
) -> Result<Unwrapped, String> {
    assert!(whole_triangles(indices, positions.len()), "a mesh's indices are in range");
    let options = Options { density: Density::Auto { page_size: size }, padding, ..Options::default() };
    let atlas =
        generate(&[MeshInput::new(positions, indices)], &options).map_err(|error| error.to_string())?;
    if atlas.page_count > 1 {
        return Err(format!("its {} pieces do not fit on one picture", atlas.chart_count));
    }
    let mesh = atlas.meshes.into_iter().next().unwrap_or_default();
    // The library crops its picture: places are shares of what is left of it.
    #[expect(
        clippy::cast_precision_loss,
        reason = "pictures have fewer texels a side than single precision counts"
    )]
    let [width, height] = [atlas.width, atlas.height].map(|side| side as f32 / size as f32);
    let place = |[u, v]: [f32; 2]| [(u * width).clamp(0.0, 1.0), (v * height).clamp(0.0, 1.0)];
    Ok(Unwrapped {
        from: mesh.vertices.iter().map(|vertex| vertex.xref).collect(),
        places: mesh.vertices.iter().map(|vertex| place(vertex.uv)).collect(),
        indices: mesh.indices,
        charts: atlas.chart_count,
    })
}
