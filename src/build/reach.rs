//! Inverse kinematics of clips, solved frame by frame.
//!
//! Each frame begins with the pose of the frame before, drawn back toward rest by a small share, so that what the
//! targets leave free settles. The poses of a loop come back to where they began: what is open at its seam is spread
//! over all of it.

use glam::{DQuat, DVec3, DVec4};

use super::Builder;
use super::course::Moved;
use super::profile::show;
use super::skeleton::unknown_joint;
use super::stage::Stage;
use crate::geometry::number::{floor_count, floor_large, single};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, ReachRule, Sp};
use crate::model::{ClipTrack, ReachTask, Space, Target};
use crate::motion::{
    Angles, Course, EulerOrder, Goal, Interpolation, InverseKinematics, Keys, Law, Path, Reached, Search,
    Skeleton, Track,
};

/// The share of a pose that is drawn back to rest from frame to frame.
const BACK: f64 = 0.03;
/// How often a loop is gone through until it nearly closes.
const ROUNDS: usize = 3;

/// A task with what it needs at each frame.
struct Task<'s> {
    written: &'s Sp<spec::Reach>,
    joint: usize,
    point: DVec3,
    /// The place, and whether it is in metres already.
    place: Option<Course>,
    facing: Option<Course>,
    pole: Option<(DVec3, Vec<usize>)>,
    /// Joints that turn.
    turning: Vec<usize>,
    tolerance: f64,
}

/// Tracks that were made by solving, with the tasks that they do.
pub(super) type Solved = (Vec<ClipTrack>, Vec<ReachTask>);

/// A clip whose tasks are solved.
pub(super) struct Frames<'t> {
    pub(super) tracks: &'t [ClipTrack],
    pub(super) duration: f64,
    pub(super) rate: f64,
    pub(super) looped: bool,
}

