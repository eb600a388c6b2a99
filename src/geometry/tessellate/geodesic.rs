//! Balls of nearly equal triangles: the faces of a Platonic solid, divided and brought onto the ball.
//!
//! A point of a divided face has whole weights i + j + k = n over its corners A, B, C. It is brought onto the ball as
//! the direction of sin(i w / n) A + sin(j w / n) B + sin(k w / n) C with w the angle between two corners: on an edge
//! these are equal steps of angle, so that neighbouring faces agree, and inside the triangles stay nearly equal.
//! On edges it is the interpolation of K. Shoemake, Animating rotation with quaternion curves, SIGGRAPH 1985; the
//! classes are those of J. Clinton, Advanced Structural Geometry Studies I, NASA CR-1734, 1971.
//!
//! The bound is proved: the mesh is seen whole from the middle, so rays from there pair its points with those of the
//! ball, and no point of a triangle is nearer to the middle than its nearest one, which has a closed form.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::round::{fewest_pieces, sagitta};
use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::mesh;
use crate::geometry::mesh::platonic::Platonic;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use crate::geometry::number::{acos, asin, atan2, sin};

/// A ball of triangles about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodesic {
    /// Radius, metres.
    pub radius: f64,
    /// The solid that is divided; one of triangles.
    pub base: Platonic,
    /// Pieces of each edge of the solid; `None` for as many as the detail asks.
    pub frequency: Option<u32>,
    /// Whether the triangles cross the edges of the solid (class II): three times as many.
    pub across: bool,
}

/// The most pieces of an edge that are tried.
const MOST: u32 = 20_000;

/// Makes a ball of triangles. Anchor source 0. O(triangles).
///
/// # Errors
/// When the limit would be passed.
pub fn geodesic(ball: &Geodesic, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let base = Base::new(ball.base);
    let frequency = match (ball.frequency, detail.density) {
        (Some(given), _) => given,
        (None, SurfaceDensity::Grid { u, .. }) => u,
        (None, SurfaceDensity::Tolerance(tolerance)) => {
            let affordable = (detail.triangle_limit / base.faces.len() as u64).isqrt();
            let most = u32::try_from(affordable).unwrap_or(MOST).clamp(1, MOST) + 1;
            fewest_pieces(tolerance / ball.radius, most, |pieces| base.deviation(pieces, ball.across))
        }
    };
    let factor = if ball.across { 3 } else { 1 };
    detail.allow(base.faces.len() as u64 * u64::from(frequency) * u64::from(frequency) * factor)?;
    let mut net = base.divided(frequency);
    if ball.across {
        net = net.across();
    }
    let deviation = Deviation { bound: net.deviation() * ball.radius, evidence: Evidence::Proved };
    Ok(Tessellation { mesh: net.mesh(ball.radius, detail.uv), deviation })
}

/// A solid of triangles with corners on the unit ball.
struct Base {
    corners: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    /// Angle between two neighbouring corners, radians.
    angle: f64,
}

/// Points on the unit ball and triangles.
struct Net {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Base {
    fn new(solid: Platonic) -> Self {
        let corners: Vec<DVec3> = solid.corners().into_iter().map(DVec3::normalize).collect();
        let faces: Vec<[u32; 3]> =
            solid.faces().into_iter().map(|face| [face[0], face[1], face[2]]).collect();
        let [a, b, _] = faces[0].map(|corner| corners[corner as usize]);
        Self { angle: acos(a.dot(b)), corners, faces }
    }

    /// The point of whole weights over the corners of a face.
    fn place(&self, face: [u32; 3], weights: [u32; 3], frequency: u32) -> DVec3 {
        let part = |k: usize| {
            let weight = sin(self.angle * f64::from(weights[k]) / f64::from(frequency));
            self.corners[face[k] as usize] * weight
        };
        (part(0) + part(1) + part(2)).normalize()
    }

