//! What an extension that is not known here may refer to, and what therefore stays as it is.
//!
//! Promise: every whole number that stands in such an extension, and every JSON pointer, is taken for an index of whatever
//! it can be: accessors and views keep their places and their bytes, meshes their vertices and units, nodes their meshes, and
//! lists that it may look into their order. An extension of a mesh, a primitive or a node holds that mesh. Extensions of materials,
//! textures and pictures are taken to look at such things alone. What stands in `extras` is no reference.

use std::collections::BTreeSet;

use serde_json::Value;

use super::document::{Object, as_index, list, whole};
use super::{copies, thickness};
use crate::packing::POINTER;

/// Extensions that refer to nothing, or whose references are followed here.
const KNOWN: [&str; 15] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    POINTER,
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp_json_ld",
    "MSFT_lod",
];

/// Whether an extension is known.
pub(super) fn is_known(name: &str) -> bool {
    KNOWN.contains(&name) || name.starts_with("KHR_materials_")
}

/// What stays as it is.
#[derive(Debug, Default)]
pub(super) struct Pins {
    /// Accessors that keep their places and bytes.
    pub(super) accessors: BTreeSet<usize>,
    /// Views that keep their places and bytes.
    pub(super) views: BTreeSet<usize>,
    /// Meshes that keep their vertices and units.
    pub(super) meshes: BTreeSet<usize>,
    /// Lists whose members keep their places.
    lists: BTreeSet<&'static str>,
    /// Names of the extensions.
    pub(super) unknown: BTreeSet<String>,
}

/// Lists of pictures and what wears them.
const LOOKS: [&str; 4] = ["images", "materials", "samplers", "textures"];

impl Pins {
    /// Whether members of a list may be referred to by their places.
    pub(super) fn holds(&self, name: &str) -> bool {
        self.lists.contains(name)
    }

    fn walk(&mut self, root: &Object, value: &Value, looks: bool) {
        match value {
            Value::Object(own) => {
                for (name, inner) in own {
                    if name == "extensions" {
                        self.extensions(root, inner, looks);
                    } else if name != "extras" {
                        self.walk(root, inner, looks);
                    }
                }
            }
            Value::Array(all) => all.iter().for_each(|inner| self.walk(root, inner, looks)),
            _ => {}
        }
    }

    fn extensions(&mut self, root: &Object, value: &Value, looks: bool) {
        for (name, inner) in value.as_object().into_iter().flatten() {
            if name == POINTER {
                self.property(root, inner);
            } else if is_known(name) {
                // Extensions stand in extensions, too.
                self.walk(root, inner, looks);
            } else {
                self.unknown.insert(name.clone());
                self.refer(root, inner, (looks, false));
            }
        }
    }

    /// A property in change is looked for by its place in lists; nodes, lights and cameras keep theirs in any case. A thickness is
    /// one in the units of the meshes that wear the material.
    fn property(&mut self, root: &Object, value: &Value) {
        let pointer = value["pointer"].as_str().unwrap_or_default();
        if let Some(material) = thickness::pointed(pointer) {
            let wears = |mesh: &Value| super::primitives(mesh).any(|own| thickness::wears(own, material));
            let meshes = list(root, "meshes").iter().enumerate().filter(|(_, mesh)| wears(mesh));
            self.meshes.extend(meshes.map(|(index, _)| index));
        }
        let list = pointer.split('/').nth(1);
        self.lists.extend(LOOKS.into_iter().chain(["meshes"]).find(|known| Some(*known) == list));
    }

