//! From the exact model to the discrete scene at a tolerance.
//!
//! Promise: each shape that is shown is made once for all its nodes; the deviation that is reported covers
//! every part of it, after all maps; the limits hold before memory is taken. Not promised: that a shape is
//! closed; the report measures that.

mod attribute;
mod bent;
mod cloud;
mod collider;
mod deformation;
mod displace;
mod estimate;
mod extents;
mod facets;
mod field;
mod height;
mod inherited;
mod keep;
mod leaning;
mod level;
mod limit;
mod made_bytes;
mod mapping;
mod material;
mod morph;
mod motion;
mod nearest;
mod node;
mod normal_map;
mod parameters;
mod property;
mod reach;
mod recipe_hash;
mod shape;
mod sheets;
mod solid;
mod source;
mod subdivide;
mod swept;
mod textured;
mod vertex_color;
mod window;
mod work;

pub use attribute::attributes;
pub use collider::colliders;
pub use estimate::memory;
pub use keep::{Keep, Memo};
pub use level::{level, within_limits};
pub use normal_map::normal_maps;
pub use shape::stretch;
pub use sheets::sheets;
pub use source::{Source, Sources, sources};
pub use window::Window;
pub use work::{Origin, ShapeWork, WorkLog};

use glam::DVec3;
use thiserror::Error;

use crate::geometry::mesh::polygon::PolygonError;
use crate::geometry::solid::SolidFault;
use crate::geometry::subdivide::SubdivideFault;
use crate::geometry::tessellate::{DeformError, TessellateError, told};
use crate::model::{MaterialHandle, Model, ShapeHandle};
use crate::motion::Property;
use crate::scene::Scene;

/// How to realize.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options<'a> {
    /// All tolerances are multiplied by this; 0 means 1.
    pub coarser: f64,
    /// How much coarser surfaces are besides.
    pub level: Level,
    /// Shapes that were made before; they must be of the model that is realized.
    pub memo: Option<&'a Memo<'a>>,
    /// Parts that wear one material stay apart.
    pub apart: bool,
}

/// A level of detail. What others are made from (cages, sums of weights) is made as for the finest one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// 0 is the finest. Steps of fixed grids are halved so often, and subdivisions are so many fewer.
    pub number: u32,
    /// Tolerances are multiplied by this.
    pub factor: f64,
    /// No tolerance is less than this, in the document's unit.
    pub least: f64,
}

impl Level {
    /// What the document describes.
    pub const FINEST: Self = Self { number: 0, factor: 1.0, least: 0.0 };

    /// A tolerance at this level.
    #[must_use]
    pub fn tolerance(&self, finest: f64) -> f64 {
        (finest * self.factor).max(self.least)
    }

    /// Steps of a fixed grid at this level; three stay, as around a tube.
    fn steps(&self, finest: u32) -> u32 {
        let halved = finest.checked_shr(self.number).unwrap_or(0);
        halved.max(finest.min(3))
    }
}

impl Default for Level {
    fn default() -> Self {
        Self::FINEST
    }
}

