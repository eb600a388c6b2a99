//! Deformed shapes: volumes of closed forms, what is kept, and how exactly the deformed surface is met.

use core::f64::consts::PI;

use kiln::compile::Options;
use kiln::geometry::number::pow;

use super::accuracy::exponent;
use super::{Baked, assert_near, bake, compile};

/// The volume of a deformed solid, which must still be one, within its bound where that is quickly measured.
fn volume(text: &str, tolerance: f64) -> f64 {
    let baked = bake(&format!("tolerance = 0.02\n{text}"));
    let deviation = baked.only().deviation;
    let measured = deviation.measured.expect("asked for");
    assert!(measured <= deviation.bound && deviation.bound <= 0.02, "{text}: {deviation:?}");
    let compiled = compile(&format!("tolerance = {tolerance}\n{text}"), &Options::default());
    let report = compiled.unwrap_or_else(|found| panic!("{found}")).report.expect("a report");
    let (facts, deviation) = (&report.shapes[0].facts, report.shapes[0].deviation);
    assert!(facts.closed && facts.manifold && facts.components == 1, "{text}: {facts:?}");
    assert!(deviation.bound <= tolerance, "{text}: {deviation:?}");
    facts.volume.expect("closed")
}

const BOX: &str = "of = { box = { size = [0.4, 3, 0.2] } }";

#[test]
fn twisting_keeps_the_volume() {
    for (text, expected) in [
        (format!("[shape.a.twist]\n{BOX}\nangle = 200"), 0.24),
        (format!("[shape.a.twist]\n{BOX}\nangle = -75\nfrom = -0.5\nto = 1"), 0.24),
        (format!("[shape.a.twist]\n{BOX}\nangle = 90\naround = [0.3, 0, 0.1]"), 0.24),
        ("[shape.a.twist]\nof = { cylinder = { radius = 0.3, height = 2 } }\nangle = 300\naround = [0.2, 0, 0]".to_owned(), PI * 0.18),
        // A cylinder about its own axis is the same cylinder.
        ("[shape.a.twist]\nof = { cylinder = { radius = 0.3, height = 2 } }\nangle = 300".to_owned(), PI * 0.18),
    ] {
        assert_near(volume(&text, 5e-4), expected, 6e-3);
    }
}

/// Pappus: the area of the section times the way of its center.
#[test]
fn a_bend_holds_what_pappus_says() {
    let turn = 120_f64.to_radians();
    let ring = PI * 0.04;
    for (text, expected) in [
        (format!("[shape.a.bend]\n{BOX}\nangle = 120"), 0.24),
        (format!("[shape.a.bend]\n{BOX}\nangle = 120\naround = [0.2, 0, 0]"), 0.08 * (3.0 + 0.2 * turn)),
        (format!("[shape.a.bend]\n{BOX}\nangle = -120\naround = [0.2, 0, 0]"), 0.08 * (3.0 - 0.2 * turn)),
        (format!("[shape.a.bend]\n{BOX}\nangle = 120\nfrom = 0\nto = 1\ntoward = \"z\""), 0.24),
        (
            "[shape.a.bend]\nof = { cylinder = { radius = 0.2, height = 3 } }\nangle = 250\naround = [-0.1, 0, 0]".to_owned(),
            ring * (3.0 - 0.1 * 250_f64.to_radians()),
        ),
        (
            "[shape.a.along]\nof = { box = { size = [0.4, 0.2, 3] } }\npath = { arc = { radius = 2, from = 0, to = 90 } }\nstretch = true".to_owned(),
            0.08 * PI,
        ),
        (
            "[shape.a.along]\nof = { cylinder = { radius = 0.2, height = 3 } }\naxis = \"y\"\npath = { arc = { radius = 2, from = 0, to = 90 } }".to_owned(),
            ring * 3.0,
        ),
    ] {
        assert_near(volume(&text, 5e-4), expected, 6e-3);
    }
}

#[test]
fn a_taper_makes_frustums() {
    let frustum = |a: f64, b: f64, height: f64| height / 3.0 * (a * a + a * b + b * b);
    for (text, expected) in [
        (format!("[shape.a.taper]\n{BOX}\nfactor = 0.4"), 0.08 * frustum(1.0, 0.4, 3.0)),
        (format!("[shape.a.taper]\n{BOX}\nfactor = 0.4\nstart = 2"), 0.08 * frustum(2.0, 0.4, 3.0)),
        (
            format!("[shape.a.taper]\n{BOX}\nfactor = 0.5\nfrom = -0.5\nto = 0.5"),
            0.08 * (1.0 + frustum(1.0, 0.5, 1.0) + 0.25),
        ),
        (
            "[shape.a.taper]\nof = { cylinder = { radius = 0.3, height = 2 } }\nfactor = 0.2".to_owned(),
            PI * 0.09 * frustum(1.0, 0.2, 2.0),
        ),
    ] {
        assert_near(volume(&text, 5e-4), expected, 6e-3);
    }
}

