//! The mesh of a body while its faces are added.

use glam::{DVec2, DVec3};

use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};

/// Points and faces.
#[derive(Debug, Default)]
pub(super) struct Shell {
    pub(super) points: Vec<DVec3>,
    vertices: Vec<Vertex>,
    triangles: Vec<[VertexIndex; 3]>,
    /// For each point its vertex on the smooth surface, where faces share vertices.
    shared: Vec<Option<u32>>,
}

/// A face that is to be added.
pub(super) struct Face<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    /// Outward direction, of any length, at a point.
    pub(super) outward: &'a dyn Fn(DVec3) -> DVec3,
    /// Plane coordinates at a point.
    pub(super) place: &'a dyn Fn(u32, DVec3) -> DVec2,
    pub(super) source: u32,
    /// Whether vertices are shared with other faces of this source.
    pub(super) shared: bool,
}

impl Shell {
    /// Points without faces.
    pub(super) fn on(points: Vec<DVec3>) -> Self {
        Self { points, ..Self::default() }
    }

    /// Adds a face; its triangles are turned so that they look outward.
    pub(super) fn add(&mut self, face: &Face<'_>) {
        let turned = self.looks_inward(face);
        let mut own: Vec<Option<u32>> = if face.shared { Vec::new() } else { vec![None; self.points.len()] };
        self.shared.resize(self.points.len(), None);
        for corners in face.triangles {
            let [a, b, c] = *corners;
            let corners = if turned { [a, c, b] } else { [a, b, c] };
            let flat = self.flat_normal(corners);
            let vertices = corners.map(|corner| {
                let point = self.points[corner as usize];
                let outward = (face.outward)(point);
                let known = if face.shared { self.shared[corner as usize] } else { own[corner as usize] };
                // Where the direction vanishes, at the apex of a cone, every triangle has a normal of its own.
                let pointed = outward.length() <= 1e-7 * self.longest(face, corners);
                if let Some(known) = known.filter(|_| !pointed) {
                    return VertexIndex(known);
                }
                let place = (face.place)(corner, point);
                let normal =
                    if pointed { self.mean_normal(face, corners, flat) } else { outward.normalize() };
                let index = mesh::index(self.vertices.len());
                self.vertices.push(Vertex {
                    point: PointIndex(corner),
                    normal,
                    uv: DVec2::ZERO,
                    color: Color::WHITE,
                    anchor: Anchor { source: face.source, u: place.x, v: place.y },
                });
                if !pointed {
                    let slot = if face.shared {
                        &mut self.shared[corner as usize]
                    } else {
                        &mut own[corner as usize]
                    };
                    *slot = Some(index);
                }
                VertexIndex(index)
            });
            self.triangles.push(vertices);
        }
    }

    /// Vertices of faces that come now are not shared with those before.
    pub(super) fn part(&mut self) {
        self.shared.clear();
    }

    /// Adds all faces of another shell, whose points stay its own.
    pub(super) fn append(&mut self, other: Self) {
        let (points, vertices) = (mesh::index(self.points.len()), mesh::index(self.vertices.len()));
        self.points.extend(other.points);
        let moved = |vertex: Vertex| Vertex { point: PointIndex(vertex.point.0 + points), ..vertex };
        self.vertices.extend(other.vertices.into_iter().map(moved));
        let moved = |corners: [VertexIndex; 3]| corners.map(|corner| VertexIndex(corner.0 + vertices));
        self.triangles.extend(other.triangles.into_iter().map(moved));
        self.shared.clear();
    }

    fn longest(&self, face: &Face<'_>, corners: [u32; 3]) -> f64 {
        corners
            .map(|corner| (face.outward)(self.points[corner as usize]).length())
            .into_iter()
            .fold(0.0, f64::max)
    }

    fn flat_normal(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
        (b - a).cross(c - a).normalize_or(DVec3::Y)
    }

    fn mean_normal(&self, face: &Face<'_>, corners: [u32; 3], flat: DVec3) -> DVec3 {
        let sum: DVec3 = corners
            .map(|corner| (face.outward)(self.points[corner as usize]).normalize_or_zero())
            .into_iter()
            .sum();
        sum.normalize_or(flat)
    }

    fn looks_inward(&self, face: &Face<'_>) -> bool {
        let side: f64 = face
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| self.points[corner as usize]);
                let outward: DVec3 =
                    [a, b, c].map(|point| (face.outward)(point).normalize_or_zero()).into_iter().sum();
                (b - a).cross(c - a).dot(outward)
            })
            .sum();
        side < 0.0
    }

    /// Spreads texture coordinates over the box of the places of each source.
    fn spread(&mut self) {
        let sources = self.vertices.iter().map(|vertex| vertex.anchor.source + 1).max().unwrap_or(0);
        let mut boxes = vec![(DVec2::INFINITY, DVec2::NEG_INFINITY); sources as usize];
        for vertex in &self.vertices {
            let place = DVec2::new(vertex.anchor.u, vertex.anchor.v);
            let (low, high) = &mut boxes[vertex.anchor.source as usize];
            (*low, *high) = (low.min(place), high.max(place));
        }
        for vertex in &mut self.vertices {
            let (low, high) = boxes[vertex.anchor.source as usize];
            let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
            let part = (DVec2::new(vertex.anchor.u, vertex.anchor.v) - low) / size;
            vertex.uv = DVec2::new(part.x, 1.0 - part.y);
        }
    }

    /// The mesh, without points that no triangle uses.
    pub(super) fn finish(mut self, uv: bool) -> Mesh {
        if uv {
            self.spread();
        }
        let mut kept: Vec<Option<u32>> = vec![None; self.points.len()];
        let mut points = Vec::with_capacity(self.points.len());
        for vertex in &mut self.vertices {
            let slot = &mut kept[vertex.point.subscript()];
            let index = *slot.get_or_insert_with(|| {
                points.push(self.points[vertex.point.subscript()]);
                mesh::index(points.len() - 1)
            });
            vertex.point = PointIndex(index);
        }
        let runs = vec![Run { origin: 0, end: mesh::index(self.triangles.len()) }];
        Mesh { points, vertices: self.vertices, triangles: self.triangles, runs }
    }
}
