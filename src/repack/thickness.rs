//! How thick bodies below surfaces are (`KHR_materials_volume`), in the units of meshes on a grid.
//!
//! Promise: a body is as thick as before. The extension counts in the units of the mesh that wears a material, which on a grid
//! are its steps: a material that meshes of several grids wear becomes one for each. A mesh keeps its units where an animation
//! changes the thickness of what it wears (see [`pins`](super::pin::pins)).
//!
//! Source: Khronos Group, `KHR_materials_volume`, 2021 (the thickness is one of the mesh's coordinates).

use serde_json::{Value, json};

use super::document::{Object, as_index, list, list_mut, whole};
use super::grid::MeshPlace;
use super::number_of;

/// The extension.
const VOLUME: &str = "KHR_materials_volume";

/// Where a pointer names the thickness of a material: its index.
pub(super) fn pointed(pointer: &str) -> Option<usize> {
    let rest = pointer.strip_prefix("/materials/")?.strip_suffix("/thicknessFactor")?;
    rest.strip_suffix(VOLUME)?.strip_suffix("/extensions/")?.parse().ok()
}

/// Every material that a primitive wears, in its variants too.
pub(super) fn worn(primitive: &mut Value) -> Vec<&mut Value> {
    let Some(own) = primitive.as_object_mut() else { return Vec::new() };
    let mut all = Vec::new();
    for (name, value) in own {
        if name == "material" {
            all.push(value);
        } else if name == "extensions" {
            let mappings = value.get_mut("KHR_materials_variants").and_then(|own| own.get_mut("mappings"));
            let mappings = mappings.and_then(Value::as_array_mut).into_iter().flatten();
            all.extend(mappings.filter_map(|mapping| mapping.get_mut("material")));
        }
    }
    all
}

/// Whether a primitive wears a material.
pub(super) fn wears(primitive: &Value, material: usize) -> bool {
    worn(&mut primitive.clone()).into_iter().any(|own| as_index(own) == Some(material))
}

/// Whether a primitive wears, in one of its variants, a material that has a volume.
pub(super) fn has_volume(root: &Object, primitive: &Value) -> bool {
    let thick = |material: &Value| material["extensions"].get(VOLUME).is_some();
    list(root, "materials").iter().enumerate().any(|(index, own)| thick(own) && wears(primitive, index))
}

/// Counts thicknesses in the steps of the grids. Linear in the primitives, times the materials with a volume.
pub(super) fn scale(made: &mut Object, places: &[MeshPlace]) {
    let thickness = |material: &Value| material["extensions"][VOLUME]["thicknessFactor"].as_f64();
    let thick: Vec<f64> = list(made, "materials").iter().map(|own| thickness(own).unwrap_or(0.0)).collect();
    if thick.iter().all(|own| *own == 0.0) {
        return;
    }
    let mut hangs = vec![false; places.len()];
    for node in list(made, "nodes").iter().filter(|node| node.get("skin").is_none()) {
        whole(node, "mesh").into_iter().for_each(|mesh| hangs[mesh] = true);
    }
    // A material, the bits of a step, and the material that has its thickness in such steps.
    let mut known: Vec<(usize, u32, usize)> = Vec::new();
    let mut count = thick.len();
    for (index, mesh) in list_mut(made, "meshes").iter_mut().enumerate() {
        let grid = places[index].grid.filter(|_| hangs[index]);
        let step = grid.map_or(1.0, |grid| grid.step).to_bits();
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut).into_iter().flatten();
        for material in primitives.flat_map(worn) {
            let Some(own) = as_index(material).filter(|own| thick.get(*own).is_some_and(|own| *own != 0.0))
            else {
                continue;
            };
            let alike = known.iter().find(|(other, of, _)| (*other, *of) == (own, step));
            let place = alike.map(|(.., place)| *place).unwrap_or_else(|| {
                let first = known.iter().all(|(other, ..)| *other != own);
                let place = if first { own } else { count };
                count = count.max(place + 1);
                known.push((own, step, place));
                place
            });
            *material = json!(place);
        }
    }
    let Some(materials) = made.get_mut("materials").and_then(Value::as_array_mut) else { return };
    let plain = materials.clone();
    for (own, step, place) in known {
        let mut material = plain[own].clone();
        let scaled = thick[own] / f64::from(f32::from_bits(step));
        material["extensions"][VOLUME]["thicknessFactor"] = number_of(scaled);
        if place < plain.len() {
            materials[place] = material;
        } else {
            materials.push(material);
        }
    }
}
