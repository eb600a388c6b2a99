//! Clips: what nodes do over time.
//!
//! Source: Khronos Group, glTF 2.0 Specification, 2021, section 3.11 and appendix C (interpolation).

use glam::{DQuat, DVec3, DVec4};

use gltf::accessor::Dimensions;

use super::{Data, GltfFault, Node, Place};
use crate::geometry::number::{acos, sin};
use crate::packing::PointerChannel;

/// A clip.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Its name, may be empty.
    pub name: String,
    /// What it moves.
    pub channels: Vec<Channel>,
    /// What else it changes (`KHR_animation_pointer`).
    pub properties: Vec<PropertyChannel>,
}

/// Numbers of the document that change.
#[derive(Clone, Debug)]
pub struct PropertyChannel {
    /// The JSON pointer.
    pub pointer: String,
    /// Seconds at which its keys stand, in order.
    pub times: Vec<f32>,
    /// Between the keys.
    pub steps: Steps,
    /// As many numbers for each key as the property has.
    pub values: Vec<f32>,
}

/// One thing that moves.
#[derive(Clone, Debug)]
pub struct Channel {
    /// The node.
    pub node: usize,
    /// Seconds at which its keys stand, in order.
    pub times: Vec<f32>,
    /// Between the keys.
    pub steps: Steps,
    /// What the keys say.
    pub track: Track,
}

/// How a value goes from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// It waits for the next key.
    Step,
    /// Straight; turns go along the shorter arc.
    Linear,
    /// By a Hermite cubic: each key is an incoming tangent, a value and an outgoing tangent.
    Cubic,
}

/// The values of a channel.
#[derive(Clone, Debug)]
pub enum Track {
    /// Moves.
    Translation(Vec<[f32; 3]>),
    /// Turns.
    Rotation(Vec<[f32; 4]>),
    /// Scales.
    Scale(Vec<[f32; 3]>),
    /// Weights of morph targets, as many for each key as there are targets.
    Weights(Vec<f32>),
}

/// What a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelPath {
    /// Moves.
    Translation,
    /// Turns.
    Rotation,
    /// Scales.
    Scale,
    /// Weights of morph targets.
    Weights,
}

pub(super) fn read(
    data: &Data<'_>,
    own: &gltf::Animation<'_>,
    pointers: &[PointerChannel],
) -> Result<Clip, GltfFault> {
    use gltf::animation::Property;
    let channels: Result<Vec<Channel>, GltfFault> = own
        .channels()
        .map(|channel| {
            let sampler = channel.sampler();
            let output = sampler.output();
            let steps = steps(&sampler);
            let times = times(data, &sampler)?;
            let track = match channel.target().property() {
                Property::Translation => Track::Translation(data.numbers(&output)?),
                Property::Rotation => Track::Rotation(data.numbers(&output)?),
                Property::Scale => Track::Scale(data.numbers(&output)?),
                Property::MorphTargetWeights => {
                    Track::Weights(data.numbers::<1>(&output)?.into_iter().map(|[weight]| weight).collect())
                }
            };
            let values = match &track {
                Track::Translation(values) | Track::Scale(values) => values.len(),
                Track::Rotation(values) => values.len(),
                Track::Weights(values) => values.len(),
            };
            let keys = times.len() * if steps == Steps::Cubic { 3 } else { 1 };
            let fits = match track {
                Track::Weights(_) => keys > 0 && values % keys == 0,
                _ => keys > 0 && values == keys,
            };
            if !fits {
                return Err(GltfFault::Accessor(output.index()));
            }
            Ok(Channel { node: channel.target().node().index(), times, steps, track })
        })
        .collect();
    let properties: Result<Vec<PropertyChannel>, GltfFault> = pointers
        .iter()
        .filter(|pointer| pointer.animation == own.index())
        .map(|pointer| property(data, own, pointer))
        .collect();
    let name = own.name().unwrap_or_default().to_owned();
    Ok(Clip { name, channels: channels?, properties: properties? })
}

fn property(
    data: &Data<'_>,
    own: &gltf::Animation<'_>,
    pointer: &PointerChannel,
) -> Result<PropertyChannel, GltfFault> {
    let missing = || GltfFault::Document(format!("sampler {} does not exist", pointer.sampler));
    let sampler = own.samplers().nth(pointer.sampler).ok_or_else(missing)?;
    let (times, steps, output) = (times(data, &sampler)?, steps(&sampler), sampler.output());
    let values = match output.dimensions() {
        Dimensions::Scalar => data.numbers::<1>(&output)?.into_flattened(),
        Dimensions::Vec2 => data.numbers::<2>(&output)?.into_flattened(),
        Dimensions::Vec3 => data.numbers::<3>(&output)?.into_flattened(),
        Dimensions::Vec4 => data.numbers::<4>(&output)?.into_flattened(),
        _ => return Err(GltfFault::Accessor(output.index())),
    };
    let keys = times.len() * if steps == Steps::Cubic { 3 } else { 1 };
    if keys == 0 || values.is_empty() || values.len() % keys != 0 {
        return Err(GltfFault::Accessor(output.index()));
    }
    Ok(PropertyChannel { pointer: pointer.path.clone(), times, steps, values })
}

fn steps(sampler: &gltf::animation::Sampler<'_>) -> Steps {
    match sampler.interpolation() {
        gltf::animation::Interpolation::Step => Steps::Step,
        gltf::animation::Interpolation::Linear => Steps::Linear,
        gltf::animation::Interpolation::CubicSpline => Steps::Cubic,
    }
}