impl Builder<'_> {
    /// The tracks of the joints that turn so that all places of a clip are reached.
    pub(super) fn reaches(&mut self, clip: &spec::Clip, frames: &Frames<'_>) -> Option<Solved> {
        let Some(first) = clip.reach.first() else { return Some((Vec::new(), Vec::new())) };
        let skeleton = self.clip_skeleton(clip, &first.joint)?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let moved = Moved {
            joint: false,
            share: 0.0,
            duration: frames.duration,
            looped: frames.looped,
            color: false,
        };
        let tasks: Vec<Option<Task<'_>>> =
            clip.reach.iter().map(|written| self.task(&bones, written, &moved)).collect();
        let tasks: Vec<Task<'_>> = tasks.into_iter().collect::<Option<_>>()?;
        let mut turning: Vec<usize> = tasks.iter().flat_map(|task| task.turning.iter().copied()).collect();
        turning.sort_unstable();
        turning.dedup();
        self.check_free(&bones, skeleton, &turning, (frames.tracks, first.span))?;
        self.check_work(turning.len(), frames, first.span)?;
        let (times, poses, found) = self.solve(&bones, skeleton, (&tasks, &turning), frames);
        self.check_reached(&bones, &tasks, (&times, &found))?;
        let tracks = turned(&bones, skeleton, (&turning, &times, &poses), self.model.frame.unit);
        let task = |(index, task): (usize, &Task<'_>)| ReachTask {
            skeleton,
            joint: task.joint,
            point: task.point,
            tolerance: task.tolerance,
            frames: (times.iter().zip(&found))
                .filter_map(|(time, goals)| {
                    let ((distance, _), place) = goals[index];
                    Some((*time, place?, distance))
                })
                .collect(),
        };
        Some((tracks, tasks.iter().enumerate().map(task).collect()))
    }

    fn task<'s>(
        &mut self,
        bones: &Skeleton,
        written: &'s Sp<spec::Reach>,
        moved: &Moved,
    ) -> Option<Task<'s>> {
        let joint = self.joint_of(bones, &written.joint)?;
        let from = match &written.from {
            Some(from) => Some(self.joint_of(bones, from)?),
            None => None,
        };
        let turning = chain(bones, joint, from);
        if let (Some(from), Some(name)) = (from, &written.from)
            && !turning.contains(&from)
        {
            let message = format!("joint `{}` does not carry `{}`", name.value, written.joint.value);
            let report = Diagnostic::error(Code::BadTrack, message)
                .at(name.span, "not before it")
                .also(written.joint.span, "what is to be brought");
            self.report(report);
            return None;
        }
        let place = match (&written.target, written.track()) {
            (Some(target), _) => Some(fixed(target.value)),
            (None, track) if track.along.is_some() || !track.keys.is_empty() || track.formula.is_some() => {
                let courses = self.courses(&Sp::new(track, written.span), moved)?;
                Some(courses.into_iter().next()?)
            }
            _ => None,
        };
        let facing = match (&written.rotate, written.rotate_keys.is_empty()) {
            (Some(rotate), _) => Some(Course::Euler { order: EulerOrder::Xyz, law: constant(rotate.value) }),
            (None, false) => {
                let courses = self.courses(&Sp::new(written.turning(), written.span), moved)?;
                Some(courses.into_iter().next()?)
            }
            _ => None,
        };
        let unit = self.model.frame.unit;
        let pole = written.pole.as_ref().map(|pole| {
            let reaching = turning.iter().copied().filter(|one| *one != joint || written.at.is_none());
            (self.model.frame.map().transform_point3(pole.value), reaching.collect())
        });
        let size: f64 = bones.joints.iter().map(crate::motion::Joint::length).sum();
        Some(Task {
            written,
            joint,
            point: written.at.as_ref().map_or(DVec3::Y * bones.joints[joint].length(), |at| at.value * unit),
            place,
            facing,
            pole,
            turning,
            tolerance: written.tolerance.map_or(1e-4 * size, |tolerance| tolerance.value * unit),
        })
    }

    fn joint_of(&mut self, bones: &Skeleton, name: &Sp<String>) -> Option<usize> {
        let found = bones.find(&name.value);
        if found.is_none() {
            let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
            self.report(unknown_joint(name, known, "joint"));
        }
        found
    }

    /// Joints that are turned by solving have no tracks of their own.
    fn check_free(
        &mut self,
        bones: &Skeleton,
        skeleton: usize,
        turning: &[usize],
        (tracks, place): (&[ClipTrack], Span),
    ) -> Option<()> {
        let taken = |track: &ClipTrack| match track.target {
            Target::Joint { skeleton: other, joint } if other == skeleton && turning.contains(&joint) => {
                (track.course.path() != Path::Scale).then_some(joint)
            }
            _ => None,
        };
        let Some(joint) = tracks.iter().find_map(taken) else { return Some(()) };
        let name = &bones.joints[joint].bone.name;
        let message = format!("joint `{name}` has a track and is turned by a reach too");
        let report = Diagnostic::error(Code::BadTrack, message)
            .at(place, "it turns for this")
            .help("write `from` to begin the chain after it, or leave the track out");
        self.report(report);
        None
    }

    /// So many poses of joints are solved that it ends in a minute even where no target is reached.
    fn check_work(&mut self, turning: usize, frames: &Frames<'_>, span: Span) -> Option<()> {
        const MOST: u64 = 100_000;
        let poses = floor_large(frames.duration * frames.rate) * turning as u64;
        if poses <= MOST {
            return Some(());
        }
        let message = format!("this clip solves {poses} poses of joints, and the limit is {MOST}");
        let report = Diagnostic::error(Code::LimitPassed, message).at(span, "too many");
        self.report(report.help("write a lower `rate`, a shorter clip, or `from` for shorter chains"));
        None
    }

    /// Times, the poses then, and for each task the distance, degrees and place.
    fn solve(
        &self,
        bones: &Skeleton,
        skeleton: usize,
        (tasks, turning): (&[Task<'_>], &[usize]),
        frames: &Frames<'_>,
    ) -> (Vec<f64>, Vec<Angles>, Vec<Vec<Told>>) {
        let count = floor_count((frames.duration * frames.rate).ceil()).clamp(8, 1 << 20);
        let time = |k: u32| f64::from(single(frames.duration * f64::from(k) / f64::from(count)));
        let times: Vec<f64> = (0..=count).map(time).collect();
        let solver = InverseKinematics::new(bones, turning);
        let players: Vec<(Option<Track<'_>>, Option<Track<'_>>)> = tasks
            .iter()
            .map(|task| (task.place.as_ref().map(Track::new), task.facing.as_ref().map(Track::new)))
            .collect();
        let stage = Stage::new(self, frames.tracks);
        let goals = |time: f64| -> Vec<Goal> {
            tasks.iter().zip(&players).map(|(task, players)| self.goal(bones, task, players, time)).collect()
        };
        let told = |goals: &[Goal], reached: &Reached| -> Vec<Told> {
            let left = reached.distances.iter().zip(&reached.turns);
            goals.iter().zip(left).map(|(goal, (distance, turn))| ((*distance, *turn), goal.place)).collect()
        };
        let frame = |time: f64, start: &Angles, search: Search| {
            let goals = goals(time);
            let reached = solver.solve(&stage.stand(skeleton, time), &goals, start, search);
            (told(&goals, &reached), reached.angles)
        };
        let mut pose = Angles::rest(bones);
        let (mut poses, mut found): (Vec<Angles>, Vec<Vec<Told>>) = (Vec::new(), Vec::new());
        for round in 0..if frames.looped { ROUNDS } else { 1 } {
            (poses, found) = (Vec::with_capacity(times.len()), Vec::with_capacity(times.len()));
            for (index, time) in times.iter().enumerate() {
                let first = index == 0 && round == 0;
                let (search, start) =
                    if first { (Search::Far, pose) } else { (Search::Near, drawn_back(&pose)) };
                let (told, angles) = frame(*time, &start, search);
                pose = angles;
                found.push(told);
                poses.push(pose.clone());
            }
        }
        if frames.looped {
            // What is still open at the seam is spread over the loop, and each pose brought back to its target.
            let (first, last) = (poses[0].clone(), poses[poses.len() - 1].clone());
            for (index, time) in times.iter().enumerate() {
                let share = index as f64 / (times.len() - 1) as f64;
                let start = closed(&poses[index], (&first, &last), share);
                let (told, angles) = frame(*time, &start, Search::Near);
                (found[index], poses[index]) = (told, angles);
            }
        }
        (times, poses, found)
    }

    fn goal(
        &self,
        bones: &Skeleton,
        task: &Task<'_>,
        (place, facing): &(Option<Track<'_>>, Option<Track<'_>>),
        time: f64,
    ) -> Goal {
        let frame = &self.model.frame;
        let along = matches!(task.place, Some(Course::Along { .. }));
        let place = place.as_ref().map(|track| {
            let place = track.at(time).truncate();
            if along { place } else { frame.map().transform_point3(place) }
        });
        let facing = facing.as_ref().map(|track| {
            let turn = DQuat::from_vec4(track.at(time));
            let turn = frame.turn() * turn * frame.turn().conjugate();
            (turn * bones.joints[task.joint].frame).normalize()
        });
        Goal { joint: task.joint, point: task.point, place, facing, pole: task.pole.clone() }
    }

    /// Tells of the worst frame of each task that is not within its tolerance.
    fn check_reached(
        &mut self,
        bones: &Skeleton,
        tasks: &[Task<'_>],
        (times, found): (&[f64], &[Vec<Told>]),
    ) -> Option<()> {
        let unit = self.model.frame.unit;
        let mut good = Some(());
        for (index, task) in tasks.iter().enumerate() {
            let all = times.iter().zip(found).map(|(time, goals)| (*time, goals[index].0));
            let worst = all.clone().max_by(|a, b| a.1.0.total_cmp(&b.1.0).then(b.0.total_cmp(&a.0)));
            let turned = all.clone().max_by(|a, b| a.1.1.total_cmp(&b.1.1).then(b.0.total_cmp(&a.0)));
            let missed = all.filter(|(_, (distance, _))| *distance > task.tolerance).count();
            let name = &bones.joints[task.joint].bone.name;
            let (message, label) = match (worst, turned) {
                (Some((time, (distance, _))), _) if distance > task.tolerance => (
                    format!(
                        "`{name}` does not reach its target in {missed} of {} frames: at {} s {} is left",
                        times.len(),
                        show(time),
                        show(distance / unit)
                    ),
                    "too far, or beyond the limits of the joints",
                ),
                (_, Some((time, (_, turn)))) if turn > 0.1 => (
                    format!(
                        "`{name}` is not turned as asked: at {} s {} degrees are left",
                        show(time),
                        show(turn)
                    ),
                    "beyond the limits of the joints",
                ),
                _ => continue,
            };
            let required = task.written.reach.value == ReachRule::Required;
            let report = if required {
                Diagnostic::error(Code::Unreached, message)
            } else {
                Diagnostic::warning(Code::Unreached, message)
            };
            let report = report.at(task.written.span, label).help(
                "move the target nearer, widen limits, or let `from` name a joint further up; a greater `tolerance` takes it as reached",
            );
            self.report(report);
            if required {
                good = None;
            }
        }
        good
    }
}

/// Distance and degrees that are left of a goal, and its place.
type Told = ((f64, f64), Option<DVec3>);

/// The joints from one to another that it carries, the upper first; all from the root where the upper is not named.
fn chain(bones: &Skeleton, joint: usize, from: Option<usize>) -> Vec<usize> {
    let mut chain = vec![joint];
    let mut last = joint;
    while Some(last) != from {
        let Some(parent) = bones.joints[last].bone.parent else { break };
        chain.push(parent);
        last = parent;
    }
    chain.reverse();
    chain
}

fn fixed(place: DVec3) -> Course {
    Course::Offset(constant(place))
}

fn constant(value: DVec3) -> Law {
    Law::Keys(Keys::new((vec![0.0], vec![value.extend(0.0)]), &[], Interpolation::Step, false))
}

fn drawn_back(pose: &Angles) -> Angles {
    let back = |values: &[DVec3]| values.iter().map(|value| *value * (1.0 - BACK)).collect();
    Angles { turns: back(&pose.turns), slides: back(&pose.slides) }
}

/// A pose with a share of what is between the last and the first one, whole turns left out.
fn closed(pose: &Angles, (first, last): (&Angles, &Angles), share: f64) -> Angles {
    let turned = |from: DVec3, to: DVec3| (to - from).map(|gap| gap - 360.0 * (gap / 360.0).round());
    let mut closed = pose.clone();
    for joint in 0..pose.turns.len() {
        closed.turns[joint] += turned(last.turns[joint], first.turns[joint]) * share;
        closed.slides[joint] += (first.slides[joint] - last.slides[joint]) * share;
    }
    closed
}

/// The tracks of solved joints: angles in the order of limits, which stay inside between frames too.
fn turned(
    bones: &Skeleton,
    skeleton: usize,
    (turning, times, poses): (&[usize], &[f64], &[Angles]),
    unit: f64,
) -> Vec<ClipTrack> {
    let keys = |value: &dyn Fn(&Angles) -> DVec3| {
        let values: Vec<DVec4> = poses.iter().map(|pose| value(pose).extend(0.0)).collect();
        Law::Keys(Keys::new((times.to_vec(), values), &[], Interpolation::Linear, false))
    };
    let mut tracks = Vec::new();
    for joint in turning {
        let target = Target::Joint { skeleton, joint: *joint };
        let mut add = |course| tracks.push(ClipTrack { target, course, space: Space::Rest, clamp: None });
        add(Course::Euler { order: EulerOrder::Yzx, law: keys(&|pose| pose.turns[*joint]) });
        if bones.joints[*joint].bone.slide.iter().any(Option::is_some) {
            add(Course::Offset(keys(&|pose| pose.slides[*joint] / unit)));
        }
    }
    tracks
}
