//! A mesh put on the surfaces of another model.

use std::collections::HashMap;

use glam::DVec3;

use super::super::shape::Made;
use super::super::source::Sources;
use super::cast::Casts;
use super::chart::{Charts, deviation};
use super::{Member, sampled};
use crate::geometry::curve::Side;
use crate::geometry::mesh::{Anchor, Mesh, PolygonMesh, VertexIndex};
use crate::geometry::number::acos;
use crate::geometry::tessellate::Deviation;
use crate::model::{Model, Recipe, ShapeHandle, Smoothing};

/// A mesh on other surfaces.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    pub(super) points: Vec<DVec3>,
    /// For each vertex.
    pub(super) normals: Vec<DVec3>,
    /// For each vertex its place on the other surfaces.
    pub(super) anchors: Vec<Anchor>,
    pub(super) deviation: Deviation,
}

impl Default for Carried {
    fn default() -> Self {
        Self { points: Vec::new(), normals: Vec::new(), anchors: Vec::new(), deviation: Deviation::NONE }
    }
}

impl Carried {
    /// A mesh where it is.
    pub(super) fn own(made: &Made) -> Self {
        let vertices = &made.mesh.vertices;
        Self {
            points: made.mesh.points.clone(),
            normals: vertices.iter().map(|vertex| vertex.normal).collect(),
            anchors: vertices.iter().map(|vertex| vertex.anchor).collect(),
            deviation: made.deviation,
        }
    }
}

/// Where normals of a carried vertex come from.
#[derive(Clone, Copy)]
enum Normal {
    /// Known.
    Known(DVec3),
    /// The triangles around it.
    Around,
}

