//! What a `.glb` file holds, for drawing: nodes, meshes, skins, materials with their pictures, clips.
//!
//! Promise: any file that is valid glTF 2.0 is read, its quantized and sparse accessors and what `EXT_meshopt_compression`
//! packs too, if it needs no other compression; a broken one is an error, never a panic. What cannot be drawn (points, pictures outside the file) is left out
//! and named in `notes`.
//! No promise: this is not the reader of the report, which reads what it measures bit by bit (`gltf::read`).

mod change;
mod level;
mod texture;

use glam::{DAffine2, DMat2, DVec2};

pub(super) use change::{changed, see};
use level::Shown;
pub use texture::{Texture, Wrap};

use crate::geometry::number::{floor_count, sin_cos, single};
use crate::import::gltf;
pub use crate::import::gltf::{
    Channel, Clip, GltfFault, Lens, Mesh, Node, Part, Place, Skin, Steps, Target, Track,
};

/// A file, read.
#[derive(Clone, Debug, Default)]
pub struct Asset {
    /// All nodes.
    pub nodes: Vec<Node>,
    /// Nodes of the scene that is shown.
    pub roots: Vec<usize>,
    /// All meshes.
    pub meshes: Vec<Mesh>,
    /// All skins.
    pub skins: Vec<Skin>,
    /// All materials; the last is the one of parts that name none.
    pub materials: Vec<Material>,
    /// All pictures with the way they are looked up.
    pub textures: Vec<Texture>,
    /// All clips.
    pub clips: Vec<Clip>,
    /// What was left out.
    pub notes: Vec<String>,
    /// Which level of detail each node shows, once one was chosen.
    pub(super) shown: Shown,
}

/// How a surface looks. Numbers and pictures are those of glTF.
#[derive(Clone, Debug)]
pub struct Material {
    /// Its name, may be empty.
    pub name: String,
    /// Linear color and opacity.
    pub color: [f32; 4],
    /// The picture that multiplies it.
    pub color_map: Option<Map>,
    /// 0 to 1.
    pub metallic: f32,
    /// 0 to 1.
    pub roughness: f32,
    /// Green is roughness, blue is metal.
    pub metallic_roughness_map: Option<Map>,
    /// Normals in the tangents' frame, with their scale.
    pub normal_map: Option<(Map, f32)>,
    /// Red is how much light from around arrives, with its strength.
    pub occlusion_map: Option<(Map, f32)>,
    /// Linear light that it sends out.
    pub emissive: [f32; 3],
    /// What that is multiplied by, and is already (`KHR_materials_emissive_strength`).
    pub emissive_strength: f32,
    /// The picture that multiplies it.
    pub emissive_map: Option<Map>,
    /// What opacity does.
    pub cutoff: Cutoff,
    /// Whether it shows its color without any light.
    pub unlit: bool,
    /// Whether its back is seen.
    pub double_sided: bool,
}

/// What opacity does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cutoff {
    /// Nothing.
    Opaque,
    /// Below this, nothing is there.
    Mask(f32),
    /// What lies behind shines through.
    Blend,
}

/// A picture as it lies on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Which texture.
    pub texture: usize,
    /// Which set of texture coordinates, 0 or 1.
    pub set: usize,
    /// What is done to them (`KHR_texture_transform`).
    pub place: DAffine2,
}

/// Reads a `.glb` file.
///
/// Cost: linear in its bytes and in the pixels of its pictures.
///
/// # Errors
/// See [`GltfFault`].
pub fn read(bytes: &[u8]) -> Result<Asset, GltfFault> {
    let file = gltf::open(bytes, &mut |_| None)?;
    let (data, document) = (file.data(), &file.document);
    let mut notes = Vec::new();
    let meshes: Result<Vec<Mesh>, GltfFault> =
        document.meshes().map(|mesh| gltf::mesh(&data, &mesh, &mut notes)).collect();
    let mut materials: Vec<Material> = document.materials().map(|own| material(&own)).collect();
    materials.push(Material::default());
    let mut asset = Asset {
        nodes: file.nodes(),
        roots: file.roots(),
        meshes: meshes?,
        skins: document.skins().map(|own| gltf::skin(&data, &own)).collect::<Result<_, _>>()?,
        materials,
        textures: texture::read(&data, &mut notes),
        clips: file.clips()?,
        notes,
        shown: Shown::default(),
    };
    asset.notes.extend(change::untold(&asset));
    check_levels(&asset)?;
    Ok(asset)
}

