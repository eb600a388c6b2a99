//! Attributes of vertices into recipes.

use super::formula::Compiler;
use super::skeleton::unknown_joint;
use super::{Builder, placement};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Formula, Sp};
use crate::model::{Attribute, ShapeHandle};

/// What formulas of attributes speak of.
const VARIABLES: [&str; 9] = ["x", "y", "z", "nx", "ny", "nz", "u", "v", "weight"];

impl Builder<'_> {
    /// Attributes of the shapes that nodes show, once skins are there.
    pub(super) fn attributes(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.shapes {
            let options = &definition.value.options;
            let Some((first, written)) = options.attributes.0.first() else { continue };
            let Some(shape) = self.named_shape(name) else { continue };
            if !self.model.nodes.iter().any(|node| node.shape == Some(shape)) {
                let message =
                    format!("no node shows shape `{name}`, so its attribute `{first}` is in no file");
                self.report(unseen(message, written.span));
                continue;
            }
            for (own, written) in &options.attributes.0 {
                let attribute = self.attribute((own, written), (shape, options));
                self.model.attributes.extend(attribute);
            }
        }
    }

    /// A shape written in place is a part of another: its attributes would be lost.
    pub(super) fn refuse_attributes(&mut self, options: &spec::ShapeOptions) {
        if let Some((name, written)) = options.attributes.0.first() {
            let message =
                format!("a shape written in place is a part of another, which has no `{name}` of it");
            self.report(unseen(message, written.span));
        }
    }

    fn attribute(
        &mut self,
        (name, written): (&str, &Sp<spec::Attribute>),
        (shape, options): (ShapeHandle, &spec::ShapeOptions),
    ) -> Option<Attribute> {
        let joint = match &written.value.joint {
            Some(joint) => Some(self.attribute_joint(joint, shape)?),
            None => None,
        };
        let weight = [Sp::from(Formula::Number(0.0))];
        let components = written.value.formula.as_ref().map_or(&weight[..], |formula| &formula.value.0);
        let of_weight = written.value.formula.is_none();
        let mut formulas = Vec::with_capacity(components.len());
        let mut wants_uv = false;
        for component in components {
            let mut compiler = Compiler::new(&VARIABLES);
            let slot = if of_weight {
                Ok(compiler.variable(8))
            } else {
                wants_uv |= self.speaks_of(component, &["u", "v"]);
                if joint.is_none() && self.speaks_of(component, &["weight"]) {
                    let message = format!("attribute `{name}` speaks of a `weight` and names no joint");
                    let report = Diagnostic::error(Code::MissingField, message)
                        .at(component.span, "whose weight?")
                        .help("write `{ formula = \"...\", joint = \"NAME\" }`");
                    self.report(report);
                    return None;
                }
                compiler.add(&component.value)
            };
            match slot {
                Ok(slot) => formulas.push(compiler.finish(vec![slot]).formula),
                Err(diagnostic) => {
                    self.report(*diagnostic);
                    return None;
                }
            }
        }
        if wants_uv && options.uv.value == spec::Uv::None {
            let message = format!("attribute `{name}` speaks of texture coordinates, and the shape has none");
            let report = Diagnostic::error(Code::Conflict, message)
                .at(written.span, "speaks of u or v")
                .also(options.uv.span, "no texture coordinates");
            self.report(report);
            return None;
        }
        let place = placement(options.scale.0, options.rotate.value, options.at.value);
        Some(Attribute {
            name: name.to_owned(),
            shape,
            formulas,
            space: (self.model.frame.map() * place).inverse(),
            joint,
            wants_uv,
            bytes: written.value.form.value == spec::AttributeForm::Byte,
        })
    }

    fn speaks_of(&self, formula: &Sp<Formula>, names: &[&str]) -> bool {
        match &formula.value {
            Formula::Number(_) => false,
            Formula::Varying(formula) => formula.variables().iter().any(|name| names.contains(name)),
        }
    }

    fn attribute_joint(&mut self, joint: &Sp<String>, shape: ShapeHandle) -> Option<usize> {
        let Some(skin) = self.model.skins.iter().find(|skin| skin.shape == shape) else {
            let message =
                format!("shape `{}` has no skin, so no joint carries it", self.model.shape(shape).name);
            let report = Diagnostic::error(Code::UnknownName, message)
                .at(joint.span, "a joint of what?")
                .help("write `[skin.NAME]` with this `shape` and a `skeleton`, or leave `joint` out");
            self.report(report);
            return None;
        };
        let bones = &self.model.skeletons[skin.skeleton].skeleton;
        let found = bones.find(&joint.value);
        if found.is_none() {
            let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
            let report = unknown_joint(joint, known, "joint");
            self.report(report);
        }
        found
    }
}

fn unseen(message: String, span: Span) -> Diagnostic {
    Diagnostic::error(Code::UnseenAttribute, message)
        .at(span, "this attribute")
        .help("write it on a shape of its own that a node shows")
}
