//! Skeletons from files, and motions from BVH files.

use glam::{DMat3, DQuat, DVec3, DVec4};

use super::Builder;
use super::import::{axes_between, default_up};
use super::skeleton::Draft;
use crate::geometry::number::single;
use crate::import::bvh::{self, Bvh, BvhJoint, Channel};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, FilePath, Sp, Up, closest, kebab};
use crate::model::{ClipTrack, PropertyTrack, Space, Target};
use crate::motion::{Axis, Course, Interpolation, Keys, Law, Skeleton, about};

/// The most numbers of a motion that is read into a clip.
const MOST_NUMBERS: usize = 4_000_000;

/// The name of a joint that carries those that nothing carries, where there are several.
const ROOT: &str = "root";

/// How the numbers of a file become those of the document.
pub(super) struct Turned {
    pub(super) axes: DMat3,
    pub(super) scale: f64,
}

/// The motion of a file.
#[derive(Default)]
pub(super) struct FileMotion {
    /// Seconds.
    pub(super) lasting: f64,
    /// What moves.
    pub(super) tracks: Vec<ClipTrack>,
    /// What else changes.
    pub(super) properties: Vec<PropertyTrack>,
}

impl Builder<'_> {
    /// The joints of a file as if they were written.
    pub(super) fn imported_joints(&mut self, import: &Sp<spec::SkeletonImport>) -> Option<Vec<Draft>> {
        let joints = match import.file.value.extension().as_str() {
            "md5mesh" => self.md5_joints(&import.file)?,
            "glb" | "gltf" => self.gltf_joints(&import.file)?,
            _ => self.bvh(&import.file)?.joints,
        };
        let up = import.up.map_or_else(|| default_up(&import.file), |up| up.value);
        let turned = self.turned(up, import.scale.value);
        let place = |offset: [f64; 3]| turned.axes * DVec3::from_array(offset) * turned.scale;
        let mut heads: Vec<DVec3> = Vec::with_capacity(joints.len());
        for joint in &joints {
            let parent = joint.parent.map_or(DVec3::ZERO, |parent| heads[parent]);
            heads.push(parent + place(joint.offset));
        }
        let bones = joints.iter().filter(|joint| joint.offset != [0.0; 3]).count().max(1) as f64;
        let usual = joints.iter().map(|joint| place(joint.offset).length()).sum::<f64>() / bones;
        let draft = |(index, joint): (usize, &BvhJoint)| Draft {
            name: joint_name(&joint.name, index),
            parent: joint.parent.map(|parent| Sp::new(joint_name(&joints[parent].name, parent), import.span)),
            head: Some(heads[index]),
            tail: heads[index] + bone(&joints, index, &place, usual),
            roll: 0.0,
            limits: [None; 3],
            slide: [None; 3],
            stiffness: 0.0,
            radius: None,
            falloff: None,
            span: import.span,
        };
        Some(joints.iter().enumerate().map(draft).collect())
    }

    /// The motion of a file.
    pub(super) fn imported_motion(
        &mut self,
        clip: &spec::Clip,
        import: &Sp<spec::MotionImport>,
    ) -> Option<FileMotion> {
        match import.file.value.extension().as_str() {
            "md5anim" => return self.md5_motion(clip, import),
            "glb" | "gltf" => return self.gltf_motion(clip, import),
            _ => {}
        }
        let bvh = self.bvh(&import.file)?;
        let numbers = bvh.frames.len() * bvh.joints.len();
        if numbers > MOST_NUMBERS {
            let message =
                format!("this motion has {numbers} poses of joints, and the limit is {MOST_NUMBERS}");
            self.report(Diagnostic::error(Code::LimitPassed, message).at(import.file.span, "too long"));
            return None;
        }
        let name = Sp::new(joint_name(&bvh.joints[0].name, 0), import.file.span);
        let skeleton = self.clip_skeleton(clip, &name)?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let own = self.model.skeletons[skeleton].name.clone();
        let own = self.spec.skeletons.get(&own).and_then(|definition| definition.value.import.as_ref());
        let turned = self.turned_as(import, own);
        let times: Vec<f64> =
            (0..bvh.frames.len()).map(|frame| f64::from(single(frame as f64 * bvh.frame_time))).collect();
        let mut tracks = Vec::new();
        for (index, joint) in bvh.joints.iter().enumerate() {
            let name = joint_name(&joint.name, index);
            let Some(found) = bones.find(&name) else {
                self.report(no_joint(&name, &joint.name, &bones, import.file.span));
                return None;
            };
            let target = Target::Joint { skeleton, joint: found };
            let courses = self.joint_courses((&bvh, joint), &times, (bones.joints[found].frame, &turned));
            tracks.extend(courses.into_iter().map(|course| ClipTrack {
                target,
                course,
                space: Space::Rest,
                clamp: None,
            }));
        }
        Some(FileMotion { lasting: times[times.len() - 1], tracks, properties: Vec::new() })
    }

    /// How a joint moves: its frames at rest stand along the axes of the file, ours along the bone.
    fn joint_courses(
        &self,
        (bvh, joint): (&Bvh, &BvhJoint),
        times: &[f64],
        (frame, turned): (DQuat, &Turned),
    ) -> Vec<Course> {
        let into = DQuat::from_mat3(&(self.model.frame.axes() * turned.axes)).normalize();
        let mut courses = Vec::new();
        let numbers = |pose: &[f64]| pose[joint.first..joint.first + joint.channels.len()].to_vec();
        if joint.channels.iter().any(|channel| matches!(channel, Channel::Rotation(_))) {
            let rotation = |pose: &Vec<f64>| {
                let turn = joint.channels.iter().zip(numbers(pose)).fold(
                    DQuat::IDENTITY,
                    |turn, (channel, value)| match channel {
                        Channel::Rotation(axis) => turn * about(Axis::ALL[*axis].direction(), value),
                        Channel::Position(_) => turn,
                    },
                );
                let turn = into * turn * into.conjugate();
                (frame.conjugate() * turn * frame).normalize()
            };
            let rotations: Vec<DQuat> = bvh.frames.iter().map(rotation).collect();
            courses.push(Course::rotations(times.to_vec(), &rotations, Interpolation::Linear, false));
        }
        if joint.channels.iter().any(|channel| matches!(channel, Channel::Position(_))) {
            let place = |pose: &Vec<f64>| -> DVec4 {
                let mut place = DVec3::ZERO;
                for (channel, value) in joint.channels.iter().zip(numbers(pose)) {
                    if let Channel::Position(axis) = channel {
                        place[*axis] = value;
                    }
                }
                // Tracks slide along the rest frame's axes; those of the parent hold for the file.
                (frame.conjugate() * (into * (place * turned.scale))).extend(0.0)
            };
            let values = bvh.frames.iter().map(place).collect();
            let keys = Keys::new((times.to_vec(), values), &[], Interpolation::Linear, false);
            courses.push(Course::Offset(Law::Keys(keys)));
        }
        courses
    }

    /// As a motion says, else as the file of its skeleton is turned.
    pub(super) fn turned_as(
        &self,
        import: &spec::MotionImport,
        own: Option<&Sp<spec::SkeletonImport>>,
    ) -> Turned {
        let scale = import.scale.or(own.map(|own| own.scale)).map_or(1.0, |scale| scale.value);
        let file = own.map_or(&import.file, |own| &own.file);
        let up = import.up.or(own.and_then(|own| own.up)).map_or_else(|| default_up(file), |up| up.value);
        self.turned(up, scale)
    }

    fn turned(&self, up: Up, scale: f64) -> Turned {
        Turned { axes: axes_between(up, self.spec.up), scale }
    }

    fn bvh(&mut self, file: &Sp<FilePath>) -> Option<Bvh> {
        let bytes = match self.files.read(&file.value.resolved) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.file_fault(&error, file);
                return None;
            }
        };
        match bvh::read(&bytes) {
            Ok(bvh) => Some(bvh),
            Err(fault) => {
                let line = fault.line().map_or(String::new(), |line| format!(", line {line}"));
                let message = format!("`{}` is no BVH motion{line}: {fault}", file.value.written);
                self.report(Diagnostic::error(Code::ImportFailed, message).at(file.span, "read from here"));
                None
            }
        }
    }
}

