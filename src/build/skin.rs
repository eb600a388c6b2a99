//! Skins of a document.

use super::Builder;
use super::formula::Compiler;
use super::skeleton::unknown_joint;
use crate::geometry::field::{AnyField, Bump};
use crate::geometry::formula::Formula;
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Sp};
use crate::model::{Skin, WeightRule};
use crate::motion::Skeleton;

impl Builder<'_> {
    pub(super) fn skins(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.skins {
            if let Some(skin) = self.skin(name, &definition.value) {
                self.model.skins.push(skin);
                self.skin_places.push(definition.span);
            }
        }
        self.check_skinned_once();
        self.check_skinned_nodes();
    }

    fn skin(&mut self, name: &str, written: &spec::Skin) -> Option<Skin> {
        let shape = self.named_shape(&written.shape.value.0)?;
        let skeleton = self.named_skeleton(&written.skeleton.value.0)?;
        let bones = self.model.skeletons[skeleton].skeleton.clone();
        let chains = &self.spec.skeletons.get(&written.skeleton.value.0)?.value.chain;
        let given = written.weight.iter().map(|weight| &weight.joint);
        let given: Vec<&Sp<String>> = given.chain(written.bump.iter().map(|bump| &bump.joint)).collect();
        let named: Vec<&Sp<String>> =
            if given.is_empty() { written.joints.iter().collect() } else { given.clone() };
        let mut joints = Vec::new();
        for name in &named {
            let found = if chains.contains_key(&name.value) && given.is_empty() {
                chain_joints(&bones, &name.value)
            } else {
                bones.find(&name.value).into_iter().collect()
            };
            if found.is_empty() {
                let known = bones.joints.iter().map(|joint| joint.bone.name.as_str());
                self.report(unknown_joint(name, known, "joint"));
                return None;
            }
            joints.extend(found);
        }
        let rule = match written.weights.value {
            spec::WeightRule::Rigid => WeightRule::Rigid,
            spec::WeightRule::Envelope => WeightRule::Envelope,
            spec::WeightRule::Heat => WeightRule::Heat,
            spec::WeightRule::Imported => {
                let (carrying, rule) = self.file_weights(written, &bones)?;
                joints = carrying;
                rule
            }
            spec::WeightRule::Perturbation => {
                let bumps = self.skin_bumps(written, &joints)?;
                joints.sort_unstable();
                joints.dedup();
                let place = |joint: usize| joints.binary_search(&joint).unwrap_or(0);
                WeightRule::Perturbation(
                    bumps.into_iter().map(|(joint, bump)| (place(joint), bump)).collect(),
                )
            }
            spec::WeightRule::Explicit => {
                let formulas = self.weight_formulas(&written.weight)?;
                let mut pairs: Vec<(usize, Formula)> = joints.iter().copied().zip(formulas).collect();
                pairs.sort_by_key(|(joint, _)| *joint);
                if let Some(pair) = pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                    let name = &bones.joints[pair[0].0].bone.name;
                    let twice = written.weight.iter().rfind(|weight| weight.joint.value == *name);
                    let span = twice.map_or(Span::NONE, |weight| weight.joint.span);
                    let message = format!("the weight of joint `{name}` is written twice");
                    self.report(Diagnostic::error(Code::Conflict, message).at(span, "once more"));
                    return None;
                }
                joints = pairs.iter().map(|(joint, _)| *joint).collect();
                WeightRule::Explicit(pairs.into_iter().map(|(_, formula)| formula).collect())
            }
        };
        if joints.is_empty() {
            joints = (0..bones.joints.len()).collect();
        }
        joints.sort_unstable();
        joints.dedup();
        let smoothing = written.smoothing.value;
        Some(Skin { name: name.to_owned(), shape, skeleton, joints, rule, smoothing })
    }

    /// For each bump its joint, which was looked up, and what it is.
    fn skin_bumps(&mut self, written: &spec::Skin, joints: &[usize]) -> Option<Vec<(usize, Bump)>> {
        let fields: Vec<_> = written.bump.iter().map(|bump| self.field_of(&bump.field)).collect();
        let mut made = true;
        for (field, bump) in fields.iter().zip(&written.bump) {
            if field.as_ref().is_some_and(|field| !field.shapes().is_empty()) {
                let message = "the field of a skin's bump cannot be the distance to a shape";
                let report =
                    Diagnostic::error(Code::PatchBump, message).at(bump.field.span(), "holds a shape");
                self.report(report.help(
                    "write the shape as simple bodies: `{ capsule = { radius = 0.1, height = 0.4 } }`",
                ));
                made = false;
            }
        }
        if !made {
            return None;
        }
        let of = |((field, bump), joint): ((Option<AnyField>, &spec::SkinBump), &usize)| {
            Some((*joint, Bump { field: field?, factor: bump.factor.value }))
        };
        fields.into_iter().zip(&written.bump).zip(joints).map(of).collect()
    }

    fn weight_formulas(&mut self, weights: &[spec::SkinWeight]) -> Option<Vec<Formula>> {
        let mut formulas = Vec::new();
        for weight in weights {
            let mut compiler = Compiler::new(&["x", "y", "z"]);
            match compiler.add(&weight.formula.value) {
                Ok(slot) => formulas.push(compiler.finish(vec![slot]).formula),
                Err(diagnostic) => self.report(*diagnostic),
            }
        }
        (formulas.len() == weights.len()).then_some(formulas)
    }

    /// The skeleton of a name; none when it could not be built, which was told.
    pub(super) fn named_skeleton(&self, name: &str) -> Option<usize> {
        self.model.skeletons.iter().position(|skeleton| skeleton.name == name)
    }

    fn check_skinned_once(&mut self) {
        let skins = &self.spec.skins;
        let mut reports = Vec::new();
        for (index, (_, skin)) in skins.iter().enumerate() {
            let shape = &skin.value.shape;
            let Some((first, other)) =
                skins.iter().take(index).find(|(_, other)| other.value.shape == *shape)
            else {
                continue;
            };
            let message = format!("shape `{}` has a skin already, `{first}`", shape.value.0);
            let report = Diagnostic::error(Code::SkinPlace, message)
                .at(shape.span, "one shape, one skin")
                .also(other.value.shape.span, "the other skin")
                .help("write a second shape, as in `[shape.NAME.copy]` with `of`");
            reports.push(report);
        }
        self.reports.extend(reports);
    }

    /// The nodes that show skinned shapes stand at the origin, and there is one.
    fn check_skinned_nodes(&mut self) {
        let spec = self.spec;
        let mut reports = Vec::new();
        for skin in &self.model.skins {
            let Some(definition) = spec.skins.get(&skin.name) else { continue };
            let span = definition.value.shape.span;
            let name = &self.model.shape(skin.shape).name;
            let shown = self.model.nodes.iter().filter(|node| node.shape == Some(skin.shape));
            if shown.clone().count() == 0 {
                let report =
                    Diagnostic::error(Code::SkinPlace, format!("no node shows the skinned shape `{name}`"))
                        .at(span, "never shown")
                        .help(format!("write `[node.{name}]` with `shape = \"{name}\"`"));
                reports.push(report);
            }
            let copied = shown.clone().find(|node| node.is_copy).and_then(|node| node.parent);
            if let Some((written, node)) = copied.and_then(|parent| spec.nodes.get_index(parent)) {
                let place = node.value.copies.as_ref().map_or(node.span, |copies| copies.span);
                let message = format!("node `{written}` shows copies of the skinned shape `{name}`");
                let report = Diagnostic::error(Code::SkinPlace, message)
                    .at(place, "all would stand in one place")
                    .note(
                        "a player puts a skinned shape where its joints are, and takes no notice of its node",
                    )
                    .help("leave `copies` out, and let the game show the file several times");
                reports.push(report);
            }
            for node in shown.filter(|node| moved(node) && !node.is_copy) {
                let place = spec.nodes.get(&node.name).map_or(span, |node| node.span);
                let message = format!(
                    "node `{}` shows the skinned shape `{name}` and has a place of its own",
                    node.name
                );
                let report = Diagnostic::error(Code::SkinPlace, message)
                    .at(place, "not where the origin is")
                    .note("a player puts a skinned shape where its joints are, and takes no notice of its node")
                    .help("leave `parent`, `socket`, `at`, `rotate` and `scale` out; the `parent` of the skeleton can carry it");
                reports.push(report);
            }
        }
        self.reports.extend(reports);
    }
}

fn moved(node: &crate::model::Node) -> bool {
    node.parent.is_some()
        || node.socket.is_some()
        || node.translation != glam::DVec3::ZERO
        || node.rotation != glam::DQuat::IDENTITY
        || node.scale != glam::DVec3::ONE
}

/// The joints of a chain, in order.
pub(super) fn chain_joints(skeleton: &Skeleton, chain: &str) -> Vec<usize> {
    (1..).map_while(|number: u32| skeleton.find(&format!("{chain}-{number}"))).collect()
}
