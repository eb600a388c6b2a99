//! Colors of vertices: floats, or bytes; read back as the range that they span.
//!
//! Colors are linear, as glTF has them. Without opacity they are three floats; bytes are always four, so that elements
//! begin on multiples of four.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Index, Root};

use super::buffer::{Binary, Content, Elements};
use super::read::{ReadError, elements, kind};
use super::vector::put;
use crate::geometry::mesh::Color;
use crate::packing::share_byte;

/// Writes colors.
pub(super) fn colors(
    root: &mut Root,
    binary: &mut Binary,
    all: impl Iterator<Item = Color> + Clone,
    small: bool,
) -> Index<Accessor> {
    let count = all.clone().count();
    if small {
        let bytes = Elements { component: ComponentType::U8, shape: Type::Vec4, count };
        let made = binary.attribute(root, bytes, Content::Attributes { stride: 4 }, |bytes| {
            all.for_each(|color| bytes.extend_from_slice(&color.0.map(share_byte)));
        });
        root.accessors[made.value()].normalized = true;
        return made;
    }
    let opaque = all.clone().all(|color| color.0[3] == 1.0);
    let (shape, stride) = if opaque { (Type::Vec3, 12) } else { (Type::Vec4, 16) };
    let floats = Elements { component: ComponentType::F32, shape, count };
    binary.attribute(root, floats, Content::Attributes { stride }, |bytes| {
        for color in all {
            let [red, green, blue, alpha] = color.0;
            if opaque {
                put(bytes, [red, green, blue]);
            } else {
                put(bytes, [red, green, blue, alpha]);
            }
        }
    })
}

/// The least and the greatest of each part of the colors of a mesh: linear red, green, blue and alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadColors {
    /// The least.
    pub min: [f32; 4],
    /// The greatest.
    pub max: [f32; 4],
}

/// The colors of all primitives of a mesh; `None` where it has none.
pub(super) fn read_colors(root: &Root, binary: &[u8], mesh: usize) -> Result<Option<ReadColors>, ReadError> {
    let mut known: Vec<usize> = Vec::new();
    let mut range: Option<ReadColors> = None;
    for primitive in &root.meshes[mesh].primitives {
        let Some(index) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) else { continue };
        if known.contains(&index.value()) {
            continue;
        }
        known.push(index.value());
        let unsupported = || ReadError::Unsupported(format!("accessor {} as colors", index.value()));
        let (component, shape) = kind(root, *index).ok_or_else(unsupported)?;
        let count = match shape {
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            _ => return Err(unsupported()),
        };
        let size = component.size();
        for element in elements(root, binary, *index, count * size)?.each(binary) {
            let mut color = [1.0; 4];
            for (part, word) in color.iter_mut().zip(element.chunks_exact(size)) {
                *part = match (component, word) {
                    (ComponentType::U8, [byte]) => f32::from(*byte) / 255.0,
                    (ComponentType::U16, [low, high]) => {
                        f32::from(u16::from_le_bytes([*low, *high])) / 65535.0
                    }
                    (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
                    _ => return Err(unsupported()),
                };
            }
            let range = range.get_or_insert(ReadColors { min: color, max: color });
            for (part, value) in color.into_iter().enumerate() {
                range.min[part] = range.min[part].min(value);
                range.max[part] = range.max[part].max(value);
            }
        }
    }
    Ok(range)
}
