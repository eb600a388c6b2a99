//! The tolerance: how the error follows it, and with how few triangles it is kept.

use core::f64::consts::PI;

use kiln::geometry::number::ln;

use kiln::compile::Options;
use kiln::report::facts::MeshFacts;

use super::{bake, compile};

/// What the report says of a large mesh: here the other reader's checks are left out, they would take longer than all else.
fn facts(text: &str) -> MeshFacts {
    let compiled = compile(text, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    compiled.report.expect("a report was asked for").shapes[0].facts.clone()
}

const SPHERE: &str = "[shape.a.sphere]\nradius = 1";
const TORUS: &str = "[shape.a.revolve]\nprofile = { circle = { radius = 0.3, center = [1, 0] } }";
const COIL: &str = "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { helix = { radius = 1, pitch = 0.5, turns = 1 } }";

/// The slope of a line fitted to logarithms: the power of the first numbers that the second ones follow.
pub(super) fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (ln(*x), ln(*y))).collect();
    let count = logs.len() as f64;
    let (x, y) = logs.iter().fold((0.0, 0.0), |sum, (x, y)| (sum.0 + x / count, sum.1 + y / count));
    let across: f64 = logs.iter().map(|(a, b)| (a - x) * (b - y)).sum();
    across / logs.iter().map(|(a, _)| (a - x) * (a - x)).sum::<f64>()
}

/// Area and volume err by the second power of the edges' length, so by the first of the tolerance.
#[test]
fn area_and_volume_converge_with_the_tolerance() {
    let coil = (4.0 * PI * PI + 0.25_f64).sqrt();
    for (text, area, volume) in [
        (SPHERE, 4.0 * PI, 4.0 * PI / 3.0),
        (TORUS, 4.0 * PI * PI * 0.3, 2.0 * PI * PI * 0.09),
        (COIL, 2.0 * PI * 0.1 * coil + 2.0 * PI * 0.01, PI * 0.01 * coil),
        (
            "[shape.a.extrude]\nheight = 1\nprofile = { circle = { radius = 1 } }\nholes = [{ circle = { radius = 0.5 } }]",
            2.0 * PI * 0.75 + 3.0 * PI,
            0.75 * PI,
        ),
    ] {
        let (mut areas, mut volumes) = (Vec::new(), Vec::new());
        for k in 0..=6 {
            // Down to a thousandth.
            let tolerance = if k == 6 { 1e-5 } else { 1e-2 / f64::from(1 << (2 * k)) };
            let facts = facts(&format!("tolerance = {tolerance}\n{text}"));
            areas.push((tolerance, (facts.area - area).abs()));
            volumes.push((tolerance, (facts.volume.expect("closed") - volume).abs()));
        }
        assert!(areas[0].0 / areas[6].0 >= 999.0, "three decades");
        assert!(exponent(&areas) >= 0.9, "{text}: area {}: {areas:?}", exponent(&areas));
        assert!(exponent(&volumes) >= 0.9, "{text}: volume {}: {volumes:?}", exponent(&volumes));
    }
}

/// The optimum: the integral of sqrt |K| over the surface, by twice the tolerance.
#[test]
fn doubly_curved_shapes_need_few_triangles() {
    // On the sphere K = 1; on the torus the integral of sqrt |cos t / (r (R + r cos t))| (R + r cos t) r by both angles.
    let torus: f64 = (0..100_000)
        .map(|k| {
            let t = 2.0 * PI * (f64::from(k) + 0.5) / 100_000.0;
            let cosine = kiln::geometry::number::cos(t);
            (cosine.abs() * 0.3 * (1.0 + 0.3 * cosine)).sqrt() * 2.0 * PI / 100_000.0
        })
        .sum::<f64>()
        * 2.0
        * PI;
    for (text, integral) in [(SPHERE, 4.0 * PI), (TORUS, torus)] {
        for tolerance in [1e-3, 1e-4, 3e-5] {
            let optimum = integral / (2.0 * tolerance);
            let ratio = facts(&format!("tolerance = {tolerance}\n{text}")).triangles as f64 / optimum;
            assert!(ratio <= 1.5, "{text} at {tolerance}: {ratio:.3} of the optimum");
            assert!(ratio >= 0.8, "{text} at {tolerance}: fewer than can be, {ratio:.3}");
        }
    }
}

