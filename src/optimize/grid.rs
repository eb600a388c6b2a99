//! Positions on a grid, so that they can be written as whole numbers.
//!
//! Promise: one grid for all geometries of a scene, its step a power of two and its lines through the origin: what lies
//! at one place in two shapes is rounded to one place, and reading back is exact in single precision, so that nothing
//! that was closed opens. No point moves by more than half a step along each axis; the deviation of each geometry says
//! by how much its points moved. Points that fall together are one, unless states part them again. Not promised: that
//! what was apart stays apart.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::mesh;
use crate::geometry::mesh::weld::weld_equal;
use crate::geometry::mesh::{PointIndex, Vertex, VertexIndex};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::Evidence;
use crate::packing::{share_byte, signed_byte};
use crate::scene::{Geometry, Grid, Scene};

/// Steps that a whole number of 16 bits tells apart.
const MOST_STEPS: f64 = 65535.0;

/// The part of the tolerance that rounding to a grid takes where that is enough: surfaces are kept within the rest.
pub const GRID_SHARE: f64 = 0.125;

/// The greatest part of the tolerance that rounding to a grid may take: beyond it, floats are shorter than the triangles
/// that the rest would ask for.
pub const MOST_GRID_SHARE: f64 = 0.5;

/// Steps over the scene where no geometry has a tolerance: as fine as what engines commonly ask for.
const STEPS: f64 = 16384.0;

/// Why positions cannot be rounded to a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooCoarse {
    /// Points would move up to this far, metres.
    pub moved: f64,
    /// Rounding's share of the finest tolerance, metres.
    pub allowed: f64,
}

/// The part of the finest tolerance that rounding to the finest grid takes; 0 where there is no tolerance.
#[must_use]
pub fn grid_share(scene: &Scene) -> f64 {
    let bounds = bounds(scene);
    let tolerance = finest_tolerance(scene).unwrap_or(f64::INFINITY);
    if bounds.is_empty() { 0.0 } else { finest_step(&bounds) * half_diagonal() / tolerance }
}

fn bounds(scene: &Scene) -> Bounds {
    let of = |geometry: &Geometry| {
        Bounds::of_points(geometry.mesh.points.iter().copied()).union(geometry.wire.bounds())
    };
    scene.geometries.iter().map(of).fold(Bounds::EMPTY, Bounds::union)
}

fn finest_tolerance(scene: &Scene) -> Option<f64> {
    scene.geometries.iter().filter_map(|geometry| geometry.tolerance).reduce(f64::min)
}

/// The least power of two with which 16 bits span a box, both its ends rounded outward.
fn finest_step(bounds: &Bounds) -> f64 {
    let extent = (bounds.max - bounds.min).max_element();
    power_at_least(f64::max(extent, f64::MIN_POSITIVE) / (MOST_STEPS - 2.0))
}

/// How far a point moves at most, in steps.
fn half_diagonal() -> f64 {
    0.75_f64.sqrt()
}

/// Rounds all positions to a grid: the coarsest one that stays within a share of the finest tolerance where `coarse`, else
/// the finest one. O(size of the scene).
///
/// # Errors
/// When even the finest grid would move points further than that. The scene is then as it was.
pub(super) fn snap(scene: &mut Scene, coarse: bool, share: f64) -> Result<(), TooCoarse> {
    let bounds = bounds(scene);
    if bounds.is_empty() || !bounds.diagonal().is_finite() {
        return Ok(());
    }
    let extent = (bounds.max - bounds.min).max_element();
    let finest = finest_step(&bounds);
    let half_diagonal = half_diagonal();
    let step = match finest_tolerance(scene) {
        Some(tolerance) if finest * half_diagonal > tolerance * share => {
            return Err(TooCoarse { moved: finest * half_diagonal, allowed: tolerance * MOST_GRID_SHARE });
        }
        Some(tolerance) if coarse => {
            // The power of two below the largest step that is allowed: more than half of it.
            finest.max(power_at_least(tolerance * share / half_diagonal / 2.0))
        }
        None if coarse => finest.max(power_at_least(extent / STEPS / 2.0)),
        _ => finest,
    };
    let offset = (bounds.min / step).floor() * step;
    for geometry in &mut scene.geometries {
        let moved = snap_geometry(geometry, step);
        if moved > 0.0 {
            let states = geometry.targets.iter_mut().map(|target| &mut target.deviation);
            for deviation in states.chain([&mut geometry.deviation]) {
                deviation.bound += moved;
                deviation.evidence = deviation.evidence.max(Evidence::Proved);
            }
        }
    }
    scene.grid = Some(Grid { step, offset });
    Ok(())
}

