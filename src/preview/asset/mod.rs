//! What a `.glb` file holds, for drawing: nodes, meshes, skins, materials with their pictures, clips.
//!
//! Promise: any file that is valid glTF 2.0 is read, its quantized and sparse accessors and what `EXT_meshopt_compression`
//! packs too, if it needs no other compression; a broken one is an error, never a panic. What cannot be drawn (points, pictures outside the file) is left out
//! and named in `notes`.
//! No promise: this is not the reader of the report, which reads what it measures bit by bit (`gltf::read`).

mod accessor;
mod clip;
mod level;
mod mesh;
mod texture;

use glam::{DAffine2, DMat2, DMat4, DQuat, DVec2, DVec3};
use gltf::json::validation::Validate as _;
use thiserror::Error;

use accessor::Data;
pub use clip::{Channel, Clip, Steps, Track};
pub use mesh::{Mesh, Part, Target};
pub use texture::{Texture, Wrap};

use crate::geometry::number::{floor_count, sin_cos, single};
use crate::packing::{UnpackError, unpacked};

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
}

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    /// Its name, may be empty.
    pub name: String,
    /// Its children.
    pub children: Vec<usize>,
    /// Where it stands in its parent.
    pub place: Place,
    /// Its mesh.
    pub mesh: Option<usize>,
    /// Its skin.
    pub skin: Option<usize>,
    /// Weights of the targets of its mesh; those of the mesh where empty.
    pub weights: Vec<f64>,
    /// Nodes that stand for it at coarser levels of detail (`MSFT_lod`).
    pub levels: Vec<usize>,
}

/// Where a node stands in its parent.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// By a matrix; clips do not move it.
    Matrix(DMat4),
    /// Scaled, then turned, then moved.
    Parts {
        /// The move.
        translation: DVec3,
        /// The turn, of length 1.
        rotation: DQuat,
        /// The scale.
        scale: DVec3,
    },
}

