//! Models as a picture of the surfaces themselves wants them: cut as finely as the picture can show, but for surfaces that
//! are found in space and drawn as fields.

use super::Built;
use crate::geometry::field::Sheet;
use crate::geometry::tessellate::Deviation;
use crate::model::{Limits, Model, Recipe, ShapeHandle};
use crate::realize;
use crate::scene::Scene;
use glam::DAffine3;

/// Most triangles and vertices of a picture, and bytes for them.
const LIMITS: Limits = Limits { triangles: 1 << 23, vertices: 1 << 23, memory: 1 << 32 };

/// How the surface of a mesh is known.
#[derive(Clone, Debug)]
pub struct Source {
    /// The shape.
    pub shape: String,
    /// The surfaces as those of fields, each with the map to the space of the mesh.
    pub sheets: Option<Vec<(Sheet, DAffine3)>>,
    /// How far the mesh is from the surface, in its own space, metres.
    pub deviation: Deviation,
}

/// Cuts the surfaces that are shown to within so many metres, whatever the document says, but for those that are found in
/// space.
pub(super) fn refine(built: &mut Built, tolerance: f64) {
    let model = &mut built.model;
    refine_model(model, tolerance / model.frame.unit);
    model.colliders.clear();
    model.attributes.clear();
    for state in &mut model.states {
        refine_model(state, tolerance / state.frame.unit);
    }
}

fn refine_model(model: &mut Model, tolerance: f64) {
    model.limits = LIMITS;
    let shown: Vec<ShapeHandle> = {
        let mut shown: Vec<ShapeHandle> = model.nodes.iter().filter_map(|node| node.shape).collect();
        shown.extend(model.morphs.iter().map(|morph| morph.shape));
        shown.sort();
        shown.dedup();
        shown
    };
    let moved = |handle: ShapeHandle| {
        model.skins.iter().any(|skin| skin.shape == handle) || model.morphs_of(handle).next().is_some()
    };
    // To cut fields finely takes long, and they are drawn without it.
    let known = |handle: ShapeHandle| holds_field(model, handle) && realize::sheets(model, handle).is_some();
    let cut: Vec<ShapeHandle> =
        shown.into_iter().filter(|handle| moved(*handle) || !known(*handle)).collect();
    // Parts take the tolerance of the whole, under its maps; cages are what the document says they are.
    let (mut parts, mut cages) = (Vec::new(), Vec::new());
    let mut open = cut.clone();
    while let Some(handle) = open.pop() {
        let inner: Vec<ShapeHandle> = match &model.shape(handle).recipe {
            Recipe::Assembly(of) => of.iter().map(|(part, _)| *part).collect(),
            Recipe::Deformed { of, .. } => vec![*of],
            Recipe::Displaced(recipe) => vec![recipe.of],
            Recipe::Solid(solid) => solid.parts.clone(),
            Recipe::Subdivided(recipe) => {
                cages.push((recipe.cage, model.shape(handle).options.tolerance));
                Vec::new()
            }
            Recipe::Implicit { shapes, .. } => {
                cages.extend(shapes.iter().map(|part| (*part, None)));
                Vec::new()
            }
            _ => Vec::new(),
        };
        for part in inner {
            if !parts.contains(&part) {
                parts.push(part);
                open.push(part);
            }
        }
    }
    let written = model.tolerance;
    for (cage, own) in cages {
        let options = &mut model.shapes[cage.0 as usize].options;
        options.tolerance = options.tolerance.or(own).or(written);
    }
    for part in parts {
        loosen(model, part, None);
    }
    for shape in cut {
        loosen(model, shape, Some(tolerance));
    }
}

/// Whether a part of a shape is found in space.
fn holds_field(model: &Model, handle: ShapeHandle) -> bool {
    match &model.shape(handle).recipe {
        Recipe::Implicit { .. } => true,
        Recipe::Perturbed(skin) => skin.is_solid(),
        Recipe::Assembly(parts) => parts.iter().any(|(part, _)| holds_field(model, *part)),
        Recipe::Solid(solid) => solid.parts.iter().any(|part| holds_field(model, *part)),
        _ => false,
    }
}

fn loosen(model: &mut Model, handle: ShapeHandle, tolerance: Option<f64>) {
    let shape = &mut model.shapes[handle.0 as usize];
    shape.options.tolerance = tolerance;
    shape.options.density = None;
    shape.options.lightmap = None;
    if let Recipe::Geodesic(ball) = &mut shape.recipe {
        ball.frequency = None;
    }
}

/// How the surface of each mesh of a scene is known; `shapes` are those of its geometries.
pub(super) fn sources(built: &Built, scene: &Scene, shapes: &[ShapeHandle]) -> Vec<Source> {
    let of = |mesh: &crate::scene::MeshUse| {
        let (geometry, handle) = (&scene.geometries[mesh.geometry], shapes[mesh.geometry]);
        Source {
            shape: geometry.name.clone(),
            // Where triangles are the shape, nothing is nearer to it; lines have no other form.
            sheets: (geometry.deviation != Deviation::NONE && geometry.wire.points.is_empty())
                .then(|| realize::sheets(&built.model, handle))
                .flatten(),
            deviation: geometry.deviation,
        }
    };
    scene.meshes.iter().map(of).collect()
}