    /// Greatest distance of the divided solid from the unit ball. Along the edges of the solid all faces are alike.
    fn deviation(&self, frequency: u32, across: bool) -> f64 {
        if across {
            return self.divided(frequency).across().deviation();
        }
        let face = vec![self.faces[0]];
        Self { corners: self.corners.clone(), faces: face, angle: self.angle }.divided(frequency).deviation()
    }

    /// Every face divided into `frequency` squared triangles; points on edges are shared.
    fn divided(&self, frequency: u32) -> Net {
        let mut points = self.corners.clone();
        let mut edges: HashMap<[u32; 2], u32> = HashMap::new();
        let mut triangles = Vec::new();
        for &face in &self.faces {
            for k in 0..3 {
                let (from, to) = (face[k], face[(k + 1) % 3]);
                let edge = [from.min(to), from.max(to)];
                edges.entry(edge).or_insert_with(|| {
                    let first = mesh::index(points.len());
                    let along = (1..frequency)
                        .map(|k| self.place([edge[0], edge[1], edge[0]], [frequency - k, k, 0], frequency));
                    points.extend(along);
                    first
                });
            }
            let inside = mesh::index(points.len());
            for i in 1..frequency {
                let along =
                    (1..frequency - i).map(|j| self.place(face, [frequency - i - j, j, i], frequency));
                points.extend(along);
            }
            let row = Rows { face, frequency, inside, edges: &edges };
            row.triangles(&mut triangles);
        }
        Net { points, triangles }
    }
}

/// The numbering of the points of one divided face.
struct Rows<'a> {
    face: [u32; 3],
    frequency: u32,
    /// First point inside of it.
    inside: u32,
    /// First point on each edge, counted from its lesser corner.
    edges: &'a HashMap<[u32; 2], u32>,
}

impl Rows<'_> {
    /// The point j steps along row i; row 0 goes from corner 0 to corner 1, row n is corner 2.
    fn point(&self, i: u32, j: u32) -> u32 {
        let n = self.frequency;
        let [a, b, c] = self.face;
        match (i, j) {
            (0, 0) => a,
            (0, j) if j == n => b,
            (i, _) if i == n => c,
            (0, j) => self.on_edge(a, b, j),
            (i, 0) => self.on_edge(a, c, i),
            (i, j) if i + j == n => self.on_edge(b, c, i),
            // The rows before, 1 to i - 1, have n - 1 - row points inside.
            (i, j) => self.inside + (i - 1) * (n - 1) - i * (i - 1) / 2 + j - 1,
        }
    }

    fn on_edge(&self, from: u32, to: u32, step: u32) -> u32 {
        if from < to {
            self.edges[&[from, to]] + step - 1
        } else {
            self.edges[&[to, from]] + self.frequency - step - 1
        }
    }

    fn triangles(&self, triangles: &mut Vec<[u32; 3]>) {
        for i in 0..self.frequency {
            for j in 0..self.frequency - i {
                triangles.push([self.point(i, j), self.point(i, j + 1), self.point(i + 1, j)]);
                if i + j + 1 < self.frequency {
                    triangles.push([self.point(i, j + 1), self.point(i + 1, j + 1), self.point(i + 1, j)]);
                }
            }
        }
    }
}