impl Place {
    /// As a matrix.
    #[must_use]
    pub fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

/// Joints that move a mesh.
#[derive(Clone, Debug)]
pub struct Skin {
    /// Nodes.
    pub joints: Vec<usize>,
    /// For each joint the way back from where it stands at rest.
    pub inverse: Vec<DMat4>,
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

/// Why a file cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum AssetError {
    /// Not a `.glb` file, or cut off.
    #[error("it is not a whole .glb file: {0}")]
    Container(String),
    /// Not a valid document.
    #[error("it is not a valid glTF document: {0}")]
    Document(String),
    /// Its compressed data is broken.
    #[error(transparent)]
    Packed(#[from] UnpackError),
    /// It needs what is not read here.
    #[error("it needs the extension {0}, which is not supported here")]
    Extension(String),
    /// A view reaches past the bytes of its buffer.
    #[error("buffer view {0} reaches past the end of the data")]
    View(usize),
    /// An accessor of the wrong kind, or without data.
    #[error("accessor {0} does not hold what it is used for")]
    Accessor(usize),
    /// An index of a mesh reaches past its vertices.
    #[error("mesh {0} uses vertex {1}, which does not exist")]
    Vertex(usize, u32),
    /// Nodes that contain themselves, or have two parents.
    #[error("node {0} stands in two places")]
    Tree(usize),
}

/// Extensions that a file may need.
const KNOWN: [&str; 3] = ["KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform"];

/// Reads a `.glb` file.
///
/// Cost: linear in its bytes and in the pixels of its pictures.
///
/// # Errors
/// See [`AssetError`].
pub fn read(bytes: &[u8]) -> Result<Asset, AssetError> {
    let bytes = unpacked(bytes)?;
    let container =
        gltf::Glb::from_slice(&bytes).map_err(|error| AssetError::Container(error.to_string()))?;
    let mut root: gltf::json::Root =
        serde_json::from_slice(&container.json).map_err(|error| AssetError::Document(error.to_string()))?;
    if let Some(unknown) = root.extensions_required.iter().find(|name| !KNOWN.contains(&name.as_str())) {
        return Err(AssetError::Extension(unknown.clone()));
    }
    root.extensions_required.clear();
    // The library's own check takes these for granted.
    check_references(&root)?;
    let mut fault = None;
    root.validate(&root, gltf::json::Path::new, &mut |path, error| {
        fault.get_or_insert_with(|| format!("{}: {error}", path()));
    });
    if let Some(fault) = fault {
        return Err(AssetError::Document(fault));
    }
    let document = gltf::Document::from_json_without_validation(root);
    let binary: &[u8] = container.bin.as_deref().unwrap_or_default();
    let mut notes = Vec::new();
    let buffers = document.buffers().map(|buffer| match buffer.source() {
        gltf::buffer::Source::Bin => binary,
        gltf::buffer::Source::Uri(_) => &[],
    });
    let data = Data { buffers: buffers.collect(), document: &document };
    let meshes: Result<Vec<Mesh>, AssetError> =
        document.meshes().map(|mesh| mesh::read(&data, &mesh, &mut notes)).collect();
    let mut materials: Vec<Material> = document.materials().map(|own| material(&own)).collect();
    materials.push(Material::default());
    let asset = Asset {
        nodes: document.nodes().map(|own| node(&own)).collect(),
        roots: roots(&document),
        meshes: meshes?,
        skins: document.skins().map(|own| skin(&data, &own)).collect::<Result<_, _>>()?,
        materials,
        textures: texture::read(&data, &mut notes),
        clips: document.animations().map(|own| clip::read(&data, &own)).collect::<Result<_, _>>()?,
        notes,
    };
    check_tree(&asset)?;
    check_levels(&asset)?;
    Ok(asset)
}

/// That attributes name accessors that there are, and clips nodes.
fn check_references(root: &gltf::json::Root) -> Result<(), AssetError> {
    let missing = |what: String| Err(AssetError::Document(format!("{what} does not exist")));
    for (mesh, own) in root.meshes.iter().enumerate() {
        for accessor in own.primitives.iter().flat_map(|primitive| primitive.attributes.values()) {
            if accessor.value() >= root.accessors.len() {
                return missing(format!("accessor {} of mesh {mesh}", accessor.value()));
            }
        }
    }
    for (clip, own) in root.animations.iter().enumerate() {
        for target in own.channels.iter().map(|channel| &channel.target) {
            if target.node.value() >= root.nodes.len() {
                return missing(format!("node {} of animation {clip}", target.node.value()));
            }
            if target.path == gltf::json::validation::Checked::Invalid {
                return missing(format!("a path of animation {clip}"));
            }
        }
    }
    Ok(())
}

/// Nodes of the scene that is shown; without scenes, those that have no parent.
fn roots(document: &gltf::Document) -> Vec<usize> {
    let shown = document.default_scene().or_else(|| document.scenes().next());
    if let Some(scene) = shown {
        return scene.nodes().map(|node| node.index()).collect();
    }
    let mut free = vec![true; document.nodes().count()];
    document
        .nodes()
        .flat_map(|node| node.children().map(|child| child.index()).collect::<Vec<_>>())
        .for_each(|child| {
            free[child] = false;
        });
    (0..free.len()).filter(|node| free[*node]).collect()
}

/// That every node has one parent at most, and none is above itself.
fn check_tree(asset: &Asset) -> Result<(), AssetError> {
    let mut seen = vec![false; asset.nodes.len()];
    let mut open = asset.roots.clone();
    while let Some(node) = open.pop() {
        if std::mem::replace(&mut seen[node], true) {
            return Err(AssetError::Tree(node));
        }
        open.extend(&asset.nodes[node].children);
    }
    Ok(())
}

/// That coarser levels are nodes.
fn check_levels(asset: &Asset) -> Result<(), AssetError> {
    let beyond = asset.nodes.iter().flat_map(|node| &node.levels).find(|level| **level >= asset.nodes.len());
    match beyond {
        Some(node) => Err(AssetError::Document(format!("node {node}, a level of detail, does not exist"))),
        None => Ok(()),
    }
}

fn vector([x, y, z]: [f32; 3]) -> DVec3 {
    DVec3::new(x.into(), y.into(), z.into())
}

fn node(own: &gltf::Node<'_>) -> Node {
    let place = match own.transform() {
        gltf::scene::Transform::Matrix { matrix } => {
            Place::Matrix(DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))))
        }
        gltf::scene::Transform::Decomposed { translation, rotation, scale } => Place::Parts {
            translation: vector(translation),
            rotation: DQuat::from_array(rotation.map(f64::from)).normalize(),
            scale: vector(scale),
        },
    };
    Node {
        name: own.name().unwrap_or_default().to_owned(),
        children: own.children().map(|child| child.index()).collect(),
        place,
        mesh: own.mesh().map(|mesh| mesh.index()),
        skin: own.skin().map(|skin| skin.index()),
        weights: own.weights().unwrap_or_default().iter().map(|weight| f64::from(*weight)).collect(),
        levels: level::levels(own),
    }
}

fn skin(data: &Data<'_>, own: &gltf::Skin<'_>) -> Result<Skin, AssetError> {
    let joints: Vec<usize> = own.joints().map(|joint| joint.index()).collect();
    let mut inverse = vec![DMat4::IDENTITY; joints.len()];
    if let Some(accessor) = own.inverse_bind_matrices() {
        let matrices = data.numbers::<16>(&accessor)?;
        for (inverse, matrix) in inverse.iter_mut().zip(matrices) {
            *inverse = DMat4::from_cols_array(&matrix.map(f64::from));
        }
    }
    Ok(Skin { joints, inverse })
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

fn material(own: &gltf::Material<'_>) -> Material {
    const TRANSFORM: &str = "KHR_texture_transform";
    let metal = own.pbr_metallic_roughness();
    let of = |info: gltf::texture::Info<'_>| {
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
        emissive_map: own.emissive_texture().map(of),
        cutoff: match own.alpha_mode() {
            gltf::material::AlphaMode::Opaque => Cutoff::Opaque,
            gltf::material::AlphaMode::Mask => Cutoff::Mask(own.alpha_cutoff().unwrap_or(0.5)),
            gltf::material::AlphaMode::Blend => Cutoff::Blend,
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
            emissive_map: None,
            cutoff: Cutoff::Opaque,
            unlit: false,
            double_sided: false,
        }
    }
}
