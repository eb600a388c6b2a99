//! Shapes as recipes.

use glam::{DAffine3, DVec2, DVec3};

use super::{Bending, Displacement, MaterialHandle, SolidRecipe, SubdivisionRecipe, VertexColor};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh::PolygonMesh;
use crate::geometry::tessellate::{
    BasedMap, ClippedQuadric, Extrusion, FieldSurface, FlatPlane, Geodesic, HeightMap, Patchwork,
    PerturbedSkin, Revolution, RoundedBox, Sheet, Sweep, TrimmedSurface, TwoSided,
};

/// Index of a shape in its model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ShapeHandle(pub u32);

/// A shape: how it is made and what holds for the result.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Its name; a shape written in place has the name of its user and a number.
    pub name: String,
    /// How it is made.
    pub recipe: Recipe,
    /// What holds for the result.
    pub options: ShapeOptions,
}

/// How a shape is made.
#[derive(Clone, Debug, PartialEq)]
pub enum Recipe {
    /// A box.
    Cuboid {
        /// Lengths of its edges.
        size: DVec3,
        /// Its middle.
        center: DVec3,
    },
    /// A box with rounded edges.
    RoundedBox(RoundedBox),
    /// A ball of nearly equal triangles.
    Geodesic(Geodesic),
    /// A flat rectangle.
    Plane(FlatPlane),
    /// A profile turned about the y axis; spheres and cylinders too.
    Revolution(Revolution),
    /// Outlines pushed along z.
    Extrusion(Extrusion),
    /// A section carried along a path.
    Sweep(Sweep),
    /// Surfaces by their parameters, alone or joined, with flat ends.
    Patches {
        /// The surfaces.
        patches: Patchwork,
        /// For each surface the material of the shape that it was joined from; none where none has one.
        materials: Vec<Option<MaterialHandle>>,
    },
    /// A flat face inside closed curves.
    Sheet(Sheet),
    /// Heights over a rectangle.
    Height(HeightMap),
    /// Heights over a curved base.
    Based(Box<BasedMap>),
    /// Heights on both sides of a plane.
    TwoSided(Box<TwoSided>),
    /// Curves as lines.
    Wire(Vec<AnyCurve>),
    /// A surface of the second degree, cut off.
    Quadric(ClippedQuadric),
    /// Where a field is zero.
    Implicit {
        /// The surface. Where its field has shapes, their numbers are places in `shapes`, and a box that is empty is that of the
        /// field once they are made.
        surface: Box<FieldSurface>,
        /// The shapes to which distances are in the field.
        shapes: Vec<ShapeHandle>,
        /// For each body of its field the material; none where none has one.
        materials: Vec<Option<MaterialHandle>>,
        /// For each element of its skeleton the color, linear; none where no element has one.
        colors: Vec<[f64; 4]>,
    },
    /// Polygons with bumps.
    Perturbed(Box<PerturbedSkin>),
    /// A part of a surface inside lines of its parameters.
    Trimmed(TrimmedSurface),
    /// Polygons, written out or imported. For each of their materials the model's, if it has one.
    Polygons {
        /// The polygons.
        mesh: PolygonMesh,
        /// For each entry of [`PolygonMesh::materials`].
        materials: Vec<Option<MaterialHandle>>,
    },
    /// Another shape under a map that bends.
    Deformed {
        /// The shape.
        of: ShapeHandle,
        /// The map.
        by: Bending,
    },
    /// Another shape moved along its normals.
    Displaced(Displacement),
    /// Closed shapes as solids.
    Solid(SolidRecipe),
    /// A cage refined toward a smooth surface.
    Subdivided(SubdivisionRecipe),
    /// Other shapes, each under maps; more than one map makes as many copies.
    Assembly(Vec<(ShapeHandle, DAffine3)>),
}

/// What holds for a shape whatever its kind.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeOptions {
    /// Distance allowed between mesh and surface, in the document's unit.
    pub tolerance: Option<f64>,
    /// A fixed grid instead.
    pub density: Option<Density>,
    /// Where it looks smooth.
    pub smoothing: Smoothing,
    /// Edges that turn by more degrees are hard.
    pub crease_angle: f64,
    /// When texture coordinates are written.
    pub uv: UvMode,
    /// How a texture lies on it.
    pub uv_mapping: UvMapping,
    /// Repeats of the texture.
    pub uv_scale: DVec2,
    /// Colors of its vertices.
    pub vertex_color: Option<VertexColor>,
    /// Second texture coordinates, if it has some.
    pub lightmap: Option<LightmapOptions>,
    /// What its own parts hide of the sky darkens the colors of its vertices.
    pub occlusion: Option<Occlusion>,
    /// Its material.
    pub material: Option<MaterialHandle>,
    /// Scale, rotation and place, applied to the finished shape.
    pub placement: DAffine3,
}

impl ShapeOptions {
    /// What holds where nothing is written.
    pub const PLAIN: Self = Self {
        tolerance: None,
        density: None,
        smoothing: Smoothing::Auto,
        crease_angle: 30.0,
        uv: UvMode::Auto,
        uv_mapping: UvMapping::Surface,
        uv_scale: DVec2::ONE,
        material: None,
        vertex_color: None,
        lightmap: None,
        occlusion: None,
        placement: DAffine3::IDENTITY,
    };
}

/// For what picture second texture coordinates are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightmapOptions {
    /// Texels of a side.
    pub size: u32,
    /// Texels around each piece.
    pub padding: u32,
}

/// How the sky over a vertex is asked, and what that does to its color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occlusion {
    /// Directions for each vertex.
    pub samples: u32,
    /// How far things hide, in the document's unit; `None` for all of them.
    pub distance: Option<f64>,
    /// How dark a vertex is whose whole sky is hidden: 1 is black.
    pub strength: f64,
    /// Turns the directions.
    pub seed: u32,
}

/// Steps of a fixed grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Density {
    /// Along the first parameter.
    pub u: u32,
    /// Along the second parameter.
    pub v: u32,
}

/// Where a shape looks smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothing {
    /// But for corners beyond the crease angle, or by smoothing groups.
    Auto,
    /// Nowhere.
    Flat,
    /// Everywhere.
    Smooth,
}

/// How a texture lies on a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UvMapping {
    /// Along the parameters of its surfaces, or as its file says.
    Surface,
    /// From the six sides.
    Box,
    /// Around the y axis and along it.
    Cylinder,
    /// Around the y axis and from pole to pole.
    Sphere,
}

/// When texture coordinates are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UvMode {
    /// When the material has a texture.
    Auto,
    /// Always.
    Always,
    /// Never.
    None,
}
