//! Solids in the file: closed, of the volumes of closed forms, with what their parts carry.

use core::f64::consts::PI;

use kiln::compile::Options;

use super::{Baked, assert_near, bake, compile};

const SPHERES: &str =
    "[shape.a.sphere]\nradius = 1\n[shape.b]\nat = [1, 0, 0]\n[shape.b.sphere]\nradius = 1\n";

/// The volume of the last shape, which must be a solid within its bound.
fn volume(text: &str) -> f64 {
    let baked = bake(text);
    let facts = baked.report().shapes.last().expect("a shape").1;
    assert!(facts.facts.closed && facts.facts.manifold, "{text}: {:?}", facts.facts);
    let deviation = &facts.deviation;
    if let Some(measured) = deviation.measured {
        assert!(measured <= deviation.bound, "{text}: {deviation:?}");
    }
    facts.facts.volume.expect("closed")
}

/// Volumes of closed forms, to what the tolerance leaves open.
#[test]
fn volumes_are_those_of_closed_forms() {
    let box_of = |name: &str, size: &str, at: &str| {
        format!("[shape.{name}]\nat = {at}\n[shape.{name}.box]\nsize = {size}\n")
    };
    let through = "[shape.c.box]\nsize = [2, 2, 2]\n[shape.d.cylinder]\nradius = 0.5\nheight = 3\n";
    let crossed = "[shape.a.cylinder]\nradius = 1\nheight = 4\n[shape.b]\nrotate = [90, 0, 0]\n[shape.b.copy]\nof = \"a\"\n";
    for (text, expected, tolerance) in [
        (format!("{SPHERES}[shape.c.union]\nof = [\"a\", \"b\"]"), 9.0 * PI / 4.0, 2e-3),
        (format!("{SPHERES}[shape.c.intersection]\nof = [\"a\", \"b\"]"), 5.0 * PI / 12.0, 2e-3),
        (format!("{SPHERES}[shape.c.difference]\nof = [\"a\", \"b\"]"), 11.0 * PI / 12.0, 2e-3),
        (format!("{SPHERES}[shape.c.solid]\nof = \"(a + b) & b - a\""), 11.0 * PI / 12.0, 2e-3),
        (format!("{through}[shape.e.difference]\nof = [\"c\", \"d\"]"), 8.0 - PI / 2.0, 1e-3),
        (format!("{crossed}[shape.c.intersection]\nof = [\"a\", \"b\"]"), 16.0 / 3.0, 4e-3),
        (
            box_of("a", "[1, 1, 1]", "[0, 0, 0]") + &box_of("b", "[1, 1, 1]", "[1, 0, 0]") + "[shape.c.union]\nof = [\"a\", \"b\"]",
            2.0,
            1e-6,
        ),
        (
            box_of("a", "[1, 1, 1]", "[0, 0, 0]") + &box_of("b", "[1, 1, 1]", "[0.5, 0.5, 0.5]") + "[shape.c.solid]\nof = \"a + b\"",
            1.875,
            1e-6,
        ),
        (format!("{SPHERES}[shape.c.cut]\nof = \"a\"\nplane = {{ normal = [0, 2, 0], point = [0, 0.3, 0] }}\nkeep = \"above\""), 1.180_191_640_198_565_3, 2e-3),
        (format!("{SPHERES}[shape.c.cut]\nof = \"a\"\nplane = {{ normal = [0, 2, 0], point = [0, 0.3, 0] }}"), 3.008_598_564_587_825_5, 2e-3),
        (
            "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.cut]\nof = \"a\"\nplane = { normal = [1, 1, 1], point = [-0.5, -0.5, 0] }".to_owned(),
            1.0 / 48.0,
            1e-6,
        ),
        (
            "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.cut]\nof = \"a\"\nplane = { normal = [1, 1, 1] }\nkeep = \"both\"\ngap = 0.5".to_owned(),
            1.0,
            1e-6,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.hull]\nof = [\"a\"]\npoints = [[0, 4, 0]]".to_owned(),
            12.0,
            1e-6,
        ),
        (
            "[shape.b.hull]\nof = [{ sphere = { radius = 1 } }]\npoints = [[0, 2, 0]]".to_owned(),
            // A ball whose top is a cone that touches it at height 1/2.
            PI * (2.0 / 3.0 + 11.0 / 24.0) + PI * 0.75 * 1.5 / 3.0,
            3e-3,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b]\ntolerance = 0.0005\n[shape.b.minkowski-round]\nof = \"a\"\nradius = 0.3".to_owned(),
            8.0 + 24.0 * 0.3 + 6.0 * PI * 0.09 + 4.0 / 3.0 * PI * 0.027,
            2e-3,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.minkowski-round]\nof = \"a\"\nradius = -0.3".to_owned(),
            1.4 * 1.4 * 1.4,
            1e-6,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.shell]\nof = \"a\"\nthickness = 0.2".to_owned(),
            8.0 - 1.6 * 1.6 * 1.6,
            1e-6,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.shell]\nof = \"a\"\nthickness = 0.2\nopen = [{ normal = [0, 1, 0], point = [0, 1, 0] }]".to_owned(),
            8.0 - 1.6 * 1.6 * 1.8,
            1e-6,
        ),
        (
            "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.shell]\nof = \"a\"\nthickness = 0.2\nopen = [{ normal = [0, 1, 0], point = [0, 1, 0] }, { normal = [0, -1, 0], point = [0, -1, 0] }]".to_owned(),
            8.0 - 1.6 * 1.6 * 2.0,
            1e-6,
        ),
        (
            "tolerance = 0.02\n[shape.a.sphere]\nradius = 1\n[shape.b.shell]\nof = \"a\"\nthickness = 0.25\nside = \"outside\"".to_owned(),
            4.0 / 3.0 * PI * (1.25_f64 * 1.25 * 1.25 - 1.0),
            6e-2,
        ),
    ] {
        let text = if text.contains("tolerance") { text } else { format!("tolerance = 0.0005\n{text}") };
        assert_near(volume(&text), expected, tolerance);
    }
}

