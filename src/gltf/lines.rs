//! Lines into primitives.
//!
//! All strands of a material are one primitive of mode LINES: one call to draw them, and a mode that every engine reads
//! (line loops, for one, are not). They carry no normals, so that by the format they are shown without light.

use std::collections::BTreeMap;

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::buffer::Target;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked as Valid;
use gltf::json::{Accessor, Index, Root};

use super::buffer::{Binary, Elements, accessor};
use super::write::{index_width, put};
use crate::geometry::mesh;
use crate::geometry::mesh::Wire;
use crate::scene::MeshUse;

/// The lines of one origin, written.
pub(super) struct Lines {
    origin: u32,
    position: Index<Accessor>,
    indices: Index<Accessor>,
}

impl Lines {
    pub(super) fn primitive(&self, mesh: &MeshUse) -> Primitive {
        let material = mesh.materials[self.origin as usize];
        Primitive {
            attributes: BTreeMap::from([(Valid::Valid(Semantic::Positions), self.position)]),
            extensions: None,
            extras: None,
            indices: Some(self.indices),
            material: material.map(|index| Index::new(mesh::index(index))),
            mode: Valid::Valid(Mode::Lines),
            targets: None,
        }
    }
}

/// Writes the positions of a wire, which all its primitives share, and the indices of each origin.
pub(super) fn shared(root: &mut Root, binary: &mut Binary, wire: &Wire) -> Vec<Lines> {
    if wire.is_empty() {
        return Vec::new();
    }
    let position = positions(root, binary, wire);
    let mut origins: Vec<u32> = wire.strands.iter().map(|strand| strand.origin).collect();
    origins.dedup();
    let width = index_width(wire.points.len());
    let start = binary.start();
    let mut counts = Vec::new();
    for &origin in &origins {
        let before = binary.bytes.len();
        for end in wire.segments(origin).flatten() {
            binary.bytes.extend_from_slice(&end.to_le_bytes()[..width]);
        }
        counts.push((binary.bytes.len() - before) / width);
    }
    let view = binary.view(root, start, Some(Target::ElementArrayBuffer));
    let component = if width == 2 { ComponentType::U16 } else { ComponentType::U32 };
    let mut first = 0;
    let mut all = Vec::with_capacity(origins.len());
    for (origin, count) in origins.into_iter().zip(counts) {
        let elements = Elements { component, shape: Type::Scalar, count };
        let indices = root.push(accessor(view, first * width, elements, None));
        all.push(Lines { origin, position, indices });
        first += count;
    }
    all
}

fn positions(root: &mut Root, binary: &mut Binary, wire: &Wire) -> Index<Accessor> {
    let start = binary.start();
    let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in &wire.points {
        let position = (point.position.as_vec3() + 0.0).to_array();
        for axis in 0..3 {
            min[axis] = min[axis].min(position[axis]);
            max[axis] = max[axis].max(position[axis]);
        }
        put(&mut binary.bytes, position);
    }
    let view = binary.view(root, start, Some(Target::ArrayBuffer));
    let elements = Elements { component: ComponentType::F32, shape: Type::Vec3, count: wire.points.len() };
    root.push(accessor(view, 0, elements, Some((min, max))))
}
