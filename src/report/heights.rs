//! How many polygons a map of heights stands for.
//!
//! The count is that of S. Vyatkin and B. Dolgovesov, "Modeling and rendering of freeforms by scalar perturbation
//! functions": three corners for each triangle, set against one number for each sample. A dense mesh of a bilinear map has
//! two triangles for each cell, and so nearly six; a spline through every l-th sample of each row and column that stays as
//! near stands for six times the square of l.

use indexmap::IndexMap;
use serde::Serialize;

use crate::geometry::map::{GridField, Interpolation};
use crate::gltf::{Indices, Read, Written};
use crate::model::{Model, Recipe, ShapeHandle};

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
    /// Bytes of positions, normals and indices in the file.
    pub mesh_bytes: u64,
    /// Bytes of the mesh for each byte of the samples.
    pub byte_ratio: f64,
}

/// All height maps that are shown, by the names of their shapes.
pub(super) fn heights(
    file: &Read<'_>,
    written: &Written,
    model: &Model,
    shapes: &[ShapeHandle],
) -> IndexMap<String, HeightFacts> {
    let facts = written.geometries.iter().zip(shapes).filter_map(|(known, handle)| {
        let field: &GridField = match &model.shape(*handle).recipe {
            Recipe::Height(map) => &map.field,
            Recipe::Based(map) => &map.heights().field,
            _ => return None,
        };
        let geometry = &file.geometries[known.mesh];
        let (triangles, each) = match &geometry.indices {
            Indices::Short(indices) => (indices.len() as u64 / 3, 2),
            Indices::Long(indices) => (indices.len() as u64 / 3, 4),
        };
        let (columns, rows) = (field.columns() as u64, field.rows() as u64);
        let samples = columns * rows;
        let mesh_bytes = geometry.positions.len() as u64 * 24 + 3 * triangles * each;
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
        Some((known.name.clone(), facts))
    });
    facts.collect()
}
