//! Vectors into buffers: floats, directions, texture coordinates.

use glam::{DVec2, DVec4};
use gltf::json::accessor::{ComponentType, Type};
use gltf::json::{Accessor, Index, Root};

use super::buffer::{Binary, Content, Elements};
use crate::geometry::number::floor_count;
use crate::packing::{exponential, octahedral, signed_byte};

/// Appends numbers in single precision.
pub(super) fn put<const N: usize>(bytes: &mut Vec<u8>, numbers: [f32; N]) {
    // Zero has one form, so that equal positions are equal bytes.
    let words = numbers.map(|number| (number + 0.0).to_le_bytes());
    bytes.extend_from_slice(words.as_flattened());
}

/// Unit vectors: floats, or bytes.
#[derive(Clone, Copy)]
pub(super) struct Directions {
    pub(super) small: bool,
    pub(super) count: usize,
}

impl Directions {
    pub(super) fn write(
        self,
        root: &mut Root,
        binary: &mut Binary,
        shape: Type,
        all: impl Iterator<Item = DVec4>,
    ) -> Index<Accessor> {
        let count = self.count;
        if !self.small {
            let floats = Elements { component: ComponentType::F32, shape, count };
            let wide = shape == Type::Vec4;
            let content = Content::Attributes { stride: if wide { 16 } else { 12 } };
            return binary.attribute(root, floats, content, |bytes| {
                for vector in all {
                    let vector = vector.as_vec4();
                    if wide {
                        put(bytes, vector.to_array());
                    } else {
                        put(bytes, vector.truncate().to_array());
                    }
                }
            });
        }
        let elements = Elements { component: ComponentType::I8, shape, count };
        let folded = binary.is_compressed();
        let content = if folded { Content::Directions } else { Content::Attributes { stride: 4 } };
        let made = binary.attribute(root, elements, content, |bytes| {
            for vector in all {
                let [x, y, z, w] = vector.to_array();
                let vector = if folded { octahedral([x, y, z], w) } else { [x, y, z, w].map(signed_byte) };
                bytes.extend(vector.map(i8::cast_unsigned));
            }
        });
        root.accessors[made.value()].normalized = true;
        made
    }
}

/// Texture coordinates: floats, or 16 bits where all lie in the unit square. Floats that are compressed have 16 bits of the
/// power of two above the greatest.
pub(super) fn uvs(root: &mut Root, binary: &mut Binary, all: &[DVec2], small: bool) -> Index<Accessor> {
    let count = all.len();
    let inside = |uv: &DVec2| uv.min_element() >= 0.0 && uv.max_element() <= 1.0;
    if !(small && all.iter().all(inside)) {
        let floats = Elements { component: ComponentType::F32, shape: Type::Vec2, count };
        if binary.is_compressed() {
            let all: Vec<f64> = all.iter().flat_map(DVec2::to_array).collect();
            return binary.attribute(root, floats, Content::Exponential { stride: 8 }, |bytes| {
                exponential(&all).iter().for_each(|word| bytes.extend_from_slice(&word.to_le_bytes()));
            });
        }
        return binary.attribute(root, floats, Content::Attributes { stride: 8 }, |bytes| {
            for uv in all {
                put(bytes, uv.as_vec2().to_array());
            }
        });
    }
    let elements = Elements { component: ComponentType::U16, shape: Type::Vec2, count };
    let made = binary.attribute(root, elements, Content::Attributes { stride: 4 }, |bytes| {
        for uv in all {
            let share = |part: f64| u16::try_from(floor_count((part * 65535.0).round())).unwrap_or(u16::MAX);
            bytes.extend_from_slice(uv.to_array().map(|part| share(part).to_le_bytes()).as_flattened());
        }
    });
    root.accessors[made.value()].normalized = true;
    made
}
