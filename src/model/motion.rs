//! What moves: skeletons, skins and clips, in metres with y up.

use glam::{DQuat, DVec3, DVec4};

use super::{Frame, MaterialHandle, ShapeHandle};
use crate::geometry::field::Bump;
use crate::geometry::formula::Formula;
use crate::motion::{Course, Envelope, Limits, Path, Property, Ramp, Range, Skeleton, Transform};

/// A skeleton of the document.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSkeleton {
    /// Its name.
    pub name: String,
    /// Its joints.
    pub skeleton: Skeleton,
    /// For each joint how far it carries, for envelopes.
    pub envelopes: Vec<Envelope>,
    /// Named places on its joints.
    pub sockets: Vec<Socket>,
    /// Index of the node that carries it in [`Model::nodes`](super::Model::nodes).
    pub parent: Option<usize>,
}

/// A named place on a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Socket {
    /// Its name.
    pub name: String,
    /// The joint.
    pub joint: usize,
    /// Where it is in the joint's rest frame.
    pub place: Transform,
}

/// A socket of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SocketHandle {
    /// Index in [`Model::skeletons`](super::Model::skeletons).
    pub skeleton: usize,
    /// Index of the socket.
    pub socket: usize,
}

/// A shape that joints carry.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Its name.
    pub name: String,
    /// The shape.
    pub shape: ShapeHandle,
    /// Index in [`Model::skeletons`](super::Model::skeletons).
    pub skeleton: usize,
    /// The joints that may carry, increasing.
    pub joints: Vec<usize>,
    /// How weights are found.
    pub rule: WeightRule,
    /// Rounds of smoothing.
    pub smoothing: u32,
}

/// How the weights of a skin are found.
#[derive(Clone, Debug, PartialEq)]
pub enum WeightRule {
    /// Wholly with the nearest bone.
    Rigid,
    /// By envelopes.
    Envelope,
    /// By heat from the bones.
    Heat,
    /// For each of the skin's joints a formula of x, y and z in the document's unit and axes.
    Explicit(Vec<Formula>),
    /// By bumps in the document's unit and axes, each with the place of its joint among the skin's.
    Perturbation(Vec<(usize, Bump)>),
    /// For each point of the shape's polygons the joints that carry it, by their places among the skin's, and their weights.
    Given(Vec<Vec<(usize, f64)>>),
}

/// A state of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Morph {
    /// Its name.
    pub name: String,
    /// The shape.
    pub shape: ShapeHandle,
    /// Its weight where no clip moves it.
    pub weight: f64,
    /// What gives its weight in every clip that turns a joint.
    pub driver: Option<Driver>,
    /// What the shape is at weight 1.
    pub state: State,
}

/// The joint whose angle gives a weight.
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// Index in [`Model::skeletons`](super::Model::skeletons).
    pub skeleton: usize,
    /// Index of the joint.
    pub joint: usize,
    /// Which angle gives which weight.
    pub ramp: Ramp,
}

/// What a shape is at weight 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Another shape of the model.
    Shape(ShapeHandle),
    /// A shape of a model of [`Model::states`](super::Model::states).
    Other {
        /// Index of the model.
        model: usize,
        /// Its shape.
        shape: ShapeHandle,
    },
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    /// Its name.
    pub name: String,
    /// Seconds.
    pub duration: f64,
    /// Whether it is played again and again.
    pub looped: bool,
    /// How far a vertex may be from the exact motion, metres.
    pub tolerance: Option<f64>,
    /// Samples a second to begin with.
    pub rate: f64,
    /// What moves.
    pub tracks: Vec<ClipTrack>,
    /// What changes of materials, lights and cameras.
    pub properties: Vec<PropertyTrack>,
    /// What joints reach, for the report.
    pub reaches: Vec<ReachTask>,
    /// What happens: seconds and names, in the order of time.
    pub events: Vec<(f64, String)>,
}

impl Clip {
    /// A clip of a file: sampled 60 times a second, within the model's own tolerance.
    #[must_use]
    pub fn of_file(name: String, duration: f64, looped: bool, tracks: Vec<ClipTrack>) -> Self {
        let (properties, reaches, events) = (Vec::new(), Vec::new(), Vec::new());
        Self { name, duration, looped, tolerance: None, rate: 60.0, tracks, properties, reaches, events }
    }
}

/// A property in change.
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyTrack {
    /// Of what.
    pub owner: Owner,
    /// Which.
    pub property: Property,
    /// The numbers that the course gives, from this place in the value on; the others stay as they are at rest.
    pub first: usize,
    /// How many the course gives.
    pub count: usize,
    /// How: by an [`Offset`](Course::Offset), whose numbers are the value, or by the way [along](Course::Along) a curve.
    pub course: Course,
    /// Whether numbers beyond what the property may be are brought into its range.
    pub clamp: bool,
}

