//! Smoothing groups that say the same as the normals of a file.

use std::collections::BTreeMap;

use crate::geometry::mesh::PolygonMesh;
use crate::geometry::mesh::polygon::NONE;

/// Normals nearer than this, as the square of the distance of unit vectors, are one: about a twentieth of a degree, what
/// files of short numbers need.
const NEAR: f64 = 1e-6;

/// What the normals of a mesh say.
pub(super) enum Smoothing {
    /// Every edge between two faces is smooth.
    Smooth,
    /// None is.
    Flat,
    /// For each face its group, 0 where no edge of it is smooth; and how many edges are sharp within a group, which
    /// groups cannot say.
    Groups(Vec<u32>, usize),
}

/// The corners at the lower and the upper point of an edge, and their face.
type Side = (usize, usize, usize);

/// What the normals of a mesh say; `None` where a corner has none.
pub(super) fn smoothing(mesh: &PolygonMesh) -> Option<Smoothing> {
    if mesh.corner_normals.is_empty() || mesh.corner_normals.contains(&NONE) {
        return None;
    }
    // For each edge, by its lower and its upper point, its sides.
    let mut edges: BTreeMap<(u32, u32), Vec<Side>> = BTreeMap::new();
    for face in 0..mesh.faces.len() {
        for ring in mesh.loops_of(face) {
            let corners = mesh.corners_of_loop(ring);
            for corner in corners.clone() {
                let next = if corner + 1 == corners.end { corners.start } else { corner + 1 };
                let (from, to) = (mesh.corners[corner].0, mesh.corners[next].0);
                let (key, ends) =
                    if from < to { ((from, to), (corner, next)) } else { ((to, from), (next, corner)) };
                edges.entry(key).or_default().push((ends.0, ends.1, face));
            }
        }
    }
    let normal = |corner: usize| mesh.normals[mesh.corner_normals[corner] as usize].normalize_or_zero();
    let one = |a: usize, b: usize| (normal(a) - normal(b)).length_squared() <= NEAR;
    let pairs: Vec<(usize, usize, bool)> = (edges.values())
        .filter_map(|around| match around[..] {
            [a, b] => Some((a.2, b.2, one(a.0, b.0) && one(a.1, b.1))),
            _ => None,
        })
        .collect();
    if pairs.iter().all(|pair| !pair.2) {
        return Some(Smoothing::Flat);
    }
    if pairs.iter().all(|pair| pair.2) {
        return Some(Smoothing::Smooth);
    }
    let mut above: Vec<usize> = (0..mesh.faces.len()).collect();
    for &(a, b, _) in pairs.iter().filter(|pair| pair.2) {
        let (a, b) = (root(&mut above, a), root(&mut above, b));
        above[a.max(b)] = a.min(b);
    }
    let roots: Vec<usize> = (0..above.len()).map(|face| root(&mut above, face)).collect();
    let mut numbers = BTreeMap::new();
    for &(a, _, _) in pairs.iter().filter(|pair| pair.2) {
        let next = crate::geometry::mesh::index(numbers.len()) + 1;
        numbers.entry(roots[a]).or_insert(next);
    }
    let groups = roots.iter().map(|root| numbers.get(root).copied().unwrap_or(0)).collect();
    let lost = pairs.iter().filter(|&&(a, b, smooth)| !smooth && roots[a] == roots[b]).count();
    Some(Smoothing::Groups(groups, lost))
}

fn root(above: &mut [usize], mut face: usize) -> usize {
    while above[face] != face {
        above[face] = above[above[face]];
        face = above[face];
    }
    face
}
