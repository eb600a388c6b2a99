//! Solids: closed meshes put together by set operations, cut, wrapped, rounded and hollowed out.
//!
//! Promise: operands are checked (closed, outward, finite) before anything is computed; every result is closed, and
//! each of its triangles knows the triangle of an operand that it lies on, with the material, texture coordinates,
//! smoothing and anchor of that one. Faces that lie on one another are treated exactly: a union of two boxes that
//! share a face has no wall between them, their intersection is nothing. The same input gives the same bits for any
//! number of threads. Not promised: that operands which cross themselves are put right; [`Check`] finds them.
//!
//! The set operations are those of the library Manifold (E. Lalish; J. Smith, Towards robust inexact geometric
//! computation, University of Cambridge, 2009, chapter 4) in its Rust port. Only `engine` knows that library. Without the
//! feature `csg` every operation answers [`SolidFault::Missing`].

mod body;
mod carry;
mod check;
mod decompose;
mod enclose;
mod group;
mod half;
mod open;
mod parts;
mod round;
mod skin;

#[cfg(feature = "csg")]
mod engine;
#[cfg(not(feature = "csg"))]
#[path = "engine_missing.rs"]
mod engine;
#[cfg(test)]
mod tests;

pub use body::{Body, body};
pub use check::Check;
pub use decompose::{ConvexPart, Decomposing, MOST_BODIES, decompose};
pub use enclose::{Round, enclosing_capsule, enclosing_cylinder, enclosing_hull, enclosing_radius};
pub use half::{HalfSpace, half_space};
pub use open::cut_open;
pub use round::{MOST_SWEPT, offset};
pub use skin::{hull, push_out};

use std::ops::Range;

use thiserror::Error;

use glam::DVec3;

use crate::geometry::mesh::Mesh;

/// Whether this build has the solid operations: the feature `csg`.
pub const AVAILABLE: bool = cfg!(feature = "csg");

/// Meshes side by side, each a part of its own.
#[derive(Clone, Debug, Default)]
pub struct Stock {
    /// All triangles; the parts share no points. Origins of runs are those of the result.
    pub mesh: Mesh,
    /// The triangles of each part.
    pub parts: Vec<Range<usize>>,
}

impl Stock {
    /// Adds a part; the origins of its runs are counted on from `origin`. Returns its number.
    pub fn add(&mut self, mesh: &Mesh, origin: u32) -> usize {
        let first = self.mesh.triangles.len();
        self.mesh.append(mesh, origin);
        self.parts.push(first..self.mesh.triangles.len());
        self.parts.len() - 1
    }
}

/// What is put together, and how. Parts are numbers of a [`Stock`].
#[derive(Clone, Debug, PartialEq)]
pub enum Combination {
    /// A part as it is.
    Part(usize),
    /// Everything that is in any of them.
    Union(Vec<Self>),
    /// Everything that is in all of them.
    Intersection(Vec<Self>),
    /// The first without the others.
    Difference(Box<Self>, Vec<Self>),
}

/// How a combination is made.
#[derive(Clone, Debug, Default)]
pub struct Making<'a> {
    /// Length below which edges vanish, in the unit of the mesh: what is shorter would collapse when positions are
    /// written in single precision. 0 for the exact result.
    pub resolution: f64,
    /// For each source of the anchors the parameters after which u and v come round again.
    pub periods: &'a [(f64, f64)],
    /// Which parts are looked through for triangles that cross each other.
    pub check: &'a [Check],
}

