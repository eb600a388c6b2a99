//! Surfaces of fields against closed forms, and the checks that hold for all.

use core::f64::consts::PI;

use glam::DVec3;

use super::{FieldSurface, field_surface};
use crate::geometry::curve::{AnyCurve, interpolate};
use crate::geometry::field::{
    AnyField, Blend, Element, Form, Join, Joined, Line, Potential, Primitive, Skeleton,
};
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::{Detail, SurfaceDensity, Tessellation};

fn surface(field: AnyField, half: f64) -> FieldSurface {
    let within = Bounds { min: DVec3::splat(-half), max: DVec3::splat(half) };
    FieldSurface { field, within, least: None }
}

fn made(shape: &FieldSurface, tolerance: f64) -> Tessellation {
    let detail = Detail {
        density: SurfaceDensity::Tolerance(tolerance),
        crease_angle: 30.0,
        uv: false,
        triangle_limit: 1 << 18,
    };
    field_surface(shape, &detail).unwrap_or_else(|error| panic!("{error}"))
}

fn triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.triangles
        .iter()
        .map(|corners| corners.map(|corner| mesh.vertices[corner.subscript()].point.0))
        .collect()
}

/// Area, volume and Euler number.
fn measure(mesh: &Mesh) -> (f64, f64, i64) {
    let (mut area, mut volume) = (0.0, 0.0);
    let triangles = triangles(mesh);
    for corners in &triangles {
        let [a, b, c] = corners.map(|corner| mesh.points[corner as usize]);
        area += (b - a).cross(c - a).length() / 2.0;
        volume += a.dot(b.cross(c)) / 6.0;
    }
    let count = |number: usize| i64::try_from(number).expect("few");
    (area, volume, count(mesh.points.len()) - count(3 * triangles.len() / 2) + count(triangles.len()))
}

/// Closed, without branches, without crossings, on the surface, within the tolerance.
fn check(shape: &FieldSurface, tolerance: f64) -> Tessellation {
    let made = made(shape, tolerance);
    let triangles = triangles(&made.mesh);
    let mut edges: Vec<(u32, u32)> =
        triangles.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]).collect();
    let mut back: Vec<(u32, u32)> = edges.iter().map(|(a, b)| (*b, *a)).collect();
    edges.sort_unstable();
    back.sort_unstable();
    assert_eq!(edges, back, "closed");
    assert!(edges.windows(2).all(|pair| pair[0] != pair[1]), "without branches");
    assert_eq!(crossings(&made.mesh.points, &triangles), [[0; 2]; 0]);
    assert!(made.deviation.bound <= tolerance, "{:?} of {tolerance}", made.deviation);
    let size = shape.within.diagonal();
    for point in &made.mesh.points {
        let (value, gradient) = shape.field.value_gradient(*point);
        assert!(value.abs() <= 1e-6 * size * gradient.length().max(1e-3), "{point} is off by {value}");
    }
    made
}

/// Numbers from 0 to 1.
fn numbers(seed: u32) -> impl FnMut() -> f64 {
    let mut state = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 33).expect("31 bits")) / f64::from(1_u32 << 31)
    }
}

fn balls(count: u32, seed: u32) -> AnyField {
    let mut next = numbers(seed);
    let elements = (0..count).map(|_| {
        let center = DVec3::new(next(), next(), next()) * 1.2 - 0.6;
        let radius = 0.25 + 0.2 * next();
        Element {
            form: Form::Point(center),
            potential: Potential::Power { radius, exponent: 3 },
            strength: 2.0,
        }
    });
    AnyField::Skeleton(Box::new(Skeleton::new(elements.collect(), 0.6)))
}

