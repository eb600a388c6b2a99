//! Properties of materials, lights and cameras in change, by `KHR_animation_pointer`, which is used and never required.
//!
//! The channels of that extension name no node, which the document types cannot say: they are put in where the document
//! becomes text.
//!
//! Source: Khronos Group, `KHR_animation_pointer`, 2024.

use gltf::json::animation::{Channel, Sampler};
use gltf::json::{Animation, Index, Root};
use serde::Serialize;
use serde_json::{Value, json};

use super::optics;
use crate::motion::Property;
use crate::packing::POINTER;
use crate::scene::{Node, Owner, PropertyChannel, Scene};

/// A channel that points at a property.
pub(super) struct Pointer {
    /// The animation of the file.
    pub(super) animation: usize,
    pub(super) sampler: Index<Sampler>,
    /// The JSON pointer.
    pub(super) path: String,
}

/// The properties of a file that a channel changes, each with what its numbers are multiplied by there.
pub(super) fn targets(scene: &Scene, channel: &PropertyChannel) -> Vec<(String, f64)> {
    let (place, material) = match channel.owner {
        Owner::Material(material) => (0, format!("/materials/{material}")),
        Owner::Node(node) => (node, String::new()),
    };
    // Lights and cameras stand in the file in the order of their nodes.
    let before = |has: fn(&Node) -> bool| scene.nodes[..place].iter().filter(|node| has(node)).count();
    let light =
        || format!("/extensions/{}/lights/{}", super::view::LIGHTS, before(|node| node.light.is_some()));
    let camera = || format!("/cameras/{}", before(|node| node.camera.is_some()));
    let one = |path: String| vec![(path, 1.0)];
    if let (Some((key, factor)), Owner::Material(index)) = (optics::place(channel.property), channel.owner) {
        let of_meshes = channel.property == Property::Thickness;
        let unit = if of_meshes { optics::thickness_unit(scene, index) } else { 1.0 };
        return vec![(format!("{material}/extensions/{key}"), factor * unit)];
    }
    match channel.property {
        Property::Color => one(format!("{material}/pbrMetallicRoughness/baseColorFactor")),
        Property::Metallic => one(format!("{material}/pbrMetallicRoughness/metallicFactor")),
        Property::Roughness => one(format!("{material}/pbrMetallicRoughness/roughnessFactor")),
        Property::Emissive => one(format!("{material}/emissiveFactor")),
        Property::NormalScale => one(format!("{material}/normalTexture/scale")),
        Property::OcclusionStrength => one(format!("{material}/occlusionTexture/strength")),
        Property::AlphaCutoff => one(format!("{material}/alphaCutoff")),
        Property::LightColor => one(format!("{}/color", light())),
        Property::Intensity => one(format!("{}/intensity", light())),
        Property::Range => one(format!("{}/range", light())),
        Property::FieldOfView => vec![(format!("{}/perspective/yfov", camera()), 1_f64.to_radians())],
        Property::Height => {
            let aspect = scene.nodes[place].camera.map_or(1.0, |camera| camera.aspect);
            let lens = format!("{}/orthographic", camera());
            vec![(format!("{lens}/xmag"), aspect / 2.0), (format!("{lens}/ymag"), 0.5)]
        }
        // Those stand in extensions of materials.
        _ => Vec::new(),
    }
}

/// An animation with channels that name no node.
#[derive(Serialize)]
struct Pointing<'a> {
    channels: Vec<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extras: &'a gltf::json::Extras,
    #[serde(skip_serializing_if = "Option::is_none")]
    name: &'a Option<String>,
    samplers: &'a [Sampler],
}

/// A document with such animations in place of its own.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    root: &'a Root,
    animations: Vec<Pointing<'a>>,
}

/// The text of a document with channels that point at properties.
///
/// # Errors
/// None: no map of a document has other keys than text.
pub(super) fn document(root: &mut Root, pointers: &[Pointer]) -> serde_json::Result<Vec<u8>> {
    if pointers.is_empty() {
        return serde_json::to_vec(root);
    }
    root.extensions_used.push(POINTER.to_owned());
    let own = std::mem::take(&mut root.animations);
    let animations: serde_json::Result<Vec<Pointing<'_>>> =
        own.iter().enumerate().map(|animation| pointing(animation, pointers)).collect();
    serde_json::to_vec(&Document { root, animations: animations? })
}

fn pointing<'a>(
    (index, own): (usize, &'a Animation),
    pointers: &[Pointer],
) -> serde_json::Result<Pointing<'a>> {
    let plain: serde_json::Result<Vec<Value>> =
        own.channels.iter().map(|channel: &Channel| serde_json::to_value(channel)).collect();
    let mut channels = plain?;
    channels.extend(pointers.iter().filter(|pointer| pointer.animation == index).map(|pointer| {
        let told = json!({ (POINTER): { "pointer": pointer.path } });
        json!({ "sampler": pointer.sampler.value(), "target": { "path": "pointer", "extensions": told } })
    }));
    Ok(Pointing { channels, extras: &own.extras, name: &own.name, samplers: &own.samplers })
}
