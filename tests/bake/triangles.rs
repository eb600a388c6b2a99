//! Bezier triangles: networks without cracks, closed forms, joints as declared.

use core::f64::consts::PI;

use super::{assert_near, bake};

/// The asset of the gallery: eight exact eighths of a ball.
#[test]
fn eight_triangles_are_a_ball() {
    let text = include_str!("../../specs/triangles/ball.toml");
    for (tolerance, near) in [("0.02", 0.2), ("0.002", 0.02)] {
        let baked = bake(&text.replace("tolerance = 0.002", &format!("tolerance = {tolerance}")));
        let facts = &baked.only().facts;
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
        assert_near(facts.volume.expect("closed"), 4.0 * PI / 3.0, near);
        assert_near(facts.area, 4.0 * PI, near);
        assert_eq!(facts.degenerate_triangles, 0);
        let deviation = baked.only().deviation;
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
        for point in &baked.glb.named("ball").positions {
            let [x, y, z] = [point[0], point[1] - 1.0, point[2]];
            let away = (x * x + y * y + z * z).sqrt() - 1.0;
            assert!(away.abs() < 1e-6, "{point:?}");
        }
    }
}

/// Raised to degree 2, a flat triangle stays what it is, and neighbours of different degrees share their side.
#[test]
fn neighbours_of_different_degrees_share_a_side() {
    let baked = bake(
        "[shape.a.bezier-triangles]\n\
         points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.5, 0.5, 0], [1, 0.5, 0], [0.5, 1, 0]]\n\
         triangles = [[0, 1, 2], [3, 5, 6, 1, 4, 2]]\ncontinuity = \"C1\"",
    );
    let facts = &baked.only().facts;
    assert_eq!((facts.components, facts.boundary_loops), (1, 1));
    assert_near(facts.area, 1.0, 1e-6);
}

/// A triangle whose side is drawn together to a point has no triangles without area.
#[test]
fn a_collapsed_side_leaves_no_dust() {
    let baked = bake(
        "tolerance = 1e-3\n[shape.a.bezier-triangles]\n\
         points = [[0, 0, 0], [0.5, 0, 0.4], [0.2, 0.6, 0.3], [1, 0, 0], [1, 0, 0], [1, 0, 0]]",
    );
    let facts = &baked.only().facts;
    assert!(facts.triangles > 0 && facts.degenerate_triangles == 0 && facts.components == 1, "{facts:?}");
}