impl Net {
    /// Greatest distance from the unit ball.
    fn deviation(&self) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| self.points[corner as usize]);
        self.triangles.iter().map(|triangle| sagitta(corners(triangle), 1.0)).fold(0.0, f64::max)
    }

    /// Middles of the triangles become points, and each edge is turned to join the middles on its two sides.
    fn across(self) -> Self {
        let Self { mut points, triangles } = self;
        let first = mesh::index(points.len());
        points.extend(
            triangles
                .iter()
                .map(|triangle| {
                    triangle.map(|corner| points[corner as usize]).iter().sum::<DVec3>().normalize()
                })
                .collect::<Vec<_>>(),
        );
        let sides = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
        let mut left: HashMap<[u32; 2], u32> = HashMap::with_capacity(3 * triangles.len());
        for (middle, triangle) in (first..).zip(&triangles) {
            left.extend(sides(*triangle).map(|side| (side, middle)));
        }
        let turned = (first..).zip(&triangles).flat_map(|(middle, triangle)| {
            sides(*triangle).map(|[from, to]| [middle, from, left[&[to, from]]])
        });
        let triangles = turned.collect();
        Self { points, triangles }
    }

    fn mesh(self, radius: f64, uv: bool) -> Mesh {
        let mut made =
            Mesh { points: self.points.iter().map(|point| *point * radius).collect(), ..Mesh::default() };
        let end = mesh::index(self.triangles.len());
        if uv {
            let mut wrap = Wrap { points: &self.points, known: HashMap::new(), vertices: Vec::new() };
            made.triangles = self.triangles.iter().map(|triangle| wrap.triangle(*triangle)).collect();
            made.vertices = wrap.vertices;
        } else {
            let plain = |(place, normal): (u32, &DVec3)| vertex(place, *normal, DVec2::ZERO);
            made.vertices = (0..).zip(&self.points).map(plain).collect();
            made.triangles = self.triangles.iter().map(|triangle| triangle.map(VertexIndex)).collect();
        }
        made.runs = vec![Run { origin: 0, end }];
        made
    }
}

fn vertex(point: u32, normal: DVec3, uv: DVec2) -> Vertex {
    Vertex { point: PointIndex(point), normal, uv, color: Color::WHITE, anchor: Anchor::default() }
}

/// Texture coordinates by longitude and latitude, as on a turned ball. Triangles across the seam get vertices of
/// their own beyond the end of the texture, those at a pole one that looks along their own middle.
struct Wrap<'a> {
    points: &'a [DVec3],
    known: HashMap<(u32, [u64; 2]), u32>,
    vertices: Vec<Vertex>,
}

impl Wrap<'_> {
    fn triangle(&mut self, corners: [u32; 3]) -> [VertexIndex; 3] {
        let directions = corners.map(|corner| self.points[corner as usize]);
        let middle = longitude(directions.iter().sum());
        let own = directions.map(|direction| if is_pole(direction) { middle } else { longitude(direction) });
        // The nearest turn to the middle, and never left of the texture.
        let near = own.map(|u| u + (middle - u).round());
        let shift = if near.iter().any(|u| *u < 0.0) { 1.0 } else { 0.0 };
        let mut made = [VertexIndex(0); 3];
        for (k, slot) in made.iter_mut().enumerate() {
            let v = 0.5 - asin(directions[k].y.clamp(-1.0, 1.0)) / core::f64::consts::PI;
            *slot = self.vertex(corners[k], directions[k], DVec2::new(near[k] + shift, v));
        }
        made
    }

    fn vertex(&mut self, point: u32, normal: DVec3, uv: DVec2) -> VertexIndex {
        let bits = [uv.x.to_bits(), uv.y.to_bits()];
        let known = self.known.entry((point, bits)).or_insert_with(|| {
            self.vertices.push(vertex(point, normal, uv));
            mesh::index(self.vertices.len() - 1)
        });
        VertexIndex(*known)
    }
}

fn is_pole(direction: DVec3) -> bool {
    direction.x.abs() + direction.z.abs() < 1e-12
}

/// Part of a turn from +x toward -z, in [0, 1).
fn longitude(direction: DVec3) -> f64 {
    if is_pole(direction) {
        return 0.0;
    }
    let turn = atan2(-direction.z, direction.x) / core::f64::consts::TAU;
    if turn < 0.0 { (turn + 1.0) % 1.0 } else { turn }
}

#[cfg(test)]
mod tests {
    use super::{Geodesic, geodesic};
    use crate::geometry::mesh::platonic::Platonic;
    use crate::geometry::mesh::{VertexIndex, topology};
    use crate::geometry::tessellate::{Detail, SurfaceDensity, Tessellation};

