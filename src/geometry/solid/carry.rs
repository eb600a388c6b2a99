//! From bare triangles to a mesh: what the corners carry comes from the triangles that they lie on.
//!
//! A new edge is sharp because its two sides lie on different triangles with different normals; what was smooth stays
//! smooth because neighbors lie on triangles that share their normals. The inside of what is taken away looks outward.

use glam::{DVec2, DVec3};

use super::group::origins;
use super::{Combined, Lying, Raw, Stock};
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex, index};

/// Difference up to which two normals, or texture coordinates of unit size, on one point are the same.
const ALIKE: f64 = 1e-9;

/// Difference up to which two parts of a color are the same: rounding to single precision.
const SHADE: f32 = 1e-6;

/// Part of the reach of a mesh that places are off by in double precision.
const ROUNDING: f64 = 1e-12;

/// The mesh of raw triangles, one run for each origin that is met. `faces` names for each triangle of the stock the one
/// that stands for its flat face.
pub(super) fn carried(stock: &Stock, raw: &Raw, faces: &[u32], periods: &[(f64, f64)]) -> Combined {
    let origins = origins(&stock.mesh);
    let mut order: Vec<u32> = (0..index(raw.triangles.len())).collect();
    let origin_of = |number: u32| origins[raw.origins[number as usize].on as usize];
    order.sort_by_key(|number| origin_of(*number));
    let mut carrier = Carrier::new(stock, raw, alone(faces), periods);
    let mut mesh = Mesh::default();
    for number in order {
        mesh.triangles.push(carrier.triangle(number));
        let (origin, end) = (origin_of(number), index(mesh.triangles.len()));
        match mesh.runs.last_mut().filter(|run| run.origin == origin) {
            Some(run) => run.end = end,
            None => mesh.runs.push(Run { origin, end }),
        }
    }
    mesh.points.clone_from(&raw.points);
    mesh.vertices = carrier.vertices;
    let noise = ROUNDING * stock.mesh.bounds().reach();
    Combined { moved: if carrier.moved > noise { carrier.moved } else { 0.0 }, mesh }
}

/// Which triangles stand for themselves alone.
fn alone(faces: &[u32]) -> Vec<bool> {
    let mut alone = vec![true; faces.len()];
    for (number, face) in (0..).zip(faces) {
        if *face != number {
            alone[*face as usize] = false;
        }
    }
    alone
}

/// The end of a chain.
const NONE: u32 = u32::MAX;

struct Carrier<'a> {
    stock: &'a Stock,
    raw: &'a Raw,
    /// Which triangles of the stock are a face of their own.
    alone: Vec<bool>,
    periods: &'a [(f64, f64)],
    /// The farthest that a point lies from its triangle.
    moved: f64,
    vertices: Vec<Vertex>,
    /// For each point the vertex made last on it, and for each vertex the one made before it on its point.
    newest: Vec<u32>,
    older: Vec<u32>,
}

impl<'a> Carrier<'a> {
    fn new(stock: &'a Stock, raw: &'a Raw, alone: Vec<bool>, periods: &'a [(f64, f64)]) -> Self {
        let count = raw.points.len();
        Self {
            stock,
            raw,
            alone,
            periods,
            moved: 0.0,
            vertices: Vec::with_capacity(count + count / 4),
            newest: vec![NONE; count],
            older: Vec::with_capacity(count + count / 4),
        }
    }

    fn triangle(&mut self, number: u32) -> [VertexIndex; 3] {
        let Lying { on, flipped } = self.raw.origins[number as usize];
        let mesh = &self.stock.mesh;
        let under = mesh.triangles[on as usize].map(|vertex| &mesh.vertices[vertex.subscript()]);
        let base = Base::new(under, under.map(|vertex| mesh.points[vertex.point.subscript()]));
        let corners = self.raw.triangles[number as usize];
        corners.map(|point| {
            let place = self.raw.points[point as usize];
            self.moved = self.moved.max(base.away(place, self.alone[on as usize]));
            let mut vertex = base.at(place, self.periods);
            vertex.point = PointIndex(point);
            if flipped {
                vertex.normal = -vertex.normal;
            }
            self.vertex(vertex)
        })
    }

    /// A vertex, made unless one like it stands on the point.
    fn vertex(&mut self, wanted: Vertex) -> VertexIndex {
        let newest = self.newest[wanted.point.subscript()];
        let mut at = newest;
        while at != NONE {
            if alike(&self.vertices[at as usize], &wanted) {
                return VertexIndex(at);
            }
            at = self.older[at as usize];
        }
        let made = index(self.vertices.len());
        self.newest[wanted.point.subscript()] = made;
        self.older.push(newest);
        self.vertices.push(wanted);
        VertexIndex(made)
    }
}

