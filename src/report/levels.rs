//! Levels of detail: what each is good for, and what it costs.

use indexmap::IndexMap;
use serde::Serialize;

use super::ShapeFacts;
use crate::gltf::{Read, Written};
use crate::scene::LevelSource;

/// A level of detail of a mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct LevelFacts {
    /// Its number; 0 is the finest.
    pub level: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// What it was made from.
    pub source: LevelOrigin,
    /// Its triangles.
    pub triangles: u64,
    /// Segments of its lines.
    #[serde(skip_serializing_if = "super::is_zero")]
    pub segments: u64,
    /// No point of it is further from the exact shape, metres, in any of its states.
    pub error: f64,
    /// It differs from the exact shape by no more than a pixel of 1920 by 1080 while the disk around its box covers no more
    /// than this part of the picture.
    pub coverage: f64,
    /// Bytes of its vertices and indices in the file.
    pub bytes: u64,
}

/// What a level of detail was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LevelOrigin {
    /// It is what the document describes.
    Finest,
    /// The surfaces, cut more coarsely.
    Surface,
    /// The triangles of the level before.
    Triangles,
}

/// The levels of each mesh that has some, by the name of the finest.
pub(super) fn levels(
    file: &Read<'_>,
    written: &Written,
    shapes: &IndexMap<String, ShapeFacts>,
) -> IndexMap<String, Vec<LevelFacts>> {
    let name = |mesh: usize| file.root.meshes[mesh].name.clone().unwrap_or_default();
    let facts = |level: &crate::gltf::WrittenLevel| {
        let (own, geometry) = (&level.level, &written.geometries[level.geometry]);
        let read = &file.geometries[own.mesh];
        LevelFacts {
            level: own.number,
            mesh: name(own.mesh),
            source: match own.source {
                LevelSource::Finest => LevelOrigin::Finest,
                LevelSource::Surface => LevelOrigin::Surface,
                LevelSource::Triangles => LevelOrigin::Triangles,
            },
            triangles: read.indices.len() as u64 / 3,
            segments: read.lines.segments.len() as u64,
            error: shapes.get(&geometry.name).map_or(0.0, worst),
            coverage: own.coverage,
            bytes: geometry.bytes,
        }
    };
    let of = |levels: &Vec<crate::gltf::WrittenLevel>| {
        let finest = levels.first()?;
        Some((name(finest.level.mesh), levels.iter().map(facts).collect()))
    };
    written.levels.iter().filter_map(of).collect()
}

/// The distance from the exact shape that is held at rest and in every state.
fn worst(shape: &ShapeFacts) -> f64 {
    let states = shape.morphs.values().map(|state| state.deviation.bound);
    states.fold(shape.deviation.bound, f64::max)
}

/// Whether a geometry is a level that lost triangles.
pub(super) fn is_thinned(written: &Written, geometry: usize) -> bool {
    let thinned = |level: &crate::gltf::WrittenLevel| {
        level.geometry == geometry && level.level.source == LevelSource::Triangles
    };
    written.levels.iter().flatten().any(thinned)
}
