//! Skeletons, weights and animations of glTF files.
//!
//! A joint of the document has its y along its bone, one of the file has axes of its own. With K the map from a joint of the
//! document to the scene at rest, B that from one of the file when its mesh is bound, and l its place in the joint that
//! carries it at some time, K' its parent's and B' its parent's, its place there is (K'⁻¹ B') l (B⁻¹ K). Both brackets are
//! constant, so that keys become keys, and what runs straight or on the sphere between them still does.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use super::Builder;
use super::file_state::Playing;
use super::import::{NOTES, beside};
use super::motion_file::{FileMotion, joint_name, no_joint, rooted, still};
use crate::import::bvh::BvhJoint;
use crate::import::gltf::{self, Channel, ChannelPath, Clip, GltfFile, Place, Rig, Steps};
use crate::import::{ImportError, ImportOptions};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, FilePath, Sp};
use crate::model::{ClipTrack, Space, Target};
use crate::motion::{Course, Interpolation, Joint, Keys, Law, Skeleton};

/// The part of a length that rounding to single precision may be.
const ROUNDING: f64 = 1.2e-7;

/// Factors that differ by less than this part are one.
const EVEN: f64 = 1e-4;

/// A turn, a factor and a move.
#[derive(Clone, Copy, Debug)]
struct Similar {
    rotation: DQuat,
    scale: f64,
    translation: DVec3,
}

/// Names of joints, and for each point of a mesh those that carry it with their shares.
type NamedWeights = (Vec<String>, Vec<Vec<(usize, f64)>>);

