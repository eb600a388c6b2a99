//! Texture coordinates from where a surface is and how it faces, rather than from its parameters.
//!
//! Promise: seen from outside, with y up, pictures stand upright and are not mirrored; within a triangle they do not jump. A vertex
//! whose triangles are laid from different sides, or on both sides of the seam behind, becomes several; points, normals and
//! triangles stay what they are. Not promised: equal lengths on what is askew to its side, or round a pole.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use crate::geometry::mesh::{self, Mesh, Vertex, VertexIndex};
use crate::geometry::number::{atan2, hypot};
use crate::model::UvMapping;

/// What faces more steeply up or down than this is laid from above or below on a cylinder: the sine of 45 degrees.
const STEEP: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Nearer to the axis than this part of the distance from the origin there is no angle.
const ON_AXIS: f64 = 1e-9;

/// Lays a picture on a mesh. Linear in the triangles.
pub(super) fn lay(mesh: &mut Mesh, mapping: UvMapping) {
    let Mesh { points, vertices, triangles, .. } = mesh;
    let law = match mapping {
        UvMapping::Surface => return,
        UvMapping::Box => from_six_sides,
        UvMapping::Cylinder => around,
        UvMapping::Sphere => as_globe,
    };
    let mut splitter = Splitter { laid: vec![false; vertices.len()], vertices, known: HashMap::new() };
    for corners in triangles {
        let places = corners.map(|corner| {
            let vertex = &splitter.vertices[corner.subscript()];
            points[vertex.point.subscript()]
        });
        let area = (places[1] - places[0]).cross(places[2] - places[0]);
        let facing = area.try_normalize().unwrap_or(splitter.vertices[corners[0].subscript()].normal);
        let all = law(&places, facing);
        for (corner, uv) in corners.iter_mut().zip(all) {
            *corner = splitter.with(*corner, uv);
        }
    }
}

/// Vertices that become several.
struct Splitter<'a> {
    vertices: &'a mut Vec<Vertex>,
    /// Of the vertices that were there, which have their coordinates.
    laid: Vec<bool>,
    /// Only looked up, never walked.
    known: HashMap<(VertexIndex, [u64; 2]), VertexIndex>,
}

impl Splitter<'_> {
    /// A vertex with these coordinates.
    fn with(&mut self, corner: VertexIndex, uv: DVec2) -> VertexIndex {
        let place = corner.subscript();
        if !self.laid[place] {
            self.laid[place] = true;
            self.vertices[place].uv = uv;
        }
        if self.vertices[place].uv == uv {
            return corner;
        }
        *self.known.entry((corner, uv.to_array().map(f64::to_bits))).or_insert_with(|| {
            self.vertices.push(Vertex { uv, ..self.vertices[place] });
            VertexIndex(mesh::index(self.vertices.len() - 1))
        })
    }
}

fn from_six_sides(places: &[DVec3; 3], facing: DVec3) -> [DVec2; 3] {
    let steep = facing.abs();
    // Of sides that a triangle faces alike the first: up and down, left and right, front and back.
    let axis = if steep.y >= steep.x && steep.y >= steep.z {
        1
    } else if steep.x >= steep.z {
        0
    } else {
        2
    };
    let sign = if facing[axis] < 0.0 { -1.0 } else { 1.0 };
    places.map(|place| match axis {
        0 => DVec2::new(-sign * place.z, -place.y),
        1 => DVec2::new(place.x, sign * place.z),
        _ => DVec2::new(sign * place.x, -place.y),
    })
}

fn around(places: &[DVec3; 3], facing: DVec3) -> [DVec2; 3] {
    if facing.y.abs() > STEEP {
        return from_six_sides(places, facing);
    }
    let turns = turns(places);
    core::array::from_fn(|corner| DVec2::new(turns[corner], -places[corner].y))
}

fn as_globe(places: &[DVec3; 3], _: DVec3) -> [DVec2; 3] {
    let turns = turns(places);
    core::array::from_fn(|corner| {
        let place = places[corner];
        let north = atan2(place.y, hypot(place.x, place.z)) / core::f64::consts::PI;
        DVec2::new(turns[corner], 0.5 - north)
    })
}

/// How far around the y axis corners are, in turns from behind, the front being half of one; all within half a turn of the middle. A corner
/// on the axis is where the others are.
fn turns(places: &[DVec3; 3]) -> [f64; 3] {
    let turn = |place: DVec3| {
        let far = hypot(place.x, place.z);
        (far > ON_AXIS * place.length()).then(|| atan2(place.x, place.z) / core::f64::consts::TAU + 0.5)
    };
    let middle = (places[0] + places[1] + places[2]) / 3.0;
    let known = places.map(turn);
    let about = turn(middle).or(known.into_iter().flatten().next()).unwrap_or(0.5);
    let near = |own: f64| own - (own - about).round();
    let laid = known.map(|own| own.map(near));
    let count = laid.iter().flatten().count();
    let mean = if count == 0 {
        about
    } else {
        laid.iter().flatten().sum::<f64>() / f64::from(u32::try_from(count).unwrap_or(1))
    };
    laid.map(|own| own.unwrap_or(mean))
}
