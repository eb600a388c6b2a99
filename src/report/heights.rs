//! How many polygons a map of heights stands for.
//!
//! The count is that of S. Vyatkin and B. Dolgovesov, "Modeling and rendering of freeforms by scalar perturbation
//! functions": three corners for each triangle, set against one number for each sample. A dense mesh of a bilinear map has
//! two triangles for each cell, and so nearly six; a spline through every l-th sample of each row and column that stays as
//! near stands for six times the square of l.

use std::collections::BTreeSet;

use gltf::json::Root;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;
use indexmap::IndexMap;
use serde::Serialize;

use crate::geometry::map::{GridField, Interpolation};
use crate::gltf::{Read, Written};
use crate::model::{Model, Recipe, ShapeHandle};
use crate::packing::{UnpackError, stored_lengths};

/// A map of heights beside the triangles that were written for it.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct HeightFacts {
    /// "bilinear" or "bicubic".
    pub interpolation: &'static str,
    /// Numbers in the map; its seam counts once more.
    pub samples: u64,
    /// Corners of the triangles of the written shape.
    pub corners: u64,
    /// Corners for each sample.
    pub ratio: f64,
    /// Corners of two triangles for each cell, for each sample: what the map would take without a tolerance.
    pub dense_ratio: f64,
    /// Bytes of the samples as numbers of 32 bits.
    pub data_bytes: u64,
    /// Bytes of positions, normals and indices in the file, as they stand there.
    pub mesh_bytes: u64,
    /// Bytes of the mesh for each byte of the samples.
    pub byte_ratio: f64,
}

/// All height maps that are shown, by the names of their shapes.
///
/// # Errors
/// When the bytes are no document; they were read before.
pub(super) fn heights(
    file: &Read<'_>,
    written: &Written,
    model: &Model,
    shapes: &[ShapeHandle],
) -> Result<IndexMap<String, HeightFacts>, UnpackError> {
    let mut lengths = None;
    let mut all = IndexMap::new();
    for (known, handle) in written.geometries.iter().zip(shapes) {
        let field: &GridField = match &model.shape(*handle).recipe {
            Recipe::Height(map) => &map.field,
            Recipe::Based(map) => &map.heights().field,
            _ => continue,
        };
        let lengths = match &mut lengths {
            Some(lengths) => lengths,
            none => none.insert(stored_lengths(&written.bytes)?),
        };
        let mesh_bytes = mesh_bytes(&file.root, known.mesh(), lengths);
        let triangles = file.geometries[known.mesh()].indices.len() as u64 / 3;
        let (columns, rows) = (field.columns() as u64, field.rows() as u64);
        let samples = columns * rows;
        let per_sample = |count: u64| count as f64 / samples as f64;
        let facts = HeightFacts {
            interpolation: match field.interpolation() {
                Interpolation::Bilinear => "bilinear",
                Interpolation::Bicubic => "bicubic",
            },
            samples,
            corners: 3 * triangles,
            ratio: per_sample(3 * triangles),
            dense_ratio: per_sample(6 * (columns - 1) * (rows - 1)),
            data_bytes: 4 * samples,
            mesh_bytes,
            byte_ratio: per_sample(mesh_bytes) / 4.0,
        };
        all.insert(known.name.clone(), facts);
    }
    Ok(all)
}

/// Bytes of the file that the positions, normals and indices of a mesh take. Accessors that share a view share its bytes.
fn mesh_bytes(root: &Root, mesh: usize, lengths: &[u64]) -> u64 {
    let of_primitive = |primitive: &Primitive| {
        let counted = [Semantic::Positions, Semantic::Normals].map(Checked::Valid);
        let attributes = counted.iter().filter_map(|semantic| primitive.attributes.get(semantic).copied());
        attributes.chain(primitive.indices).collect::<Vec<_>>()
    };
    let accessors = root.meshes[mesh].primitives.iter().flat_map(of_primitive);
    let views: BTreeSet<usize> = accessors
        .filter_map(|accessor| root.accessors[accessor.value()].buffer_view)
        .map(|view| view.value())
        .collect();
    views.into_iter().filter_map(|view| lengths.get(view)).sum()
}