impl Builder<'_> {
    fn gltf_file(&mut self, file: &Sp<FilePath>) -> Option<(GltfFile, Rig)> {
        let bytes = self.bytes_of(file)?;
        let found = gltf::open(&bytes, &mut beside(self.files, &file.value));
        let found = found.and_then(|found| Ok((found.rig()?, found)));
        match found {
            Ok((rig, found)) => Some((found, rig)),
            Err(fault) => {
                self.refused(file, &ImportError::from(fault));
                None
            }
        }
    }

    /// The joints of a file's skins, each by its offset from its parent along the axes of the file.
    pub(super) fn gltf_joints(&mut self, file: &Sp<FilePath>) -> Option<Vec<BvhJoint>> {
        let (_, rig) = self.gltf_file(file)?;
        if rig.joints.is_empty() {
            let message = format!("{} has no skin", file.value.written);
            self.report(Diagnostic::error(Code::UnknownPart, message).at(file.span, "no joints"));
            return None;
        }
        let place = |joint: usize| rig.joints[joint].bind.translation;
        let plain = |(index, joint): (usize, &gltf::RigJoint)| {
            let offset = place(index) - joint.parent.map_or(DVec3::ZERO, place);
            still(joint_name(&joint.name, index), joint.parent, offset)
        };
        Some(rooted(rig.joints.iter().enumerate().map(plain).collect()))
    }

    /// The meshes of a file as they are written, with the weights of their points and their states.
    pub(super) fn gltf_weighted(&mut self, import: &spec::Import) -> Option<gltf::Weighted> {
        let bytes = self.bytes_of(&import.file)?;
        let options = ImportOptions {
            group: import.group.as_ref().map(|group| group.value.clone()),
            weld: None,
            most: self.model.limits.triangles,
        };
        let read = gltf::read_weighted(&bytes, &options, &mut beside(self.files, &import.file.value));
        read.map_err(|error| self.refused(&import.file, &error)).ok()
    }

    /// The joints of a file and its weights for the points of a shape.
    pub(super) fn gltf_weights(
        &mut self,
        import: &spec::Import,
        shape: &Sp<spec::ShapeName>,
    ) -> Option<NamedWeights> {
        let (_, rig) = self.gltf_file(&import.file)?;
        let found = self.gltf_weighted(import)?;
        if found.weights.iter().all(Vec::is_empty) {
            return self.no_weights(shape);
        }
        let place = |node: usize| rig.joints.iter().position(|joint| joint.node == node);
        let of = |own: &Vec<(usize, f64)>| {
            own.iter().filter_map(|(node, share)| Some((place(*node)?, *share))).collect()
        };
        let names = rig.joints.iter().enumerate().map(|(index, joint)| joint_name(&joint.name, index));
        Some((names.collect(), found.weights.iter().map(of).collect()))
    }

    /// The motion of a file.
    pub(super) fn gltf_motion(
        &mut self,
        clip: &spec::Clip,
        import: &Sp<spec::MotionImport>,
    ) -> Option<FileMotion> {
        let (file, rig) = self.gltf_file(&import.file)?;
        let clips = file.clips();
        let clips = clips.map_err(|fault| self.refused(&import.file, &ImportError::from(fault))).ok()?;
        let own = self.animation(import, &clips)?;
        let is_joint = |node: usize| rig.joints.iter().any(|joint| joint.node == node);
        let nodes = file.nodes();
        let playing = Playing { own, nodes: &nodes, is_joint: &is_joint };
        let (mut tracks, properties, left_out) = self.beside_joints(&import.file.value, &playing);
        let moves_joints = own.channels.iter().any(|channel| is_joint(channel.node));
        if moves_joints || !(rig.joints.is_empty() || self.spec.skeletons.is_empty()) {
            tracks.extend(self.joint_tracks(clip, import, (&rig, own))?);
        }
        if tracks.is_empty() && properties.is_empty() {
            let message = format!(
                "animation `{}` of {} moves nothing of this document",
                own.name, import.file.value.written
            );
            let report = Diagnostic::error(Code::BadTrack, message)
                .at(import.file.span, "no joint, state or material of it");
            let report = left_out.into_iter().take(NOTES).fold(report, Diagnostic::note);
            self.report(report.help("import what it moves from the same file: joints by `[skeleton.NAME.import]`, states and materials by `[shape.NAME.import]` of a shape that a node shows"));
            return None;
        }
        self.tell_left_out(&import.file, own, left_out);
        Some(FileMotion { lasting: own.duration(), tracks, properties })
    }

    /// How the joints of a file move.
    fn joint_tracks(
        &mut self,
        clip: &spec::Clip,
        import: &Sp<spec::MotionImport>,
        (rig, own): (&Rig, &Clip),
    ) -> Option<Vec<ClipTrack>> {
        let first = rig.joints.first().map_or("", |joint| joint.name.as_str());
        let skeleton = self.clip_skeleton(clip, &Sp::new(joint_name(first, 0), import.file.span))?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let written = self.spec.skeletons.get(&self.model.skeletons[skeleton].name);
        let written = written.and_then(|definition| definition.value.import.as_ref());
        let turned = self.turned_as(import, written);
        let into = self.model.frame.map() * DAffine3::from_mat3(turned.axes * turned.scale);
        let mut tracks = Vec::new();
        for (index, joint) in rig.joints.iter().enumerate() {
            let name = joint_name(&joint.name, index);
            let Some(found) = bones.find(&name) else {
                self.report(no_joint(&name, &joint.name, &bones, import.file.span));
                return None;
            };
            let around = around(&bones, found, (rig, index), &into);
            let within = (into * joint.bind).inverse() * bones.joints[found].bind();
            let channels: Vec<&Channel> =
                own.channels.iter().filter(|channel| channel.node == joint.node).collect();
            let carried = similar(&around).zip(similar(&within));
            let courses = carried.and_then(|maps| {
                courses(&joint.rest, &channels, maps, (&bones.joints[found], self.model.frame.unit))
            });
            let Some(courses) = courses else {
                self.report(stretched(&joint.name, &import.file, import.file.span));
                return None;
            };
            let target = Target::Joint { skeleton, joint: found };
            let (space, clamp) = (Space::Rest, None);
            tracks.extend(courses.into_iter().map(|course| ClipTrack { target, course, space, clamp }));
        }
        Some(tracks)
    }

    /// The animation that is asked for.
    fn animation<'c>(&mut self, import: &spec::MotionImport, clips: &'c [Clip]) -> Option<&'c Clip> {
        let wanted = import.animation.as_ref();
        let found = clips.iter().find(|clip| wanted.is_none_or(|name| name.value == clip.name));
        if found.is_none() {
            let known: Vec<String> = clips.iter().map(|clip| format!("`{}`", clip.name)).collect();
            let (what, span) = wanted.map_or(("no animation".to_owned(), import.file.span), |name| {
                (format!("no animation `{}`", name.value), name.span)
            });
            let message = format!("{} has {what}", import.file.value.written);
            let report = Diagnostic::error(Code::UnknownPart, message).at(span, "not in the file");
            self.report(match known.is_empty() {
                true => report,
                false => report.note(format!("its animations: {}", known.join(", "))),
            });
        }
        found
    }

    /// Warns of what of an animation is not played.
    fn tell_left_out(&mut self, file: &Sp<FilePath>, own: &Clip, left_out: Vec<String>) {
        if left_out.is_empty() {
            return;
        }
        let message = format!("animation `{}` of {} was not imported whole", own.name, file.value.written);
        let mut report = Diagnostic::warning(Code::ImportNote, message).at(file.span, "see the notes");
        let count = left_out.len();
        for words in left_out.into_iter().take(NOTES) {
            report = report.note(format!("left out: {words}"));
        }
        if count > NOTES {
            report = report.note(format!("and {} more", count - NOTES));
        }
        self.report(report);
    }
}

