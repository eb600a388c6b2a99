//! What light does at surfaces beyond color, metal and roughness, by extensions that are used and never required.
//!
//! Every number is written, also where it is the format's default, so that a pointer of an animation finds it. A thickness is
//! in the units of the meshes that wear it, which on a grid are its steps.
//!
//! Sources: Khronos Group, `KHR_materials_anisotropy`, `_clearcoat`, `_dispersion`, `_emissive_strength`, `_ior`,
//! `_iridescence`, `_sheen`, `_specular`, `_transmission`, `_unlit`, `_volume`, 2020 to 2024.

use gltf::json::{Root, extensions};
use serde_json::{Map, Value, json};

use super::material::Textures;
use crate::geometry::number::single;
use crate::motion::Property;
use crate::scene::{Scene, Texture};

/// What a thickness in metres is multiplied by in a material: one over the step of the grid, where meshes that wear it hang on
/// nodes that scale it back.
pub(super) fn thickness_unit(scene: &Scene, material: usize) -> f64 {
    let wears = |mesh: usize| scene.meshes[mesh].materials.contains(&Some(material));
    let hangs = |node: &crate::scene::Node| node.skin.is_none() && node.mesh.is_some_and(wears);
    scene.grid.filter(|_| scene.nodes.iter().any(hangs)).map_or(1.0, |grid| 1.0 / grid.step)
}

/// Where a property of a material stands in its extensions, and what its numbers are multiplied by there.
pub(super) fn place(property: Property) -> Option<(&'static str, f64)> {
    Some(match property {
        Property::EmissiveStrength => ("KHR_materials_emissive_strength/emissiveStrength", 1.0),
        Property::Ior => ("KHR_materials_ior/ior", 1.0),
        Property::Dispersion => ("KHR_materials_dispersion/dispersion", 1.0),
        Property::Clearcoat => ("KHR_materials_clearcoat/clearcoatFactor", 1.0),
        Property::ClearcoatRoughness => ("KHR_materials_clearcoat/clearcoatRoughnessFactor", 1.0),
        Property::ClearcoatNormalScale => ("KHR_materials_clearcoat/clearcoatNormalTexture/scale", 1.0),
        Property::Transmission => ("KHR_materials_transmission/transmissionFactor", 1.0),
        Property::Thickness => ("KHR_materials_volume/thicknessFactor", 1.0),
        Property::AttenuationDistance => ("KHR_materials_volume/attenuationDistance", 1.0),
        Property::AttenuationColor => ("KHR_materials_volume/attenuationColor", 1.0),
        Property::Specular => ("KHR_materials_specular/specularFactor", 1.0),
        Property::SpecularColor => ("KHR_materials_specular/specularColorFactor", 1.0),
        Property::SheenColor => ("KHR_materials_sheen/sheenColorFactor", 1.0),
        Property::SheenRoughness => ("KHR_materials_sheen/sheenRoughnessFactor", 1.0),
        Property::Iridescence => ("KHR_materials_iridescence/iridescenceFactor", 1.0),
        Property::IridescenceIor => ("KHR_materials_iridescence/iridescenceIor", 1.0),
        Property::IridescenceThickness => ("KHR_materials_iridescence/iridescenceThicknessMaximum", 1.0),
        Property::Anisotropy => ("KHR_materials_anisotropy/anisotropyStrength", 1.0),
        Property::AnisotropyRotation => ("KHR_materials_anisotropy/anisotropyRotation", 1_f64.to_radians()),
        _ => return None,
    })
}

/// One extension under way: its numbers and textures.
struct Part<'t, 'i> {
    textures: &'t mut Textures<'i>,
    root: &'t mut Root,
    made: Map<String, Value>,
}

impl Part<'_, '_> {
    fn number(&mut self, key: &str, number: f64) -> &mut Self {
        self.made.insert(key.to_owned(), json!(single(number)));
        self
    }

    fn color(&mut self, key: &str, color: [f64; 3]) -> &mut Self {
        self.made.insert(key.to_owned(), json!(color.map(single)));
        self
    }

