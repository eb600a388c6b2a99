//! Skeletons: joints, chains of them, sockets.

use glam::{DVec2, DVec3};
use indexmap::IndexMap;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::deform::CoordinateAxis;
use crate::language::spec::import::{FilePath, Up};
use crate::language::spec::name::check_name;
use crate::language::spec::reader::{Reader, backtick};
use crate::language::spec::reference::{CurveReference, NodeName};
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// Joints in a tree, for skins and clips. One of them has no parent: the root.
    "skeleton" pub Skeleton {
        /// The joints, as `[skeleton.NAME.joint.JOINT]`.
        joint: IndexMap<String, Sp<Joint>>;
        /// Rows of joints, as `[skeleton.NAME.chain.CHAIN]`; the joints of a chain `tail` are `tail-1`, `tail-2` and so on.
        chain: IndexMap<String, Sp<Chain>>;
        /// Named places on joints, as `[skeleton.NAME.socket.SOCKET]`; each is a node of the file.
        socket: IndexMap<String, Sp<Socket>>;
        /// Makes the other side: each joint, chain and socket with the word `left` in its name is made once more with `right`,
        /// mirrored in the plane across this axis; and the other way round.
        mirror: Option<Sp<MirrorAxis>>;
        /// Joints from a file, as `[skeleton.NAME.import]`.
        import: Option<Sp<SkeletonImport>>;
        /// The name of the node that carries the skeleton.
        parent: Option<Sp<NodeName>>;
    }
    checked check
}

table! {
    /// The joints of a BVH file, of an MD5 mesh, or of the skins of a glTF file, which stand as their meshes are bound. Their
    /// names are written in kebab-case: `LeftUpLeg` is `left-up-leg`. Bones run to end sites or to the middle of the joints
    /// they carry. Where several joints have no parent, a joint `root` at the origin carries them.
    "skeleton import" pub SkeletonImport {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// What one unit of the file is in the document's unit.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// The axis that points up in the file: `"y"` when it is not written, for MD5 `"z"`.
        up: Option<Sp<Up>>;
    }
}

choices! {
    /// The axis across which a skeleton is mirrored.
    MirrorAxis {
        /// Left and right change x.
        X = "x";
    }
}

table! {
    /// A joint: it turns at its head, and carries what is around the bone from head to tail. Its rest frame has y along
    /// the bone; x and z stand where the least rotation from the upright brings them, turned about the bone by `roll`.
    "joint" pub Joint {
        /// The joint that carries it; the root has none.
        parent: Option<Sp<String>>;
        /// Where it turns, in the document's unit; at the tail of its parent when it is not written.
        head: Option<Sp<DVec3>>;
        /// Where its bone ends.
        tail: Sp<DVec3>;
        /// Degrees by which the rest frame is turned about the bone.
        roll: Sp<f64> = 0.0;
        /// How far it turns.
        limits: Option<Sp<AxisRanges>>;
        /// Axes of the rest frame about which it does not turn, in place of ranges `[0, 0]`.
        locked: Vec<Sp<CoordinateAxis>> = Vec::new();
        /// How far it slides along the axes of its rest frame, in the document's unit; along others it does not.
        slide: Option<Sp<AxisRanges>>;
        /// How unwilling it is to turn where several joints could, from 0 to below 1.
        stiffness: Sp<f64> = 0.0 => Check::within(0.0, 0.99);
        /// How far around its bone it carries wholly, for skins by envelopes; a quarter of the bone when it is not written.
        radius: Option<Sp<f64>> => Check::at_least(0.0);
        /// How much further it carries less and less; as far as `radius` when it is not written.
        falloff: Option<Sp<f64>> => Check::above(0.0);
    }
}

