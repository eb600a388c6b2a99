//! Quadrics by their equations: every written point satisfies it, and areas and volumes are those of closed forms.

use core::f64::consts::PI;

use kiln::compile::Options;

use super::{assert_near, bake, compile};

const TOWER: &str = "[shape.a.quadric]\nxx = 1\nyy = -0.25\nzz = 1\nconstant = -1\n\
     within = { min = [-9, -2, -9], max = [9, 2, 9] }";
/// An ellipsoid of half axes 1, 2 and 3, turned by a third of a right angle about y and moved.
const EGG: &str = "[shape.a.quadric]\nxx = \"= cos(30) * cos(30) + sin(30) * sin(30) / 9\"\n\
     zz = \"= sin(30) * sin(30) + cos(30) * cos(30) / 9\"\nzx = \"= 2 * sin(30) * cos(30) * (1 - 1 / 9)\"\n\
     yy = 0.25\ny = -0.5\nconstant = -0.75";
/// z = x y over a square, from below.
const SADDLE: &str = "[shape.a.quadric]\nxy = -1\nz = 1\nwithin = { min = [-1, -1, -2], max = [1, 1, 2] }";

/// A sum of the second degree at a point.
type Equation = fn([f64; 3]) -> f64;

#[test]
fn written_points_satisfy_the_equation() {
    let egg: Equation = |[x, y, z]| {
        // Rotated back: x' along the shortest axis.
        let (cosine, sine) = (0.75_f64.sqrt(), 0.5);
        let (a, c) = (x * cosine + z * sine, z * cosine - x * sine);
        a * a + (y - 1.0) * (y - 1.0) / 4.0 + c * c / 9.0 - 1.0
    };
    let cases: [(&str, Equation); 3] = [
        (TOWER, |[x, y, z]| x * x - 0.25 * y * y + z * z - 1.0),
        (EGG, egg),
        (SADDLE, |[x, y, z]| z - x * y),
    ];
    for (text, equation) in cases {
        let baked = bake(&format!("tolerance = 1e-3\n{text}"));
        let mesh = baked.glb.named("a");
        let reach = mesh.positions.iter().flatten().map(|x| x.abs()).fold(0.0, f64::max);
        for point in &mesh.positions {
            // Positions are rounded to single precision; slopes are at most 2 there.
            assert!(equation(*point).abs() <= 1e-6 * reach, "{point:?} of {text}: {}", equation(*point));
        }
        let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{text}: {deviation:?}");
        assert!(deviation.bound <= 1e-3 && facts.degenerate_triangles == 0, "{text}: {deviation:?}");
        assert_eq!(facts.components, 1, "{text}");
    }
}

#[test]
fn solids_and_skins_have_the_measures_of_school() {
    let tower = bake(&format!("tolerance = 1e-4\n{TOWER}\ncaps = true"));
    let facts = &tower.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    // The integral of pi (1 + y^2 / 4) from -2 to 2.
    assert_near(facts.volume.expect("closed"), PI * (4.0 + 4.0 / 3.0), 1e-3);

    let egg = bake(&format!("tolerance = 1e-4\n{EGG}"));
    let facts = &egg.only().facts;
    assert!(facts.closed && facts.genus == Some(0), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 4.0 / 3.0 * PI * 6.0, 1e-3);
    let mesh = egg.glb.named("a");
    let heights = || mesh.positions.iter().map(|place| place[1]);
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    assert!((low + 1.0).abs() < 1e-3 && (high - 3.0).abs() < 1e-3, "{low} {high}");

    let sheets = bake(
        "tolerance = 1e-3\n[shape.a.quadric]\nxx = -1\nyy = 1\nzz = -1\nconstant = -1\nwithin = { min = [-9, -2, -9], max = [9, 2, 9] }",
    );
    assert_eq!((sheets.only().facts.components, sheets.only().facts.boundary_loops), (2, 2));

    let planes = bake("[shape.a.quadric]\nxx = 1\nyy = -1\nwithin = { min = [-1, -1, -1], max = [1, 1, 1] }");
    assert_near(planes.only().facts.area, 2.0 * 2.0 * 8.0_f64.sqrt(), 1e-6);
}

/// What two balls share: 5/12 pi of a radius of 1, with the rim where they meet sharp and every point on one of them.
#[test]
fn a_lens_is_what_two_balls_share() {
    let text = "tolerance = 1e-4\n[shape.a.quadric]\nxx = 1\nyy = 1\nzz = 1\ny = 1\nconstant = -0.75\n\
         within = { center = [0, 0.5, 0], radius = 1 }\ncaps = true";
    let baked = bake(text);
    let (facts, deviation) = (&baked.only().facts, baked.only().deviation);
    assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
    assert_near(facts.volume.expect("closed"), 5.0 * PI / 12.0, 1e-3);
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 1e-4);
    let away = |[x, y, z]: [f64; 3], center: f64| (x * x + (y - center) * (y - center) + z * z).sqrt() - 1.0;
    let mesh = baked.glb.named("a");
    for point in &mesh.positions {
        let (low, high) = (away(*point, -0.5), away(*point, 0.5));
        assert!(low.max(high).abs() < 1e-6, "{point:?}: {low} {high}");
    }
    // Two normals stand on every point of the rim, 120 degrees apart.
    let rim = mesh.positions.iter().filter(|point| point[1].abs() < 1e-6).count();
    assert!(rim > 40 && rim % 2 == 0, "{rim}");
}

/// The asset of the gallery: one skin, open at foot and top, and columns below it.
#[test]
fn the_tower_stands() {
    let text = include_str!("../../specs/quadrics/tower.toml");
    let compiled = compile(text, &Options { measure: true, ..Options::default() });
    let report = compiled.unwrap_or_else(|found| panic!("{found}")).report.expect("a report");
    let shell = &report.shapes["shell"];
    assert_eq!((shell.facts.components, shell.facts.boundary_loops), (1, 2), "{:?}", shell.facts);
    assert!(shell.deviation.measured.expect("asked for") <= shell.deviation.bound);
}

/// Both halves of a cone meet in one vertex, which the closed body has too; the report says what the equation makes.
#[test]
fn a_cone_keeps_its_apex() {
    let text = "tolerance = 1e-3\n[shape.a.quadric]\nxx = 1\nyy = -1\nzz = 1\nx = -1\nconstant = 0.25\n\
         within = { min = [-2, -1, -2], max = [2, 1, 2] }\ncaps = true";
    let baked = bake(text);
    let facts = &baked.only().facts;
    assert!(facts.closed, "{facts:?}");
    assert_near(facts.volume.expect("closed"), 2.0 * PI / 3.0, 2e-3);
    let mesh = baked.glb.named("a");
    assert!(mesh.positions.contains(&[0.5, 0.0, 0.0]));
    let compiled = compile(text, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let report = compiled.report.expect("a report");
    assert_eq!((report.quadrics["a"].surface, report.quadrics["a"].origin), ("cone", [0.5, 0.0, 0.0]));
}
