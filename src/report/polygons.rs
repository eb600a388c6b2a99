//! Properties of the polygons that a shape was made from.

use crate::geometry::mesh::polygon_facts::{PolygonFacts, measure};
use crate::model::{Model, Recipe, ShapeHandle};

/// The properties of a shape's own polygons; `None` for shapes that are not made of polygons.
pub(super) fn polygon_facts(model: &Model, handle: ShapeHandle) -> Option<PolygonFacts> {
    match &model.shape(handle).recipe {
        Recipe::Polygons { mesh, .. } => Some(measure(mesh)),
        Recipe::Assembly(parts) => match parts.as_slice() {
            [(part, _)] => polygon_facts(model, *part),
            _ => None,
        },
        _ => None,
    }
}
