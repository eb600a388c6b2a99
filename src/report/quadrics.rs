//! What surface the equation of a quadric makes.

use indexmap::IndexMap;
use serde::Serialize;

use crate::model::{Model, Recipe};

/// A quadric: the exact surface before its placement, in the document's unit and axes.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct QuadricFacts {
    /// What it is: "ellipsoid", "hyperboloid of one sheet" and so on.
    pub surface: &'static str,
    /// Its center, vertex, apex, or a point of its axis.
    pub origin: [f64; 3],
    /// The directions of its axes: of an ellipsoid the longest first, otherwise the axis that it turns about last.
    pub axes: [[f64; 3]; 3],
    /// Half lengths along the axes where it has a center; the ratios of a cone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half: Option<[f64; 3]>,
}

/// All quadrics by the names of their shapes.
pub(super) fn quadrics(model: &Model) -> IndexMap<String, QuadricFacts> {
    let facts = model.shapes.iter().filter_map(|shape| match &shape.recipe {
        Recipe::Quadric(quadric) => {
            let form = quadric.form();
            let facts = QuadricFacts {
                surface: form.kind.text(),
                origin: form.origin.to_array(),
                axes: form.axes.to_cols_array_2d(),
                half: form.kind.has_center().then(|| form.half.to_array()),
            };
            Some((shape.name.clone(), facts))
        }
        _ => None,
    });
    facts.collect()
}
