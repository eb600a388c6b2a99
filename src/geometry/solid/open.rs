//! Cutting off what lies beyond a plane, without closing the cut.

use std::collections::HashMap;

use super::half::HalfSpace;
use crate::geometry::mesh::{Anchor, Mesh, PointIndex, Run, Vertex, VertexIndex, index};

/// Part of the mesh's reach within which a point lies in the plane: rounding.
const IN_PLANE: f64 = 1e-14;

/// What of a mesh, closed or not, lies in half of space. Points in the plane stay where they are, so that a mesh that
/// touches the plane is not cut there; triangles that lie in it go, as they would be the cut. O(triangles).
#[must_use]
pub fn cut_open(mesh: &Mesh, half: &HalfSpace, periods: &[(f64, f64)]) -> Mesh {
    let near = IN_PLANE * (mesh.bounds().reach() + half.point.abs().max_element());
    let depths: Vec<f64> = (mesh.points.iter())
        .map(|point| half.depth(*point))
        .map(|depth| if depth.abs() <= near { 0.0 } else { depth })
        .collect();
    let mut cutter = Cutter {
        made: Mesh { points: mesh.points.clone(), vertices: mesh.vertices.clone(), ..Mesh::default() },
        depths,
        periods,
        points: HashMap::new(),
        vertices: HashMap::new(),
    };
    let mut start = 0;
    for run in &mesh.runs {
        for triangle in &mesh.triangles[start..run.end as usize] {
            cutter.cut(*triangle);
        }
        start = run.end as usize;
        let end = index(cutter.made.triangles.len());
        if end > cutter.made.runs.last().map_or(0, |run| run.end) {
            cutter.made.runs.push(Run { origin: run.origin, end });
        }
    }
    cutter.made
}

struct Cutter<'a> {
    made: Mesh,
    depths: Vec<f64>,
    periods: &'a [(f64, f64)],
    /// Points where sides meet the plane, and vertices there.
    points: HashMap<(u32, u32), u32>,
    vertices: HashMap<(u32, u32), u32>,
}

impl Cutter<'_> {
    fn depth(&self, vertex: VertexIndex) -> f64 {
        self.depths[self.made.vertices[vertex.subscript()].point.subscript()]
    }

    fn cut(&mut self, triangle: [VertexIndex; 3]) {
        let depths = triangle.map(|vertex| self.depth(vertex));
        if depths.iter().all(|depth| *depth >= 0.0) {
            if depths.iter().any(|depth| *depth > 0.0) {
                self.made.triangles.push(triangle);
            }
            return;
        }
        let mut kept: Vec<VertexIndex> = Vec::with_capacity(4);
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            let (before, after) = (depths[k], depths[(k + 1) % 3]);
            if before >= 0.0 {
                kept.push(from);
            }
            if before * after < 0.0 {
                kept.push(self.crossing(from, to));
            }
        }
        for k in 2..kept.len() {
            self.made.triangles.push([kept[0], kept[k - 1], kept[k]]);
        }
    }

    /// The vertex where a side crosses the plane, the same from both sides of it.
    fn crossing(&mut self, from: VertexIndex, to: VertexIndex) -> VertexIndex {
        let point_of = |mesh: &Mesh, vertex: VertexIndex| mesh.vertices[vertex.subscript()].point.0;
        let (from, to) =
            if point_of(&self.made, from) <= point_of(&self.made, to) { (from, to) } else { (to, from) };
        if let Some(known) = self.vertices.get(&(from.0, to.0)) {
            return VertexIndex(*known);
        }
        let (one, other) = (self.made.vertices[from.subscript()], self.made.vertices[to.subscript()]);
        let (before, after) = (self.depth(from), self.depth(to));
        let part = before / (before - after);
        let side = (one.point.0, other.point.0);
        let point = *self.points.entry(side).or_insert_with(|| {
            let (a, b) = (self.made.points[side.0 as usize], self.made.points[side.1 as usize]);
            self.made.points.push(a.lerp(b, part));
            self.depths.push(0.0);
            index(self.made.points.len() - 1)
        });
        let made = index(self.made.vertices.len());
        self.made.vertices.push(Vertex {
            point: PointIndex(point),
            normal: one.normal.lerp(other.normal, part).try_normalize().unwrap_or(one.normal),
            uv: one.uv.lerp(other.uv, part),
            color: one.color.lerp(other.color, part),
            anchor: between(one.anchor, other.anchor, part, self.periods),
        });
        self.vertices.insert((from.0, to.0), made);
        VertexIndex(made)
    }
}

