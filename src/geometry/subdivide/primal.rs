//! Masks of Catmull-Clark, Loop and bilinear refinement, with creases.
//!
//! Sources: E. Catmull, J. Clark, "Recursively Generated B-Spline Surfaces on Arbitrary Topological Meshes", 1978;
//! C. Loop, "Smooth Subdivision Surfaces Based on Triangles", 1987; creases as in [`sharpness`](super::sharpness).

use super::Scheme;
use super::level::Level;
use super::mask::{Mask, Scratch};
use super::sharpness::VertexClass;
use super::topology::{NONE, Ring};
use crate::geometry::mesh::index;
use crate::geometry::number::cos;

/// The weight of each neighbor in Loop's mask of an inner vertex.
pub(super) fn loop_weight(valence: usize) -> f64 {
    let n = f64::from(index(valence));
    let inner = 0.375 + 0.25 * cos(std::f64::consts::TAU / n);
    (0.625 - inner * inner) / n
}

/// The mask of an old vertex.
pub(super) fn vertex(level: &Level, scheme: Scheme, vertex: u32, scratch: &mut Scratch, mask: &mut Mask) {
    if scheme == Scheme::Bilinear {
        return mask.add(vertex, 1.0);
    }
    let Scratch { ring, around, .. } = scratch;
    level.topology.ring(vertex, ring);
    around.read(level, ring);
    for (class, after, share) in around.rules() {
        if share == 0.0 {
            continue;
        }
        match class {
            VertexClass::Smooth | VertexClass::Dart => smooth_vertex(level, scheme, ring, share, mask),
            VertexClass::Crease => {
                let [one, other] = around.crease_edges(after);
                mask.add(vertex, 0.75 * share);
                mask.add(ring.far[one], 0.125 * share);
                mask.add(ring.far[other], 0.125 * share);
            }
            VertexClass::Corner => mask.add(vertex, share),
        }
    }
}

fn smooth_vertex(level: &Level, scheme: Scheme, ring: &Ring, share: f64, mask: &mut Mask) {
    let n = f64::from(index(ring.valence()));
    if scheme == Scheme::Loop {
        let weight = loop_weight(ring.valence());
        mask.add(ring.vertex, share * (1.0 - n * weight));
        ring.far.iter().for_each(|far| mask.add(*far, share * weight));
        return;
    }
    let weight = share / (n * n);
    mask.add(ring.vertex, share * (n - 2.0) / n);
    ring.far.iter().for_each(|far| mask.add(*far, weight));
    for corner in &ring.corners {
        mask.add_face(level, level.topology.corner_face[*corner as usize], weight);
    }
}

/// The mask of the vertex on an edge.
pub(super) fn edge(level: &Level, scheme: Scheme, edge: u32, mask: &mut Mask) {
    let [a, b] = level.topology.ends(edge);
    let sharpness = if scheme == Scheme::Bilinear { 1.0 } else { level.edge_sharpness(edge).min(1.0) };
    if sharpness > 0.0 {
        mask.add(a, 0.5 * sharpness);
        mask.add(b, 0.5 * sharpness);
    }
    if sharpness == 1.0 {
        return;
    }
    let share = 1.0 - sharpness;
    let topology = &level.topology;
    let corner = topology.edge_corner[edge as usize];
    let sides = [corner, topology.twin[corner as usize]];
    debug_assert!(sides[1] != NONE, "borders are sharp");
    if scheme == Scheme::Loop {
        mask.add(a, 0.375 * share);
        mask.add(b, 0.375 * share);
        sides
            .into_iter()
            .for_each(|side| mask.add(topology.corner_vertex[topology.before(side) as usize], 0.125 * share));
        return;
    }
    mask.add(a, 0.25 * share);
    mask.add(b, 0.25 * share);
    sides
        .into_iter()
        .for_each(|side| mask.add_face(level, topology.corner_face[side as usize], 0.25 * share));
}
