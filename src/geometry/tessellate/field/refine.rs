//! From rough triangles to few good ones within a tolerance.
//!
//! The distance of a triangle from the surface is known from the normals at its corners: along an edge the surface
//! bends away by an eighth of (difference of normals) . (difference of places), and within a triangle these three add up
//! as the quadratic that they define. So edges are split, drawn together and turned by their errors without asking the
//! field, which is asked once for each new point. Long triangles along what is straight follow by themselves.
//!
//! Sources: M. Botsch, L. Kobbelt, A remeshing approach to multiresolution modeling, 2004 (split, collapse, turn,
//! smooth); N. Dyn, D. Levin, S. Rippa, Data dependent triangulations, 1990 (turning by error).

use glam::DVec3;

use super::edges::ASIDE;
use super::probe::Probe;
use super::skin::{Kind, Skin, before, next};
use crate::geometry::mesh;

/// Normals of a triangle and of its corners differ by less than this: cosine of 55 degrees.
const UPRIGHT: f64 = 0.57;
/// Quality of the worst triangle that a change may make, where 1 is equilateral.
const NEEDLE: f64 = 0.03;
/// What a change may use of the tolerance: the estimate is of second order alone.
const USED: f64 = 0.95;

/// Changes triangles until they are good.
pub(super) struct Refiner<'a> {
    pub(super) probe: Probe<'a>,
    pub(super) skin: Skin,
    /// How far triangles may be from the surface.
    pub(super) tolerance: f64,
    /// Most triangles allowed.
    pub(super) limit: usize,
    /// Points around which something changed since edges were turned, and since they were drawn together.
    pub(super) changed: Changed,
}

/// Marks of points: what was looked at and left as it was need not be looked at again.
#[derive(Clone, Debug, Default)]
pub(super) struct Changed {
    turn: Vec<bool>,
    collapse: Vec<bool>,
}

impl Changed {
    /// Of so many points, all changed.
    pub(super) fn all(points: usize) -> Self {
        Self { turn: vec![true; points], collapse: vec![true; points] }
    }

    fn mark(&mut self, point: u32) {
        // A point that has no mark counts as changed.
        for marks in [&mut self.turn, &mut self.collapse] {
            if let Some(mark) = marks.get_mut(point as usize) {
                *mark = true;
            }
        }
    }
}

/// A corner: its place and the normal there.
type Corner = (DVec3, DVec3);

/// How far the surface is above the middle of a chord.
fn sag(a: Corner, b: Corner) -> f64 {
    0.125 * (b.1 - a.1).dot(b.0 - a.0)
}

/// 1 for an equilateral triangle, 0 for a flat one.
fn quality([a, b, c]: [DVec3; 3]) -> f64 {
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    let area = (b - a).cross(c - a).length();
    if squares > 0.0 { 2.0 * 1.732_050_807_568_877_2 * area / squares } else { 0.0 }
}

/// The least cosine between the normal of a triangle and those at its corners.
fn upright(corners: [Corner; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b.0 - a.0).cross(c.0 - a.0).normalize_or_zero();
    corners.iter().map(|corner| normal.dot(corner.1)).fold(1.0, f64::min)
}

/// Distance of a triangle from the surface, of second order.
fn error([a, b, c]: [Corner; 3]) -> f64 {
    let sags = [sag(a, b), sag(b, c), sag(c, a)];
    let middle = 4.0 / 9.0 * (sags[0] + sags[1] + sags[2]);
    sags.into_iter().fold(middle.abs(), |most, sag| most.max(sag.abs()))
}