/// K'⁻¹ B' with the nodes between a joint and the one that carries it.
fn around(bones: &Skeleton, found: usize, (rig, index): (&Rig, usize), into: &DAffine3) -> DAffine3 {
    let joint = &rig.joints[index];
    let outside = joint.parent.map_or(*into, |parent| *into * rig.joints[parent].bind) * joint.before;
    match bones.joints[found].bone.parent {
        Some(parent) => bones.joints[parent].bind().inverse() * outside,
        None => outside,
    }
}

/// A map as a turn, a factor and a move; none where it stretches unevenly or mirrors.
fn similar(map: &DAffine3) -> Option<Similar> {
    let matrix = map.matrix3;
    let scale = matrix.x_axis.length();
    let even = |axis: DVec3| (axis.length() - scale).abs() <= EVEN * scale;
    let square = |a: DVec3, b: DVec3| a.dot(b).abs() <= EVEN * scale * scale;
    let whole = scale > 0.0
        && even(matrix.y_axis)
        && even(matrix.z_axis)
        && square(matrix.x_axis, matrix.y_axis)
        && square(matrix.y_axis, matrix.z_axis)
        && square(matrix.z_axis, matrix.x_axis)
        && matrix.determinant() > 0.0;
    let turn = DMat3::from_cols(matrix.x_axis, matrix.y_axis, matrix.z_axis) * (1.0 / scale);
    whole.then(|| Similar {
        rotation: DQuat::from_mat3(&turn).normalize(),
        scale,
        translation: map.translation,
    })
}

/// How a joint moves relative to its rest; none where it is stretched unevenly.
fn courses(
    rest: &Place,
    channels: &[&Channel],
    (around, within): (Similar, Similar),
    (joint, unit): (&Joint, f64),
) -> Option<Vec<Course>> {
    let (rotation, translation, scale) = parts(rest)?;
    let back = joint.rest.rotation.conjugate();
    let turn = |quaternion: DVec4| {
        let product = back * around.rotation * DQuat::from_vec4(quaternion) * within.rotation;
        DVec4::from(product)
    };
    let linear = |way: DVec3| back * (around.rotation * (way * around.scale)) / unit;
    let start = back * (around.translation - joint.rest.translation) / unit;
    let shift = |place: DVec4| (start + linear(place.truncate())).extend(0.0);
    let grow = |factors: DVec4| factors * (around.scale * within.scale);
    let mut all = Vec::new();
    let find = |path: ChannelPath| channels.iter().find(|channel| channel.path() == path);
    // Without a channel a joint stands as it rests in the file, which may be another place than where it was bound.
    let still = |value: DVec4| Keys::new((vec![0.0], vec![value]), &[], Interpolation::Step, false);
    let turns = match find(ChannelPath::Rotation) {
        Some(channel) => keys(channel, &turn, &turn),
        None => still(turn(DVec4::from(rotation))),
    };
    if !is_all(&turns, DVec4::W, 1e-9) && !is_all(&turns, -DVec4::W, 1e-9) {
        all.push(match turns.interpolation {
            Interpolation::Cubic => Course::Rotations(turns),
            other => {
                let rotations: Vec<DQuat> =
                    turns.values.iter().map(|value| DQuat::from_vec4(*value).normalize()).collect();
                Course::rotations(turns.times, &rotations, other, false)
            }
        });
    }
    let keys_of = |path: ChannelPath,
                   still_value: DVec3,
                   value: &dyn Fn(DVec4) -> DVec4,
                   slope: &dyn Fn(DVec4) -> DVec4| {
        find(path)
            .map_or_else(|| still(value(still_value.extend(0.0))), |channel| keys(channel, value, slope))
    };
    let moves =
        keys_of(ChannelPath::Translation, translation, &shift, &|way| linear(way.truncate()).extend(0.0));
    let reach = joint.bone.head.abs().max_element().max(joint.length());
    if !is_all(&moves, DVec4::ZERO, ROUNDING * reach / unit) {
        all.push(Course::Offset(Law::Keys(moves)));
    }
    let factors = keys_of(ChannelPath::Scale, scale, &grow, &grow);
    if factors.values.iter().any(|value| !even(value.truncate())) {
        return None;
    }
    if !is_all(&factors, DVec3::ONE.extend(0.0), 1e-6) {
        all.push(Course::Size(Law::Keys(factors)));
    }
    Some(all)
}

