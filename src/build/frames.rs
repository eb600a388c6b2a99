//! Frames of files: states of the shapes that show them, clips of their sequences, and nodes of their tags.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use super::Builder;
use super::import::{axes_between, default_up, has_frames, is_gltf};
use crate::geometry::mesh;
use crate::geometry::number::single;
use crate::import::keyframes::{Keyframes, Sequence};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Import, Shape as Kind, Sp, closest, kebab};
use crate::model::{Clip, ClipTrack, Morph, Node, Recipe, Shape, ShapeHandle, Space, State, Target};
use crate::motion::{Course, Interpolation, Keys, Law};

/// The most keys of all sequences of a file, times the frames that each has a weight for.
const MOST_WEIGHTS: usize = 8_000_000;

/// A shape whose file has frames.
pub(super) struct Played<'a> {
    shape: ShapeHandle,
    import: &'a Import,
    sequences: Vec<Sequence>,
    /// For each frame of the file its target; none for the one that is the shape.
    targets: Vec<Option<usize>>,
    /// Nodes that move with the frames, each with its place in every frame.
    tags: Vec<(usize, Vec<Place>)>,
    span: Span,
}

/// Where a tag is, in the document's unit and axes.
#[derive(Clone, Copy)]
struct Place {
    translation: DVec3,
    rotation: DQuat,
}

impl<'a> Builder<'a> {
    /// The number of the frame that an import names; the first where it names none.
    pub(super) fn frame_of(&mut self, import: &Import, found: &Keyframes) -> Option<usize> {
        let Some(name) = &import.frame else { return Some(0) };
        let named = found.frames.iter().position(|frame| frame.name == name.value);
        if named.is_none() {
            let message = format!("{} has no frame `{}`", import.file.value.written, name.value);
            let report = Diagnostic::error(Code::UnknownPart, message).at(name.span, "no such frame");
            let names = found.frames.iter().map(|frame| frame.name.as_str());
            let first = names.clone().next().unwrap_or_default();
            self.report(match closest(&name.value, names) {
                Some(near) => report.help(format!("did you mean `{near}`?")),
                None => report.note(format!("it has {} frames; the first is `{first}`", found.frames.len())),
            });
        }
        named
    }

