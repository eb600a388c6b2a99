//! Skeletons of a document: chains laid out, sides mirrored, names resolved, then put in order.

use glam::{DVec2, DVec3};

use super::profile::show;
use super::{Builder, rotation};
use crate::geometry::curve::{AnyCurve, Curve as _, Polyline};
use crate::geometry::surface::{Carry, FrameField};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, AxisRanges, CoordinateAxis, Sp, closest};
use crate::model::{NamedSkeleton, Socket, SocketHandle};
use crate::motion::{Bone, Envelope, Limits, Range, Skeleton, SkeletonFault, Transform};

/// A joint on its way from the text, in the document's unit and axes.
#[derive(Clone)]
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) parent: Option<Sp<String>>,
    pub(super) head: Option<DVec3>,
    pub(super) tail: DVec3,
    pub(super) roll: f64,
    pub(super) limits: [Option<Range>; 3],
    pub(super) slide: [Option<Range>; 3],
    pub(super) stiffness: f64,
    pub(super) radius: Option<f64>,
    pub(super) falloff: Option<f64>,
    pub(super) span: Span,
}

impl Builder<'_> {
    pub(super) fn skeletons(&mut self) {
        let spec = self.spec;
        for (name, definition) in &spec.skeletons {
            if let Some(skeleton) = self.skeleton_of_joints(name, &definition.value, definition.span) {
                self.model.skeletons.push(skeleton);
            }
        }
    }

    fn skeleton_of_joints(
        &mut self,
        name: &str,
        written: &spec::Skeleton,
        span: Span,
    ) -> Option<NamedSkeleton> {
        let mut drafts: Vec<Draft> = match &written.import {
            Some(import) => self.imported_joints(import)?,
            None => Vec::new(),
        };
        drafts.extend(written.joint.iter().map(|(name, joint)| joint_draft(name, joint)));
        for (name, chain) in &written.chain {
            drafts.extend(self.chain_drafts(name, chain)?);
        }
        if written.mirror.is_some() {
            let twins: Vec<Draft> = drafts.iter().filter_map(|draft| mirrored(draft, &drafts)).collect();
            drafts.extend(twins);
        }
        self.check_names(&drafts)?;
        let parents = self.parents(&drafts, written)?;
        let bones = self.bones(&drafts, &parents)?;
        let skeleton = match Skeleton::new(bones) {
            Ok(skeleton) => skeleton,
            Err(fault) => {
                self.report(refusal(&fault, &drafts, span));
                return None;
            }
        };
        let unit = self.model.frame.unit;
        let envelope = |joint: &crate::motion::Joint| {
            let draft = drafts.iter().find(|draft| draft.name == joint.bone.name);
            let own = draft.and_then(|draft| draft.radius);
            let radius = own.map_or(joint.length() / 4.0, |radius| radius * unit);
            let falloff = draft.and_then(|draft| draft.falloff).map(|falloff| falloff * unit);
            let falloff = falloff.unwrap_or(if radius > 0.0 { radius } else { joint.length() / 4.0 });
            Envelope { radius, falloff }
        };
        let envelopes = skeleton.joints.iter().map(envelope).collect();
        let sockets = self.sockets(written, &skeleton)?;
        let parent = written.parent.as_ref().and_then(|node| self.spec.nodes.get_index_of(&node.value.0));
        Some(NamedSkeleton { name: name.to_owned(), skeleton, envelopes, sockets, parent })
    }

    fn chain_drafts(&mut self, name: &str, chain: &Sp<spec::Chain>) -> Option<Vec<Draft>> {
        let path = match &chain.curve {
            Some(curve) => self.curve_of(curve)?,
            None => {
                let points = chain.points.iter().map(|point| point.value).collect();
                match Polyline::new(points, false) {
                    Some(line) => AnyCurve::Polyline(line),
                    None => return self.degenerate("the points of this chain are all one", chain.span),
                }
            }
        };
        let places: Vec<DVec3> = match chain.joints {
            None => chain.points.iter().map(|point| point.value).collect(),
            Some(count) => {
                let frames = FrameField::new(&path, &Carry::PLAIN, 0.0);
                let share = |k: u32| f64::from(k) / f64::from(count.value);
                (0..=count.value).map(|k| path.point(frames.parameter(share(k)))).collect()
            }
        };
        let draft = |(index, pair): (usize, &[DVec3])| Draft {
            name: format!("{name}-{}", index + 1),
            parent: match index {
                0 => chain.parent.clone(),
                _ => Some(Sp::new(format!("{name}-{index}"), chain.span)),
            },
            head: Some(pair[0]),
            tail: pair[1],
            roll: chain.roll.value,
            limits: ranges(chain.limits.as_ref(), &chain.locked),
            slide: [None; 3],
            stiffness: chain.stiffness.value,
            radius: chain.radius.map(|radius| radius.value),
            falloff: chain.falloff.map(|falloff| falloff.value),
            span: chain.span,
        };
        Some(places.windows(2).enumerate().map(draft).collect())
    }

    fn check_names(&mut self, drafts: &[Draft]) -> Option<()> {
        let mut good = Some(());
        for (index, draft) in drafts.iter().enumerate() {
            let Some(first) = drafts[..index].iter().find(|other| other.name == draft.name) else { continue };
            let report = Diagnostic::error(
                Code::Conflict,
                format!("there are two joints of the name `{}`", draft.name),
            )
            .at(draft.span, "made here")
            .also(first.span, "and here")
            .help("give one of them another name");
            self.report(report);
            good = None;
        }
        good
    }

    /// For each joint the index of its parent; the name of a chain stands for its last joint.
    fn parents(&mut self, drafts: &[Draft], written: &spec::Skeleton) -> Option<Vec<Option<usize>>> {
        let mut parents = Vec::with_capacity(drafts.len());
        let mut good = true;
        for draft in drafts {
            let Some(parent) = &draft.parent else {
                parents.push(None);
                continue;
            };
            let found = find(drafts, parent, written);
            if found.is_none() {
                good = false;
                let names = drafts.iter().map(|draft| draft.name.as_str());
                self.report(unknown_joint(parent, names, "joint"));
            }
            parents.push(found);
        }
        good.then_some(parents)
    }

    fn bones(&mut self, drafts: &[Draft], parents: &[Option<usize>]) -> Option<Vec<Bone>> {
        let map = self.model.frame.map();
        let unit = self.model.frame.unit;
        let scaled = |range: Range| Range { least: range.least * unit, most: range.most * unit };
        let mut bones = Vec::with_capacity(drafts.len());
        for (draft, parent) in drafts.iter().zip(parents) {
            let Some(head) = draft.head.or(parent.map(|parent| drafts[parent].tail)) else {
                let report = Diagnostic::error(
                    Code::MissingField,
                    format!("joint `{}` has neither a `head` nor a parent", draft.name),
                );
                self.report(report.at(draft.span, "where does it turn?").help("write `head = [x, y, z]`"));
                return None;
            };
            bones.push(Bone {
                name: draft.name.clone(),
                parent: *parent,
                head: map.transform_point3(head),
                tail: map.transform_point3(draft.tail),
                roll: draft.roll,
                limits: Limits { ranges: draft.limits },
                slide: draft.slide.map(|range| range.map(scaled)),
                stiffness: draft.stiffness,
            });
        }
        Some(bones)
    }

    fn sockets(&mut self, written: &spec::Skeleton, skeleton: &Skeleton) -> Option<Vec<Socket>> {
        let unit = self.model.frame.unit;
        let mut sockets: Vec<Socket> = Vec::new();
        let mut add = |name: String, joint: usize, socket: &spec::Socket, side: DVec3| {
            let length = DVec3::Y * skeleton.joints[joint].length();
            let turn = DVec3::new(1.0, side.x, side.x) * socket.rotate.value;
            sockets.push(Socket {
                name,
                joint,
                place: Transform {
                    translation: socket.at.map_or(length, |at| at.value * side * unit),
                    rotation: rotation(turn),
                    scale: DVec3::ONE,
                },
            });
        };
        let mut lost = Vec::new();
        for (name, socket) in &written.socket {
            match skeleton.find(&socket.joint.value) {
                Some(joint) => add(name.clone(), joint, &socket.value, DVec3::ONE),
                None => lost.push(socket.joint.clone()),
            }
            let twin = written.mirror.as_ref().and_then(|_| other_side(name));
            let twin = twin.filter(|twin| !written.socket.contains_key(twin));
            let joint = other_side(&socket.joint.value).and_then(|joint| skeleton.find(&joint));
            if let (Some(twin), Some(joint)) = (twin, joint) {
                add(twin, joint, &socket.value, DVec3::new(-1.0, 1.0, 1.0));
            }
        }
        for joint in &lost {
            let names = skeleton.joints.iter().map(|joint| joint.bone.name.as_str());
            self.report(unknown_joint(joint, names, "joint"));
        }
        lost.is_empty().then_some(sockets)
    }

    /// The socket of a name, in whichever skeleton it is.
    pub(super) fn socket(&mut self, name: &Sp<String>) -> Option<SocketHandle> {
        let mut found = Vec::new();
        for (skeleton, named) in self.model.skeletons.iter().enumerate() {
            let sockets = named.sockets.iter().enumerate();
            let own = sockets.filter(|(_, socket)| socket.name == name.value);
            found.extend(own.map(|(socket, _)| SocketHandle { skeleton, socket }));
        }
        match found.as_slice() {
            [one] => Some(*one),
            [] => {
                let all = self.model.skeletons.iter().flat_map(|named| &named.sockets);
                let nodes = self.model.nodes.iter().filter(|node| node.is_socket).map(|node| &node.name);
                let names: Vec<String> = all.map(|socket| &socket.name).chain(nodes).cloned().collect();
                // A skeleton that could not be built has told its own faults.
                if self.model.skeletons.len() == self.spec.skeletons.len() {
                    self.report(unknown_joint(name, names.iter().map(String::as_str), "socket"));
                }
                None
            }
            _ => {
                let message = format!("{} skeletons have a socket `{}`", found.len(), name.value);
                let report = Diagnostic::error(Code::Conflict, message).at(name.span, "which of them?");
                self.report(report.help("give each socket a name of its own"));
                None
            }
        }
    }
}

