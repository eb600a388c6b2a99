//! Masks of the dual schemes, which cut corners: Doo-Sabin and mid-edge.
//!
//! Sources: D. Doo, M. Sabin, "Behaviour of Recursive Division Surfaces near Extraordinary Points", 1978; J. Peters,
//! U. Reif, "The Simplest Subdivision Scheme for Smoothing Polyhedra", 1997 (one step here is two of theirs, which is one
//! halving). Borders follow quadratic splines by Chaikin's rule: A. Nasri, "Polyhedral Subdivision Methods for Free-Form
//! Surfaces", 1987.

use super::Scheme;
use super::level::Level;
use super::mask::Mask;
use crate::geometry::mesh::index;
use crate::geometry::number::cos;

/// The weight of the corner `steps` further round a face of `count` corners in Doo and Sabin's mask.
pub(super) fn doo_sabin_weight(count: usize, steps: usize) -> f64 {
    let n = f64::from(index(count));
    if steps == 0 {
        return (n + 5.0) / (4.0 * n);
    }
    (3.0 + 2.0 * cos(std::f64::consts::TAU * f64::from(index(steps)) / n)) / (4.0 * n)
}

/// The mask of the vertex in a corner of a face.
pub(super) fn corner(level: &Level, scheme: Scheme, corner: u32, mask: &mut Mask) {
    let topology = &level.topology;
    let here = topology.corner_vertex[corner as usize];
    if scheme == Scheme::MidEdge {
        let [before, next] = [topology.before(corner), topology.next(corner)];
        mask.add(here, 0.5);
        [before, next].into_iter().for_each(|side| mask.add(topology.corner_vertex[side as usize], 0.25));
        return;
    }
    let face = topology.corner_face[corner as usize] as usize;
    let corners = topology.face(face);
    let place = corner as usize - topology.face_range(face).start;
    for (other, vertex) in corners.iter().enumerate() {
        mask.add(*vertex, doo_sabin_weight(corners.len(), place.abs_diff(other)));
    }
}

/// The mask of a place on the border edge of a corner, a quarter of the way from its beginning or from its end.
pub(super) fn border(level: &Level, corner: u32, far: bool, mask: &mut Mask) {
    let topology = &level.topology;
    let (from, to) =
        (topology.corner_vertex[corner as usize], topology.corner_vertex[topology.next(corner) as usize]);
    let (near, away) = if far { (to, from) } else { (from, to) };
    mask.add(near, 0.75);
    mask.add(away, 0.25);
}
