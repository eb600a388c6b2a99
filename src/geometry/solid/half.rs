//! Half of space, as a box that is large enough.

use glam::{DVec2, DVec3};

use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex, index};
use crate::geometry::number::Bounds;

/// All points on the side of a plane that its normal points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// A point of the plane.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

impl HalfSpace {
    /// How far a place lies inside.
    #[must_use]
    pub fn depth(&self, place: DVec3) -> f64 {
        (place - self.point).dot(self.normal)
    }

    /// Unit directions along the plane, the first across the second.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 2] {
        let least = self.normal.abs();
        let aside = if least.x <= least.y.min(least.z) {
            DVec3::X
        } else if least.y <= least.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let across = aside.cross(self.normal).normalize();
        [across, self.normal.cross(across)]
    }
}

/// A box that is half of space for whatever lies within some bounds: one of its faces lies in the plane, with texture
/// coordinates from 0 to 1 over the bounds. All anchors have this source.
#[must_use]
pub fn half_space(half: &HalfSpace, bounds: &Bounds, source: u32) -> Mesh {
    let [across, up] = half.axes();
    let middle = bounds.center() - half.normal * half.depth(bounds.center());
    // Beyond everything to all sides, by as much again.
    let size = bounds.diagonal().max(f64::MIN_POSITIVE);
    let deep = half.depth(bounds.center()).abs() + size;
    let corner = |k: usize| {
        let side = |bit: usize| if k >> bit & 1 == 1 { size } else { -size };
        let depth = if k >> 2 & 1 == 1 { deep } else { 0.0 };
        middle + across * side(0) + up * side(1) + half.normal * depth
    };
    /// Corners of the faces, counter-clockwise from outside; the first is the plane's.
    const FACES: [[usize; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut mesh = Mesh { points: (0..8).map(corner).collect(), ..Mesh::default() };
    let normals = [-half.normal, half.normal, -up, up, -across, across];
    for (face, normal) in FACES.iter().zip(normals) {
        let first = index(mesh.vertices.len());
        for corner in face {
            let part = |bit: usize| if corner >> bit & 1 == 1 { 1.5 } else { -0.5 };
            mesh.vertices.push(Vertex {
                point: PointIndex(index(*corner)),
                normal,
                uv: DVec2::new(part(0), 1.0 - part(1)),
                color: Color::WHITE,
                anchor: Anchor { source, u: 0.0, v: 0.0 },
            });
        }
        mesh.triangles.push([first, first + 1, first + 2].map(VertexIndex));
        mesh.triangles.push([first, first + 2, first + 3].map(VertexIndex));
    }
    mesh.runs.push(Run { origin: 0, end: index(mesh.triangles.len()) });
    mesh
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{HalfSpace, half_space};
    use crate::geometry::mesh::topology;
    use crate::geometry::number::Bounds;

    #[test]
    fn the_box_is_closed_outward_and_ends_in_the_plane() {
        let bounds = Bounds { min: DVec3::new(1.0, 2.0, 3.0), max: DVec3::new(2.0, 5.0, 4.0) };
        for normal in [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::new(1.0, -2.0, 0.5).normalize()] {
            let half = HalfSpace { point: DVec3::new(1.5, 3.0, 3.5), normal };
            let mesh = half_space(&half, &bounds, 0);
            let corners = |of: &[crate::geometry::mesh::VertexIndex; 3]| {
                of.map(|v| mesh.vertices[v.subscript()].point.0)
            };
            let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(corners).collect();
            let measured = topology::of_triangles(&triangles, 8).expect("few triangles");
            assert!(measured.closed && measured.manifold && measured.genus == Some(0));
            for (triangle, corners) in mesh.triangles.iter().zip(&triangles) {
                let [a, b, c] = corners.map(|point| mesh.points[point as usize]);
                let normal = (b - a).cross(c - a).normalize();
                assert!(normal.distance(mesh.vertices[triangle[0].subscript()].normal) < 1e-12);
            }
            let flat = mesh.points[..4].iter().map(|place| half.depth(*place).abs()).fold(0.0, f64::max);
            assert!(flat < 1e-14, "{flat}");
            assert!(mesh.points[4..].iter().all(|place| half.depth(*place) > 3.0));
        }
    }
}
