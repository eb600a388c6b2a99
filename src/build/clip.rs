//! Clips of a document: what moves, held against limits, seams and each other.

use glam::{DQuat, DVec3, DVec4};

use super::Builder;
use super::course::Moved;
use super::profile::show;
use super::property::is_property;
use super::reach::Frames;
use super::skeleton::unknown_joint;
use super::skin::chain_joints;
use crate::geometry::curve::{Curve as _, Side};
use crate::geometry::number::floor_large;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, LimitRule, Sp};
use crate::model::{Clip, ClipTrack, Space, Target};
use crate::motion::{Axis, Course, Path, Track};

/// The most samples of a clip, times what moves.
const MOST_SAMPLES: u64 = 4_000_000;

/// What a track moves: each target and its place along the chain.
type Targets = Vec<(Target, f64)>;

impl Builder<'_> {
    pub(super) fn clips(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.clips {
            if let Some(clip) = self.clip(name, &definition.value, definition.span) {
                self.model.clips.push(clip);
                self.clip_places.push(definition.span);
            }
        }
    }

    fn clip(&mut self, name: &str, written: &spec::Clip, span: Span) -> Option<Clip> {
        let imported = match &written.import {
            Some(import) => Some(self.imported_motion(written, import)?),
            None => None,
        };
        let lasting = imported.as_ref().map_or(0.0, |motion| motion.lasting);
        let duration = self.duration(written, lasting, span)?;
        self.check_samples(written, duration, span)?;
        let place = written.import.as_ref().map_or(span, |import| import.file.span);
        let imported = imported.unwrap_or_default();
        let mut tracks: Vec<(ClipTrack, Span)> =
            imported.tracks.into_iter().map(|track| (track, place)).collect();
        let changing = imported.properties.into_iter().map(|track| (track, place)).collect();
        let mut good = true;
        for track in written.track.iter().filter(|track| !is_property(track)) {
            match self.track(written, track, duration) {
                Some(made) => {
                    for one in made {
                        good &= self.check_alone(&one, track.span, &tracks);
                        tracks.push((one, track.span));
                    }
                }
                None => good = false,
            }
        }
        if written.track.is_empty() && written.reach.is_empty() && written.import.is_none() {
            let report = Diagnostic::error(Code::BadTrack, format!("clip `{name}` moves nothing"))
                .at(span, "no track")
                .help("write `[[clip.NAME.track]]` with `node`, `joint` or `material`, `path` and `keys`");
            self.report(report);
            return None;
        }
        good &= self.check_weights(&tracks) && self.check_events(written, duration);
        let properties = self.properties(written, changing, duration)?;
        if !good {
            return None;
        }
        let mut own: Vec<ClipTrack> = tracks.iter().map(|(track, _)| track.clone()).collect();
        let (rate, looped) = (written.rate.value, written.r#loop.value);
        if !self.aims.is_empty() && !written.reach.is_empty() {
            // What looks may carry a skeleton; once joints have reached, it looks again.
            let frames = Frames { tracks: &own, duration, rate, looped };
            let looking = self.aim_tracks(&frames, span)?;
            own.extend(looking);
        }
        let frames = Frames { tracks: &own, duration, rate, looped };
        let (solved, reaches) = self.reaches(written, &frames)?;
        let reached = written.reach.first().map_or(span, |reach| reach.span);
        tracks.extend(solved.into_iter().map(|track| (track, reached)));
        if !self.aims.is_empty() {
            let own: Vec<ClipTrack> = tracks.iter().map(|(track, _)| track.clone()).collect();
            let frames = Frames { tracks: &own, duration, rate, looped };
            tracks.extend(self.aim_tracks(&frames, span)?.into_iter().map(|track| (track, span)));
        }
        for (one, span) in self.driven(&tracks) {
            if !self.check_alone(&one, span, &tracks) {
                return None;
            }
            tracks.push((one, span));
        }
        if !self.check_weights(&tracks) {
            return None;
        }
        if written.limits.value == LimitRule::Error {
            self.check_limits(&tracks, duration)?;
        }
        if written.r#loop.value {
            self.check_loop(&tracks, written, duration)?;
        }
        let mut events: Vec<(f64, String)> =
            written.event.iter().map(|event| (event.at.value, event.name.value.clone())).collect();
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(Clip {
            name: name.to_owned(),
            duration,
            looped: written.r#loop.value,
            tolerance: written.tolerance.map(|tolerance| tolerance.value * self.model.frame.unit),
            rate: written.rate.value,
            tracks: tracks.into_iter().map(|(track, _)| track).collect(),
            properties,
            reaches,
            events,
        })
    }

    fn duration(&mut self, written: &spec::Clip, lasting: f64, span: Span) -> Option<f64> {
        let tracks = written.track.iter().flat_map(|track| track.keys.iter().chain(&track.speed));
        let reaches = written.reach.iter();
        let reaches = reaches.flat_map(|one| one.keys.iter().chain(&one.speed).chain(&one.rotate_keys));
        let keys = tracks.chain(reaches);
        let mut last = keys.map(|key| key.at.value).fold(lasting, f64::max);
        for curve in written.track.iter().filter_map(|track| track.curve.as_ref()) {
            let curve = self.curve_of(curve)?;
            last = last.max(curve.evaluate(curve.domain().end, Side::Before).point.x);
        }
        let duration = written.duration.map_or(last, |duration| duration.value);
        // Shorter than a frame of any player.
        if duration >= 1e-3 {
            return Some(duration);
        }
        let place = written.duration.map_or(span, |duration| duration.span);
        let message = format!("this clip lasts {} s", show(duration));
        let report = Diagnostic::error(Code::NoTime, message).at(place, "no time to move in");
        self.report(report.help(if written.duration.is_some() {
            "write a `duration` of at least 0.001 s"
        } else {
            "write a `duration`, or a key after the first"
        }));
        None
    }

    fn check_samples(&mut self, written: &spec::Clip, duration: f64, span: Span) -> Option<()> {
        let moving = written.track.len()
            + self.aims.len()
            + self.model.skeletons.iter().map(|s| s.skeleton.joints.len()).sum::<usize>();
        let samples = floor_large(duration * written.rate.value) * (moving as u64 + 8);
        if samples <= MOST_SAMPLES {
            return Some(());
        }
        let message = format!("this clip needs {samples} samples, and the limit is {MOST_SAMPLES}");
        let report = Diagnostic::error(Code::LimitPassed, message).at(span, "too long for its `rate`");
        self.report(report.help("write a shorter clip, or a lower `rate`"));
        None
    }

    fn track(
        &mut self,
        clip: &spec::Clip,
        track: &Sp<spec::ClipTrack>,
        duration: f64,
    ) -> Option<Vec<ClipTrack>> {
        let targets = self.targets(clip, track)?;
        let mut made = Vec::new();
        for (target, share) in targets {
            let joint = matches!(target, Target::Joint { .. });
            let moved = Moved { joint, share, duration, looped: clip.r#loop.value, color: false };
            for course in self.courses(track, &moved)? {
                let space = match (joint, track.along.is_some()) {
                    (true, _) => Space::Rest,
                    (false, true) => Space::File,
                    (false, false) => Space::Document,
                };
                let mut one = ClipTrack { target, course, space, clamp: None };
                self.check_slides(&one, track)?;
                if clip.limits.value == LimitRule::Clamp {
                    one.clamp = self.joint(target).map(|joint| (joint.bone.limits, joint.bone.slide));
                }
                made.push(one);
            }
        }
        Some(made)
    }

    fn joint(&self, target: Target) -> Option<&crate::motion::Joint> {
        let Target::Joint { skeleton, joint } = target else { return None };
        self.model.skeletons.get(skeleton)?.skeleton.joints.get(joint)
    }

    fn targets(&mut self, clip: &spec::Clip, track: &spec::ClipTrack) -> Option<Targets> {
        if let Some(morph) = &track.morph {
            let targets = self.weight_targets(morph, track)?;
            return Some(targets.into_iter().map(|target| (target, 0.0)).collect());
        }
        if let Some(node) = &track.node {
            let index = self.spec.nodes.get_index_of(&node.value.0)?;
            return Some(vec![(Target::Node(index), 0.0)]);
        }
        let name = track.joint.as_ref().or(track.chain.as_ref())?;
        let skeleton = self.clip_skeleton(clip, name)?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let target = |joint: usize| Target::Joint { skeleton, joint };
        if track.joint.is_some() {
            if let Some(joint) = bones.find(&name.value) {
                return Some(vec![(target(joint), 0.0)]);
            }
            let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
            self.report(unknown_joint(name, known, "joint"));
            return None;
        }
        let own = &self.spec.skeletons.get(&self.model.skeletons[skeleton].name)?.value;
        let joints = chain_joints(&bones, &name.value);
        if joints.is_empty() {
            let known: Vec<&str> = own.chain.keys().map(String::as_str).collect();
            self.report(unknown_joint(name, known.into_iter(), "chain"));
            return None;
        }
        let last = (joints.len() - 1).max(1) as f64;
        Some(joints.iter().enumerate().map(|(k, joint)| (target(*joint), k as f64 / last)).collect())
    }

    /// The skeleton that a clip names, or the only one.
    pub(super) fn clip_skeleton(&mut self, clip: &spec::Clip, joint: &Sp<String>) -> Option<usize> {
        self.skeleton_of(clip.skeleton.as_ref(), joint)
    }

    /// The skeleton that is named, or the only one.
    pub(super) fn skeleton_of(
        &mut self,
        named: Option<&Sp<spec::SkeletonName>>,
        joint: &Sp<String>,
    ) -> Option<usize> {
        if let Some(skeleton) = named {
            return self.named_skeleton(&skeleton.value.0);
        }
        match self.spec.skeletons.len() {
            1 => (!self.model.skeletons.is_empty()).then_some(0),
            0 => {
                self.report(unknown_joint(joint, std::iter::empty(), "joint"));
                None
            }
            _ => {
                let names: Vec<&str> = self.spec.skeletons.keys().map(String::as_str).collect();
                let report = Diagnostic::error(Code::MissingField, "missing field `skeleton`")
                    .at(joint.span, "a joint of which one?")
                    .note(format!("skeletons: {}", names.join(", ")));
                self.report(report);
                None
            }
        }
    }

    /// One part of a node or joint has one track.
    fn check_alone(&mut self, one: &ClipTrack, span: Span, before: &[(ClipTrack, Span)]) -> bool {
        let path = one.course.path();
        let same = |other: &&(ClipTrack, Span)| other.0.target == one.target && other.0.course.path() == path;
        let Some((_, first)) = before.iter().find(same) else { return true };
        let message = format!("the {} of `{}` has two tracks", word(path), self.target_name(one.target));
        let report = Diagnostic::error(Code::BadTrack, message)
            .at(span, "moved once more")
            .also(*first, "moved here")
            .help("write one track, or let a node or joint between them carry the second motion");
        self.report(report);
        false
    }

    /// The weights of a node are written together, and together they jump from key to key or run.
    fn check_weights(&mut self, tracks: &[(ClipTrack, Span)]) -> bool {
        let of = |track: &ClipTrack| match track.target {
            Target::Weight { node, .. } => Some((node, track.course.stepped())),
            _ => None,
        };
        let mixed = tracks.iter().enumerate().find_map(|(index, (track, span))| {
            let (node, stepped) = of(track)?;
            let other = tracks[..index].iter().find(|(other, _)| of(other) == Some((node, !stepped)))?;
            Some((track.target, *span, other.1))
        });
        let Some((target, span, other)) = mixed else { return true };
        let message = format!("some weights of `{}` step and others run", self.target_name(target));
        let report = Diagnostic::error(Code::MixedWeights, message)
            .at(span, "this one goes another way")
            .also(other, "than this")
            .note("glTF keeps the weights of a mesh in one track")
            .help("write `between = \"step\"` for all of them, or two keys close together for a jump");
        self.report(report);
        false
    }

    fn target_name(&self, target: Target) -> String {
        match target {
            Target::Node(node) | Target::Weight { node, .. } => {
                self.model.nodes.get(node).map_or(String::new(), |node| node.name.clone())
            }
            Target::Joint { .. } => self.joint(target).map_or(String::new(), |joint| joint.bone.name.clone()),
        }
    }

    /// Joints slide along the axes that have ranges; the root goes anywhere unless it has some.
    fn check_slides(&mut self, one: &ClipTrack, track: &Sp<spec::ClipTrack>) -> Option<()> {
        let joint = self.joint(one.target).filter(|_| one.course.path() == Path::Translation);
        let Some(joint) = joint else { return Some(()) };
        let fixed = joint.bone.parent.is_some() && joint.bone.slide.iter().all(Option::is_none);
        if !fixed {
            return Some(());
        }
        let message = format!("joint `{}` does not slide", joint.bone.name);
        let report = Diagnostic::error(Code::BadTrack, message)
            .at(track.path.as_ref().map_or(track.span, |path| path.span), "moved")
            .help("write `slide = { y = [least, most] }` for the joint, or turn it");
        self.report(report);
        None
    }

    fn check_events(&mut self, written: &spec::Clip, duration: f64) -> bool {
        let late = written.event.iter().find(|event| event.at.value > duration * (1.0 + 1e-9));
        if let Some(event) = late {
            let message = format!(
                "event \"{}\" at {} s lies beyond the end of the clip at {} s",
                event.name.value,
                show(event.at.value),
                show(duration)
            );
            self.report(Diagnostic::error(Code::KeyOrder, message).at(event.at.span, "never reached"));
        }
        late.is_none()
    }

    /// Every pose lies within the limits of its joints; of each track the worst moment is told.
    fn check_limits(&mut self, tracks: &[(ClipTrack, Span)], duration: f64) -> Option<()> {
        let mut reports = Vec::new();
        for (track, span) in tracks {
            let Some(joint) = self.joint(track.target) else { continue };
            let playing = Track::new(&track.course);
            let value = |time: f64| track.converted(playing.at(time), &self.model.frame);
            let times = times(&track.course, duration);
            reports.extend(match track.course.path() {
                Path::Rotation => {
                    turned_too_far(joint, &times, value).map(|report| report.at(*span, "this track"))
                }
                Path::Translation => slid_too_far(joint, &times, value, self.model.frame.unit)
                    .map(|report| report.at(*span, "this track")),
                Path::Scale | Path::Weight => None,
            });
        }
        let good = reports.is_empty();
        let help = "keep it within the range, widen the range, or write `limits = \"clamp\"` for the clip";
        self.reports.extend(reports.into_iter().map(|report| report.help(help)));
        good.then_some(())
    }

    /// A loop ends as it begins.
    fn check_loop(&mut self, tracks: &[(ClipTrack, Span)], clip: &spec::Clip, duration: f64) -> Option<()> {
        let mut reports = Vec::new();
        for (track, span) in tracks {
            let playing = Track::new(&track.course);
            let (first, last) = (playing.at(0.0), playing.at(duration));
            let Some(gap) = seam_gap(track.course.path(), first, last) else { continue };
            let (name, path) = (self.target_name(track.target), word(track.course.path()));
            let message =
                format!("this clip is a loop, but the {path} of `{name}` ends {gap} from where it begins");
            let report = Diagnostic::error(Code::LoopSeam, message)
                .at(*span, "this track")
                .also(clip.r#loop.span, "played again and again")
                .help("end with the value of the start, or leave `loop` out");
            reports.push(report);
        }
        let good = reports.is_empty();
        self.reports.extend(reports);
        good.then_some(())
    }
}

fn word(path: Path) -> &'static str {
    match path {
        Path::Translation => "translation",
        Path::Rotation => "rotation",
        Path::Scale => "scale",
        Path::Weight => "weight",
    }
}