/// Parameters at a part of the way; where the ends lie on different surfaces, those of the nearer one.
fn between(one: Anchor, other: Anchor, part: f64, periods: &[(f64, f64)]) -> Anchor {
    if one.source != other.source {
        return if part < 0.5 { one } else { other };
    }
    let (u, v) = periods.get(one.source as usize).copied().unwrap_or((f64::INFINITY, f64::INFINITY));
    let way = |from: f64, to: f64, period: f64| from + super::carry::shorter_way(to - from, period) * part;
    Anchor { source: one.source, u: way(one.u, other.u, u), v: way(one.v, other.v, v) }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::cut_open;
    use crate::geometry::mesh::topology;
    use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
    use crate::geometry::solid::HalfSpace;

    /// A square of two triangles in the plane z = 0, from 0 to 1.
    fn square() -> Mesh {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let vertex = |k: u32, u: f64, v: f64| Vertex {
            point: PointIndex(k),
            normal: DVec3::Z,
            uv: DVec2::new(u, v),
            color: Color::WHITE,
            anchor: Anchor { source: 0, u, v },
        };
        Mesh {
            points: corners.iter().map(|(x, y)| DVec3::new(*x, *y, 0.0)).collect(),
            vertices: (0..).zip(corners).map(|(k, (u, v))| vertex(k, u, v)).collect(),
            triangles: vec![[0, 1, 2].map(VertexIndex), [0, 2, 3].map(VertexIndex)],
            runs: vec![Run { origin: 0, end: 2 }],
        }
    }

    fn area(mesh: &Mesh) -> f64 {
        let corner = |vertex: VertexIndex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()];
        let twice = |triangle: &[VertexIndex; 3]| {
            let [a, b, c] = triangle.map(corner);
            (b - a).cross(c - a).z
        };
        mesh.triangles.iter().map(twice).sum::<f64>() / 2.0
    }

    #[test]
    fn both_sides_make_the_whole_and_attributes_follow() {
        for (normal, offset) in [(DVec3::X, 0.3), (DVec3::new(0.6, 0.8, 0.0), 0.5), (DVec3::NEG_Y, -0.75)] {
            let half = HalfSpace { point: normal * offset, normal };
            let above = cut_open(&square(), &half, &[]);
            let below = cut_open(&square(), &HalfSpace { normal: -normal, ..half }, &[]);
            assert!((area(&above) + area(&below) - 1.0).abs() < 1e-15);
            for side in [&above, &below] {
                for vertex in &side.vertices {
                    let place = side.points[vertex.point.subscript()];
                    assert!((vertex.uv - place.truncate()).length() < 1e-15);
                    assert!((vertex.anchor.u - place.x).abs() + (vertex.anchor.v - place.y).abs() < 1e-15);
                }
                let corners = |of: &[VertexIndex; 3]| of.map(|v| side.vertices[v.subscript()].point.0);
                let triangles: Vec<[u32; 3]> = side.triangles.iter().map(corners).collect();
                let measured = topology::of_triangles(&triangles, side.points.len()).expect("few triangles");
                assert_eq!((measured.boundary_loops, measured.components, measured.crowded_edges), (1, 1, 0));
            }
        }
    }

    #[test]
    fn what_touches_the_plane_is_not_cut() {
        let along = HalfSpace { point: DVec3::ZERO, normal: DVec3::X };
        assert_eq!(cut_open(&square(), &along, &[]).triangles, square().triangles);
        assert!(cut_open(&square(), &HalfSpace { normal: DVec3::NEG_X, ..along }, &[]).triangles.is_empty());
        let diagonal = HalfSpace { point: DVec3::ZERO, normal: DVec3::new(1.0, -1.0, 0.0).normalize() };
        let half = cut_open(&square(), &diagonal, &[]);
        assert_eq!((half.triangles.len(), half.points.len()), (1, 4));
        let inside = HalfSpace { point: DVec3::ZERO, normal: DVec3::Z };
        assert!(cut_open(&square(), &inside, &[]).triangles.is_empty(), "it lies in the plane");
    }
}
