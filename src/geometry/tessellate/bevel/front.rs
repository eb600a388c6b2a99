//! Outlines that move inward at even speed: where their corners go, and which of their edges vanish.
//!
//! A front is a set of closed polygons, outlines counter-clockwise and holes clockwise, whose edges all move to
//! their left. A corner moves along the bisector of its edges; an edge that has shrunk to a point leaves, and its
//! neighbors meet. Corners where the inside turns by more than half a turn get edges of no length that fan out
//! around them, so that the front stays as far from the corner as from everything else. What an edge runs over
//! between two depths is a face of a roof of even slope.
//!
//! Promise: up to the depth that [`widest`] finds, fronts are the lines at even distance from the polygons, but for
//! fans, which lie outside of their arcs by the bound that [`Front::new`] is given. Not promised: anything of
//! deeper fronts, where parts of the outlines run into each other.
//!
//! Source: O. Aichholzer, F. Aurenhammer, D. Alberts, B. Gärtner, A novel type of skeleton for polygons, 1995; of its
//! events only those of edges.
//!
//! Cost: O(n log n) for n edges.

use core::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;

use crate::geometry::mesh;
use crate::geometry::number::{acos, floor_count, sin_cos};
use crate::geometry::planar::{first_contact, first_crossing};

/// A corner of a polygon that will move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Where it stands.
    pub(super) place: DVec2,
    /// Unit normals to the right of the curve that the polygon follows, before and after the corner.
    pub(super) outward: [DVec2; 2],
    /// Whether the surface on both sides of it is to look smooth.
    pub(super) smooth: bool,
    /// Parameters of the curve at the corner and at the end of the edge that follows.
    pub(super) t: [f64; 2],
    /// The same as shares of the length.
    pub(super) along: [f64; 2],
}

/// A place that a corner of the front passes, as the face to its left or right sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// Number of the point.
    pub(super) point: u32,
    /// Where it is.
    pub(super) place: DVec2,
    /// The share of the way between the two depths at which it was passed.
    pub(super) share: f64,
    /// Unit normal in the plane.
    pub(super) outward: DVec2,
}

/// What an edge ran over between two depths: what its two ends passed, in order.
#[derive(Clone, Debug)]
pub(super) struct Face {
    /// The edge.
    pub(super) edge: usize,
    /// What its first corner passed.
    pub(super) left: Vec<Passed>,
    /// What its second corner passed.
    pub(super) right: Vec<Passed>,
}

/// An edge that moves.
#[derive(Clone, Debug)]
struct Edge {
    /// Unit direction.
    along: DVec2,
    previous: usize,
    next: usize,
    gone: bool,
    /// Raised when what it knows of its end is out of date.
    version: u32,
    /// Where its first corner set out.
    place: DVec2,
    /// And at which depth.
    depth: f64,
    /// How its first corner moves.
    velocity: DVec2,
    /// Unit normals at its first corner, of the edge before and of its own.
    outward: [DVec2; 2],
    smooth: bool,
    /// What its ends passed since the last depth.
    left: Vec<Passed>,
    right: Vec<Passed>,
}

/// Where an edge lies on the curve that the polygon follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// Index of the outline.
    pub(super) outline: usize,
    /// Ends of the edge before it moved.
    pub(super) ends: [DVec2; 2],
    /// Unit direction.
    pub(super) direction: DVec2,
    /// Parameters of the curve there.
    pub(super) t: [f64; 2],
    /// Shares of its length.
    pub(super) along: [f64; 2],
}

/// Polygons on their way.
#[derive(Clone, Debug)]
pub(super) struct Front {
    edges: Vec<Edge>,
    /// For each edge, what it was.
    pub(super) stretches: Vec<Stretch>,
    /// An edge of each polygon that is still there.
    loops: Vec<usize>,
    /// The depth that is reached.
    depth: f64,
    /// The place of each point, and the share of the way at which it came to be.
    pub(super) points: Vec<(DVec2, f64)>,
    /// Lengths below this are nothing.
    pub(super) nothing: f64,
    /// For each point the one whose place it shares: itself, or an earlier one.
    same: Vec<u32>,
    /// Number of points before the present advance.
    settled: usize,
    /// Whether anything so short was left out.
    pub(super) merged: bool,
    /// Faces whose neighbors' normals differ by less look smooth: the cosine.
    crease: f64,
}