/// The mesh of one member on the surfaces of another; none where they do not correspond.
pub(super) fn carry(
    (plan, from): (&Member<'_>, &Sources),
    (member, to): (&Member<'_>, &Sources),
) -> Option<Carried> {
    let (mesh, other) = (&plan.made.mesh, &member.made.mesh);
    let count = mesh.triangles.len();
    let every = |_: &[VertexIndex; 3]| true;
    let mut points: Vec<Option<DVec3>> = vec![None; mesh.points.len()];
    let mut normals = vec![Normal::Around; mesh.vertices.len()];
    let mut anchors: Vec<Anchor> = mesh.vertices.iter().map(|vertex| vertex.anchor).collect();
    let mut own = false;
    let take =
        |found: &Match, points: &mut [Option<DVec3>], normals: &mut [Normal], anchors: &mut [Anchor]| {
            for (point, of) in &found.points {
                points[*point as usize] = Some(other.points[*of as usize]);
            }
            for (vertex, of) in &found.vertices {
                let of = other.vertices[*of as usize];
                normals[*vertex as usize] = Normal::Known(of.normal);
                anchors[*vertex as usize] = of.anchor;
            }
        };
    if mesh.points.len() == other.points.len()
        && count == other.triangles.len()
        && runs(mesh) == runs(other)
        && let Some(found) = matched(mesh, other, every)
    {
        take(&found, &mut points, &mut normals, &mut anchors);
        own = true;
    }
    let equal = !own
        && mesh.points.len() == other.points.len()
        && same_polygons((plan.model, plan.shape), (member.model, member.shape));
    if equal {
        // Polygons may be cut into triangles in other ways; their points are the same.
        points = other.points.iter().map(|point| Some(*point)).collect();
        own = true;
    }
    let flat = plan.model.shape(plan.shape).options.smoothing == Smoothing::Flat;
    let charts = if own { None } else { Some(Charts::between(from, to)?) };
    let casts = Casts::between((plan.model, plan.shape), (member.model, member.shape), (from, to));
    let casts = casts.filter(|_| !own);
    if let Some(charts) = &charts {
        for source in 0..charts.len() {
            let of = |mesh: &Mesh, triangle: &[VertexIndex; 3]| {
                let corners =
                    triangle.map(|vertex| mesh.vertices[vertex.subscript()].anchor.source == source);
                (corners.contains(&true), corners == [true; 3])
            };
            let pure = |mesh: &Mesh| {
                mesh.triangles.iter().all(|triangle| {
                    let (some, all) = of(mesh, triangle);
                    some == all
                })
            };
            let own_triangles = |triangle: &[VertexIndex; 3]| of(mesh, triangle).1;
            let other_triangles = |triangle: &[VertexIndex; 3]| of(other, triangle).1;
            // What rays tell fits together; triangles that only look alike need not.
            if casts.is_none()
                && pure(mesh)
                && pure(other)
                && let Some(found) = matched_some((mesh, &own_triangles), (other, &other_triangles))
            {
                take(&found, &mut points, &mut normals, &mut anchors);
                own = true;
                continue;
            }
        }
        let first = first_triangles(mesh);
        let allowed = 4.0 * plan.made.deviation.bound + 1e-6 * mesh.bounds().diagonal();
        for (index, vertex) in mesh.vertices.iter().enumerate() {
            let Some(triangle) = first[index] else { continue };
            let known = points[vertex.point.subscript()].is_some();
            if matches!(normals[index], Normal::Known(_)) {
                continue;
            }
            let Some(chart) = charts.get(vertex.anchor.source) else { continue };
            let sides = chart.sides(mesh, &mesh.triangles[triangle], vertex.anchor);
            let before = chart.from(vertex.anchor, sides);
            if before.point.distance(mesh.points[vertex.point.subscript()]) > allowed {
                return None;
            }
            let (anchor, after) = chart.to(vertex.anchor, sides);
            anchors[index] = anchor;
            if !known {
                points[vertex.point.subscript()] = Some(after.point);
            }
            let along = before.normal.dot(vertex.normal);
            // Between faces that look the same a normal may be the mean of theirs.
            if along.abs() > 0.98 && !flat {
                normals[index] = Normal::Known(after.normal * along.signum());
            }
        }
    }
    if let (Some(casts), Some(charts)) = (&casts, &charts) {
        // Walls begin where the surfaces are that they end.
        for curved in [true, false] {
            for (index, vertex) in mesh.vertices.iter().enumerate() {
                let source = vertex.anchor.source;
                let done = matches!(normals[index], Normal::Known(_)) || charts.get(source).is_some();
                if done || casts.is_curved(source) != curved {
                    continue;
                }
                let place = &mut points[vertex.point.subscript()];
                let (after, seen) = casts.cast(source, mesh.points[vertex.point.subscript()])?;
                place.get_or_insert(after);
                if let Some([before, after]) = seen {
                    let along = before.dot(vertex.normal);
                    if along.abs() > 0.98 && !flat {
                        normals[index] = Normal::Known(after * along.signum());
                    }
                }
            }
        }
    }
    let used = used_points(mesh);
    let place = |(index, point): (usize, &Option<DVec3>)| {
        let place = point.or_else(|| (!used[index]).then_some(mesh.points[index]))?;
        place.is_finite().then_some(place)
    };
    let points: Vec<DVec3> = points.iter().enumerate().map(place).collect::<Option<_>>()?;
    let normals = settled(mesh, &points, &normals);
    let mut carried = Carried { points, normals, anchors, deviation: Deviation::NONE };
    if own {
        carried.deviation = member.made.deviation;
    }
    if let Some(charts) = &charts {
        let found = deviation(mesh, &carried, charts, (to, casts.is_some()));
        carried.deviation = carried.deviation.union(sampled(found, &mesh.bounds()));
    }
    Some(carried)
}

fn runs(mesh: &Mesh) -> Vec<u32> {
    mesh.runs.iter().map(|run| run.end).collect()
}

fn used_points(mesh: &Mesh) -> Vec<bool> {
    let mut used = vec![false; mesh.points.len()];
    for vertex in mesh.triangles.iter().flatten() {
        used[mesh.vertices[vertex.subscript()].point.subscript()] = true;
    }
    used
}

/// For each vertex the first triangle that uses it.
fn first_triangles(mesh: &Mesh) -> Vec<Option<usize>> {
    let mut first = vec![None; mesh.vertices.len()];
    for (index, triangle) in mesh.triangles.iter().enumerate() {
        for vertex in triangle {
            first[vertex.subscript()].get_or_insert(index);
        }
    }
    first
}

/// Which point and vertex of one mesh is which of another.
struct Match {
    points: Vec<(u32, u32)>,
    vertices: Vec<(u32, u32)>,
}

fn matched(mesh: &Mesh, other: &Mesh, some: impl Fn(&[VertexIndex; 3]) -> bool) -> Option<Match> {
    matched_some((mesh, &some), (other, &some))
}

type Some<'f> = &'f dyn Fn(&[VertexIndex; 3]) -> bool;

/// Some triangles of a mesh held against some of another, one by one in their order: none where points that are shared
/// here are not there.
fn matched_some((mesh, some): (&Mesh, Some<'_>), (other, others): (&Mesh, Some<'_>)) -> Option<Match> {
    const NONE: u32 = u32::MAX;
    let mut to = vec![NONE; mesh.points.len()];
    let mut back = vec![NONE; other.points.len()];
    let mut vertices = vec![NONE; mesh.vertices.len()];
    let mut own = mesh.triangles.iter().filter(|triangle| some(triangle));
    let mut there = other.triangles.iter().filter(|triangle| others(triangle));
    let mut any = false;
    loop {
        match (own.next(), there.next()) {
            (None, None) => break,
            (Some(own), Some(there)) => {
                any = true;
                for (a, b) in own.iter().zip(there) {
                    let (p, q) = (mesh.vertices[a.subscript()].point, other.vertices[b.subscript()].point);
                    let (forth, home) = (&mut to[p.subscript()], &mut back[q.subscript()]);
                    if *forth == NONE && *home == NONE {
                        (*forth, *home) = (q.0, p.0);
                    }
                    if *forth != q.0 || *home != p.0 {
                        return None;
                    }
                    if vertices[a.subscript()] == NONE {
                        vertices[a.subscript()] = b.0;
                    }
                }
            }
            _ => return None,
        }
    }
    let pairs = |list: Vec<u32>| (0..).zip(list).filter(|(_, of)| *of != NONE).collect();
    any.then(|| Match { points: pairs(to), vertices: pairs(vertices) })
}

/// Whether two shapes are made of the same polygons over other points.
pub(super) fn same_polygons((a, first): (&Model, ShapeHandle), (b, second): (&Model, ShapeHandle)) -> bool {
    let equal = |one: &PolygonMesh, other: &PolygonMesh| {
        let materials = |mesh: &PolygonMesh| mesh.faces.iter().map(|face| face.material).collect::<Vec<_>>();
        one.corners == other.corners
            && one.loop_ends == other.loop_ends
            && one.faces.len() == other.faces.len()
            && materials(one) == materials(other)
            && one.points.len() == other.points.len()
    };
    match (&a.shape(first).recipe, &b.shape(second).recipe) {
        (Recipe::Polygons { mesh, .. }, Recipe::Polygons { mesh: other, .. }) => equal(mesh, other),
        (Recipe::Subdivided(one), Recipe::Subdivided(other)) => {
            one.scheme == other.scheme && same_polygons((a, one.cage), (b, other.cage))
        }
        (Recipe::Cuboid { .. }, Recipe::Cuboid { .. }) => true,
        (Recipe::Assembly(parts), Recipe::Assembly(others)) => {
            parts.len() == others.len()
                && parts.iter().zip(others).all(|(one, other)| same_polygons((a, one.0), (b, other.0)))
        }
        _ => false,
    }
}

/// The normals of all vertices. Those that are not known are means of the triangles around, by their angles; vertices
/// that look the same way at one point do so in every state.
fn settled(mesh: &Mesh, points: &[DVec3], normals: &[Normal]) -> Vec<DVec3> {
    let mut groups: HashMap<(u32, [u64; 3]), usize> = HashMap::new();
    let group: Vec<usize> = mesh
        .vertices
        .iter()
        .map(|vertex| {
            let next = groups.len();
            let bits = vertex.normal.to_array().map(|part| (part + 0.0).to_bits());
            *groups.entry((vertex.point.0, bits)).or_insert(next)
        })
        .collect();
    let mut sums = vec![DVec3::ZERO; groups.len()];
    for triangle in &mesh.triangles {
        let place = |vertex: VertexIndex| points[mesh.vertices[vertex.subscript()].point.subscript()];
        let places = triangle.map(place);
        let normal = (places[1] - places[0]).cross(places[2] - places[0]).normalize_or_zero();
        for corner in 0..3 {
            let ways = [1, 2].map(|k| (places[(corner + k) % 3] - places[corner]).normalize_or_zero());
            sums[group[triangle[corner].subscript()]] += normal * acos(ways[0].dot(ways[1]).clamp(-1.0, 1.0));
        }
    }
    let normal = |(index, normal): (usize, &Normal)| match normal {
        Normal::Known(normal) => normal.normalize_or(mesh.vertices[index].normal),
        Normal::Around => sums[group[index]].normalize_or(mesh.vertices[index].normal),
    };
    normals.iter().enumerate().map(normal).collect()
}

/// The side of a parameter on which another lies.
pub(super) fn side_of(own: f64, other: f64) -> Side {
    if other < own { Side::Before } else { Side::After }
}
