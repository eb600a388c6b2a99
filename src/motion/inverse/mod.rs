//! Inverse kinematics: the angles of joints that bring points of a skeleton to places.
//!
//! Each turning joint has three angles (swing about x, then z, twist about y) and each sliding one its lengths; those
//! with no room are left out. The sum of squared errors is made least within the ranges by a damped least-squares
//! method (Levenberg, Marquardt) whose steps leave out what stands at its limit and would be pushed beyond, and are
//! projected into the ranges. Steps are the shortest that do, so poses change little from frame to frame; stiff joints
//! take less of them.
//!
//! Promise: no angle and no slide is ever outside of its range; the distance that remains is told. Not promised: the
//! least distance over all poses. From a pose that stands still though it is not there (a straight chain whose target
//! is on its line) it begins again from poses near by, and where it may, far away; these are the same on every machine.
//!
//! Sources: D. Marquardt, An algorithm for least-squares estimation of nonlinear parameters, 1963; C. Wampler, Manipulator
//! inverse kinematic solutions based on vector formulations and damped least-squares methods, 1986; C. Kanzow,
//! N. Yamashita, M. Fukushima, Levenberg-Marquardt methods with strong local convergence properties for solving
//! nonlinear equations with convex constraints, 2004 (projected steps).

mod linear;

use glam::{DAffine3, DQuat, DVec3};

use super::limit::Axis;
use super::rotation::{about, from_angles, nearer};
use super::skeleton::Skeleton;
use super::transform::Transform;
use crate::geometry::number::atan2;

/// What a joint shall reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// The joint that is carried there.
    pub joint: usize,
    /// The point of it, in its rest frame.
    pub point: DVec3,
    /// Where that point shall be, metres; none leaves it free.
    pub place: Option<DVec3>,
    /// How the joint's frame shall stand; none leaves it free.
    pub facing: Option<DQuat>,
    /// Toward where the chain shall bend, metres: the first of these joints is its start, the others bend.
    pub pole: Option<(DVec3, Vec<usize>)>,
}

/// Angles in degrees about x, y and z and slides in metres, for each joint of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Angles {
    /// For each joint.
    pub turns: Vec<DVec3>,
    /// For each joint.
    pub slides: Vec<DVec3>,
}

impl Angles {
    /// The pose at rest.
    #[must_use]
    pub fn rest(skeleton: &Skeleton) -> Self {
        let zero = vec![DVec3::ZERO; skeleton.joints.len()];
        Self { turns: zero.clone(), slides: zero }
    }
}

/// A pose that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The pose.
    pub angles: Angles,
    /// For each goal the distance from the point to its place, metres.
    pub distances: Vec<f64>,
    /// For each goal the angle to its facing, degrees.
    pub turns: Vec<f64>,
    /// From how many poses it was looked for.
    pub starts: usize,
}

/// Where else to look when a pose does not reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// Near the start, so that a motion does not jump.
    Near,
    /// Anywhere within the ranges.
    Far,
}

/// One number of a pose that may change.
#[derive(Clone, Copy, Debug)]
struct Freedom {
    joint: usize,
    axis: Axis,
    slides: bool,
    /// Radians or metres.
    least: f64,
    most: f64,
    /// Its share of a step, from the joint's stiffness.
    ease: f64,
}

/// Solves for the angles of some joints of a skeleton.
#[derive(Clone, Debug)]
pub struct InverseKinematics<'a> {
    skeleton: &'a Skeleton,
    freedoms: Vec<Freedom>,
    /// Whether a joint is one of those that turn.
    turning: Vec<bool>,
    /// The length of all bones, metres.
    size: f64,
}

/// Where the skeleton stands and what other motion does to it.
#[derive(Clone, Debug)]
pub struct Stand {
    /// The map that carries the skeleton.
    pub base: DAffine3,
    /// For each joint its place in its parent; those of joints that turn here are not looked at.
    pub local: Vec<Transform>,
}

/// The error that is none, in sizes of the skeleton.
const REACHED: f64 = 1e-7;

/// How much a pole counts beside a place.
const POLE: f64 = 0.3;

/// The starts of a search, and how far from the pose they lie in radians; 0 stands for anywhere.
const NEAR: [f64; 8] = [0.0, 0.02, 0.05, 0.05, 0.1, 0.1, 0.2, 0.2];
/// How many starts anywhere a far search has besides.
const ANYWHERE: usize = 120;

