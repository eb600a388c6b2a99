//! The five Platonic solids, by closed forms.
//!
//! Coordinates are those of Euclid's constructions, Elements XIII, in the form of H. S. M. Coxeter, Regular
//! Polytopes (3rd edition, 1973), section 3.7: corners of a cube, and the golden section for the other two. A face
//! is the set of corners that lie farthest in the direction of a corner of the dual solid.

use glam::{DMat3, DVec2, DVec3};

use crate::geometry::mesh::{PolygonMesh, index};
use crate::geometry::number::atan2;

/// The golden section, (1 + sqrt 5) / 2.
const GOLDEN: f64 = 1.618_033_988_749_895;

/// A Platonic solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platonic {
    /// Four triangles.
    Tetrahedron,
    /// Six squares.
    Cube,
    /// Eight triangles.
    Octahedron,
    /// Twelve pentagons.
    Dodecahedron,
    /// Twenty triangles.
    Icosahedron,
}

/// How large a Platonic solid is; all in one unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlatonicSize {
    /// Distance from the middle to each corner.
    Circumradius(f64),
    /// Length of each edge.
    Edge(f64),
    /// Distance from the middle to each face.
    Inradius(f64),
}

/// What of a Platonic solid is lowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pose {
    /// Its axes of symmetry lie along x, y and z as its closed form has them.
    Axes,
    /// A face.
    Face,
    /// An edge, along x.
    Edge,
    /// A corner.
    Vertex,
}

impl Platonic {
    /// All five, by their number of faces.
    pub const ALL: [Self; 5] =
        [Self::Tetrahedron, Self::Cube, Self::Octahedron, Self::Dodecahedron, Self::Icosahedron];

    /// The solid whose corners stand over the middles of this one's faces.
    #[must_use]
    pub const fn dual(self) -> Self {
        match self {
            Self::Tetrahedron => Self::Tetrahedron,
            Self::Cube => Self::Octahedron,
            Self::Octahedron => Self::Cube,
            Self::Dodecahedron => Self::Icosahedron,
            Self::Icosahedron => Self::Dodecahedron,
        }
    }

    /// Distance from the middle to each corner of the solid of a size.
    #[must_use]
    pub fn circumradius(self, size: PlatonicSize) -> f64 {
        // Radius, edge and inradius of the closed forms below.
        let golden_radius = (1.0 + GOLDEN * GOLDEN).sqrt();
        let (third, eighth) = (3.0_f64.sqrt(), 2.0 * 2.0_f64.sqrt());
        let (radius, edge, inradius) = match self {
            Self::Tetrahedron => (third, eighth, 1.0 / third),
            Self::Cube => (third, 2.0, 1.0),
            Self::Octahedron => (1.0, 2.0_f64.sqrt(), 1.0 / third),
            Self::Dodecahedron => (third, 2.0 / GOLDEN, (1.0 + GOLDEN) / golden_radius),
            Self::Icosahedron => (golden_radius, 2.0, (1.0 + GOLDEN) / third),
        };
        match size {
            PlatonicSize::Circumradius(given) => given,
            PlatonicSize::Edge(given) => given / edge * radius,
            PlatonicSize::Inradius(given) => given / inradius * radius,
        }
    }

    /// Directions of the corners, of one length; even permutations of the coordinates in the order x, y, z.
    #[must_use]
    pub fn corners(self) -> Vec<DVec3> {
        let signs = [-1.0, 1.0];
        let cube = || {
            signs
                .into_iter()
                .flat_map(move |x| signs.into_iter().flat_map(move |y| signs.map(|z| DVec3::new(x, y, z))))
        };
        let cyclic = |y: f64, z: f64| {
            let pairs = signs.into_iter().flat_map(move |b| signs.map(|c| (b * y, c * z)));
            pairs.flat_map(|(b, c)| [DVec3::new(0.0, b, c), DVec3::new(c, 0.0, b), DVec3::new(b, c, 0.0)])
        };
        match self {
            Self::Tetrahedron => cube().filter(|corner| corner.element_product() > 0.0).collect(),
            Self::Cube => cube().collect(),
            Self::Octahedron => {
                vec![DVec3::NEG_X, DVec3::X, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_Z, DVec3::Z]
            }
            Self::Dodecahedron => cube().chain(cyclic(GOLDEN, 1.0 / GOLDEN)).collect(),
            Self::Icosahedron => cyclic(1.0, GOLDEN).collect(),
        }
    }

