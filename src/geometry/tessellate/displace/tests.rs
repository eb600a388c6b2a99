//! Displaced meshes against closed forms.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use super::{Heights, displace};
use crate::geometry::mesh::{Mesh, VertexIndex};
use crate::geometry::number::{cos_degrees, sin_degrees};
use crate::geometry::tessellate::{
    Detail, Evidence, FlatPlane, RoundedBox, SurfaceDensity, TessellateError, cuboid, plane, rounded_box,
};

const PI: f64 = core::f64::consts::PI;

fn detail(tolerance: f64) -> Detail {
    Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: true,
        triangle_limit: 1 << 22,
    }
}

fn moved(
    mesh: Mesh,
    height: &(dyn Fn(DVec3, DVec2) -> f64 + Sync),
    steps: f64,
    tolerance: f64,
) -> Result<Mesh, TessellateError> {
    let fine = |places: [DVec3; 2], _: [DVec2; 2]| steps * places[0].distance(places[1]);
    let heights = Heights { height, detail: &fine };
    let (mesh, deviation) = displace(mesh, &heights, &[], tolerance, 1 << 20)?;
    assert!(deviation.bound <= tolerance);
    assert_ne!(deviation.evidence, Evidence::Proved);
    Ok(mesh)
}

fn point(mesh: &Mesh, corner: VertexIndex) -> DVec3 {
    mesh.points[mesh.vertices[corner.subscript()].point.subscript()]
}

fn volume(mesh: &Mesh) -> f64 {
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|at| point(mesh, at)));
    corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}

fn is_closed(mesh: &Mesh) -> bool {
    let mut seen = BTreeSet::new();
    let mut sides = mesh.triangles.iter().flat_map(|triangle| {
        let [a, b, c] = triangle.map(|at| mesh.vertices[at.subscript()].point.0);
        [[a, b], [b, c], [c, a]]
    });
    sides.all(|side| side[0] != side[1] && seen.insert(side))
        && seen.iter().all(|[a, b]| seen.contains(&[*b, *a]))
}

fn ball(radius: f64, tolerance: f64) -> Mesh {
    rounded_box(&RoundedBox { size: DVec3::splat(2.0 * radius), radius }, &detail(tolerance)).unwrap().mesh
}

#[test]
fn a_box_moved_evenly_is_a_larger_box() {
    let crate_of = || cuboid(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, true).mesh;
    for height in [0.25, -0.25] {
        let mesh = moved(crate_of(), &|_, _| height, 0.0, 1e-3).unwrap();
        assert_eq!(mesh.triangles.len(), 12);
        assert!(is_closed(&mesh));
        let exact = (1.0 + 2.0 * height) * (2.0 + 2.0 * height) * (3.0 + 2.0 * height);
        assert!((volume(&mesh) - exact).abs() < 1e-6);
        for (vertex, before) in mesh.vertices.iter().zip(&crate_of().vertices) {
            assert!(vertex.normal.distance(before.normal) < 1e-9, "sharp edges stay sharp");
        }
    }
}

#[test]
fn a_ball_moved_evenly_is_a_larger_ball() {
    for (height, tolerance) in [(0.5, 1e-2), (0.5, 1e-3), (-0.5, 1e-3)] {
        let mesh = moved(ball(1.0, tolerance / 4.0), &|_, _| height, 0.0, tolerance).unwrap();
        assert!(is_closed(&mesh));
        let radius = 1.0 + height;
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|at| point(&mesh, at));
            for place in [a, (a + b) / 2.0, (a + b + c) / 3.0] {
                assert!((place.length() - radius).abs() <= 1.5 * tolerance);
            }
        }
        let exact = 4.0 / 3.0 * PI * radius * radius * radius;
        assert!((volume(&mesh) - exact).abs() <= 1.5 * tolerance * 4.0 * PI * radius * radius);
        for vertex in &mesh.vertices {
            let way = mesh.points[vertex.point.subscript()].normalize();
            assert!(vertex.normal.dot(way) > 1.0 - 1e-4);
        }
    }
}

