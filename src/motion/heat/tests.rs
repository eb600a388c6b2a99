use glam::{DVec2, DVec3};

use super::{HeatFault, heat_weights};
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Vertex, VertexIndex, index};
use crate::geometry::number::{exp, sin_cos_degrees};
use crate::motion::{Bone, Joint, Limits, Skeleton};

const MOST: u64 = 1 << 30;

/// A chain of bones through points.
fn chain(points: &[DVec3]) -> Skeleton {
    let bone = |(at, ends): (usize, &[DVec3])| Bone {
        name: format!("bone-{at}"),
        parent: at.checked_sub(1),
        head: ends[0],
        tail: ends[1],
        roll: 0.0,
        limits: Limits::default(),
        slide: [None; 3],
        stiffness: 0.0,
    };
    Skeleton::new(points.windows(2).enumerate().map(bone).collect()).expect("a chain")
}

fn mesh(points: Vec<DVec3>, triangles: &[[usize; 3]]) -> Mesh {
    let vertex = |point: u32| Vertex {
        point: PointIndex(point),
        normal: DVec3::Z,
        uv: DVec2::ZERO,
        color: Color::WHITE,
        anchor: Anchor::default(),
    };
    let vertices = (0..index(points.len())).map(vertex).collect();
    let triangles =
        triangles.iter().map(|corners| corners.map(|corner| VertexIndex(index(corner)))).collect();
    Mesh { points, vertices, triangles, runs: Vec::new() }
}

