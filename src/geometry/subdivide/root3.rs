//! Masks of the sqrt(3) scheme.
//!
//! Source: L. Kobbelt, "sqrt(3)-Subdivision", 2000: inner vertices in each step, borders in every second step as cubic
//! splines of which each part becomes three.

use super::level::Level;
use super::mask::{Mask, Scratch};
use crate::geometry::mesh::index;
use crate::geometry::number::cos;

/// The share of the mean of the neighbors in the mask of an inner vertex.
pub(super) fn relaxation(valence: usize) -> f64 {
    (4.0 - 2.0 * cos(std::f64::consts::TAU / f64::from(index(valence)))) / 9.0
}

/// The mask of an old vertex.
pub(super) fn vertex(level: &Level, vertex: u32, scratch: &mut Scratch, mask: &mut Mask) {
    let ring = &mut scratch.ring;
    level.topology.ring(vertex, ring);
    if ring.is_closed() {
        let share = relaxation(ring.valence());
        mask.add(vertex, 1.0 - share);
        ring.far.iter().for_each(|far| mask.add(*far, share / f64::from(index(ring.valence()))));
    } else if level.step % 2 == 1 && level.vertex_sharpness(vertex) == 0.0 {
        mask.add(vertex, 19.0 / 27.0);
        mask.add(ring.far[0], 4.0 / 27.0);
        mask.add(*ring.far.last().expect("a border has two edges"), 4.0 / 27.0);
    } else {
        mask.add(vertex, 1.0);
    }
}

/// The mask of a place on the border edge of a corner: a third of the way, or two thirds. At a sharp end the spline goes on
/// as straight as it can.
pub(super) fn third(level: &Level, corner: u32, far: bool, scratch: &mut Scratch, mask: &mut Mask) {
    let topology = &level.topology;
    let mut ends =
        [topology.corner_vertex[corner as usize], topology.corner_vertex[topology.next(corner) as usize]];
    if far {
        ends.reverse();
    }
    let [near, away] = ends;
    let ring = &mut scratch.ring;
    topology.ring(near, ring);
    let (first, last) = (ring.far[0], *ring.far.last().expect("a border has two edges"));
    let beyond = if first == away { last } else { first };
    if level.vertex_sharpness(near) > 0.0 {
        mask.add(near, 18.0 / 27.0);
        mask.add(away, 9.0 / 27.0);
        return;
    }
    mask.add(beyond, 1.0 / 27.0);
    mask.add(near, 16.0 / 27.0);
    mask.add(away, 10.0 / 27.0);
}
