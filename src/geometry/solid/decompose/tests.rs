use glam::DVec3;

use super::{ConvexPart, Decomposing, decompose};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::Bounds;
use crate::geometry::solid::check::moments;
use crate::geometry::solid::skin::skin;
use crate::geometry::solid::{Combination, Making, SolidFault, Stock, combine, hull};

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Mesh {
    let bounds = Bounds { min: DVec3::from_array(min), max: DVec3::from_array(max) };
    hull(&bounds.corners(), 30.0).expect("a box")
}

fn union(parts: &[Mesh]) -> Mesh {
    let mut stock = Stock::default();
    let all = parts.iter().map(|part| Combination::Part(stock.add(part, 0))).collect();
    combine(&stock, &Combination::Union(all), &Making::default()).expect("a solid").mesh
}

/// A ring of a square section, in steps of 15 degrees.
fn ring() -> Mesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for step in 0..24_u32 {
        let (sine, cosine) = crate::geometry::number::sin_cos_degrees(f64::from(step) * 15.0);
        for (radius, y) in [(1.0, -0.2), (1.4, -0.2), (1.4, 0.2), (1.0, 0.2)] {
            points.push(DVec3::new(radius * cosine, y, radius * sine));
        }
        for side in 0..4 {
            let [a, b] = [4 * step + side, 4 * step + (side + 1) % 4];
            let [c, d] = [a, b].map(|corner| (corner + 4) % 96);
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    let (volume, _) = moments(&points, triangles.iter().copied());
    if volume < 0.0 {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    skin(points, &triangles, 30.0).expect("a ring")
}

fn volume(parts: &[ConvexPart]) -> f64 {
    parts.iter().map(|part| moments(&part.points, part.triangles.iter().copied()).0 / 6.0).sum()
}

/// How far the points of a mesh lie outside of all parts, and whether the parts are convex.
fn uncovered(mesh: &Mesh, parts: &[ConvexPart]) -> f64 {
    let outside = |part: &ConvexPart, point: DVec3| {
        let above = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| part.points[corner as usize]);
            (point - a).dot((b - a).cross(c - a).normalize_or_zero())
        };
        part.triangles.iter().map(above).fold(f64::NEG_INFINITY, f64::max)
    };
    for part in parts {
        let out = part.points.iter().map(|point| outside(part, *point)).fold(0.0, f64::max);
        assert!(out < 1e-8, "a corner is {out} outside of its own part");
    }
    let of = |point: &DVec3| parts.iter().map(|part| outside(part, *point)).fold(f64::INFINITY, f64::min);
    mesh.points.iter().map(of).fold(0.0, f64::max)
}

const HOW: Decomposing = Decomposing { most: 16, concavity: 0.05, vertices: 64 };

#[test]
fn what_is_convex_is_one_part() {
    let body = cuboid([0.0, 0.0, 0.0], [1.0, 2.0, 3.0]);
    let parts = decompose(&body, &HOW).expect("a body");
    assert_eq!((parts.len(), parts[0].points.len()), (1, 8));
    assert!((volume(&parts) - 6.0).abs() < 1e-12 && parts[0].concavity == 0.0);
}

/// Bodies put together from boxes come apart into boxes: no volume is added.
#[test]
fn boxes_come_apart_exactly() {
    let angle = [cuboid([0.0; 3], [3.0, 1.0, 1.0]), cuboid([0.0; 3], [1.0, 3.0, 1.0])];
    let channel = [
        cuboid([0.0; 3], [3.0, 1.0, 1.0]),
        cuboid([0.0; 3], [1.0, 3.0, 1.0]),
        cuboid([2.0, 0.0, 0.0], [3.0, 3.0, 1.0]),
    ];
    let leg = |x: f64, z: f64| cuboid([x, 0.0, z], [x + 0.2, 2.0, z + 0.2]);
    let table = [
        cuboid([0.0, 2.0, 0.0], [3.0, 2.2, 2.0]),
        leg(0.0, 0.0),
        leg(2.8, 0.0),
        leg(0.0, 1.8),
        leg(2.8, 1.8),
    ];
    for (boxes, count, exact) in [(&angle[..], 2, 5.0), (&channel[..], 3, 7.0), (&table[..], 5, 1.64)] {
        let body = union(boxes);
        let own = moments(&body.points, triangles(&body).into_iter()).0 / 6.0;
        let parts = decompose(&body, &HOW).expect("a body");
        assert_eq!(parts.len(), count);
        assert!((volume(&parts) - own).abs() < 1e-9, "{} of {own}, {exact}", volume(&parts));
        assert!(uncovered(&body, &parts) < 1e-9);
    }
}

fn triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.triangles.iter().map(|all| all.map(|v| mesh.vertices[v.subscript()].point.0)).collect()
}

/// More parts come nearer to the volume of a ring, and each keeps what was asked.
#[test]
fn rings_are_covered_the_better_the_more_parts() {
    let body = ring();
    let exact = moments(&body.points, triangles(&body).into_iter()).0 / 6.0;
    let mut before = f64::INFINITY;
    for most in [2, 6, 16] {
        let parts = decompose(&body, &Decomposing { most, ..HOW }).expect("a body");
        let ratio = volume(&parts) / exact;
        assert!(parts.len() <= most && uncovered(&body, &parts) < 1e-9, "{most}: {}", parts.len());
        assert!(ratio <= before && ratio > 1.0 - 1e-9, "{most}: {ratio} after {before}");
        assert!(most < 16 || parts.iter().all(|part| part.concavity <= HOW.concavity), "{most}: {parts:?}");
        before = ratio;
    }
    let coarse = decompose(&body, &Decomposing { vertices: 8, ..HOW }).expect("a body");
    assert!(coarse.iter().all(|part| part.points.len() <= 8) && uncovered(&body, &coarse) < 1e-8);
    // The same again is the same to the last bit.
    assert_eq!(coarse, decompose(&body, &Decomposing { vertices: 8, ..HOW }).expect("a body"));
}

#[test]
fn bodies_apart_and_hollows() {
    let mut pair = cuboid([0.0; 3], [1.0; 3]);
    pair.append(&cuboid([3.0, 0.0, 0.0], [4.0, 1.0, 1.0]), 0);
    let parts = decompose(&pair, &HOW).expect("two bodies");
    assert_eq!(parts.len(), 2);
    // One part alone has to span both.
    let one = decompose(&pair, &Decomposing { most: 1, ..HOW }).expect("two bodies");
    assert!(one.len() == 1 && (volume(&one) - 4.0).abs() < 1e-12 && one[0].concavity > 0.9, "{one:?}");
    let mut hollow = cuboid([0.0; 3], [3.0; 3]);
    let mut inner = cuboid([1.0; 3], [2.0; 3]);
    inner.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    hollow.append(&inner, 0);
    let parts = decompose(&hollow, &HOW).expect("a hollow body");
    assert!(parts.len() == 1 && (volume(&parts) - 27.0).abs() < 1e-12, "nothing reaches the hollow");
}

#[test]
fn what_encloses_nothing_is_refused() {
    let mut open = cuboid([0.0; 3], [1.0; 3]);
    open.triangles.pop();
    open.runs[0].end -= 1;
    assert!(matches!(decompose(&open, &HOW), Err(SolidFault::Open { .. })));
}
