//! States of the document's shapes.

use super::skeleton::unknown_joint;
use super::{Builder, StateModel};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, MorphName, Sp, closest};
use crate::model::{ClipTrack, Driver, Morph, ShapeHandle, Space, State, Target};
use crate::motion::{Axis, Course, Path, Ramp};

/// The most names that are listed.
const LISTED: usize = 12;

impl Builder<'_> {
    pub(super) fn morphs(&mut self, states: &[StateModel]) {
        let spec = self.spec;
        for (name, definition) in &spec.morphs {
            let Some(shape) = self.named_shape(name) else { continue };
            self.check_shown(name, shape, definition.name.span);
            for (target, morph) in &definition.value {
                let Some(state) = self.state(name, shape, morph, states) else { continue };
                if self.model.morphs_of(shape).any(|known| known.name == *target) {
                    let message = format!("state `{target}` of shape `{name}` is defined twice");
                    let report = Diagnostic::error(Code::DuplicateName, message)
                        .at(morph.span, "here")
                        .also(definition.name.span, "and as a frame of the shape's file")
                        .help("give it another name");
                    self.report(report);
                    continue;
                }
                let driver = match &morph.driver {
                    Some(driver) => match self.driver(driver) {
                        Some(driver) => Some(driver),
                        None => continue,
                    },
                    None => None,
                };
                let (name, weight) = (target.clone(), morph.weight.value);
                self.model.morphs.push(Morph { name, shape, weight, driver, state });
                self.morph_places.push(morph.span);
            }
        }
    }

    /// The joint that drives a state.
    fn driver(&mut self, written: &spec::MorphDriver) -> Option<Driver> {
        let skeleton = self.skeleton_of(written.skeleton.as_ref(), &written.joint)?;
        let bones = &self.model.skeletons[skeleton].skeleton;
        let Some(joint) = bones.find(&written.joint.value) else {
            let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
            let report = unknown_joint(&written.joint, known, "joint");
            self.report(report);
            return None;
        };
        let axis = match written.axis.value {
            spec::DriverAxis::X => Axis::X,
            spec::DriverAxis::Y => Axis::Y,
            spec::DriverAxis::Z => Axis::Z,
        };
        let ramp = Ramp { axis, from: written.from.value, to: written.to.value };
        Some(Driver { skeleton, joint, ramp })
    }

    /// The weights that joints drive in a clip that turns them: a track for each node that shows the shape.
    pub(super) fn driven(&self, tracks: &[(ClipTrack, Span)]) -> Vec<(ClipTrack, Span)> {
        let mut all = Vec::new();
        let mut counts: Vec<(ShapeHandle, usize)> = Vec::new();
        for morph in &self.model.morphs {
            // The number of the state among those of its shape.
            let place = counts.iter().position(|(shape, _)| *shape == morph.shape).unwrap_or_else(|| {
                counts.push((morph.shape, 0));
                counts.len() - 1
            });
            let target = counts[place].1;
            counts[place].1 += 1;
            let Some(driver) = &morph.driver else { continue };
            let joint = Target::Joint { skeleton: driver.skeleton, joint: driver.joint };
            let turns = |track: &&(ClipTrack, Span)| {
                track.0.target == joint && track.0.course.path() == Path::Rotation
            };
            let Some((turning, span)) = tracks.iter().find(turns) else { continue };
            let limits = turning.clamp.as_ref().map(|(limits, _)| *limits);
            let course = Course::Driven { of: Box::new(turning.course.clone()), limits, ramp: driver.ramp };
            let shows =
                (0..self.model.nodes.len()).filter(|node| self.model.nodes[*node].shape == Some(morph.shape));
            all.extend(shows.map(|node| {
                let target = Target::Weight { node, target };
                (ClipTrack { target, course: course.clone(), space: Space::Document, clamp: None }, *span)
            }));
        }
        all
    }

    fn state(
        &mut self,
        name: &str,
        base: ShapeHandle,
        morph: &spec::Morph,
        states: &[StateModel],
    ) -> Option<State> {
        if let Some(other) = &morph.shape {
            let shape = self.named_shape(&other.value.0)?;
            if shape != base {
                return Some(State::Shape(shape));
            }
            let report = Diagnostic::error(Code::BadMorph, format!("a state of `{name}` is `{name}` itself"))
                .at(other.span, "nothing moves")
                .help("name another shape, or write `with` for other parameters");
            self.report(report);
            return None;
        }
        let model = states.iter().position(|state| state.with == morph.with)?;
        let shape = *states[model].built.shapes.get(name)?;
        Some(State::Other { model, shape })
    }

    /// A shape that morphs is shown by some node, as itself.
    fn check_shown(&mut self, name: &str, shape: ShapeHandle, span: Span) {
        if self.model.nodes.iter().any(|node| node.shape == Some(shape)) {
            return;
        }
        let report =
            Diagnostic::error(Code::BadMorph, format!("no node shows the shape `{name}` that morphs"))
                .at(span, "never shown")
                .note("a shape that is part of another one does not morph")
                .help(format!(
                    "write `[node.{name}]` with `shape = \"{name}\"`, or let the whole shape morph"
                ));
        self.report(report);
    }

    /// What a track of a weight moves: the target at each node that shows the shape, or at the one that it names.
    pub(super) fn weight_targets(
        &mut self,
        morph: &Sp<MorphName>,
        track: &spec::ClipTrack,
    ) -> Option<Vec<Target>> {
        let MorphName { shape, target } = &morph.value;
        let known = self.spec.shapes.contains_key(shape).then(|| self.named_shape(shape));
        // A shape that could not be built was told.
        let handle = known.map_or(Some(None), |built| built.map(Some))?;
        let morphs: Vec<&Morph> =
            handle.into_iter().flat_map(|handle| self.model.morphs_of(handle)).collect();
        let (Some(handle), false) = (handle, morphs.is_empty()) else {
            let mut names: Vec<&str> =
                self.model.morphs.iter().map(|morph| self.model.shape(morph.shape).name.as_str()).collect();
            names.dedup();
            let report = unknown(morph, &format!("no morph of a shape `{shape}`"), shape, &names);
            self.report(report);
            return None;
        };
        let names: Vec<&str> = morphs.iter().map(|morph| morph.name.as_str()).collect();
        let Some(target) = names.iter().position(|name| name == target) else {
            let report = unknown(morph, &format!("no state `{target}` of `{shape}`"), target, &names);
            self.report(report);
            return None;
        };
        let only = track.node.as_ref().and_then(|node| self.spec.nodes.get_index_of(&node.value.0));
        let shows = |node: &usize| self.model.nodes[*node].shape == Some(handle);
        let nodes: Vec<usize> = (0..self.model.nodes.len())
            .filter(shows)
            .filter(|node| {
                let own = &self.model.nodes[*node];
                only.is_none_or(|only| only == *node || (own.is_copy && own.parent == Some(only)))
            })
            .collect();
        if let (Some(node), true) = (&track.node, nodes.is_empty()) {
            let message = format!("node `{}` does not show the shape `{shape}`", node.value.0);
            let report = Diagnostic::error(Code::BadMorph, message)
                .at(node.span, "shows something else")
                .also(morph.span, "a state of that shape");
            self.report(report);
            return None;
        }
        Some(nodes.into_iter().map(|node| Target::Weight { node, target }).collect())
    }
}

fn unknown(morph: &Sp<MorphName>, what: &str, part: &str, known: &[&str]) -> Diagnostic {
    let report =
        Diagnostic::error(Code::UnknownName, format!("there is {what}")).at(morph.span, "not defined");
    match closest(part, known.iter().copied()) {
        Some(near) => report.help(format!("did you mean `{near}`?")),
        None if known.is_empty() => report.note("this document defines no morph"),
        None => report.note(format!("there is: {}", known[..known.len().min(LISTED)].join(", "))),
    }
}
