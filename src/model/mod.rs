//! The exact model: recipes of numbers, no triangle yet.
//!
//! Promise: a [`Model`] holds everything that is needed to make the asset at any tolerance and nothing of
//! the text it came from; handles always point at what exists, and a recipe refers only to shapes before it,
//! so there is no cycle. Lengths are in the document's unit; [`Model::frame`] turns and scales them to glTF.

mod deform;
mod material;
mod shape;
mod solid;
mod subdivide;

pub use deform::{AxialBending, Bending, PathBending};
pub use material::{
    AlphaMode, Filter, Image, ImageHandle, ImageKind, Material, MaterialHandle, Texture, Wrap,
};
pub use shape::{Density, Recipe, Shape, ShapeHandle, ShapeOptions, Smoothing, UvMode};
pub use solid::{Hollow, KeptSide, PlaneCut, SolidOperation, SolidRecipe};
pub use subdivide::SubdivisionRecipe;

use glam::{DQuat, DVec3};

use crate::geometry::curve::Path;

/// From the document's unit and axes to metres with y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// One unit of the document, metres.
    pub unit: f64,
    /// Whether z points up in the document.
    pub z_up: bool,
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
    /// Nodes; parents stand anywhere.
    pub nodes: Vec<Node>,
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

    /// The material of a handle.
    #[must_use]
    pub fn material(&self, handle: MaterialHandle) -> &Material {
        &self.materials[handle.0 as usize]
    }
}
