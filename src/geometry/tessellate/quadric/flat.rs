//! Planes and pairs of planes inside walls.

use glam::DVec3;

use super::convex::Polyhedron;
use super::shell::Shell;
use super::walled::add_wall;
use super::{Job, Made, SHEETS, walls};
use crate::geometry::field::quadric::{HalfSpace, QuadricForm, QuadricKind};
use crate::geometry::mesh;
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::Deviation;

/// The planes of a flat quadric as half spaces on the negative side (of crossing planes on either), and the bodies that
/// the inside of the quadric is made of, each as the common part of half spaces.
pub(super) struct Planes {
    pub(super) all: Vec<HalfSpace>,
    pub(super) bodies: Vec<Vec<HalfSpace>>,
}

fn reversed(half: &HalfSpace) -> HalfSpace {
    HalfSpace { normal: -half.normal, offset: -half.offset }
}

impl Planes {
    /// `negative` tells whether the quadric is negative at a point.
    pub(super) fn new(form: &QuadricForm, negative: &dyn Fn(DVec3) -> bool) -> Self {
        let through = |normal: DVec3, point: DVec3| HalfSpace { normal, offset: normal.dot(point) };
        let (x, y) = (form.axes.x_axis, form.axes.y_axis);
        match form.kind {
            QuadricKind::ParallelPlanes => {
                let low = through(x, form.origin - x * form.half.x);
                let high = through(-x, form.origin + x * form.half.x);
                if negative(form.origin) {
                    Self { all: vec![low, high], bodies: vec![vec![low, high]] }
                } else {
                    let (low, high) = (reversed(&low), reversed(&high));
                    Self { all: vec![low, high], bodies: vec![vec![low], vec![high]] }
                }
            }
            QuadricKind::CrossingPlanes => {
                // X/a = Y/b and X/a = -Y/b.
                let one = (x / form.half.x - y / form.half.y).normalize();
                let other = (x / form.half.x + y / form.half.y).normalize();
                let (one, other) = (through(one, form.origin), through(other, form.origin));
                let bodies = if negative(form.origin + x * form.half.x) {
                    vec![vec![one, other], vec![reversed(&one), reversed(&other)]]
                } else {
                    vec![vec![one, reversed(&other)], vec![reversed(&one), other]]
                };
                Self { all: vec![one, other], bodies }
            }
            _ => {
                let plane = through(x, form.origin);
                let inside = if negative(form.origin + x) { plane } else { reversed(&plane) };
                Self { all: vec![inside], bodies: vec![vec![inside]] }
            }
        }
    }
}

/// The flat quadric inside a box.
pub(super) fn in_walls(
    form: &QuadricForm,
    bounds: &Bounds,
    negative: &dyn Fn(DVec3) -> bool,
    job: &Job,
) -> Made {
    let planes = Planes::new(form, negative);
    let walls = walls(bounds);
    let mut shell = Shell::default();
    if job.closed {
        for body in &planes.bodies {
            add_polyhedron(&mut shell, bounds, body);
        }
    } else {
        for (index, plane) in planes.all.iter().enumerate() {
            let corners = polygon(plane, &walls);
            add_polygon(&mut shell, plane, &corners, mesh::index(index));
        }
    }
    Made { shell, deviation: Deviation::NONE }
}

/// The face of a plane inside half spaces, cut out of a square that is larger than all of it.
fn polygon(plane: &HalfSpace, walls: &[HalfSpace]) -> Vec<DVec3> {
    let reach = walls.iter().map(|wall| wall.offset.abs()).fold(plane.offset.abs(), f64::max) * 8.0 + 1e-300;
    let x = plane.normal.any_orthonormal_vector();
    let y = plane.normal.cross(x);
    let middle = plane.normal * plane.offset;
    let mut corners = vec![
        middle + (x + y) * reach,
        middle + (y - x) * reach,
        middle - (x + y) * reach,
        middle + (x - y) * reach,
    ];
    for wall in walls {
        corners = cut(&corners, wall);
    }
    corners
}

/// The part of a convex polygon inside a half space (I. Sutherland, G. Hodgman, Reentrant polygon clipping, CACM 17, 1974).
fn cut(corners: &[DVec3], wall: &HalfSpace) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (k, corner) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        let (here, there) = (wall.depth(*corner), wall.depth(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    kept
}

/// Adds the faces of the part of a box inside half spaces, which are planes of the quadric.
fn add_polyhedron(shell: &mut Shell, bounds: &Bounds, own: &[HalfSpace]) {
    let mut body = Polyhedron::cuboid(bounds, SHEETS);
    for (half, source) in own.iter().zip(0..) {
        body.cut(half, bounds.diagonal(), source);
    }
    let base = mesh::index(shell.points.len());
    shell.points.extend(&body.points);
    let sides = walls(bounds);
    for face in &body.faces {
        let inward = if face.source < SHEETS {
            &own[face.source as usize]
        } else {
            &sides[(face.source - SHEETS) as usize]
        };
        let corners: Vec<u32> = face.corners.iter().map(|corner| base + corner).collect();
        add_wall(shell, inward, &fan(&corners), face.source);
    }
}

fn add_polygon(shell: &mut Shell, inward: &HalfSpace, corners: &[DVec3], source: u32) {
    let base = mesh::index(shell.points.len());
    shell.points.extend_from_slice(corners);
    let corners: Vec<u32> = (0..mesh::index(corners.len())).map(|k| base + k).collect();
    add_wall(shell, inward, &fan(&corners), source);
}

/// Triangles of a convex polygon.
fn fan(corners: &[u32]) -> Vec<[u32; 3]> {
    if corners.len() < 3 {
        return Vec::new();
    }
    corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect()
}
