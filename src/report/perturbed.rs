//! How the surface of perturbed patches was made.

use indexmap::IndexMap;
use serde::Serialize;

use crate::model::{Model, Recipe};

/// Perturbed patches of a shape.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct PerturbedFacts {
    /// "surface": each ray through a face meets it once, which was proved. "solid": the body below it, since a ray may meet
    /// it more than once.
    pub made: &'static str,
    /// How many faces.
    pub faces: usize,
    /// Whether every side belongs to two faces.
    pub closed: bool,
}

/// All perturbed patches by the names of their shapes.
pub(super) fn perturbed(model: &Model) -> IndexMap<String, PerturbedFacts> {
    let facts = model.shapes.iter().filter_map(|shape| match &shape.recipe {
        Recipe::Perturbed(skin) => {
            let made = if skin.is_solid() { "solid" } else { "surface" };
            let facts = PerturbedFacts { made, faces: skin.face_count(), closed: skin.is_closed() };
            Some((shape.name.clone(), facts))
        }
        _ => None,
    });
    facts.collect()
}
