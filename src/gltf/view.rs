//! Cameras, and lights by `KHR_lights_punctual`, which is used and never required.

use gltf::json::Root;
use gltf::json::camera::{Camera, Orthographic, Perspective, Type};
use gltf::json::validation::Checked as Valid;
use serde_json::{Value, json};

use crate::geometry::number::single;
use crate::scene::{self, Lens, Light, LightKind, Scene};

/// The extension of lights.
pub(super) const LIGHTS: &str = "KHR_lights_punctual";

/// A camera of a node.
pub(super) fn camera(name: &str, camera: &scene::Camera) -> Camera {
    let (near, far) = (single(camera.near), camera.far.map(single));
    let (perspective, orthographic) = match camera.lens {
        Lens::Perspective { upright } => {
            let aspect = Some(single(camera.aspect));
            let yfov = single(upright.to_radians());
            let seen = Perspective {
                aspect_ratio: aspect,
                yfov,
                zfar: far,
                znear: near,
                extensions: None,
                extras: None,
            };
            (Some(seen), None)
        }
        Lens::Parallel { height } => {
            // Half of what it sees.
            let (xmag, ymag) = (single(height * camera.aspect / 2.0), single(height / 2.0));
            let zfar = far.unwrap_or(f32::MAX);
            (None, Some(Orthographic { xmag, ymag, zfar, znear: near, extensions: None, extras: None }))
        }
    };
    Camera {
        name: Some(name.to_owned()),
        type_: Valid::Valid(if perspective.is_some() { Type::Perspective } else { Type::Orthographic }),
        perspective,
        orthographic,
        extensions: None,
        extras: None,
    }
}

/// Writes the lights; for each node what names its own.
pub(super) fn lights(root: &mut Root, scene: &Scene) -> Vec<Option<Value>> {
    let mut all = Vec::new();
    let mut take = |node: &scene::Node| {
        all.push(light(&node.name, &node.light?));
        Some(json!({ "light": all.len() - 1 }))
    };
    let named = scene.nodes.iter().map(&mut take).collect();
    if !all.is_empty() {
        root.extensions_used.push(LIGHTS.to_owned());
        let others = &mut root.extensions.get_or_insert_default().others;
        others.insert(LIGHTS.to_owned(), json!({ "lights": all }));
    }
    named
}

fn light(name: &str, light: &Light) -> Value {
    let mut made = json!({
        "name": name,
        "type": match light.kind {
            LightKind::Point => "point",
            LightKind::Sun => "directional",
            LightKind::Spot { .. } => "spot",
        },
        "color": light.color.map(single),
        "intensity": single(light.intensity),
    });
    if let LightKind::Spot { inner, outer } = light.kind {
        let [inner, outer] = [inner, outer].map(|degrees| single(degrees.to_radians()));
        made["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
    }
    if let Some(range) = light.range {
        made["range"] = json!(single(range));
    }
    made
}
