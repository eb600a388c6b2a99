//! A closed surface of triangles that can be changed: edges split, turned and drawn together.
//!
//! Promise: every operation leaves a closed surface without branches and with the same genus; one that would not is
//! refused. Half-edge h runs from corner h % 3 of triangle h / 3 to the next corner; `twins` are the half-edges that run
//! back. Dead triangles and points stay in place until [`Skin::compact`].

use glam::DVec3;

use super::cells::Quick;
use crate::geometry::mesh;

/// No half-edge, no point.
pub(super) const NONE: u32 = u32::MAX;

/// What a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The surface is smooth around it.
    Smooth,
    /// It lies on an edge of the surface.
    Edge,
    /// It is a corner.
    Corner,
    /// It stays where it is, and so do triangles between such points.
    Held,
}

/// A closed surface of triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct Skin {
    pub(super) points: Vec<DVec3>,
    /// Unit gradients; of a point on an edge that of some side.
    pub(super) normals: Vec<DVec3>,
    pub(super) kinds: Vec<Kind>,
    /// Corners; the first of a dead triangle is [`NONE`].
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) twins: Vec<u32>,
    /// Whether the surface has an edge here.
    pub(super) sharp: Vec<bool>,
    /// A half-edge that starts at each point; [`NONE`] of a dead one.
    pub(super) starts: Vec<u32>,
}

