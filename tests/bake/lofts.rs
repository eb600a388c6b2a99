//! Surfaces through rows of profiles: volumes and areas of closed forms, and how they are reached.

use core::f64::consts::PI;

use kiln::compile::Options;
use kiln::geometry::curve::{Curve as _, Side};
use kiln::geometry::number::{cos, pow, sin, sin_cos};
use kiln::language::Document;

use super::accuracy::exponent;
use super::{assert_near, bake, compile};

/// The volume of a solid, which must be one, within its bound where that is quickly measured.
fn volume(text: &str, tolerance: f64) -> f64 {
    let baked = bake(&format!("tolerance = 0.01\n{text}"));
    let deviation = baked.only().deviation;
    let measured = deviation.measured.expect("asked for");
    assert!(measured <= deviation.bound, "{text}: {deviation:?}");
    let compiled = compile(&format!("tolerance = {tolerance}\n{text}"), &Options::default());
    let report = compiled.unwrap_or_else(|found| panic!("{found}")).report.expect("a report");
    let (facts, deviation) = (&report.shapes[0].facts, report.shapes[0].deviation);
    assert!(facts.closed && facts.manifold && facts.components == 1, "{text}: {facts:?}");
    assert!(deviation.bound <= tolerance, "{text}: {deviation:?}");
    let volume = facts.volume.expect("closed");
    assert!(volume > 0.0, "inside out: {text}");
    volume
}

fn square_of_cosine(degrees: f64) -> f64 {
    let cosine = cos(degrees.to_radians());
    cosine * cosine
}

const CIRCLES: &str = "profiles = [{ circle = { radius = 1 } }, \
     { curve = { circle = { radius = 0.4 } }, at = [0, 0, 1] }, \
     { curve = { circle = { radius = 0.7 } }, at = [0, 0, 3] }]";

#[test]
fn straight_lofts_of_circles_are_frustums() {
    let frustum = |a: f64, b: f64, height: f64| PI * height / 3.0 * (a * a + a * b + b * b);
    let text = format!("[shape.a.loft]\nacross = \"linear\"\n{CIRCLES}");
    assert_near(volume(&text, 4e-4), frustum(1.0, 0.4, 1.0) + frustum(0.4, 0.7, 2.0), 3e-3);
    // A rim that turns the edge keeps its own normals on both sides.
    let facts = bake(&format!("tolerance = 0.001\n{text}")).only().facts.clone();
    assert!(facts.vertices > facts.points + facts.points / 10, "{facts:?}");
}

/// Sections of a ruled solid between polygons grow quadratically, so three of them give the volume exactly (the
/// prismoidal formula).
#[test]
fn a_square_turned_on_its_way_up_is_a_prismoid() {
    let text = "[curve.s.polyline]\npoints = [[1, -1], [1, 1], [-1, 1], [-1, -1]]\nclosed = true\n\
         [shape.a.loft]\nacross = \"linear\"\nprofiles = [\"s\", { curve = \"s\", rotate = [0, 0, 40], at = [0, 0, 3] }]";
    // Without corners to hold to, the closest points of two squares are not their corners, unless they may not move.
    for matching in [
        "matching = \"auto\"",
        "matching = \"corners\"",
        "matching = \"length\"\nalign = false",
        "matching = \"parameter\"\nalign = false",
    ] {
        let middle = 4.0 * square_of_cosine(20.0);
        let volume = volume(&format!("{text}\n{matching}"), 4e-4);
        assert_near(volume, 3.0 / 6.0 * (4.0 + 4.0 * middle + 4.0), 1e-3);
    }
    // As they are written, corner 1 goes to a corner 130 degrees further on: nearly through the middle.
    let text = text.replace("rotate = [0, 0, 40]", "rotate = [0, 0, 130]");
    let text = &text;
    let aligned = volume(text, 4e-4);
    assert_near(aligned, 2.0 * (2.0 + 4.0 * square_of_cosine(20.0)), 1e-3);
    let middle = 4.0 * square_of_cosine(65.0);
    let own = volume(&format!("{text}\nalign = false"), 4e-4);
    assert_near(own, 3.0 / 6.0 * (4.0 + 4.0 * middle + 4.0), 4e-3);
}

