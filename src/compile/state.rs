//! States of shapes: the models that they need, and what is said of those that cannot be made.

use super::{Options, place};
use crate::build::{self, Built, StateModel};
use crate::language::Document;
use crate::language::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::language::source::{Files, Span};
use crate::language::spec::Spec;
use crate::model::{Recipe, ShapeHandle};
use crate::realize::RealizeError;
use crate::scene;

/// Builds the model of a document, with those that its states need.
pub(super) fn model(
    document: &Document,
    spec: &Spec,
    files: &dyn Files,
    options: &Options,
) -> Result<Built, Diagnostics> {
    let mut states: Vec<StateModel> = Vec::new();
    let morphs = spec.morphs.values().flat_map(|definition| definition.value.values());
    for with in morphs.map(|morph| &morph.with).filter(|with| !with.is_empty()) {
        if states.iter().any(|state| state.with == *with) {
            continue;
        }
        let state = document.state(options.variant.as_deref(), &options.overrides, with)?;
        let built = build::state(&state, &options.name, files).map_err(|list| document.diagnostics(list))?;
        states.push(StateModel { with: with.clone(), built });
    }
    build::model(spec, &options.name, files, states).map_err(|list| document.diagnostics(list))
}

/// Where a state of a shape is defined; the shape where there is no such.
fn place_of(built: &Built, shape: ShapeHandle, state: &str) -> Span {
    let named = |morph: &crate::model::Morph| morph.shape == shape && morph.name == state;
    let index = built.model.morphs.iter().position(named);
    index.and_then(|index| built.morph_places.get(index).copied()).unwrap_or_else(|| place(built, shape))
}

/// The diagnostic for a shape whose states cannot be made; none for other errors.
pub(super) fn refused(built: &Built, shape: ShapeHandle, error: &RealizeError) -> Option<Diagnostic> {
    let name = &built.model.shape(shape).name;
    Some(match error {
        RealizeError::MorphedWire => {
            Diagnostic::error(Code::BadMorph, format!("shape `{name}` cannot morph: {error}"))
                .at(place(built, shape), "this shape")
                .help("draw a thin profile along its curves with `sweep`")
        }
        RealizeError::Topology { state, .. } => {
            Diagnostic::error(Code::MorphTopology, format!("shape `{name}` cannot morph so: {error}"))
                .at(place_of(built, shape, state), "this state")
                .also(place(built, shape), "this shape")
                .note("surfaces over parameters correspond where they have as many parts; polygons where they are the same; heights, whole ellipsoids and perturbed patches along their rays; all else only where the triangles are")
                .help(way_out(&built.model.shape(shape).recipe))
        }
        RealizeError::State { state, error } => {
            let code = if matches!(**error, RealizeError::Limit { .. } | RealizeError::Together { .. }) {
                Code::LimitPassed
            } else {
                Code::BadMorph
            };
            Diagnostic::error(code, format!("state `{state}` of shape `{name}` cannot be made: {error}"))
                .at(place_of(built, shape, state), "this state")
                .also(place(built, shape), "this shape")
                .help("let the shape be possible with the values of the state, or write others")
        }
        _ => return None,
    })
}

/// What to write in place of states that have other triangles.
fn way_out(recipe: &Recipe) -> &'static str {
    match recipe {
        Recipe::Implicit { .. } => {
            "a field's surface is cut anew wherever it goes: move one surface by the joints of a skin, or write the states as cages of `subdivide`, as `perturbed` patches or by parameters"
        }
        Recipe::Solid(_) => {
            "edges lie where the bodies of a solid meet, which each state has elsewhere: let nodes or joints move its parts, or let the bodies morph one by one, each shown by a node of its own"
        }
        Recipe::Quadric(quadric) if quadric.within.is_some() => {
            "the rim of a quadric that is cut off has other points in each state: write the part as `revolve`, `parametric` or a patch, whose points keep their parameters"
        }
        _ => {
            "change no number of parts, corners or copies, or write the same `segments` or `levels` for both"
        }
    }
}

/// States whose bound could not be brought under their tolerance.
pub(super) fn beyond_tolerance(
    scene: &scene::Scene,
    shapes: &[ShapeHandle],
    built: &Built,
) -> Vec<Diagnostic> {
    let of = |(geometry, shape): (&scene::Geometry, &ShapeHandle)| {
        let beyond = |target: &scene::MorphTarget| {
            let (tolerance, bound) = (target.tolerance?, target.deviation.bound);
            (bound > tolerance * (1.0 + 1e-9)).then(|| {
                let message = format!(
                    "state `{}` of shape `{}` lies up to {bound:.3e} m from its true surface, more than its tolerance of {tolerance:.3e} m",
                    target.name, geometry.name
                );
                Diagnostic::warning(Code::TightBend, message)
                    .at(place_of(built, *shape, &target.name), "this state")
                    .note("all states have the same triangles, which were made finer several times")
                    .help("write a state that is less far from the shape, or a coarser `tolerance`")
            })
        };
        geometry.targets.iter().filter_map(beyond).collect::<Vec<_>>()
    };
    scene.geometries.iter().zip(shapes).flat_map(of).collect()
}
