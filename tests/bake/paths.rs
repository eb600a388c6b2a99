//! Paths of segments: what they enclose, and what the report says of their joints.

use core::f64::consts::PI;

use super::{assert_near, bake};

const STADIUM: &str = "[curve.stadium.path]\nstart = [0, 0]\nclosed = true\n\
    segments = [{ line = [[2, 0]] }, { arc = { radius = 0.5, angle = 180 } }, { line = [[0, 1]] }, { arc = { to = [0, 0] } }]\n\
    [shape.a]\ntolerance = 1e-5\n[shape.a.extrude]\nheight = 1\nprofile = \"stadium\"\n";

#[test]
fn arcs_that_go_on_make_a_stadium() {
    let baked = bake(STADIUM);
    let facts = &baked.only().facts;
    assert!(facts.closed);
    assert_near(facts.volume.expect("closed"), 2.0 + PI / 4.0, 1e-4);
    let joints = &baked.report().paths["stadium"];
    assert_eq!(joints.len(), 4, "the seam is one of them");
    for (joint, at) in joints.iter().zip([[2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]]) {
        assert_eq!(joint.continuity, "G1");
        let apart = (joint.at[0] - at[0]).abs() + (joint.at[1] - at[1]).abs();
        assert!(apart < 1e-12 && joint.turn < 1e-6, "{joint:?}");
        let mut curvature = joint.curvature.map(|curvature| curvature.expect("it moves"));
        curvature.sort_by(f64::total_cmp);
        assert!(curvature[0] == 0.0 && (curvature[1] - 2.0).abs() < 1e-9, "{curvature:?}");
    }
}

#[test]
fn paths_inside_other_definitions_have_numbers() {
    let baked = bake(
        "[shape.a.extrude]\nheight = 1\n\
         profile = { path = { start = [0, 0], closed = true, segments = [{ line = [[4, 0], [4, 4]] }, { line = [[0, 4]] }] } }\n\
         holes = [{ path = { start = [1, 1], closed = true, segments = [{ line = [[2, 1]] }, { arc = { through = [1.5, 1.5], to = [1, 1] } }] } }]\n",
    );
    let paths = &baked.report().paths;
    assert_eq!(paths.keys().collect::<Vec<_>>(), ["a/1", "a/2"]);
    let outer: Vec<_> = paths["a/1"].iter().map(|joint| joint.continuity.as_str()).collect();
    // Where the second line begins, where the line that closes begins, and at the start.
    assert_eq!(outer, ["G0", "G0", "G0"]);
    assert_near(paths["a/1"][0].turn, 90.0, 1e-9);
}

#[test]
fn what_is_claimed_can_be_asserted() {
    let text = format!("{STADIUM}[assert]\n\"paths.stadium.0.continuity\" = \"G1\"\n");
    assert_eq!(bake(&text).report().assertions.len(), 1);
}