/// A tube around a line through `at` along y, open at both ends, from -half to half. With a seam, the points of its
/// first line stand there twice.
fn tube(
    at: DVec3,
    radius: f64,
    half: f64,
    (around, along): (usize, usize),
    seam: bool,
) -> (Vec<DVec3>, Vec<[usize; 3]>) {
    let columns = around + usize::from(seam);
    let mut points = Vec::new();
    for row in 0..=along {
        for column in 0..columns {
            let (sine, cosine) = sin_cos_degrees(360.0 * (column % around) as f64 / around as f64);
            let y = half * (2.0 * row as f64 / along as f64 - 1.0);
            points.push(at + DVec3::new(radius * cosine, y, radius * sine));
        }
    }
    let mut triangles = Vec::new();
    for row in 0..along {
        for column in 0..around {
            let corner = |row: usize, column: usize| row * columns + column % columns;
            let (a, b) = (corner(row, column), corner(row, column + 1));
            let (c, d) = (corner(row + 1, column), corner(row + 1, column + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    (points, triangles)
}

fn both(one: (Vec<DVec3>, Vec<[usize; 3]>), other: (Vec<DVec3>, Vec<[usize; 3]>)) -> Mesh {
    let count = one.0.len();
    let triangles = other.1.iter().map(|corners| corners.map(|corner| corner + count));
    let triangles: Vec<[usize; 3]> = one.1.into_iter().chain(triangles).collect();
    mesh([one.0, other.0].concat(), &triangles)
}

fn joints(skeleton: &Skeleton) -> Vec<&Joint> {
    skeleton.joints.iter().collect()
}

/// Along a tube of radius r around two bones that meet, heat obeys w'' = 4 (w - p) / r²: the weight of the one is half of
/// exp(-2 y / r) on the side of the other.
#[test]
fn along_a_tube_weights_fall_off_as_heat_does() {
    let skeleton = chain(&[DVec3::Y * -4.0, DVec3::ZERO, DVec3::Y * 4.0]);
    let mut errors = Vec::new();
    for steps in [(24, 160), (48, 320)] {
        let (points, triangles) = tube(DVec3::ZERO, 0.5, 4.0, steps, false);
        let mesh = mesh(points, &triangles);
        let weights = heat_weights(&mesh, &joints(&skeleton), MOST).expect("weights");
        // Bones lie square to the skin: they count as a thousandth nearer.
        let radius = 0.5 * 2.0 / 2.002;
        let mut worst: f64 = 0.0;
        for (at, point) in mesh.points.iter().enumerate() {
            let fall = 0.5 * exp(-2.0 * point.y.abs() / radius);
            let wanted = if point.y < 0.0 { 1.0 - fall } else { fall };
            let of = weights.of(at);
            worst = worst.max((of[0] - wanted).abs());
            assert!((of[0] + of[1] - 1.0).abs() < 1e-12, "{of:?}");
        }
        errors.push(worst);
    }
    // Of second order in the steps along, 5 and 10 of which heat takes to fall to 1 / e, and around.
    assert!(errors[0] < 6e-3 && errors[1] < errors[0] / 2.5, "{errors:?}");
}

#[test]
fn seams_sizes_and_places_do_not_count() {
    let ends = [DVec3::Y * -2.0, DVec3::Y * -0.3, DVec3::Y * 0.8, DVec3::Y * 2.0];
    let (points, triangles) = tube(DVec3::ZERO, 0.4, 2.0, (12, 30), false);
    let whole = mesh(points, &triangles);
    let (points, triangles) = tube(DVec3::ZERO, 0.4, 2.0, (12, 30), true);
    let cut = mesh(points, &triangles);
    let one = heat_weights(&whole, &joints(&chain(&ends)), MOST).expect("weights");
    let other = heat_weights(&cut, &joints(&chain(&ends)), MOST).expect("weights");
    for row in 0..=30 {
        assert_eq!(other.of(row * 13), other.of(row * 13 + 12), "both lines of the seam");
        for column in 0..12 {
            for (a, b) in one.of(row * 12 + column).iter().zip(other.of(row * 13 + column)) {
                assert!((a - b).abs() < 1e-9);
            }
        }
    }
    let moved = |point: DVec3| 300.0 * point + DVec3::new(70.0, -20.0, 5.0);
    let mut large = whole.clone();
    large.points.iter_mut().for_each(|point| *point = moved(*point));
    let found = heat_weights(&large, &joints(&chain(&ends.map(moved))), MOST).expect("weights");
    for point in 0..whole.points.len() {
        let apart = one.of(point).iter().zip(found.of(point)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-8, "{apart}");
    }
}

#[test]
fn what_a_wall_hides_is_told() {
    let skeleton = chain(&[DVec3::Y * -1.0, DVec3::ZERO, DVec3::Y]);
    let inner = || tube(DVec3::ZERO, 0.2, 1.0, (16, 20), false);
    // A sleeve around the tube sees only the tube.
    let sleeve = both(inner(), tube(DVec3::ZERO, 0.4, 0.7, (16, 10), false));
    let fault = heat_weights(&sleeve, &joints(&skeleton), MOST).expect_err("hidden");
    assert_eq!(fault, HeatFault::Unseen { parts: 1, count: 16 * 11, first: 16 * 21 });
    // A second tube, which has a bone of its own.
    let beside = both(inner(), tube(DVec3::X, 0.2, 1.0, (16, 20), false));
    let fault = heat_weights(&beside, &joints(&skeleton), MOST).expect_err("hidden");
    assert!(matches!(fault, HeatFault::Unseen { parts: 1, .. }), "{fault:?}");
    let other = chain(&[DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0)]);
    let all: Vec<&Joint> = skeleton.joints.iter().chain(&other.joints).collect();
    let weights = heat_weights(&beside, &all, MOST).expect("weights");
    for point in 0..beside.points.len() {
        let own = weights.of(point)[2];
        let wanted = if point < 16 * 21 { 0.0 } else { 1.0 };
        assert!((own - wanted).abs() < 1e-12, "{own} at {}", beside.points[point]);
    }
}

#[test]
fn bones_outside_carry_what_no_other_does() {
    // A plate beside a bone that it turns its back to, and one that it faces.
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let plate = mesh(points.to_vec(), &[[0, 1, 2], [0, 2, 3]]);
    let place = |z: f64| chain(&[DVec3::new(0.5, 0.0, z), DVec3::new(0.5, 1.0, z)]);
    for side in [-0.3, 0.3] {
        let weights = heat_weights(&plate, &joints(&place(side)), MOST).expect("weights");
        assert!((0..4).all(|point| (weights.of(point)[0] - 1.0).abs() < 1e-9));
    }
    // Of the two the one behind the plate carries, though it is further away.
    let (behind, before) = (place(-0.3), place(0.2));
    let all: Vec<&Joint> = behind.joints.iter().chain(&before.joints).collect();
    let weights = heat_weights(&plate, &all, MOST).expect("weights");
    assert!((0..4).all(|point| weights.of(point)[0] > 0.99));
}

#[test]
fn bones_in_the_skin_and_points_of_no_triangle_are_borne() {
    let points =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [5.0, 0.5]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let sheet = mesh(points.to_vec(), &[[0, 1, 2], [0, 2, 3]]);
    let skeleton = chain(&[DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]);
    let weights = heat_weights(&sheet, &joints(&skeleton), MOST).expect("weights");
    assert!(weights.of(0)[0] > 0.999 && weights.of(2)[1] > 0.999, "{:?} {:?}", weights.of(0), weights.of(2));
    assert!((weights.of(3)[0] - 0.5).abs() < 1e-3, "where they meet: {:?}", weights.of(3));
    assert_eq!(weights.of(4), [0.0, 1.0]);
}

#[test]
fn what_takes_too_much_is_refused_first() {
    let (points, triangles) = tube(DVec3::ZERO, 0.5, 2.0, (24, 40), false);
    let skeleton = chain(&[DVec3::Y * -2.0, DVec3::Y * 2.0]);
    let fault = heat_weights(&mesh(points, &triangles), &joints(&skeleton), 100_000).expect_err("too much");
    assert!(matches!(fault, HeatFault::Limit { needed } if needed > 100_000), "{fault:?}");
}
