//! Laws of quadrics.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::{Quadric, QuadricForm, QuadricKind, Sheet};
use crate::geometry::field::Field;
use crate::geometry::number::Bounds;

/// A quadric of each kind in its own axes, by squares, linear terms and constant.
const PLAIN: [(QuadricKind, [f64; 3], [f64; 3], f64); 19] = [
    (QuadricKind::Ellipsoid, [1.0, 0.25, 4.0], [0.0; 3], -1.0),
    (QuadricKind::Ellipsoid, [-1.0, -1.0, -1.0], [0.0; 3], 2.0),
    (QuadricKind::OneSheet, [1.0, 2.0, -0.5], [0.0; 3], -1.0),
    (QuadricKind::OneSheet, [-1.0, 2.0, -0.5], [0.0; 3], 1.0),
    (QuadricKind::TwoSheets, [1.0, 2.0, -0.5], [0.0; 3], 1.0),
    (QuadricKind::Cone, [1.0, -2.0, 0.5], [0.0; 3], 0.0),
    (QuadricKind::EllipticParaboloid, [1.0, 2.0, 0.0], [0.0, 0.0, 3.0], 1.0),
    (QuadricKind::EllipticParaboloid, [0.0, -1.0, -2.0], [3.0, 0.0, 0.0], 0.0),
    (QuadricKind::HyperbolicParaboloid, [1.0, -2.0, 0.0], [0.0, 0.0, 3.0], 1.0),
    (QuadricKind::EllipticCylinder, [1.0, 0.0, 2.0], [0.0; 3], -3.0),
    (QuadricKind::HyperbolicCylinder, [1.0, 0.0, -2.0], [0.0; 3], -3.0),
    (QuadricKind::HyperbolicCylinder, [1.0, 0.0, -2.0], [0.0; 3], 3.0),
    (QuadricKind::ParabolicCylinder, [0.0, 2.0, 0.0], [1.0, 0.0, 2.0], 1.0),
    (QuadricKind::CrossingPlanes, [1.0, -2.0, 0.0], [0.0; 3], 0.0),
    (QuadricKind::ParallelPlanes, [0.0, 2.0, 0.0], [0.0; 3], -1.0),
    (QuadricKind::Plane, [0.0; 3], [1.0, 2.0, -2.0], 3.0),
    (QuadricKind::Line, [1.0, 0.0, 1.0], [0.0; 3], 0.0),
    (QuadricKind::Point, [1.0, 2.0, 1.0], [0.0; 3], 0.0),
    (QuadricKind::Empty, [1.0, 2.0, 0.0], [0.0; 3], 1.0),
];

/// The quadric turned and moved: F'(x) = F(R^T (x - o)).
fn placed(squares: [f64; 3], linear: [f64; 3], constant: f64, turn: DQuat, origin: DVec3) -> Quadric {
    let rotation = DMat3::from_quat(turn);
    let a = rotation * DMat3::from_diagonal(DVec3::from_array(squares)) * rotation.transpose();
    let b = rotation * DVec3::from_array(linear);
    let moved = Quadric { a, b, c: constant };
    Quadric { a, b: b - (a * origin) * 2.0, c: moved.value(-origin) }
}

fn all() -> Vec<(QuadricKind, Quadric, DVec3)> {
    let mut all = Vec::new();
    for (kind, squares, linear, constant) in PLAIN {
        for (turn, origin) in [
            (DQuat::IDENTITY, DVec3::ZERO),
            (DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5), DVec3::new(3.0, -1.0, 2.0)),
            (DQuat::from_xyzw(0.18, -0.36, 0.54, 0.738_918_1).normalize(), DVec3::new(-0.3, 20.0, 1.7)),
        ] {
            all.push((kind, placed(squares, linear, constant, turn, origin), origin));
        }
    }
    all
}

#[test]
fn each_kind_is_recognized_wherever_it_stands() {
    for (kind, quadric, origin) in all() {
        assert_eq!(QuadricForm::new(&quadric, origin, 3.0).kind, kind, "{quadric:?}");
        assert_eq!(
            QuadricForm::new(&quadric, origin + DVec3::new(1.0, 2.0, -1.0), 5.0).kind,
            kind,
            "{quadric:?}"
        );
        let scaled = Quadric { a: quadric.a * 1e-7, b: quadric.b * 1e-7, c: quadric.c * 1e-7 };
        assert_eq!(QuadricForm::new(&scaled, origin, 3.0).kind, kind);
    }
    let nothing = Quadric { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0 };
    assert_eq!(QuadricForm::new(&nothing, DVec3::ZERO, 1.0).kind, QuadricKind::Everything);
    let ball = Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::new(-2e6, 0.0, 0.0), 1e12 - 1.0);
    assert_eq!(QuadricForm::anywhere(&ball).kind, QuadricKind::Ellipsoid);
    assert!((QuadricForm::anywhere(&ball).half.x - 1.0).abs() < 1e-3);
}