impl<'a> InverseKinematics<'a> {
    /// For the joints `turning`.
    #[must_use]
    pub fn new(skeleton: &'a Skeleton, turning: &[usize]) -> Self {
        let mut freedoms = Vec::new();
        for joint in turning {
            let bone = &skeleton.joints[*joint].bone;
            for axis in Axis::ALL {
                let range = bone.limits.ranges[axis as usize];
                let (least, most) = range.map_or((f64::NEG_INFINITY, f64::INFINITY), |range| {
                    (range.least.to_radians(), range.most.to_radians())
                });
                let one =
                    Freedom { joint: *joint, axis, slides: false, least, most, ease: 1.0 - bone.stiffness };
                freedoms.push(one);
                if let Some(range) = bone.slide[axis as usize] {
                    freedoms.push(Freedom { slides: true, least: range.least, most: range.most, ..one });
                }
            }
        }
        freedoms.retain(|freedom| freedom.least < freedom.most);
        let size = skeleton.joints.iter().map(super::skeleton::Joint::length).sum::<f64>().max(1e-12);
        let mut turns = vec![false; skeleton.joints.len()];
        turning.iter().for_each(|joint| turns[*joint] = true);
        Self { skeleton, freedoms, turning: turns, size }
    }

    /// The pose nearest to `start`, in steps that are each the shortest, that reaches the goals as nearly as could be found.
    ///
    /// A pole need not be met: where the goals and limits leave no room for it, the pose that is found from a near start
    /// holds as soon as its bend is on the pole's side. So frames of a motion take one start each.
    ///
    /// Cost: a few dozen steps, each O(joints * goals); as many times more as starts are needed.
    #[must_use]
    pub fn solve(&self, stand: &Stand, goals: &[Goal], start: &Angles, search: Search) -> Reached {
        let start = self.held(start);
        let mut dice = Dice(0x9E37_79B9_7F4A_7C15);
        let mut best: Option<(f64, Angles)> = None;
        let far = if search == Search::Far { ANYWHERE } else { 0 };
        let spreads = NEAR.iter().copied().chain(std::iter::repeat_n(f64::INFINITY, far));
        let mut starts = 0;
        for spread in spreads {
            starts += 1;
            let from = self.stray(&start, spread, &mut dice);
            let mut angles = from;
            if goals.iter().any(|goal| goal.pole.is_some()) {
                self.descend(stand, goals, &mut angles, true);
            }
            let rest = self.descend(stand, goals, &mut angles, false);
            let bent = self.off_poles(stand, goals, &angles);
            let settled = search == Search::Near && rest <= REACHED && self.on_poles(stand, goals, &angles);
            let score = rest + 0.01 * bent;
            if best.as_ref().is_none_or(|(least, _)| score < 0.999 * least - 1e-12) {
                best = Some((score, angles));
            }
            if settled || best.as_ref().is_some_and(|(least, _)| *least <= REACHED + 0.01 * BENT) {
                break;
            }
        }
        let angles = best.map_or(start, |(_, angles)| angles);
        Reached { starts, ..self.judged(stand, goals, angles) }
    }

    /// The pose with everything in its range; joints that do not turn here at rest.
    fn held(&self, start: &Angles) -> Angles {
        let mut angles = Angles::rest(self.skeleton);
        for (joint, turning) in self.turning.iter().enumerate() {
            if *turning {
                let bone = &self.skeleton.joints[joint].bone;
                angles.turns[joint] = bone.limits.clamped(start.turns[joint]);
            }
        }
        for freedom in self.freedoms.iter().filter(|freedom| freedom.slides) {
            let axis = freedom.axis as usize;
            angles.slides[freedom.joint][axis] =
                start.slides[freedom.joint][axis].clamp(freedom.least, freedom.most);
        }
        // A range that leaves zero out holds a slide that cannot move, too.
        for (joint, one) in self.skeleton.joints.iter().enumerate().filter(|(joint, _)| self.turning[*joint])
        {
            for axis in Axis::ALL {
                if let Some(range) = one.bone.slide[axis as usize] {
                    let slide = &mut angles.slides[joint][axis as usize];
                    *slide = slide.clamp(range.least, range.most);
                }
            }
        }
        angles
    }

