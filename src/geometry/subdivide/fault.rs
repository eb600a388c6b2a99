//! Why a cage cannot be refined.

use thiserror::Error;

/// What is wrong with a cage or with what is asked of it. Faces and vertices count from 0.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SubdivideFault {
    /// No faces.
    #[error("the cage has no faces")]
    Empty,
    /// Its own creases were asked for, and it has none.
    #[error("the cage says of no edge and of no vertex that it is sharp")]
    NoCreases,
    /// A face with fewer than three corners.
    #[error("face {face} of the cage has fewer than three corners")]
    FewCorners {
        /// The face.
        face: u32,
    },
    /// A face with holes.
    #[error("face {face} of the cage has holes")]
    Holes {
        /// The face.
        face: u32,
    },
    /// A face that comes to a vertex twice.
    #[error("face {face} of the cage comes to vertex {vertex} twice")]
    RepeatedVertex {
        /// The face.
        face: u32,
        /// The vertex.
        vertex: u32,
    },
    /// An edge with more than two faces.
    #[error("{faces} faces meet in the edge between vertices {a} and {b} of the cage")]
    ManyFaces {
        /// One end.
        a: u32,
        /// The other.
        b: u32,
        /// How many faces.
        faces: u32,
    },
    /// Neighbors that turn opposite ways.
    #[error("the two faces at the edge between vertices {a} and {b} of the cage turn opposite ways")]
    Opposed {
        /// One end.
        a: u32,
        /// The other.
        b: u32,
    },
    /// Parts that touch in a vertex alone.
    #[error("parts of the cage touch in vertex {vertex} alone")]
    Pinched {
        /// The vertex.
        vertex: u32,
    },
    /// A vertex without faces.
    #[error("vertex {vertex} of the cage belongs to no face")]
    Isolated {
        /// The vertex.
        vertex: u32,
    },
    /// A crease where there is no edge.
    #[error("there is no edge between vertices {a} and {b} of the cage")]
    NoEdge {
        /// One end.
        a: u32,
        /// The other.
        b: u32,
    },
    /// A vertex that does not exist.
    #[error("there is no vertex {vertex} in the cage, which has {count}")]
    NoVertex {
        /// The vertex.
        vertex: u32,
        /// How many there are.
        count: u32,
    },
    /// A scheme of triangles over other faces.
    #[error("face {face} of the cage has {corners} corners, and the scheme is one of triangles")]
    NotTriangles {
        /// The face.
        face: u32,
        /// Its corners.
        corners: u32,
    },
    /// An odd number of steps over a cage with borders.
    #[error(
        "the cage has borders, which the sqrt(3) scheme refines in every second level alone, and {levels} is odd"
    )]
    OddLevels {
        /// Levels that were asked for.
        levels: u32,
    },
    /// A coordinate that is no number.
    #[error("vertex {vertex} of the cage is not at a finite place")]
    NotFinite {
        /// The vertex.
        vertex: u32,
    },
    /// More triangles than allowed.
    #[error("{levels} levels would make {needed} triangles, and the limit is {limit}")]
    TooMany {
        /// Levels that were asked for, or that the tolerance needs at least.
        levels: u32,
        /// Triangles it would take.
        needed: u64,
        /// The limit.
        limit: u64,
    },
}
