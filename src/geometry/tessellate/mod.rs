//! From continuous to discrete: curves become stations, surfaces become triangles within a tolerance.
//!
//! Promise: each tessellation carries a bound on the distance between its triangles and the surface they
//! stand for, in both directions, before positions are rounded to single precision, and says whether the
//! bound is proved or sampled; points that triangles share are shared, so nothing cracks; no triangle has
//! zero area unless the surface itself is degenerate there. The tolerance is spent here and nowhere else.
//! Not promised: that the result does not cross itself where the surface does.

mod bevel;
mod cap;
mod cuboid;
mod deform;
mod discretize;
mod displace;
mod extrude;
mod field;
mod geodesic;
mod height;
mod patch;
mod perturbed;
mod plane;
mod quadric;
mod region;
mod revolve;
mod ring;
mod round;
mod rounded;
mod sheet;
mod sweep;
#[cfg(test)]
mod tests;
mod trimmed;
mod wire;

pub use bevel::{Collision, EdgeProfile};
pub use cuboid::cuboid;
pub use deform::{DeformError, Deformed, deform};
pub use discretize::{Density, Station, arc_lengths, discretize};
pub use displace::{Heights, PictureFault, displace, normal_picture};
pub use extrude::{Extrusion, extrude};
pub use field::{FieldSurface, field_surface};
pub use geodesic::{Geodesic, geodesic};
pub use height::{
    Base, BaseFault, BaseSurface, BasedMap, Chart, Closing, HeightBound, HeightMap, Layer, Mask, MaskSide,
    SurfaceBase, TwoSided, based_map, height_map, two_sided,
};
pub use patch::{Patchwork, Rim, patchwork};
pub use perturbed::{NetBase, NetBump, NoSolid, PerturbedNet, PerturbedSkin, SkinFault, perturbed};
pub use plane::{FlatPlane, plane};
pub use quadric::{Ball, Clip, ClippedQuadric, quadric};
pub use revolve::{Revolution, revolve};
pub use rounded::{RoundedBox, rounded_box};
pub use sheet::{Sheet, sheet};
pub use sweep::{Route, Sweep, sweep};
pub use trimmed::{TrimmedSurface, trimmed};
pub use wire::wire;

use glam::{DVec2, DVec3};
use thiserror::Error;

use super::mesh::Mesh;

/// How a bound on the deviation is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Evidence {
    /// The triangles are the shape.
    Exact,
    /// Follows from bounds on derivatives or closed forms.
    Proved,
    /// The largest of dense samples, with a margin.
    Sampled,
}

/// A bound on the distance between a mesh and the surface it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Greatest distance, metres.
    pub bound: f64,
    /// How it is known.
    pub evidence: Evidence,
}

impl Deviation {
    /// A mesh that is the shape.
    pub const NONE: Self = Self { bound: 0.0, evidence: Evidence::Exact };

    /// A bound in metres with its evidence; a bound of zero is exact.
    #[must_use]
    pub fn new(bound: f64, evidence: Evidence) -> Self {
        Self { bound, evidence: if bound == 0.0 { Evidence::Exact } else { evidence } }
    }

    /// The deviation of two meshes together.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { bound: self.bound.max(other.bound), evidence: self.evidence.max(other.evidence) }
    }
}

/// A mesh and how far it is from its source.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// The triangles; one run of origin 0.
    pub mesh: Mesh,
    /// Distance from the source.
    pub deviation: Deviation,
}

/// How finely a surface is to be cut and what its vertices carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Tolerance in metres, or a fixed grid.
    pub density: SurfaceDensity,
    /// Joints that turn by more than this many degrees are hard edges.
    pub crease_angle: f64,
    /// Whether vertices carry texture coordinates; without them no vertex is split for a seam.
    pub uv: bool,
    /// Most triangles allowed.
    pub triangle_limit: u64,
}

impl Detail {
    /// Refuses a number of triangles beyond the limit.
    fn allow(&self, needed: u64) -> Result<(), TessellateError> {
        let limit = self.triangle_limit;
        if needed > limit { Err(TessellateError::TooMany { needed, limit }) } else { Ok(()) }
    }
}