/// Whose properties change.
#[derive(Clone, Debug, PartialEq)]
pub enum Owner {
    /// A material, and those that were made of it for shapes with normal maps.
    Material(Vec<MaterialHandle>),
    /// The light or the camera of a node, by its index in [`Model::nodes`](super::Model::nodes).
    Node(usize),
}

impl PropertyTrack {
    /// The value of the property where the course gives one, in the document's unit.
    #[must_use]
    pub fn composed(&self, rest: DVec4, given: DVec4) -> DVec4 {
        let (least, most) = self.property.range();
        let mut value = rest;
        for part in 0..self.count {
            let number = given[part];
            value[self.first + part] = if self.clamp { number.clamp(least, most) } else { number };
        }
        value
    }
}

/// A point of a joint that is brought to places.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachTask {
    /// Index in [`Model::skeletons`](super::Model::skeletons).
    pub skeleton: usize,
    /// Index of the joint.
    pub joint: usize,
    /// The point in the joint's rest frame.
    pub point: DVec3,
    /// So far from its place it counts as there, metres.
    pub tolerance: f64,
    /// For each frame its time, the place, metres, and the distance that solving left, metres.
    pub frames: Vec<(f64, DVec3, f64)>,
}

/// One part of a node or joint in motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ClipTrack {
    /// What moves.
    pub target: Target,
    /// How.
    pub course: Course,
    /// In which unit and axes the course is.
    pub space: Space,
    /// Limits into which rotations are brought, and ranges in metres for translations.
    pub clamp: Option<(Limits, [Option<Range>; 3])>,
}

/// In which unit and axes a course is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// The document's.
    Document,
    /// The document's unit along the axes of a rest frame.
    Rest,
    /// Metres, y up.
    File,
}

/// What a track moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A node, by its index in [`Model::nodes`](super::Model::nodes).
    Node(usize),
    /// A joint of a skeleton.
    Joint {
        /// Index in [`Model::skeletons`](super::Model::skeletons).
        skeleton: usize,
        /// Index of the joint.
        joint: usize,
    },
    /// The weight of a morph target of the shape that a node shows.
    Weight {
        /// Index in [`Model::nodes`](super::Model::nodes).
        node: usize,
        /// The number of the target among those of the shape.
        target: usize,
    },
}

impl ClipTrack {
    /// A value of the course in metres with y up, brought into the limits where they clamp; still relative to rest.
    #[must_use]
    pub fn converted(&self, value: DVec4, frame: &Frame) -> DVec4 {
        match self.course.path() {
            Path::Translation => {
                let value = value.truncate();
                let moved = match self.space {
                    Space::Document => frame.axes() * value * frame.unit,
                    Space::Rest => value * frame.unit,
                    Space::File => value,
                };
                self.slid(moved).extend(0.0)
            }
            Path::Rotation => {
                let rotation = DQuat::from_vec4(value);
                let turn = frame.turn();
                let turned = match self.space {
                    Space::Document => turn * rotation * turn.conjugate(),
                    Space::Rest | Space::File => rotation,
                };
                DVec4::from(match &self.clamp {
                    Some((limits, _)) => limits.clamp(turned),
                    None => turned,
                })
            }
            Path::Scale => match self.space {
                Space::Document => frame.scale(value.truncate()).extend(0.0),
                Space::Rest | Space::File => value,
            },
            Path::Weight => value,
        }
    }

    /// What a value of the course makes of a place at rest: a translation or scale (x, y, z), or a rotation (x, y, z, w); a
    /// weight as it is.
    #[must_use]
    pub fn composed(&self, rest: &Transform, value: DVec4, frame: &Frame) -> DVec4 {
        let value = self.converted(value, frame);
        match self.course.path() {
            Path::Translation => {
                let turn = if self.space == Space::Rest { rest.rotation } else { DQuat::IDENTITY };
                (rest.translation + turn * value.truncate()).extend(0.0)
            }
            Path::Rotation => {
                let turned = DQuat::from_vec4(value);
                // Along a curve the rest's own rotation comes first.
                let along = self.space == Space::File;
                let whole = if along { turned * rest.rotation } else { rest.rotation * turned };
                DVec4::from(whole.normalize())
            }
            Path::Scale => (rest.scale * value.truncate()).extend(0.0),
            Path::Weight => value,
        }
    }

    /// Puts a value of the course into a place.
    pub fn put(&self, place: &mut Transform, rest: &Transform, value: DVec4, frame: &Frame) {
        let value = self.composed(rest, value, frame);
        match self.course.path() {
            Path::Translation => place.translation = value.truncate(),
            Path::Rotation => place.rotation = DQuat::from_vec4(value),
            Path::Scale => place.scale = value.truncate(),
            Path::Weight => {}
        }
    }

    fn slid(&self, value: DVec3) -> DVec3 {
        let Some((_, ranges)) = &self.clamp else { return value };
        if ranges.iter().all(Option::is_none) {
            return value;
        }
        let inside =
            |axis: usize| ranges[axis].map_or(0.0, |range| value[axis].clamp(range.least, range.most));
        DVec3::new(inside(0), inside(1), inside(2))
    }
}
