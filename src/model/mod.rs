//! The exact model: recipes of numbers, no triangle yet.
//!
//! Promise: a [`Model`] holds everything that is needed to make the asset at any tolerance and nothing of
//! the text it came from; handles always point at what exists, and a recipe refers only to shapes before it,
//! so there is no cycle. Lengths are in the document's unit; [`Model::frame`] turns and scales them to glTF.

mod attribute;
mod collider;
mod deform;
mod displace;
mod material;
mod motion;
mod optics;
mod shape;
mod solid;
mod subdivide;
mod vertex_color;
mod view;

pub use attribute::{At, Attribute};
pub use collider::{Collider, Fit};
pub use deform::{AxialBending, Bending, PathBending};
pub use displace::{Displacement, Heights, Projection};
pub use material::NormalMap;
pub use material::{
    AlphaMode, Filter, Image, ImageHandle, ImageKind, Material, MaterialHandle, Texture, TextureUse, Wrap,
};
pub use motion::{
    Clip, ClipTrack, Driver, Morph, NamedSkeleton, Owner, PropertyTrack, ReachTask, Skin, Socket,
    SocketHandle, Space, State, Target, WeightRule,
};
pub use optics::{Anisotropy, Clearcoat, Iridescence, Optics, Sheen, Specular, Transmission, Volume};
pub use shape::{
    Density, LightmapOptions, Occlusion, Recipe, Shape, ShapeHandle, ShapeOptions, Smoothing, UvMapping,
    UvMode,
};
pub use solid::{Hollow, KeptSide, PlaneCut, SolidOperation, SolidRecipe};
pub use subdivide::SubdivisionRecipe;
pub use vertex_color::{ColorLaw, VertexColor};
pub use view::{Camera, Lens, Light, LightKind};

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::geometry::curve::Path;

/// From the document's unit and axes to metres with y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// One unit of the document, metres.
    pub unit: f64,
    /// Whether z points up in the document.
    pub z_up: bool,
}

impl Frame {
    /// The rotation that brings the document's up to +y: (x, y, z) becomes (x, z, -y).
    #[must_use]
    pub fn axes(&self) -> DMat3 {
        if self.z_up { DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y) } else { DMat3::IDENTITY }
    }

    /// The same rotation as a quaternion.
    #[must_use]
    pub fn turn(&self) -> DQuat {
        const HALF_ROOT: f64 = core::f64::consts::FRAC_1_SQRT_2;
        if self.z_up { DQuat::from_xyzw(-HALF_ROOT, 0.0, 0.0, HALF_ROOT) } else { DQuat::IDENTITY }
    }

    /// From the document's unit and axes to metres with y up.
    #[must_use]
    pub fn map(&self) -> DAffine3 {
        DAffine3::from_mat3(self.axes() * self.unit)
    }

    /// Factors along the document's axes, along those of the file: up changes places with depth.
    #[must_use]
    pub fn scale(&self, scale: DVec3) -> DVec3 {
        if self.z_up { DVec3::new(scale.x, scale.z, scale.y) } else { scale }
    }
}

/// A place in the tree of nodes, in the document's unit and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Its name.
    pub name: String,
    /// The shape that stands there.
    pub shape: Option<ShapeHandle>,
    /// A material in place of the shape's own.
    pub material: Option<MaterialHandle>,
    /// Index of the parent in [`Model::nodes`].
    pub parent: Option<usize>,
    /// The socket that carries it, in place of a parent.
    pub socket: Option<SocketHandle>,
    /// Whether it is itself a place to attach things to.
    pub is_socket: bool,
    /// Whether it is one of the places where its parent shows a shape.
    pub is_copy: bool,
    /// The camera that looks along its -z from there.
    pub camera: Option<Camera>,
    /// The light that shines from there, along its -z if it is a spot or sun.
    pub light: Option<Light>,
    /// Applied last.
    pub translation: DVec3,
    /// Applied second.
    pub rotation: DQuat,
    /// Applied first.
    pub scale: DVec3,
}

/// A path of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPath {
    /// The name of the curve; of a path that is written inside another definition that one's name and a number.
    pub name: String,
    /// The path.
    pub path: Path,
}

/// The most that may be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Triangles of the asset.
    pub triangles: u64,
    /// Vertices of the asset.
    pub vertices: u64,
    /// Bytes of memory.
    pub memory: u64,
}

/// An asset, exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Name of the asset.
    pub name: String,
    /// Unit and axes.
    pub frame: Frame,
    /// Tolerance for shapes that state none, in the document's unit.
    pub tolerance: Option<f64>,
    /// Shapes; a recipe refers only to shapes before it.
    pub shapes: Vec<Shape>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Images that textures show.
    pub images: Vec<Image>,
    /// Normal maps that are drawn when the meshes are known.
    pub normal_maps: Vec<NormalMap>,
    /// Nodes; parents stand anywhere.
    pub nodes: Vec<Node>,
    /// Skeletons.
    pub skeletons: Vec<NamedSkeleton>,
    /// Skins, at most one for a shape.
    pub skins: Vec<Skin>,
    /// States of shapes; those of one shape stand together.
    pub morphs: Vec<Morph>,
    /// Models that the document makes with other parameters, for states; their own states and motions are left out.
    pub states: Vec<Self>,
    /// Motions.
    pub clips: Vec<Clip>,
    /// Bodies for physics.
    pub colliders: Vec<Collider>,
    /// Attributes of vertices that games read themselves.
    pub attributes: Vec<Attribute>,
    /// How far vertices may be from exact motions for clips that do not say, metres.
    pub motion_tolerance: Option<f64>,
    /// Paths, for the report of their joints.
    pub paths: Vec<NamedPath>,
    /// The most that may be made.
    pub limits: Limits,
}

impl Model {
    /// The shape of a handle.
    #[must_use]
    pub fn shape(&self, handle: ShapeHandle) -> &Shape {
        &self.shapes[handle.0 as usize]
    }

    /// The states of a shape, in the order of their targets.
    pub fn morphs_of(&self, shape: ShapeHandle) -> impl Iterator<Item = &Morph> {
        self.morphs.iter().filter(move |morph| morph.shape == shape)
    }

    /// The material of a handle.
    #[must_use]
    pub fn material(&self, handle: MaterialHandle) -> &Material {
        &self.materials[handle.0 as usize]
    }
}
