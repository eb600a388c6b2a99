//! How the surfaces of a network join.

use indexmap::IndexMap;
use serde::Serialize;

use crate::geometry::surface::{AnySurface, PatchContinuity, Rim, SurfaceJoint, SurfaceLine, joints};
use crate::model::{Model, Recipe};

/// The exact surfaces of a shape of several, before its placement, in the document's unit and axes.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NetworkFacts {
    /// How many surfaces.
    pub surfaces: usize,
    /// How many joints there are of each class, from "G0" to "C2".
    pub continuity: IndexMap<String, usize>,
    /// All joints: inside surfaces where pieces meet, then between sides.
    pub joints: Vec<NetworkJoint>,
    /// How many sides meet no other.
    pub open_sides: usize,
    /// How many sides are one point.
    pub collapsed_sides: usize,
}

/// A line along which two surfaces meet, or two pieces of one.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NetworkJoint {
    /// The lines on both sides of it.
    pub between: [NetworkLine; 2],
    /// The best that holds all along: "G0" (one line), "C0" (with equal parameters), "G1" (one tangent plane), "C1" or "C2"
    /// (equal derivatives).
    pub continuity: String,
    /// The greatest angle between the tangent planes, degrees.
    pub angle: f64,
    /// Where that is.
    pub at: [f64; 3],
}

/// A line of a surface: a side, or where u or v has a value.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct NetworkLine {
    /// Which surface, from 0.
    pub surface: usize,
    /// Of a side its name: "u-start", "u-end", "v-start", "v-end".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<&'static str>,
    /// Of a line inside its u.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u: Option<f64>,
    /// Or its v.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub v: Option<f64>,
}

/// All networks by the names of their shapes.
pub(super) fn networks(model: &Model) -> IndexMap<String, NetworkFacts> {
    let facts = model.shapes.iter().filter_map(|shape| match &shape.recipe {
        Recipe::Patches { patches, .. } => {
            let facts = network(&patches.surfaces);
            // A surface of one piece that meets nothing, not even itself, is no network.
            let many = facts.surfaces > 1 || !facts.joints.is_empty();
            many.then(|| (shape.name.clone(), facts))
        }
        _ => None,
    });
    facts.collect()
}

fn network(surfaces: &[AnySurface]) -> NetworkFacts {
    let found = joints(surfaces);
    let of = |class: PatchContinuity| {
        found.joints.iter().filter(|joint| joint.smoothness.continuity == class).count()
    };
    NetworkFacts {
        surfaces: surfaces.len(),
        continuity: PatchContinuity::ALL.into_iter().map(|class| (class.to_string(), of(class))).collect(),
        joints: found.joints.iter().map(joint).collect(),
        open_sides: found.open.len(),
        collapsed_sides: found.collapsed.len(),
    }
}

fn joint(joint: &SurfaceJoint) -> NetworkJoint {
    let found = &joint.smoothness;
    NetworkJoint {
        between: joint.lines.map(line),
        continuity: found.continuity.to_string(),
        angle: found.angle,
        at: found.place.to_array(),
    }
}

fn line((surface, line): (usize, SurfaceLine)) -> NetworkLine {
    let none = NetworkLine { surface, side: None, u: None, v: None };
    match line {
        SurfaceLine::Rim(side) => NetworkLine { side: Some(name(side)), ..none },
        SurfaceLine::U(u) => NetworkLine { u: Some(u), ..none },
        SurfaceLine::V(v) => NetworkLine { v: Some(v), ..none },
    }
}

fn name(side: Rim) -> &'static str {
    match side {
        Rim::Bottom => "v-start",
        Rim::Top => "v-end",
        Rim::Left => "u-start",
        Rim::Right => "u-end",
    }
}