    /// A pose some way from another, within the ranges.
    fn stray(&self, from: &Angles, spread: f64, dice: &mut Dice) -> Angles {
        let mut angles = from.clone();
        if spread == 0.0 {
            return angles;
        }
        for freedom in &self.freedoms {
            let (least, most) = if freedom.slides {
                (freedom.least, freedom.most)
            } else {
                (freedom.least.max(-core::f64::consts::PI), freedom.most.min(core::f64::consts::PI))
            };
            let roll = dice.roll();
            let value = if spread.is_infinite() {
                least + (most - least) * roll
            } else {
                let reach = if freedom.slides { spread * self.size } else { spread };
                freedom.get(&angles) + reach * (2.0 * roll - 1.0)
            };
            freedom.set(&mut angles, value.clamp(freedom.least, freedom.most));
        }
        angles
    }

    /// Descends to a pose from which no step leads nearer; the error there, in sizes.
    fn descend(&self, stand: &Stand, goals: &[Goal], angles: &mut Angles, poles: bool) -> f64 {
        const MOST: usize = 200;
        let mut residual = self.residual(stand, goals, angles, poles);
        let mut error = norm(&residual);
        let mut damping = 1e-3;
        for _ in 0..MOST {
            if error <= REACHED {
                break;
            }
            let rows = self.jacobian(stand, goals, angles, poles);
            let mut moved = false;
            while damping < 1e8 {
                let step = self.step(&rows, &residual, angles, damping);
                let mut next = angles.clone();
                for (freedom, step) in self.freedoms.iter().zip(&step) {
                    let value = freedom.get(angles) + step;
                    freedom.set(&mut next, value.clamp(freedom.least, freedom.most));
                }
                let found = self.residual(stand, goals, &next, poles);
                let less = norm(&found);
                if less < error {
                    moved = error - less > 1e-9 * error;
                    (*angles, residual, error) = (next, found, less);
                    damping = (damping * 0.2).max(1e-12);
                    break;
                }
                damping *= 4.0;
            }
            if !moved {
                break;
            }
        }
        error
    }

    /// The damped step that leaves out what stands at its limit and would be pushed beyond.
    fn step(&self, rows: &[Vec<f64>], residual: &[f64], angles: &Angles, damping: f64) -> Vec<f64> {
        /// No angle changes by more in one step, radians.
        const LONGEST: f64 = 0.5;
        let count = self.freedoms.len();
        let mut free = vec![true; count];
        loop {
            let eases: Vec<f64> =
                (0..count).map(|k| if free[k] { self.freedoms[k].ease } else { 0.0 }).collect();
            let mut step = linear::damped(rows, residual, &eases, damping);
            let stuck: Vec<usize> = (0..count)
                .filter(|k| {
                    let (freedom, value) = (&self.freedoms[*k], self.freedoms[*k].get(angles));
                    let below = value <= freedom.least && step[*k] < 0.0;
                    let above = value >= freedom.most && step[*k] > 0.0;
                    free[*k] && (below || above)
                })
                .collect();
            if stuck.is_empty() {
                let longest = step.iter().fold(0.0_f64, |longest, part| longest.max(part.abs()));
                let shorter = (LONGEST / longest.max(1e-300)).min(1.0);
                step.iter_mut().for_each(|part| *part *= shorter);
                return step;
            }
            stuck.into_iter().for_each(|k| free[k] = false);
        }
    }

    /// The maps from the joints to space.
    fn worlds(&self, stand: &Stand, angles: &Angles) -> Vec<DAffine3> {
        let mut worlds: Vec<DAffine3> = Vec::with_capacity(self.skeleton.joints.len());
        for (index, joint) in self.skeleton.joints.iter().enumerate() {
            let local = if self.turning[index] {
                let rest = &joint.rest;
                Transform {
                    translation: rest.translation + rest.rotation * angles.slides[index],
                    rotation: rest.rotation * from_angles(angles.turns[index]),
                    scale: rest.scale,
                }
            } else {
                stand.local[index]
            };
            let outside = joint.bone.parent.map_or(stand.base, |parent| worlds[parent]);
            worlds.push(outside * local.map());
        }
        worlds
    }

