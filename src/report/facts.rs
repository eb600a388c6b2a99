//! Facts about one written mesh: its f32 positions and indices as they stand in the file.
//!
//! Vertices at equal positions (bit for bit, with -0 taken as 0) are one *point*; topology is that of the points.
//! Every number is the same for any number of threads: sums run over fixed blocks whose results are added pairwise.

mod cache;
mod lines;
mod merge;
mod moments;
mod source;

use serde::Serialize;
use thiserror::Error;

use crate::geometry::mesh::topology::{self, Topology};
use moments::Moments;

pub use cache::{VertexCache, vertex_cache};
pub use lines::{LineFacts, measure_lines};
pub use source::{Corner, Position};

/// What [`measure`] finds.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct MeshFacts {
    /// Triangles.
    pub triangles: u64,
    /// Vertices in the file.
    pub vertices: u64,
    /// Different positions that triangles use.
    pub points: u64,
    /// The box of all vertices; none without vertices.
    pub bounds: Option<Box3>,
    /// Square metres.
    pub area: f64,
    /// Cubic metres, negative when the surface is inside out; none unless the mesh is closed.
    pub volume: Option<f64>,
    /// What `centroid` and `inertia` are of.
    #[serde(rename = "inertia-of")]
    pub mass: Mass,
    /// Center of mass, metres; none when there is neither volume nor area.
    pub centroid: Option<[f64; 3]>,
    /// Inertia tensor about the centroid for density 1 (per cubic metre, or per square metre of a surface).
    pub inertia: Option<[[f64; 3]; 3]>,
    /// Each edge is used equally often in both directions.
    pub closed: bool,
    /// Each edge is used exactly once in each direction, and one fan of triangles stands around each point.
    pub manifold: bool,
    /// Sets of triangles joined through edges.
    pub components: u64,
    /// Points - edges + triangles.
    pub euler: i64,
    /// Handles over all components; none unless the mesh is manifold.
    pub genus: Option<u64>,
    /// Edges that one triangle uses.
    pub boundary_edges: u64,
    /// Chains of boundary edges.
    pub boundary_loops: u64,
    /// Edges that more than two triangles use.
    pub crowded_edges: u64,
    /// Edges that two triangles use in the same direction.
    pub misoriented_edges: u64,
    /// Triangles whose area is exactly zero.
    pub degenerate_triangles: u64,
    /// Vertices transformed for each triangle with a FIFO cache of 16: 3 at worst, 0.5 at best on large meshes.
    pub acmr: f64,
    /// Vertices transformed for each vertex used: 1 at best.
    pub atvr: f64,
}

/// An axis-aligned box of written positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Box3 {
    /// Least coordinates.
    pub min: [f32; 3],
    /// Greatest coordinates.
    pub max: [f32; 3],
}

/// What has mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mass {
    /// The inside, evenly filled.
    Solid,
    /// The surface, as of an even sheet.
    Surface,
}

/// Why a mesh cannot be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum FactsError {
    /// The number of indices is not a multiple of three.
    #[error("{indices} indices do not make whole triangles")]
    IncompleteTriangle {
        /// How many there are.
        indices: usize,
    },
    /// An index beyond the vertices.
    #[error("index {index} of triangle {triangle} is out of range: there are {vertices} vertices")]
    IndexOutOfRange {
        /// Which triangle.
        triangle: usize,
        /// The index.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A NaN or infinite coordinate.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// Which vertex.
        vertex: usize,
    },
    /// More triangles than topology can name.
    #[error(transparent)]
    TooLarge(#[from] topology::TooLarge),
}

/// A volume below this part of what a ball of the same area holds is none: the mesh is a sheet with two sides.
const THIN: f64 = 1e-9;

/// Triangles below which one thread measures everything: to wake another takes longer.
const ONE_THREAD: usize = 100_000;

/// Measures a mesh: all its primitives together. Linear in time; the memory on top of the input is at most twice the
/// input for oriented surfaces, three times for other meshes.
///
/// # Errors
/// See [`FactsError`]; every index and position is checked.
pub fn measure<P: Position, I: Corner>(positions: &[P], indices: &[I]) -> Result<MeshFacts, FactsError> {
    check(positions, indices)?;
    let bounds = bounds_of(positions);
    let shape = || topology_of(positions, indices);
    let sums = || (Moments::of(positions, indices, bounds.as_ref()), vertex_cache(indices, positions.len()));
    let (topology, (mut moments, cache)) =
        if indices.len() / 3 < ONE_THREAD { (shape(), sums()) } else { rayon::join(shape, sums) };
    let topology = topology?;
    let solid = topology.closed && moments.volume().abs() > THIN * moments.area() * moments.area().sqrt();
    let mass = if solid { Mass::Solid } else { Mass::Surface };
    if mass == Mass::Surface {
        moments.add_surface(positions, indices);
    }
    Ok(MeshFacts {
        triangles: topology.triangles,
        vertices: positions.len() as u64,
        points: topology.points,
        bounds,
        area: moments.area(),
        volume: topology.closed.then(|| moments.volume()),
        mass,
        centroid: moments.centroid(mass),
        inertia: moments.inertia(mass),
        closed: topology.closed,
        manifold: topology.manifold,
        components: topology.components,
        euler: topology.euler,
        genus: topology.genus,
        boundary_edges: topology.boundary_edges,
        boundary_loops: topology.boundary_loops,
        crowded_edges: topology.crowded_edges,
        misoriented_edges: topology.misoriented_edges,
        degenerate_triangles: moments.degenerate,
        acmr: cache.acmr,
        atvr: cache.atvr,
    })
}

fn topology_of<P: Position, I: Corner>(
    positions: &[P],
    indices: &[I],
) -> Result<Topology, topology::TooLarge> {
    let same = merge::merge(positions);
    topology::measure(indices.len() / 3, positions.len(), |corner| same[indices[corner].vertex() as usize])
}

fn check<P: Position, I: Corner>(positions: &[P], indices: &[I]) -> Result<(), FactsError> {
    if !indices.len().is_multiple_of(3) {
        return Err(FactsError::IncompleteTriangle { indices: indices.len() });
    }
    let vertices = positions.len();
    let beyond = |index: &I| index.vertex() as usize >= vertices;
    if indices.iter().map(|index| index.vertex()).max().is_some_and(|most| most as usize >= vertices) {
        let at = indices.iter().position(beyond).unwrap_or(0);
        return Err(FactsError::IndexOutOfRange { triangle: at / 3, index: indices[at].vertex(), vertices });
    }
    let finite = |position: &P| position.coordinates().iter().all(|value| value.is_finite());
    match positions.iter().position(|position| !finite(position)) {
        Some(vertex) => Err(FactsError::NotFinite { vertex }),
        None => Ok(()),
    }
}

fn bounds_of<P: Position>(positions: &[P]) -> Option<Box3> {
    let first = positions.first()?.coordinates();
    let mut bounds = Box3 { min: first, max: first };
    for position in positions {
        for (axis, value) in position.coordinates().into_iter().enumerate() {
            bounds.min[axis] = bounds.min[axis].min(value);
            bounds.max[axis] = bounds.max[axis].max(value);
        }
    }
    Some(bounds)
}

#[cfg(test)]
mod tests;
