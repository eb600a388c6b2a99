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

const LINE: &str = "path = { line = { from = [0, 0, 0], to = [0, 2, 0] } }";
const HELIX: &str = "path = { helix = { radius = 1, pitch = 0.8, turns = 1.5 } }";
const BENT: &str =
    "path = { natural-spline = { points = [[0, 0, 0], [1, 0.4, 0], [1, 1.3, 1], [0, 1, 1.5]] } }";
const CORNERED: &str = "path = { polyline = { points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [2, 2, 2]] } }";

const CIRCLE: &str = "profile = { circle = { radius = 0.2 } }";
const BAR: &str = "profile = { polyline = { points = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]], closed = true } }";
const STRIP: &str = "profile = { line = { from = [-0.2, 0], to = [0.2, 0.05] } }";
const DUCT: &str = "profiles = [{ polyline = { points = [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]], closed = true } }, { circle = { radius = 0.15 } }]";
const STAR: &str = "profiles = [{ circle = { radius = 0.1 } }, { polyline = { points = { count = 10, each = \"= [(0.1 + 0.1 * (i % 2)) * cos(36 * i), (0.1 + 0.1 * (i % 2)) * sin(36 * i)]\" }, closed = true } }, { ellipse = { radii = [0.2, 0.1] } }, { circle = { radius = 0.05 } }]\nblend = \"smooth\"";

const CHANGES: [&str; 8] = [
    "",
    "scale = 0",
    "scale = 2.5",
    "scale = [0, 1, 0.5, 0]",
    "scale = [{ at = 0, factor = 0.3 }, { at = 0.7, factor = 1 }, { at = 1, factor = 0 }]",
    "scale = [{ at = 0, factor = [1, 0.2] }, { at = 0.7, factor = [0.2, 1] }, { at = 1, factor = [1, 0.1] }]",
    "scale = { arc = { center = [0, 0], radius = 1, from = 90, to = 0 } }",
    "scale = { natural-spline = { points = [[0, 1], [0.2, 0.4], [0.6, 1.2], [1, 0.3]] } }",
];

/// Every profile along every path, each under other changes: solid, without a triangle that has no area, within its
/// bound.
#[test]
fn sections_that_change_keep_their_bound() {
    let mut failed = Vec::new();
    for (row, path) in [LINE, HELIX, BENT, CORNERED].into_iter().enumerate() {
        for (column, profile) in [CIRCLE, BAR, STRIP, DUCT, STAR].into_iter().enumerate() {
            for (change, twist) in [(5 * row + column, 0), (3 * row + column + 2, 150)] {
                let change = CHANGES[change % CHANGES.len()];
                let text = format!(
                    "tolerance = 0.01\n[shape.a.sweep]\n{profile}\n{path}\n{change}\ntwist = {twist}\n"
                );
                let baked = bake(&text);
                let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
                let solid = profile != STRIP;
                let measured = deviation.measured.expect("asked for");
                let within = measured <= deviation.bound && deviation.bound <= 0.01;
                let whole = (facts.closed, facts.degenerate_triangles) == (solid, 0);
                if !within || !whole || !baked.compiled.warnings.is_empty() {
                    failed.push(format!("{text}{facts:?}\n{deviation:?}\n{}", baked.compiled.warnings));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} of 40\n{}", failed.len(), failed.join("\n"));
}
