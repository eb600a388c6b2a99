//! Splitting the triangles of a mesh at marked sides, so that neighbors agree.

use std::collections::{HashMap, HashSet};

use crate::geometry::mesh::{Anchor, Mesh, PointIndex, Run, Vertex, VertexIndex, index};

/// A mesh that is split, and its lines.
pub(in crate::geometry::tessellate) struct Splitter<'a> {
    pub(in crate::geometry::tessellate) mesh: Mesh,
    /// For each source the parameters after which u and v come round again.
    periods: &'a [(f64, f64)],
    lines: HashSet<(u32, u32)>,
    /// For each point that was made, in order: its neighbors on the side, and at which part of the way from the first.
    pub(in crate::geometry::tessellate) parents: Vec<(u32, u32, f64)>,
}

/// What a triangle is after a round.
pub(in crate::geometry::tessellate) struct Part {
    /// Whether it is as it was.
    pub(in crate::geometry::tessellate) whole: bool,
    /// The triangle it comes from.
    pub(in crate::geometry::tessellate) of: u32,
}

/// Two points in order.
pub(in crate::geometry::tessellate) fn key(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Points made on sides in one round, and vertices made on pairs of vertices.
struct Round<'a> {
    marks: &'a HashMap<(u32, u32), f64>,
    points: HashMap<(u32, u32), u32>,
    vertices: HashMap<(u32, u32), u32>,
}

impl<'a> Splitter<'a> {
    pub(in crate::geometry::tessellate) fn new(
        mesh: Mesh,
        lines: HashSet<(u32, u32)>,
        periods: &'a [(f64, f64)],
    ) -> Self {
        Self { mesh, periods, lines, parents: Vec::new() }
    }

    /// Whether a side is a border or a hard edge.
    pub(super) fn is_line(&self, side: (u32, u32)) -> bool {
        self.lines.contains(&side)
    }

    /// Splits every triangle with a marked side; a mark says at which part of the way from the lesser point. For each
    /// triangle that there is then: where it comes from.
    pub(in crate::geometry::tessellate) fn split(&mut self, marks: &HashMap<(u32, u32), f64>) -> Vec<Part> {
        let mut round = Round { marks, points: HashMap::new(), vertices: HashMap::new() };
        let triangles = std::mem::take(&mut self.mesh.triangles);
        let runs = std::mem::take(&mut self.mesh.runs);
        let mut sources = Vec::new();
        let mut made = Vec::with_capacity(triangles.len() * 2);
        let mut number = 0;
        for run in runs {
            while number < run.end {
                let parts = self.parts(triangles[number as usize], &mut round);
                sources.extend(parts.iter().map(|_| Part { whole: parts.len() == 1, of: number }));
                made.extend(parts);
                number += 1;
            }
            self.mesh.runs.push(Run { end: index(made.len()), ..run });
        }
        self.mesh.triangles = made;
        for ((a, b), middle) in sorted(&round.points) {
            if self.lines.contains(&(a, b)) {
                self.lines.insert(key(a, middle));
                self.lines.insert(key(middle, b));
            }
        }
        sources
    }

    fn parts(&mut self, [a, b, c]: [VertexIndex; 3], round: &mut Round<'_>) -> Vec<[VertexIndex; 3]> {
        let middle = [self.middle(b, c, round), self.middle(c, a, round), self.middle(a, b, round)];
        match middle {
            [None, None, None] => vec![[a, b, c]],
            [Some(m), None, None] => vec![[a, b, m], [a, m, c]],
            [None, Some(m), None] => vec![[b, c, m], [b, m, a]],
            [None, None, Some(m)] => vec![[c, a, m], [c, m, b]],
            [None, Some(q), Some(r)] => self.fork([a, b, c], (r, q)),
            [Some(p), None, Some(r)] => self.fork([b, c, a], (p, r)),
            [Some(p), Some(q), None] => self.fork([c, a, b], (q, p)),
            [Some(p), Some(q), Some(r)] => vec![[a, r, q], [r, b, p], [q, p, c], [p, q, r]],
        }
    }