/// A front that ran into itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// No front is whole at this depth.
    pub depth: f64,
    /// Where.
    pub place: DVec2,
}

/// Lengths below this share of the reach are nothing: in single precision their ends are one place.
const NOTHING: f64 = 2e-7;

/// An edge that will vanish.
#[derive(PartialEq)]
struct Event {
    depth: f64,
    edge: usize,
    version: u32,
}

impl Eq for Event {}

impl Ord for Event {
    /// The shallowest is the greatest, of equals that of the first edge.
    fn cmp(&self, other: &Self) -> Ordering {
        other.depth.total_cmp(&self.depth).then(other.edge.cmp(&self.edge))
    }
}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Front {
    /// Polygons before they move. Fans stay within `round` of their arcs down to `deepest`; without a bound each
    /// turns by at most 15 degrees. Normals that differ by less than the angle of which `crease` is the cosine look
    /// smooth where edges that were apart come to meet.
    pub(super) fn new(outlines: &[Vec<Corner>], deepest: f64, round: Option<f64>, crease: f64) -> Self {
        let corners = outlines.iter().flatten();
        let size = corners.map(|corner| corner.place.abs().max_element()).fold(0.0, f64::max);
        let mut front = Self {
            edges: Vec::new(),
            stretches: Vec::new(),
            loops: Vec::new(),
            depth: 0.0,
            points: Vec::new(),
            nothing: NOTHING * size,
            same: Vec::new(),
            settled: 0,
            merged: false,
            crease,
        };
        let step = fan_step(deepest, round);
        for (outline, corners) in outlines.iter().enumerate() {
            front.add(outline, corners, step);
        }
        for edge in 0..front.edges.len() {
            let before = front.edges[edge].previous;
            front.edges[edge].velocity =
                bisector(front.edges[before].along, front.edges[edge].along).unwrap_or(DVec2::ZERO);
        }
        front
    }

    /// Adds the edges of a polygon.
    fn add(&mut self, outline: usize, corners: &[Corner], step: f64) {
        let first = self.edges.len();
        let count = corners.len();
        let direction = |k: usize| (corners[(k + 1) % count].place - corners[k].place).normalize_or_zero();
        for (k, corner) in corners.iter().enumerate() {
            let point = self.point(corner.place, 0.0) as usize;
            let (before, after) = (direction((k + count - 1) % count), direction(k));
            let turn = before.perp_dot(after);
            let angle = acos(before.dot(after).clamp(-1.0, 1.0));
            // Where the inside takes the larger part, edges of no length open a fan.
            let fans = if turn < 0.0 { floor_count((angle / step).ceil()).max(1) - 1 } else { 0 };
            let mut outward = corner.outward;
            if corner.smooth {
                let mean = (outward[0] + outward[1]).normalize_or(outward[1]);
                outward = [mean; 2];
            }
            let mut last = before;
            for fan in 1..=fans {
                let (sin, cos) = sin_cos(-angle * f64::from(fan) / f64::from(fans + 1));
                let along = before.rotate(DVec2::new(cos, sin));
                let normal = -last.perp() - along.perp();
                let seen = normal.normalize_or(-along.perp());
                let seen = if fan == 1 { outward[0] } else { seen };
                let stretch = Stretch {
                    outline,
                    ends: [corner.place; 2],
                    direction: along,
                    t: [corner.t[0]; 2],
                    along: [corner.along[0]; 2],
                };
                self.push(stretch, corner.place, [seen; 2], true, point);
                last = along;
            }
            let seen = if fans > 0 { [outward[1]; 2] } else { outward };
            let stretch = Stretch {
                outline,
                ends: [corner.place, corners[(k + 1) % count].place],
                direction: after,
                t: corner.t,
                along: corner.along,
            };
            self.push(stretch, corner.place, seen, corner.smooth || fans > 0, point);
        }
        let end = self.edges.len();
        for edge in first..end {
            self.edges[edge].previous = if edge == first { end - 1 } else { edge - 1 };
            self.edges[edge].next = if edge + 1 == end { first } else { edge + 1 };
        }
        for edge in first..end {
            let next = &self.edges[self.edges[edge].next];
            let passed = Passed { outward: next.outward[0], ..next.left[0] };
            self.edges[edge].right = vec![passed];
        }
        self.loops.push(first);
    }

    fn push(&mut self, stretch: Stretch, place: DVec2, outward: [DVec2; 2], smooth: bool, point: usize) {
        let passed = Passed { point: mesh::index(point), place, share: 0.0, outward: outward[1] };
        self.edges.push(Edge {
            along: stretch.direction,
            previous: 0,
            next: 0,
            gone: false,
            version: 0,
            place,
            depth: 0.0,
            velocity: DVec2::ZERO,
            outward,
            smooth,
            left: vec![passed],
            right: Vec::new(),
        });
        self.stretches.push(stretch);
    }

    /// The first corner of an edge at a depth.
    fn corner(&self, edge: usize, depth: f64) -> DVec2 {
        let edge = &self.edges[edge];
        edge.place + edge.velocity * (depth - edge.depth)
    }

    /// The depth at which an edge vanishes, if it shrinks; at once where it is no longer than rounding at `deepest`.
    fn vanishes(&self, edge: usize, deepest: f64) -> Option<f64> {
        let next = self.edges[edge].next;
        let along = self.edges[edge].along;
        let from = self.edges[edge].depth.max(self.edges[next].depth);
        let length = |depth: f64| (self.corner(next, depth) - self.corner(edge, depth)).dot(along);
        let rate = (self.edges[next].velocity - self.edges[edge].velocity).dot(along);
        if rate >= 0.0 {
            return None;
        }
        let depth = from + length(from).max(0.0) / -rate;
        if depth > deepest && length(deepest) <= self.nothing {
            return Some(deepest);
        }
        Some(depth)
    }

    /// Moves on to a depth and tells what the edges ran over.
    ///
    /// # Errors
    /// When a polygon vanishes before, or folds onto itself.
    pub(super) fn advance(&mut self, depth: f64) -> Result<Vec<Face>, Collision> {
        self.settled = self.points.len();
        let mut faces = Vec::new();
        let mut events = BinaryHeap::new();
        for edge in 0..self.edges.len() {
            self.expect(edge, depth, &mut events);
        }
        while let Some(Event { depth: at, edge, version }) = events.pop() {
            if self.edges[edge].gone || self.edges[edge].version != version {
                continue;
            }
            faces.push(self.remove(edge, (at, (at - self.depth) / (depth - self.depth)))?);
            let (previous, next) = (self.edges[edge].previous, self.edges[edge].next);
            for changed in [previous, next] {
                self.edges[changed].version += 1;
                self.expect(changed, depth, &mut events);
            }
        }
        self.depth = depth;
        self.settle(&mut faces, true);
        Ok(faces)
    }

    /// Goes up without moving inward.
    pub(super) fn rise(&mut self) -> Vec<Face> {
        let mut faces = Vec::new();
        self.settle(&mut faces, false);
        faces
    }

    fn expect(&self, edge: usize, deepest: f64, events: &mut BinaryHeap<Event>) {
        if self.edges[edge].gone {
            return;
        }
        if let Some(depth) = self.vanishes(edge, deepest)
            && depth <= deepest
        {
            events.push(Event { depth, edge, version: self.edges[edge].version });
        }
    }

    /// Takes an edge out that has shrunk to a point.
    fn remove(&mut self, edge: usize, (depth, share): (f64, f64)) -> Result<Face, Collision> {
        let (previous, next) = (self.edges[edge].previous, self.edges[edge].next);
        let place = (self.corner(edge, depth) + self.corner(next, depth)) / 2.0;
        let collision = Collision { depth, place };
        if previous == next || self.edges[previous].previous == next {
            // Three edges or fewer: the polygon is a point now.
            return Err(collision);
        }
        let velocity = bisector(self.edges[previous].along, self.edges[next].along).ok_or(collision)?;
        let point = self.meeting_point(edge, place, share);
        let normals = self.meeting_normals(previous, edge, next);
        let passed = |outward: DVec2| Passed { point, place, share, outward };
        self.edges[previous].right.push(passed(normals[0]));
        self.edges[next].left.push(passed(normals[2]));
        let mut left = std::mem::take(&mut self.edges[edge].left);
        let mut right = std::mem::take(&mut self.edges[edge].right);
        left.push(passed(normals[1]));
        right.push(passed(normals[1]));
        self.edges[edge].gone = true;
        self.edges[previous].next = next;
        let smooth = normals[0] == normals[2];
        let after = &mut self.edges[next];
        after.previous = previous;
        (after.place, after.depth, after.velocity) = (place, depth, velocity);
        (after.outward, after.smooth) = ([normals[0], normals[2]], smooth);
        for first in &mut self.loops {
            if *first == edge {
                *first = next;
            }
        }
        Ok(Face { edge, left, right })
    }

    /// The point where an edge ends: one that its ends have just passed, or a new one. Corners move, so what they
    /// pass at one place they pass at one depth.
    fn meeting_point(&mut self, edge: usize, place: DVec2, share: f64) -> u32 {
        let ends = [self.edges[edge].left.last(), self.edges[edge].right.last()];
        let here = |passed: &&Passed| passed.place.distance(place) <= self.nothing;
        let known: Vec<u32> = ends.into_iter().flatten().filter(here).map(|passed| passed.point).collect();
        self.merged |= !known.is_empty();
        if let [one, other] = known[..] {
            self.unite(one, other);
        }
        known.first().copied().unwrap_or_else(|| self.point(place, share))
    }

    fn point(&mut self, place: DVec2, share: f64) -> u32 {
        let point = mesh::index(self.points.len());
        self.points.push((place, share));
        self.same.push(point);
        point
    }

    /// The point that stands for a point.
    pub(super) fn stand_in(&self, mut point: u32) -> u32 {
        while self.same[point as usize] != point {
            point = self.same[point as usize];
        }
        point
    }

    /// Makes one of two points that share a place, unless faces that are told already know them apart.
    fn unite(&mut self, one: u32, other: u32) {
        let (one, other) = (self.stand_in(one), self.stand_in(other));
        let (first, second) = (one.min(other), one.max(other));
        if second as usize >= self.settled {
            self.same[second as usize] = first;
        }
    }

    /// Normals of three faces where the middle one ends: those that look smooth side by side share one.
    fn meeting_normals(&self, previous: usize, edge: usize, next: usize) -> [DVec2; 3] {
        let own = [previous, edge, next].map(|edge| -self.edges[edge].along.perp());
        let mean = |a: DVec2, b: DVec2| (a + b).normalize_or(a);
        let before = self.edges[edge].smooth;
        let after = self.edges[next].smooth;
        if before && after && own[0].dot(own[2]) >= self.crease {
            return [mean(own[0], own[2]); 3];
        }
        match (before, after) {
            (true, false) => [mean(own[0], own[1]), mean(own[0], own[1]), own[2]],
            (false, true) => [own[0], mean(own[1], own[2]), mean(own[1], own[2])],
            _ => own,
        }
    }

    /// Puts points where the corners are at the depth that is reached, and closes the faces there.
    fn settle(&mut self, faces: &mut Vec<Face>, moved: bool) {
        let mut reached = vec![(0, DVec2::ZERO); self.edges.len()];
        for first in self.loops.clone() {
            let around = self.around(first);
            for (k, edge) in around.iter().enumerate() {
                let place = self.corner(*edge, self.depth);
                let previous = self.edges[*edge].previous;
                let passed = [self.edges[*edge].left.last(), self.edges[previous].right.last()];
                let passed = passed.into_iter().flatten().find(|_| moved).copied();
                let passed = passed.filter(|passed| passed.place.distance(place) <= self.nothing);
                self.merged |= passed.is_some();
                // An edge of no length has both its ends at one point.
                let before = (k > 0).then(|| reached[previous]);
                let before = before.filter(|(_, there)| there.distance(place) <= self.nothing);
                let known = passed.map(|passed| passed.point).or(before.map(|(point, _)| point));
                reached[*edge] = (known.unwrap_or_else(|| self.point(place, 1.0)), place);
            }
            for edge in around {
                let next = self.edges[edge].next;
                let at = |front: &Self, corner: usize, side: usize| {
                    let (point, place) = reached[corner];
                    Passed { point, place, share: 1.0, outward: front.edges[corner].outward[side] }
                };
                let ends = (at(self, edge, 1), at(self, next, 0));
                let onward = |passed: Passed| vec![Passed { share: 0.0, ..passed }];
                let mut left = std::mem::replace(&mut self.edges[edge].left, onward(ends.0));
                let mut right = std::mem::replace(&mut self.edges[edge].right, onward(ends.1));
                left.push(ends.0);
                right.push(ends.1);
                faces.push(Face { edge, left, right });
            }
        }
    }

    /// The edges of a polygon in order, from one whose start is not the start of the edge before.
    fn around(&self, first: usize) -> Vec<usize> {
        let mut all = vec![first];
        let mut edge = self.edges[first].next;
        while edge != first {
            all.push(edge);
            edge = self.edges[edge].next;
        }
        let apart = |edge: &usize| {
            let previous = self.edges[*edge].previous;
            self.corner(*edge, self.depth).distance(self.corner(previous, self.depth)) > self.nothing
        };
        let start = all.iter().position(apart).unwrap_or(0);
        all.rotate_left(start);
        all
    }

    /// The polygons at the depth that is reached: their points, each with its place.
    pub(super) fn polygons(&self) -> Vec<Vec<(u32, DVec2)>> {
        let polygon = |first: &usize| {
            let start = |edge: usize| self.edges[edge].left[0];
            let starts = self.around(*first).into_iter().map(start);
            let mut corners: Vec<(u32, DVec2)> =
                starts.map(|passed| (self.stand_in(passed.point), passed.place)).collect();
            corners.dedup_by_key(|(point, _)| *point);
            corners
        };
        self.loops.iter().map(polygon).collect()
    }
}

