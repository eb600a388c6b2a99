//! Masks of the modified Butterfly scheme, which keeps all vertices.
//!
//! Sources: N. Dyn, D. Levin, J. Gregory, "A Butterfly Subdivision Scheme for Surface Interpolation with Tension Control",
//! 1990 (w = 1/16); D. Zorin, P. Schröder, W. Sweldens, "Interpolating Subdivision for Meshes with Arbitrary Topology",
//! 1996. Borders follow the four-point rule; where a mask reaches over a border, the missing vertex is the image of the
//! one across that edge in the middle of the edge.

use super::level::Level;
use super::mask::{Mask, Scratch};
use super::topology::{NONE, Ring};
use crate::geometry::mesh::index;
use crate::geometry::number::cos;

/// The weight of the neighbor `steps` further round an inner vertex of a valence that is not 6.
pub(super) fn ring_weight(valence: usize, steps: usize) -> f64 {
    match (valence, steps) {
        (3, 0) => 5.0 / 12.0,
        (3, _) => -1.0 / 12.0,
        (4, 0) => 0.375,
        (4, 2) => -0.125,
        (4, _) => 0.0,
        _ => {
            let n = f64::from(index(valence));
            let angle = std::f64::consts::TAU * f64::from(index(steps)) / n;
            (0.25 + cos(angle) + 0.5 * cos(2.0 * angle)) / n
        }
    }
}

/// The mask of the vertex on an edge.
pub(super) fn edge(level: &Level, edge: u32, scratch: &mut Scratch, mask: &mut Mask) {
    let topology = &level.topology;
    let [a, b] = topology.ends(edge);
    let Scratch { ring, other, .. } = scratch;
    topology.ring(a, ring);
    topology.ring(b, other);
    if topology.is_border(edge) {
        return border(level, [(a, ring, b), (b, other, a)], mask);
    }
    // Borders count as regular: what is missing there is made up.
    let extraordinary = |ring: &Ring| ring.is_closed() && ring.valence() != 6;
    match (extraordinary(ring), extraordinary(other)) {
        (false, false) => regular(level, edge, mask),
        (true, false) => around(ring, b, 1.0, mask),
        (false, true) => around(other, a, 1.0, mask),
        (true, true) => {
            around(ring, b, 0.5, mask);
            around(other, a, 0.5, mask);
        }
    }
}

fn around(ring: &Ring, toward: u32, share: f64, mask: &mut Mask) {
    let valence = ring.valence();
    let first = ring.far.iter().position(|far| *far == toward).expect("ends of an edge are neighbors");
    mask.add(ring.vertex, 0.75 * share);
    for step in 0..valence {
        mask.add(ring.far[(first + step) % valence], share * ring_weight(valence, step));
    }
}

fn border(level: &Level, ends: [(u32, &mut Ring, u32); 2], mask: &mut Mask) {
    for (near, ring, away) in ends {
        let (first, last) = (ring.far[0], *ring.far.last().expect("a border has two edges"));
        let beyond = if first == away { last } else { first };
        mask.add(near, 0.5625);
        if level.vertex_sharpness(near) > 0.0 {
            // The border ends here: it goes on straight.
            mask.add(near, -0.125);
            mask.add(away, 0.0625);
        } else {
            mask.add(beyond, -0.0625);
        }
    }
}

fn regular(level: &Level, edge: u32, mask: &mut Mask) {
    let topology = &level.topology;
    let corner = topology.edge_corner[edge as usize];
    for side in [corner, topology.twin[corner as usize]] {
        let (next, before) = (topology.next(side), topology.before(side));
        let at = |corner: u32| topology.corner_vertex[corner as usize];
        mask.add(at(side), 0.5);
        mask.add(at(before), 0.125);
        // The wings over both other edges of the triangle.
        for (over, opposite) in [(next, side), (before, next)] {
            let twin = topology.twin[over as usize];
            if twin == NONE {
                mask.add(at(over), -0.0625);
                mask.add(at(topology.next(over)), -0.0625);
                mask.add(at(opposite), 0.0625);
            } else {
                mask.add(at(topology.before(twin)), -0.0625);
            }
        }
    }
}