pub(super) fn next(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

pub(super) fn before(half: u32) -> u32 {
    if half.is_multiple_of(3) { half + 2 } else { half - 1 }
}

impl Skin {
    /// Of triangles that share their edges in pairs; a place on an edge that is not shared, where there is one.
    pub(super) fn new(points: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, DVec3> {
        let count = points.len();
        let mut skin = Self {
            normals: vec![DVec3::ZERO; count],
            kinds: vec![Kind::Smooth; count],
            twins: vec![NONE; 3 * triangles.len()],
            sharp: vec![false; 3 * triangles.len()],
            starts: vec![NONE; count],
            points,
            triangles,
        };
        let mut open: Quick<u32> = Quick::default();
        for half in 0..mesh::index(skin.twins.len()) {
            let (from, to) = (skin.from(half), skin.to(half));
            skin.starts[from as usize] = half;
            let key = |a: u32, b: u32| (u64::from(a) << 32) | u64::from(b);
            match open.remove(&key(to, from)) {
                Some(twin) => {
                    skin.twins[half as usize] = twin;
                    skin.twins[twin as usize] = half;
                }
                None => {
                    open.insert(key(from, to), half);
                }
            }
        }
        match skin.twins.iter().position(|twin| *twin == NONE) {
            Some(half) => Err(skin.point(skin.from(mesh::index(half)))),
            None => Ok(skin),
        }
    }

    pub(super) fn from(&self, half: u32) -> u32 {
        self.triangles[(half / 3) as usize][(half % 3) as usize]
    }

    pub(super) fn to(&self, half: u32) -> u32 {
        self.from(next(half))
    }

    /// The corner across from a half-edge.
    pub(super) fn across(&self, half: u32) -> u32 {
        self.from(before(half))
    }

    pub(super) fn twin(&self, half: u32) -> u32 {
        self.twins[half as usize]
    }

    pub(super) fn point(&self, index: u32) -> DVec3 {
        self.points[index as usize]
    }

    /// The middle of a triangle.
    pub(super) fn middle(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.triangles[triangle as usize].map(|corner| self.point(corner));
        (a + b + c) / 3.0
    }

    pub(super) fn normal(&self, index: u32) -> DVec3 {
        self.normals[index as usize]
    }

    pub(super) fn kind(&self, index: u32) -> Kind {
        self.kinds[index as usize]
    }

    pub(super) fn is_sharp(&self, half: u32) -> bool {
        self.sharp[half as usize]
    }

    pub(super) fn is_alive(&self, triangle: u32) -> bool {
        self.triangles[triangle as usize][0] != NONE
    }

    /// Whether a triangle stays as it is.
    pub(super) fn is_kept(&self, triangle: u32) -> bool {
        self.triangles[triangle as usize].into_iter().all(|corner| self.kind(corner) == Kind::Held)
    }

    /// Whether a triangle beside an edge stays as it is.
    pub(super) fn is_held(&self, half: u32) -> bool {
        self.is_kept(half / 3) || self.is_kept(self.twin(half) / 3)
    }

    /// Live half-edges, one of each pair.
    pub(super) fn edges(&self) -> impl Iterator<Item = u32> {
        (0..mesh::index(self.twins.len())).filter(|half| self.is_alive(half / 3) && *half < self.twin(*half))
    }

    /// Half-edges that start at a point, around it.
    pub(super) fn around(&self, index: u32) -> Around<'_> {
        let first = self.starts[index as usize];
        Around { skin: self, first, at: first, left: 4096 }
    }

    pub(super) fn set_sharp(&mut self, half: u32, sharp: bool) {
        let twin = self.twin(half);
        self.sharp[half as usize] = sharp;
        self.sharp[twin as usize] = sharp;
    }

    fn pair(&mut self, a: u32, b: u32) {
        self.twins[a as usize] = b;
        self.twins[b as usize] = a;
    }

    fn add_triangle(&mut self, corners: [u32; 3]) -> u32 {
        self.triangles.push(corners);
        self.twins.extend([NONE; 3]);
        self.sharp.extend([false; 3]);
        mesh::index(3 * (self.triangles.len() - 1))
    }

    pub(super) fn add_point(&mut self, point: DVec3, normal: DVec3, kind: Kind) -> u32 {
        self.points.push(point);
        self.normals.push(normal);
        self.kinds.push(kind);
        self.starts.push(NONE);
        mesh::index(self.points.len() - 1)
    }

    /// Puts a new point on an edge:
    ///
    /// ```text
    ///      c             c
    ///     / \           /|\
    ///    a---b   ->    a-v-b
    ///     \ /           \|/
    ///      d             d
    /// ```
    ///
    /// Half-edge `half` runs from a to v afterwards.
    pub(super) fn split(&mut self, half: u32, (point, normal, kind): (DVec3, DVec3, Kind)) -> u32 {
        let twin = self.twin(half);
        let (b, c, d) = (self.to(half), self.across(half), self.across(twin));
        let v = self.add_point(point, normal, kind);
        let sharp = self.is_sharp(half);
        let (bc, ad) = (next(half), next(twin));
        let (outer_bc, outer_bd) = (self.twin(bc), self.twin(before(twin)));
        let (sharp_bc, sharp_bd) = (self.is_sharp(bc), self.is_sharp(before(twin)));
        let bd = before(twin);
        // Triangle a b c becomes a v c, and v b c is new; triangle b a d becomes v a d, and b v d is new.
        let one = self.add_triangle([v, b, c]);
        let other = self.add_triangle([b, v, d]);
        self.triangles[(half / 3) as usize][(next(half) % 3) as usize] = v;
        self.triangles[(twin / 3) as usize][(twin % 3) as usize] = v;
        self.pair(one, other);
        self.pair(one + 1, outer_bc);
        self.pair(one + 2, bc);
        // `bd` runs from d to the start of `twin`: now from d to v.
        self.pair(other + 1, bd);
        self.pair(other + 2, outer_bd);
        self.set_sharp(one, sharp);
        self.set_sharp(one + 1, sharp_bc);
        self.set_sharp(other + 2, sharp_bd);
        self.set_sharp(bc, false);
        self.set_sharp(bd, false);
        self.starts[v as usize] = one;
        self.starts[b as usize] = one + 1;
        self.starts[c as usize] = before(half);
        self.starts[d as usize] = bd;
        let _ = ad;
        v
    }

    /// Puts a new point into a triangle.
    pub(super) fn split_face(&mut self, triangle: u32, (point, normal, kind): (DVec3, DVec3, Kind)) -> u32 {
        let [a, b, c] = self.triangles[triangle as usize];
        let v = self.add_point(point, normal, kind);
        let first = 3 * triangle;
        let (outer_bc, outer_ca) = (self.twin(first + 1), self.twin(first + 2));
        let (sharp_bc, sharp_ca) = (self.is_sharp(first + 1), self.is_sharp(first + 2));
        self.triangles[triangle as usize] = [a, b, v];
        let two = self.add_triangle([b, c, v]);
        let three = self.add_triangle([c, a, v]);
        self.pair(two, outer_bc);
        self.pair(three, outer_ca);
        self.pair(first + 1, two + 2);
        self.pair(two + 1, three + 2);
        self.pair(three + 1, first + 2);
        self.set_sharp(two, sharp_bc);
        self.set_sharp(three, sharp_ca);
        for half in [first + 1, first + 2, two + 1] {
            self.set_sharp(half, false);
        }
        self.starts[v as usize] = first + 2;
        self.starts[a as usize] = first;
        self.starts[b as usize] = two;
        self.starts[c as usize] = three;
        v
    }

    /// Whether an edge can be turned without making two edges between the same points.
    pub(super) fn can_turn(&self, half: u32) -> bool {
        let (c, d) = (self.across(half), self.across(self.twin(half)));
        c != d && !self.is_sharp(half) && self.around(c).all(|other| self.to(other) != d)
    }

    /// Turns an edge in the quadrilateral of its two triangles: a-b becomes d-c.
    pub(super) fn turn(&mut self, half: u32) {
        let twin = self.twin(half);
        let (a, b, c, d) = (self.from(half), self.to(half), self.across(half), self.across(twin));
        let (bc, ca, ad, db) = (next(half), before(half), next(twin), before(twin));
        let outer = [bc, ca, ad, db].map(|side| (self.twin(side), self.is_sharp(side)));
        // Triangle of `half` becomes d c a ... with half-edges: half d-c, next c-a, before a-d.
        let (one, other) = ((half / 3) as usize, (twin / 3) as usize);
        let set = |triangles: &mut Vec<[u32; 3]>, triangle: usize, half: u32, corners: [u32; 3]| {
            for (k, corner) in corners.into_iter().enumerate() {
                let place = (half as usize % 3 + k) % 3;
                triangles[triangle][place] = corner;
            }
        };
        set(&mut self.triangles, one, half, [d, c, a]);
        set(&mut self.triangles, other, twin, [c, d, b]);
        let places = [before(twin), next(half), before(half), next(twin)];
        for (place, (outer, sharp)) in places.into_iter().zip(outer) {
            self.pair(place, outer);
            self.set_sharp(place, sharp);
        }
        self.pair(half, twin);
        self.set_sharp(half, false);
        self.starts[a as usize] = before(half);
        self.starts[b as usize] = before(twin);
        self.starts[c as usize] = next(half);
        self.starts[d as usize] = next(twin);
    }

    /// Whether the start of a half-edge can be drawn into its end: the only points that both ends are joined to are the
    /// two across, and more than a tetrahedron is left.
    pub(super) fn can_collapse(&self, half: u32) -> bool {
        let (a, b) = (self.from(half), self.to(half));
        let (c, d) = (self.across(half), self.across(self.twin(half)));
        if c == d {
            return false;
        }
        let common = self.around(a).map(|other| self.to(other)).filter(|p| *p != b);
        let common = common.filter(|p| self.around(b).any(|other| self.to(other) == *p));
        let mut count = 0;
        for point in common {
            if point != c && point != d {
                return false;
            }
            count += 1;
        }
        // Points across must keep three edges.
        count == 2 && self.around(c).nth(3).is_some() && self.around(d).nth(3).is_some()
    }

    /// Draws the start of a half-edge into its end.
    pub(super) fn collapse(&mut self, half: u32) {
        let twin = self.twin(half);
        let (a, b, c, d) = (self.from(half), self.to(half), self.across(half), self.across(twin));
        let fan: Vec<u32> = self.around(a).collect();
        for out in fan {
            self.triangles[(out / 3) as usize][(out % 3) as usize] = b;
        }
        let glue = |skin: &mut Self, one: u32, other: u32| {
            let sharp = skin.is_sharp(one) || skin.is_sharp(other);
            let (p, q) = (skin.twin(one), skin.twin(other));
            skin.pair(p, q);
            skin.set_sharp(p, sharp);
            (p, q)
        };
        let (bc, _) = glue(self, next(half), before(half));
        let (da, _) = glue(self, before(twin), next(twin));
        self.triangles[(half / 3) as usize] = [NONE; 3];
        self.triangles[(twin / 3) as usize] = [NONE; 3];
        self.starts[a as usize] = NONE;
        // `bc` is the twin of b-c: it runs from c to b. `da` is the twin of d-b: it runs from b to d.
        self.starts[c as usize] = bc;
        self.starts[b as usize] = self.twin(bc);
        self.starts[d as usize] = self.twin(da);
    }

    /// Throws away what is dead.
    pub(super) fn tidy(&mut self) {
        let (kept, triangles) = self.compact();
        let pick = |index: &u32| *index as usize;
        let alive = (0..mesh::index(self.triangles.len())).filter(|triangle| self.is_alive(*triangle));
        let halves: Vec<u32> = alive.flat_map(|triangle| 3 * triangle..3 * triangle + 3).collect();
        let mut names = vec![NONE; self.twins.len()];
        for (new, old) in halves.iter().enumerate() {
            names[*old as usize] = mesh::index(new);
        }
        let twins = halves.iter().map(|old| names[pick(&self.twins[pick(old)])]).collect();
        let sharp = halves.iter().map(|old| self.sharp[pick(old)]).collect();
        let starts = kept.iter().map(|old| names[pick(&self.starts[pick(old)])]).collect();
        *self = Self {
            points: kept.iter().map(|old| self.points[pick(old)]).collect(),
            normals: kept.iter().map(|old| self.normals[pick(old)]).collect(),
            kinds: kept.iter().map(|old| self.kinds[pick(old)]).collect(),
            triangles,
            twins,
            sharp,
            starts,
        };
    }

    /// Without what is dead.
    pub(super) fn compact(&self) -> (Vec<u32>, Vec<[u32; 3]>) {
        let mut names = vec![NONE; self.points.len()];
        let mut kept = Vec::new();
        let mut triangles = Vec::new();
        for corners in self.triangles.iter().filter(|corners| corners[0] != NONE) {
            triangles.push(corners.map(|corner| {
                let name = &mut names[corner as usize];
                if *name == NONE {
                    *name = mesh::index(kept.len());
                    kept.push(corner);
                }
                *name
            }));
        }
        (kept, triangles)
    }
}

/// Half-edges around a point.
pub(super) struct Around<'a> {
    skin: &'a Skin,
    first: u32,
    at: u32,
    /// A guard against a broken ring.
    left: u32,
}

impl Iterator for Around<'_> {
    type Item = u32;

    fn next(&mut self) -> Option<u32> {
        if self.at == NONE || self.left == 0 {
            return None;
        }
        let here = self.at;
        let after = self.skin.twin(before(here));
        self.left -= 1;
        self.at = if after == self.first { NONE } else { after };
        Some(here)
    }
}
