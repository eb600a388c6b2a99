//! Whether a part encloses something: closed, of one orientation, outward.

use glam::DVec3;

use super::SolidFault;
use crate::geometry::mesh::topology;

/// Whether a part is looked through for triangles that cross each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Check {
    /// Its maker promises that none do.
    #[default]
    Trusted,
    /// None are known not to.
    Crossings,
}

/// The number of components of a closed mesh.
///
/// # Errors
/// Where it is open, or where neighbors look to opposite sides.
pub(super) fn components(part: usize, points: &[DVec3], triangles: &[[u32; 3]]) -> Result<u64, SolidFault> {
    let measured = topology::of_triangles(triangles, points.len())
        .map_err(|error| SolidFault::Engine(error.to_string()))?;
    if measured.closed { Ok(measured.components) } else { Err(gap(part, points, triangles)) }
}

/// What keeps a mesh from being closed.
fn gap(part: usize, points: &[DVec3], triangles: &[[u32; 3]]) -> SolidFault {
    let mut sides: Vec<(u32, u32, i32)> = triangles
        .iter()
        .flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)])
        .map(|(from, to)| if from < to { (from, to, 1) } else { (to, from, -1) })
        .collect();
    sides.sort_unstable();
    let unmatched = |edge: &[(u32, u32, i32)]| edge.iter().map(|(_, _, way)| way).sum::<i32>() != 0;
    let edges = || sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|edge| unmatched(edge));
    let middle = |edge: &[(u32, u32, i32)]| points[edge[0].0 as usize].midpoint(points[edge[0].1 as usize]);
    let count = |odd: bool| edges().filter(|edge| (edge.len() % 2 == 1) == odd).count() as u64;
    let first = |odd: bool| edges().find(|edge| (edge.len() % 2 == 1) == odd).map_or(DVec3::ZERO, middle);
    match count(true) {
        0 => SolidFault::Misoriented { part, edges: count(false), place: first(false) },
        edges => SolidFault::Open { part, edges, place: first(true) },
    }
}

/// Six times the signed volume, and twice the area, of some triangles; measured from a point near them.
pub(super) fn moments(points: &[DVec3], triangles: impl Iterator<Item = [u32; 3]>) -> (f64, f64) {
    let mut origin = None;
    let (mut volume, mut area) = (0.0, 0.0);
    for corners in triangles {
        let [a, b, c] = corners.map(|point| points[point as usize]);
        let origin = *origin.get_or_insert(a);
        let across = (b - a).cross(c - a);
        volume += across.dot(a - origin);
        area += across.length();
    }
    (volume, area)
}
