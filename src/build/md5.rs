//! Skeletons, weights and motions from MD5 files.
//!
//! A joint of the document has its y along its bone, one of the file has axes of its own. Motions are carried over by the
//! rotations at rest of both, so that what a joint carries moves as it does in the file.

use glam::{DMat3, DQuat, DVec3};

use super::Builder;
use super::motion_file::{FileMotion, Turned, joint_name, no_joint, rooted, still};
use super::skeleton::unknown_joint;
use crate::geometry::number::single;
use crate::import::ImportError;
use crate::import::bvh::BvhJoint;
use crate::import::md5::animation::{self, Md5Animation};
use crate::import::md5::mesh::{self, Md5Mesh};
use crate::import::md5::{Md5Joint, Place};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::spec::{self, FilePath, Shape as Kind, Sp, kebab};
use crate::model::{ClipTrack, Space, Target, WeightRule};
use crate::motion::{Course, Interpolation, Keys, Law, Skeleton};

impl Builder<'_> {
    /// The model of a file; of its meshes those of a material, if one is named.
    fn read_md5(&mut self, file: &Sp<FilePath>, group: Option<&str>) -> Option<Md5Mesh> {
        let bytes = self.bytes_of(file)?;
        mesh::read(&bytes, group).map_err(|error| self.refused(file, &error)).ok()
    }

    /// The joints of a mesh, each by its offset from its parent along the axes of the file.
    pub(super) fn md5_joints(&mut self, file: &Sp<FilePath>) -> Option<Vec<BvhJoint>> {
        let found = self.read_md5(file, None)?;
        let place = |joint: usize| found.places[joint].translation;
        let plain = |(index, joint): (usize, &Md5Joint)| {
            let offset = place(index) - joint.parent.map_or(DVec3::ZERO, place);
            still(joint_name(&joint.name, index), joint.parent, offset)
        };
        Some(rooted(found.joints.iter().enumerate().map(plain).collect()))
    }

    /// The weights that the file of a shape has, and the joints that carry.
    pub(super) fn file_weights(
        &mut self,
        written: &spec::Skin,
        bones: &Skeleton,
    ) -> Option<(Vec<usize>, WeightRule)> {
        let name = &written.shape.value.0;
        let kind = &self.spec.shapes.get(name)?.value.kind;
        let Kind::Import(import) = kind else { return self.no_weights(&written.shape) };
        // The shape was read, so that this succeeds again.
        let (names, weights) = match import.file.value.extension().as_str() {
            _ if import.weld.is_some() => return self.no_weights(&written.shape),
            "md5mesh" => {
                let group = import.group.as_ref().map(|group| group.value.as_str());
                let found = self.read_md5(&import.file, group)?;
                let names =
                    found.joints.iter().enumerate().map(|(index, joint)| joint_name(&joint.name, index));
                (names.collect::<Vec<_>>(), found.weights)
            }
            "glb" | "gltf" => self.gltf_weights(import, &written.shape)?,
            _ => return self.no_weights(&written.shape),
        };
        let mut joints = Vec::with_capacity(names.len());
        for name in names {
            let Some(own) = bones.find(&name) else {
                let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
                self.report(unknown_joint(&Sp::new(name, written.skeleton.span), known, "joint"));
                return None;
            };
            joints.push(own);
        }
        let mut sorted = joints.clone();
        sorted.sort_unstable();
        let place = |joint: usize| sorted.partition_point(|own| *own < joints[joint]);
        let of = |own: &Vec<(usize, f64)>| own.iter().map(|(joint, share)| (place(*joint), *share)).collect();
        let weights = weights.iter().map(of).collect();
        Some((sorted, WeightRule::Given(weights)))
    }

    pub(super) fn no_weights<T>(&mut self, shape: &Sp<spec::ShapeName>) -> Option<T> {
        let message = format!("shape `{}` does not have the points of a file with weights", shape.value.0);
        let report = Diagnostic::error(Code::UnknownPart, message)
            .at(shape.span, "no weights")
            .help("only `[shape.NAME.import]` of a glTF file with a skin or of an MD5 mesh (.md5mesh), without `weld`, has them");
        self.report(report);
        None
    }

    /// The motion of a file.
    pub(super) fn md5_motion(
        &mut self,
        clip: &spec::Clip,
        import: &Sp<spec::MotionImport>,
    ) -> Option<FileMotion> {
        let bytes = self.bytes_of(&import.file)?;
        let read =
            animation::read(&bytes).map_err(|fault| self.refused(&import.file, &ImportError::from(fault)));
        let motion = read.ok()?;
        let first = joint_name(&motion.joints.first()?.name, 0);
        let skeleton = self.clip_skeleton(clip, &Sp::new(first, import.file.span))?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let own = self.spec.skeletons.get(&self.model.skeletons[skeleton].name);
        let own = own.and_then(|definition| definition.value.import.as_ref());
        let Some(own) = own.filter(|own| own.file.value.extension() == "md5mesh") else {
            let message = format!(
                "{} moves the joints of an MD5 mesh, and skeleton `{}` is not from one",
                import.file.value.written, self.model.skeletons[skeleton].name
            );
            let report = Diagnostic::error(Code::UnknownPart, message)
                .at(import.file.span, "which axes do its joints have at rest?")
                .help("write `[skeleton.NAME.import]` with the .md5mesh file of the model");
            self.report(report);
            return None;
        };
        let rest = self.read_md5(&own.file, None)?;
        let turned = self.turned_as(import, Some(own));
        let time = |frame: usize| f64::from(single(frame as f64 / motion.frame_rate));
        let times: Vec<f64> = (0..motion.frames.len()).map(time).collect();
        let mut tracks = Vec::new();
        for (index, joint) in motion.joints.iter().enumerate() {
            let name = joint_name(&joint.name, index);
            let Some(found) = bones.find(&name) else {
                self.report(no_joint(&name, &joint.name, &bones, import.file.span));
                return None;
            };
            let named = |at: &usize| joint_name(&rest.joints[*at].name, *at) == name;
            let alike = |at: &usize| parent(&rest.joints, *at) == parent(&motion.joints, index);
            let Some(at_rest) = (0..rest.joints.len()).find(named).filter(alike) else {
                let message = format!(
                    "joint `{}` of {} has another parent than in the mesh",
                    joint.name, import.file.value.written
                );
                let report = Diagnostic::error(Code::UnknownPart, message)
                    .at(import.file.span, "a motion of another skeleton")
                    .also(own.file.span, "the skeleton's file");
                self.report(report);
                return None;
            };
            let target = Target::Joint { skeleton, joint: found };
            let frame = bones.joints[found].frame;
            let courses = self.md5_courses((&motion, index), (&rest, at_rest), &times, (frame, &turned));
            let (space, clamp) = (Space::Rest, None);
            tracks.extend(courses.into_iter().map(|course| ClipTrack { target, course, space, clamp }));
        }
        Some(FileMotion { lasting: times[times.len() - 1], tracks, properties: Vec::new() })
    }

    /// How a joint moves. With F the frame of the document's joint, Q and P the file's rotations of it and of its parent
    /// at rest, and r its rotation in its parent: F^-1 P r Q^-1 F on top of the rest.
    fn md5_courses(
        &self,
        (motion, joint): (&Md5Animation, usize),
        (rest, at_rest): (&Md5Mesh, usize),
        times: &[f64],
        (frame, turned): (DQuat, &Turned),
    ) -> Vec<Course> {
        let axes: DMat3 = self.model.frame.axes() * turned.axes;
        let into = DQuat::from_mat3(&axes).normalize();
        let own = rest.places[at_rest];
        let parent = rest.joints[at_rest].parent.map(|parent| rest.places[parent]);
        let around = parent.map_or(into, |parent| into * parent.rotation);
        let local = parent.map_or(own.translation, |parent| {
            parent.rotation.conjugate() * (own.translation - parent.translation)
        });
        let before = frame.conjugate() * around;
        let after = (into * own.rotation).conjugate() * frame;
        let rotation = |places: &Vec<Place>| (before * places[joint].rotation * after).normalize();
        let rotations: Vec<DQuat> = motion.frames.iter().map(rotation).collect();
        let mut courses = vec![Course::rotations(times.to_vec(), &rotations, Interpolation::Linear, false)];
        let offset = |places: &Vec<Place>| places[joint].translation - local;
        // Texts have six digits or so.
        let size = rest.places.iter().map(|place| place.translation.abs().max_element()).fold(0.0, f64::max);
        if motion.frames.iter().any(|places| offset(places).length() > 1e-5 * size) {
            let value = |places: &Vec<Place>| (before * (offset(places) * turned.scale)).extend(0.0);
            let values = motion.frames.iter().map(value).collect();
            let keys = Keys::new((times.to_vec(), values), &[], Interpolation::Linear, false);
            courses.push(Course::Offset(Law::Keys(keys)));
        }
        courses
    }
}

/// The name of the joint that carries another.
fn parent(joints: &[Md5Joint], joint: usize) -> Option<String> {
    joints[joint].parent.and_then(|parent| kebab(&joints[parent].name))
}