fn find(drafts: &[Draft], name: &Sp<String>, written: &spec::Skeleton) -> Option<usize> {
    let exact = drafts.iter().position(|draft| draft.name == name.value);
    let chain = || {
        let begins = format!("{}-", name.value);
        let of_chain = |draft: &Draft| {
            draft.name.strip_prefix(&begins).is_some_and(|rest| rest.bytes().all(|b| b.is_ascii_digit()))
        };
        written.chain.contains_key(&name.value).then(|| drafts.iter().rposition(of_chain)).flatten()
    };
    exact.or_else(chain)
}

/// The error on the name of a joint or socket that a skeleton does not have.
pub(super) fn unknown_joint<'n>(
    name: &Sp<String>,
    known: impl Iterator<Item = &'n str> + Clone,
    what: &str,
) -> Diagnostic {
    let message = format!("there is no {what} `{}`", name.value);
    let report = Diagnostic::error(Code::UnknownName, message).at(name.span, "not defined");
    if let Some(near) = closest(&name.value, known.clone()) {
        return report.suggest(name.span, format!("\"{near}\""), format!("did you mean `{near}`?"));
    }
    let known: Vec<&str> = known.take(13).collect();
    match known.len() {
        0 => report.note(format!("there is no {what} at all")),
        1..=12 => report.note(format!("{what}s: {}", known.join(", "))),
        _ => report,
    }
}

