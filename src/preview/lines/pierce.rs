//! Lines in which triangles run through each other.
//!
//! Promise: each pair of triangles that share no corner and cross at more than a degree adds the segment in which they meet;
//! segments of neighbors have a common end. Not promised: lines of triangles that only touch, lie on each other, or cross from
//! a corner that they share.
//!
//! Cost: a tree of boxes over the triangles, and a few determinants for each pair whose boxes meet.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

use super::feature::{Edge, Kind};
use crate::geometry::mesh::crossing::{Pierced, segment};
use crate::geometry::mesh::tree::Tree;
use crate::geometry::number::count_of;
use crate::preview::camera::Camera;
use crate::preview::stage::Stage;

/// Triangles whose planes meet at an angle of less than this sine, a degree, lie on each other rather than cross.
const FLAT: f64 = 0.0175;

/// The end of a segment: an edge of one triangle, by its points, and the triangle that it runs through. Triangles at both
/// sides of the edge have the same.
type End = ([u32; 2], u32);

/// The segments in which triangles cross, by the numbers of their points.
pub(super) fn edges(stage: &Stage, camera: &Camera, points: &[u32]) -> Vec<Edge> {
    let places: Vec<DVec3> = stage.vertices.iter().map(|vertex| vertex.point).collect();
    let tree = Tree::new(&places, &stage.triangles);
    let corners = |triangle: u32| stage.triangles[triangle as usize];
    let solid = |triangle: u32| corners(triangle).map(|corner| places[corner as usize]);
    let numbers = |triangle: u32| corners(triangle).map(|corner| points[corner as usize]);
    let across = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize_or_zero();
    let found: Vec<([u32; 2], [Pierced; 2])> = (0..count_of(stage.triangles.len()))
        .into_par_iter()
        .with_min_len(64)
        .flat_map_iter(|one| {
            let mut all = Vec::new();
            let (own, normal, named) = (solid(one), across(solid(one)), numbers(one));
            tree.visit(one, |other| {
                let others = numbers(other);
                if !named.iter().any(|point| others.contains(point))
                    && normal.cross(across(solid(other))).length() > FLAT
                    && let Some(ends) = segment(own, solid(other))
                {
                    all.push(([one, other], ends));
                }
                true
            });
            all
        })
        .collect();
    let mut known: BTreeMap<End, u32> = BTreeMap::new();
    let first = points.iter().copied().max().map_or(0, |last| last + 1);
    let mut edges = Vec::with_capacity(found.len());
    for (pair, ends) in found {
        let [Some(from), Some(to)] = ends.map(|end| camera.project(end.point)) else { continue };
        let number = ends.map(|end| {
            let named = numbers(pair[end.triangle]);
            let (a, b) = (named[end.side], named[(end.side + 1) % 3]);
            let next = first + count_of(known.len());
            *known.entry(([a.min(b), a.max(b)], pair[1 - end.triangle])).or_insert(next)
        });
        edges.push(Edge { kind: Kind::Intersection, points: number, ends: [from, to], own: pair.to_vec() });
    }
    edges
}