fn places() -> impl Iterator<Item = DVec2> {
    (-8..=8).flat_map(|a| (-8..=8).map(move |b| DVec2::new(f64::from(a), f64::from(b)) / 8.5))
}

#[test]
fn sheets_lie_on_the_surface_and_know_their_own_coordinates() {
    for (kind, quadric, origin) in all() {
        let form = QuadricForm::new(&quadric, origin, 3.0);
        let sheets = Sheet::all(&form, &[]);
        for sheet in &sheets {
            let mut tried = 0;
            for place in places() {
                // Angles are covered by half turns, what is drawn together by small numbers.
                let place = match kind {
                    QuadricKind::Cone => DVec2::new(place.x * 3.0, place.y * 1e-3),
                    QuadricKind::OneSheet => DVec2::new(place.x * 3.0, place.y),
                    QuadricKind::EllipticCylinder => DVec2::new(place.x * 3.0, place.y * 1e-3),
                    _ => place * 0.7,
                };
                let point = sheet.lift(place);
                let size = quadric.gradient(point).length() * (point.distance(origin) + 1.0);
                assert!(
                    quadric.value(point).abs() < 1e-13 * size * (1.0 + origin.length()),
                    "{kind:?} {place}"
                );
                if sheet.limits().iter().all(|limit| limit.depth(point) > 0.0) {
                    tried += 1;
                    assert!(sheet.drop(point).distance(place) < 1e-9, "{kind:?} {place} {sheet:?}");
                }
            }
            assert!(tried > 40, "{kind:?}");
        }
    }
}

#[test]
fn coordinates_make_the_second_form_alike_in_all_directions() {
    for (kind, quadric, origin) in all() {
        let form = QuadricForm::new(&quadric, origin, 3.0);
        for sheet in Sheet::all(&form, &[]) {
            let h = 1e-4;
            let straight = matches!(
                kind,
                QuadricKind::EllipticCylinder
                    | QuadricKind::HyperbolicCylinder
                    | QuadricKind::ParabolicCylinder
                    | QuadricKind::Cone
            );
            if straight {
                continue;
            }
            for place in places().filter(|place| place.length() < 0.9) {
                // For a quadric the second form is A on tangents, up to the length of the gradient.
                let tangent = |step: DVec2| (sheet.lift(place + step) - sheet.lift(place - step)) / (2.0 * h);
                let (u, v) = (tangent(DVec2::X * h), tangent(DVec2::Y * h));
                let (uu, vv) = (quadric.bent(u), quadric.bent(v));
                let uv = u.dot(quadric.a * v);
                assert!((uu.abs() / vv.abs() - 1.0).abs() < 1e-5, "{kind:?} {place}: {uu} {vv}");
                assert!(uv.abs() < 1e-5 * uu.abs(), "{kind:?} {place}");
            }
        }
    }
}

#[test]
fn ranges_hold_values_and_gradients() {
    for (_, quadric, origin) in all() {
        for (low, high) in [([-1.0, -0.5, 0.2], [0.3, 0.5, 2.0]), ([0.1; 3], [0.11; 3])] {
            let within =
                Bounds { min: origin + DVec3::from_array(low), max: origin + DVec3::from_array(high) };
            let (least, most) = quadric.range(&within);
            let gradients = quadric.gradient_range(&within);
            for k in 0..125 {
                let part = DVec3::new(f64::from(k % 5), f64::from(k / 5 % 5), f64::from(k / 25)) / 4.0;
                let point = within.min + (within.max - within.min) * part;
                let slack = 1e-11;
                let (value, gradient) = (quadric.value(point), quadric.gradient(point));
                assert!(least - slack <= value && value <= most + slack);
                assert!(
                    gradient.cmpge(gradients.min - slack).all()
                        && gradient.cmple(gradients.max + slack).all()
                );
            }
        }
    }
}

#[test]
fn points_settle_on_the_surface() {
    for (kind, quadric, origin) in all() {
        let form = QuadricForm::new(&quadric, origin, 3.0);
        for sheet in Sheet::all(&form, &[]) {
            let point = sheet.lift(DVec2::new(0.3, 1e-4));
            let off = point + DVec3::new(1e-3, -2e-3, 1e-3);
            let settled = quadric.settled(off).expect("near a smooth place");
            let size = quadric.gradient(settled).length() * (1.0 + origin.length_squared());
            assert!(quadric.value(settled).abs() < 1e-14 * size, "{kind:?}");
            assert!(settled.distance(point) < 1e-2);
        }
    }
}
