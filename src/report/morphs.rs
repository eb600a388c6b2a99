//! States of shapes as they stand in the file.

use glam::DVec3;
use indexmap::IndexMap;
use serde::Serialize;

use super::{DeviationFacts, Extent};
use crate::geometry::number::{Bounds, single_rounding};
use crate::gltf::{Read, ReadError, WrittenGeometry};

/// What is known of a state of a shape: measured on its morph target.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MorphFacts {
    /// Its weight where no clip moves it.
    pub weight: f64,
    /// Vertices that it moves.
    pub moved: usize,
    /// How far the furthest of them goes, metres.
    pub furthest: f64,
    /// The box of all vertices at weight 1, metres.
    pub bounds: Extent,
    /// Distance from the exact state.
    pub deviation: DeviationFacts,
}

/// The states of a shape.
///
/// # Errors
/// When the bytes cannot be read back.
pub(super) fn morphs(
    file: &Read<'_>,
    known: &WrittenGeometry,
) -> Result<IndexMap<String, MorphFacts>, ReadError> {
    if known.targets.is_empty() {
        return Ok(IndexMap::new());
    }
    let geometry = &file.geometries[known.mesh()];
    let place = |vertex: usize| glam::Vec3::from_array(geometry.position(vertex)).as_dvec3();
    let targets = file.targets(known.mesh())?;
    let facts = targets.into_iter().zip(&known.targets).map(|(target, known)| {
        let at = |(vertex, moved): (usize, &DVec3)| place(vertex) + *moved;
        let bounds = Bounds::of_points(target.positions.iter().enumerate().map(at));
        let moved = target.positions.iter().filter(|moved| **moved != DVec3::ZERO).count();
        let furthest = target.positions.iter().map(|moved| moved.length()).fold(0.0, f64::max);
        // The place at weight 0 is rounded, and the way from there.
        let rounding = single_rounding(bounds.reach() + furthest) + single_rounding(furthest);
        let facts = MorphFacts {
            weight: target.weight,
            moved,
            furthest,
            bounds: Extent { min: bounds.min.to_array(), max: bounds.max.to_array() },
            deviation: DeviationFacts {
                tolerance: known.tolerance,
                bound: known.deviation.bound + rounding,
                kind: known.deviation.evidence.into(),
                measured: None,
            },
        };
        (target.name, facts)
    });
    Ok(facts.collect())
}