fn alike(one: &Vertex, other: &Vertex) -> bool {
    let size = one.uv.abs().max_element().max(1.0);
    one.anchor.source == other.anchor.source
        && (one.normal - other.normal).abs().max_element() <= ALIKE
        && (one.uv - other.uv).abs().max_element() <= ALIKE * size
        && (0..4).all(|part| (one.color.0[part] - other.color.0[part]).abs() <= SHADE)
}

/// A triangle with what its corners carry.
struct Base<'a> {
    vertices: [&'a Vertex; 3],
    places: [DVec3; 3],
    normal: DVec3,
    square: f64,
}

impl<'a> Base<'a> {
    fn new(vertices: [&'a Vertex; 3], places: [DVec3; 3]) -> Self {
        let normal = (places[1] - places[0]).cross(places[2] - places[0]);
        Self { vertices, places, normal, square: normal.length_squared() }
    }

    /// What a point of its plane carries. Beyond its sides only where its whole face is flat, and all is linear.
    fn at(&self, point: DVec3, periods: &[(f64, f64)]) -> Vertex {
        if let Some(corner) = (0..3).find(|corner| self.places[*corner] == point) {
            return *self.vertices[corner];
        }
        self.mixed(self.weights(point), periods)
    }

    /// How far a point lies from its plane or, where it is a face of its own, from the triangle.
    fn away(&self, point: DVec3, alone: bool) -> f64 {
        let [a, b, c] = self.places;
        if self.square == 0.0 || point == a || point == b || point == c {
            return 0.0;
        }
        let mut away = (point - a).dot(self.normal).abs() / self.square.sqrt();
        if alone {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let inside = (to - from).cross(point - from).dot(self.normal);
                if inside < 0.0 {
                    away = away.max(-inside / (self.square.sqrt() * from.distance(to)));
                }
            }
        }
        away
    }

    fn weights(&self, point: DVec3) -> [f64; 3] {
        let [a, b, c] = self.places;
        if self.square == 0.0 {
            return on_longest([a, b, c], point);
        }
        let part = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(self.normal) / self.square;
        let (first, second) = (part(b, c), part(c, a));
        [first, second, 1.0 - first - second]
    }

    fn mixed(&self, weights: [f64; 3], periods: &[(f64, f64)]) -> Vertex {
        let [a, b, c] = self.vertices;
        let mix =
            |of: &dyn Fn(&Vertex) -> DVec3| of(a) * weights[0] + of(b) * weights[1] + of(c) * weights[2];
        let one_normal = a.normal == b.normal && b.normal == c.normal;
        let normal = mix(&|vertex| vertex.normal);
        let uv: DVec2 = a.uv * weights[0] + b.uv * weights[1] + c.uv * weights[2];
        Vertex {
            point: PointIndex(0),
            normal: if one_normal { a.normal } else { normal.try_normalize().unwrap_or(a.normal) },
            uv,
            color: Color::mixed([a.color, b.color, c.color], weights),
            anchor: self.anchor(weights, periods),
        }
    }

    /// Parameters between those of the corners; where these lie on different surfaces, those of the nearest.
    fn anchor(&self, weights: [f64; 3], periods: &[(f64, f64)]) -> Anchor {
        let [a, b, c] = self.vertices.map(|vertex| vertex.anchor);
        if a.source != b.source || b.source != c.source {
            let heaviest = if weights[0] >= weights[1].max(weights[2]) {
                a
            } else if weights[1] >= weights[2] {
                b
            } else {
                c
            };
            return heaviest;
        }
        let (period_u, period_v) =
            periods.get(a.source as usize).copied().unwrap_or((f64::INFINITY, f64::INFINITY));
        let between = |from: f64, one: f64, other: f64, period: f64| {
            from + weights[1] * shorter_way(one - from, period)
                + weights[2] * shorter_way(other - from, period)
        };
        Anchor { source: a.source, u: between(a.u, b.u, c.u, period_u), v: between(a.v, b.v, c.v, period_v) }
    }
}

/// A difference of parameters, across the seam where that is shorter.
pub(super) fn shorter_way(difference: f64, period: f64) -> f64 {
    if difference.abs() > period / 2.0 { difference - period * difference.signum() } else { difference }
}

/// Weights of a point on a triangle without area: along its longest side.
fn on_longest(places: [DVec3; 3], point: DVec3) -> [f64; 3] {
    let length = |k: usize| (places[(k + 1) % 3] - places[k]).length_squared();
    let longest = (0..3).max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap_or(0);
    let mut weights = [0.0; 3];
    let square = length(longest);
    let along = places[(longest + 1) % 3] - places[longest];
    let part =
        if square > 0.0 { ((point - places[longest]).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    weights[longest] = 1.0 - part;
    weights[(longest + 1) % 3] = part;
    weights
}
