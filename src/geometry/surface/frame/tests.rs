//! Frames of every rule.

use glam::DVec3;

use super::{Carry, FrameField, FrameRule};
use crate::geometry::curve::{
    AnyCurve, Curve, EllipseArc, Helix, Parametrization, Path, Polyline, Side, interpolate,
    interpolate_closed, parameters,
};
use crate::geometry::number::{atan2, cos, sin};

#[test]
fn a_straight_path_along_z_has_the_plane_of_the_profile() {
    let line = AnyCurve::Polyline(Polyline::new(vec![DVec3::ZERO, DVec3::Z], false).unwrap());
    let frame = FrameField::new(&line, &Carry::PLAIN, 0.1).at(0.5, Side::After);
    assert_eq!((frame.side, frame.up, frame.along), (DVec3::X, DVec3::Y, DVec3::Z));
}

#[test]
fn on_a_helix_the_frame_turns_back_against_the_torsion() {
    // Against the Frenet frame a rotation-minimizing frame turns by minus the torsion times the length.
    // Steps of whole turns would all look alike.
    for turns in [2.0, 32.0, 64.0] {
        assert_turns_back(turns);
    }
}

fn assert_turns_back(turns: f64) {
    let (radius, pitch) = (1.0, 1.0);
    let helix = Helix { radius, end_radius: radius, pitch, turns };
    let field = FrameField::new(&AnyCurve::Helix(helix.clone()), &Carry::PLAIN, 0.1);
    let rise = pitch / core::f64::consts::TAU;
    let speed = (radius * radius + rise * rise).sqrt();
    let torsion = rise / (speed * speed);
    let angle_to_normal = |t: f64| {
        let frame = field.at(t, Side::After);
        let point = helix.point(t);
        let inward = -DVec3::new(point.x, 0.0, point.z).normalize();
        atan2(frame.up.dot(inward), frame.side.dot(inward))
    };
    let start = angle_to_normal(0.0);
    for k in 1..=64 {
        let t = turns * f64::from(k) / 64.0;
        let expected = start + torsion * speed * core::f64::consts::TAU * t;
        let found = angle_to_normal(t);
        assert!((sin(found) - sin(expected)).abs() < 1e-8, "{t}");
        assert!((cos(found) - cos(expected)).abs() < 1e-8, "{t}");
    }
}

#[test]
fn around_closed_paths_the_frame_comes_back() {
    let bent = (0..7).map(|k| {
        let angle = f64::from(k) * 51.0_f64.to_radians();
        DVec3::new(cos(angle), sin(3.0 * angle), sin(angle))
    });
    let spline = {
        let points: Vec<DVec3> = bent.collect();
        let knots = parameters(&points, true, Parametrization::Chordal).unwrap();
        AnyCurve::Bezier(interpolate_closed(&points, &knots).unwrap())
    };
    let circle = AnyCurve::Ellipse(EllipseArc::full(DVec3::ZERO, 1.0, 1.0));
    for path in [spline, circle] {
        let field = FrameField::new(&path, &Carry::PLAIN, 0.1);
        let domain = path.domain();
        let (start, end) = (field.at(domain.start, Side::After), field.at(domain.end, Side::Before));
        assert!(start.side.distance(end.side) < 1e-9);
        assert!(start.up.distance(end.up) < 1e-9);
    }
}

/// A line, an arc, a line in space, another arc that bends in another plane: smooth, with straight parts.
fn bent_wire() -> AnyCurve {
    let first =
        EllipseArc { center: DVec3::new(1.0, 1.0, 0.0), x: DVec3::NEG_Y, y: DVec3::X, from: 0.0, to: 90.0 };
    let corner = DVec3::new(2.0, 1.0, 0.0);
    let far = corner + DVec3::Y * 2.0;
    let side = DVec3::new(0.6, 0.0, 0.8);
    let second = EllipseArc { center: far + side, x: -side, y: DVec3::Y, from: 0.0, to: 60.0 };
    let line = |from: DVec3, to: DVec3| AnyCurve::Polyline(Polyline::new(vec![from, to], false).unwrap());
    AnyCurve::Path(
        Path::new(vec![
            line(DVec3::ZERO, DVec3::X),
            AnyCurve::Ellipse(first),
            line(corner, far),
            AnyCurve::Ellipse(second),
        ])
        .unwrap(),
    )
}

#[test]
fn frenet_frames_look_to_the_center_and_turn_with_the_torsion() {
    let (radius, pitch) = (0.7, 1.3);
    let helix = Helix { radius, end_radius: radius, pitch, turns: 3.0 };
    let field =
        FrameField::new(&AnyCurve::Helix(helix.clone()), &Carry { rule: FrameRule::Frenet, twist: 0.0 }, 0.1);
    let rise = pitch / core::f64::consts::TAU;
    for k in 0..=100 {
        let t = 3.0 * f64::from(k) / 100.0;
        let point = helix.point(t);
        let inward = -DVec3::new(point.x, 0.0, point.z).normalize();
        assert!(field.at(t, Side::Before).side.distance(inward) < 1e-12, "{t}");
        let torsion = rise / (radius * radius + rise * rise);
        assert!((field.turn_rate(t, Side::Before).abs() / torsion - 1.0).abs() < 1e-6, "{t}");
    }
}

