//! Bodies without a history of surfaces: convex hulls, and flat faces pushed out.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::{HalfSpace, SolidFault, engine};
use crate::geometry::mesh::convert::{ConvertOptions, Shading, convert};
use crate::geometry::mesh::polygon::Face;
use crate::geometry::mesh::{Anchor, Mesh, PointIndex, PolygonMesh, VertexIndex, index};
use crate::geometry::number::Bounds;

/// The smallest convex body around some points. Edges that turn by more than `crease_angle` degrees look sharp.
/// Expected O(n log n).
///
/// # Errors
/// Points that all lie on one plane.
pub fn hull(points: &[DVec3], crease_angle: f64) -> Result<Mesh, SolidFault> {
    let (points, triangles) = engine::hull(points)?;
    skin(points, &triangles, crease_angle)
}

/// A mesh of bare triangles: normals by the angles of its edges, texture coordinates from 0 to 1 over its box, each
/// triangle seen along the axis that it faces.
pub(super) fn skin(
    points: Vec<DVec3>,
    triangles: &[[u32; 3]],
    crease_angle: f64,
) -> Result<Mesh, SolidFault> {
    let bounds = Bounds::of_points(points.iter().copied());
    let size = (bounds.max - bounds.min).max_element();
    let size = if size > 0.0 { size } else { 1.0 };
    let mut mesh = PolygonMesh { points, ..PolygonMesh::default() };
    let mut known: HashMap<(u32, u8), u32> = HashMap::new();
    for corners in triangles {
        let [a, b, c] = corners.map(|point| mesh.points[point as usize]);
        let axis = faced((b - a).cross(c - a));
        for corner in corners {
            mesh.corners.push(PointIndex(*corner));
            let place = (mesh.points[*corner as usize] - bounds.min) / size;
            let uvs = &mut mesh.uvs;
            mesh.corner_uvs.push(*known.entry((*corner, axis)).or_insert_with(|| {
                uvs.push(seen(place, axis));
                index(uvs.len() - 1)
            }));
        }
        mesh.loop_ends.push(index(mesh.corners.len()));
        mesh.faces.push(Face { loops_end: index(mesh.loop_ends.len()), material: None, smoothing: 0 });
    }
    let options = ConvertOptions { shading: Shading::Auto, crease_angle };
    let made = convert(&mesh, &options).map_err(|error| SolidFault::Engine(error.to_string()))?;
    Ok(made.mesh)
}

/// The axis that a direction is nearest to: 0 to 2 forward, 3 to 5 backward.
fn faced(normal: DVec3) -> u8 {
    let size = normal.abs();
    let (axis, value) = if size.x >= size.y.max(size.z) {
        (0, normal.x)
    } else if size.y >= size.z {
        (1, normal.y)
    } else {
        (2, normal.z)
    };
    if value < 0.0 { axis + 3 } else { axis }
}

/// A place of the unit cube as it is seen by who looks against an axis.
fn seen(place: DVec3, axis: u8) -> DVec2 {
    let DVec3 { x, y, z } = place;
    match axis {
        0 => DVec2::new(1.0 - z, 1.0 - y),
        1 => DVec2::new(x, z),
        2 => DVec2::new(x, 1.0 - y),
        3 => DVec2::new(z, 1.0 - y),
        4 => DVec2::new(x, 1.0 - z),
        _ => DVec2::new(1.0 - x, 1.0 - y),
    }
}

/// The flat faces of a mesh that lie in a plane and look the same way, pushed out of it by a depth: closed bodies that
/// touch the mesh in those faces. Normals and anchors mean nothing.
///
/// # Errors
/// No face lies there; `number` tells which plane it was.
pub fn push_out(mesh: &Mesh, plane: &HalfSpace, depth: f64, number: usize) -> Result<Mesh, SolidFault> {
    /// Part of the reach of a mesh within which a face lies in a plane.
    const NEAR: f64 = 1e-9;
    let near = NEAR * (mesh.bounds().reach() + plane.point.abs().max_element());
    let points_of =
        |triangle: &[VertexIndex; 3]| triangle.map(|vertex| mesh.vertices[vertex.subscript()].point);
    let lies = |corners: &[PointIndex; 3]| {
        let [a, b, c] = corners.map(|point| mesh.points[point.subscript()]);
        let flat = [a, b, c].iter().all(|place| plane.depth(*place).abs() <= near);
        flat && (b - a).cross(c - a).dot(plane.normal) > 0.0
    };
    let faces: Vec<[PointIndex; 3]> = mesh.triangles.iter().map(points_of).filter(lies).collect();
    if faces.is_empty() {
        let (point, normal) = (plane.point, plane.normal);
        return Err(SolidFault::NoFace { number, point, normal });
    }
    let mut lower: HashMap<PointIndex, u32> = HashMap::new();
    let mut points = Vec::new();
    let mut base: Vec<[u32; 3]> = Vec::new();
    for face in &faces {
        base.push(face.map(|point| {
            *lower.entry(point).or_insert_with(|| {
                points.push(mesh.points[point.subscript()]);
                index(points.len() - 1)
            })
        }));
    }
    let count = index(points.len());
    let raised: Vec<DVec3> = points.iter().map(|point| *point + plane.normal * depth).collect();
    points.extend(raised);
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut sides: Vec<(u32, u32)> =
        base.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]).collect();
    sides.sort_unstable();
    for [a, b, c] in &base {
        triangles.push([*a, *c, *b]);
        triangles.push([a + count, b + count, c + count]);
    }
    for (a, b) in &sides {
        if sides.binary_search(&(*b, *a)).is_err() {
            triangles.push([*a, *b, b + count]);
            triangles.push([*a, b + count, a + count]);
        }
    }
    let mut made = skin(points, &triangles, 0.0)?;
    made.vertices.iter_mut().for_each(|vertex| vertex.anchor = Anchor::default());
    Ok(made)
}
