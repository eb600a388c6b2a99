//! Laws of quadrics cut off by boxes.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};

use super::{Clip, ClippedQuadric, quadric};
use crate::geometry::field::quadric::QuadricKind;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::{Bounds, ln};
use crate::geometry::tessellate::{Detail, Evidence, SurfaceDensity, TessellateError, Tessellation};

pub(super) const PI: f64 = core::f64::consts::PI;

pub(super) fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: false,
        triangle_limit: 10_000_000,
    }
}

pub(super) fn axes(squares: [f64; 3], constant: f64) -> Quadric {
    Quadric::new(DVec3::from_array(squares), DVec3::ZERO, DVec3::ZERO, constant)
}

fn cube(half: f64) -> Option<Clip> {
    Some(Clip::Box(Bounds { min: DVec3::splat(-half), max: DVec3::splat(half) }))
}

fn boxed(min: [f64; 3], max: [f64; 3]) -> Option<Clip> {
    Some(Clip::Box(Bounds { min: DVec3::from_array(min), max: DVec3::from_array(max) }))
}

pub(super) fn made(quadric: Quadric, within: Option<Clip>, closed: bool, tolerance: f64) -> Tessellation {
    super::quadric(&ClippedQuadric { quadric, within, closed }, &detail(tolerance))
        .unwrap_or_else(|error| panic!("{quadric:?} {within:?} {closed}: {error}"))
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [DVec3; 3]> + '_ {
    mesh.triangles
        .iter()
        .map(|corners| corners.map(|corner| mesh.points[mesh.vertices[corner.subscript()].point.subscript()]))
}