/// The triangles are within the tolerance of the curved surface, and no finer than that by much.
#[test]
fn volumes_converge_over_three_decades() {
    for (text, exact) in [
        ("[shape.a.twist]\nof = { box = { size = [0.4, 2, 0.4] } }\nangle = 60", 0.32),
        ("[shape.a.bend]\nof = { cylinder = { radius = 0.2, height = 3 } }\nangle = 80", PI * 0.12),
    ] {
        let points: Vec<(f64, f64)> = (0..=3)
            .map(|k| {
                let tolerance = 5e-2 * pow(10.0, -f64::from(k));
                let compiled = compile(&format!("tolerance = {tolerance}\n{text}"), &Options::default());
                let report = compiled.unwrap_or_else(|found| panic!("{found}")).report.expect("a report");
                let found = report.shapes[0].facts.volume.expect("closed");
                (tolerance, (found - exact).abs())
            })
            .collect();
        let exponent = exponent(&points);
        assert!(exponent >= 0.9, "{text}: {exponent}: {points:?}");
    }
}

/// Materials and smooth normals go along, and a deformed shape can be deformed again.
#[test]
fn what_a_shape_has_it_keeps() {
    let text = "tolerance = 0.02\n[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n\
         [shape.a]\nmaterial = \"red\"\n[shape.a.cylinder]\nradius = 0.2\nheight = 2\n\
         [shape.b]\nmaterial = \"blue\"\nat = [1, 0, 0]\n[shape.b.box]\nsize = [0.2, 2, 0.2]\n\
         [shape.c.bend]\nof = { group = { of = [\"a\", \"b\"] } }\nangle = 40\n\
         [shape.d.twist]\nof = \"c\"\nangle = 60\n[node.only]\nshape = \"d\"";
    let baked = bake(text);
    let facts = &baked.report().shapes["d"].facts;
    assert_eq!((facts.components, facts.closed), (2, true), "{facts:?}");
    let meshes = baked.glb.list("meshes");
    assert_eq!(meshes[0]["primitives"].as_array().map(Vec::len), Some(2));
    // A cylinder has a smooth wall: fewer vertices than corners of triangles by far.
    assert!(facts.vertices < facts.triangles, "{facts:?}");
    let deviation = baked.report().shapes["d"].deviation;
    assert!(
        deviation.bound <= 0.02 && deviation.measured.expect("asked for") <= deviation.bound,
        "{deviation:?}"
    );
}

/// Nothing to bend is nothing to split.
#[test]
fn a_map_that_does_nothing_adds_no_triangle() {
    for map in ["twist]\nangle = 0", "bend]\nangle = 0", "taper]\nfactor = 1"] {
        let facts = bake(&format!("[shape.a.{map}\n{BOX}")).only().facts.clone();
        assert_eq!(facts.triangles, 12, "{map}");
        assert_near(facts.volume.expect("closed"), 0.24, 1e-6);
    }
}

/// The number of triangles against the least for grids of right-angled triangles, the integral of the root of the
/// curvature over twice the tolerance.
#[test]
fn a_bent_tube_is_no_finer_than_it_must_be() {
    let (radius, height, turn, tolerance) = (0.2, 3.0, 2.0 * PI / 3.0, 2e-3);
    let text = format!(
        "tolerance = {tolerance}\n[shape.a.bend]\nof = {{ cylinder = {{ radius = {radius}, height = {height} }} }}\nangle = 120"
    );
    let facts = bake(&text).only().facts.clone();
    // The integral of the root of |cos| over a full turn.
    let around = 4.0 * 1.198_140_234_735_592;
    let least = turn * (radius * height / turn).sqrt() * around / (2.0 * tolerance);
    let caps = 2.0 * PI * (radius / (2.0 * tolerance)).sqrt();
    let share = facts.triangles as f64 / (least + caps);
    assert!(share < 2.0, "{} triangles, {share} times the least", facts.triangles);
}