/// The times of keys, which follow each other from 0 on.
fn times(data: &Data<'_>, sampler: &gltf::animation::Sampler<'_>) -> Result<Vec<f32>, GltfFault> {
    let times = data.numbers::<1>(&sampler.input())?.into_flattened();
    let ordered = times.is_sorted_by(|a, b| a < b) && times.iter().all(|time| time.is_finite());
    if !ordered || times.first().is_some_and(|first| *first < 0.0) {
        return Err(GltfFault::Times(sampler.input().index()));
    }
    Ok(times)
}

impl PropertyChannel {
    /// Its numbers at a time, in seconds.
    #[must_use]
    pub fn at(&self, time: f64) -> Vec<f64> {
        let at = Moment::new(&self.times, time, self.steps);
        let width = self.values.len() / (self.times.len() * if self.steps == Steps::Cubic { 3 } else { 1 });
        (0..width).map(|k| at.value(|key| f64::from(self.values[key * width + k]))).collect()
    }
}

impl Channel {
    /// Which part of its node it moves.
    #[must_use]
    pub fn path(&self) -> ChannelPath {
        match self.track {
            Track::Translation(_) => ChannelPath::Translation,
            Track::Rotation(_) => ChannelPath::Rotation,
            Track::Scale(_) => ChannelPath::Scale,
            Track::Weights(_) => ChannelPath::Weights,
        }
    }

    /// Its keys as four numbers each, of which a move or a scale has three; none of weights.
    #[must_use]
    pub fn numbers(&self) -> Vec<DVec4> {
        let three = |[x, y, z]: &[f32; 3]| DVec4::new((*x).into(), (*y).into(), (*z).into(), 0.0);
        match &self.track {
            Track::Translation(values) | Track::Scale(values) => values.iter().map(three).collect(),
            Track::Rotation(values) => {
                values.iter().map(|value| DVec4::from_array(value.map(f64::from))).collect()
            }
            Track::Weights(_) => Vec::new(),
        }
    }
}

impl Clip {
    /// Its last key, in seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        let last = |channel: &Channel| channel.times.last().map_or(0.0, |time| f64::from(*time));
        let changed = self.properties.iter().filter_map(|channel| channel.times.last());
        self.channels.iter().map(last).chain(changed.map(|time| f64::from(*time))).fold(0.0, f64::max)
    }

    /// Puts nodes where they are at a time, in seconds; before the first key and after the last they wait.
    pub fn apply(&self, time: f64, nodes: &mut [Node]) {
        for channel in &self.channels {
            let Some(node) = nodes.get_mut(channel.node) else { continue };
            let at = Moment::new(&channel.times, time, channel.steps);
            if let Track::Weights(values) = &channel.track {
                let keys = channel.times.len() * if channel.steps == Steps::Cubic { 3 } else { 1 };
                let targets = values.len() / keys;
                let weight = |k: usize| at.value(|key| f64::from(values[key * targets + k]));
                node.weights = (0..targets).map(weight).collect();
                continue;
            }
            let Place::Parts { translation, rotation, scale } = &mut node.place else { continue };
            match &channel.track {
                Track::Translation(values) => *translation = at.vector(values),
                Track::Scale(values) => *scale = at.vector(values),
                Track::Rotation(values) => *rotation = at.turn(values),
                Track::Weights(_) => {}
            }
        }
    }
}

/// A time between two keys.
struct Moment {
    before: usize,
    after: usize,
    /// From 0 at the one to 1 at the other.
    part: f64,
    /// Seconds from the one to the other.
    span: f64,
    steps: Steps,
}

impl Moment {
    fn new(times: &[f32], time: f64, steps: Steps) -> Self {
        let next = times.partition_point(|key| f64::from(*key) <= time);
        let (before, after) = (next.saturating_sub(1), next.min(times.len() - 1));
        let (start, end) = (f64::from(times[before]), f64::from(times[after]));
        let span = end - start;
        let part = if span > 0.0 { ((time - start) / span).clamp(0.0, 1.0) } else { 0.0 };
        Self { before, after, part, span, steps }
    }

    fn value(&self, key: impl Fn(usize) -> f64) -> f64 {
        let t = self.part;
        match self.steps {
            Steps::Step => key(self.before),
            Steps::Linear => key(self.before) * (1.0 - t) + key(self.after) * t,
            Steps::Cubic => {
                let (start, leaves) = (key(3 * self.before + 1), key(3 * self.before + 2));
                let (arrives, end) = (key(3 * self.after), key(3 * self.after + 1));
                let (t2, t3) = (t * t, t * t * t);
                start * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + leaves * self.span * (t3 - 2.0 * t2 + t)
                    + end * (3.0 * t2 - 2.0 * t3)
                    + arrives * self.span * (t3 - t2)
            }
        }
    }

    fn vector(&self, values: &[[f32; 3]]) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| self.value(|key| f64::from(values[key][k]))))
    }

    fn turn(&self, values: &[[f32; 4]]) -> DQuat {
        let at = |key: usize| DQuat::from_array(values[key].map(f64::from));
        match self.steps {
            Steps::Linear => arc(at(self.before), at(self.after), self.part),
            _ => DQuat::from_array([0, 1, 2, 3].map(|k| self.value(|key| f64::from(values[key][k]))))
                .normalize(),
        }
    }
}

/// Between two turns along the shorter arc.
fn arc(start: DQuat, end: DQuat, part: f64) -> DQuat {
    let cosine = start.dot(end);
    let (end, cosine) = if cosine < 0.0 { (-end, -cosine) } else { (end, cosine) };
    if cosine > 0.9995 {
        return (start * (1.0 - part) + end * part).normalize();
    }
    let angle = acos(cosine.min(1.0));
    let (first, second) = (sin(angle * (1.0 - part)), sin(angle * part));
    ((start * first + end * second) * (1.0 / sin(angle))).normalize()
}
