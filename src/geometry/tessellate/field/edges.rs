//! Edges of a surface: found where normals jump, and made edges of the triangles.
//!
//! A jump is told from a bend by halving: a bend halves with the way, a jump stays. The place is where the tangent
//! planes at both sides of it meet. Where three sides meet in a triangle it gets a corner first.

use glam::DVec3;

use super::cells::Quick;
use super::probe::{Probe, meet};
use super::skin::{Kind, NONE, Skin};
use crate::geometry::mesh;
use crate::geometry::number::cos_degrees;

/// Normals that differ by less than this many degrees are looked at no further.
const FAINT: f64 = 20.0;
/// What is left of a bend of this many degrees after all halvings would be far less: it is a jump.
const JUMP: f64 = 10.0;
/// How often a way is halved.
const HALVINGS: u32 = 12;
/// How far from a point on an edge the normals of its sides are taken, as a share of the way to the triangle's middle.
pub(super) const ASIDE: f64 = 0.05;

impl Probe<'_> {
    /// Where normals jump between two points of the surface.
    fn jump(&self, [mut from, mut to]: [(DVec3, DVec3); 2]) -> Option<DVec3> {
        if from.1.dot(to.1) > cos_degrees(FAINT) {
            return None;
        }
        for _ in 0..HALVINGS {
            let reach = from.0.distance(to.0);
            let middle = self.settle(from.0.midpoint(to.0), reach)?;
            let (first, second) = (from.1.dot(middle.1), middle.1.dot(to.1));
            if first.min(second) > cos_degrees(JUMP) {
                return None;
            }
            if first < second { to = middle } else { from = middle }
        }
        let plane = |(place, normal): (DVec3, DVec3)| (normal.dot(place), normal);
        let middle = from.0.midpoint(to.0);
        let found = meet(middle, [plane(from), plane(to)])?;
        (found.distance(middle) <= 4.0 * from.0.distance(to.0)).then(|| self.onto(found, from.1 + to.1))
    }

    /// The normal at a corner of a triangle, of the side that the triangle is on.
    pub(super) fn corner_normal(&self, skin: &Skin, corner: u32, middle: DVec3) -> DVec3 {
        match skin.kind(corner) {
            Kind::Smooth => skin.normal(corner),
            Kind::Edge | Kind::Corner | Kind::Held => self.normal_towards(skin.point(corner), middle, ASIDE),
        }
    }

    /// Makes the edges of the surface edges of triangles, where they are not yet; whether there are any. Looks at the
    /// triangles that `chosen` names, or at all.
    pub(super) fn add_edges(&self, skin: &mut Skin, chosen: Option<&[u32]>) -> bool {
        let halves: Vec<u32> = match chosen {
            None => skin.edges().collect(),
            Some(triangles) => {
                let alive = triangles.iter().filter(|triangle| skin.is_alive(**triangle));
                let mut halves: Vec<u32> = alive
                    .flat_map(|triangle| 3 * triangle..3 * triangle + 3)
                    .map(|half| half.min(skin.twin(half)))
                    .collect();
                halves.sort_unstable();
                halves.dedup();
                halves
            }
        };
        // Between two points on edges normals have no one side to be taken from.
        let smooth = |point: u32| skin.kind(point) == Kind::Smooth;
        let edges = halves.into_iter().map(|half| (skin.from(half), skin.to(half)));
        let crossed: Vec<(u32, u32)> = edges
            .filter(|(from, to)| smooth(*from) || smooth(*to))
            .filter(|edge| self.jump_along(skin, *edge).is_some())
            .collect();
        let first = mesh::index(skin.points.len());
        self.add_corners(skin, &crossed);
        for edge in &crossed {
            if let (Some(half), Some(place)) = (between(skin, edge.0, edge.1), self.jump_along(skin, *edge)) {
                skin.split(half, (place, skin.normal(edge.0), Kind::Edge));
            }
        }
        self.mark(skin, first);
        !crossed.is_empty()
    }

    /// Where normals jump along an edge of triangles.
    fn jump_along(&self, skin: &Skin, (from, to): (u32, u32)) -> Option<DVec3> {
        let (a, b) = (skin.point(from), skin.point(to));
        self.jump([(a, self.corner_normal(skin, from, b)), (b, self.corner_normal(skin, to, a))])
    }

    fn add_corners(&self, skin: &mut Skin, crossed: &[(u32, u32)]) {
        let key = |a: u32, b: u32| (u64::from(a.min(b)) << 32) | u64::from(a.max(b));
        let mut jumps: Quick<()> = Quick::default();
        jumps.extend(crossed.iter().map(|(a, b)| (key(*a, *b), ())));
        for triangle in 0..mesh::index(skin.triangles.len()) {
            let [a, b, c] = skin.triangles[triangle as usize];
            if skin.is_alive(triangle)
                && [(a, b), (b, c), (c, a)].iter().all(|(from, to)| jumps.contains_key(&key(*from, *to)))
                && let Some(place) = self.settle_on_corner([a, b, c].map(|corner| skin.point(corner)))
            {
                skin.split_face(triangle, (place, skin.normal(a), Kind::Corner));
            }
        }
    }

    /// Marks edges of triangles that are edges of the surface, and what their ends are. Points from `first` on are new: two
    /// of them that are joined were put on two sides of one triangle, or on a side and into its middle, so that the edge
    /// of the surface runs from one to the other. Only where three were put on the sides of one triangle normals decide.
    fn mark(&self, skin: &mut Skin, first: u32) {
        let edges: Vec<u32> = skin.edges().collect();
        let new = |point: u32| point >= first;
        for half in edges {
            let ends = [skin.from(half), skin.to(half)];
            if ends.iter().any(|end| skin.kind(*end) == Kind::Smooth) || !ends.iter().any(|end| new(*end)) {
                continue;
            }
            let across = [skin.across(half), skin.across(skin.twin(half))];
            let clear = ends.iter().all(|end| new(*end)) && !across.iter().any(|point| new(*point));
            let with_corner = ends.iter().any(|end| skin.kind(*end) == Kind::Corner);
            let sharp = clear || with_corner || self.is_edge(skin, half);
            skin.set_sharp(half, sharp);
        }
        self.drop_islands(skin);
        for index in 0..mesh::index(skin.points.len()) {
            if matches!(skin.kind(index), Kind::Smooth | Kind::Held) || skin.starts[index as usize] == NONE {
                continue;
            }
            let count = skin.around(index).filter(|half| skin.is_sharp(*half)).count();
            skin.kinds[index as usize] = match count {
                2 => Kind::Edge,
                0 => Kind::Smooth,
                _ => Kind::Corner,
            };
            if count == 0
                && let Some((place, normal)) = self.settle(skin.point(index), self.size)
            {
                skin.points[index as usize] = place;
                skin.normals[index as usize] = normal;
            }
        }
    }

    /// A point so near to an edge that it was put on the other side of it is an island with a thin ring of edges around
    /// it: such rings are no edges of the surface.
    fn drop_islands(&self, skin: &mut Skin) {
        const LONGEST: usize = 16;
        const THIN: f64 = 0.01;
        let mut seen = vec![false; skin.points.len()];
        for start in 0..mesh::index(skin.points.len()) {
            if seen[start as usize] || skin.starts[start as usize] == NONE || skin.kind(start) != Kind::Edge {
                continue;
            }
            let Some(ring) = ring_of(skin, start, &mut seen).filter(|ring| ring.len() <= LONGEST) else {
                continue;
            };
            let places: Vec<DVec3> = ring.iter().map(|half| skin.point(skin.from(*half))).collect();
            let (mut area, mut length) = (DVec3::ZERO, 0.0);
            for (k, place) in places.iter().enumerate() {
                let after = places[(k + 1) % places.len()];
                area += (*place - places[0]).cross(after - places[0]) / 2.0;
                length += place.distance(after);
            }
            if area.length() < THIN * length * length {
                for half in ring {
                    skin.set_sharp(half, false);
                }
            }
        }
    }

    /// Whether normals jump across an edge of triangles.
    pub(super) fn is_edge(&self, skin: &Skin, half: u32) -> bool {
        let middle = skin.point(skin.from(half)).midpoint(skin.point(skin.to(half)));
        let sides = [skin.across(half), skin.across(skin.twin(half))];
        let [one, other] = sides.map(|side| self.normal_towards(middle, skin.point(side), ASIDE));
        one.dot(other) < cos_degrees(JUMP)
    }

    /// The place on the surface's edge across from the middle of an edge of triangles.
    pub(super) fn on_edge(&self, skin: &Skin, half: u32) -> Option<DVec3> {
        let middle = skin.point(skin.from(half)).midpoint(skin.point(skin.to(half)));
        let sides = [skin.across(half), skin.across(skin.twin(half))].map(|side| skin.point(side));
        self.settle_on_edge(middle, sides)
    }
}

/// The closed ring of edges of the surface through a point, where it has no branch.
fn ring_of(skin: &Skin, start: u32, seen: &mut [bool]) -> Option<Vec<u32>> {
    let mut ring = Vec::new();
    let (mut at, mut from) = (start, NONE);
    loop {
        seen[at as usize] = true;
        let sharp: Vec<u32> = skin.around(at).filter(|half| skin.is_sharp(*half)).collect();
        if sharp.len() != 2 {
            return None;
        }
        let half = if skin.to(sharp[0]) == from && from != NONE { sharp[1] } else { sharp[0] };
        ring.push(half);
        (from, at) = (at, skin.to(half));
        if at == start {
            return Some(ring);
        }
        if seen[at as usize] {
            return None;
        }
    }
}

/// The half-edge from one point to another, where there is one.
pub(super) fn between(skin: &Skin, from: u32, to: u32) -> Option<u32> {
    skin.around(from).find(|half| skin.to(*half) == to)
}
