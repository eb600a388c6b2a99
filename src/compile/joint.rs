//! The joints of a file that do not turn freely: what a page shows beside their motion.

use glam::DQuat;

use crate::model::Model;
use crate::motion::Limits;
use crate::scene::Scene;

/// A joint with limits.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitedJoint {
    /// The name of its node in the file.
    pub name: String,
    /// How far it turns from rest.
    pub limits: Limits,
    /// Its rotation at rest, relative to its parent.
    pub rest: DQuat,
    /// Length of its bone, metres.
    pub length: f64,
}

/// All of them, in the order of the document.
pub(super) fn limited(model: &Model, scene: &Scene) -> Vec<LimitedJoint> {
    let named = |name: &str| scene.nodes.iter().any(|node| node.name == name);
    let of = |skeleton: &crate::model::NamedSkeleton| {
        let joints = skeleton.skeleton.joints.iter().filter(|joint| joint.bone.limits.any());
        let one = |joint: &crate::motion::Joint| {
            // Where another node has its name, that of the skeleton stands before it.
            let full = format!("{}.{}", skeleton.name, joint.bone.name);
            let name = if named(&full) { full } else { joint.bone.name.clone() };
            LimitedJoint {
                name,
                limits: joint.bone.limits,
                rest: joint.rest.rotation,
                length: joint.length(),
            }
        };
        joints.map(one).collect::<Vec<_>>()
    };
    model.skeletons.iter().flat_map(of).collect()
}
