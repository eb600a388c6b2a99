//! Lines into primitives.
//!
//! All strands of a material are one primitive of mode LINES: one call to draw them, and a mode that every engine reads
//! (line loops, for one, are not). They carry no normals, so that by the format they are shown without light.

use std::collections::BTreeMap;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked as Valid;
use gltf::json::{Accessor, Index, Root};

use super::attribute;
use super::buffer::{Binary, index_accessors};
use super::color::colors;
use super::position::positions;
use crate::geometry::mesh;
use crate::scene::{Geometry, Grid, MeshUse};

/// The lines of one origin, written.
pub(super) struct Lines {
    origin: u32,
    position: Index<Accessor>,
    color: Option<Index<Accessor>>,
    attributes: attribute::Named,
    indices: Index<Accessor>,
}

impl Lines {
    pub(super) fn primitive(&self, mesh: &MeshUse) -> Primitive {
        let material = mesh.materials[self.origin as usize];
        let mut attributes = BTreeMap::from([(Valid::Valid(Semantic::Positions), self.position)]);
        attributes.extend(self.color.map(|color| (Valid::Valid(Semantic::Colors(0)), color)));
        attribute::name(&mut attributes, &self.attributes);
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(self.indices),
            material: material.map(|index| Index::new(mesh::index(index))),
            mode: Valid::Valid(Mode::Lines),
            targets: None,
        }
    }
}

/// Writes the positions and colors of a wire, which all its primitives share, and the indices of each origin.
pub(super) fn shared(
    root: &mut Root,
    binary: &mut Binary,
    geometry: &Geometry,
    (grid, small): (Option<Grid>, bool),
) -> Vec<Lines> {
    let wire = &geometry.wire;
    if wire.is_empty() {
        return Vec::new();
    }
    let position = positions(root, binary, grid, wire.points.iter().map(|point| point.position));
    let shades = wire.points.iter().map(|point| point.color);
    let color = geometry.colored.then(|| colors(root, binary, shades, small));
    let attributes = attribute::written(root, binary, &geometry.attributes, |own| &own.of_lines);
    let mut origins: Vec<u32> = wire.strands.iter().map(|strand| strand.origin).collect();
    origins.dedup();
    let ends = |origin: &u32| wire.segments(*origin).flatten();
    let counts = origins.iter().map(|origin| ends(origin).count());
    let all = origins.iter().flat_map(ends);
    let indices = index_accessors(root, binary, all, (wire.points.len(), true), counts);
    let lines = |(origin, indices): (u32, Index<Accessor>)| Lines {
        origin,
        position,
        color,
        attributes: attributes.clone(),
        indices,
    };
    origins.iter().copied().zip(indices).map(lines).collect()
}