    /// A triangle (a, b, c) with marks on the sides from a: at `r` toward b and `q` toward c. The rest is cut so
    /// that the worse of its halves is as good as can be.
    fn fork(&self, [a, b, c]: [VertexIndex; 3], (r, q): (VertexIndex, VertexIndex)) -> Vec<[VertexIndex; 3]> {
        let place =
            |vertex: VertexIndex| self.mesh.points[self.mesh.vertices[vertex.subscript()].point.subscript()];
        let quality = |corners: [VertexIndex; 3]| {
            let [a, b, c] = corners.map(place);
            let longest =
                (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
        };
        let (one, other) = ([[r, b, q], [b, c, q]], [[r, b, c], [r, c, q]]);
        let worse = |pair: &[[VertexIndex; 3]; 2]| quality(pair[0]).min(quality(pair[1]));
        let [first, second] = if worse(&one) >= worse(&other) { one } else { other };
        vec![[a, r, q], first, second]
    }

    /// The vertex on a marked side between two vertices, made at its first use.
    fn middle(&mut self, a: VertexIndex, b: VertexIndex, round: &mut Round<'_>) -> Option<VertexIndex> {
        let (one, other) = (self.mesh.vertices[a.subscript()], self.mesh.vertices[b.subscript()]);
        let side = key(one.point.0, other.point.0);
        let part = *round.marks.get(&side)?;
        let (a, b, one, other) =
            if one.point.0 <= other.point.0 { (a, b, one, other) } else { (b, a, other, one) };
        if let Some(known) = round.vertices.get(&(a.0, b.0)) {
            return Some(VertexIndex(*known));
        }
        let point = *round.points.entry(side).or_insert_with(|| {
            let ends = (self.mesh.points[side.0 as usize], self.mesh.points[side.1 as usize]);
            self.mesh.points.push(ends.0.lerp(ends.1, part));
            self.parents.push((side.0, side.1, part));
            index(self.mesh.points.len() - 1)
        });
        self.mesh.vertices.push(between((&one, &other), part, PointIndex(point), self.periods));
        let made = index(self.mesh.vertices.len() - 1);
        round.vertices.insert((a.0, b.0), made);
        Some(VertexIndex(made))
    }
}

/// A vertex on the side between two, at a part of the way.
pub(super) fn between(
    (one, other): (&Vertex, &Vertex),
    part: f64,
    point: PointIndex,
    periods: &[(f64, f64)],
) -> Vertex {
    Vertex {
        point,
        normal: one.normal.lerp(other.normal, part).try_normalize().unwrap_or(one.normal),
        uv: one.uv.lerp(other.uv, part),
        color: one.color.lerp(other.color, part),
        anchor: anchor_between((one.anchor, other.anchor), part, periods),
    }
}

/// Parameters at a part of the way between two places of one source.
pub(super) fn anchor_between((one, other): (Anchor, Anchor), part: f64, periods: &[(f64, f64)]) -> Anchor {
    let never = (f64::INFINITY, f64::INFINITY);
    let (u, v) = periods.get(one.source as usize).copied().unwrap_or(never);
    Anchor {
        source: one.source,
        u: one.u + shorter_way(other.u - one.u, u) * part,
        v: one.v + shorter_way(other.v - one.v, v) * part,
    }
}

/// A difference of parameters, across the seam where that is shorter.
fn shorter_way(difference: f64, period: f64) -> f64 {
    if difference.abs() > period / 2.0 { difference - period * difference.signum() } else { difference }
}

/// The entries of a map in the order of their keys.
fn sorted(points: &HashMap<(u32, u32), u32>) -> Vec<((u32, u32), u32)> {
    let mut all: Vec<((u32, u32), u32)> = points.iter().map(|(side, point)| (*side, *point)).collect();
    all.sort_unstable();
    all
}
