//! Meshes: triangles ready to be written, and polygons as they were authored or imported.
//!
//! Topology and position are separate: `points` are the corners of the *shape* (two triangles share an edge
//! when they share its two points), `vertices` are what a renderer needs (a point with one normal and one
//! UV). Several vertices may stand on one point; that is a hard edge or a UV seam, never a crack.

//!
//! A [`PolygonMesh`] is what an author or a file gives; [`convert`](convert::convert) makes a [`Mesh`] of it. Promise: indices
//! in range, boundary edges kept exactly, hard edges where asked. Not promised: that the result is closed,
//! or free of self-intersections; [`topology`] measures the first on any index buffer.

pub mod cache;
mod color;
pub mod convert;
pub mod crossing;
pub mod distance;
pub mod laplacian;
pub mod nearest;
mod normals;
pub mod occlusion;
pub mod overlap;
pub mod platonic;
pub mod polygon;
pub mod polygon_facts;
pub mod sight;
pub mod texels;
pub mod topology;
mod transform;
pub(crate) mod tree;
pub mod triangulate;
pub mod weld;
mod wire;

pub use color::Color;
pub use polygon::PolygonMesh;
pub(crate) use transform::NormalMap;
pub use wire::{Strand, Wire, WirePoint};

use glam::{DVec2, DVec3};

/// Index of a point in [`Mesh::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct PointIndex(pub u32);

impl PointIndex {
    /// The index as a subscript.
    #[must_use]
    pub fn subscript(self) -> usize {
        self.0 as usize
    }
}

/// Index of a vertex in [`Mesh::vertices`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct VertexIndex(pub u32);

impl VertexIndex {
    /// The index as a subscript.
    #[must_use]
    pub fn subscript(self) -> usize {
        self.0 as usize
    }
}

/// Where a vertex stands on its exact source: parameters of surface `source` (an index that the maker of the
/// mesh gives meaning). Never written; it follows every reordering, so that deviation can be measured locally.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Anchor {
    /// Which exact surface of the shape.
    pub source: u32,
    /// First parameter.
    pub u: f64,
    /// Second parameter.
    pub v: f64,
}

/// What a renderer needs at a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// The point it stands on.
    pub point: PointIndex,
    /// Unit normal, outward.
    pub normal: DVec3,
    /// Texture coordinates; v grows downwards as in glTF.
    pub uv: DVec2,
    /// Its color; white where it has none.
    pub color: Color,
    /// Place on the exact source.
    pub anchor: Anchor,
}

/// A run of triangles with one origin: triangles from the end of the run before up to `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Index into the table of origins that travels beside the mesh.
    pub origin: u32,
    /// One past the last triangle of the run.
    pub end: u32,
}

/// Triangles, counter-clockwise seen from outside. Every index is in range, runs cover all triangles in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions, metres.
    pub points: Vec<DVec3>,
    /// Points with their attributes.
    pub vertices: Vec<Vertex>,
    /// Corners of each triangle.
    pub triangles: Vec<[VertexIndex; 3]>,
    /// Origin of each triangle, as runs.
    pub runs: Vec<Run>,
}

/// A subscript as a 32-bit index.
///
/// # Panics
/// When there are 2^32 things or more; limits refuse such a mesh long before it exists.
pub(crate) fn index(subscript: usize) -> u32 {
    u32::try_from(subscript).expect("limits keep every count below 2^32")
}