/// Times at which limits are held against a track: 240 a second, and where it bends.
pub(super) fn times(course: &Course, duration: f64) -> Vec<f64> {
    let count = crate::geometry::number::floor_count((duration * 240.0).ceil()).clamp(64, 1 << 20);
    let even = (0..=count).map(|k| duration * f64::from(k) / f64::from(count));
    even.chain(course.stops().into_iter().filter(|time| (0.0..=duration).contains(time))).collect()
}

fn turned_too_far(
    joint: &crate::motion::Joint,
    times: &[f64],
    value: impl Fn(f64) -> DVec4,
) -> Option<Diagnostic> {
    let held = |time: &f64| {
        let found = joint.bone.limits.hold(DQuat::from_vec4(value(*time)).normalize());
        found.err().map(|excess| (*time, excess))
    };
    let beyond = times.iter().filter_map(held);
    let worst = beyond.max_by(|a, b| {
        (a.1.angle - a.1.limit).abs().total_cmp(&(b.1.angle - b.1.limit).abs()).then(b.0.total_cmp(&a.0))
    });
    let (time, excess) = worst?;
    let message = format!(
        "joint `{}` turns to {} degrees about its {} axis at {} s, and its limit is {}",
        joint.bone.name,
        show(excess.angle),
        excess.axis.letter(),
        show(time),
        show(excess.limit)
    );
    Some(Diagnostic::error(Code::BeyondLimit, message))
}

