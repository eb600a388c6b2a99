use glam::{DVec3, DVec4};

use super::{Moving, Reduced, Wanted, reduce};
use crate::geometry::number::Bounds;
use crate::geometry::number::sin_degrees;
use crate::motion::rotation::about;
use crate::motion::{MorphedBox, MorphedState, Rig};
use crate::motion::{Path, Transform};

fn arm() -> Rig {
    let bone = Transform { translation: DVec3::Y, ..Transform::IDENTITY };
    Rig {
        parents: vec![None, Some(0)],
        rest: vec![Transform::IDENTITY, bone],
        points: vec![vec![], vec![DVec3::Y]],
        weights: vec![vec![], vec![]],
        morphed: Vec::new(),
    }
}

fn reduced(tolerance: f64, exact: impl Fn(f64) -> DVec4 + Sync, path: Path) -> Reduced {
    let moving = [Moving { node: 0, path, target: 0, exact: Box::new(exact), steps: None, corners: None }];
    let wanted = Wanted { duration: 2.0, tolerance, rate: 60.0, stops: vec![1.0], most: 10_000 };
    reduce(&arm(), &moving, &wanted)
}

#[test]
fn a_tighter_tolerance_takes_more_keys_and_is_kept() {
    let mut before = 0;
    for tolerance in [0.1, 0.01, 1e-3, 1e-4] {
        let swing = |time: f64| DVec4::from(about(DVec3::Z, 60.0 * sin_degrees(180.0 * time)));
        let found = reduced(tolerance, swing, Path::Rotation);
        let keys = found.tracks[0].times.len();
        assert!(found.bound <= tolerance, "{} at {tolerance}", found.bound);
        assert!(found.bound > tolerance / 20.0, "{} at {tolerance}: more keys than needed", found.bound);
        assert!(keys > before, "{keys} at {tolerance}");
        before = keys;
    }
}

#[test]
fn straight_ways_keep_their_ends_and_corners_alone() {
    let found = reduced(1e-4, |time| DVec4::new(time.min(1.0), 0.0, 0.0, 0.0), Path::Translation);
    assert_eq!(found.tracks[0].times, [0.0, 1.0, 2.0]);
    assert!(found.bound < 1e-6);
}

#[test]
fn what_stays_at_rest_is_left_out_but_the_clip_keeps_its_length() {
    let still = |_| DVec4::from(about(DVec3::X, 0.0));
    let moving = [
        Moving {
            node: 0,
            path: Path::Rotation,
            target: 0,
            exact: Box::new(still),
            steps: None,
            corners: None,
        },
        Moving {
            node: 1,
            path: Path::Translation,
            target: 0,
            exact: Box::new(|time| DVec4::new(0.0, 1.0 + time, 0.0, 0.0)),
            steps: None,
            corners: None,
        },
    ];
    let wanted = Wanted { duration: 2.0, tolerance: 1e-3, rate: 60.0, stops: vec![], most: 10_000 };
    let found = reduce(&arm(), &moving, &wanted);
    assert_eq!(found.tracks.len(), 1);
    assert_eq!((found.tracks[0].track, found.tracks[0].times.last()), (1, Some(&2.0)));
}

#[test]
fn steps_stay_steps() {
    let jump = |time: f64| DVec4::new(if time < 0.75 { 0.0 } else { 1.0 }, 0.0, 0.0, 0.0);
    let moving = [Moving {
        node: 1,
        path: Path::Translation,
        target: 0,
        exact: Box::new(jump),
        steps: Some(vec![0.0, 0.5, 0.75]),
        corners: None,
    }];
    let wanted = Wanted { duration: 2.0, tolerance: 1e-3, rate: 60.0, stops: vec![], most: 10_000 };
    let found = reduce(&arm(), &moving, &wanted);
    assert!(found.tracks[0].stepped && found.bound == 0.0);
    // The key at 0.5 changes nothing; the last one lets the clip last.
    assert_eq!(found.tracks[0].times, [0.0, 0.75, 2.0]);
}

/// Something that carries no point may be as coarse as it likes, but has two keys.
#[test]
fn rounding_to_single_precision_is_part_of_the_bound() {
    let far = |time: f64| DVec4::new(1e6 + time / 3.0, 0.0, 0.0, 0.0);
    let found = reduced(0.5, far, Path::Translation);
    assert!(found.bound > 1e-3 && found.bound <= 0.5, "{}", found.bound);
}

/// A unit box whose far side is drawn out by one target and whose top is raised by the other.
fn swelling() -> Rig {
    let unit = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
    let state = |max: DVec3| {
        let ways = Bounds { min: DVec3::ZERO, max: max - DVec3::ONE };
        MorphedState { bounds: Bounds { max, ..unit }, ways, furthest: 1.0 }
    };
    let states = vec![state(DVec3::new(2.0, 1.0, 1.0)), state(DVec3::new(1.0, 2.0, 1.0))];
    Rig {
        parents: vec![None],
        rest: vec![Transform::IDENTITY],
        points: vec![vec![]],
        weights: vec![vec![0.0, 0.25]],
        morphed: vec![MorphedBox { node: 0, weights: 0, base: unit, states }],
    }
}

/// The error of a weight is told in metres, and the box over the motion holds what the weights make of it.
#[test]
fn weights_are_held_to_the_distance_that_they_move_points() {
    let wave = |time: f64| DVec4::X * sin_degrees(90.0 * time);
    let mut before = 0;
    for tolerance in [0.1, 0.01, 1e-3] {
        let moving = [Moving {
            node: 0,
            path: Path::Weight,
            target: 0,
            exact: Box::new(wave),
            steps: None,
            corners: None,
        }];
        let wanted = Wanted { duration: 2.0, tolerance, rate: 60.0, stops: vec![1.0], most: 10_000 };
        let found = reduce(&swelling(), &moving, &wanted);
        let keys = &found.tracks[0];
        assert!(found.bound <= tolerance && keys.times.len() > before, "{} at {tolerance}", found.bound);
        before = keys.times.len();
        // Straight lines between keys of a sine, by their definition.
        let off = (0..=400).map(|k| {
            let time = f64::from(k) / 200.0;
            let next = keys.times.partition_point(|key| *key <= time).clamp(1, keys.times.len() - 1);
            let share = (time - keys.times[next - 1]) / (keys.times[next] - keys.times[next - 1]);
            let played = keys.values[next - 1].lerp(keys.values[next], share);
            (played - wave(time)).x.abs()
        });
        let off = off.fold(0.0, f64::max);
        assert!(off <= found.bound * (1.0 + 1e-9) && off > found.bound / 2.0, "{off} of {}", found.bound);
        let (min, max) = found.reach.expect("a box");
        assert!(min.distance(DVec3::ZERO) < 1e-6 && max.distance(DVec3::new(2.0, 1.25, 1.0)) < 1e-6, "{max}");
    }
}

/// Where one state takes the place of another all points stay in the hull of the two boxes.
#[test]
fn a_box_of_states_that_take_turns_is_no_larger_than_both() {
    let rig = swelling();
    let bounds = rig.morphed[0].at(&[0.5, 0.5]);
    assert_eq!((bounds.min, bounds.max), (DVec3::ZERO, DVec3::new(1.5, 1.5, 1.0)));
    let bounds = rig.morphed[0].at(&[1.0, 0.0]);
    assert_eq!((bounds.min, bounds.max), (DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)));
}