fn joint_draft(name: &str, joint: &Sp<spec::SkeletonJoint>) -> Draft {
    Draft {
        name: name.to_owned(),
        parent: joint.parent.clone(),
        head: joint.head.map(|head| head.value),
        tail: joint.tail.value,
        roll: joint.roll.value,
        limits: ranges(joint.limits.as_ref(), &joint.locked),
        slide: joint.slide.as_ref().map_or([None; 3], |slide| slide.ranges().map(|one| one.map(range))),
        stiffness: joint.stiffness.value,
        radius: joint.radius.map(|radius| radius.value),
        falloff: joint.falloff.map(|falloff| falloff.value),
        span: joint.span,
    }
}

fn range(written: Sp<DVec2>) -> Range {
    Range { least: written.x, most: written.y }
}

fn ranges(limits: Option<&Sp<AxisRanges>>, locked: &[Sp<CoordinateAxis>]) -> [Option<Range>; 3] {
    let mut all = limits.map_or([None; 3], |limits| limits.ranges().map(|one| one.map(range)));
    for axis in locked {
        all[match axis.value {
            CoordinateAxis::X => 0,
            CoordinateAxis::Y => 1,
            CoordinateAxis::Z => 2,
        }] = Some(Range::NONE);
    }
    all
}

/// A name with left for right and right for left; none where neither is a word of it.
pub(super) fn other_side(name: &str) -> Option<String> {
    let other = |word: &str| match word {
        "left" => Some("right"),
        "right" => Some("left"),
        _ => None,
    };
    let words: Vec<&str> = name.split('-').map(|word| other(word).unwrap_or(word)).collect();
    let turned = words.join("-");
    (turned != name).then_some(turned)
}