/// Of an array the holes of a plate: genus counts them.
#[test]
fn holes_are_counted() {
    let text = "[shape.plate.box]\nsize = [10, 0.5, 10]\n[shape.hole.array]\nof = { cylinder = { radius = 0.4, height = 2 } }\ncount = [5, 1, 4]\noffset = [1.5, 0, 1.5]\n[shape.a]\n[shape.a.difference]\nof = [\"plate\", { copy = { of = \"hole\" } }]\n[node.a]\nshape = \"a\"";
    let moved = text.replace("[shape.hole.array]", "[shape.hole]\nat = [-3, 0, -2.5]\n[shape.hole.array]");
    let baked = bake(&moved);
    let facts = &baked.only().facts;
    assert_eq!((facts.genus, facts.components, facts.closed), (Some(20), 1, true));
    assert_near(facts.volume.expect("closed"), 50.0 - 20.0 * PI * 0.16 * 0.5, 1e-2);
}

/// Smooth where the parts are, sharp at the new edges, and turned round inside what is taken away.
#[test]
fn normals_look_outward_and_stay_smooth() {
    let sphere = "[shape.b.sphere]\nradius = 1.3\n";
    for operation in ["union", "difference", "intersection"] {
        let baked = bake(&format!(
            "[shape.a.box]\nsize = [2, 2, 2]\n{sphere}[shape.c.{operation}]\nof = [\"a\", \"b\"]"
        ));
        // A chord of a ball at this tolerance turns by less than four degrees from its corner's normal.
        let lean = baked.glb.named("c").greatest_lean();
        assert!(lean < 4.0, "{operation}: {lean}");
    }
}