/// Why a shape has no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RealizeError {
    /// The tessellator refused.
    #[error(transparent)]
    Tessellate(#[from] TessellateError),
    /// The polygons are no mesh.
    #[error(transparent)]
    Polygons(#[from] PolygonError),
    /// A map that bends the shape cannot be applied.
    #[error(transparent)]
    Deform(DeformError),
    /// A solid operation has no result.
    #[error("{fault}")]
    Solid {
        /// The solid.
        shape: ShapeHandle,
        /// The part of it that is to blame, if one is.
        part: Option<ShapeHandle>,
        /// Why.
        fault: SolidFault,
    },
    /// A cage cannot be refined.
    #[error("{fault}")]
    Subdivide {
        /// The subdivision.
        shape: ShapeHandle,
        /// Its cage.
        cage: ShapeHandle,
        /// Why.
        fault: SubdivideFault,
    },
    /// Points that no joint carries.
    #[error("{count} of its {of} points are carried by no joint")]
    Unweighted {
        /// Index of the skin.
        skin: usize,
        /// How many there are.
        count: usize,
        /// Of how many.
        of: usize,
        /// Where one of them is, in the document's unit and axes.
        place: DVec3,
        /// How far that one is from the nearest bone, in the document's unit.
        distance: f64,
    },
    /// Parts of a skin by heat that see no bone.
    #[error("{count} of its {of} points see no bone")]
    Unseen {
        /// Index of the skin.
        skin: usize,
        /// How many parts.
        parts: usize,
        /// How many points they have.
        count: usize,
        /// Of how many.
        of: usize,
        /// Where one of them is, in the document's unit and axes.
        place: DVec3,
        /// The joint of the skeleton whose bone is nearest to that one.
        nearest: usize,
    },
    /// Lines have no states.
    #[error("it has lines, and triangles alone have states")]
    MorphedWire,
    /// A state has other triangles.
    #[error("state `{state}` has {} points and {} triangles{}", found.0, found.1, if found == wanted {
        ", as the shape has, but joined in another way".to_owned()
    } else {
        format!(", and the shape has {} and {}", wanted.0, wanted.1)
    })]
    Topology {
        /// Its name.
        state: String,
        /// Points and triangles of the state by itself.
        found: (usize, usize),
        /// Points and triangles of the shape by itself.
        wanted: (usize, usize),
    },
    /// A state cannot be made.
    #[error("state `{state}` cannot be made: {error}")]
    State {
        /// Its name.
        state: String,
        /// Why.
        error: Box<Self>,
    },
    /// A collider without volume.
    #[error("its points lie on one plane")]
    FlatCollider {
        /// Index of the collider.
        collider: usize,
    },
    /// A collider of parts whose shape cannot be cut.
    #[error("{fault}")]
    ColliderParts {
        /// Index of the collider.
        collider: usize,
        /// Why.
        fault: SolidFault,
    },
    /// An attribute by a formula that has no value somewhere.
    #[error("its attribute `{name}` has no value at {}", told(*place))]
    NoAttribute {
        /// The attribute.
        name: String,
        /// Where, in the document's unit.
        place: DVec3,
    },
    /// A color by a formula that has no value somewhere.
    #[error("its color has no value at {}", told(*place))]
    NoColor {
        /// Where, in the document's unit.
        place: DVec3,
    },
    /// Lines have no weights.
    #[error("it has lines, and joints carry triangles alone")]
    SkinnedWire {
        /// Index of the skin.
        skin: usize,
    },
    /// A normal map that no written mesh shows.
    #[error(
        "its normal map is not shown: the shape is part of another one, or nodes give it other materials"
    )]
    NormalMapUnused,
    /// Texture coordinates under which a normal map cannot be drawn.
    #[error("its normal map cannot be drawn: near u = {}, v = {} texture coordinates {}", place.x, place.y, if *overlap { "cover one place several times" } else { "lie outside of the picture" })]
    NormalMapPlace {
        /// Texture coordinates.
        place: glam::DVec2,
        /// Whether triangles overlap there; otherwise they leave the picture.
        overlap: bool,
    },
    /// More vertices or bytes than allowed.
    #[error("this would make at least {needed} {what}, and the limit is {limit}")]
    Limit {
        /// What is counted.
        what: &'static str,
        /// How many there would be.
        needed: u64,
        /// The limit.
        limit: u64,
    },
    /// All shapes together pass a limit that none of them passes alone.
    #[error("all shapes together make more {what} than the limit of {limit}")]
    Together {
        /// What is counted.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
}

/// A scene, and what was noticed on the way.
#[derive(Clone, Debug)]
pub struct Realized {
    /// The scene.
    pub scene: Scene,
    /// For each geometry of the scene, the shape it comes from.
    pub shapes: Vec<ShapeHandle>,
    /// For each geometry the materials of its origins, before nodes give it others.
    pub materials: Vec<Vec<Option<MaterialHandle>>>,
    /// Motions that are not within their tolerance.
    pub loose: Vec<Loose>,
    /// For each change of a material that is on nothing shown its clip and the name of the material.
    pub unseen: Vec<(usize, String)>,
    /// Things a person should know, each with its shape.
    pub notes: Vec<(ShapeHandle, Note)>,
}

/// A motion whose written keys are further from it than its tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loose {
    /// Index of the clip.
    pub clip: usize,
    /// What is not: a property, or where none is named the motion.
    pub property: Option<Property>,
    /// How far, metres or in the property's unit.
    pub bound: f64,
    /// What was asked for.
    pub tolerance: f64,
}

/// What a person should know of the faces of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// Faces with two corners on one place and no others: they are left out.
    Dropped(Faces),
    /// Faces whose corners lie on one line: they are kept for the edges they share.
    Flat(Faces),
    /// Faces that cross themselves: they fold.
    Crossing(Faces),
    /// Faces of a cage that were cut into triangles for the scheme; the first is not told.
    Triangulated(Faces),
    /// Vertices of a cage that are smooth, at the end of a crease, on creases, and corners: a fact, no warning.
    Classes([u32; 4]),
}

/// Some faces of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Faces {
    /// The first of them.
    pub first: u32,
    /// How many there are.
    pub count: usize,
}

/// Makes the scene of a model.
///
/// # Errors
/// Every shape that could not be made, with the reason.
pub fn scene(model: &Model, options: &Options<'_>) -> Result<Realized, Vec<(ShapeHandle, RealizeError)>> {
    node::scene(model, options)
}
