//! Moving, mirroring and joining meshes.

use glam::{DAffine3, DMat3, DVec3};

use crate::geometry::mesh::{Mesh, PointIndex, PolygonMesh, Run, VertexIndex, index};
use crate::geometry::number::Bounds;

impl Mesh {
    /// The smallest box that holds all points.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.points.iter().copied())
    }

    /// Applies an affine map. Normals go by the inverse transpose; a map that mirrors also turns every triangle
    /// around, so that outside stays outside. Under a map that flattens, normals that it destroys are kept.
    pub fn transform(&mut self, map: &DAffine3) {
        for point in &mut self.points {
            *point = map.transform_point3(*point);
        }
        let normals = NormalMap::new(&map.matrix3);
        for vertex in &mut self.vertices {
            vertex.normal = normals.apply(vertex.normal).try_normalize().unwrap_or(vertex.normal);
        }
        if normals.mirrors {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
    }

    /// Adds the triangles of another mesh after its own; the origins of the other are moved up by `origin_offset`,
    /// the length of the table of origins that its own runs refer to.
    ///
    /// # Panics
    /// When the sum has 2^32 points, vertices or triangles; limits are checked before.
    pub fn append(&mut self, other: &Self, origin_offset: u32) {
        let points = index(self.points.len());
        let vertices = index(self.vertices.len());
        let triangles = index(self.triangles.len());
        self.points.extend_from_slice(&other.points);
        self.vertices.extend(other.vertices.iter().map(|vertex| {
            let mut vertex = *vertex;
            vertex.point = PointIndex(vertex.point.0 + points);
            vertex
        }));
        let moved = |triangle: &[VertexIndex; 3]| triangle.map(|vertex| VertexIndex(vertex.0 + vertices));
        self.triangles.extend(other.triangles.iter().map(moved));
        let shifted = |run: &Run| Run { origin: run.origin + origin_offset, end: run.end + triangles };
        self.runs.extend(other.runs.iter().map(shifted));
    }

    /// Copies of this mesh, one for each map, in their order; all refer to the same table of origins.
    #[must_use]
    pub fn array(&self, maps: impl IntoIterator<Item = DAffine3>) -> Self {
        let mut all = Self::default();
        for map in maps {
            let mut copy = self.clone();
            copy.transform(&map);
            all.append(&copy, 0);
        }
        all
    }
}

impl PolygonMesh {
    /// Applies an affine map; see [`Mesh::transform`].
    pub fn transform(&mut self, map: &DAffine3) {
        for point in &mut self.points {
            *point = map.transform_point3(*point);
        }
        let normals = NormalMap::new(&map.matrix3);
        for normal in &mut self.normals {
            *normal = normals.apply(*normal).try_normalize().unwrap_or(*normal);
        }
        if normals.mirrors {
            self.flip();
        }
    }

    /// Turns every loop around. The first corner of a loop stays the first.
    pub fn flip(&mut self) {
        for ring in 0..self.loop_ends.len() {
            let rest = self.corners_of_loop(ring).start + 1..self.corners_of_loop(ring).end;
            self.corners[rest.clone()].reverse();
            for attribute in [&mut self.corner_uvs, &mut self.corner_normals, &mut self.corner_colors] {
                if !attribute.is_empty() {
                    attribute[rest.clone()].reverse();
                }
            }
        }
    }
}

/// How a linear map acts on normals.
pub(crate) struct NormalMap {
    matrix: DMat3,
    /// Whether it turns surfaces inside out.
    pub(crate) mirrors: bool,
}

impl NormalMap {
    /// The cofactor matrix is the inverse transpose times the determinant, and exists for every map.
    pub(crate) fn new(matrix: &DMat3) -> Self {
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
        let mirrors = x.cross(y).dot(z) < 0.0;
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Self { matrix: if mirrors { -cofactors } else { cofactors }, mirrors }
    }

    /// A normal of any length.
    pub(crate) fn apply(&self, normal: DVec3) -> DVec3 {
        self.matrix * normal
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3, DVec3};

    use crate::geometry::mesh::convert::{ConvertOptions, convert};
    use crate::geometry::mesh::{Mesh, PolygonMesh};

    /// A tetrahedron, flat-shaded.
    fn tetrahedron() -> Mesh {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces: [&[u32]; 4] = [&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]];
        convert(&PolygonMesh::from_faces(points, &faces), &ConvertOptions::default()).expect("valid").mesh
    }

    fn corner_positions(mesh: &Mesh, triangle: usize) -> [DVec3; 3] {
        mesh.triangles[triangle]
            .map(|vertex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()])
    }

    fn volume(mesh: &Mesh) -> f64 {
        (0..mesh.triangles.len())
            .map(|triangle| {
                let [a, b, c] = corner_positions(mesh, triangle);
                a.cross(b).dot(c) / 6.0
            })
            .sum()
    }

    #[test]
    fn volume_scales_by_the_size_of_the_determinant_and_normals_stay_outward() {
        let maps = [
            DMat3::from_cols(DVec3::new(2.0, 0.3, 0.0), DVec3::new(0.0, 1.0, 0.5), DVec3::new(0.1, 0.0, 3.0)),
            DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
            DMat3::from_diagonal(DVec3::new(-1.0, -4.0, -0.5)),
        ];
        for matrix in maps {
            let mut mesh = tetrahedron();
            mesh.transform(&DAffine3 { matrix3: matrix, translation: DVec3::new(5.0, -3.0, 2.0) });
            assert!((volume(&mesh) - matrix.determinant().abs() / 6.0).abs() < 1e-12);
            for triangle in 0..4 {
                let [a, b, c] = corner_positions(&mesh, triangle);
                let facing = (b - a).cross(c - a).normalize();
                for vertex in mesh.triangles[triangle] {
                    assert!(mesh.vertices[vertex.subscript()].normal.dot(facing) > 1.0 - 1e-12);
                }
            }
        }
    }

    #[test]
    fn flattening_keeps_normals_finite() {
        let mut mesh = tetrahedron();
        mesh.transform(&DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)));
        assert!(mesh.vertices.iter().all(|vertex| (vertex.normal.length() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn array_is_its_copies_end_to_end() {
        let mesh = tetrahedron();
        let maps = [0.0, 2.0, 4.0].map(|x| DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)));
        let array = mesh.array(maps);
        assert_eq!((array.points.len(), array.triangles.len(), array.runs.len()), (12, 12, 3));
        assert_eq!(
            array.runs.iter().map(|run| (run.origin, run.end)).collect::<Vec<_>>(),
            [(0, 4), (0, 8), (0, 12)]
        );
        assert!((volume(&array) - 0.5).abs() < 1e-12);
        assert_eq!(array.bounds().max, DVec3::new(5.0, 1.0, 1.0));
    }

    #[test]
    fn origins_move_with_append() {
        let mut mesh = tetrahedron();
        mesh.append(&tetrahedron(), 7);
        assert_eq!(mesh.runs[1].origin, 7);
    }

    #[test]
    fn mirrored_polygons_keep_their_first_corners() {
        let mut mesh =
            PolygonMesh::from_faces(vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y], &[&[0, 1, 2, 3]]);
        mesh.corner_uvs = vec![10, 11, 12, 13];
        mesh.transform(&DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0)));
        assert_eq!(mesh.corners.iter().map(|point| point.0).collect::<Vec<_>>(), [0, 3, 2, 1]);
        assert_eq!(mesh.corner_uvs, [10, 13, 12, 11]);
    }
}