/// Between two triangles of different sense, or with another start, the least way is found.
#[test]
fn profiles_are_turned_to_lie_closest() {
    let text = |points: &str| {
        format!(
            "[shape.a.loft]\nacross = \"linear\"\nprofiles = [{{ polyline = {{ points = [[0, 0], [3, 0], [0, 4]], closed = true }} }}, \
             {{ curve = {{ polyline = {{ points = {points}, closed = true }} }}, at = [0, 0, 2] }}]"
        )
    };
    for points in ["[[0, 0], [3, 0], [0, 4]]", "[[3, 0], [0, 4], [0, 0]]", "[[0, 4], [3, 0], [0, 0]]"] {
        assert_near(volume(&text(points), 1e-3), 12.0, 1e-9);
    }
}

/// Pi times the integral of r^2 dz along an outline: what it holds when it is turned about the axis.
fn turned(curve: &str) -> f64 {
    const STEPS: u32 = 20_000;
    let text = format!("{curve}\n[shape.x.box]\nsize = [1, 1, 1]");
    let files = super::inputs().with("spec.toml", text.as_bytes());
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let curve = kiln::compile::curve(&document, &files, &Options::default(), "s");
    let curve = curve.unwrap_or_else(|found| panic!("{found}")).expect("it is there");
    let domain = curve.domain();
    let slice = |k: u32| {
        let jet = curve.evaluate(domain.at((f64::from(k) + 0.5) / f64::from(STEPS)), Side::After);
        jet.point.x * jet.point.x * jet.first.y
    };
    PI * (0..STEPS).map(slice).sum::<f64>() * domain.span() / f64::from(STEPS)
}

/// A spline through circles about one axis is what the spline through their radii makes when it is turned.
#[test]
fn smooth_lofts_of_circles_are_surfaces_of_revolution() {
    let outline = "[curve.s.spline]\npoints = [[1, 0], [0.4, 1], [0.7, 3]]\n";
    for (loft, spline) in [
        ("", ""),
        ("start = \"not-a-knot\"\nend = \"not-a-knot\"", "ends = \"not-a-knot\""),
        ("start = \"straight\"", "start = { first = [0, 1] }"),
        ("end = \"straight\"", "end = { first = [0, 1] }"),
        ("start = { first = [0, 0, 2] }", "start = { first = [0, 2] }"),
    ] {
        let found = volume(&format!("[shape.a.loft]\n{loft}\n{CIRCLES}"), 4e-4);
        assert_near(found, turned(&format!("{outline}{spline}")), 2e-3);
    }
}

const EGG: &str = "[shape.a.loft]\nstart = \"round\"\nend = \"round\"\n\
     profiles = [[0, 0, -1], { circle = { radius = 1 } }, [0, 0, 1.6]]";

#[test]
fn round_tips_have_one_normal_and_pointed_ones_many() {
    let outline = "[curve.s.spline]\npoints = [[0, -1], [1, 0], [0, 1.6]]\n\
         start = { first = [1, 0] }\nend = { first = [-1, 0] }";
    assert_near(volume(EGG, 4e-4), turned(outline), 2e-3);
    let facts = bake(&format!("tolerance = 0.001\n{EGG}")).only().facts.clone();
    assert_eq!(facts.vertices, facts.points, "smooth all over: {facts:?}");
    let pointed = EGG.replace("\"round\"", "\"natural\"");
    let facts = bake(&format!("tolerance = 0.001\n{pointed}")).only().facts.clone();
    assert!(facts.vertices > facts.points + 10, "{facts:?}");
    let outline = "[curve.s.natural-spline]\npoints = [[0, -1], [1, 0], [0, 1.6]]";
    assert_near(volume(&pointed, 4e-4), turned(outline), 2e-3);
}

