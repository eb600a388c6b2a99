//! Weights that follow the angles of joints, as they stand in the file.

use glam::DQuat;
use indexmap::IndexMap;
use serde::Serialize;

use super::{Path, Stage, played, vector};
use crate::gltf::{ReadAnimation, ReadChannel};
use crate::model::{Model, Target};
use crate::motion::{Axis, Course};

/// Steps of a clip at which weights are held against angles.
const STEPS: u32 = 64;

/// Steps from one moment that is told to the next.
const TOLD: u32 = 8;

/// A weight that follows the angle of a joint.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct DriverFacts {
    /// The node that shows the shape.
    pub node: String,
    /// The number of the state among those of its mesh.
    pub target: usize,
    /// The node of the joint.
    pub joint: String,
    /// The axis of the angle, as limits take rotations apart.
    pub axis: &'static str,
    /// Degrees at which the weight is 0.
    pub from: f64,
    /// Degrees at which it is 1.
    pub to: f64,
    /// The greatest difference between the weight in the file and the one of the angle in the file, at 65 times: both are
    /// kept within the clip's tolerance, each by keys of its own.
    pub worst: f64,
    /// Some moments.
    pub frames: Vec<DriverFrame>,
}

/// A moment of a weight that follows an angle, played from the file.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct DriverFrame {
    /// Seconds.
    pub time: f64,
    /// Degrees.
    pub angle: f64,
    /// The weight.
    pub weight: f64,
}

impl Stage<'_> {
    /// How the weights of a clip follow the joints that drive them, by the names of their nodes and states.
    pub(super) fn drivers(
        &self,
        animation: &ReadAnimation,
        model: &Model,
        (clip, duration): (&str, f64),
    ) -> IndexMap<String, DriverFacts> {
        let clip = model.clips.iter().find(|known| known.name == clip);
        let mut all = IndexMap::new();
        for track in clip.into_iter().flat_map(|clip| &clip.tracks) {
            let (Target::Weight { node, target }, Course::Driven { ramp, .. }) =
                (track.target, &track.course)
            else {
                continue;
            };
            let own = &model.nodes[node];
            let Some(shape) = own.shape.filter(|_| !own.is_copy) else { continue };
            let Some(morph) = model.morphs_of(shape).nth(target) else { continue };
            let Some(driver) = &morph.driver else { continue };
            let joint = self.joint_node(model, (driver.skeleton, driver.joint));
            let find = |wanted: usize, path: Path| {
                animation.channels.iter().find(|channel| (channel.node, channel.path) == (wanted, path))
            };
            let frame = |time: f64| {
                let turned = find(joint, Path::Rotation).map_or(self.rest[joint].rotation, |channel| {
                    DQuat::from_vec4(vector(&played(channel, time))).normalize()
                });
                let rotation = self.rest[joint].rotation.conjugate() * turned;
                let weights = find(node, Path::Weight).map_or_else(
                    || self.weights[node].clone(),
                    |channel: &ReadChannel| played(channel, time),
                );
                let weight = weights.get(target).copied().unwrap_or(0.0);
                (DriverFrame { time, angle: ramp.angle(rotation), weight }, ramp.weight(rotation))
            };
            let times = (0..=STEPS).map(|k| duration * f64::from(k) / f64::from(STEPS));
            let frames: Vec<(DriverFrame, f64)> = times.map(frame).collect();
            let apart = |(frame, wanted): &(DriverFrame, f64)| (frame.weight - wanted).abs();
            let facts = DriverFacts {
                node: self.name(node),
                target,
                joint: self.name(joint),
                axis: match ramp.axis {
                    Axis::X => "x",
                    Axis::Y => "y",
                    Axis::Z => "z",
                },
                from: ramp.from,
                to: ramp.to,
                worst: frames.iter().map(apart).fold(0.0, f64::max),
                frames: frames.iter().step_by(TOLD as usize).map(|(frame, _)| *frame).collect(),
            };
            all.insert(format!("{}.{}", self.name(node), morph.name), facts);
        }
        all
    }
}