fn slid_too_far(
    joint: &crate::motion::Joint,
    times: &[f64],
    value: impl Fn(f64) -> DVec4,
    unit: f64,
) -> Option<Diagnostic> {
    if joint.bone.slide.iter().all(Option::is_none) {
        return None;
    }
    let range = |axis: Axis| joint.bone.slide[axis as usize].unwrap_or(crate::motion::Range::NONE);
    let rounding = 1e-9 * (1.0 + joint.length());
    let held = |time: &f64| {
        let place: DVec3 = value(*time).truncate();
        let worst = Axis::ALL.into_iter().map(|axis| (range(axis).excess(place[axis as usize]), axis));
        let (excess, axis) = worst.max_by(|a, b| a.0.total_cmp(&b.0))?;
        (excess > rounding).then(|| (excess, *time, axis, place[axis as usize]))
    };
    let worst = times.iter().filter_map(held).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let (_, time, axis, found) = worst?;
    let limit = if found > range(axis).most { range(axis).most } else { range(axis).least };
    let message = format!(
        "joint `{}` slides to {} along its {} axis at {} s, and its limit is {}",
        joint.bone.name,
        show(found / unit),
        axis.letter(),
        show(time),
        show(limit / unit)
    );
    Some(Diagnostic::error(Code::BeyondLimit, message))
}

/// How far the end of a loop is from its start, in words; none where they agree.
pub(super) fn seam_gap(path: Path, first: DVec4, last: DVec4) -> Option<String> {
    if path == Path::Rotation {
        let apart = first.distance(last).min(first.distance(-last));
        let degrees = (2.0 * crate::geometry::number::asin((apart / 2.0).min(1.0)) * 2.0).to_degrees();
        return (degrees > 1e-3).then(|| format!("{} degrees", show(degrees)));
    }
    let apart = first.distance(last);
    (apart > 1e-6 * (1.0 + first.length())).then(|| show(apart))
}
