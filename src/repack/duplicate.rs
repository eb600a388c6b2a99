//! What is said twice is said once: samplers, pictures, textures, materials and meshes that agree in everything, also in
//! their names. Lists that an unknown extension may look into keep their members.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::document::{Object, as_index, list, list_mut};
use super::pin::{Pins, is_known};
use super::thickness::worn;

/// Merges what is equal, from what is referred to up to what refers. Linear in the JSON.
pub(super) fn merge(made: &mut Object, pins: &Pins) {
    let texture_keys = ["EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu"];
    let places = unique(made, "samplers", pins);
    for texture in list_mut(made, "textures") {
        rename(texture.get_mut("sampler"), &places);
    }
    let places = unique(made, "images", pins);
    for texture in list_mut(made, "textures") {
        rename(texture.get_mut("source"), &places);
        for name in texture_keys {
            rename(
                texture.get_mut("extensions").and_then(|own| own.get_mut(name)?.get_mut("source")),
                &places,
            );
        }
    }
    let places = unique(made, "textures", pins);
    list_mut(made, "materials").iter_mut().for_each(|material| textures(material, &places));
    let places = unique(made, "materials", pins);
    for mesh in list_mut(made, "meshes") {
        for primitive in mesh.get_mut("primitives").and_then(Value::as_array_mut).into_iter().flatten() {
            worn(primitive).into_iter().for_each(|material| rename(Some(material), &places));
        }
    }
    for material in list_mut(made, "materials") {
        let coarser = material.get_mut("extensions").and_then(|own| own.get_mut("MSFT_lod")?.get_mut("ids"));
        let coarser = coarser.and_then(Value::as_array_mut).into_iter().flatten();
        coarser.for_each(|material| rename(Some(material), &places));
    }
    let places = unique(made, "meshes", pins);
    list_mut(made, "nodes").iter_mut().for_each(|node| rename(node.get_mut("mesh"), &places));
}

fn rename(index: Option<&mut Value>, places: &[usize]) {
    if let Some(index) = index
        && let Some(place) = as_index(index).and_then(|index| places.get(index))
    {
        *index = json!(place);
    }
}

/// Every texture that a material names, in its extensions too.
fn textures(value: &mut Value, places: &[usize]) {
    for (name, inner) in value.as_object_mut().into_iter().flatten() {
        if name.ends_with("Texture") {
            rename(inner.get_mut("index"), places);
        } else if name == "extensions" {
            let own = inner.as_object_mut().into_iter().flatten();
            own.filter(|(name, _)| is_known(name)).for_each(|(_, inner)| textures(inner, places));
        } else if name != "extras" {
            textures(inner, places);
        }
    }
}

/// Leaves out members that are equal to one before; gives for each of the old places the new one.
fn unique(made: &mut Object, name: &str, pins: &Pins) -> Vec<usize> {
    // Only looked up, never walked.
    let mut known: HashMap<String, usize> = HashMap::new();
    let stays = pins.holds(name);
    let mut kept = Vec::new();
    let mut places = Vec::new();
    for member in list(made, name) {
        let next = kept.len();
        let place = *known.entry(member.to_string()).or_insert(next);
        places.push(place);
        if place == next || stays {
            kept.push(member.clone());
        }
    }
    if !kept.is_empty() {
        made.insert(name.to_owned(), Value::Array(kept));
    }
    places
}
