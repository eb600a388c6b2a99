//! Colliders: how they stand in files, and what is said of those that cannot be.

use crate::build::Built;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::realize::RealizeError;
use crate::scene::{Body, ColliderForm, Node, Scene};

/// Gives the colliders of a scene their form, and nodes of their own where that asks for them.
pub(super) fn hold(scene: &mut Scene, form: spec::ColliderForm) {
    scene.collider_form = match form {
        spec::ColliderForm::Extras => return,
        spec::ColliderForm::Omi => ColliderForm::Omi,
        spec::ColliderForm::Godot => ColliderForm::Godot,
        spec::ColliderForm::Unreal => ColliderForm::Unreal,
    };
    for index in 0..scene.colliders.len() {
        let collider = &scene.colliders[index];
        let earlier = scene.colliders[..index].iter().filter(|other| other.node == collider.node).count();
        let name = match scene.collider_form {
            ColliderForm::Godot => format!("{}-convcolonly", collider.name),
            ColliderForm::Unreal => {
                let kind = match collider.body {
                    Body::Box { .. } => "UBX",
                    Body::Sphere { .. } => "USP",
                    Body::Capsule { .. } => "UCP",
                    Body::Cylinder { .. } | Body::Hull { .. } => "UCX",
                };
                format!("{kind}_{}_{earlier:02}", scene.nodes[collider.node].name)
            }
            ColliderForm::Extras | ColliderForm::Omi => collider.name.clone(),
        };
        let taken = scene.nodes.iter().any(|node| node.name == name);
        let node = Node {
            name: if taken { format!("{name}.collider") } else { name },
            mesh: None,
            skin: None,
            socket: false,
            camera: None,
            light: None,
            parent: Some(collider.node),
            translation: collider.translation,
            rotation: collider.rotation,
            scale: glam::DVec3::ONE,
        };
        scene.colliders[index].holder = Some(scene.nodes.len());
        scene.nodes.push(node);
    }
}

/// A collider that cannot be, told at its place.
pub(super) fn refused(built: &Built, error: &RealizeError) -> Option<Diagnostic> {
    let RealizeError::FlatCollider { collider } = error else { return None };
    let own = &built.model.colliders[*collider];
    let place = built.collider_places.get(*collider).copied().unwrap_or(Span::NONE);
    let message = format!(
        "collider `{}` has no volume: all points of shape `{}` lie on one plane",
        own.name,
        built.model.shape(own.shape).name
    );
    Some(
        Diagnostic::error(Code::FlatCollider, message)
            .at(place, "this collider")
            .help("name a shape that has some depth, such as a thin box"),
    )
}