/// The least power of two that is not below a number, within what single precision holds.
fn power_at_least(number: f64) -> f64 {
    let mut power = f64::from(f32::MIN_POSITIVE);
    while power < number && power < 1e30 {
        power *= 2.0;
    }
    power
}

/// Rounds the positions of a geometry; returns how far the furthest moved.
fn snap_geometry(geometry: &mut Geometry, step: f64) -> f64 {
    let mut moved: f64 = 0.0;
    let mut snap = |point: DVec3| {
        let to = (point / step).round() * step + DVec3::ZERO;
        moved = moved.max(to.distance(point));
        to
    };
    geometry.mesh.points.iter_mut().for_each(|point| *point = snap(*point));
    geometry.wire.points.iter_mut().for_each(|point| point.position = snap(point.position));
    for point in geometry.targets.iter_mut().flat_map(|target| &mut target.points) {
        *point = snap(*point);
    }
    if geometry.targets.is_empty() {
        join_points(geometry);
        join_vertices(geometry);
    }
    moved
}

/// Points that fell together become one; it is carried as the first of them was.
fn join_points(geometry: &mut Geometry) {
    let mesh = &mut geometry.mesh;
    let welded = weld_equal(&mesh.points);
    if welded.points.len() == mesh.points.len() {
        return;
    }
    for vertex in &mut mesh.vertices {
        vertex.point = PointIndex(welded.map[vertex.point.subscript()]);
    }
    if let Some(influences) = &mut geometry.influences {
        let mut next = 0;
        let firsts = welded.map.iter().map(|kept| {
            let first = *kept == next;
            next += u32::from(first);
            first
        });
        let firsts: Vec<bool> = firsts.collect();
        let mut keep = firsts.into_iter();
        influences.retain(|_| keep.next().unwrap_or(false));
    }
    mesh.points = welded.points;
}

/// What is written of a vertex: its point, and the bits of its normal, texture coordinates, color and second coordinates.
type Alike = (u32, [i8; 3], [u64; 2], [u8; 4], [u32; 2]);

/// Vertices that will be written alike become one.
fn join_vertices(geometry: &mut Geometry) {
    let mesh = &mut geometry.mesh;
    // Only looked up, never walked.
    let mut known: HashMap<Alike, u32> = HashMap::with_capacity(mesh.vertices.len());
    let mut kept: Vec<Vertex> = Vec::with_capacity(mesh.vertices.len());
    let mut second: Vec<[f32; 2]> = Vec::new();
    let laid = geometry.lightmap.as_ref().map(|lightmap| lightmap.places.as_slice());
    let places: Vec<u32> = mesh
        .vertices
        .iter()
        .enumerate()
        .map(|(number, vertex)| {
            let own = laid.map(|places| places[number]);
            let key = (
                vertex.point.0,
                vertex.normal.to_array().map(signed_byte),
                vertex.uv.to_array().map(|part| (part + 0.0).to_bits()),
                vertex.color.0.map(share_byte),
                own.unwrap_or_default().map(f32::to_bits),
            );
            *known.entry(key).or_insert_with(|| {
                kept.push(*vertex);
                second.extend(own);
                mesh::index(kept.len() - 1)
            })
        })
        .collect();
    if kept.len() < mesh.vertices.len() {
        mesh.vertices = kept;
        if let Some(lightmap) = &mut geometry.lightmap {
            lightmap.places = second;
        }
        for vertex in mesh.triangles.iter_mut().flatten() {
            *vertex = VertexIndex(places[vertex.subscript()]);
        }
    }
}
