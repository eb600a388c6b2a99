//! Sweeps: every rule of frames, along open and closed paths, smooth and with corners.

use super::bake;

/// Paths, and the genus of a tube along them.
const PATHS: [(&str, u64); 6] = [
    ("helix = { radius = 1, pitch = 0.6, turns = 1.7 }", 0),
    ("circle = { radius = 1 }", 1),
    ("natural-spline = { closed = true, points = [[1, 0, 0], [0, 0.4, 1], [-1, 0, 0.3], [0, -0.3, -1]] }", 1),
    ("natural-spline = { points = [[0, 0, 0], [1, 0.5, 0.2], [2, -0.5, 0.5], [3, 0.5, 0], [4, 0, 0.3]] }", 0),
    ("polyline = { points = [[0, 0, 0], [2, 0, 0], [2, 0.5, 2], [4, 0.5, 3], [4, 0, 5]] }", 0),
    ("polyline = { closed = true, points = [[0, 0, 0], [2, 0, 0], [2, 0.5, 2], [0, 0.5, 2]] }", 1),
];

const SECTIONS: [&str; 2] = [
    "ellipse = { radii = [0.1, 0.05] }",
    "polyline = { points = [[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]], closed = true }",
];

#[test]
fn every_rule_of_frames_makes_closed_shapes_within_their_bound() {
    for (path, genus) in PATHS {
        for section in SECTIONS {
            for frame in ["rotation-minimizing", "frenet", "up"] {
                // The circle stands upright.
                let up = if frame == "up" && path.starts_with("circle") { "up = [0, 0, 1]" } else { "" };
                let text = format!(
                    "tolerance = 0.004\n[shape.a.sweep]\nprofile = {{ {section} }}\npath = {{ {path} }}\nframe = \"{frame}\"\n{up}\n"
                );
                let baked = bake(&text);
                let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
                assert!(facts.closed && facts.manifold, "{text}: {facts:?}");
                assert_eq!((facts.genus, facts.degenerate_triangles), (Some(genus), 0), "{text}");
                let measured = deviation.measured.expect("asked for");
                assert!(measured <= deviation.bound && deviation.bound <= 0.004, "{text}: {deviation:?}");
                assert!(baked.compiled.warnings.is_empty(), "{text}: {}", baked.compiled.warnings);
            }
        }
    }
}
