use glam::{DAffine3, DVec3};

use super::{Angles, Goal, InverseKinematics, Reached, Search, Stand};
use crate::geometry::number::{acos, atan2};
use crate::motion::limit::{Limits, Range};
use crate::motion::skeleton::{Bone, Skeleton};

/// Numbers from 0 to 1, seeded.
struct Seeded(u64);

impl Seeded {
    fn roll(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.roll()
    }
}

fn chain(lengths: &[f64], along: DVec3, limits: &[Limits]) -> Skeleton {
    let mut head = DVec3::ZERO;
    let mut bones = Vec::new();
    for (index, length) in lengths.iter().enumerate() {
        let tail = head + along * *length;
        bones.push(Bone {
            name: format!("j{index}"),
            parent: index.checked_sub(1),
            head,
            tail,
            roll: 0.0,
            limits: limits[index],
            slide: [None; 3],
            stiffness: 0.0,
        });
        head = tail;
    }
    Skeleton::new(bones).expect("a chain")
}

fn stand(skeleton: &Skeleton) -> Stand {
    Stand { base: DAffine3::IDENTITY, local: skeleton.joints.iter().map(|joint| joint.rest).collect() }
}

fn tip(skeleton: &Skeleton, place: DVec3) -> Goal {
    let joint = skeleton.joints.len() - 1;
    let point = DVec3::Y * skeleton.joints[joint].length();
    Goal { joint, point, place: Some(place), facing: None, pole: None }
}

fn turns(least: f64, most: f64) -> Option<Range> {
    Some(Range { least, most })
}

fn reach(skeleton: &Skeleton, goals: &[Goal], start: &Angles, search: Search) -> Reached {
    let all: Vec<usize> = (0..skeleton.joints.len()).collect();
    let found = InverseKinematics::new(skeleton, &all).solve(&stand(skeleton), goals, start, search);
    for (joint, turn) in skeleton.joints.iter().zip(&found.angles.turns) {
        for axis in 0..3 {
            if let Some(range) = joint.bone.limits.ranges[axis] {
                assert!(range.excess(turn[axis]) < 1e-9, "{} {axis}: {turn}", joint.bone.name);
            }
        }
    }
    found
}

/// Where the tip is, by the kinematics of the solver itself; the places of published poses hold that.
fn tip_of(skeleton: &Skeleton, angles: &Angles) -> DVec3 {
    let all: Vec<usize> = (0..skeleton.joints.len()).collect();
    let worlds = InverseKinematics::new(skeleton, &all).worlds(&stand(skeleton), angles);
    let last = skeleton.joints.len() - 1;
    worlds[last].transform_point3(DVec3::Y * skeleton.joints[last].length())
}

/// Chains of 2 to 20 joints with limits of their own and targets that some pose within the limits has: each is reached
/// within 0.1 mm of a chain of 1 m.
#[test]
fn a_thousand_reachable_targets_are_reached() {
    let mut dice = Seeded(0x1234_5678_9ABC_DEF1);
    let mut missed = Vec::new();
    for case in 0..1000_usize {
        let count = 2 + case % 19;
        let lengths: Vec<f64> = (0..count).map(|_| dice.between(0.5, 1.5)).collect();
        let whole: f64 = lengths.iter().sum();
        let lengths: Vec<f64> = lengths.iter().map(|length| length / whole).collect();
        let limits: Vec<Limits> = (0..count)
            .map(|_| {
                let mut range = |most: f64| turns(-dice.between(0.0, most), dice.between(0.0, most));
                match case % 3 {
                    // Hinges, universal joints, and balls.
                    0 => Limits { ranges: [range(120.0), turns(0.0, 0.0), turns(0.0, 0.0)] },
                    1 => Limits { ranges: [range(90.0), turns(0.0, 0.0), range(60.0)] },
                    _ => Limits { ranges: [range(90.0), range(45.0), range(60.0)] },
                }
            })
            .collect();
        let skeleton = chain(&lengths, DVec3::Y, &limits);
        let mut pose = Angles::rest(&skeleton);
        for (joint, limits) in limits.iter().enumerate() {
            for axis in 0..3 {
                let range = limits.ranges[axis].expect("each has one");
                pose.turns[joint][axis] = dice.between(range.least, range.most);
            }
        }
        let target = tip_of(&skeleton, &pose);
        let found = reach(&skeleton, &[tip(&skeleton, target)], &Angles::rest(&skeleton), Search::Far);
        if found.distances[0] > 1e-4 {
            missed.push((case, count, found.distances[0]));
        }
    }
    assert!(missed.is_empty(), "{} missed: {missed:?}", missed.len());
}