    /// Takes every number in a value for an index; `of_view` where its name says that it is one of a view.
    fn refer(&mut self, root: &Object, value: &Value, (looks, of_view): (bool, bool)) {
        match value {
            Value::Object(own) => {
                for (name, inner) in own {
                    self.refer(root, inner, (looks, name.to_lowercase().contains("bufferview")));
                }
            }
            Value::Array(all) => all.iter().for_each(|inner| self.refer(root, inner, (looks, of_view))),
            Value::String(text) => self.pointer(root, text),
            _ => {
                let Some(index) = as_index(value) else { return };
                for name in LOOKS {
                    self.hold(root, name, index);
                }
                if !looks || of_view {
                    self.hold(root, "bufferViews", index);
                }
                if !looks {
                    ["accessors", "meshes", "nodes", "skins"]
                        .into_iter()
                        .for_each(|name| self.hold(root, name, index));
                }
            }
        }
    }

    fn pointer(&mut self, root: &Object, text: &str) {
        let mut parts = text.split('/').skip(1);
        if let (Some(name), Some(index)) = (parts.next(), parts.next().and_then(|part| part.parse().ok())) {
            self.hold(root, name, index);
        }
    }

    fn hold(&mut self, root: &Object, name: &str, index: usize) {
        let all = list(root, name);
        let Some(member) = all.get(index) else { return };
        match name {
            "accessors" => {
                self.accessors.insert(index);
            }
            "bufferViews" => {
                self.views.insert(index);
            }
            "meshes" => {
                self.meshes.insert(index);
                self.lists.insert("meshes");
            }
            "nodes" => self.meshes.extend(whole(member, "mesh")),
            "skins" => {
                let carried = list(root, "nodes").iter().filter(|node| whole(node, "skin") == Some(index));
                self.meshes.extend(carried.filter_map(|node| whole(node, "mesh")));
            }
            _ => self.lists.extend(LOOKS.into_iter().find(|known| *known == name)),
        }
    }
}

fn has_unknown(value: &Value) -> bool {
    let own = value.get("extensions").and_then(Value::as_object);
    own.into_iter().flatten().any(|(name, _)| !is_known(name))
}

/// Finds what stays. Linear in the JSON, times the nodes for each number of an unknown extension that is an index of a skin.
pub(super) fn pins(root: &Object) -> Pins {
    let mut pins = Pins::default();
    for (name, value) in root {
        if name == "extensions" {
            pins.extensions(root, value, false);
        } else if name != "extras" {
            pins.walk(root, value, LOOKS.contains(&name.as_str()) || name == "cameras");
        }
    }
    for (index, mesh) in list(root, "meshes").iter().enumerate() {
        if has_unknown(mesh) || super::primitives(mesh).any(has_unknown) {
            pins.meshes.insert(index);
        }
    }
    for node in list(root, "nodes") {
        // A body is as thick as its node is large, whatever its copies are.
        let thick = |mesh: usize| {
            super::primitives(&list(root, "meshes")[mesh]).any(|own| thickness::has_volume(root, own))
        };
        let copies =
            copies::has_some(node) && (node.get("skin").is_some() || whole(node, "mesh").is_some_and(thick));
        if copies || has_unknown(node) {
            pins.meshes.extend(whole(node, "mesh"));
        }
        let bound = whole(node, "skin").map(|skin| &list(root, "skins")[skin]);
        if bound.is_some_and(has_unknown) {
            pins.meshes.extend(whole(node, "mesh"));
        }
    }
    // What a view or an accessor is beyond the specification is not known.
    let told =
        |name| list(root, name).iter().enumerate().filter(|(_, own)| has_unknown(own)).map(|(at, _)| at);
    pins.views.extend(told("bufferViews"));
    pins.accessors.extend(told("accessors"));
    loop {
        let before = (pins.meshes.len(), pins.accessors.len());
        for (index, mesh) in list(root, "meshes").iter().enumerate() {
            // What shares numbers with a mesh that stays, stays with it.
            let own: Vec<usize> = super::primitives(mesh).flat_map(super::accessors_of).collect();
            if pins.meshes.contains(&index) || own.iter().any(|accessor| pins.accessors.contains(accessor)) {
                pins.meshes.insert(index);
                pins.accessors.extend(own);
            }
        }
        if before == (pins.meshes.len(), pins.accessors.len()) {
            return pins;
        }
    }
}