/// Turn of one part of a fan, radians: its tip lies outside of the arc by `depth * (1 / cos(turn / 2) - 1)`.
fn fan_step(deepest: f64, round: Option<f64>) -> f64 {
    const COARSEST: f64 = core::f64::consts::FRAC_PI_4;
    let Some(round) = round else { return core::f64::consts::PI / 12.0 };
    if deepest <= 0.0 {
        return COARSEST;
    }
    (2.0 * acos(deepest / (deepest + round))).clamp(1e-4, COARSEST)
}

/// How a corner between two directions moves so that both its edges move to their left at speed 1; none where they
/// run against each other.
fn bisector(before: DVec2, after: DVec2) -> Option<DVec2> {
    let (one, other) = (before.perp(), after.perp());
    let share = 1.0 + one.dot(other);
    (share > 1e-9).then(|| (one + other) / share)
}

/// Moves polygons to a depth, and looks whether they ran into each other or themselves on the way.
///
/// # Errors
/// The place where they did; the depth is one at which they have.
pub(super) fn whole(outlines: &[Vec<Corner>], depth: f64, round: Option<f64>) -> Result<(), Collision> {
    let mut front = Front::new(outlines, depth, round, 1.0);
    front.advance(depth)?;
    let places: Vec<Vec<DVec2>> =
        (front.polygons().iter()).map(|polygon| polygon.iter().map(|(_, place)| *place).collect()).collect();
    for polygon in &places {
        if polygon.len() < 3 {
            return Err(Collision { depth, place: polygon.first().copied().unwrap_or(DVec2::ZERO) });
        }
        if let Some(crossing) = first_crossing(polygon, true) {
            return Err(Collision { depth, place: crossing.point });
        }
    }
    match first_contact(&places) {
        Some(contact) => Err(Collision { depth, place: contact.point }),
        None => Ok(()),
    }
}

/// The greatest depth, to a thousandth, at which polygons are still whole; none is asked for beyond `deepest`.
pub(super) fn widest(outlines: &[Vec<Corner>], deepest: f64, round: Option<f64>) -> f64 {
    let (mut low, mut high) = (0.0, deepest);
    while high - low > 1e-3 * high {
        let middle = (low + high) / 2.0;
        match whole(outlines, middle, round) {
            Ok(()) => low = middle,
            Err(collision) => high = middle.min(collision.depth.max(low)),
        }
        if high <= 1e-9 * deepest {
            break;
        }
    }
    low
}
