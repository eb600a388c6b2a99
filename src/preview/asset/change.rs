//! Materials and cameras at a moment of a clip that changes them (`KHR_animation_pointer`).

use std::collections::BTreeSet;

use super::{Asset, Clip, Cutoff, Lens, Material, Node};
use crate::geometry::number::single;

/// The materials at a time of a clip, in seconds.
pub(in crate::preview) fn changed(asset: &Asset, clip: &Clip, time: f64) -> Vec<Material> {
    let mut materials = asset.materials.clone();
    for channel in &clip.properties {
        let numbers: Vec<f32> = channel.at(time).into_iter().map(single).collect();
        if let Some((material, part)) = of_material(&channel.pointer)
            && let Some(own) = materials.get_mut(material)
        {
            put(own, part, &numbers);
        }
    }
    materials
}

/// The cameras of nodes at a time of a clip, in seconds.
pub(in crate::preview) fn see(clip: &Clip, time: f64, nodes: &mut [Node]) {
    for channel in &clip.properties {
        let place = channel.pointer.strip_prefix("/cameras/").and_then(|place| place.split_once('/'));
        let Some((number, part)) = place else { continue };
        let Ok(number) = number.parse::<usize>() else { continue };
        let Some(&value) = channel.at(time).first() else { continue };
        let own = nodes.iter_mut().filter_map(|node| node.camera.as_mut());
        for (_, lens) in own.filter(|(camera, _): &&mut (usize, Lens)| *camera == number) {
            match (lens, part) {
                (Lens::Perspective { upright, .. }, "perspective/yfov") => *upright = value,
                (Lens::Perspective { near, .. }, "perspective/znear")
                | (Lens::Orthographic { near, .. }, "orthographic/znear") => *near = value,
                (Lens::Perspective { far, .. }, "perspective/zfar") => *far = Some(value),
                (Lens::Orthographic { far, .. }, "orthographic/zfar") => *far = value,
                (Lens::Orthographic { half, .. }, "orthographic/ymag") => *half = value,
                _ => {}
            }
        }
    }
}

/// What the file changes and no drawing shows, each once.
pub(super) fn untold(asset: &Asset) -> Vec<String> {
    let all = asset.clips.iter().flat_map(|clip| &clip.properties);
    let unknown = all.filter(|channel| {
        let numbers: Vec<f32> = channel.at(0.0).into_iter().map(single).collect();
        let known = of_material(&channel.pointer).and_then(|(material, part)| {
            let mut own = asset.materials.get(material)?.clone();
            put(&mut own, part, &numbers)
        });
        // Lights of a file are not drawn in any case; cameras are looked through.
        let unseen = ["/cameras/", "/extensions/KHR_lights_punctual/"];
        known.is_none() && !unseen.iter().any(|place| channel.pointer.starts_with(place))
    });
    let names: BTreeSet<&str> = unknown.map(|channel| channel.pointer.as_str()).collect();
    names.into_iter().map(|name| format!("what `{name}` changes over time is not drawn")).collect()
}

/// The material that a pointer looks into, and where there.
fn of_material(pointer: &str) -> Option<(usize, &str)> {
    let (material, part) = pointer.strip_prefix("/materials/")?.split_once('/')?;
    Some((material.parse().ok()?, part))
}

/// Puts numbers in the place of a material's own; none where it has no such part, or as many numbers.
fn put(own: &mut Material, part: &str, numbers: &[f32]) -> Option<()> {
    let one = || if let [one] = numbers { Some(*one) } else { None };
    let three = || <[f32; 3]>::try_from(numbers).ok();
    match part {
        "pbrMetallicRoughness/baseColorFactor" => own.color = numbers.try_into().ok()?,
        "pbrMetallicRoughness/metallicFactor" => own.metallic = one()?,
        "pbrMetallicRoughness/roughnessFactor" => own.roughness = one()?,
        "emissiveFactor" => own.emissive = three()?.map(|part| part * own.emissive_strength),
        "normalTexture/scale" => own.normal_map.as_mut()?.1 = one()?,
        "occlusionTexture/strength" => own.occlusion_map.as_mut()?.1 = one()?,
        "extensions/KHR_materials_emissive_strength/emissiveStrength" => {
            let (before, now) = (own.emissive_strength, one()?);
            let factor = if before > 0.0 { now / before } else { 0.0 };
            own.emissive = own.emissive.map(|part| part * factor);
            own.emissive_strength = now;
        }
        "alphaCutoff" => match &mut own.cutoff {
            Cutoff::Mask(cutoff) => *cutoff = one()?,
            _ => return None,
        },
        _ => return None,
    }
    Some(())
}