/// Eight circles on a ring: the periodic spline leaves the torus by a 384th of the fourth power of its step.
#[test]
fn a_closed_loft_is_a_ring() {
    let profile = |k: u32| {
        let angle = f64::from(k) * 45.0;
        let (sin, cos) = sin_cos(angle.to_radians());
        format!(
            "{{ curve = {{ circle = {{ radius = 0.4 }} }}, rotate = [0, {}, 0], at = [{}, 0, {}] }}",
            -angle,
            2.0 * cos,
            2.0 * sin
        )
    };
    let profiles: Vec<String> = (0..8).map(profile).collect();
    let text = format!("[shape.a.loft]\nclosed = true\nprofiles = [{}]", profiles.join(", "));
    let torus = 2.0 * PI * PI * 2.0 * 0.16;
    assert_near(volume(&text, 4e-4), torus, 6e-3);
    let facts = bake(&format!("tolerance = 0.001\n{text}")).only().facts.clone();
    assert_eq!((facts.genus, facts.vertices), (Some(1), facts.points));
    // Straight from circle to circle: eight wedges of elliptic sections, with an edge at each circle.
    let text = text.replace("closed", "across = \"linear\"\nclosed");
    let section = PI * 0.16 * cos(PI / 8.0);
    let ring = 8.0 * section * 2.0 * (2.0 * sin(PI / 8.0));
    let found = volume(&text, 4e-4);
    assert!((found / ring - 1.0).abs() < 0.02, "{found} {ring}");
}

#[test]
fn volumes_converge_over_three_decades() {
    let outline = "[curve.s.natural-spline]\npoints = [[1, 0], [0.4, 1], [0.7, 3]]";
    let exact = turned(outline);
    let points: Vec<(f64, f64)> = (0..=6)
        .map(|k| {
            let tolerance = 2e-1 * pow(10.0, -f64::from(k) / 2.0);
            let text = format!("tolerance = {tolerance}\n[shape.a.loft]\n{CIRCLES}");
            let compiled = compile(&text, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
            let found = compiled.report.expect("a report").shapes[0].facts.volume.expect("closed");
            (tolerance, (found - exact).abs())
        })
        .collect();
    let exponent = exponent(&points);
    assert!(exponent >= 0.9, "{exponent}: {points:?}");
}

#[test]
fn an_open_loft_of_different_curves_lies_within_its_bound() {
    let text = "[shape.a.loft]\nprofiles = [{ arc = { radius = 1, from = 0, to = 180 } }, \
         { curve = { natural-spline = { points = [[1.2, 0], [0.5, 0.9], [-0.4, 0.7], [-1, 0.1]] } }, at = [0, 0, 1] }, \
         { curve = { polyline = { points = [[1, 0], [0, 1.4], [-1, 0]] } }, at = [0, 0.1, 2] }, [0, 0.4, 2.7]]";
    for tolerance in [0.05, 0.005, 0.0005] {
        let baked = bake(&format!("tolerance = {tolerance}\n{text}"));
        let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
        assert!(!facts.closed && facts.components == 1, "{facts:?}");
        assert!(deviation.bound <= tolerance, "{deviation:?}");
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{deviation:?}");
    }
}

/// Through circles in one plane the surface folds along a ring, where no triangle is ever good: it ends all the same,
/// and says how far it may be off.
#[test]
fn a_loft_that_folds_in_its_own_plane_comes_to_an_end() {
    let text = "tolerance = 0.05\n[shape.a.loft]\nprofiles = [{ circle = { radius = 1 } }, \
         { circle = { radius = 2 } }, { circle = { radius = 1.5 } }]\ncaps = false";
    let compiled = compile(text, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let shape = &compiled.report.expect("a report").shapes[0];
    assert!(shape.facts.triangles < 400_000, "{}", shape.facts.triangles);
    let told = compiled.warnings.iter().any(|warning| warning.message.contains("more than its tolerance"));
    assert_eq!(told, shape.deviation.bound > 0.05, "{:?}", shape.deviation);
    let bounds = shape.facts.bounds.expect("there are points");
    assert!(bounds.max[0] >= 2.0 - 0.05 && bounds.max[0] < 2.1, "{bounds:?}");
}