/// That coarser levels are nodes.
fn check_levels(asset: &Asset) -> Result<(), GltfFault> {
    let beyond = asset.nodes.iter().flat_map(|node| &node.levels).find(|level| **level >= asset.nodes.len());
    match beyond {
        Some(node) => Err(GltfFault::Document(format!("node {node}, a level of detail, does not exist"))),
        None => Ok(()),
    }
}

/// Where a picture lies, by what its extension says.
fn map(texture: usize, set: u32, extension: Option<&serde_json::Value>) -> Map {
    let pair = |name: &str, otherwise: f64| {
        let list = extension.and_then(|value| value.get(name)?.as_array());
        let at = |k: usize| list.and_then(|list| list.get(k)?.as_f64()).unwrap_or(otherwise);
        DVec2::new(at(0), at(1))
    };
    let number = |name: &str| extension.and_then(|value| value.get(name)?.as_f64());
    let (sine, cosine) = sin_cos(number("rotation").unwrap_or(0.0));
    // Texture coordinates go down: a turn goes clockwise in them.
    let turn = DMat2::from_cols(DVec2::new(cosine, -sine), DVec2::new(sine, cosine));
    let place =
        DAffine2::from_mat2_translation(turn * DMat2::from_diagonal(pair("scale", 1.0)), pair("offset", 0.0));
    let own = number("texCoord").map_or(set, floor_count);
    Map { texture, set: if own == 1 { 1 } else { 0 }, place }
}

fn material(own: &::gltf::Material<'_>) -> Material {
    const TRANSFORM: &str = "KHR_texture_transform";
    let metal = own.pbr_metallic_roughness();
    let of = |info: ::gltf::texture::Info<'_>| {
        map(info.texture().index(), info.tex_coord(), info.extension_value(TRANSFORM))
    };
    let strength = own
        .extension_value("KHR_materials_emissive_strength")
        .and_then(|value| value.get("emissiveStrength")?.as_f64())
        .unwrap_or(1.0);
    Material {
        name: own.name().unwrap_or_default().to_owned(),
        color: metal.base_color_factor(),
        color_map: metal.base_color_texture().map(of),
        metallic: metal.metallic_factor(),
        roughness: metal.roughness_factor(),
        metallic_roughness_map: metal.metallic_roughness_texture().map(of),
        normal_map: own.normal_texture().map(|normal| {
            let place = normal.extension_value(TRANSFORM);
            (map(normal.texture().index(), normal.tex_coord(), place), normal.scale())
        }),
        occlusion_map: own.occlusion_texture().map(|light| {
            let place = light.extension_value(TRANSFORM);
            (map(light.texture().index(), light.tex_coord(), place), light.strength())
        }),
        emissive: own.emissive_factor().map(|part| part * single(strength)),
        emissive_strength: single(strength),
        emissive_map: own.emissive_texture().map(of),
        cutoff: match own.alpha_mode() {
            ::gltf::material::AlphaMode::Opaque => Cutoff::Opaque,
            ::gltf::material::AlphaMode::Mask => Cutoff::Mask(own.alpha_cutoff().unwrap_or(0.5)),
            ::gltf::material::AlphaMode::Blend => Cutoff::Blend,
        },
        unlit: own.extension_value("KHR_materials_unlit").is_some(),
        double_sided: own.double_sided(),
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            color: [1.0; 4],
            color_map: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_map: None,
            normal_map: None,
            occlusion_map: None,
            emissive: [0.0; 3],
            emissive_strength: 1.0,
            emissive_map: None,
            cutoff: Cutoff::Opaque,
            unlit: false,
            double_sided: false,
        }
    }
}
