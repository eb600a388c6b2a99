//! The limit of schemes that cut corners: the middles of their faces.
//!
//! The masks of Doo-Sabin and mid-edge keep the middle of each face, so it lies on the limit surface; the two tangents
//! there are the first waves around the face, which shrink alike. On borders the middles of the edges are on the limit
//! curve. So the limit mesh has a vertex for each face and each border edge, and a face for each vertex.

use std::f64::consts::TAU;

use glam::DVec3;

use super::level::{Channel, Level};
use super::limit::{Limit, position};
use super::mask::{Mask, apply};
use super::topology::{NONE, Ring, Topology};
use crate::geometry::mesh::index;
use crate::geometry::number::{cos, sin};

/// The limit mesh of a level of a scheme that cuts corners. O(n).
#[must_use]
pub fn dual_limit(level: &Level) -> (Topology, Limit) {
    let topology = &level.topology;
    let mut made = Limit {
        channels: level
            .channels
            .iter()
            .map(|channel| Channel { width: channel.width, values: Vec::new() })
            .collect(),
        ..Limit::default()
    };
    let mut mask = Mask::default();
    for face in 0..index(topology.faces()) {
        mask.0.clear();
        mask.add_face(level, face, 1.0);
        apply(&mask, &level.channels, &mut made.channels);
        made.normals.push(normal(level, face));
    }
    let mut middle = vec![NONE; topology.edges()];
    for edge in (0..index(topology.edges())).filter(|edge| topology.is_border(*edge)) {
        let [a, b] = topology.ends(edge);
        mask.0.clear();
        mask.add(a, 0.5);
        mask.add(b, 0.5);
        middle[edge as usize] = index(made.normals.len());
        apply(&mask, &level.channels, &mut made.channels);
        // The plane of the one face beside it; the limit's own is not known in closed form.
        let face = topology.corner_face[topology.edge_corner[edge as usize] as usize];
        made.normals.push(made.normals[face as usize]);
    }
    let (mut start, mut corners, mut ring) = (vec![0], Vec::new(), Ring::default());
    for vertex in 0..index(topology.vertices()) {
        topology.ring(vertex, &mut ring);
        corners.extend(ring.corners.iter().map(|corner| topology.corner_face[*corner as usize]));
        if !ring.is_closed() {
            corners.push(middle[ring.edges[ring.edges.len() - 1] as usize]);
            corners.push(middle[ring.edges[0] as usize]);
        }
        start.push(index(corners.len()));
    }
    made.corner_normals = corners.clone();
    let dual = Topology::of_faces(start, corners, index(made.normals.len()))
        .expect("the dual of a manifold is a manifold");
    (dual, made)
}

fn normal(level: &Level, face: u32) -> DVec3 {
    let corners = level.topology.face(face as usize);
    let turn = TAU / f64::from(index(corners.len()));
    let along = |wave: fn(f64) -> f64| -> DVec3 {
        let places = corners.iter().map(|vertex| position(&level.channels[0], *vertex));
        places.enumerate().map(|(step, place)| place * wave(turn * f64::from(index(step)))).sum()
    };
    along(cos).cross(along(sin)).try_normalize().unwrap_or(DVec3::Y)
}