/// Two bones in a plane: the angles are those of the law of cosines, on the side where the elbow may bend.
#[test]
fn two_bones_have_the_closed_form() {
    let (a, b) = (2.0, 1.5);
    let hinge =
        |least: f64, most: f64| Limits { ranges: [turns(0.0, 0.0), turns(0.0, 0.0), turns(least, most)] };
    let skeleton = chain(&[a, b], DVec3::X, &[hinge(-180.0, 180.0), hinge(0.0, 170.0)]);
    let mut dice = Seeded(42);
    for _ in 0..200 {
        let (radius, angle) = (dice.between(0.7, 3.45), dice.between(-170.0, 170.0));
        let (sin, cos) = crate::geometry::number::sin_cos_degrees(angle);
        let target = DVec3::new(radius * cos, radius * sin, 0.0);
        let elbow = acos((radius * radius - a * a - b * b) / (2.0 * a * b));
        let (sin, cos) = crate::geometry::number::sin_cos(elbow);
        let shoulder = atan2(target.y, target.x) - atan2(b * sin, a + b * cos);
        let turned = shoulder.to_degrees() - 360.0 * (shoulder.to_degrees() / 360.0).round();
        let found = reach(&skeleton, &[tip(&skeleton, target)], &Angles::rest(&skeleton), Search::Far);
        assert!(found.distances[0] < 1e-6, "{target}: {:?}", found.distances);
        let [upper, lower] = [found.angles.turns[0].z, found.angles.turns[1].z];
        assert!((lower - elbow.to_degrees()).abs() < 1e-3, "{target}: {lower}");
        assert!((upper - turned).abs() < 1e-3, "{target}: {upper} instead of {turned}");
    }
    // Too far: straight toward it, and the distance that remains.
    let found =
        reach(&skeleton, &[tip(&skeleton, DVec3::new(3.0, 4.0, 0.0))], &Angles::rest(&skeleton), Search::Far);
    assert!((found.distances[0] - 1.5).abs() < 1e-6, "{:?}", found.distances);
}

/// Published targets: some cannot be reached within the limits, and the least distances are known.
#[test]
fn published_limits_come_to_the_published_distances() {
    let hinge =
        |least: f64, most: f64| Limits { ranges: [turns(0.0, 0.0), turns(0.0, 0.0), turns(least, most)] };
    let elbow = chain(&[2.0, 1.5], DVec3::X, &[hinge(-90.0, 90.0), hinge(0.0, 150.0)]);
    let snake = chain(&[1.0; 4], DVec3::X, &[hinge(-45.0, 45.0); 4]);
    let cases = [
        (&elbow, [2.0, 1.8], 0.0),
        (&elbow, [2.0, -1.8], 0.0),
        (&elbow, [-2.0, 1.0], 0.736_068),
        (&elbow, [3.5, 0.0], 0.0),
        (&elbow, [0.3, 0.2], 0.666_016),
        (&snake, [2.0, 2.0], 0.0),
        (&snake, [-1.0, 2.0], 0.414_214),
        (&snake, [0.0, 0.0], 2.613_126),
        (&snake, [3.0, 1.0], 0.0),
    ];
    for (skeleton, [x, y], least) in cases {
        let found =
            reach(skeleton, &[tip(skeleton, DVec3::new(x, y, 0.0))], &Angles::rest(skeleton), Search::Far);
        assert!((found.distances[0] - least).abs() < 1e-4, "[{x}, {y}]: {} not {least}", found.distances[0]);
    }
}

