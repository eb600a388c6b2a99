//! Colliders: numbers in extras, extensions, or meshes with names that engines know.
//!
//! Source: Open Metaverse Interoperability Group, `OMI_physics_shape` and `OMI_physics_body`, 2024.

use std::collections::BTreeMap;

use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked as Valid;
use gltf::json::{Mesh, Root, extensions};
use serde_json::{Map, Value, json};

use super::buffer::{Binary, index_accessors};
use super::position::positions;
use crate::geometry::number::single;
use crate::scene::{Body, Collider, ColliderForm, Scene};

const SHAPE: &str = "OMI_physics_shape";
const BODY: &str = "OMI_physics_body";

/// What a node of the file says and shows of colliders.
#[derive(Default)]
pub(super) struct Told {
    pub(super) extensions: Map<String, Value>,
    pub(super) extras: Option<Value>,
    pub(super) mesh: Option<usize>,
}

/// Writes the meshes of colliders and their shapes; for each node of the scene what it says of them.
pub(super) fn write(root: &mut Root, binary: &mut Binary, scene: &Scene) -> Vec<Told> {
    let mut told: Vec<Told> = scene.nodes.iter().map(|_| Told::default()).collect();
    let mut shapes = Vec::new();
    for collider in &scene.colliders {
        let holder = collider.holder.unwrap_or(collider.node);
        let told = &mut told[holder];
        match scene.collider_form {
            ColliderForm::Extras => {
                let list = told.extras.get_or_insert_with(|| json!([]));
                list.as_array_mut().into_iter().for_each(|list| list.push(numbers(collider)));
            }
            ColliderForm::Omi => {
                let mesh = matches!(collider.body, Body::Hull { .. }).then(|| mesh(root, binary, collider));
                told.extensions.insert(BODY.to_owned(), json!({ "collider": { "shape": shapes.len() } }));
                shapes.push(shape(&collider.body, mesh));
            }
            ColliderForm::Godot | ColliderForm::Unreal => told.mesh = Some(mesh(root, binary, collider)),
        }
    }
    if !shapes.is_empty() {
        let others = Map::from_iter([(SHAPE.to_owned(), json!({ "shapes": shapes }))]);
        root.extensions = Some(extensions::root::Root { others });
        root.extensions_used.extend([SHAPE, BODY].map(str::to_owned));
    }
    told
}

/// A collider as extras say it.
fn numbers(collider: &Collider) -> Value {
    let mut told = json!({ "name": collider.name, "shape": collider.body.kind() });
    let mut say = |key: &str, value: Value| told[key] = value;
    if let Some(part) = &collider.part {
        say("part-of", json!(part.of));
    }
    say("translation", json!(collider.translation.as_vec3().to_array()));
    say("rotation", json!(collider.rotation.as_quat().to_array()));
    match &collider.body {
        Body::Box { size } => say("size", json!(size.as_vec3().to_array())),
        Body::Sphere { radius } => say("radius", json!(single(*radius))),
        Body::Capsule { radius, height } | Body::Cylinder { radius, height } => {
            say("radius", json!(single(*radius)));
            say("height", json!(single(*height)));
        }
        Body::Hull { points, triangles } => {
            let places: Vec<[f32; 3]> = points.iter().map(|point| point.as_vec3().to_array()).collect();
            say("points", json!(places));
            say("indices", json!(triangles.as_flattened()));
        }
    }
    told
}

/// A body as the extension says it.
fn shape(body: &Body, mesh: Option<usize>) -> Value {
    match body {
        Body::Box { size } => json!({ "type": "box", "box": { "size": size.as_vec3().to_array() } }),
        Body::Sphere { radius } => json!({ "type": "sphere", "sphere": { "radius": single(*radius) } }),
        Body::Capsule { radius, height } => {
            let radius = single(*radius);
            let sizes = json!({ "height": single(*height), "radiusBottom": radius, "radiusTop": radius });
            json!({ "type": "capsule", "capsule": sizes })
        }
        Body::Cylinder { radius, height } => {
            let radius = single(*radius);
            let sizes = json!({ "height": single(*height), "radiusBottom": radius, "radiusTop": radius });
            json!({ "type": "cylinder", "cylinder": sizes })
        }
        Body::Hull { .. } => json!({ "type": "convex", "convex": { "mesh": mesh } }),
    }
}

/// Writes the triangles of a body, in floats whatever the profile: no node takes them to metres.
fn mesh(root: &mut Root, binary: &mut Binary, collider: &Collider) -> usize {
    let (points, triangles) = collider.body.triangles();
    let position = positions(root, binary, None, points.iter().copied());
    let all = triangles.as_flattened().iter().copied();
    let count = std::iter::once(3 * triangles.len());
    let indices = index_accessors(root, binary, all, (points.len(), false), count);
    let primitive = Primitive {
        attributes: BTreeMap::from([(Valid::Valid(Semantic::Positions), position)]),
        extensions: None,
        extras: None,
        indices: indices.first().copied(),
        material: None,
        mode: Valid::Valid(Mode::Triangles),
        targets: None,
    };
    let mesh = Mesh {
        extensions: None,
        extras: None,
        name: Some(collider.name.clone()),
        primitives: vec![primitive],
        weights: None,
    };
    root.push(mesh).value()
}