pub(super) fn area(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

pub(super) fn volume(mesh: &Mesh) -> f64 {
    corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

/// Directed edges that have no twin.
pub(super) fn open_edges(mesh: &Mesh) -> usize {
    let mut balance: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| mesh.vertices[corner.subscript()].point.0);
        assert!(a != b && b != c && c != a);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.values().filter(|sum| **sum != 0).count()
}

/// Points lie on the quadric or, of a closed body, on its cut; triangles have areas and look outward.
pub(super) fn check(shape: &ClippedQuadric, made: &Tessellation) {
    let size = made.mesh.bounds().diagonal();
    for vertex in &made.mesh.vertices {
        let point = made.mesh.points[vertex.point.subscript()];
        if vertex.anchor.source < super::SHEETS && !shape.form().kind.is_flat() {
            let slope = shape.quadric.gradient(point).length();
            let near = shape.quadric.value(point).abs();
            // Where the slope vanishes, at the apex of a cone, what rounding leaves of the sum counts.
            let terms = shape.quadric.stretch() * size * size + shape.quadric.c.abs();
            assert!(near <= (1e-12 * size * slope).max(1e-15 * terms), "{point}: {near} {slope}");
        }
        assert!((vertex.normal.length() - 1.0).abs() < 1e-12);
    }
    for (corners, place) in made.mesh.triangles.iter().zip(corners(&made.mesh)) {
        let [a, b, c] = place;
        let across = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        assert!(across.length() > 1e-9 * longest * longest, "{place:?}");
        let mean: DVec3 = corners.iter().map(|corner| made.mesh.vertices[corner.subscript()].normal).sum();
        assert!(across.dot(mean) > 0.0, "{place:?}");
    }
    assert!(made.deviation.bound.is_finite());
}

#[test]
fn bodies_have_the_volumes_of_their_closed_forms() {
    // A ball, an ellipsoid, a spherical cap and parts of a ball, a frustum, a paraboloid, a hyperboloid between planes, a
    // cylinder, the wedge of a parabolic cylinder, a saddle that halves a cube, a cube without a ball.
    let saddle = Quadric::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -1.0), 0.0);
    let paraboloid = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), 0.0);
    let trough = Quadric::new(DVec3::new(1.0, 0.0, 0.0), DVec3::ZERO, DVec3::new(0.0, -1.0, 0.0), 0.0);
    let tower = axes([1.0, 1.0, -0.25], -1.0);
    for (name, shape, within, expected) in [
        ("ball", axes([1.0; 3], -4.0), None, 32.0 * PI / 3.0),
        ("ball in a box", axes([1.0; 3], -1.0), cube(1.0), 4.0 * PI / 3.0),
        ("ellipsoid", axes([1.0 / 9.0, 0.25, 1.0], -1.0), None, 8.0 * PI),
        ("half a ball", axes([1.0; 3], -1.0), boxed([-2.0, -2.0, 0.0], [2.0; 3]), 2.0 * PI / 3.0),
        ("a quarter", axes([1.0; 3], -1.0), boxed([-2.0, 0.0, 0.0], [2.0; 3]), PI / 3.0),
        ("an eighth", axes([1.0; 3], -1.0), boxed([0.0; 3], [2.0; 3]), PI / 6.0),
        ("cap", axes([1.0; 3], -1.0), boxed([-2.0, -2.0, 0.6], [2.0; 3]), PI * 0.16 * 2.6 / 3.0),
        ("frustum", axes([4.0, 4.0, -1.0], 0.0), boxed([-2.0, -2.0, 0.5], [2.0; 3]), PI / 12.0 * 7.875),
        ("half a frustum", axes([4.0, 4.0, -1.0], 0.0), boxed([0.0, -2.0, 0.5], [2.0; 3]), PI / 24.0 * 7.875),
        (
            "both halves of a cone",
            axes([1.0, 1.0, -1.0], 0.0),
            boxed([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]),
            PI * 2.0 / 3.0,
        ),
        (
            "a cone on its apex",
            axes([1.0, 1.0, -1.0], 0.0),
            boxed([-2.0, -2.0, 0.0], [2.0, 2.0, 1.0]),
            PI / 3.0,
        ),
        ("half a cone", axes([1.0, 1.0, -1.0], 0.0), boxed([0.0, -2.0, 0.0], [2.0, 2.0, 1.0]), PI / 6.0),
        ("a quarter of a cone", axes([1.0, 1.0, -1.0], 0.0), boxed([0.0; 3], [2.0, 2.0, 1.0]), PI / 12.0),
        ("paraboloid", paraboloid, boxed([-1.0, -1.0, 0.0], [1.0; 3]), PI / 2.0),
        ("tower", tower, boxed([-9.0, -9.0, -3.0], [9.0, 9.0, 2.0]), PI * (5.0 + (27.0 + 8.0) / 12.0)),
        ("cylinder", axes([1.0, 1.0, 0.0], -1.0), cube(1.0), 2.0 * PI),
        ("lying cylinder", axes([0.0, 1.0, 4.0], -1.0), boxed([-3.0; 3], [4.0; 3]), 7.0 * PI / 2.0),
        ("trough", trough, cube(1.0), 2.0 * 4.0 / 3.0),
        ("saddle", saddle, cube(1.0), 4.0),
        ("a cube without a ball", axes([-1.0; 3], 0.25), cube(1.0), 8.0 - PI / 6.0),
        (
            "a cube without half a ball",
            axes([-1.0; 3], 0.25),
            boxed([-1.0; 3], [0.0, 1.0, 1.0]),
            4.0 - PI / 12.0,
        ),
        ("slab", axes([0.0, 1.0, 0.0], -0.25), cube(1.0), 4.0),
        ("wedges", axes([1.0, -1.0, 0.0], 0.0), cube(1.0), 4.0),
        (
            "half space",
            Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::new(1.0, 1.0, 1.0), 0.0),
            cube(1.0),
            4.0,
        ),
    ] {
        let whole = ClippedQuadric { quadric: shape, within, closed: true };
        for tolerance in [1e-2, 1e-3, 3e-4] {
            let made = made(shape, within, true, tolerance);
            check(&whole, &made);
            assert_eq!(open_edges(&made.mesh), 0, "{name} at {tolerance}");
            assert!(made.deviation.bound <= tolerance, "{name}: {}", made.deviation.bound);
            // Between two surfaces that are nowhere further apart lies no more than the area times that distance.
            let off = (volume(&made.mesh) - expected).abs();
            let most = 1.01 * area(&made.mesh) * made.deviation.bound + 1e-7;
            assert!(off <= most, "{name} at {tolerance}: {} for {expected}", volume(&made.mesh));
        }
    }
}

pub(super) fn turned(quadric: &Quadric, turn: DQuat, origin: DVec3) -> Quadric {
    let rotation = DMat3::from_quat(turn);
    let a = rotation * quadric.a * rotation.transpose();
    let b = rotation * quadric.b;
    let moved = Quadric { a, b, c: quadric.c };
    Quadric { a, b: b - (a * origin) * 2.0, c: moved.value(-origin) }
}