#[test]
fn frenet_frames_do_not_jump_at_inflections_or_straight_parts() {
    let wave: Vec<DVec3> = [(0.0, 0.0), (1.0, 1.0), (2.0, -1.0), (3.0, 1.0), (4.0, 0.0)]
        .map(|(x, y)| DVec3::new(x, y, 0.0))
        .to_vec();
    let knots = parameters(&wave, false, Parametrization::Chordal).unwrap();
    let wave = AnyCurve::Bezier(interpolate(&wave, &knots).unwrap());
    for (path, flat) in [(wave, true), (bent_wire(), false)] {
        let field = FrameField::new(&path, &Carry { rule: FrameRule::Frenet, twist: 0.0 }, 0.1);
        let domain = path.domain();
        let mut last = field.at(domain.start, Side::After);
        let mut rolled = 0.0_f64;
        for k in 1..=20_000 {
            let t = domain.at(f64::from(k) / 20_000.0);
            let next = field.at(t, Side::Before);
            assert!(next.side.distance(last.side) < 1e-2, "{t}: {last:?} {next:?}");
            let jet = path.evaluate(t, Side::Before);
            let bend = jet.first.cross(jet.second);
            if bend.length() > 1e-3 * jet.first.length_squared() {
                let lean = next.up.dot(bend.normalize()).abs();
                assert!((lean - 1.0).abs() < 1e-9, "{t}: the side is not along the normal");
            }
            rolled += field.turn_rate(t, Side::Before)
                * (field.share(t) - field.share(domain.at(f64::from(k - 1) / 20_000.0)))
                * field.length();
            last = next;
        }
        let exact = field.turn_between(domain.start, domain.end);
        assert!((rolled - exact).abs() < 1e-2, "{rolled} {exact}");
        assert_eq!(exact.abs() < 1e-9, flat, "{exact}");
    }
}

#[test]
fn upright_frames_stay_upright_and_tell_their_rate() {
    let helix = AnyCurve::Helix(Helix { radius: 1.0, end_radius: 1.0, pitch: 0.8, turns: 2.0 });
    let field = FrameField::new(&helix, &Carry { rule: FrameRule::Up(DVec3::Y), twist: 0.0 }, 0.1);
    let plain = FrameField::new(&helix, &Carry::PLAIN, 0.1);
    for k in 1..200 {
        let (t, step) = (f64::from(k) / 100.0, 1e-5);
        let frame = field.at(t, Side::After);
        assert!(frame.side.y.abs() < 1e-12 && frame.up.y > 0.9, "{frame:?}");
        let roll = |t: f64| {
            let (one, other) = (plain.at(t, Side::After), field.at(t, Side::After));
            atan2(other.side.dot(one.up), other.side.dot(one.side))
        };
        let metres = (field.share(t + step) - field.share(t - step)) * field.length();
        let turned = roll(t + step) - roll(t - step);
        let turned = turned - core::f64::consts::TAU * (turned / core::f64::consts::TAU).round();
        assert!((field.turn_rate(t, Side::After) - turned / metres).abs() < 1e-5, "{t}");
    }
}

/// In the bisecting plane of a corner the sections before and after are one section, whatever the rule.
#[test]
fn frames_meet_in_the_mitre_of_every_corner() {
    let stair = [(0, 0, 0), (2, 0, 0), (2, 1, 2), (4, 1, 3), (4, 0, 5), (1, 0, 5)]
        .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
    for closed in [false, true] {
        let path = AnyCurve::Polyline(Polyline::new(stair.to_vec(), closed).unwrap());
        for rule in [FrameRule::RotationMinimizing, FrameRule::Frenet, FrameRule::Up(DVec3::Y)] {
            for twist in [0.0, 360.0] {
                let field = FrameField::new(&path, &Carry { rule, twist }, 0.1);
                let end = path.domain().end;
                let mut corners: Vec<(f64, f64)> = path.joints().into_iter().map(|t| (t, t)).collect();
                if closed {
                    corners.push((end, 0.0));
                }
                for (before, after) in corners {
                    let (one, other) = (field.at(before, Side::Before), field.at(after, Side::After));
                    let normal = (one.along + other.along).normalize();
                    let mitre =
                        |axis: DVec3, along: DVec3| axis - along * (axis.dot(normal) / along.dot(normal));
                    for (a, b) in [(one.side, other.side), (one.up, other.up)] {
                        let gap = mitre(a, one.along).distance(mitre(b, other.along));
                        assert!(gap < 1e-9, "{rule:?} {twist} at {before}: {gap}");
                    }
                }
            }
        }
    }
}

#[test]
fn shares_of_the_length_lead_back_to_their_parameters() {
    for path in [bent_wire(), AnyCurve::Helix(Helix { radius: 1.0, end_radius: 0.2, pitch: 1.0, turns: 2.0 })]
    {
        let field = FrameField::new(&path, &Carry::PLAIN, 0.1);
        let domain = path.domain();
        assert_eq!((field.share(domain.start), field.share(domain.end)), (0.0, 1.0));
        assert_eq!((field.parameter(0.0), field.parameter(1.0)), (domain.start, domain.end));
        for k in 0..=97 {
            let t = domain.at(f64::from(k) / 97.0);
            assert!((field.parameter(field.share(t)) - t).abs() < 1e-12 * domain.span(), "{t}");
        }
    }
}
