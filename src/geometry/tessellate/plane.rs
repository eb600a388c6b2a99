//! Flat rectangles.

use glam::{DVec2, DVec3};

use super::{Detail, Deviation, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};

/// A flat rectangle in the x, z plane about the origin that looks to +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatPlane {
    /// Lengths along x and z, metres.
    pub size: DVec2,
}

/// Two triangles, or a grid; the texture's up is -z. Anchor source 0.
///
/// # Errors
/// When the limit would be passed.
pub fn plane(shape: &FlatPlane, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let (columns, rows) = match detail.density {
        SurfaceDensity::Grid { u, v } => (u.max(1), v.max(1)),
        SurfaceDensity::Tolerance(_) => (1, 1),
    };
    detail.allow(2 * u64::from(columns) * u64::from(rows))?;
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let part = DVec2::new(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
            // Symmetric to the last bit.
            let place = (part * 2.0 - 1.0) * shape.size / 2.0;
            let point = PointIndex(mesh::index(mesh.points.len()));
            mesh.points.push(DVec3::new(place.x, 0.0, place.y));
            let uv = if detail.uv { part } else { DVec2::ZERO };
            let anchor = Anchor { source: 0, u: part.x, v: part.y };
            mesh.vertices.push(Vertex { point, normal: DVec3::Y, uv, color: Color::WHITE, anchor });
        }
    }
    let at = |row: u32, column: u32| VertexIndex(row * (columns + 1) + column);
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [at(row + 1, column), at(row + 1, column + 1)];
            let [c, d] = [at(row, column + 1), at(row, column)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
    Ok(Tessellation { mesh, deviation: Deviation::NONE })
}