fn even(factors: DVec3) -> bool {
    (factors.max_element() - factors.min_element()).abs() <= EVEN * factors.abs().max_element()
}

/// Whether a value stays what it is.
fn is_all(keys: &Keys, value: DVec4, within: f64) -> bool {
    let near = |known: &DVec4| known.abs_diff_eq(value, within);
    keys.values.iter().all(near) && keys.slopes.iter().all(|slope| slope.length() <= within)
}

fn parts(place: &Place) -> Option<(DQuat, DVec3, DVec3)> {
    match place {
        Place::Parts { translation, rotation, scale } => Some((*rotation, *translation, *scale)),
        Place::Matrix(matrix) => {
            let similar = similar(&DAffine3::from_mat4(*matrix))?;
            Some((similar.rotation, similar.translation, DVec3::splat(similar.scale)))
        }
    }
}

/// The keys of a channel, carried over.
fn keys(channel: &Channel, value: &dyn Fn(DVec4) -> DVec4, slope: &dyn Fn(DVec4) -> DVec4) -> Keys {
    keys_of((&channel.times, channel.steps), channel.numbers(), value, slope)
}

/// Keys of numbers at times, of which cubics have three for each, carried over.
pub(super) fn keys_of(
    (times, steps): (&[f32], Steps),
    numbers: Vec<DVec4>,
    value: &dyn Fn(DVec4) -> DVec4,
    slope: &dyn Fn(DVec4) -> DVec4,
) -> Keys {
    let times: Vec<f64> = times.iter().map(|time| f64::from(*time)).collect();
    match steps {
        Steps::Step | Steps::Linear => {
            let interpolation =
                if steps == Steps::Step { Interpolation::Step } else { Interpolation::Linear };
            Keys::new((times, numbers.into_iter().map(value).collect()), &[], interpolation, false)
        }
        Steps::Cubic => {
            let (rows, _) = numbers.as_chunks::<3>();
            // A key whose slopes before and after it differ becomes two, a moment apart.
            let (mut all, mut values, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
            for (key, [arriving, own, leaving]) in rows.iter().enumerate() {
                let (arriving, leaving) = (slope(*arriving), slope(*leaving));
                let own = value(*own);
                let last = key + 1 == rows.len();
                if key > 0 && !last && !arriving.abs_diff_eq(leaving, 1e-6 * leaving.length().max(1e-9)) {
                    all.push(times[key] - MOMENT * (times[key] - times[key - 1]));
                    values.push(own - arriving * (MOMENT * (times[key] - times[key - 1])));
                    slopes.push(Some(arriving));
                }
                all.push(times[key]);
                values.push(own);
                slopes.push(Some(if last { arriving } else { leaving }));
            }
            Keys::new((all, values), &slopes, Interpolation::Cubic, false)
        }
    }
}

/// The share of the way from a key to the next in which a motion changes its slope.
const MOMENT: f64 = 1e-6;

fn stretched(joint: &str, file: &Sp<FilePath>, span: Span) -> Diagnostic {
    let message = format!("{} stretches joint `{joint}` unevenly", file.value.written);
    Diagnostic::error(Code::StretchedMotion, message)
        .at(span, "cannot be carried over")
        .note("joints of a skeleton have their y along their bones, and what is stretched along other axes would be sheared")
        .help("scale joints evenly, by the same factor along x, y and z")
}