/// Elements of all kinds with all potentials; some take away.
fn mixed(seed: u32) -> AnyField {
    let mut next = numbers(seed);
    let mut element = |k: u32| {
        let mut point = || DVec3::new(next(), next(), next()) * 1.2 - 0.6;
        let points = [point(), point(), point(), point()];
        let form = match (seed + k) % 4 {
            0 => Form::Point(points[0]),
            1 => Form::Segment(points[0], points[1]),
            2 => Form::Triangles(vec![[points[0], points[1], points[2]]]),
            _ => {
                let curve = interpolate(&points, &[0.0, 1.0, 2.0, 3.0]).expect("distinct");
                Form::Curves(vec![Line::new(&AnyCurve::Bezier(curve))])
            }
        };
        let radius = 0.25 + 0.3 * next();
        let potential = match (seed / 3 + k) % 5 {
            0 => Potential::Gaussian { sharpness: 1.0 / (radius * radius) },
            1 => Potential::Wyvill { radius },
            exponent => Potential::Power { radius, exponent: exponent - 1 },
        };
        let strength = if k > 0 && next() < 0.2 { -0.5 } else { 1.5 };
        Element { form, potential, strength }
    };
    let elements = (0..1 + seed % 3).map(&mut element).collect();
    AnyField::Skeleton(Box::new(Skeleton::new(elements, 0.5)))
}

#[test]
fn balls_and_rings_have_the_measures_of_school() {
    let sphere = surface(AnyField::Primitive(Primitive::Sphere { radius: 1.0 }), 1.2);
    let torus = surface(AnyField::Primitive(Primitive::Torus { major: 1.0, minor: 0.3 }), 1.5);
    let capsule = surface(AnyField::Primitive(Primitive::Capsule { radius: 0.4, half: 0.7 }), 1.3);
    for (shape, area, volume, euler) in [
        (&sphere, 4.0 * PI, 4.0 / 3.0 * PI, 2),
        (&torus, 4.0 * PI * PI * 0.3, 2.0 * PI * PI * 0.09, 0),
        (&capsule, 2.0 * PI * 0.4 * 1.4 + 4.0 * PI * 0.16, PI * 0.16 * 1.4 + 4.0 / 3.0 * PI * 0.064, 2),
    ] {
        for tolerance in [1e-2, 1e-3] {
            let made = check(shape, tolerance);
            let found = measure(&made.mesh);
            let errors = (1.0 - found.0 / area, 1.0 - found.1 / volume);
            assert_eq!(found.2, euler);
            assert!(errors.0.abs() < 8.0 * tolerance && errors.1.abs() < 8.0 * tolerance, "{errors:?}");
        }
    }
}

#[test]
fn sharp_edges_are_kept() {
    let cube = AnyField::Primitive(Primitive::Box { half: DVec3::new(0.5, 0.6, 0.7), radius: 0.0 });
    let made = check(&surface(cube.clone(), 1.0), 1e-3);
    let found = measure(&made.mesh);
    assert!((found.1 - 8.0 * 0.21).abs() < 1e-9, "{found:?}");
    let drilled = AnyField::Joined(Joined {
        join: Join::Difference(Blend::Sharp),
        of: vec![cube, AnyField::Primitive(Primitive::Cylinder { radius: 0.3, half: 2.0 })],
    });
    let made = check(&surface(drilled, 1.0), 1e-3);
    let found = measure(&made.mesh);
    assert_eq!(found.2, 0);
    assert!((found.1 - (8.0 * 0.21 - PI * 0.09 * 1.2)).abs() < 2e-3, "{found:?}");
}

/// Seeded skeletons of seven balls, which merge, touch and pierce: none of their triangles cross.
#[test]
fn random_skeletons_are_sound() {
    for seed in 0..40 {
        check(&surface(balls(7, seed), 1.1), 1e-2);
    }
}

/// Surfaces with edges that begin and end somewhere: of curves that turn back, and of potentials that end with a slope.
#[test]
fn random_skeletons_with_edges_are_sound() {
    for seed in 6..18 {
        let field = mixed(seed);
        let within = field.bounds().expect("potentials fall off");
        check(&FieldSurface { field, within, least: None }, 2e-2);
    }
}