pub(super) fn every_kind() -> Vec<(QuadricKind, Quadric)> {
    let graph = |squares: [f64; 3]| {
        Quadric::new(DVec3::from_array(squares), DVec3::ZERO, DVec3::new(0.1, 0.0, -1.0), 0.2)
    };
    vec![
        (QuadricKind::Ellipsoid, axes([1.0, 2.0, 0.4], -0.7)),
        (QuadricKind::OneSheet, axes([1.0, 2.0, -0.4], -0.2)),
        (QuadricKind::TwoSheets, axes([1.0, 2.0, -0.4], 0.05)),
        (QuadricKind::Cone, axes([1.0, 2.0, -0.4], 0.0)),
        (QuadricKind::EllipticParaboloid, graph([1.0, 0.5, 0.0])),
        (QuadricKind::HyperbolicParaboloid, graph([1.0, -0.5, 0.0])),
        (QuadricKind::EllipticCylinder, axes([1.0, 2.0, 0.0], -0.3)),
        (QuadricKind::HyperbolicCylinder, axes([1.0, -2.0, 0.0], -0.1)),
        (QuadricKind::ParabolicCylinder, graph([0.0, 1.0, 0.0])),
        (QuadricKind::CrossingPlanes, axes([1.0, -2.0, 0.0], 0.0)),
        (QuadricKind::ParallelPlanes, axes([1.0, 0.0, 0.0], -0.1)),
        (QuadricKind::Plane, Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5), 0.3)),
    ]
}

#[test]
fn every_kind_is_cut_by_boxes_in_every_position() {
    let turns = [
        DQuat::IDENTITY,
        DQuat::from_xyzw(0.18, -0.36, 0.54, 0.738_918_1).normalize(),
        DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
        DQuat::from_xyzw(-0.3, 0.1, 0.7, 0.2).normalize(),
    ];
    let clips = [
        cube(1.0),
        boxed([-0.9, -0.2, -1.1], [0.3, 1.4, 0.0]),
        boxed([0.0; 3], [1.0, 1.2, 1.4]),
        boxed([0.2, -0.5, -0.4], [1.2, 0.9, 0.8]),
    ];
    for (kind, plain) in every_kind() {
        for turn in turns {
            for origin in [DVec3::ZERO, DVec3::new(0.1, 0.2, -0.15)] {
                let placed = turned(&plain, turn, origin);
                for sign in [1.0, -1.0] {
                    let quadric = Quadric { a: placed.a * sign, b: placed.b * sign, c: placed.c * sign };
                    let mut whole = 0.0;
                    for within in clips {
                        let shape = ClippedQuadric { quadric, within, closed: true };
                        assert_eq!(shape.form().kind, kind);
                        let made = match super::quadric(&shape, &detail(1e-2)) {
                            Ok(made) => made,
                            Err(TessellateError::NoArea) => continue,
                            Err(error) => panic!("{kind:?} {turn} {origin} {within:?}: {error}"),
                        };
                        check(&shape, &made);
                        assert_eq!(open_edges(&made.mesh), 0, "{kind:?} {turn} {origin} {within:?} {sign}");
                        assert!(made.deviation.bound <= 1e-2, "{kind:?} {}", made.deviation.bound);
                        whole = volume(&made.mesh);
                        assert!(whole > 0.0, "{kind:?} {turn} {origin} {within:?} {sign}");
                    }
                    assert!(whole <= 1.0 * 1.4 * 1.2);
                }
            }
        }
    }
}

#[test]
fn both_sides_of_a_quadric_fill_the_clip() {
    for (kind, quadric) in every_kind() {
        for (within, all) in [
            (boxed([-0.9, -0.2, -1.1], [0.3, 1.4, 0.2]), 1.2 * 1.6 * 1.3),
            (boxed([0.2, -0.5, -0.4], [1.2, 0.9, 0.8]), 1.0 * 1.4 * 1.2),
        ] {
            let volumes = [1.0, -1.0].map(|sign| {
                let quadric = Quadric { a: quadric.a * sign, b: quadric.b * sign, c: quadric.c * sign };
                volume(&made(quadric, within, true, 1e-4).mesh)
            });
            let sum = volumes[0] + volumes[1];
            assert!((sum / all - 1.0).abs() < 1e-3, "{kind:?}: {volumes:?} of {all}");
        }
    }
}

