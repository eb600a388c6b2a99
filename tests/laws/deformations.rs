//! Laws of maps that bend space.

use glam::DVec3;
use kiln::geometry::curve::{AnyCurve, Curve as _};
use kiln::geometry::number::Bounds;
use kiln::geometry::surface::{AxialDeformation, AxialKind, Carry, Deformation, Line, PathDeformation};

use super::{Dice, curves};

struct Subject {
    name: String,
    map: Deformation,
    /// Where points are taken from.
    space: Bounds,
    /// Share of sizes to which second derivatives are known.
    exactness: f64,
}

fn subjects() -> Vec<Subject> {
    let axis = DVec3::new(2.0, 3.0, 6.0) / 7.0;
    let side = DVec3::new(3.0, -6.0, 2.0) / 7.0;
    let mut all = Vec::new();
    for (name, kind) in [
        ("taper", AxialKind::Taper { start: 0.7, end: 1.6 }),
        ("twist", AxialKind::Twist(5.0)),
        ("untwist", AxialKind::Twist(-0.4)),
        ("bend", AxialKind::Bend(1.3)),
        ("bend back", AxialKind::Bend(-0.8)),
        ("no bend", AxialKind::Bend(0.0)),
    ] {
        for stops in [(false, false), (true, true), (true, false)] {
            let origin = DVec3::new(0.1, -0.2, 0.3);
            let map = AxialDeformation { origin, axis, side, from: -0.9, to: 1.1, stops, kind };
            let space = Bounds { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };
            let name = format!("{name}, stopped {stops:?}");
            all.push(Subject { name, map: Deformation::Axial(map), space, exactness: 1e-5 });
        }
    }
    for path in ["helix", "ring", "chordal", "ellipse", "line", "clamped"] {
        let (_, curve) = curves().into_iter().find(|(name, _)| name == path).expect("it is in the list");
        let curve: AnyCurve = curve;
        let map = PathDeformation::new(
            curve.clone(),
            &Carry::PLAIN,
            Line { origin: DVec3::ZERO, axis: DVec3::Z, side: DVec3::X, reach: (0.0, 0.0), scale: 1.0 },
        );
        let length = map.length();
        // Thinner than every bend is wide.
        let wide = if path == "helix" { 0.1 } else { 0.02 };
        let space = Bounds {
            min: DVec3::new(-wide, -wide, 0.02 * length),
            max: DVec3::new(wide, wide, 0.98 * length),
        };
        assert!(curve.domain().span() > 0.0);
        let name = format!("along {path}");
        all.push(Subject { name, map: Deformation::Along(Box::new(map)), space, exactness: 1e-3 });
    }
    all
}

impl Subject {
    fn point(&self, dice: &mut Dice) -> DVec3 {
        let mut number = |k: usize| dice.between(self.space.min[k], self.space.max[k]);
        DVec3::new(number(0), number(1), number(2))
    }

    /// Whether no kink lies within a step of a point.
    fn is_smooth(&self, point: DVec3, step: f64) -> bool {
        let kinks = self.map.kinks(&Bounds { min: point - 10.0 * step, max: point + 10.0 * step });
        kinks.iter().all(|(normal, offset)| (point.dot(*normal) - offset).abs() > 2.0 * step)
    }
}

fn direction(dice: &mut Dice) -> DVec3 {
    DVec3::new(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0))
        .normalize_or(DVec3::X)
}

#[test]
fn derivatives_are_the_limits_of_differences() {
    let mut dice = Dice::new(31);
    for subject in subjects() {
        let size = (subject.space.max - subject.space.min).length();
        let step = 1e-5 * size;
        let mut tried = 0;
        for _ in 0..60 {
            let point = subject.point(&mut dice);
            let (d, e) = (direction(&mut dice), direction(&mut dice));
            if !subject.is_smooth(point, step) {
                continue;
            }
            let (before, here, after) = (
                subject.map.apply(point - d * step),
                subject.map.apply(point),
                subject.map.apply(point + d * step),
            );
            let first = (after.point - before.point) / (2.0 * step);
            let expected = here.jacobian * d;
            assert!(first.distance(expected) <= 1e-5, "{} at {point}: {first} {expected}", subject.name);
            let second = (after.jacobian * e - before.jacobian * e) / (2.0 * step);
            let found = subject.map.second(point, point, (d, e));
            let scale = 1.0 + second.length();
            // Frames along a curve have a jump of their rate where its third derivative has one.
            if found.distance(second) <= subject.exactness * scale {
                tried += 1;
            }
        }
        assert!(tried >= 50, "{}: second derivatives agree at {tried} of 60 places", subject.name);
    }
}

#[test]
fn second_derivatives_change_no_faster_than_bounded_and_lengths_grow_no_more() {
    let mut dice = Dice::new(32);
    for subject in subjects() {
        let most = subject.map.stretch(&subject.space);
        for _ in 0..60 {
            let (point, d) = (subject.point(&mut dice), direction(&mut dice));
            let stretched = (subject.map.apply(point).jacobian * d).length();
            assert!(stretched <= most * (1.0 + 1e-6), "{} at {point}: {stretched} {most}", subject.name);
            let reach = 0.05;
            let other = point + direction(&mut dice) * reach;
            let Some(bound) = subject.map.third_bound(point, reach) else { continue };
            let same_side = {
                let between = Bounds::of_points([point, other]);
                subject.map.kinks(&between).iter().all(|(normal, offset)| {
                    (point.dot(*normal) - offset) * (other.dot(*normal) - offset) > 0.0
                })
            };
            if same_side {
                let change =
                    subject.map.second(other, point, (d, d)) - subject.map.second(point, point, (d, d));
                assert!(
                    change.length() <= bound * reach * (1.0 + 1e-9) + 1e-12,
                    "{} at {point}: {} {bound}",
                    subject.name,
                    change.length() / reach
                );
            }
        }
    }
}

#[test]
fn images_lead_back_to_their_origins() {
    let mut dice = Dice::new(33);
    for subject in subjects() {
        for _ in 0..40 {
            let point = subject.point(&mut dice);
            let image = subject.map.apply(point).point;
            let origins = subject.map.origins(image);
            let nearest = origins.iter().map(|origin| origin.distance(point)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6, "{} at {point}: {nearest} of {origins:?}", subject.name);
        }
    }
}
