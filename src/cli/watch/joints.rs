//! How far joints are turned, beside how far they may.

use serde_json::{Value, json};

use super::baked::Asset;
use crate::compile::LimitedJoint;
use crate::motion::Axis;
use crate::preview::{Moment, turns};

/// For each joint that does not turn freely its name, its rotation at rest (x, y, z, w), its ranges about x, y and z
/// (degrees, null for none), and the length of its bone.
pub(super) fn limits(joints: &[LimitedJoint]) -> Value {
    let one = |joint: &LimitedJoint| {
        let ranges = joint.limits.ranges.map(|range| range.map(|range| [range.least, range.most]));
        json!({ "name": joint.name, "rest": joint.rest.to_array(), "ranges": ranges, "length": joint.length })
    };
    joints.iter().map(one).collect()
}

/// The same joints at a moment: for each axis with a range that range and the angle, degrees, and whether it lies within.
pub(super) fn angles(asset: &Asset, moment: &Moment) -> Result<Value, String> {
    let (drawn, _) = asset.drawn(0).map_err(str::to_owned)?;
    let turned = turns(drawn, moment).map_err(|error| error.to_string())?;
    let one = |joint: &LimitedJoint| {
        let node = drawn.nodes.iter().position(|node| node.name == joint.name)?;
        let rotation = (joint.rest.inverse() * turned[node]?).normalize();
        let found = joint.limits.nearest(rotation);
        let axis = |axis: Axis| {
            let range = joint.limits.ranges[axis as usize]?;
            let angle = found[axis as usize];
            // Rotations of files have single precision.
            let within = range.excess(angle) <= 1e-3;
            Some(json!({
                "axis": axis.letter(), "least": range.least, "most": range.most, "angle": angle, "within": within,
            }))
        };
        let axes: Vec<Value> = Axis::ALL.into_iter().filter_map(axis).collect();
        Some(json!({ "name": joint.name, "axes": axes }))
    };
    Ok(asset.compiled.joints.iter().filter_map(one).collect())
}