#[test]
fn areas_converge_with_the_tolerance() {
    // x^2 + y^2 - z^2 / 4 = 1 between z = -1 and 1: 2 pi times the integral of sqrt(1 + 5 z^2 / 16).
    let k: f64 = (5.0_f64 / 16.0).sqrt();
    let tower = 2.0 * PI * ((1.0 + k * k).sqrt() + crate::geometry::number::asinh(k) / k);
    let paraboloid = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), 0.0);
    // Where the surface is saddle-shaped its rim loses what its inside gains: coarse meshes are right by accident.
    for (shape, within, expected, coarsest) in [
        (axes([1.0 / 9.0, 0.25, 1.0], -1.0), None, 48.882_146_302_582_06, 1e-1),
        (axes([1.0, 1.0, -0.25], -1.0), boxed([-9.0, -9.0, -1.0], [9.0, 9.0, 1.0]), tower, 1e-2),
        // Both halves of a cone of half angle 45 degrees and height 1.
        (
            axes([1.0, 1.0, -1.0], 0.0),
            boxed([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0]),
            2.0 * PI * 2.0_f64.sqrt(),
            1e-1,
        ),
        (paraboloid, boxed([-2.0, -2.0, 0.0], [2.0, 2.0, 1.0]), 5.330_413_500_268_973, 1e-1),
    ] {
        let errors: Vec<f64> = [1.0, 0.1, 0.01, 0.001]
            .map(|share| (area(&made(shape, within, false, coarsest * share).mesh) / expected - 1.0).abs())
            .to_vec();
        let exponent = -ln(errors[3] / errors[0]) / ln(1000.0);
        assert!(exponent >= 0.9 && errors[3] < 4.0 * coarsest * 1e-3, "{shape:?} {errors:?}: {exponent}");
    }
}

#[test]
fn few_triangles_are_used() {
    // The optimum is the integral of sqrt |K| / (2 tolerance): for a ball 4 pi / (2 tolerance) at radius 1.
    for (quadric, within, integral) in [
        (axes([1.0; 3], -1.0), None, 4.0 * PI),
        // |K| dA of an ellipsoid is that of the ball, but the root is not; 3, 2, 1 by quadrature.
        (
            axes([1.0, 1.0, -1.0], -1.0),
            boxed([-9.0, -9.0, -1.0], [9.0, 9.0, 1.0]),
            2.0 * PI * 2.0 * 0.881_373_587_019_543,
        ),
    ] {
        let tolerance = 1e-4;
        let made = made(quadric, within, false, tolerance);
        let ratio = made.mesh.triangles.len() as f64 / (integral / (2.0 * tolerance));
        assert!(ratio < 1.8, "{ratio}");
    }
}

#[test]
fn what_touches_the_box_leaves_no_dust() {
    for (quadric, within) in [
        (axes([1.0; 3], -1.0), cube(1.0)),
        (axes([1.0; 3], -2.0), cube(1.0)),
        (axes([1.0; 3], -3.0), cube(1.0)),
        (axes([1.0, 1.0, 0.0], -1.0), cube(1.0)),
        (axes([1.0, 1.0, -1.0], -1.0), cube(2.0)),
        (
            Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), 0.0),
            boxed([-1.0, -1.0, 0.0], [1.0; 3]),
        ),
        (
            Quadric::new(DVec3::new(1.0, -1.0, 0.0), DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), 0.0),
            boxed([-1.0, -1.0, 0.0], [1.0; 3]),
        ),
    ] {
        for closed in [true, false] {
            let shape = ClippedQuadric { quadric, within, closed };
            let made =
                super::quadric(&shape, &detail(1e-3)).unwrap_or_else(|error| panic!("{shape:?}: {error}"));
            check(&shape, &made);
            assert!(!closed || open_edges(&made.mesh) == 0);
            assert!(made.mesh.triangles.len() < 20_000);
        }
    }
}

#[test]
fn nothing_inside_is_no_area() {
    let far = Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::new(-20.0, 0.0, 0.0), 99.0);
    let shape = ClippedQuadric { quadric: far, within: cube(1.0), closed: true };
    assert_eq!(quadric(&shape, &detail(1e-3)), Err(TessellateError::NoArea));
    let small = Detail { triangle_limit: 100, ..detail(1e-5) };
    let shape = ClippedQuadric { quadric: axes([1.0; 3], -1.0), within: None, closed: true };
    assert!(matches!(quadric(&shape, &small), Err(TessellateError::TooMany { .. })));
}

#[test]
fn a_fixed_grid_cuts_edges_into_so_many_chords() {
    let shape = ClippedQuadric { quadric: axes([1.0, 1.0, -1.0], -1.0), within: cube(2.0), closed: true };
    let detail = Detail { density: SurfaceDensity::Grid { u: 12, v: 12 }, ..detail(1.0) };
    let made = quadric(&shape, &detail).unwrap();
    check(&shape, &made);
    assert_eq!(open_edges(&made.mesh), 0);
    assert_eq!(made.deviation.evidence, Evidence::Proved);
}