#[test]
fn each_part_keeps_its_material_and_the_cut_has_the_shapes() {
    let materials = "[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n[material.green]\ncolor = \"#00ff00\"\n";
    let parts = "[shape.a]\nmaterial = \"red\"\n[shape.a.box]\nsize = [2, 2, 2]\n[shape.b]\nmaterial = \"blue\"\n[shape.b.sphere]\nradius = 1.3\n";
    let primitives = |baked: &Baked| baked.glb.list("meshes")[0]["primitives"].as_array().map_or(0, Vec::len);
    let union = bake(&format!("{materials}{parts}[shape.c.union]\nof = [\"a\", \"b\"]"));
    assert_eq!(primitives(&union), 2);
    let cut = format!(
        "{materials}{parts}[shape.c]\nmaterial = \"green\"\n[shape.c.cut]\nof = {{ union = {{ of = [\"a\", \"b\"] }} }}\nplane = \"x\""
    );
    let baked = bake(&cut);
    assert_eq!(primitives(&baked), 3);
    // The cap is a square and what a circle of radius 1.3 has beyond its sides.
    let mesh = baked.glb.named("c");
    let at_cut =
        |triangle: &&[usize; 3]| triangle.iter().all(|corner| mesh.positions[*corner][0].abs() < 1e-6);
    let area = |triangle: &[usize; 3]| {
        let [x, y, z] = mesh.across(*triangle);
        (x * x + y * y + z * z).sqrt() / 2.0
    };
    let cap: f64 = mesh.triangles.iter().filter(at_cut).map(area).sum();
    let half = kiln::geometry::number::acos(1.0 / 1.3);
    let segment = 1.69 * half - (1.69_f64 - 1.0).sqrt();
    assert_near(cap, 4.0 + 4.0 * segment, 5e-3);
}

/// Exact parts stay exact: nothing but rounding to single precision is left.
#[test]
fn boxes_stay_exact() {
    let baked = bake(
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b]\nrotate = [10, 20, 30]\n[shape.b.box]\nsize = [1, 3, 1]\n[shape.c.difference]\nof = [\"a\", \"b\"]",
    );
    let deviation = baked.only().deviation;
    assert!(deviation.bound < 1e-6, "{deviation:?}");
}

/// Operations on operations, and on what bends.
#[test]
fn solids_may_be_parts_and_may_be_bent() {
    let drilled = "[shape.bar.box]\nsize = [0.6, 4, 0.6]\n[shape.hole]\nrotate = [90, 0, 0]\n[shape.hole.cylinder]\nradius = 0.15\nheight = 2\n[shape.drilled.difference]\nof = [\"bar\", \"hole\"]\n";
    let text = format!(
        "tolerance = 0.01\n{drilled}[shape.bent.bend]\nof = \"drilled\"\nangle = 90\n[shape.both.union]\nof = [\"bent\", {{ sphere = {{ radius = 0.2 }} }}]"
    );
    let baked = bake(&text);
    let facts = baked.only();
    assert!(facts.facts.closed && facts.facts.manifold, "{:?}", facts.facts);
    let measured = facts.deviation.measured.expect("asked for");
    assert!(measured <= facts.deviation.bound && facts.deviation.bound <= 0.0101, "{:?}", facts.deviation);
    let straight = bake(&format!("{drilled}[node.a]\nshape = \"drilled\""));
    assert_eq!(straight.only().facts.genus, Some(1));
}

/// An open cut leaves a rim; of a sheet too.
#[test]
fn open_cuts_have_a_rim() {
    for (of, loops) in [
        ("{ sphere = { radius = 1 } }", 1),
        ("{ plane = { size = [2, 2] } }", 1),
        ("{ torus = { radius = 2, tube-radius = 0.5 } }", 2),
    ] {
        let baked = bake(&format!(
            "[shape.a.cut]\nof = {of}\nplane = {{ normal = [1, 0.2, 0], point = [0.1, 0, 0] }}\ncap = false"
        ));
        let facts = &baked.only().facts;
        assert_eq!((facts.boundary_loops, facts.components, facts.crowded_edges), (loops, 1, 0), "{of}");
    }
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let text = "[shape.a.geodesic]\nradius = 1\nfrequency = 40\n[shape.b]\nat = [0.7, 0.2, 0.1]\n[shape.b.copy]\nof = \"a\"\n[shape.c.difference]\nof = [\"a\", \"b\"]\n[shape.d]\nat = [4, 0, 0]\n[shape.d.union]\nof = [\"a\", \"b\"]\n[shape.e]\nat = [8, 0, 0]\n[shape.e.intersection]\nof = [\"a\", \"b\"]";
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| compile(text, &Options::default()).unwrap_or_else(|found| panic!("{found}")).bytes)
    };
    let one = bytes(1);
    for threads in [2, 5, 1] {
        assert!(bytes(threads) == one, "{threads} threads give other bytes");
    }
}