/// The chains that FABRIK and CCD were published with: straight ones whose target is on or off their line.
#[test]
fn straight_chains_leave_their_line() {
    let free = [Limits::default(); 3];
    let skeleton = chain(&[1.0; 3], DVec3::X, &free);
    for target in [DVec3::new(1.5, 1.5, 0.0), DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.4, 0.7, 1.0)] {
        let found = reach(&skeleton, &[tip(&skeleton, target)], &Angles::rest(&skeleton), Search::Near);
        assert!(found.distances[0] < 1e-6, "{target}: {:?}", found.distances);
    }
    let two = chain(&[1.0; 2], DVec3::X, &free);
    let found = reach(&two, &[tip(&two, DVec3::new(0.0, 5.0, 0.0))], &Angles::rest(&two), Search::Near);
    assert!((found.distances[0] - 3.0).abs() < 1e-6, "{:?}", found.distances);
}

#[test]
fn elbows_bend_toward_their_poles_and_hands_face_as_asked() {
    let skeleton = chain(&[1.0, 1.0, 0.3], DVec3::Y, &[Limits::default(); 3]);
    let facing = crate::motion::about(DVec3::X, 40.0) * skeleton.joints[2].frame;
    for pole in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z].map(|way| way * 5.0) {
        let goal = Goal {
            joint: 2,
            point: DVec3::ZERO,
            place: Some(DVec3::Y * 1.2),
            facing: Some(facing),
            pole: Some((pole, vec![0, 1])),
        };
        let found = reach(&skeleton, &[goal], &Angles::rest(&skeleton), Search::Far);
        assert!(found.distances[0] < 1e-6 && found.turns[0] < 1e-3, "{found:?}");
        let all = [0, 1, 2];
        let worlds = InverseKinematics::new(&skeleton, &all).worlds(&stand(&skeleton), &found.angles);
        let elbow = worlds[1].translation;
        // The elbow of two bones of 1 over 1.2 stands 0.8 aside.
        assert!(elbow.distance(DVec3::Y * 0.6 + pole.normalize() * 0.8) < 0.02, "{pole}: {elbow}");
    }
}

/// An arm that is told how its hand stands, with limits that leave its elbow no way to the pole: after the first frame
/// one start is enough, and the elbow stays on the side of the pole.
#[test]
fn poles_that_cannot_be_met_cost_no_search_in_every_frame() {
    let hinge = Limits { ranges: [turns(-150.0, 150.0), turns(0.0, 0.0), turns(0.0, 0.0)] };
    // The shoulder turns little about the bone, so that the elbow stays near the y-z plane.
    let shoulder = Limits { ranges: [turns(-120.0, 120.0), turns(-5.0, 5.0), turns(-60.0, 60.0)] };
    let wrist = Limits { ranges: [turns(-120.0, 120.0), turns(-90.0, 90.0), turns(-60.0, 60.0)] };
    let skeleton = chain(&[1.0, 1.0, 0.3], DVec3::Y, &[shoulder, hinge, wrist]);
    let mut pose = Angles::rest(&skeleton);
    let (mut later, mut off) = (0, 0.0_f64);
    for frame in 0..60 {
        let turn = 3.0 * f64::from(frame);
        let (sine, cosine) = crate::geometry::number::sin_cos_degrees(turn);
        let goal = Goal {
            joint: 2,
            point: DVec3::Y * 0.3,
            place: Some(DVec3::new(0.15 * sine, 1.5, 0.2 * cosine)),
            facing: Some(crate::motion::about(DVec3::X, 20.0 * cosine) * skeleton.joints[2].frame),
            pole: Some((DVec3::new(5.0, 1.0, 3.0), vec![0, 1, 2])),
        };
        let search = if frame == 0 { Search::Far } else { Search::Near };
        let found = reach(&skeleton, std::slice::from_ref(&goal), &pose, search);
        assert!(found.distances[0] < 1e-6 && found.turns[0] < 1e-3, "{frame}: {found:?}");
        let all = [0, 1, 2];
        let solver = InverseKinematics::new(&skeleton, &all);
        off = off.max(solver.off_poles(&stand(&skeleton), std::slice::from_ref(&goal), &found.angles));
        assert!(solver.on_poles(&stand(&skeleton), &[goal], &found.angles), "{frame}");
        later += if frame == 0 { 0 } else { found.starts };
        pose = found.angles;
    }
    assert!(off > 10.0 * super::BENT, "the pole is never met: {off}");
    assert_eq!(later, 59);
}

