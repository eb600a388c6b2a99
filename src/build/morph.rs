//! States of the document's shapes.

use super::{Builder, StateModel};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, MorphName, Sp, closest};
use crate::model::{Morph, ShapeHandle, State, Target};

impl Builder<'_> {
    pub(super) fn morphs(&mut self, states: &[StateModel]) {
        let spec = self.spec;
        for (name, definition) in &spec.morphs {
            let Some(shape) = self.named_shape(name) else { continue };
            self.check_shown(name, shape, definition.name.span);
            for (target, morph) in &definition.value {
                let Some(state) = self.state(name, shape, morph, states) else { continue };
                let (name, weight) = (target.clone(), morph.weight.value);
                self.model.morphs.push(Morph { name, shape, weight, state });
                self.morph_places.push(morph.span);
            }
        }
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
        let Some(known) = self.spec.morphs.get(shape) else {
            let names = self.spec.morphs.keys().map(String::as_str);
            self.report(unknown(morph, &format!("no morph of a shape `{shape}`"), shape, names));
            return None;
        };
        let Some(target) = known.value.get_index_of(target) else {
            let names = known.value.keys().map(String::as_str);
            self.report(unknown(morph, &format!("no state `{target}` of `{shape}`"), target, names));
            return None;
        };
        let handle = self.named_shape(shape)?;
        let only = track.node.as_ref().and_then(|node| self.spec.nodes.get_index_of(&node.value.0));
        let shows = |node: &usize| self.model.nodes[*node].shape == Some(handle);
        let nodes: Vec<usize> = (0..self.model.nodes.len())
            .filter(shows)
            .filter(|node| only.is_none_or(|only| only == *node))
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

fn unknown<'n>(
    morph: &Sp<MorphName>,
    what: &str,
    part: &str,
    names: impl Iterator<Item = &'n str> + Clone,
) -> Diagnostic {
    let report =
        Diagnostic::error(Code::UnknownName, format!("there is {what}")).at(morph.span, "not defined");
    let known: Vec<&str> = names.clone().collect();
    match closest(part, names) {
        Some(near) => report.help(format!("did you mean `{near}`?")),
        None if known.is_empty() => report.note("this document defines no morph"),
        None => report.note(format!("there is: {}", known.join(", "))),
    }
}