table! {
    /// A row of joints along points or a curve, each the parent of the next.
    "chain" pub Chain {
        /// The joint that carries the first one.
        parent: Option<Sp<String>>;
        /// Points from the first head to the last tail. Without `joints` each is a head, but for the last.
        points: Vec<Sp<DVec3>> = Vec::new();
        /// A curve in place of points.
        curve: Option<CurveReference>;
        /// How many joints: bones between places at equal lengths of the way.
        joints: Option<Sp<u32>> => Check::within(1.0, 256.0);
        /// Degrees by which each rest frame is turned about its bone.
        roll: Sp<f64> = 0.0;
        /// How far each turns.
        limits: Option<Sp<AxisRanges>>;
        /// Axes of the rest frame about which none turns.
        locked: Vec<Sp<CoordinateAxis>> = Vec::new();
        /// How unwilling each is to turn, from 0 to below 1.
        stiffness: Sp<f64> = 0.0 => Check::within(0.0, 0.99);
        /// How far around its bone each carries wholly; a quarter of the bone when it is not written.
        radius: Option<Sp<f64>> => Check::at_least(0.0);
        /// How much further each carries less and less; as far as `radius` when it is not written.
        falloff: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

table! {
    /// Ranges along or about the axes of a rest frame, each `[least, most]`. Limits of angles are degrees and hold for the
    /// swing about x, then the one about z, then the twist about y, which is the bone. An axis that is not written is free
    /// for turns.
    "axis ranges" pub AxisRanges {
        /// About or along x.
        x: Option<Sp<DVec2>>;
        /// About or along z.
        z: Option<Sp<DVec2>>;
        /// About or along y, the bone.
        y: Option<Sp<DVec2>>;
    }
    checked check
}

table! {
    /// A named place on a joint, where a game or a node attaches things.
    "socket" pub Socket {
        /// The joint.
        joint: Sp<String>;
        /// Where it is in the joint's rest frame, whose y runs along the bone, in the document's unit; at the tail when it is
        /// not written.
        at: Option<Sp<DVec3>>;
        /// Degrees about the x axis, then the y axis, then the z axis of the rest frame.
        rotate: Sp<DVec3> = DVec3::ZERO;
    }
}

impl Skeleton {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let mut names: Vec<(&str, &String, Span)> = Vec::new();
        names.extend(self.joint.iter().map(|(name, joint)| ("joint", name, joint.span)));
        names.extend(self.chain.iter().map(|(name, chain)| ("chain", name, chain.span)));
        names.extend(self.socket.iter().map(|(name, socket)| ("socket", name, socket.span)));
        for (what, name, span) in names {
            reader.diagnostics.extend(check_name(what, name, span));
        }
        if self.joint.is_empty() && self.chain.is_empty() && self.import.is_none() {
            let report = Diagnostic::error(Code::MissingField, "this skeleton has no joint")
                .at(table, "no joint")
                .help("write `[skeleton.NAME.joint.JOINT]` with a `head` and a `tail`");
            reader.report(report);
            return false;
        }
        true
    }
}

impl Chain {
    fn check(&self, table: Span, reader: &mut Reader<'_>) -> bool {
        let report = match (&self.curve, self.points.as_slice()) {
            (Some(curve), [first, ..]) => {
                Diagnostic::error(Code::Conflict, "a chain runs along `points` or along a `curve`")
                    .at(first.span, "cannot stand beside `curve`")
                    .also(curve.span(), "the curve")
            }
            (Some(curve), []) if self.joints.is_none() => {
                Diagnostic::error(Code::MissingField, "missing field `joints` of chain")
                    .at(curve.span(), "into how many bones?")
            }
            (None, []) => Diagnostic::error(Code::MissingField, "missing `points` or `curve` of chain")
                .at(table, "along what?"),
            (None, [one]) => Diagnostic::error(Code::WrongLength, "`points` needs at least 2 items, found 1")
                .at(one.span, "too few"),
            _ => return true,
        };
        reader.report(report);
        false
    }
}

impl AxisRanges {
    /// The ranges of x, y and z.
    #[must_use]
    pub fn ranges(&self) -> [Option<Sp<DVec2>>; 3] {
        [self.x, self.y, self.z]
    }

    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (range, axis) in self.ranges().into_iter().zip(["x", "y", "z"]) {
            let Some(range) = range.filter(|range| range.x > range.y) else { continue };
            let message = format!(
                "a range runs from least to most, but {} runs from {} to {}",
                backtick(axis),
                show_number(range.x),
                show_number(range.y)
            );
            let report = Diagnostic::error(Code::OutOfRange, message).at(range.span, "the other way round");
            reader.report(report);
            good = false;
        }
        good
    }
}