#[test]
fn waves_are_followed_and_have_their_normals() {
    let wave = |place: DVec3, _: DVec2| 0.1 * sin_degrees(360.0 * place.x) * cos_degrees(360.0 * place.z);
    let mut counts = Vec::new();
    for tolerance in [1e-2, 1e-3, 2.5e-4] {
        let flat = plane(&FlatPlane { size: DVec2::splat(2.0) }, &detail(tolerance)).unwrap().mesh;
        let mesh = moved(flat, &wave, 16.0, tolerance).unwrap();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|at| point(&mesh, at));
            for i in 0..=6_u32 {
                for j in 0..=6 - i {
                    let place = a + (b - a) * f64::from(i) / 6.0 + (c - a) * f64::from(j) / 6.0;
                    assert!((place.y - wave(place, DVec2::ZERO)).abs() <= tolerance * 1.05);
                }
            }
        }
        for vertex in &mesh.vertices {
            let at = mesh.points[vertex.point.subscript()];
            let slope = 0.2 * PI;
            let x = slope * cos_degrees(360.0 * at.x) * cos_degrees(360.0 * at.z);
            let z = -slope * sin_degrees(360.0 * at.x) * sin_degrees(360.0 * at.z);
            let exact = DVec3::new(-x, 1.0, -z).normalize();
            assert!(vertex.normal.distance(exact) < 1e-3, "{at} {} {exact}", vertex.normal);
        }
        counts.push(mesh.triangles.len() as f64);
    }
    // Twice as many each way for a quarter of the tolerance; flat strips need fewer.
    let growth = counts[2] / counts[1];
    assert!((2.0..8.0).contains(&growth), "{counts:?}");
}

#[test]
fn detail_smaller_than_the_triangles_is_found() {
    // A spike of a hundredth of the plane, which no corner and no middle of a side meets at first.
    let spike = |place: DVec3, _: DVec2| {
        let away = DVec2::new(place.x - 0.3111, place.z + 0.4177).length();
        (0.02 - away).max(0.0)
    };
    let flat = || plane(&FlatPlane { size: DVec2::splat(2.0) }, &detail(0.1)).unwrap().mesh;
    let mesh = moved(flat(), &spike, 100.0, 1e-3).unwrap();
    let most = mesh.points.iter().map(|point| point.y).fold(0.0, f64::max);
    assert!((0.018..=0.02).contains(&most), "{most}");
}

#[test]
fn seams_that_do_not_agree_are_told() {
    let torn = moved(cuboid(DVec3::ONE, DVec3::ZERO, true).mesh, &|_, uv| 0.1 * uv.x, 1.0, 1e-3);
    assert!(
        matches!(torn, Err(TessellateError::TornSeam { gap, .. }) if (gap - 0.1).abs() < 1e-9),
        "{torn:?}"
    );
}

#[test]
fn what_would_run_through_itself_is_refused() {
    let deep =
        moved(ball(1.0, 0.01), &|place, _| if place.y > 0.0 { -2.0 * place.y } else { 0.0 }, 4.0, 0.05);
    assert!(matches!(deep, Err(TessellateError::CrossesItself { .. })), "{deep:?}");
    // Evenly through the middle: nothing crosses, but all is turned over.
    for mesh in [ball(1.0, 0.01), cuboid(DVec3::ONE, DVec3::ZERO, true).mesh] {
        let inverted = moved(mesh, &|_, _| -1.5, 0.0, 0.05);
        assert!(matches!(inverted, Err(TessellateError::CrossesItself { .. })), "{inverted:?}");
    }
}

#[test]
fn wild_heights_end_at_the_limit() {
    let flat = plane(&FlatPlane { size: DVec2::splat(2.0) }, &detail(0.1)).unwrap().mesh;
    let heights = Heights { height: &|place, _| 100.0 * sin_degrees(1e7 * place.x), detail: &|_, _| 0.0 };
    let error = displace(flat, &heights, &[], 1e-9, 1000);
    assert!(matches!(error, Err(TessellateError::TooMany { limit: 1000, .. })), "{error:?}");
}