    fn texture(&mut self, key: &str, texture: Option<Texture>) -> &mut Self {
        if let Some(texture) = texture {
            let index = self.textures.texture(self.root, texture).value();
            self.made.insert(key.to_owned(), json!({ "index": index }));
        }
        self
    }
}

/// The extensions of a material of the scene; none where it has none.
pub(super) fn extensions(
    textures: &mut Textures<'_>,
    root: &mut Root,
    (scene, index): (&Scene, usize),
) -> Option<extensions::material::Material> {
    let mut others = Map::new();
    let optics = &scene.materials[index].optics;
    let mut add = |name: &str, fill: &dyn Fn(&mut Part<'_, '_>)| {
        let mut part = Part { textures: &mut *textures, root: &mut *root, made: Map::new() };
        fill(&mut part);
        others.insert(format!("KHR_materials_{name}"), Value::Object(part.made));
    };
    if let Some(own) = &optics.anisotropy {
        add("anisotropy", &|part| {
            part.number("anisotropyStrength", own.strength)
                .number("anisotropyRotation", own.rotation.to_radians())
                .texture("anisotropyTexture", own.texture);
        });
    }
    if let Some(own) = &optics.clearcoat {
        add("clearcoat", &|part| {
            part.number("clearcoatFactor", own.factor)
                .texture("clearcoatTexture", own.texture)
                .number("clearcoatRoughnessFactor", own.roughness)
                .texture("clearcoatRoughnessTexture", own.roughness_texture);
            if let Some((normal, scale)) = own.normal_texture {
                part.texture("clearcoatNormalTexture", Some(normal));
                part.made["clearcoatNormalTexture"]["scale"] = json!(single(scale));
            }
        });
    }
    if let Some(own) = optics.dispersion {
        add("dispersion", &|part| _ = part.number("dispersion", own));
    }
    if let Some(own) = optics.emissive_strength {
        add("emissive_strength", &|part| _ = part.number("emissiveStrength", own));
    }
    if let Some(own) = optics.ior {
        add("ior", &|part| _ = part.number("ior", own));
    }
    if let Some(own) = &optics.iridescence {
        add("iridescence", &|part| {
            part.number("iridescenceFactor", own.factor)
                .texture("iridescenceTexture", own.texture)
                .number("iridescenceIor", own.ior)
                .number("iridescenceThicknessMaximum", own.thickness);
            if let Some((texture, least)) = own.thickness_texture {
                part.number("iridescenceThicknessMinimum", least)
                    .texture("iridescenceThicknessTexture", Some(texture));
            }
        });
    }
    if let Some(own) = &optics.sheen {
        add("sheen", &|part| {
            part.color("sheenColorFactor", own.color)
                .texture("sheenColorTexture", own.color_texture)
                .number("sheenRoughnessFactor", own.roughness)
                .texture("sheenRoughnessTexture", own.roughness_texture);
        });
    }
    if let Some(own) = &optics.specular {
        add("specular", &|part| {
            part.number("specularFactor", own.factor)
                .texture("specularTexture", own.texture)
                .color("specularColorFactor", own.color)
                .texture("specularColorTexture", own.color_texture);
        });
    }
    if let Some(own) = &optics.transmission {
        add("transmission", &|part| {
            part.number("transmissionFactor", own.factor).texture("transmissionTexture", own.texture);
        });
    }
    if optics.unlit {
        add("unlit", &|_| {});
    }
    if let Some(own) = &optics.volume {
        let unit = thickness_unit(scene, index);
        add("volume", &|part| {
            part.number("thicknessFactor", own.thickness * unit)
                .texture("thicknessTexture", own.thickness_texture)
                .color("attenuationColor", own.attenuation_color);
            if let Some(way) = own.attenuation_distance {
                part.number("attenuationDistance", way);
            }
        });
    }
    (!others.is_empty()).then_some(extensions::material::Material { others })
}

/// Says which extensions materials use.
pub(super) fn name_used(root: &mut Root) {
    let mut names: Vec<String> = Vec::new();
    for material in &root.materials {
        let own = material.extensions.iter().flat_map(|own| own.others.keys());
        names.extend(own.cloned());
    }
    names.sort_unstable();
    names.dedup();
    root.extensions_used.extend(names);
}
