//! Boxes.

use glam::{DVec2, DVec3};

use super::{Deviation, Tessellation};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};

/// The box of `size` about `center`: 8 points, 6 faces with their own vertices, each face the whole texture.
#[must_use]
pub fn cuboid(size: DVec3, center: DVec3, uv: bool) -> Tessellation {
    let mut mesh = Mesh::default();
    for corner in 0..8u32 {
        let side = |bit: u32| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
        mesh.points.push(center + size * DVec3::new(side(0), side(1), side(2)));
    }
    for (face, (normal, right)) in FACES.into_iter().enumerate() {
        let up = normal.cross(right);
        let base = mesh::index(mesh.vertices.len());
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let corner = normal + right * x + up * y;
            let bit = |value: f64, bit: u32| u32::from(value > 0.0) << bit;
            let point = bit(corner.x, 0) | bit(corner.y, 1) | bit(corner.z, 2);
            let place = DVec2::new((x + 1.0) / 2.0, (1.0 - y) / 2.0);
            mesh.vertices.push(Vertex {
                point: PointIndex(point),
                normal,
                uv: if uv { place } else { DVec2::ZERO },
                color: Color::WHITE,
                anchor: Anchor { source: mesh::index(face), u: place.x, v: place.y },
            });
        }
        let corner = |k: u32| VertexIndex(base + k);
        mesh.triangles.push([corner(0), corner(1), corner(2)]);
        mesh.triangles.push([corner(0), corner(2), corner(3)]);
    }
    mesh.runs.push(Run { origin: 0, end: 12 });
    Tessellation { mesh, deviation: Deviation::NONE }
}

/// Outward normal of each face and the direction to the right for who looks at it.
const FACES: [(DVec3, DVec3); 6] = [
    (DVec3::X, DVec3::NEG_Z),
    (DVec3::NEG_X, DVec3::Z),
    (DVec3::Y, DVec3::X),
    (DVec3::NEG_Y, DVec3::X),
    (DVec3::Z, DVec3::X),
    (DVec3::NEG_Z, DVec3::NEG_X),
];