/// A fixed grid is exactly as fine as it is written.
#[test]
fn segments_give_a_grid() {
    for (text, triangles) in [
        ("[shape.a]\nsegments = [12, 6]\n[shape.a.sphere]\nradius = 1", 12 * 6 * 2 - 2 * 12),
        (
            "[shape.a]\nsegments = [8, 5]\n[shape.a.revolve]\nprofile = { circle = { radius = 0.3, center = [1, 0] } }",
            80,
        ),
        (
            "[shape.a]\nsegments = [7, 3]\n[shape.a.extrude]\nheight = 1\nprofile = { circle = { radius = 1 } }",
            7 * 3 * 2 + 2 * 5,
        ),
        (
            "[shape.a]\nsegments = [6, 9]\n[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { circle = { radius = 1 } }",
            6 * 9 * 2,
        ),
    ] {
        let baked = bake(text);
        assert_eq!(baked.only().facts.triangles, triangles, "{text}");
        let deviation = baked.only().deviation;
        assert!(
            deviation.tolerance.is_none() && deviation.bound >= deviation.measured.expect("asked for"),
            "{text}: {deviation:?}"
        );
    }
}

/// Without a tolerance a shape is as fine as its size: the diagonal of its box by 2000.
#[test]
fn the_default_tolerance_follows_the_size() {
    for size in [1e-3, 1.0, 1e3] {
        let baked = bake(&format!("[shape.a.sphere]\nradius = {size}"));
        let deviation = baked.only().deviation;
        let expected = size * 2.0 * 3.0_f64.sqrt() / 2000.0;
        let tolerance = deviation.tolerance.expect("a tolerance");
        assert!((tolerance / expected - 1.0).abs() < 1e-6, "{tolerance} instead of {expected}");
    }
    let counts = [1e-3, 1.0, 1e3]
        .map(|size| bake(&format!("[shape.a.sphere]\nradius = {size}")).only().facts.triangles);
    assert!(counts.iter().all(|count| *count == counts[0]), "{counts:?}");
}

/// A finer tolerance than single precision can hold at this place is told, not promised.
#[test]
fn rounding_counts_in_the_bound() {
    let far = bake("tolerance = 0.001\n[shape.a.sphere]\nradius = 1\ncenter = [30000, 0, 0]");
    let deviation = far.only().deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
    assert!(deviation.bound > 0.001, "positions near 30000 are rounded by up to 0.001: {deviation:?}");
    assert_eq!(far.compiled.warnings.len(), 1, "{}", far.compiled.warnings);
    let near = bake("tolerance = 0.001\n[shape.a.sphere]\nradius = 1\ncenter = [3000, 0, 0]");
    assert!(near.only().deviation.bound <= 0.001, "{:?}", near.only().deviation);
    assert!(near.compiled.warnings.is_empty());
}