    /// Corners of each face, counter-clockwise seen from outside, the least first.
    #[must_use]
    pub fn faces(self) -> Vec<Vec<u32>> {
        let corners = self.corners();
        // The tetrahedron is its own dual turned upside down.
        let sense = if self == Self::Tetrahedron { -1.0 } else { 1.0 };
        let directions = self.dual().corners().into_iter().map(|direction| direction * sense);
        directions.map(|direction| face(&corners, direction)).collect()
    }
}

fn face(corners: &[DVec3], direction: DVec3) -> Vec<u32> {
    let reach = corners.iter().map(|corner| corner.dot(direction)).fold(0.0, f64::max);
    // The next plane of corners is far behind: in all five its reach is less than half.
    let on: Vec<usize> = (0..corners.len()).filter(|&k| corners[k].dot(direction) > 0.9 * reach).collect();
    let right = corners[on[0]].reject_from(direction);
    let up = direction.cross(right);
    let angle = |k: usize| {
        let angle = atan2(corners[k].dot(up), corners[k].dot(right) * direction.length());
        if k == on[0] { 0.0 } else { angle.rem_euclid(core::f64::consts::TAU) }
    };
    let mut turned: Vec<(f64, usize)> = on.iter().map(|&k| (angle(k), k)).collect();
    turned.sort_by(|a, b| a.0.total_cmp(&b.0));
    turned.into_iter().map(|(_, k)| index(k)).collect()
}

/// A Platonic solid about the origin. Each face has the same place in the texture: a regular polygon that stands on
/// the edge that is lowest on the solid.
#[must_use]
pub fn platonic(solid: Platonic, size: PlatonicSize, pose: Pose) -> PolygonMesh {
    let corners = solid.corners();
    let turn = rotation(solid, &corners, pose);
    let scale = solid.circumradius(size) / corners[0].length();
    let mut mesh = PolygonMesh {
        points: corners.iter().map(|corner| turn * (*corner * scale)).collect(),
        ..PolygonMesh::default()
    };
    let faces = solid.faces();
    mesh.uvs = regular_polygon(faces[0].len());
    for mut corners in faces {
        let lowest = lowest_edge(&mesh.points, &corners);
        corners.rotate_left(lowest);
        mesh.push_face(&[&corners], None, 0);
        mesh.corner_uvs.extend(0..index(corners.len()));
    }
    mesh
}

fn lowest_edge(points: &[DVec3], face: &[u32]) -> usize {
    let size = points[0].length();
    let height = |k: usize| {
        let ends = [face[k], face[(k + 1) % face.len()]];
        let middle: f64 = ends.iter().map(|corner| points[*corner as usize].y).sum();
        // Rounded, so that edges at one height are told apart by their order alone.
        (middle / size * 1e9).round()
    };
    (0..face.len()).min_by(|a, b| height(*a).total_cmp(&height(*b))).unwrap_or(0)
}

/// Texture coordinates of a regular polygon on its first edge, as large as the texture and in its middle.
fn regular_polygon(corners: usize) -> Vec<DVec2> {
    let turn = 360.0 / f64::from(index(corners));
    let places: Vec<DVec2> = (0..index(corners))
        .map(|k| {
            let angle = -90.0 - turn / 2.0 + turn * f64::from(k);
            let (sin, cos) = crate::geometry::number::sin_cos_degrees(angle);
            DVec2::new(cos, -sin)
        })
        .collect();
    let low = places.iter().copied().reduce(DVec2::min).unwrap_or_default();
    let high = places.iter().copied().reduce(DVec2::max).unwrap_or_default();
    let size = (high - low).max_element();
    places.iter().map(|place| (*place - (low + high) / 2.0) / size + 0.5).collect()
}