/// Two hands of one body, both held.
#[test]
fn several_goals_are_met_at_once() {
    let bone = |name: &str, parent: Option<usize>, head: DVec3, tail: DVec3| Bone {
        name: name.to_owned(),
        parent,
        head,
        tail,
        roll: 0.0,
        limits: Limits::default(),
        slide: [None; 3],
        stiffness: 0.0,
    };
    let (neck, left, right) = (DVec3::Y, DVec3::new(-1.0, 1.0, 0.0), DVec3::new(1.0, 1.0, 0.0));
    let skeleton = Skeleton::new(vec![
        bone("spine", None, DVec3::ZERO, neck),
        bone("left", Some(0), neck, left),
        bone("left-hand", Some(1), left, left - DVec3::X * 0.5),
        bone("right", Some(0), neck, right),
        bone("right-hand", Some(3), right, right + DVec3::X * 0.5),
    ])
    .expect("a body");
    let hand = |name: &str, place: DVec3| Goal {
        joint: skeleton.find(name).expect("a hand"),
        point: DVec3::Y * 0.5,
        place: Some(place),
        facing: None,
        pole: None,
    };
    let goals =
        [hand("left-hand", DVec3::new(-0.8, 0.9, 0.8)), hand("right-hand", DVec3::new(0.9, 1.6, 0.5))];
    let found = reach(&skeleton, &goals, &Angles::rest(&skeleton), Search::Far);
    assert!(found.distances.iter().all(|distance| *distance < 1e-6), "{:?}", found.distances);
}

/// A target that moves little moves the pose little, all the way round.
#[test]
fn poses_do_not_jump_from_frame_to_frame() {
    let limits = Limits { ranges: [turns(-100.0, 100.0), turns(-90.0, 90.0), turns(-100.0, 100.0)] };
    let skeleton = chain(&[0.3, 0.3, 0.2, 0.2], DVec3::Y, &[limits; 4]);
    let mut pose = Angles::rest(&skeleton);
    let mut before: Option<Angles> = None;
    for frame in 0..240 {
        let (sin, cos) = crate::geometry::number::sin_cos_degrees(1.5 * f64::from(frame));
        let target = DVec3::new(0.4 * cos, 0.5 + 0.1 * sin, 0.4 * sin);
        let search = if before.is_none() { Search::Far } else { Search::Near };
        let found = reach(&skeleton, &[tip(&skeleton, target)], &pose, search);
        assert!(found.distances[0] < 1e-6, "{frame}: {:?}", found.distances);
        if let Some(before) = before {
            let jump = |(a, b): (&DVec3, &DVec3)| (*a - *b).abs().max_element();
            let most = before.turns.iter().zip(&found.angles.turns).map(jump).fold(0.0, f64::max);
            assert!(most < 12.0, "{frame}: {most} degrees");
        }
        pose = found.angles.clone();
        before = Some(found.angles);
    }
}

/// A trolley that slides and a boom that turns share the way.
#[test]
fn slides_take_part() {
    let mut skeleton = chain(&[1.0, 0.5], DVec3::Y, &[Limits::default(); 2]);
    skeleton.joints[0].bone.slide[0] = turns(-2.0, 2.0);
    skeleton.joints[0].bone.limits = Limits { ranges: [turns(0.0, 0.0); 3] };
    let target = DVec3::new(1.5, 0.8, 0.2);
    let found = reach(&skeleton, &[tip(&skeleton, target)], &Angles::rest(&skeleton), Search::Far);
    assert!(found.distances[0] < 1e-6, "{:?}", found.distances);
    assert!((-2.0..=2.0).contains(&found.angles.slides[0].x));
    let far =
        reach(&skeleton, &[tip(&skeleton, DVec3::new(9.0, 1.0, 0.0))], &Angles::rest(&skeleton), Search::Far);
    assert!((far.distances[0] - 6.5).abs() < 1e-6, "{:?}", far.distances);
}