/// Samples at whole turns all look alike: neither a coil nor a twist may pass for a straight line.
#[test]
fn whole_turns_are_not_taken_for_straight() {
    let mut last = 0;
    for turns in [4, 8, 16] {
        let baked = bake(&format!(
            "tolerance = 0.02\n[shape.a.sweep]\nprofile = {{ circle = {{ radius = 0.1 }} }}\n\
             path = {{ helix = {{ radius = 1, pitch = 0.5, turns = {turns} }} }}"
        ));
        let (shape, length) = (baked.only(), f64::from(turns) * (4.0 * PI * PI + 0.25_f64).sqrt());
        let measured = shape.deviation.measured.expect("asked for");
        assert!(measured <= shape.deviation.bound && shape.deviation.bound <= 0.02, "{:?}", shape.deviation);
        let volume = shape.facts.volume.expect("closed");
        assert!((volume / (PI * 0.01 * length) - 1.0).abs() < 0.3, "{turns} turns: {volume}");
        assert!(shape.facts.triangles > last, "{turns} turns: {} triangles", shape.facts.triangles);
        last = shape.facts.triangles;
    }
    for twist in [360, 720, 1440] {
        let baked = bake(&format!(
            "tolerance = 0.01\n[shape.a.sweep]\nprofile = {{ ellipse = {{ radii = [0.2, 0.1] }} }}\n\
             path = {{ line = {{ from = [0, 0, 0], to = [0, 0, 1] }} }}\ntwist = {twist}"
        ));
        let shape = baked.only();
        let measured = shape.deviation.measured.expect("asked for");
        assert!(
            measured <= shape.deviation.bound && shape.deviation.bound <= 0.01,
            "{twist}: {:?}",
            shape.deviation
        );
        // The least that one radian for each row allows.
        assert!(
            shape.facts.triangles > 20 * twist / 58,
            "{twist} degrees: {} triangles",
            shape.facts.triangles
        );
    }
}

/// A document's tolerance is that of the result, whatever maps a shape passes through.
#[test]
fn scaled_copies_keep_the_tolerance_of_the_document() {
    for text in [
        "[shape.a]\nscale = 10\n[shape.a.copy]\nof = { sphere = { radius = 0.1 } }",
        "[shape.a]\nscale = [1, 8, 2]\n[shape.a.array]\nof = { copy = { of = \"b\" } }\ncount = 2\noffset = [3, 0, 0]\n\
         [shape.b]\nscale = 5\n[shape.b.sphere]\nradius = 0.2",
        "[shape.a]\nscale = 10\ntolerance = 0.001\n[shape.a.group]\nof = [{ sphere = { radius = 0.1 } }]",
    ] {
        let baked = bake(&format!("tolerance = 0.001\n{text}"));
        let deviation = baked.only().deviation;
        assert!(deviation.bound <= 0.001 && deviation.bound > 0.0001, "{text}: {deviation:?}");
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{text}: {deviation:?}");
        assert!((deviation.tolerance.expect("a tolerance") - 0.001).abs() < 1e-9, "{text}: {deviation:?}");
    }
}

/// Twisted surfaces lean against their sections: the bound holds for them too.
#[test]
fn bounds_hold_on_twisted_sections() {
    let (line, helix, bent) = (
        "line = { from = [0, 0, 0], to = [0, 0, 1] }",
        "helix = { radius = 1, pitch = 0.3, turns = 0.7 }",
        "natural-spline = { points = [[0, 0, 0], [1, 0.4, 0], [1, 1.3, 1], [0, 1, 1.5]] }",
    );
    for profile in [
        "ellipse = { radii = [0.2, 0.1] }",
        "ellipse = { radii = [0.2, 0.02] }",
        "polyline = { points = [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]], closed = true }",
        "line = { from = [-0.1, 0], to = [0.3, 0.05] }",
    ] {
        for (path, twist) in [(line, 50), (line, 1440), (line, 5000), (helix, 50), (helix, 1440), (bent, 360)]
        {
            let text = format!(
                "tolerance = 0.02\n[shape.a.sweep]\nprofile = {{ {profile} }}\npath = {{ {path} }}\ntwist = {twist}"
            );
            let options = Options { measure: true, ..Options::default() };
            let compiled = compile(&text, &options).unwrap_or_else(|found| panic!("{found}"));
            let deviation = compiled.report.expect("a report was asked for").shapes[0].deviation;
            assert!(deviation.bound <= 0.02, "{text}: {deviation:?}");
            assert!(deviation.measured.expect("asked for") <= deviation.bound, "{text}: {deviation:?}");
        }
    }
}
