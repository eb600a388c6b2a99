//! Attributes that games read themselves, under names of their own: floats, or bytes; read back as the range that they span.
//!
//! Elements begin on multiples of four, as the format demands of vertices: bytes are always four, those that nothing is said of 0.
//! Blender's importer fails on one of them, and leaves out two and three.

use std::collections::BTreeMap;

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked as Valid;
use gltf::json::{Accessor, Index, Root};
use indexmap::IndexMap;

use super::buffer::{Binary, Content, Elements};
use super::read::{ReadError, elements, kind};
use crate::packing::{exponential, share_byte};
use crate::scene::VertexAttribute;

/// Attributes with their names.
pub(super) type Named = Vec<(String, Index<Accessor>)>;

/// Writes attributes of triangles, or of lines.
pub(super) fn written(
    root: &mut Root,
    binary: &mut Binary,
    all: &[VertexAttribute],
    values: impl Fn(&VertexAttribute) -> &[f32],
) -> Named {
    all.iter().map(|own| (own.name.clone(), one(root, binary, own, values(own)))).collect()
}

fn one(root: &mut Root, binary: &mut Binary, own: &VertexAttribute, values: &[f32]) -> Index<Accessor> {
    let count = values.len() / own.width;
    if own.bytes {
        let elements = Elements { component: ComponentType::U8, shape: Type::Vec4, count };
        let made = binary.attribute(root, elements, Content::Attributes { stride: 4 }, |bytes| {
            for element in values.chunks_exact(own.width) {
                let mut word = [0; 4];
                word.iter_mut().zip(element).for_each(|(byte, value)| *byte = share_byte(*value));
                bytes.extend_from_slice(&word);
            }
        });
        root.accessors[made.value()].normalized = true;
        return made;
    }
    let shape = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4][own.width - 1];
    let (elements, stride) = (Elements { component: ComponentType::F32, shape, count }, 4 * own.width);
    if binary.is_compressed() {
        let wide: Vec<f64> = values.iter().copied().map(f64::from).collect();
        return binary.attribute(root, elements, Content::Exponential { stride }, |bytes| {
            exponential(&wide).iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
        });
    }
    binary.attribute(root, elements, Content::Attributes { stride }, |bytes| {
        values.iter().for_each(|value| bytes.extend_from_slice(&value.to_le_bytes()));
    })
}

/// Puts them among the attributes of a primitive.
pub(super) fn name(attributes: &mut BTreeMap<Valid<Semantic>, Index<Accessor>>, own: &Named) {
    // The library writes the underscore itself.
    let named = |(name, accessor): &(String, Index<Accessor>)| {
        (Valid::Valid(Semantic::Extras(name[1..].to_owned())), *accessor)
    };
    attributes.extend(own.iter().map(named));
}

/// The least and the greatest of each component of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadRange {
    /// The least.
    pub min: Vec<f32>,
    /// The greatest.
    pub max: Vec<f32>,
}

/// The attributes of their own that the primitives of a mesh have, by their names.
pub(super) fn read_attributes(
    root: &Root,
    binary: &[u8],
    mesh: usize,
) -> Result<IndexMap<String, ReadRange>, ReadError> {
    let mut found: IndexMap<String, ReadRange> = IndexMap::new();
    let mut known: Vec<usize> = Vec::new();
    let primitives = root.meshes[mesh].primitives.iter().flat_map(|primitive| &primitive.attributes);
    for (semantic, index) in primitives {
        let Valid::Valid(Semantic::Extras(name)) = semantic else { continue };
        if known.contains(&index.value()) {
            continue;
        }
        known.push(index.value());
        let unsupported = || ReadError::Unsupported(format!("accessor {} as an attribute", index.value()));
        let (component, shape) = kind(root, *index).ok_or_else(unsupported)?;
        let (size, width) = (component.size(), shape.multiplicity());
        for element in elements(root, binary, *index, width * size)?.each(binary) {
            for (part, word) in element.chunks_exact(size).enumerate() {
                let value = match (component, word) {
                    (ComponentType::U8, [byte]) => f32::from(*byte) / 255.0,
                    (ComponentType::F32, [a, b, c, d]) => f32::from_le_bytes([*a, *b, *c, *d]),
                    _ => return Err(unsupported()),
                };
                let range = found.entry(format!("_{name}")).or_insert_with(|| ReadRange {
                    min: vec![f32::INFINITY; width],
                    max: vec![f32::NEG_INFINITY; width],
                });
                range.min[part] = range.min[part].min(value);
                range.max[part] = range.max[part].max(value);
            }
        }
    }
    Ok(found)
}