    /// All errors in sizes of the skeleton and radians.
    fn residual(&self, stand: &Stand, goals: &[Goal], angles: &Angles, poles: bool) -> Vec<f64> {
        let worlds = self.worlds(stand, angles);
        let mut all = Vec::new();
        for goal in goals {
            let world = &worlds[goal.joint];
            if let Some(place) = goal.place {
                all.extend(((world.transform_point3(goal.point) - place) / self.size).to_array());
            }
            if let Some(facing) = goal.facing {
                all.extend(turn_between(facing, rotation_of(world)).to_array());
            }
            if let Some(pole) = goal.pole.as_ref().filter(|_| poles) {
                all.extend((pole_error(goal, pole, &worlds) * (POLE / self.size)).to_array());
            }
        }
        all
    }

    /// The derivatives of the residual by the freedoms, one row for each error.
    fn jacobian(&self, stand: &Stand, goals: &[Goal], angles: &Angles, poles: bool) -> Vec<Vec<f64>> {
        let count = self.freedoms.len();
        let worlds = self.worlds(stand, angles);
        let axes: Vec<(DVec3, DVec3)> =
            self.freedoms.iter().map(|one| self.axis(one, stand, angles, &worlds)).collect();
        let above = |joint: usize| self.chain(joint);
        let mut rows = Vec::new();
        for goal in goals {
            let carried = above(goal.joint);
            let point = worlds[goal.joint].transform_point3(goal.point);
            let columns = |of: &dyn Fn(&Freedom, DVec3, DVec3) -> DVec3| -> Vec<DVec3> {
                let column = |k: usize| {
                    let (freedom, (axis, origin)) = (&self.freedoms[k], axes[k]);
                    if carried[freedom.joint] { of(freedom, axis, origin) } else { DVec3::ZERO }
                };
                (0..count).map(column).collect()
            };
            if goal.place.is_some() {
                let moved = columns(&|freedom, axis, origin| {
                    if freedom.slides { axis / self.size } else { axis.cross(point - origin) / self.size }
                });
                push_rows(&mut rows, &moved);
            }
            if goal.facing.is_some() {
                let turned = columns(&|freedom, axis, _| {
                    if freedom.slides { DVec3::ZERO } else { axis.normalize_or_zero() }
                });
                push_rows(&mut rows, &turned);
            }
            if let Some(pole) = goal.pole.as_ref().filter(|_| poles) {
                let by_difference = |k: usize| {
                    const STEP: f64 = 1e-6;
                    let at = |side: f64| {
                        let mut near = angles.clone();
                        let freedom = &self.freedoms[k];
                        freedom.set(&mut near, freedom.get(angles) + side * STEP);
                        pole_error(goal, pole, &self.worlds(stand, &near)) * (POLE / self.size)
                    };
                    (at(1.0) - at(-1.0)) / (2.0 * STEP)
                };
                push_rows(&mut rows, &(0..count).map(by_difference).collect::<Vec<_>>());
            }
        }
        rows
    }

    /// The axis in space about or along which a freedom moves, and a point of it.
    fn axis(&self, freedom: &Freedom, stand: &Stand, angles: &Angles, worlds: &[DAffine3]) -> (DVec3, DVec3) {
        let joint = &self.skeleton.joints[freedom.joint];
        let outside = joint.bone.parent.map_or(stand.base, |parent| worlds[parent]);
        let frame = outside.matrix3 * glam::DMat3::from_quat(joint.rest.rotation);
        let turns = angles.turns[freedom.joint];
        let own = if freedom.slides {
            freedom.axis.direction()
        } else {
            // The swing about x comes outermost, then the one about z, then the twist.
            let x = about(DVec3::X, turns.x);
            match freedom.axis {
                Axis::X => DVec3::X,
                Axis::Z => x * DVec3::Z,
                Axis::Y => x * about(DVec3::Z, turns.z) * DVec3::Y,
            }
        };
        let axis = frame * own;
        (if freedom.slides { axis } else { axis.normalize_or_zero() }, worlds[freedom.joint].translation)
    }

    /// Whether each joint carries another: is it, or one of its ancestors.
    fn chain(&self, joint: usize) -> Vec<bool> {
        let mut chain = vec![false; self.skeleton.joints.len()];
        let mut next = Some(joint);
        while let Some(joint) = next {
            chain[joint] = true;
            next = self.skeleton.joints[joint].bone.parent;
        }
        chain
    }