    fn detail(tolerance: f64) -> Detail {
        Detail {
            density: SurfaceDensity::Tolerance(tolerance),
            crease_angle: 30.0,
            uv: false,
            triangle_limit: 1 << 22,
        }
    }

    fn made(base: Platonic, frequency: u32, across: bool, uv: bool) -> Tessellation {
        let ball = Geodesic { radius: 2.0, base, frequency: Some(frequency), across };
        geodesic(&ball, &Detail { uv, ..detail(1.0) }).expect("within the limit")
    }

    const BASES: [(Platonic, usize); 3] =
        [(Platonic::Tetrahedron, 4), (Platonic::Octahedron, 8), (Platonic::Icosahedron, 20)];

    #[test]
    fn counts_are_those_of_the_class_and_every_net_is_a_ball() {
        for (base, faces) in BASES {
            for frequency in 1..9u32 {
                for (across, factor) in [(false, 1), (true, 3)] {
                    let mesh = made(base, frequency, across, false).mesh;
                    let count = faces * factor * (frequency * frequency) as usize;
                    assert_eq!(mesh.triangles.len(), count, "{base:?} {frequency} {across}");
                    let corner = |k: usize| mesh.triangles[k / 3][k % 3].0;
                    let found = topology::measure(count, mesh.points.len(), corner).expect("small");
                    assert!(found.manifold && found.genus == Some(0) && found.components == 1);
                    let outside = |t: &[VertexIndex; 3]| {
                        let [a, b, c] = t.map(|v| mesh.points[v.0 as usize]);
                        (b - a).cross(c - a).dot(a + b + c) > 0.0
                    };
                    assert!(mesh.triangles.iter().all(outside), "{base:?} {frequency} {across}");
                }
            }
        }
    }

    #[test]
    fn the_fewest_pieces_keep_the_tolerance() {
        for (base, _) in BASES {
            for across in [false, true] {
                for tolerance in [0.5, 0.1, 1e-2, 1e-4] {
                    let ball = Geodesic { radius: 1.0, base, frequency: None, across };
                    let made = geodesic(&ball, &detail(tolerance)).expect("within the limit");
                    assert!(
                        made.deviation.bound <= tolerance * (1.0 + 1e-9),
                        "{base:?} {}",
                        made.deviation.bound
                    );
                    let per_face = made.mesh.triangles.len() / if across { 3 } else { 1 };
                    let faces = BASES.iter().find(|known| known.0 == base).expect("known").1;
                    let frequency = u32::try_from((per_face / faces).isqrt()).expect("small");
                    if frequency > 1 {
                        let fewer = Geodesic { frequency: Some(frequency - 1), ..ball };
                        let fewer = geodesic(&fewer, &detail(1.0)).expect("within the limit");
                        assert!(fewer.deviation.bound > tolerance * 0.999, "{base:?} {frequency}");
                    }
                }
            }
        }
    }

    #[test]
    fn no_triangle_reaches_around_the_texture() {
        for (base, _) in BASES {
            for frequency in [1, 2, 3, 8] {
                for across in [false, true] {
                    let mesh = made(base, frequency, across, true).mesh;
                    // Where a pole lies inside a triangle, the texture runs together there.
                    let low = |t: &&[VertexIndex; 3]| {
                        t.iter().all(|v| mesh.vertices[v.0 as usize].normal.y.abs() < 0.8)
                    };
                    for triangle in mesh.triangles.iter().filter(low) {
                        let u = triangle.map(|corner| mesh.vertices[corner.0 as usize].uv.x);
                        let wide = u.iter().fold(0.0, |w: f64, a| u.iter().fold(w, |w, b| w.max(a - b)));
                        assert!(wide <= 0.5 + 1e-9 && u.iter().all(|u| (0.0..2.0).contains(u)), "{u:?}");
                    }
                }
            }
        }
    }
}
