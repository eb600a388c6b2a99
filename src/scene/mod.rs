//! The discrete scene: what a glTF file can hold, and nothing more.
//!
//! Promise: a [`Scene`] is in metres with y up, in doubles; [`check`](check::check) alone can turn it into a
//! [`Checked`], which every writer demands. Not promised of an unchecked scene: anything.

pub mod check;
mod collider;
mod morph;
mod motion;

pub use check::{Checked, SceneError};
pub use collider::{Body, Collider, ColliderForm, ColliderPart};
pub use morph::MorphTarget;
pub use motion::{Animation, Channel, Owner, PropertyChannel, Skin};

pub use crate::model::{
    AlphaMode, Camera, Filter, Image, ImageHandle, ImageKind, Lens, Light, LightKind, Material, Texture,
    TextureUse, Wrap,
};

use glam::{DQuat, DVec3};

use crate::geometry::mesh::{Mesh, Wire};
use crate::geometry::number::floor_count;
use crate::geometry::tessellate::Deviation;
use crate::motion::Influences;

/// Everything that is written into one file.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name of the asset.
    pub name: String,
    /// Triangles, each stored once however often it is shown.
    pub geometries: Vec<Geometry>,
    /// Geometries with materials.
    pub meshes: Vec<MeshUse>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Images; textures refer to them.
    pub images: Vec<Image>,
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Skins.
    pub skins: Vec<Skin>,
    /// Motions.
    pub animations: Vec<Animation>,
    /// Bodies for physics.
    pub colliders: Vec<Collider>,
    /// How they stand in the file.
    pub collider_form: ColliderForm,
    /// The grid that all positions lie on, where they are written as whole numbers.
    pub grid: Option<Grid>,
    /// The node that carries all others where the file turns, moves or scales the model: it moves in no motion.
    pub root: Option<usize>,
    /// How coarser levels of meshes stand in the file.
    pub level_form: LevelForm,
}

/// A grid of positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// From line to line, metres: a power of two.
    pub step: f64,
    /// Its first point, a whole number of steps from the origin.
    pub offset: DVec3,
}

impl Grid {
    /// The place of a position on the grid; `None` where it lies on no point of it that 16 bits can name.
    #[must_use]
    pub fn place(&self, position: DVec3) -> Option<[u16; 3]> {
        let steps = (position - self.offset) / self.step;
        let whole = steps == steps.round() && steps.min_element() >= 0.0 && steps.max_element() <= 65535.0;
        // Whole numbers of this size are exact.
        whole.then(|| steps.to_array().map(|step| u16::try_from(floor_count(step)).unwrap_or(u16::MAX)))
    }
}

/// Triangles with their attributes, and lines.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// Name of the shape it comes from.
    pub name: String,
    /// Points, vertices, triangles; each run is one primitive, its origin an index into the materials of a
    /// [`MeshUse`].
    pub mesh: Mesh,
    /// Where parts of one material stay apart, for each origin of the runs the name of the part; else empty.
    pub parts: Vec<String>,
    /// Lines; the origin of each strand is an index into the materials of a [`MeshUse`].
    pub wire: Wire,
    /// Whether texture coordinates are written.
    pub uv: bool,
    /// Whether colors of vertices are written.
    pub colored: bool,
    /// For each vertex a tangent and the sign of the bitangent, where any material has a normal texture.
    pub tangents: Option<Vec<[f32; 4]>>,
    /// Second texture coordinates, by which no two places share a place of a picture.
    pub lightmap: Option<Lightmap>,
    /// Attributes that games read themselves.
    pub attributes: Vec<VertexAttribute>,
    /// For each point of the mesh the joints that carry it, as indices of the skin's joints.
    pub influences: Option<Vec<Influences>>,
    /// States that weights bring its vertices to.
    pub targets: Vec<MorphTarget>,
    /// Distance from the exact shape before rounding.
    pub deviation: Deviation,
    /// Distance that was asked for, metres; `None` where a fixed grid or no surface made the mesh.
    pub tolerance: Option<f64>,
}

/// Second texture coordinates, for a square picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Lightmap {
    /// Texels of a side.
    pub size: u32,
    /// Pieces that lie apart from each other.
    pub charts: u32,
    /// For each vertex its place, from 0 to 1; v grows downwards.
    pub places: Vec<[f32; 2]>,
}

/// Numbers at vertices, under a name that the format leaves to games.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexAttribute {
    /// Its name: an underscore, then capital letters, digits and underscores.
    pub name: String,
    /// Numbers at a vertex, one to four.
    pub width: usize,
    /// Whether they are bytes of 0 to 1; floats if not.
    pub bytes: bool,
    /// Those of each vertex of the mesh, one after the other.
    pub values: Vec<f32>,
    /// Those of each point of the wire.
    pub of_lines: Vec<f32>,
}

/// How levels of detail stand in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LevelForm {
    /// Beside the nodes, by `MSFT_lod`.
    #[default]
    Extension,
    /// Below the nodes, named `_LOD0`, `_LOD1`...
    Nodes,
}

/// A level of detail of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelUse {
    /// Its number; 0 is the finest.
    pub number: u32,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// What it was made from.
    pub source: LevelSource,
    /// It differs from the exact shape by no more than a pixel where it covers no more than this part of the picture.
    pub coverage: f64,
}

/// What a level of detail was made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelSource {
    /// It is what the document describes.
    Finest,
    /// The surfaces, cut more coarsely.
    Surface,
    /// The triangles of the level before.
    Triangles,
}

/// A geometry shown with materials.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshUse {
    /// Its name in the file.
    pub name: String,
    /// Index into [`Scene::geometries`].
    pub geometry: usize,
    /// For each origin of the geometry's runs and strands an index into [`Scene::materials`].
    pub materials: Vec<Option<usize>>,
    /// Its levels of detail, the finest first: its own, and coarser ones; empty where it has none.
    pub levels: Vec<LevelUse>,
}

/// A place where a node shows its mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// Applied last, metres.
    pub translation: DVec3,
    /// Applied second.
    pub rotation: DQuat,
    /// Applied first.
    pub scale: DVec3,
}

/// A place in the tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name.
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: Option<usize>,
    /// Index into [`Scene::skins`].
    pub skin: Option<usize>,
    /// Whether it is a place to attach things to.
    pub socket: bool,
    /// Whether it is one of the places where its parent shows a mesh.
    pub copy: bool,
    /// Where it shows its mesh, from itself, in place of once; empty where once.
    pub instances: Vec<Instance>,
    /// The camera that looks along its -z from there.
    pub camera: Option<Camera>,
    /// The light that shines from there, along its -z if it is a spot or sun.
    pub light: Option<Light>,
    /// Index of the parent.
    pub parent: Option<usize>,
    /// Applied last, metres.
    pub translation: DVec3,
    /// Applied second.
    pub rotation: DQuat,
    /// Applied first.
    pub scale: DVec3,
}