/// The bone of a joint: to its end site, or to the middle of its children; where these stand on it, on as its parent's.
fn bone(joints: &[BvhJoint], index: usize, place: &impl Fn([f64; 3]) -> DVec3, usual: f64) -> DVec3 {
    let joint = &joints[index];
    let end = joint.end.map(place).filter(|end| *end != DVec3::ZERO);
    let below: Vec<DVec3> = (joints.iter())
        .filter(|other| other.parent == Some(index))
        .map(|other| place(other.offset))
        .filter(|offset| *offset != DVec3::ZERO)
        .collect();
    let middle = below.iter().sum::<DVec3>() / below.len().max(1) as f64;
    let onward = place(joint.offset);
    let length = if usual > 0.0 { usual } else { 1.0 };
    end.or((middle.length() > 1e-6 * length).then_some(middle))
        .or(below.first().copied())
        .or((joint.parent.is_some() && onward != DVec3::ZERO).then_some(onward))
        .unwrap_or(DVec3::Y * length)
}

/// Joints, with one at the origin before them that carries those without a parent where there are several.
pub(super) fn rooted(mut joints: Vec<BvhJoint>) -> Vec<BvhJoint> {
    if joints.iter().filter(|joint| joint.parent.is_none()).count() < 2 {
        return joints;
    }
    for joint in &mut joints {
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
    }
    let free = |name: &String| joints.iter().all(|joint| joint.name != *name);
    let names = (1..).map(|k| if k == 1 { ROOT.to_owned() } else { format!("{ROOT}-{k}") });
    let name = names.into_iter().find(free).unwrap_or_default();
    joints.insert(0, still(name, None, DVec3::ZERO));
    joints
}

/// A joint that only stands somewhere.
pub(super) fn still(name: String, parent: Option<usize>, offset: DVec3) -> BvhJoint {
    BvhJoint { name, parent, offset: offset.to_array(), end: None, channels: Vec::new(), first: 0 }
}

/// The name of a joint as documents write names.
pub(super) fn joint_name(name: &str, index: usize) -> String {
    kebab(name).unwrap_or_else(|| format!("joint-{}", index + 1))
}

pub(super) fn no_joint(name: &str, written: &str, bones: &Skeleton, span: Span) -> Diagnostic {
    let message = format!("the skeleton has no joint `{name}` for `{written}` of the file");
    let report = Diagnostic::error(Code::UnknownName, message).at(span, "moves it");
    let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
    match closest(name, known) {
        Some(near) => report
            .help(format!("the skeleton has `{near}`; names must be the same but for their letters' case")),
        None => report.help("write `[skeleton.NAME.import]` with the same file"),
    }
}
