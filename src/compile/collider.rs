//! Colliders: how they stand in files, and what is said of those that cannot be.

use crate::build::Built;
use crate::geometry::solid::SolidFault;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::realize::RealizeError;
use crate::scene::{Body, ColliderForm, ColliderPart, Node, Scene};

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
            copy: false,
            instances: Vec::new(),
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
    let (RealizeError::FlatCollider { collider } | RealizeError::ColliderParts { collider, .. }) = error
    else {
        return None;
    };
    let own = &built.model.colliders[*collider];
    let shape = &built.model.shape(own.shape).name;
    let (code, message, help) = match error {
        RealizeError::ColliderParts { fault: SolidFault::Missing, .. } => (
            Code::MissingFeature,
            format!("collider `{}` cannot be made of parts: {error}", own.name),
            "build Kiln with `features = [\"csg\"]`",
        ),
        RealizeError::ColliderParts { .. } => (
            Code::NoParts,
            format!("collider `{}` cannot be made of parts: shape `{shape}` {error}", own.name),
            "name a shape that is closed, such as one with caps, or write `fit = \"hull\"`",
        ),
        _ => (
            Code::FlatCollider,
            format!("collider `{}` has no volume: all points of shape `{shape}` lie on one plane", own.name),
            "name a shape that has some depth, such as a thin box",
        ),
    };
    Some(Diagnostic::error(code, message).at(place(built, *collider), "this collider").help(help))
}

fn place(built: &Built, collider: usize) -> Span {
    built.collider_places.get(collider).copied().unwrap_or(Span::NONE)
}

/// Colliders with parts that are less convex than was asked for.
pub(super) fn rough(built: &Built, scene: &Scene) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (index, own) in built.model.colliders.iter().enumerate() {
        let of = |part: &&ColliderPart| part.of == own.name || part.of.starts_with(&format!("{}.", own.name));
        let parts: Vec<&ColliderPart> =
            scene.colliders.iter().filter_map(|body| body.part.as_ref()).filter(of).collect();
        let worst = parts.iter().max_by(|a, b| a.concavity.total_cmp(&b.concavity));
        let Some(worst) = worst.filter(|worst| worst.concavity > worst.allowed) else { continue };
        let message = format!(
            "collider `{}` fills hollows of its shape {:.2e} m deep, more than the {:.2e} m that `concavity` allows, since it has no more than {} parts",
            own.name, worst.concavity, worst.allowed, own.parts
        );
        found.push(
            Diagnostic::warning(Code::RoughParts, message)
                .at(place(built, index), "this collider")
                .help("write more `parts`, or the `concavity` that is enough"),
        );
    }
    found
}