impl Refiner<'_> {
    fn corners(&self, triangle: [u32; 3]) -> [Corner; 3] {
        let places = triangle.map(|corner| self.skin.point(corner));
        let middle = (places[0] + places[1] + places[2]) / 3.0;
        [0, 1, 2].map(|k| (places[k], self.probe.corner_normal(&self.skin, triangle[k], middle)))
    }

    /// Notes that all around a point has changed.
    pub(super) fn touch(&mut self, point: u32) {
        self.changed.mark(point);
        for half in self.skin.around(point) {
            self.changed.mark(self.skin.to(half));
        }
    }

    /// Splits edges until all triangles are within the tolerance; whether that could be done within the limits.
    pub(super) fn split(&mut self) -> bool {
        let mut stuck = 0;
        let mut last = usize::MAX;
        for _ in 0..24 {
            let mut wanted = self.too_far();
            // Where the surface is singular some never come near.
            stuck = if wanted.len() < last { 0 } else { stuck + 1 };
            last = wanted.len();
            if wanted.is_empty() || stuck == 3 {
                return true;
            }
            wanted.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut touched = vec![false; self.skin.triangles.len()];
            let mut any = false;
            for (_, half) in wanted {
                let twin = self.skin.twin(half);
                let sides = [half / 3, twin / 3].map(|side| side as usize);
                if sides.iter().any(|side| touched[*side]) {
                    continue;
                }
                for side in sides {
                    touched[side] = true;
                }
                let split = self.split_edge(half);
                if let Some(point) = split.or_else(|| self.split_any(half / 3)) {
                    any = true;
                    self.touch(point);
                }
                touched.resize(self.skin.triangles.len(), true);
                if self.skin.triangles.len() > self.limit || self.probe.is_spent() {
                    return false;
                }
            }
            if !any {
                return true;
            }
        }
        true
    }

    /// Of each triangle that is too far from the surface the edge that is furthest.
    fn too_far(&self) -> Vec<(f64, u32)> {
        let mut wanted = Vec::new();
        for triangle in (0..mesh::index(self.skin.triangles.len())).filter(|t| self.skin.is_alive(*t)) {
            let corners = self.corners(self.skin.triangles[triangle as usize]);
            let error = error(corners);
            if error <= self.tolerance * USED {
                continue;
            }
            let key = |k: usize| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                sag(a, b).abs() + 1e-3 * a.0.distance(b.0)
            };
            let worst = [1, 2].into_iter().fold(0, |best, k| if key(k) > key(best) { k } else { best });
            let half = 3 * triangle + mesh::index(worst);
            wanted.push((error, half));
        }
        for half in self.skin.edges().filter(|half| self.skin.is_sharp(*half)) {
            let sag = self.sharp_sag(half);
            if sag > self.tolerance * USED {
                wanted.push((sag, half));
            }
        }
        wanted
    }

    /// How far an edge of the surface is from the edge of triangles that stands for it.
    fn sharp_sag(&self, half: u32) -> f64 {
        let (a, b) = (self.skin.point(self.skin.from(half)), self.skin.point(self.skin.to(half)));
        if a.distance(b) < 4.0 * self.tolerance {
            return 0.0;
        }
        self.probe.on_edge(&self.skin, half).map_or(0.0, |place| place.distance(a.midpoint(b)))
    }

    /// Splits an edge where that folds no triangle over: beside an edge of the surface the nearest place to the middle may
    /// lie behind it.
    pub(super) fn split_edge(&mut self, half: u32) -> Option<u32> {
        if self.skin.is_held(half) {
            return None;
        }
        let (from, to) = (self.skin.from(half), self.skin.to(half));
        let (a, b) = (self.skin.point(from), self.skin.point(to));
        let (place, normal, kind) = if self.skin.is_sharp(half) {
            (self.probe.on_edge(&self.skin, half)?, self.skin.normal(from), Kind::Edge)
        } else {
            let length = a.distance(b);
            if length < 1e-7 * self.probe.size {
                return None;
            }
            let (place, normal) = self.probe.settle(a.midpoint(b), 0.5 * length)?;
            (place, normal, Kind::Smooth)
        };
        let by_edges = [from, to, self.skin.across(half), self.skin.across(self.skin.twin(half))]
            .iter()
            .any(|corner| self.skin.kind(*corner) != Kind::Smooth);
        if by_edges && !self.stays_upright(half, (place, normal, kind)) {
            return None;
        }
        Some(self.skin.split(half, (place, normal, kind)))
    }

    /// Whether the four triangles that a new point on an edge makes are no steeper than the two before, or steep.
    fn stays_upright(&self, half: u32, (place, normal, kind): (DVec3, DVec3, Kind)) -> bool {
        let skin = &self.skin;
        [half, skin.twin(half)].into_iter().all(|half| {
            let [a, b, c] = [skin.from(half), skin.to(half), skin.across(half)];
            let before = upright(self.corners([a, b, c]));
            [[c, a], [b, c]].into_iter().all(|ends| {
                let middle = (place + skin.point(ends[0]) + skin.point(ends[1])) / 3.0;
                let own = match kind {
                    Kind::Smooth => normal,
                    Kind::Edge | Kind::Corner | Kind::Held => self.probe.normal_towards(place, middle, ASIDE),
                };
                let corner = |point: u32| (skin.point(point), self.probe.corner_normal(skin, point, middle));
                upright([(place, own), corner(ends[0]), corner(ends[1])]) >= UPRIGHT.min(before)
            })
        })
    }

    /// Splits the longest edge of a triangle that can be split.
    pub(super) fn split_any(&mut self, triangle: u32) -> Option<u32> {
        let mut sides = [0, 1, 2].map(|k| {
            let half = 3 * triangle + k;
            (self.skin.point(self.skin.from(half)).distance(self.skin.point(self.skin.to(half))), half)
        });
        sides.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        sides.into_iter().find_map(|(_, half)| self.split_edge(half))
    }

    /// Draws edges together as long as triangles stay within the tolerance; how many there were.
    pub(super) fn collapse(&mut self) -> usize {
        let mut all: Vec<(f64, u32)> = Vec::new();
        for half in self.skin.edges() {
            let ends = [self.skin.from(half), self.skin.to(half)];
            if !ends.iter().any(|end| self.changed.collapse.get(*end as usize) != Some(&false)) {
                continue;
            }
            let corners = ends.map(|end| (self.skin.point(end), self.skin.normal(end)));
            let length = corners[0].0.distance(corners[1].0) / self.probe.size;
            all.push((sag(corners[0], corners[1]).abs() / self.tolerance + 0.05 * length, half));
        }
        all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        self.changed.collapse = vec![false; self.skin.points.len()];
        let mut count = 0;
        let mut ring = Vec::new();
        for (_, half) in all {
            if !self.skin.is_alive(half / 3) {
                continue;
            }
            let twin = self.skin.twin(half);
            let costs = [half, twin].map(|half| self.cost_of_collapse(half, &mut ring));
            let best = if costs[0] <= costs[1] { (costs[0], half) } else { (costs[1], twin) };
            if best.0 <= self.tolerance * USED && self.skin.can_collapse(best.1) {
                let left = self.skin.to(best.1);
                self.skin.collapse(best.1);
                self.touch(left);
                count += 1;
            }
        }
        count
    }

    /// The greatest error around an edge after its start is drawn into its end; infinite where it must not be.
    pub(super) fn cost_of_collapse(&self, half: u32, ring: &mut Vec<u32>) -> f64 {
        let skin = &self.skin;
        let (a, b) = (skin.from(half), skin.to(half));
        match skin.kind(a) {
            Kind::Corner | Kind::Held => return f64::INFINITY,
            Kind::Edge if !skin.is_sharp(half) => return f64::INFINITY,
            _ => {}
        }
        // The sides of a triangle that falls flat become one edge: both must not be edges of the surface.
        let merged = [(next(half), before(half)), (before(skin.twin(half)), next(skin.twin(half)))];
        if merged.iter().any(|(one, other)| skin.is_sharp(*one) && skin.is_sharp(*other)) {
            return f64::INFINITY;
        }
        ring.clear();
        ring.extend(skin.around(a));
        let (first, second) = (half, next(skin.twin(half)));
        let mut cost: f64 = 0.0;
        for out in ring.iter().filter(|out| **out != first && **out != second) {
            let (x, y) = (skin.to(*out), skin.across(*out));
            let corners = self.corners([b, x, y]);
            let error = error(corners);
            if error > self.tolerance * USED {
                return f64::INFINITY;
            }
            let places = corners.map(|corner| corner.0);
            let was = quality([skin.point(a), places[1], places[2]]);
            // A needle has no normal of its own: then it is enough that none gets worse.
            let steep = upright(corners);
            if steep < UPRIGHT && steep < upright(self.corners([a, x, y])) {
                return f64::INFINITY;
            }
            if quality(places) < NEEDLE.min(0.5 * was) {
                return f64::INFINITY;
            }
            cost = cost.max(error);
        }
        if skin.kind(a) == Kind::Edge {
            cost = cost.max(self.sag_after(a, b));
        }
        cost
    }

    /// Throws away what is dead.
    pub(super) fn tidy(&mut self) {
        self.skin.tidy();
        self.changed = Changed::all(self.skin.points.len());
    }

    /// How far an edge of the surface is from the straight line that is left when the point `a` on it is drawn to `b`.
    fn sag_after(&self, a: u32, b: u32) -> f64 {
        let skin = &self.skin;
        let Some(other) = skin.around(a).find(|half| skin.is_sharp(*half) && skin.to(*half) != b) else {
            return f64::INFINITY;
        };
        let (from, to) = (skin.point(b), skin.point(skin.to(other)));
        let middle = from.midpoint(to);
        let sides = [skin.across(other), skin.across(skin.twin(other))].map(|side| skin.point(side));
        self.probe.settle_on_edge(middle, sides).map_or(f64::INFINITY, |place| place.distance(middle))
    }

    /// Turns edges where that brings triangles nearer to the surface, or where both are near makes them rounder; how many.
    pub(super) fn turn(&mut self) -> usize {
        let changed = std::mem::take(&mut self.changed.turn);
        let mark = |point: u32| changed.get(point as usize) != Some(&false);
        let skin = &self.skin;
        let corners =
            |half: u32| [skin.from(half), skin.to(half), skin.across(half), skin.across(skin.twin(half))];
        let edges: Vec<u32> = skin.edges().filter(|half| corners(*half).into_iter().any(mark)).collect();
        self.changed.turn = vec![false; self.skin.points.len()];
        let mut count = 0;
        for half in edges {
            if self.is_better_turned(half) && self.skin.can_turn(half) {
                self.skin.turn(half);
                for corner in [half, next(half), before(half), before(self.skin.twin(half))] {
                    let point = self.skin.from(corner);
                    self.changed.mark(point);
                }
                count += 1;
            }
        }
        count
    }

    fn is_better_turned(&self, half: u32) -> bool {
        let skin = &self.skin;
        if skin.is_sharp(half) || skin.is_held(half) {
            return false;
        }
        let (a, b) = (skin.from(half), skin.to(half));
        let (c, d) = (skin.across(half), skin.across(skin.twin(half)));
        let (now, turned) = ([[a, b, c], [b, a, d]], [[d, c, a], [c, d, b]]);
        let errors =
            |pair: [[u32; 3]; 2]| pair.map(|t| error(self.corners(t))).into_iter().fold(0.0, f64::max);
        let (before, after) = (errors(now), errors(turned));
        let steepest =
            |pair: [[u32; 3]; 2]| pair.map(|t| upright(self.corners(t))).into_iter().fold(1.0, f64::min);
        let (steep, steep_after) = (steepest(now), steepest(turned));
        if steep_after < UPRIGHT && steep_after <= steep {
            return false;
        }
        if steep < UPRIGHT && steep_after >= UPRIGHT {
            return after <= before.max(self.tolerance);
        }
        let least = |pair: [[u32; 3]; 2]| {
            pair.map(|t| quality(t.map(|corner| skin.point(corner))))
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        };
        let (shape, shape_after) = (least(now), least(turned));
        if shape_after < NEEDLE.min(0.5 * shape) {
            return false;
        }
        // What is far within the tolerance may as well be round.
        let near = 0.3 * self.tolerance;
        if before.max(after) <= near {
            shape_after > 1.01 * shape
        } else {
            after < 0.98 * before.max(near) && after < 0.98 * before
        }
    }

    /// Moves points to the middles of their neighbors and back to the surface, where no triangle suffers.
    pub(super) fn smooth(&mut self) {
        for index in 0..mesh::index(self.skin.points.len()) {
            if self.probe.is_spent() {
                return;
            }
            if self.skin.starts[index as usize] != super::skin::NONE && self.skin.kind(index) == Kind::Smooth
            {
                self.smooth_point(index);
            }
        }
    }

    fn smooth_point(&mut self, index: u32) {
        let ring: Vec<u32> = self.skin.around(index).collect();
        let (old, normal) = (self.skin.point(index), self.skin.normal(index));
        let sum: DVec3 = ring.iter().map(|half| self.skin.point(self.skin.to(*half))).sum();
        let middle = sum / ring.len() as f64;
        let aim = old + (middle - old).reject_from_normalized(normal) * 0.7;
        let reach = aim.distance(old);
        let worst = |refiner: &Self| {
            ring.iter().fold((0.0_f64, f64::INFINITY, 1.0_f64), |(most, least, steep), half| {
                let corners = refiner.corners(refiner.skin.triangles[(*half / 3) as usize]);
                (
                    most.max(error(corners)),
                    least.min(quality(corners.map(|corner| corner.0))),
                    steep.min(upright(corners)),
                )
            })
        };
        let before = worst(self);
        let Some((place, turned)) = self.probe.settle(aim, reach.max(1e-6 * self.probe.size)) else { return };
        (self.skin.points[index as usize], self.skin.normals[index as usize]) = (place, turned);
        let after = worst(self);
        let allowed = before.0.max(0.8 * self.tolerance * USED);
        if after.0 > allowed || after.1 < 0.9 * before.1.min(0.3) || after.2 < UPRIGHT.min(before.2) {
            (self.skin.points[index as usize], self.skin.normals[index as usize]) = (old, normal);
        } else {
            self.touch(index);
        }
    }

    /// Splits, draws together, turns and smooths until little changes; whether the limit and the budget allowed it.
    pub(super) fn run(&mut self) -> bool {
        // First triangles may be needles: they go before anything is measured on them.
        for _ in 0..2 {
            self.turn();
            self.draw_short();
            self.unfold(f64::INFINITY);
            self.collapse();
            self.smooth();
        }
        self.tidy();
        for round in 0..ROUNDS {
            if !self.split() {
                return false;
            }
            self.turn();
            for _ in 0..6 {
                let count = self.collapse();
                self.turn();
                if count * 30 < self.skin.triangles.len() {
                    break;
                }
            }
            if round + 1 < ROUNDS {
                self.smooth();
                self.turn();
            }
        }
        self.split()
    }
}

/// How often everything is gone through.
const ROUNDS: u32 = 3;
