//! Second texture coordinates of a file.

use gltf::json::Root;
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked;

use super::read::{ReadError, elements, kind};

/// The second texture coordinates of the vertices of a mesh, in the order in which those of its primitives are gathered; `None`
/// where it has none, or not one for each vertex.
pub(super) fn read_second(
    root: &Root,
    binary: &[u8],
    (mesh, vertices): (usize, u32),
) -> Result<Option<Vec<[f32; 2]>>, ReadError> {
    let mut known: Vec<usize> = Vec::new();
    let mut all = Vec::new();
    for primitive in
        root.meshes[mesh].primitives.iter().filter(|one| one.mode == Checked::Valid(Mode::Triangles))
    {
        let Some(index) = primitive.attributes.get(&Checked::Valid(Semantic::TexCoords(1))) else {
            return Ok(None);
        };
        if known.contains(&index.value()) {
            continue;
        }
        known.push(index.value());
        let unsupported =
            || ReadError::Unsupported(format!("accessor {} as texture coordinates", index.value()));
        let (component, Type::Vec2) = kind(root, *index).ok_or_else(unsupported)? else {
            return Err(unsupported());
        };
        let size = component.size();
        for element in elements(root, binary, *index, 2 * size)?.each(binary) {
            let mut place = [0.0; 2];
            for (part, word) in place.iter_mut().zip(element.chunks_exact(size)) {
                *part = match (component, word) {
                    (ComponentType::U16, [low, high]) => {
                        f32::from(u16::from_le_bytes([*low, *high])) / 65535.0
                    }
                    (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
                    _ => return Err(unsupported()),
                };
            }
            all.push(place);
        }
    }
    Ok((!all.is_empty() && all.len() == vertices as usize).then_some(all))
}
