//! Laws of fields: gradients are the differences of values, and ranges hold what they must.

use glam::{DAffine3, DVec3};

use super::{
    AnyField, Blend, Bump, Element, Field, Form, Join, Joined, Line, Perturbed, Placed, Potential, Primitive,
    Skeleton,
};
use crate::geometry::curve::{AnyCurve, Curve, interpolate};
use crate::geometry::number::Bounds;

fn all() -> Vec<AnyField> {
    let ball = AnyField::Primitive(Primitive::Sphere { radius: 0.7 });
    let cuboid = AnyField::Primitive(Primitive::Box { half: DVec3::new(0.5, 0.4, 0.6), radius: 0.1 });
    let potentials = [
        Potential::Gaussian { sharpness: 3.0 },
        Potential::Wyvill { radius: 0.8 },
        Potential::Power { radius: 0.9, exponent: 2 },
        Potential::Power { radius: 0.9, exponent: 3 },
    ];
    let element = |(k, potential): (usize, Potential)| {
        let place = DVec3::new(0.2 * k as f64 - 0.3, 0.1, -0.2);
        let form =
            if k % 2 == 0 { Form::Point(place) } else { Form::Segment(place, DVec3::new(0.1, 0.6, 0.3)) };
        Element { form, potential, strength: if k == 2 { -0.4 } else { 1.0 } }
    };
    let elements = potentials.into_iter().enumerate().map(element).collect();
    let skeleton = AnyField::Skeleton(Box::new(Skeleton::new(elements, 0.5)));
    let turned = DAffine3::from_rotation_z(0.6) * DAffine3::from_translation(DVec3::new(0.2, 0.1, 0.0));
    let placed = AnyField::Placed(Placed::new(cuboid.clone(), &turned));
    let join = |join: Join| AnyField::Joined(Joined { join, of: vec![ball.clone(), placed.clone()] });
    let bump =
        Bump { field: AnyField::Primitive(Primitive::Capsule { radius: 0.3, half: 0.4 }), factor: 2.0 };
    vec![
        ball.clone(),
        cuboid,
        AnyField::Primitive(Primitive::Torus { major: 0.6, minor: 0.2 }),
        AnyField::Primitive(Primitive::Cone { bottom: 0.5, top: 0.2, half: 0.5 }),
        skeleton,
        join(Join::Union(Blend::Smooth(0.3))),
        join(Join::Intersection(Blend::Rvachev)),
        join(Join::Difference(Blend::Sharp)),
        AnyField::Perturbed(Perturbed { base: Box::new(ball.clone()), bumps: vec![bump] }),
        AnyField::Skin { of: Box::new(ball), half: 0.1 },
        placed,
    ]
}

/// A curve that turns back on itself, in half of the space that places come from.
fn hairpin() -> AnyCurve {
    let points = [[-0.5, -0.3, 0.1], [0.5, 0.0, 0.3], [0.45, 0.1, 0.25], [-0.4, 0.2, -0.3]].map(DVec3::from);
    AnyCurve::Bezier(interpolate(&points, &[0.0, 1.0, 1.2, 2.2]).expect("distinct"))
}

/// Skeletons whose nearest places jump, or whose potentials end with a slope.
fn kinked() -> Vec<AnyField> {
    let corners = [[-0.6, 0.1, 0.0], [0.4, 0.5, 0.1], [0.5, -0.4, 0.0], [-0.1, -0.7, -0.2]].map(DVec3::from);
    let [a, b, c, d] = corners;
    let line = || Form::Curves(vec![Line::new(&hairpin())]);
    let one = |form: Form, potential: Potential| {
        AnyField::Skeleton(Box::new(Skeleton::new(vec![Element { form, potential, strength: 1.2 }], 0.5)))
    };
    vec![
        one(line(), Potential::Gaussian { sharpness: 5.0 }),
        one(line(), Potential::Wyvill { radius: 0.9 }),
        one(line(), Potential::Power { radius: 0.7, exponent: 1 }),
        one(Form::Triangles(vec![[a, b, c], [a, c, d]]), Potential::Power { radius: 0.8, exponent: 2 }),
    ]
}

/// Places that lie on no kink of the fields above.
fn places() -> impl Iterator<Item = DVec3> {
    (0..200_u32).map(|k| {
        let part = |step: f64| (f64::from(k) * step).fract() * 1.8 - 0.9;
        DVec3::new(part(0.754_877_67), part(0.569_840_29), part(0.430_159_71))
    })
}

#[test]
fn gradients_are_differences_of_values() {
    const STEP: f64 = 1e-6;
    for field in all() {
        let mut off = 0;
        for place in places() {
            let gradient = field.gradient(place);
            let slope = |axis: DVec3| {
                (field.value(place + axis * STEP) - field.value(place - axis * STEP)) / (2.0 * STEP)
            };
            let differences = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            off += u32::from(gradient.distance(differences) > 1e-6 * (1.0 + gradient.length()));
        }
        // A difference across a kink is no derivative.
        assert!(off <= 1, "{off} of {field:?}");
    }
}

#[test]
fn ranges_hold_values_and_gradients() {
    for field in all().into_iter().chain(kinked()) {
        for (k, place) in places().enumerate().step_by(3) {
            let half = DVec3::new(0.02, 0.05, 0.03) * [0.05, 1.0, 2.0, 3.0, 5.0][k % 5];
            let study = field.study(&Bounds { min: place - half, max: place + half });
            for part in places() {
                let inside = place + half * part;
                let (value, gradient) = field.value_gradient(inside);
                assert!(study.value.contains(value), "{value} of {study:?} in {field:?}");
                for (slope, bounds) in gradient.to_array().into_iter().zip(study.gradient) {
                    let slack = 1e-12 * (1.0 + slope.abs());
                    assert!(
                        bounds.low - slack <= slope && slope <= bounds.high + slack,
                        "{slope} of {bounds:?}"
                    );
                }
            }
        }
    }
}

/// No place of a curve is nearer than the nearest, found among very many.
#[test]
fn nearest_places_of_curves_are_the_nearest() {
    let curve = hairpin();
    let domain = curve.domain();
    let all: Vec<DVec3> = (0..=20_000).map(|k| curve.point(domain.at(f64::from(k) / 20_000.0))).collect();
    let line = Line::new(&curve);
    for place in places() {
        let least = all.iter().map(|point| point.distance(place)).fold(f64::INFINITY, f64::min);
        let found = line.nearest(place).distance(place);
        // Half a step of those many along the curve.
        assert!(found <= least + 1e-12 && least <= found + 1e-7, "{found} of {least} at {place}");
    }
}