    /// Makes the frames and morph targets of files states of the shapes that nodes show.
    pub(super) fn frames(&mut self) -> Vec<Played<'a>> {
        let spec = self.spec;
        let mut all = Vec::new();
        for (name, definition) in &spec.shapes {
            let Kind::Import(import) = &definition.value.kind else { continue };
            let Some(shape) = self.shapes.get(name).copied().flatten() else { continue };
            if self.showing(shape).is_empty() {
                continue;
            }
            if has_frames(&import.file) {
                all.extend(self.frames_of(name, shape, import, definition.span));
            } else if is_gltf(&import.file) {
                self.file_states(name, shape, import, definition.span);
            }
        }
        all
    }

    /// The nodes that show a shape.
    pub(super) fn showing(&self, shape: ShapeHandle) -> Vec<usize> {
        (0..self.model.nodes.len()).filter(|node| self.model.nodes[*node].shape == Some(shape)).collect()
    }

    /// A state of a shape from a file, which is a shape that nothing shows.
    pub(super) fn push_state(
        &mut self,
        (shape, span): (ShapeHandle, Span),
        (name, target): (&str, String),
        recipe: Recipe,
        weight: f64,
    ) {
        let handle = ShapeHandle(mesh::index(self.model.shapes.len()));
        let options = self.model.shape(shape).options.clone();
        self.model.shapes.push(Shape { name: format!("{name}.{target}"), recipe, options });
        self.places.push(span);
        self.faces.push(Vec::new());
        let state = State::Shape(handle);
        self.model.morphs.push(Morph { name: target, shape, weight, driver: None, state });
        self.morph_places.push(span);
    }

    fn frames_of(
        &mut self,
        name: &str,
        shape: ShapeHandle,
        import: &'a Import,
        span: Span,
    ) -> Option<Played<'a>> {
        // The shape was read, so that this succeeds again.
        let found = self.read_keyframes(import)?;
        let own = self.frame_of(import, &found)?;
        let sequences = self.sequences_of(import, &found)?;
        let axes =
            axes_between(import.up.map_or_else(|| default_up(&import.file), |up| up.value), self.spec.up);
        let map = DAffine3::from_mat3(axes * import.scale.value);
        let base = self.model.shape(shape).clone();
        let tags = self.tags_of(&found, own, (shape, axes, import.scale.value));
        if import.frames.value == spec::Frames::One {
            return None;
        }
        let Recipe::Polygons { materials, .. } = base.recipe else { return None };
        let mut names: Vec<String> = Vec::with_capacity(found.frames.len());
        let mut targets = Vec::with_capacity(found.frames.len());
        for (number, frame) in found.frames.iter().enumerate() {
            let target = unique(&frame.name, number, "frame", &names);
            names.push(target.clone());
            if number == own {
                targets.push(None);
                continue;
            }
            targets.push(Some(targets.iter().flatten().count()));
            let mut mesh = found.at(number);
            mesh.transform(&map);
            let recipe = Recipe::Polygons { mesh, materials: materials.clone() };
            self.push_state((shape, span), (name, target), recipe, 0.0);
        }
        Some(Played { shape, import, sequences, targets, tags, span })
    }

    /// Makes a node of each tag below each node that shows the shape.
    fn tags_of(
        &mut self,
        found: &Keyframes,
        own: usize,
        (shape, axes, scale): (ShapeHandle, DMat3, f64),
    ) -> Vec<(usize, Vec<Place>)> {
        let placement = self.model.shape(shape).options.placement;
        let (_, turn, _) = placement.to_scale_rotation_translation();
        let into = turn * DQuat::from_mat3(&axes);
        let place = |place: &DAffine3| Place {
            translation: placement.transform_point3(axes * place.translation * scale),
            rotation: (into * DQuat::from_mat3(&place.matrix3) * into.conjugate()).normalize(),
        };
        let mut all = Vec::new();
        for parent in self.showing(shape) {
            for (number, tag) in found.tags.iter().enumerate() {
                let taken: Vec<String> = self.model.nodes.iter().map(|node| node.name.clone()).collect();
                let name = kebab(&tag.name).unwrap_or_else(|| format!("tag-{}", number + 1));
                let longer = format!("{}.{name}", self.model.nodes[parent].name);
                let name = if taken.contains(&name) { numbered(longer, &taken) } else { name };
                let places: Vec<Place> = tag.places.iter().map(place).collect();
                let Place { translation, rotation } = places[own];
                all.push((self.model.nodes.len(), places));
                self.model.nodes.push(Node {
                    name,
                    shape: None,
                    material: None,
                    parent: Some(parent),
                    socket: None,
                    is_socket: true,
                    is_copy: false,
                    camera: None,
                    light: None,
                    translation,
                    rotation,
                    scale: DVec3::ONE,
                });
            }
        }
        all
    }

    fn sequences_of(&mut self, import: &Import, found: &Keyframes) -> Option<Vec<Sequence>> {
        if import.sequences.value == spec::Sequences::Named {
            return Some(found.sequences());
        }
        let standard = found.standard_sequences();
        if standard.is_none() {
            let message = format!(
                "{} has {} frames, and the standard sequences 198, or 199 with the last",
                import.file.value.written,
                found.frames.len()
            );
            let report = Diagnostic::error(Code::UnknownPart, message)
                .at(import.sequences.span, "not those of a player")
                .help("leave `sequences` out: they are told by the names of their frames");
            self.report(report);
        }
        standard
    }

    /// Makes a clip of each sequence. Files whose sequences have one name, as a body and what it holds in its hands, share
    /// the clip.
    pub(super) fn sequence_clips(&mut self, all: Vec<Played<'_>>) {
        let written = self.model.clips.len();
        for played in all {
            let keys: usize = played.sequences.iter().map(|sequence| sequence.frames.len() + 1).sum();
            let weights = keys.saturating_mul(played.targets.len());
            if weights > MOST_WEIGHTS {
                let message = format!(
                    "the sequences of this file need {weights} weights, and the limit is {MOST_WEIGHTS}"
                );
                let report =
                    Diagnostic::error(Code::LimitPassed, message).at(played.import.file.span, "too many");
                self.report(report.help("write `frames = \"one\"`, or split the file"));
                continue;
            }
            let mut known: Vec<String> = Vec::with_capacity(played.sequences.len());
            for sequence in &played.sequences {
                known.push(unique(&sequence.name, sequence.frames.start, "frame", &known));
            }
            if let Some(name) = played.import.r#loop.iter().find(|name| !known.contains(&name.value)) {
                self.report(unknown_sequence(name, &known));
            }
            for (sequence, name) in played.sequences.iter().zip(&known) {
                self.sequence_clip(&played, sequence, name, written);
            }
        }
    }

    fn sequence_clip(&mut self, played: &Played<'_>, sequence: &Sequence, name: &str, written: usize) {
        let looped = played.import.r#loop.iter().any(|loops| loops.value == *name);
        let mut order: Vec<usize> = sequence.frames.clone().collect();
        if looped || order.len() == 1 {
            order.push(sequence.frames.start);
        }
        let rate = played.import.frame_rate.value;
        let times: Vec<f64> = (0..order.len()).map(|k| f64::from(single(k as f64 / rate))).collect();
        let duration = times[times.len() - 1];
        let nodes = self.showing(played.shape);
        let mut moved: Vec<usize> = order.iter().filter_map(|frame| played.targets[*frame]).collect();
        moved.sort_unstable();
        moved.dedup();
        if moved.is_empty() {
            // The shape as it is: some weight stays 0 for as long.
            moved.extend(played.targets.iter().flatten().take(1));
        }
        let mut tracks = Vec::new();
        for target in moved {
            let value =
                |frame: &usize| if played.targets[*frame] == Some(target) { DVec4::X } else { DVec4::ZERO };
            let values = order.iter().map(value).collect();
            let keys = Keys::new((times.clone(), values), &[], Interpolation::Linear, looped);
            for node in &nodes {
                let course = Course::Weight(Law::Keys(keys.clone()));
                let target = Target::Weight { node: *node, target };
                tracks.push(ClipTrack { target, course, space: Space::Document, clamp: None });
            }
        }
        for (node, places) in &played.tags {
            let courses = tag_courses(&self.model.nodes[*node], places, (&order, &times), looped);
            let (target, space, clamp) = (Target::Node(*node), Space::Document, None);
            tracks.extend(courses.into_iter().map(|course| ClipTrack { target, course, space, clamp }));
        }
        if tracks.is_empty() {
            return;
        }
        let same = self.model.clips.iter().position(|clip| clip.name == name);
        match same {
            None => {
                self.model.clips.push(Clip::of_file(name.to_owned(), duration, looped, tracks));
                self.clip_places.push(played.span);
            }
            Some(index) if index >= written => {
                let clip = &mut self.model.clips[index];
                clip.duration = clip.duration.max(duration);
                clip.looped &= looped;
                clip.tracks.extend(tracks);
            }
            Some(index) => {
                let report =
                    Diagnostic::error(Code::DuplicateName, format!("clip `{name}` is defined twice"))
                        .at(self.clip_places[index], "here")
                        .also(played.import.file.span, "and as a sequence of this file")
                        .help("give the clip another name, or write `frames = \"one\"` for the file");
                self.report(report);
            }
        }
    }
}