/// The joint of the other side, in the mirror image: turns about x and slides along y and z keep their sign, the others
/// change it. None where the name has no side or the other side is written.
fn mirrored(draft: &Draft, all: &[Draft]) -> Option<Draft> {
    let name = other_side(&draft.name)?;
    if all.iter().any(|other| other.name == name) {
        return None;
    }
    let turned = |range: Option<Range>| range.map(|one| Range { least: -one.most, most: -one.least });
    let across = |point: DVec3| DVec3::new(-point.x, point.y, point.z);
    let parent = draft.parent.as_ref().map(|parent| {
        Sp::new(other_side(&parent.value).unwrap_or_else(|| parent.value.clone()), parent.span)
    });
    let [x, y, z] = draft.limits;
    let [slide_x, slide_y, slide_z] = draft.slide;
    Some(Draft {
        name,
        parent,
        head: draft.head.map(across),
        tail: across(draft.tail),
        roll: -draft.roll,
        limits: [x, turned(y), turned(z)],
        slide: [turned(slide_x), slide_y, slide_z],
        ..draft.clone()
    })
}

fn refusal(fault: &SkeletonFault, drafts: &[Draft], table: Span) -> Diagnostic {
    match fault {
        SkeletonFault::Empty => {
            Diagnostic::error(Code::MissingField, "this skeleton has no joint").at(table, "no joint")
        }
        SkeletonFault::Cycle(circle) => {
            let names: Vec<&str> = circle.iter().map(|joint| drafts[*joint].name.as_str()).collect();
            let place = &drafts[circle[0]];
            let span = place.parent.as_ref().map_or(place.span, |parent| parent.span);
            let message = match names.as_slice() {
                [one] => format!("joint `{one}` is its own parent"),
                _ => format!("joints carry each other in a circle: {} -> {}", names.join(" -> "), names[0]),
            };
            Diagnostic::error(Code::Cycle, message)
                .at(span, "leads back to it")
                .help("one joint of a skeleton, the root, has no `parent`")
        }
        SkeletonFault::Roots(first, second) => {
            let (first, second) = (&drafts[*first], &drafts[*second]);
            let message =
                format!("a skeleton has one root, but `{}` and `{}` have no parent", first.name, second.name);
            Diagnostic::error(Code::TwoRoots, message)
                .at(second.span, "another root")
                .also(first.span, "a root")
                .help("give one of them a `parent`, or add a root that carries both")
        }
        SkeletonFault::NoLength(joint) => {
            let draft = &drafts[*joint];
            let [x, y, z] = draft.tail.to_array().map(show);
            let message = format!("the bone of joint `{}` has no length", draft.name);
            Diagnostic::error(Code::NoBone, message)
                .at(draft.span, format!("head and tail are both at [{x}, {y}, {z}]"))
                .help("a bone gives its joint a direction: write another `tail`")
        }
        SkeletonFault::TooMany(count) => {
            let message =
                format!("this skeleton has {count} joints, and the limit is {}", crate::motion::MOST_JOINTS);
            Diagnostic::error(Code::LimitPassed, message)
                .at(table, "too many")
                .note("indices of joints are written as bytes")
        }
    }
}