/// Every kind of wall and face, with a shape of its own for the map to bend.
#[test]
fn all_kinds_of_shapes_are_bent_within_their_tolerance() {
    let shapes = [
        "box = { size = [0.4, 2, 0.3], radius = 0.1 }",
        "sphere = { radius = 0.6 }",
        "geodesic = { radius = 0.6 }",
        "polyhedron = { solid = \"icosahedron\", radius = 0.6 }",
        "torus = { radius = 0.6, tube-radius = 0.2 }",
        "revolve = { profile = { polyline = { points = [[0.1, 0], [0.4, 0.5], [0.2, 1]] } }, angle = 200 }",
        "extrude = { profile = { circle = { radius = 0.5 } }, holes = [{ circle = { radius = 0.2 } }], height = 1 }",
        "extrude = { profile = { circle = { radius = 0.5 } }, height = 1, twist = 90, taper = 0.5 }",
        "sweep = { profile = { circle = { radius = 0.1 } }, path = { helix = { radius = 0.5, pitch = 0.5, turns = 1.5 } } }",
        "ruled = { from = { circle = { radius = 0.5 } }, to = { transform = { of = { ellipse = { radii = [0.3, 0.6] } }, at = [0, 0, 1] } } }",
        "loft = { profiles = [{ circle = { radius = 0.5 } }, { transform = { of = { circle = { radius = 0.2 } }, at = [0, 0, 0.5] } }, { transform = { of = { circle = { radius = 0.4 } }, at = [0, 0, 1] } }] }",
        "sheet = { profile = { ellipse = { radii = [0.3, 0.8] } } }",
        "mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }",
    ];
    let maps = [
        "[shape.a.bend]\nangle = 15\n",
        "[shape.a.twist]\naxis = \"x\"\nangle = 80\n",
        "[shape.a.along]\naxis = \"x\"\npath = { arc = { radius = 3, from = 0, to = 60 } }\n",
    ];
    for (shape, map) in shapes.into_iter().zip(maps.into_iter().cycle()) {
        let text = format!("tolerance = 0.02\n{map}of = {{ {shape} }}");
        let baked = bake(&text);
        let deviation = baked.only().deviation;
        let measured = deviation.measured.expect("asked for");
        assert!(measured <= deviation.bound && deviation.bound <= 0.02, "{text}: {deviation:?}");
        let plain = bake(&format!("tolerance = 0.02\n[shape.a.copy]\nof = {{ {shape} }}"));
        let facts = |baked: &Baked| {
            let facts = &baked.only().facts;
            (facts.closed, facts.manifold, facts.components, facts.boundary_edges > 0)
        };
        assert_eq!(facts(&baked), facts(&plain), "{text}");
    }
}

/// A line beside the axis of a twist is a helix; a line along that of a bend an arc of its own length.
#[test]
fn lines_are_bent_too() {
    let baked = bake(
        "tolerance = 1e-4\n[shape.a.twist]\nangle = 720\naxis = \"x\"\n\
         of = { wire = { curves = [{ line = { from = [0, 0.5], to = [3, 0.5] } }] } }",
    );
    let lines = baked.only().lines.clone().expect("there are lines");
    let expected = (9.0 + 4.0 * PI * PI).sqrt();
    assert!(lines.length <= expected + 1e-6 && lines.length > expected * (1.0 - 1e-3), "{lines:?}");
    let deviation = baked.only().deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 1e-4);
    let baked = bake(
        "tolerance = 1e-4\n[shape.a.bend]\nangle = 180\nfrom = 1\nto = 2\naxis = \"x\"\ntoward = \"y\"\n\
         of = { wire = { curves = [{ line = { from = [0, 0], to = [3, 0] } }, { circle = { radius = 0.2, center = [1.5, 0] } }] } }",
    );
    let lines = baked.only().lines.clone().expect("there are lines");
    assert_eq!((lines.curves, lines.closed_curves), (2, 1));
    let deviation = baked.only().deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 1e-4);
}

#[test]
fn a_shape_of_several_parts_keeps_its_parts_through_maps_of_maps() {
    let text = "tolerance = 0.004\n[shape.post.box]\nsize = [0.1, 0.6, 0.1]\n[shape.posts.array]\nof = \"post\"\ncount = 5\n\
         offset = [0.4, 0, 0]\n[shape.fence]\nrotate = [0, 90, 0]\n[shape.fence.along]\nof = \"posts\"\naxis = \"x\"\nstretch = true\n\
         path = { arc = { radius = 1, from = 0, to = 270 } }\n[shape.all.taper]\nof = { twist = { of = \"fence\", angle = 30 } }\nfactor = 0.5\n[node.n]\nshape = \"all\"";
    let baked = bake(text);
    let facts = &baked.report().shapes["all"].facts;
    assert_eq!((facts.components, facts.closed), (5, true), "{facts:?}");
    let deviation = baked.report().shapes["all"].deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 0.004);
}