/// How a tag moves through some frames, where it does.
fn tag_courses(
    rest: &Node,
    places: &[Place],
    (order, times): (&[usize], &[f64]),
    looped: bool,
) -> Vec<Course> {
    let mut courses = Vec::new();
    let moved = |frame: &usize| (places[*frame].translation - rest.translation).extend(0.0);
    let values: Vec<DVec4> = order.iter().map(moved).collect();
    if values.iter().any(|value| *value != DVec4::ZERO) {
        let keys = Keys::new((times.to_vec(), values), &[], Interpolation::Linear, looped);
        courses.push(Course::Offset(Law::Keys(keys)));
    }
    let turned = |frame: &usize| (rest.rotation.conjugate() * places[*frame].rotation).normalize();
    if order.iter().any(|frame| places[*frame].rotation != rest.rotation) {
        let rotations: Vec<DQuat> = order.iter().map(turned).collect();
        courses.push(Course::rotations(times.to_vec(), &rotations, Interpolation::Linear, looped));
    }
    courses
}

/// A name in kebab-case, with a number where another has it; of letters that make none, a word with its number.
pub(super) fn unique(name: &str, number: usize, word: &str, taken: &[String]) -> String {
    numbered(kebab(name).unwrap_or_else(|| format!("{word}-{}", number + 1)), taken)
}

/// A name, with a number where another has it.
fn numbered(name: String, taken: &[String]) -> String {
    if !taken.contains(&name) {
        return name;
    }
    let numbered = |k: usize| format!("{name}-{k}");
    (2..).map(numbered).find(|name| !taken.contains(name)).unwrap_or(name)
}

fn unknown_sequence(name: &Sp<String>, known: &[String]) -> Diagnostic {
    let message = format!("the file has no sequence `{}`", name.value);
    let report = Diagnostic::error(Code::UnknownPart, message).at(name.span, "no such sequence");
    match closest(&name.value, known.iter().map(String::as_str)) {
        Some(near) => report.help(format!("did you mean `{near}`?")),
        None => report.note(format!("its sequences: {}", known.join(", "))),
    }
}