    fn off_poles(&self, stand: &Stand, goals: &[Goal], angles: &Angles) -> f64 {
        let worlds = self.worlds(stand, angles);
        let off =
            |goal: &Goal| goal.pole.as_ref().map_or(0.0, |pole| pole_error(goal, pole, &worlds).length());
        goals.iter().map(off).sum::<f64>() / self.size
    }

    /// Whether all chains bend to the side of their poles, or are straight.
    fn on_poles(&self, stand: &Stand, goals: &[Goal], angles: &Angles) -> bool {
        let worlds = self.worlds(stand, angles);
        goals.iter().all(|goal| {
            let Some(pole) = &goal.pole else { return true };
            let (bend, toward) = pole_bend(goal, pole, &worlds);
            bend.dot(toward) >= 0.0
        })
    }

    fn judged(&self, stand: &Stand, goals: &[Goal], angles: Angles) -> Reached {
        let worlds = self.worlds(stand, &angles);
        let distance = |goal: &Goal| {
            let found = worlds[goal.joint].transform_point3(goal.point);
            goal.place.map_or(0.0, |place| found.distance(place))
        };
        let turn = |goal: &Goal| {
            let found = rotation_of(&worlds[goal.joint]);
            goal.facing.map_or(0.0, |facing| turn_between(facing, found).length().to_degrees())
        };
        let (distances, turns) = (goals.iter().map(distance).collect(), goals.iter().map(turn).collect());
        Reached { angles, distances, turns, starts: 0 }
    }
}

/// A bend that is off its pole by so much of the size is on it.
const BENT: f64 = 1e-3;

impl Freedom {
    /// Radians or metres.
    fn get(&self, angles: &Angles) -> f64 {
        let axis = self.axis as usize;
        if self.slides {
            angles.slides[self.joint][axis]
        } else {
            angles.turns[self.joint][axis].to_radians()
        }
    }

    fn set(&self, angles: &mut Angles, value: f64) {
        let axis = self.axis as usize;
        if self.slides {
            angles.slides[self.joint][axis] = value;
        } else {
            angles.turns[self.joint][axis] = value.to_degrees();
        }
    }
}

/// How far the bend of a chain is from where its pole asks for it, metres.
fn pole_error(goal: &Goal, pole: &(DVec3, Vec<usize>), worlds: &[DAffine3]) -> DVec3 {
    let (bend, toward) = pole_bend(goal, pole, worlds);
    bend - toward * bend.length()
}

/// The bend of a chain, metres, and the direction to its pole, both square to the line from its start to its end.
fn pole_bend(goal: &Goal, (pole, joints): &(DVec3, Vec<usize>), worlds: &[DAffine3]) -> (DVec3, DVec3) {
    let Some((first, bending)) = joints.split_first() else { return (DVec3::ZERO, DVec3::ZERO) };
    let start = worlds[*first].translation;
    let axis = (worlds[goal.joint].transform_point3(goal.point) - start).normalize_or_zero();
    let aside = |point: DVec3| (point - start) - axis * axis.dot(point - start);
    let bend = bending.iter().map(|joint| aside(worlds[*joint].translation)).sum::<DVec3>()
        / bending.len().max(1) as f64;
    (bend, aside(*pole).normalize_or_zero())
}

fn rotation_of(map: &DAffine3) -> DQuat {
    let (_, rotation, _) = map.to_scale_rotation_translation();
    rotation.normalize()
}

/// The turn from one rotation to another as an axis times radians, the shorter way.
fn turn_between(from: DQuat, to: DQuat) -> DVec3 {
    let turn = nearer(to * from.conjugate(), DQuat::IDENTITY);
    let axis = DVec3::new(turn.x, turn.y, turn.z);
    let sine = axis.length();
    if sine < 1e-300 { DVec3::ZERO } else { axis * (2.0 * atan2(sine, turn.w) / sine) }
}

fn push_rows(rows: &mut Vec<Vec<f64>>, columns: &[DVec3]) {
    for axis in 0..3 {
        rows.push(columns.iter().map(|column| column[axis]).collect());
    }
}

fn norm(numbers: &[f64]) -> f64 {
    numbers.iter().map(|number| number * number).sum::<f64>().sqrt()
}

/// Numbers from 0 to 1 in a fixed order (Knuth's linear congruences, the upper bits).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests;
