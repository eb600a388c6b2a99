//! Skins: which joints carry which parts of a shape.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::formula::Formula;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{FieldReference, ShapeName, SkeletonName};
use crate::language::spec::spanned::Sp;

table! {
    /// A shape that moves with the joints of a skeleton. At most four joints carry a vertex; written weights sum to exactly
    /// 255. The node that shows the shape must stand where the document's origin is: the skeleton carries it.
    "skin" pub Skin {
        /// The name of the shape.
        shape: Sp<ShapeName>;
        /// The name of the skeleton.
        skeleton: Sp<SkeletonName>;
        /// How weights are found.
        weights: Sp<WeightRule> = WeightRule::Envelope;
        /// The joints that carry; all when it is not written. A chain's name stands for all of its joints.
        joints: Vec<Sp<String>> = Vec::new();
        /// How often the weights of each vertex are brought nearer to those of its neighbours.
        smoothing: Sp<u32> = 0_u32 => Check::within(0.0, 100.0);
        /// The weights of each joint, for "explicit", as `[[skin.NAME.weight]]`.
        weight: Vec<SkinWeight> = Vec::new();
        /// The bumps of each joint, for "perturbation", as `[[skin.NAME.bump]]`.
        bump: Vec<SkinBump> = Vec::new();
    }
    checked check
}

choices! {
    /// How the weights of a skin are found.
    WeightRule {
        /// Each vertex wholly with the nearest bone.
        Rigid = "rigid";
        /// By the distance to the bones: wholly within `radius` of a joint, less and less over its `falloff`.
        Envelope = "envelope";
        /// By heat from the bones, which the skin carries along: smooth, and whole limbs go with their bones whatever the
        /// distance through the air. Each part of the shape sees a bone that is near it.
        Heat = "heat";
        /// By the formulas of `weight`.
        Explicit = "explicit";
        /// By the bumps of `bump`, which are attached to joints: each joint by its share of the perturbation that a bump makes
        /// there, its `factor` times the square of its Q, where that is negative.
        Perturbation = "perturbation";
        /// Those of the file of the shape, which is a glTF file with a skin or an MD5 mesh. Its joints are found by their names in kebab-case.
        Imported = "imported";
    }
}

table! {
    /// The weight of a joint at each place of a shape at rest.
    "skin weight" pub SkinWeight {
        /// The joint.
        joint: Sp<String>;
        /// The weight, a formula of x, y and z in the document's unit and axes; below 0 it counts as 0. The weights of
        /// all joints together are brought to the sum 1.
        formula: Sp<Formula>;
    }
}

table! {
    /// A perturbation that is attached to a joint: where its Q is negative it counts for that joint, by its square. Several
    /// bumps of a joint add up.
    "skin bump" pub SkinBump {
        /// The joint.
        joint: Sp<String>;
        /// Its Q, by name or in place, in the document's unit and axes: a quadric that is -1 in its middle and 0 at its
        /// rim, as those that perturb shapes and fields, or any other field that is negative inside.
        field: FieldReference;
        /// Factor of its square; hollows count as hills do.
        factor: Sp<f64> = 1.0 => Check::nonzero();
    }
}

impl Skin {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let explicit = self.weights.value == WeightRule::Explicit;
        let perturbed = self.weights.value == WeightRule::Perturbation;
        let found = |what: &str, word: &str, span: Span| {
            let message =
                format!("weights \"{}\" are found, and `{what}` gives them", self.weights.value.text());
            Diagnostic::error(Code::Conflict, message)
                .at(span, "given here")
                .help(format!("write `weights = \"{word}\"`, or leave `{what}` out"))
        };
        let report = match self.weight.first() {
            None if explicit => Diagnostic::error(Code::MissingField, "missing field `weight` of skin")
                .at(table, "no weight of any joint")
                .help("write `[[skin.NAME.weight]]` with `joint` and `formula = \"= ...\"` for each joint"),
            Some(weight) if !explicit => found("weight", "explicit", weight.joint.span),
            _ => match self.bump.first() {
                None if perturbed => Diagnostic::error(Code::MissingField, "missing field `bump` of skin")
                    .at(table, "no bump of any joint")
                    .help("write `[[skin.NAME.bump]]` with `joint` and `field` for each joint"),
                Some(bump) if !perturbed => found("bump", "perturbation", bump.joint.span),
                _ => return true,
            },
        };
        reader.report(report);
        false
    }
}