/// Why there is no result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SolidFault {
    /// A part has no triangle.
    #[error("encloses nothing: it has no faces")]
    NoFaces {
        /// Which part.
        part: usize,
    },
    /// A part has lines.
    #[error("has lines, which enclose nothing")]
    Lines {
        /// Which part.
        part: usize,
    },
    /// Edges of a part have a triangle on one side alone.
    #[error("is not closed: {edges} of its edges have a face on one side only, one of them at {}", shown(*place))]
    Open {
        /// Which part.
        part: usize,
        /// How many edges.
        edges: u64,
        /// The middle of the first of them.
        place: DVec3,
    },
    /// Neighbors of a part look to opposite sides.
    #[error("has faces that look to opposite sides: {edges} edges where they meet, one of them at {}", shown(*place))]
    Misoriented {
        /// Which part.
        part: usize,
        /// How many edges.
        edges: u64,
        /// The middle of the first of them.
        place: DVec3,
    },
    /// A part has no inside.
    #[error("encloses no volume")]
    NoVolume {
        /// Which part.
        part: usize,
    },
    /// The faces of a part look inward.
    #[error("is inside out: its volume is {volume:.6}")]
    InsideOut {
        /// Which part.
        part: usize,
        /// Its signed volume.
        volume: f64,
    },
    /// A part crosses itself.
    #[error("crosses itself{}", near(*place))]
    Crossing {
        /// Which part.
        part: usize,
        /// A point of the crossing, where one is known.
        place: Option<DVec3>,
    },
    /// Nothing is left.
    #[error("nothing is left")]
    Nothing,
    /// Points that wrap nothing: all on one plane.
    #[error("all points lie on one plane")]
    Flat,
    /// No flat face lies where one is to be opened.
    #[error("no flat face lies in the plane through {} that looks along {}", shown(*point), shown(*normal))]
    NoFace {
        /// Which of the planes.
        number: usize,
        /// A point on it.
        point: DVec3,
        /// Its normal.
        normal: DVec3,
    },
    /// A rounding of more work than is allowed.
    #[error("rounding it takes {needed} sums of a face and a corner of the ball, and the limit is {limit}")]
    TooMuch {
        /// Faces of the part times corners of the ball.
        needed: u64,
        /// The most.
        limit: u64,
    },
    /// More bodies apart from each other than can be made into parts.
    #[error("is {bodies} bodies apart from each other, and the limit is {limit}")]
    Scattered {
        /// How many.
        bodies: usize,
        /// The most.
        limit: usize,
    },
    /// The library refused.
    #[error("the solid library says {0}")]
    Engine(String),
    /// This build has no solid operations.
    #[error("this build of Kiln lacks the feature `csg`")]
    Missing,
}

impl SolidFault {
    /// The part it is about, if it is about one.
    #[must_use]
    pub fn part(&self) -> Option<usize> {
        match self {
            Self::NoFaces { part }
            | Self::Lines { part }
            | Self::Open { part, .. }
            | Self::Misoriented { part, .. }
            | Self::NoVolume { part }
            | Self::InsideOut { part, .. }
            | Self::Crossing { part, .. } => Some(*part),
            _ => None,
        }
    }
}

fn shown(place: DVec3) -> String {
    let short = |value: f64| {
        let text = format!("{value:.4}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        if text == "-0" { "0".to_owned() } else { text.to_owned() }
    };
    format!("[{}, {}, {}]", short(place.x), short(place.y), short(place.z))
}

fn near(place: Option<DVec3>) -> String {
    place.map_or_else(String::new, |place| format!(" near {}", shown(place)))
}

/// Puts parts together. The result has one run for each origin that it shows, in the order of the origins.
///
/// Cost: O(n log n) in the triangles of the parts and in the places where their faces cross or lie on one another.
///
/// # Errors
/// A part that is no solid, and a result that is empty.
pub fn combine(stock: &Stock, how: &Combination, making: &Making<'_>) -> Result<Combined, SolidFault> {
    let solids = parts::solids(stock, how, making)?;
    let faces = group::faces(stock);
    let made = engine::combine(stock, &solids, &faces, how, making.resolution)?;
    let Combined { mesh, moved } = carry::carried(stock, &made, &faces, making.periods);
    let mesh = parts::without_slivers(mesh);
    if mesh.triangles.is_empty() { Err(SolidFault::Nothing) } else { Ok(Combined { mesh, moved }) }
}

/// What a combination gives.
#[derive(Clone, Debug, Default)]
pub struct Combined {
    /// The mesh; its origins are those of the stock.
    pub mesh: Mesh,
    /// The greatest distance of its points from the triangles of the stock that they lie on: what short edges that vanished
    /// have cost. 0 where it is no more than rounding in double precision.
    pub moved: f64,
}

/// Triangles as the library gives them: each with the triangle of the stock that it lies on.
#[derive(Clone, Debug, Default)]
struct Raw {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// For each triangle one of the stock, in whose plane it lies, and whether it looks the other way.
    origins: Vec<Lying>,
}

/// The triangle of a stock that another lies on.
#[derive(Clone, Copy, Debug)]
struct Lying {
    on: u32,
    flipped: bool,
}
