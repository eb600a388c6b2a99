//! Inverse kinematics in clips: what joints shall reach.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::clip::{Between, ClipTrack, Formulas, MotionKey, MotionPath, RotationWay};
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::CurveReference;
use crate::language::spec::spanned::Sp;

table! {
    /// A point of a joint that is brought to a place by turning the joints before it, within their limits: inverse kinematics,
    /// solved when the clip is baked. Several of them in a clip are solved together where they share joints. Places are in
    /// the scene, in the document's unit.
    "reach" pub Reach {
        /// The joint that is brought there.
        joint: Sp<String>;
        /// The first joint that turns for it; the root when it is not written.
        from: Option<Sp<String>>;
        /// The point of the joint, in its rest frame, whose y runs along the bone; its tail when it is not written.
        at: Option<Sp<DVec3>>;
        /// The place.
        target: Option<Sp<DVec3>>;
        /// Places at times, each `{ at = seconds, value = [x, y, z] }`. With `along`: the share of the curve's length.
        keys: Vec<MotionKey> = Vec::new();
        /// How the place goes from key to key.
        between: Sp<Between> = Between::Linear;
        /// Three formulas of the time t in seconds. With `along`: one, for the share of the curve's length.
        formula: Option<Formulas>;
        /// A curve along which the place moves by its length. Without keys, formula or speed: once, at constant speed.
        along: Option<CurveReference>;
        /// Speeds along the curve in the document's unit a second, each `{ at = seconds, value = ... }`.
        speed: Vec<MotionKey> = Vec::new();
        /// How the joint is turned in the scene against its rest: degrees about the x axis, then the y axis, then the z axis.
        rotate: Option<Sp<DVec3>>;
        /// The same at times, each `{ at = seconds, value = [x, y, z] }`.
        rotate_keys: Vec<MotionKey> = Vec::new();
        /// A place toward which the joints between bend: in front of a knee, behind an elbow.
        pole: Option<Sp<DVec3>>;
        /// What becomes of places that cannot be reached.
        reach: Sp<ReachRule> = ReachRule::Warn;
        /// How far the point may be from its place and count as there, in the document's unit; a ten thousandth of the
        /// bones' length together when it is not written.
        tolerance: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

choices! {
    /// What becomes of places that cannot be reached.
    ReachRule {
        /// A warning that tells the distance.
        Warn = "warn";
        /// An error.
        Required = "required";
    }
}

impl Reach {
    /// Where the law of the place is written, if it is more than a fixed one.
    fn moving(&self) -> Option<Span> {
        let along = self.along.as_ref().map(CurveReference::span);
        let keys = self.keys.first().map(|key| key.at.span);
        along.or(keys).or(self.formula.as_ref().map(Formulas::span))
    }

    /// The track that a node would have that moved as the place does.
    #[must_use]
    pub fn track(&self) -> ClipTrack {
        ClipTrack {
            morph: None,
            keys: self.keys.clone(),
            between: self.between,
            formula: self.formula.clone(),
            along: self.along.clone(),
            orient: false.into(),
            speed: self.speed.clone(),
            ..still(MotionPath::Translation)
        }
    }

    /// The track that a node would have that turned as the joint does.
    #[must_use]
    pub fn turning(&self) -> ClipTrack {
        ClipTrack { keys: self.rotate_keys.clone(), ..still(MotionPath::Rotation) }
    }

    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let moving = self.moving();
        let report = match (&self.target, moving) {
            (None, None) if self.rotate.is_none() && self.rotate_keys.is_empty() => Diagnostic::error(
                Code::MissingField,
                "missing `target`, `keys`, `formula` or `along` of reach",
            )
            .at(table, "where to?"),
            (Some(target), Some(moving)) => {
                Diagnostic::error(Code::Conflict, "a place is fixed by `target`, or it moves")
                    .at(moving, "moves")
                    .also(target.span, "fixed")
            }
            _ => match (&self.rotate, self.rotate_keys.first()) {
                (Some(rotate), Some(key)) => {
                    Diagnostic::error(Code::Conflict, "`rotate` and `rotate-keys` both turn the joint")
                        .at(key.at.span, "said again")
                        .also(rotate.span, "said here")
                }
                _ => return true,
            },
        };
        reader.report(report);
        false
    }
}

/// A track that says nothing yet.
fn still(path: MotionPath) -> ClipTrack {
    ClipTrack {
        node: None,
        joint: None,
        chain: None,
        material: None,
        morph: None,
        path: Some(path.into()),
        keys: Vec::new(),
        between: Between::Linear.into(),
        formula: None,
        curve: None,
        axis: None,
        order: None,
        way: RotationWay::Angles.into(),
        along: None,
        orient: false.into(),
        up: None,
        speed: Vec::new(),
    }
}