/// How finely a surface is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceDensity {
    /// As coarse as this many metres allow.
    Tolerance(f64),
    /// A grid of this many steps across and along.
    Grid {
        /// Steps around (revolve, sweep) or along the outline (extrude).
        u: u32,
        /// Steps along the profile (revolve), the path (sweep) or the height (extrude).
        v: u32,
    },
}

/// Why a surface was not tessellated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TessellateError {
    /// More triangles than allowed, found before they were made.
    #[error("this would make at least {needed} triangles, and the limit is {limit}")]
    TooMany {
        /// A lower bound on the number.
        needed: u64,
        /// The limit.
        limit: u64,
    },
    /// A cap could not be triangulated.
    #[error("the flat face at its end cannot be triangulated: {reason}")]
    Cap {
        /// What the triangulation said.
        reason: String,
    },
    /// A height map that reaches below the base that closes it.
    #[error("it is {height} high at [{}, {}], below its base at {base}", place.x, place.y)]
    BelowBase {
        /// A height below the base.
        height: f64,
        /// The base.
        base: f64,
        /// x and z of that height.
        place: DVec2,
    },
    /// A height map over a curved base that reaches below what closes it.
    #[error("at column {}, row {} it is {height} high, below its base at {base}", place.x, place.y)]
    BelowLevel {
        /// A height below the base.
        height: f64,
        /// The base.
        base: f64,
        /// Column and row of that height, counted from 0.
        place: DVec2,
    },
    /// Heights along normals that are different on both sides of a line, or jump.
    #[error("its height jumps by {gap} near {}", told(*place))]
    TornSeam {
        /// Where.
        place: DVec3,
        /// By how much.
        gap: f64,
    },
    /// A height that is no number.
    #[error("its height has no value at {}", told(*place))]
    NoHeight {
        /// Where.
        place: DVec3,
    },
    /// A surface moved along its normals so far that it crosses itself.
    #[error("its surface runs through itself near {}", told(*place))]
    CrossesItself {
        /// Where.
        place: DVec3,
    },
    /// Chords of lines that bound a curved face cross, however finely they are cut.
    #[error("the lines that bound it come too close to each other")]
    Tangled,
    /// Masks of a height map that leave no area of it.
    #[error("its masks leave nothing of it")]
    NothingKept,
    /// Walls lean further in than the outline is wide.
    #[error("near [{}, {}] the outline is too narrow for walls that reach {inset} inside", place.x, place.y)]
    TooNarrow {
        /// How far they reach in.
        inset: f64,
        /// Where.
        place: DVec2,
    },
    /// The outline encloses no area.
    #[error("the outline encloses no area")]
    NoArea,
    /// A field that is nowhere 0 in its box.
    #[error("the field has no surface in its box")]
    NoSurface,
    /// A field that has no value somewhere in its box.
    #[error("the field has no value at {}", told(*place))]
    NoValue {
        /// Where.
        place: DVec3,
    },
    /// A surface that reaches the box in which it is searched.
    #[error("the surface leaves its box at {}", told(*place))]
    LeavesBox {
        /// A place near the box where it does.
        place: DVec3,
    },
    /// A surface whose triangles do not become sound, as where it touches itself.
    #[error("near {} {flaw}", told(*place))]
    Unsound {
        /// Where.
        place: DVec3,
        /// In what way.
        flaw: Flaw,
    },
    /// A field whose surface would take too long to find.
    #[error("to find its surface takes too many steps")]
    TooMuchWork,
}

/// Why triangles of a field's surface are not sound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Flaw {
    /// They cross each other.
    #[error("its triangles cross each other")]
    Crossing,
    /// They are too far from the surface.
    #[error("its triangles stay further from it than the tolerance")]
    Far,
    /// They are joined in another way at every size.
    #[error("its parts touch, or are too near or thin to be told apart")]
    Touching,
}

/// A place for a person: no more digits than it takes to find it.
pub(crate) fn told(place: DVec3) -> String {
    let mut digits = 0;
    let mut size = place.abs().max_element();
    while size < 100.0 && digits < 12 {
        (size, digits) = (10.0 * size, digits + 1);
    }
    let number = |x: f64| {
        let text = format!("{x:.digits$}");
        let text = if digits > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    };
    format!("[{}, {}, {}]", number(place.x), number(place.y), number(place.z))
}
