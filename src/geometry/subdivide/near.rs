//! How far a mesh lies from the limit surface, sampled on each edge and across each face.
//!
//! Along an edge the limit is followed by the cubic that has the limit's ends and normals: its middle lies off the chord by
//! an eighth of the chord's length along the change of the normals. Along creases and borders, which are splines, an
//! eighth of the greatest second difference bounds the distance.

use glam::DVec3;

use super::level::Level;
use super::limit::{Limit, position};
use super::topology::{NONE, Ring};
use crate::geometry::mesh::index;

/// Put on what is sampled, for what lies between the samples.
const MARGIN: f64 = 1.25;

/// The greatest distance of the limit from the mesh of a level, vertices put on their limits or left where they are.
/// O(n).
pub(super) fn distance(level: &Level, limit: &Limit, on_limit: bool) -> f64 {
    let moved = if on_limit { 0.0 } else { moves(level, limit) };
    let along = (0..index(level.topology.edges())).map(|edge| {
        if level.edge_sharpness(edge) > 0.0 {
            bend_of_crease(level, edge)
        } else {
            bend_of_edge(level, limit, edge)
        }
    });
    let across = diagonals(level, limit).chain(middles(level, limit));
    MARGIN * along.chain(across).fold(0.0, f64::max) + moved
}

/// The greatest way of a vertex to its limit.
fn moves(level: &Level, limit: &Limit) -> f64 {
    let ways = (0..index(level.topology.vertices()))
        .map(|vertex| position(&level.channels[0], vertex).distance(position(&limit.channels[0], vertex)));
    ways.fold(0.0, f64::max)
}

fn bend_of_crease(level: &Level, edge: u32) -> f64 {
    let mut ring = Ring::default();
    let bends = level.topology.ends(edge).map(|end| {
        level.topology.ring(end, &mut ring);
        if level.vertex_sharpness(end) > 0.0 {
            return 0.0;
        }
        let sharp: Vec<usize> =
            (0..ring.edges.len()).filter(|edge| level.edge_sharpness(ring.edges[*edge]) > 0.0).collect();
        let [one, other] = sharp[..] else { return 0.0 };
        let at = |vertex: u32| position(&level.channels[0], vertex);
        (at(ring.far[one]) - 2.0 * at(end) + at(ring.far[other])).length() / 8.0
    });
    bends[0].max(bends[1])
}

/// How far the limit lies off the middle of a chord, by the side.
fn bend(limit: &Limit, [from, to]: [(u32, u32); 2]) -> f64 {
    let chord = position(&limit.channels[0], to.0) - position(&limit.channels[0], from.0);
    let normal = |corner: u32| limit.normals[limit.corner_normals[corner as usize] as usize];
    let turn: DVec3 = normal(to.1) - normal(from.1);
    chord.dot(turn) / 8.0
}

fn bend_of_edge(level: &Level, limit: &Limit, edge: u32) -> f64 {
    let topology = &level.topology;
    let one = topology.edge_corner[edge as usize];
    let sides = [one, topology.twin[one as usize]];
    let of_side = |corner: &u32| {
        let next = topology.next(*corner);
        let at = |corner: u32| (topology.corner_vertex[corner as usize], corner);
        bend(limit, [at(*corner), at(next)]).abs()
    };
    sides.iter().filter(|side| **side != NONE).map(of_side).fold(0.0, f64::max)
}

/// Across faces of four corners.
fn diagonals<'a>(level: &'a Level, limit: &'a Limit) -> impl Iterator<Item = f64> + 'a {
    let topology = &level.topology;
    let quads = (0..topology.faces()).map(|face| topology.face_range(face)).filter(|range| range.len() == 4);
    quads.flat_map(move |range| {
        let at = |step: usize| (topology.corner_vertex[range.start + step], index(range.start + step));
        [bend(limit, [at(0), at(2)]).abs(), bend(limit, [at(1), at(3)]).abs()]
    })
}

/// In the middles of triangles: of a quadric over a triangle, 4/9 of the sum over its sides.
fn middles<'a>(level: &'a Level, limit: &'a Limit) -> impl Iterator<Item = f64> + 'a {
    let topology = &level.topology;
    let triangles =
        (0..topology.faces()).map(|face| topology.face_range(face)).filter(|range| range.len() == 3);
    triangles.map(move |range| {
        let at = |step: usize| {
            let corner = range.start + step % 3;
            (topology.corner_vertex[corner], index(corner))
        };
        (0..3).map(|step| bend(limit, [at(step), at(step + 1)])).sum::<f64>().abs() * 4.0 / 9.0
    })
}
