//! Meshes: triangles ready to be written, and polygons as they were authored or imported.
//!
//! Topology and position are separate: `points` are the corners of the *shape* (two triangles share an edge
//! when they share its two points), `vertices` are what a renderer needs (a point with one normal and one
//! UV). Several vertices may stand on one point; that is a hard edge or a UV seam, never a crack.

use glam::{DVec2, DVec3};

/// Index of a point in [`Mesh::points`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct PointIndex(pub u32);

/// Index of a vertex in [`Mesh::vertices`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct VertexIndex(pub u32);

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