/// The turn that brings a face, an edge or a corner down.
fn rotation(solid: Platonic, corners: &[DVec3], pose: Pose) -> DMat3 {
    let first = solid.faces().swap_remove(0);
    let [a, b] = [corners[first[0] as usize], corners[first[1] as usize]];
    let middle: DVec3 = first.iter().map(|corner| corners[*corner as usize]).sum();
    let (down, along) = match pose {
        Pose::Axes => return DMat3::IDENTITY,
        Pose::Face => (middle, b - a),
        Pose::Edge => (a + b, b - a),
        // Seen from the front the corner has an edge or a face in the middle.
        Pose::Vertex => (a, middle.cross(a)),
    };
    let up = -down.normalize();
    let right = along.reject_from(up).normalize();
    DMat3::from_cols(right, up, right.cross(up)).transpose()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Platonic, PlatonicSize, Pose, platonic};
    use crate::geometry::mesh::polygon_facts::measure;

    const POSES: [Pose; 4] = [Pose::Axes, Pose::Face, Pose::Edge, Pose::Vertex];

    /// Corners, edges, faces, corners of a face, and faces at a corner: Euclid, Elements XIII.18.
    const COUNTS: [[u64; 4]; 5] =
        [[4, 6, 4, 3], [8, 12, 6, 4], [6, 12, 8, 3], [20, 30, 12, 5], [12, 30, 20, 3]];

    #[test]
    fn counts_are_those_of_euclid() {
        for (solid, [vertices, edges, faces, sides]) in Platonic::ALL.into_iter().zip(COUNTS) {
            for pose in POSES {
                let mesh = platonic(solid, PlatonicSize::Edge(2.0), pose);
                assert_eq!(mesh.validate(), Ok(()));
                let facts = measure(&mesh);
                assert_eq!((facts.vertices, facts.edges, facts.faces), (vertices, edges, faces), "{solid:?}");
                assert_eq!((facts.most_corners, facts.euler, facts.genus), (sides, 2, Some(0)));
                assert!(
                    facts.closed && facts.simple && facts.planar && facts.convex_faces && facts.connected
                );
            }
        }
    }

    #[test]
    fn edges_radii_and_faces_are_equal_and_of_the_size_asked_for() {
        for solid in Platonic::ALL {
            for pose in POSES {
                for size in
                    [PlatonicSize::Circumradius(3.0), PlatonicSize::Edge(3.0), PlatonicSize::Inradius(3.0)]
                {
                    let mesh = platonic(solid, size, pose);
                    let mut edges = Vec::new();
                    let mut inside = Vec::new();
                    for face in 0..mesh.faces.len() {
                        let corners: Vec<DVec3> = mesh.corners_of(face).map(|k| mesh.position(k)).collect();
                        edges.extend(
                            (0..corners.len()).map(|k| corners[k].distance(corners[(k + 1) % corners.len()])),
                        );
                        let normal = mesh.newell(face).normalize();
                        inside.extend(corners.iter().map(|corner| corner.dot(normal)));
                    }
                    let radii: Vec<f64> = mesh.points.iter().map(|point| point.length()).collect();
                    for all in [&edges, &inside, &radii] {
                        assert!(all.iter().all(|one| (one - all[0]).abs() < 1e-14 * radii[0] * 3.0));
                    }
                    let given = match size {
                        PlatonicSize::Circumradius(_) => radii[0],
                        PlatonicSize::Edge(_) => edges[0],
                        PlatonicSize::Inradius(_) => inside[0],
                    };
                    assert!((given - 3.0).abs() < 1e-14 * 3.0 * 3.0, "{solid:?} {given}");
                }
            }
        }
    }

    #[test]
    fn poses_bring_a_face_an_edge_or_a_corner_down() {
        for solid in Platonic::ALL {
            let lowest = |pose: Pose| {
                let mesh = platonic(solid, PlatonicSize::Circumradius(1.0), pose);
                let bottom = mesh.points.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
                (bottom, mesh.points.iter().filter(|point| point.y < bottom + 1e-9).count())
            };
            let sides = solid.faces()[0].len();
            assert_eq!(lowest(Pose::Face).1, sides);
            assert_eq!(lowest(Pose::Edge).1, 2);
            assert_eq!(lowest(Pose::Vertex).1, 1);
            assert!((lowest(Pose::Vertex).0 + 1.0).abs() < 1e-15);
            let inradius = 1.0 / solid.circumradius(PlatonicSize::Inradius(1.0));
            assert!((lowest(Pose::Face).0 + inradius).abs() < 1e-15);
        }
    }

    #[test]
    fn textures_stand_upright_on_each_face() {
        let mesh = platonic(Platonic::Cube, PlatonicSize::Edge(1.0), Pose::Axes);
        for face in 0..6 {
            let corners: Vec<usize> = mesh.corners_of(face).collect();
            let uv = |k: usize| mesh.uvs[mesh.corner_uvs[corners[k]] as usize];
            // Lower left, lower right, upper right, upper left; v grows downwards.
            for (k, (u, v)) in [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].into_iter().enumerate() {
                assert!(uv(k).distance(glam::DVec2::new(u, v)) < 1e-15);
            }
            assert!(mesh.position(corners[0]).y <= mesh.position(corners[2]).y);
        }
    }
}
