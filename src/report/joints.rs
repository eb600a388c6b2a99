//! How the segments of each path meet.

use indexmap::IndexMap;
use serde::Serialize;

use crate::geometry::curve::{Curve as _, Meeting, Path};
use crate::model::Model;

/// A joint of a path: of the exact curve, in the document's unit and axes.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct JointFacts {
    /// Where it is.
    pub at: [f64; 3],
    /// The best that holds: "gap", "G0", "G1", "C1", "G2" (with or without C1) or "C2". Each segment takes one unit
    /// of the parameter.
    pub continuity: String,
    /// By how much the direction turns, degrees.
    pub turn: f64,
    /// One over the radius before and after; null where the curve stands still.
    pub curvature: [Option<f64>; 2],
}

/// The joints of all paths, in their order; the seam of a closed path last.
pub(super) fn joints(model: &Model) -> IndexMap<String, Vec<JointFacts>> {
    model.paths.iter().map(|named| (named.name.clone(), of_path(&named.path))).collect()
}

fn of_path(path: &Path) -> Vec<JointFacts> {
    let seam = path.is_closed().then_some(0);
    (1..path.curves().len()).chain(seam).map(|joint| facts(&path.meeting(joint))).collect()
}

fn facts(meeting: &Meeting) -> JointFacts {
    let finite = |curvature: f64| curvature.is_finite().then_some(curvature);
    JointFacts {
        at: meeting.point.to_array(),
        continuity: meeting.continuity().to_string(),
        turn: meeting.turn.to_degrees(),
        curvature: meeting.curvature.map(|curvature| finite(curvature.length())),
    }
}
