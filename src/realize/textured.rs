//! Which shapes carry texture coordinates.

use crate::model::{Displacement, MaterialHandle, Model, Recipe, ShapeHandle, UvMode};

/// Whether a shape carries texture coordinates, by its materials and what it asks for.
pub(super) fn wants_uv(model: &Model, handle: ShapeHandle, overrides: &[Option<MaterialHandle>]) -> bool {
    let shape = model.shape(handle);
    match shape.options.uv {
        // A second set of coordinates is no second without a first.
        _ if shape.options.lightmap.is_some() => true,
        UvMode::Always => true,
        _ if model.attributes.iter().any(|own| own.shape == handle && own.wants_uv) => true,
        UvMode::None => false,
        UvMode::Auto => {
            let textured = |material: &MaterialHandle| model.material(*material).needs_uv();
            overrides.iter().flatten().any(textured) || shows_texture(model, handle)
        }
    }
}

/// Whether a material with a texture is on the shape or a part of it. Shapes come after their parts, so one
/// pass over those before it is enough however often parts share parts.
fn shows_texture(model: &Model, handle: ShapeHandle) -> bool {
    let textured = |material: &MaterialHandle| model.material(*material).needs_uv();
    let mut shows: Vec<bool> = Vec::with_capacity(handle.0 as usize + 1);
    for shape in &model.shapes[..=handle.0 as usize] {
        let of_parts = match &shape.recipe {
            Recipe::Assembly(parts) => parts.iter().any(|(part, _)| shows[part.0 as usize]),
            Recipe::Deformed { of, .. } | Recipe::Displaced(Displacement { of, .. }) => shows[of.0 as usize],
            Recipe::Subdivided(refined) => shows[refined.cage.0 as usize],
            Recipe::Solid(solid) => solid.parts.iter().any(|part| shows[part.0 as usize]),
            Recipe::Polygons { materials, .. } => materials.iter().flatten().any(textured),
            _ => false,
        };
        let drawn = model.normal_maps.iter().any(|map| map.shape.0 as usize == shows.len());
        shows.push(of_parts || drawn || shape.options.material.iter().any(textured));
    }
    shows.pop().unwrap_or(false)
}
