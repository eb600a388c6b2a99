//! Distances to triangles against closed forms.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{AnyField, Blend, Distance, Field, Join, Joined, Primitive};
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::mesh::topology;
use crate::geometry::number::{Bounds, sin_cos_degrees};

/// Triangles with one normal each.
pub(super) fn faceted(points: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> AnyField {
    let found = topology::of_triangles(&triangles, points.len()).expect("few");
    assert!(found.closed && crossings(&points, &triangles).is_empty(), "{found:?}");
    let normal = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        [(b - a).cross(c - a).normalize(); 3]
    };
    let normals = triangles.iter().map(normal).collect();
    AnyField::Distance(Arc::new(Distance::new(points, triangles, normals)))
}

/// An outline in the x, y plane, counter-clockwise, with the triangles that fill it, from one z to another.
fn prism(outline: &[DVec2], fill: &[[u32; 3]], low: f64, high: f64) -> AnyField {
    let count = u32::try_from(outline.len()).expect("few");
    let points = [low, high].iter().flat_map(|z| outline.iter().map(|point| point.extend(*z))).collect();
    let ends = fill.iter().flat_map(|[a, b, c]| [[*a, *c, *b], [a + count, b + count, c + count]]);
    let walls = (0..count).flat_map(|a| {
        let b = (a + 1) % count;
        [[a, b, b + count], [a, b + count, a + count]]
    });
    faceted(points, ends.chain(walls).collect())
}

fn cube(half: DVec3) -> AnyField {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let outline: Vec<DVec2> = corners.iter().map(|corner| DVec2::from(*corner) * half.truncate()).collect();
    prism(&outline, &[[0, 1, 2], [0, 2, 3]], -half.z, half.z)
}

/// An L: a square of 2 without its upper right quarter.
pub(super) fn bent() -> AnyField {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(DVec2::from);
    prism(&outline, &[[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]], 0.0, 1.0)
}

/// A ball of rows and columns, whose corners lie on it and have its normals.
fn ball(rows: u32) -> (AnyField, f64) {
    let columns = 2 * rows;
    let mut points = vec![DVec3::Z, DVec3::NEG_Z];
    let step = 180.0 / f64::from(rows);
    for row in 1..rows {
        let (ring, height) = sin_cos_degrees(step * f64::from(row));
        points.extend((0..columns).map(|column| {
            let (sine, cosine) = sin_cos_degrees(step * f64::from(column));
            DVec3::new(ring * cosine, ring * sine, height)
        }));
    }
    let at = |row: u32, column: u32| 2 + (row - 1) * columns + column % columns;
    let mut triangles = Vec::new();
    for column in 0..columns {
        triangles.push([0, at(1, column), at(1, column + 1)]);
        triangles.push([1, at(rows - 1, column + 1), at(rows - 1, column)]);
        for row in 1..rows - 1 {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    let flat = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| points[corner as usize]);
        (b - a).cross(c - a).normalize().dot(a)
    };
    let off = 1.0 - triangles.iter().map(flat).fold(1.0, f64::min);
    let normals = triangles.iter().map(|corners| corners.map(|corner| points[corner as usize])).collect();
    (AnyField::Distance(Arc::new(Distance::new(points, triangles, normals))), off)
}

fn places(reach: f64) -> impl Iterator<Item = DVec3> {
    (1..1500_u32).map(move |k| {
        let part = |step: f64| ((f64::from(k) * step).fract() * 2.0 - 1.0) * reach;
        DVec3::new(part(0.819_172_51), part(0.671_043_61), part(0.549_700_48))
    })
}

/// Outside, inside, over sides, edges and corners the values and slopes are those of the closed form.
#[test]
fn the_distance_to_a_cube_is_that_of_a_box() {
    let half = DVec3::new(0.5, 0.4, 0.7);
    let (mesh, known) = (cube(half), AnyField::Primitive(Primitive::Box { half, radius: 0.0 }));
    for place in places(1.2) {
        let ((value, slope), (wanted, steepest)) = (mesh.value_gradient(place), known.value_gradient(place));
        assert!((value - wanted).abs() < 1e-14, "{value} {wanted} at {place}");
        assert!(slope.distance(steepest) < 1e-12, "{slope} {steepest} at {place}");
    }
    assert!(mesh.has_kinks());
    assert_eq!(mesh.bounds(), known.bounds());
}

