//! Which vertices of a closed mesh are one, by the extension `EXT_mesh_manifold`.
//!
//! Promise: after merging what the extension names, each half of an edge has exactly one other half; only vertices of one
//! place are merged, and what does not know the extension reads the same mesh as without it. Meshes that are not closed, or
//! have edges of more than two faces, and those with lines, say nothing.
//!
//! Source: E. Lalish, `EXT_mesh_manifold`, Khronos glTF extensions, 2024.

use gltf::json::accessor::sparse::{Indices, Sparse, Values};
use gltf::json::accessor::{ComponentType, IndexComponentType, Type};
use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked as Valid, USize64};
use gltf::json::{Accessor, Index, Root, Value, extensions};
use serde_json::{Map, json};

use super::buffer::{Binary, Content, Elements, accessor, index_width};
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::topology;
use crate::scene::Scene;

const EXTENSION: &str = "EXT_mesh_manifold";

/// Says of every closed mesh of a file which of its vertices are one. Called when accessors have their final places.
pub(super) fn mark(root: &mut Root, binary: &mut Binary, scene: &Scene) {
    let mut marked = false;
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let geometry = &scene.geometries[mesh.geometry];
        if !geometry.wire.is_empty() || !is_manifold(&geometry.mesh) {
            continue;
        }
        let said = manifold(root, binary, (number, &geometry.mesh));
        let others = Map::from_iter([(EXTENSION.to_owned(), said)]);
        root.meshes[number].extensions = Some(extensions::mesh::Mesh { others });
        marked = true;
    }
    if marked {
        root.extensions_used.push(EXTENSION.to_owned());
    }
}

fn is_manifold(mesh: &Mesh) -> bool {
    let point = |vertex: crate::geometry::mesh::VertexIndex| mesh.vertices[vertex.subscript()].point.0;
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|corners| corners.map(point)).collect();
    let measured = topology::of_triangles(&triangles, mesh.points.len());
    !triangles.is_empty() && measured.is_ok_and(|measured| measured.closed && measured.manifold)
}

/// What the extension says of a mesh: its triangles with one vertex for each point.
fn manifold(root: &mut Root, binary: &mut Binary, (number, mesh): (usize, &Mesh)) -> Value {
    let primitives = &root.meshes[number].primitives;
    let position =
        primitives[0].attributes.get(&Valid::Valid(Semantic::Positions)).map_or(0, |at| at.value());
    // All indices of a mesh stand in one view, in the order of its triangles.
    let first = primitives[0].indices.map_or(0, |at| at.value());
    let mut first_of_point = vec![u32::MAX; mesh.points.len()];
    for (vertex, known) in (0..).zip(&mesh.vertices) {
        let first = &mut first_of_point[known.point.subscript()];
        *first = (*first).min(vertex);
    }
    let corners = mesh.triangles.iter().flatten();
    let merged: Vec<(u32, u32)> = (0..)
        .zip(corners)
        .map(|(corner, vertex)| {
            (corner, vertex.0, first_of_point[mesh.vertices[vertex.subscript()].point.subscript()])
        })
        .filter(|(_, own, first)| own != first)
        .map(|(corner, _, first)| (corner, first))
        .collect();
    let whole = Accessor { count: USize64::from(3 * mesh.triangles.len()), ..root.accessors[first].clone() };
    let attributes = json!({ "POSITION": position });
    if merged.is_empty() {
        let indices = root.push(whole);
        return json!({ "manifoldPrimitive": { "attributes": attributes, "indices": indices.value(), "mode": 4 } });
    }
    let corners = words(root, binary, merged.iter().map(|(corner, _)| *corner), 3 * mesh.triangles.len());
    let values = words(root, binary, merged.iter().map(|(_, vertex)| *vertex), mesh.vertices.len());
    let sparse = |words: &Words| (words.view, USize64(0), words.component);
    let (view, byte_offset, component) = sparse(&corners);
    let indices = Indices {
        buffer_view: view,
        byte_offset,
        component_type: Valid::Valid(IndexComponentType(component)),
        extensions: None,
        extras: None,
    };
    let (view, byte_offset, _) = sparse(&values);
    let told = Values { buffer_view: view, byte_offset, extensions: None, extras: None };
    let count = USize64::from(merged.len());
    let sparse = Sparse { count, indices, values: told, extensions: None, extras: None };
    let indices = root.push(Accessor { sparse: Some(sparse), ..whole });
    json!({
        "manifoldPrimitive": { "attributes": attributes, "indices": indices.value(), "mode": 4 },
        "mergeIndices": corners.accessor.value(),
        "mergeValues": values.accessor.value(),
    })
}

/// Whole numbers in a view of their own.
struct Words {
    view: Index<gltf::json::buffer::View>,
    component: ComponentType,
    accessor: Index<Accessor>,
}

/// Writes whole numbers below a bound.
fn words(root: &mut Root, binary: &mut Binary, all: impl Iterator<Item = u32>, bound: usize) -> Words {
    let width = index_width(bound);
    let start = binary.start();
    let mut count = 0;
    for word in all {
        binary.bytes.extend_from_slice(&word.to_le_bytes()[..width]);
        count += 1;
    }
    let view = binary.view(root, start, None, Content::Picture);
    let component = if width == 2 { ComponentType::U16 } else { ComponentType::U32 };
    let elements = Elements { component, shape: Type::Scalar, count };
    Words { view, component, accessor: root.push(accessor(view, 0, elements, None)) }
}
