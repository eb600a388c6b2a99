//! Colors of vertices: laws of shapes at the places of their vertices.
//!
//! A color multiplies what a part of the shape, or its file, has already.

use glam::DVec3;

use super::RealizeError;
use super::shape::Made;
use crate::geometry::field::AnyField;
use crate::geometry::mesh::{Color, Mesh, PolygonMesh, Wire, index};
use crate::model::VertexColor;

/// Colors the vertices of a shape that has not been placed yet.
pub(super) fn color(made: &mut Made, law: &VertexColor) -> Result<(), RealizeError> {
    let mesh = &mut made.mesh;
    for vertex in &mut mesh.vertices {
        let place = mesh.points[vertex.point.subscript()];
        vertex.color = vertex.color.times(at(law, place, vertex.normal)?);
    }
    for point in &mut made.wire.points {
        point.color = point.color.times(at(law, point.position, DVec3::ZERO)?);
    }
    Ok(())
}

/// Colors the vertices of the surface of a skeleton by the shares of its elements there; what takes away has none.
pub(super) fn blend(made: &mut Made, field: &AnyField, colors: &[[f64; 4]]) {
    if colors.is_empty() {
        return;
    }
    for vertex in &mut made.mesh.vertices {
        let shares = field.shares(made.mesh.points[vertex.point.subscript()]);
        let shares = || shares.iter().map(|share| share.max(0.0));
        let total: f64 = shares().sum();
        if total > 0.0 {
            let part = |part: usize| {
                shares().zip(colors).map(|(share, color)| share * color[part]).sum::<f64>() / total
            };
            vertex.color = Color::held([part(0), part(1), part(2), part(3)]);
        }
    }
}

/// Colors the corners of polygons, by the mean normals of the faces around their points.
pub(super) fn color_polygons(mesh: &mut PolygonMesh, law: &VertexColor) -> Result<(), RealizeError> {
    let mut normals = vec![DVec3::ZERO; mesh.points.len()];
    for face in 0..mesh.faces.len() {
        let normal = mesh.newell(face);
        for corner in mesh.corners_of(face) {
            normals[mesh.corners[corner].subscript()] += normal;
        }
    }
    let places = mesh.points.iter().zip(normals);
    let colors: Result<Vec<Color>, RealizeError> =
        places.map(|(place, normal)| at(law, *place, normal.normalize_or_zero())).collect();
    let colors = colors?;
    let before = std::mem::take(&mut mesh.corner_colors);
    if before.is_empty() {
        mesh.corner_colors = mesh.corners.iter().map(|point| point.0).collect();
        mesh.colors = colors;
        return Ok(());
    }
    let own = |(point, before): (&crate::geometry::mesh::PointIndex, u32)| {
        mesh.colors[before as usize].times(colors[point.subscript()])
    };
    mesh.colors = mesh.corners.iter().zip(before).map(own).collect();
    mesh.corner_colors = (0..index(mesh.corners.len())).collect();
    Ok(())
}

fn at(law: &VertexColor, place: DVec3, normal: DVec3) -> Result<Color, RealizeError> {
    law.at(place, normal).ok_or(RealizeError::NoColor { place: law.space.transform_point3(place) })
}

/// Whether any vertex has a color.
pub(super) fn is_colored(mesh: &Mesh, wire: &Wire) -> bool {
    mesh.vertices.iter().any(|vertex| vertex.color != Color::WHITE)
        || wire.points.iter().any(|point| point.color != Color::WHITE)
}