/// Signs are right around edges and corners that look inward, and near them the distance is that of two boxes.
#[test]
fn the_sign_is_right_beside_a_corner_that_looks_inward() {
    let mesh = bent();
    let within = |place: DVec3| {
        let flat = |low: f64, x: f64, high: f64| low < x && x < high;
        let either = flat(0.0, place.x, 1.0) || flat(0.0, place.y, 1.0);
        either && flat(0.0, place.x, 2.0) && flat(0.0, place.y, 2.0) && flat(0.0, place.z, 1.0)
    };
    let mut inside = 0;
    for place in places(1.5).map(|place| place + DVec3::new(1.0, 1.0, 0.5)) {
        assert_eq!(mesh.value(place) < 0.0, within(place), "{} at {place}", mesh.value(place));
        inside += u32::from(within(place));
    }
    assert!(inside > 100, "{inside}");
    // In the notch the two walls are nearest.
    let value = mesh.value(DVec3::new(1.2, 1.3, 0.5));
    assert!((value - 0.2).abs() < 1e-15, "{value}");
    // Within, beside its edge, that edge is nearest.
    let value = mesh.value(DVec3::new(0.9, 0.9, 0.5));
    assert!((value + 0.1 * 2.0_f64.sqrt()).abs() < 1e-15, "{value}");
}

/// No further from the ball's own distance than its triangles, and with its normals.
#[test]
fn the_distance_to_a_ball_of_triangles_is_that_of_the_ball() {
    let (mesh, off) = ball(24);
    for place in places(1.4) {
        let (value, normal) = mesh.value_normal(place);
        let wanted = place.length() - 1.0;
        assert!(value >= wanted - 1e-14 && value <= wanted + off + 1e-14, "{value} {wanted}");
        if wanted.abs() < 0.2 {
            assert!(normal.dot(place.normalize()) > 1.0 - off / 4.0, "{normal} at {place}");
        }
    }
    assert!(!mesh.has_kinks(), "it stands for something smooth");
}

/// Values and slopes in boxes near edges, in joins and moved outward are within what is told of the boxes; far from edges slopes
/// are told exactly, so that a search ends.
#[test]
fn studies_of_boxes_hold_what_is_in_them() {
    let half = DVec3::new(0.5, 0.4, 0.7);
    let cut = AnyField::Joined(Joined {
        join: Join::Difference(Blend::Rvachev),
        of: vec![bent(), AnyField::Primitive(Primitive::Sphere { radius: 0.8 })],
    });
    let grown = AnyField::Grown { of: Box::new(bent()), by: 0.2 };
    for field in [cube(half), bent(), ball(12).0, cut, grown] {
        for (number, middle) in places(1.3).enumerate().step_by(5) {
            let half = DVec3::new(0.03, 0.05, 0.04) * [0.02, 0.3, 1.0, 4.0][number % 4];
            let study = field.study(&Bounds { min: middle - half, max: middle + half });
            for part in places(1.0).take(60) {
                let (value, slope) = field.value_gradient(middle + half * part);
                assert!(study.value.contains(value), "{value} of {study:?} in {field:?}");
                for (slope, bounds) in slope.to_array().into_iter().zip(study.gradient) {
                    let told = bounds.low - 1e-9 <= slope && slope <= bounds.high + 1e-9;
                    assert!(told, "{slope} of {bounds:?} near {middle} in {field:?}");
                }
            }
        }
    }
    let face = cube(half).study(&Bounds { min: DVec3::new(0.45, 0.1, 0.1), max: DVec3::new(0.55, 0.2, 0.2) });
    assert!(face.turns_little() && face.gradient[0].low > 0.99 && face.gradient[1].size() < 1e-9, "{face:?}");
}

/// Each place belongs to the body that says the value there.
#[test]
fn places_belong_to_the_body_that_is_nearest() {
    let ball = |x: f64| {
        let body = AnyField::Primitive(Primitive::Sphere { radius: 1.0 });
        let map = glam::DAffine3::from_translation(DVec3::X * x);
        AnyField::Placed(super::Placed::new(body, &map))
    };
    let pair = |join: Join, x: f64| AnyField::Joined(Joined { join, of: vec![ball(-x), ball(x)] });
    let all = AnyField::Joined(Joined {
        join: Join::Union(Blend::Smooth(0.1)),
        of: vec![pair(Join::Union(Blend::Sharp), 3.0), pair(Join::Difference(Blend::Sharp), 0.5)],
    });
    assert_eq!(all.owners(), 4);
    let owners = [-4.0, 4.0, -1.5, -0.5].map(|x| all.owner(DVec3::X * x));
    assert_eq!(owners, [0, 1, 2, 3]);
}
