//! Colliders: exactly the shape where that is simple, else around it; in each form.

use std::f64::consts::PI;

use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::language::Document;
use kiln::report::ColliderFacts;
use serde_json::{Value, json};

use super::glb::Glb;
use super::{assert_near, inputs};

fn made(text: &str, options: &Options) -> Vec<Compiled> {
    let files = inputs().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    compile_profiles(&document, &files, options).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

fn bake(text: &str) -> (Glb, Compiled) {
    let mut all = made(text, &Options { name: "asset".to_owned(), ..Options::default() });
    let compiled = all.remove(0);
    // Meshes of colliders have no normals, as the check demands of all others.
    let glb = Glb::new(&compiled.bytes);
    (glb, compiled)
}

/// The one collider of a document: what the file says, and the report.
fn only(text: &str) -> (Value, ColliderFacts) {
    let (glb, compiled) = bake(text);
    let mut told = glb.list("nodes").iter().filter_map(|node| node["extras"]["colliders"].as_array());
    let list = told.next().unwrap_or_else(|| panic!("no collider in {text}"));
    assert!(list.len() == 1 && told.next().is_none());
    let facts = compiled.report.as_ref().expect("a report").colliders.values().next().expect("a collider");
    assert_eq!(list[0]["shape"], facts.body);
    (list[0].clone(), facts.clone())
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(all) => all.iter().flat_map(numbers).collect(),
        number => vec![number.as_f64().expect("a number")],
    }
}

#[track_caller]
fn near(value: &Value, wanted: &[f64]) {
    near_within(value, wanted, 1e-6);
}

/// As [`near`], for what encloses triangles: these lie a little inside of their shape.
#[track_caller]
fn near_within(value: &Value, wanted: &[f64], within: f64) {
    let found = numbers(value);
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= within * b.abs().max(1.0);
    assert!(found.len() == wanted.len() && found.iter().zip(wanted).all(close), "{found:?}, not {wanted:?}");
}

#[test]
fn simple_shapes_are_their_own_colliders() {
    let collider = "\n[collider.c]\nshape = \"a\"";
    let check = |shape: &str, kind: &str, sizes: &[(&str, &[f64])]| {
        let (told, facts) = only(&format!("{shape}{collider}"));
        assert!(facts.exact && facts.body == kind, "{shape}: {facts:?}");
        for (key, wanted) in sizes {
            near(&told[*key], wanted);
        }
        // Rounding aside every vertex lies in the body.
        assert!(facts.outside.expect("the shape is shown") < 2e-6, "{shape}: {facts:?}");
        told
    };
    check(
        "[shape.a.box]\nsize = [1, 2, 3]\ncenter = [0, 1, 0]",
        "box",
        &[("size", &[1.0, 2.0, 3.0]), ("translation", &[0.0, 1.0, 0.0])],
    );
    check(
        "[shape.a.sphere]\nradius = 0.4\ncenter = [1, 0, 0]",
        "sphere",
        &[("radius", &[0.4]), ("translation", &[1.0, 0.0, 0.0])],
    );
    check("[shape.a.geodesic]\nradius = 0.4", "sphere", &[("radius", &[0.4])]);
    check(
        "[shape.a.cylinder]\nradius = 0.4\nheight = 2",
        "cylinder",
        &[("radius", &[0.4]), ("height", &[2.0])],
    );
    check(
        "[shape.a.capsule]\nradius = 0.4\nheight = 2",
        "capsule",
        &[("radius", &[0.4]), ("height", &[1.2])],
    );
    // Turned by hand it is a cylinder too, its middle halfway up.
    check(
        "[shape.a.revolve]\nprofile = { polyline = { points = [[0, 1], [0.5, 1], [0.5, 4], [0, 4]] } }",
        "cylinder",
        &[("radius", &[0.5]), ("height", &[3.0]), ("translation", &[0.0, 2.5, 0.0])],
    );
    // Placement moves, turns and scales; the document's unit and axes come on top.
    let told = check(
        "unit = \"cm\"\nup = \"z\"\n[shape.a]\nscale = 2\nrotate = [90, 0, 0]\nat = [0, 0, 50]\n[shape.a.cylinder]\nradius = 40\nheight = 200",
        "cylinder",
        &[("radius", &[0.8]), ("height", &[4.0]), ("translation", &[0.0, 0.5, 0.0])],
    );
    // Along y of the document, turned about x by 90 degrees, is up in it, and so up in the file.
    let turn = numbers(&told["rotation"]);
    let (x, z) = (turn[0], turn[2]);
    assert!(1.0 - 2.0 * (x * x + z * z) > 0.999_999, "its axis is y: {turn:?}");
    let told = check(
        "[shape.b.box]\nsize = [1, 1, 1]\n[shape.a]\nscale = [1, 2, 3]\nrotate = [0, 90, 0]\n[shape.a.copy]\nof = \"b\"",
        "box",
        &[],
    );
    near(&told["size"], &[1.0, 2.0, 3.0]);
}

#[test]
fn other_shapes_are_enclosed() {
    let text =
        |shape: &str, fit: &str| format!("tolerance = 0.002\n{shape}\n[collider.c]\nshape = \"a\"\n{fit}");
    let ring = "[shape.a.torus]\nradius = 0.5\ntube-radius = 0.1";
    let (told, hull) = only(&text(ring, ""));
    assert!(hull.body == "hull" && !hull.exact && hull.vertices.expect("a hull") <= 64, "{hull:?}");
    assert_eq!(told["points"].as_array().expect("points").len(), hull.vertices.expect("a hull"));
    assert!(hull.outside.expect("shown") <= 1e-6, "{hull:?}");
    let (_, coarse) = only(&text(ring, "vertices = 12"));
    assert!(coarse.vertices.expect("a hull") <= 12 && coarse.volume > hull.volume, "{coarse:?}");
    assert!(coarse.outside.expect("shown") <= 1e-6, "{coarse:?}");
    let (told, _) = only(&text(ring, "fit = \"box\""));
    near_within(&told["size"], &[1.2, 0.2, 1.2], 1e-3);
    let (told, cylinder) = only(&text(ring, "fit = \"cylinder\""));
    near_within(&told["radius"], &[0.6], 1e-3);
    near_within(&told["height"], &[0.2], 1e-3);
    assert!(cylinder.outside.expect("shown") <= 1e-6);
    for fit in ["sphere", "capsule"] {
        let (_, facts) = only(&text(ring, &format!("fit = \"{fit}\"")));
        assert!(facts.body == fit && !facts.exact && facts.outside.expect("shown") <= 1e-6, "{facts:?}");
    }
    // A ball that is flattened is no ball any more; a rounded box no box.
    let (_, flat) = only(&text("[shape.a]\nscale = [1, 0.5, 1]\n[shape.a.sphere]\nradius = 0.5", ""));
    assert!(flat.body == "hull" && flat.outside.expect("shown") <= 1e-6);
    let (_, rounded) = only(&text("[shape.a.box]\nsize = [1, 1, 1]\nradius = 0.2", ""));
    assert_eq!(rounded.body, "hull");
    // Asked for as a hull, a box has its eight corners.
    let (_, cube) = only(&text("[shape.a.box]\nsize = [1, 2, 3]", "fit = \"hull\""));
    assert_eq!((cube.body, cube.vertices), ("hull", Some(8)));
    assert_near(cube.volume, 6.0, 1e-9);
}

#[test]
fn a_collider_stands_for_what_no_node_shows_where_it_is_told() {
    let text = "[shape.house.sphere]\nradius = 1\n[shape.stand-in.box]\nsize = [2, 1, 2]\n[node.home]\nshape = \"house\"\nat = [5, 0, 0]\n\
                [collider.walls]\nshape = \"stand-in\"\nnode = \"home\"";
    let (told, facts) = only(text);
    assert_eq!((told["shape"].as_str(), facts.node.as_str(), facts.outside), (Some("box"), "home", None));
    near(&told["translation"], &[0.0; 3]);
}

#[test]
fn each_node_of_a_shape_has_its_collider() {
    let text = "[shape.a.box]\nsize = [1, 1, 1]\n[node.one]\nshape = \"a\"\n[node.two]\nshape = \"a\"\nat = [3, 0, 0]\n[collider.c]\nshape = \"a\"";
    let (glb, compiled) = bake(text);
    let names: Vec<&Value> =
        glb.list("nodes").iter().map(|node| &node["extras"]["colliders"][0]["name"]).collect();
    assert_eq!(names, [&json!("c.one"), &json!("c.two")]);
    let report = compiled.report.as_ref().expect("a report");
    assert_eq!(report.colliders.keys().collect::<Vec<_>>(), ["c.one", "c.two"]);
}

const BODIES: &str = "[shape.crate.box]\nsize = [1, 1, 1]\n[shape.ring.torus]\nradius = 1\ntube-radius = 0.2\n[collider.crate-body]\nshape = \"crate\"\n[collider.ring-body]\nshape = \"ring\"\n";

#[test]
fn extensions_of_the_open_metaverse_say_the_same() {
    let options = Options {
        name: "asset".to_owned(),
        profiles: vec![kiln::Profile::Core, kiln::Profile::Quantized],
        ..Options::default()
    };
    for compiled in made(&format!("[output]\ncolliders = \"omi\"\n{BODIES}"), &options) {
        let glb = Glb::new(&compiled.bytes);
        for name in ["OMI_physics_shape", "OMI_physics_body"] {
            assert!(glb.list("extensionsUsed").contains(&json!(name)));
        }
        let shapes = &glb.json["extensions"]["OMI_physics_shape"]["shapes"];
        assert_eq!(shapes[0], json!({ "type": "box", "box": { "size": [1.0, 1.0, 1.0] } }));
        assert_eq!(shapes[1]["type"], "convex");
        let mesh = shapes[1]["convex"]["mesh"].as_u64().expect("a mesh");
        assert_eq!(glb.list("meshes")[usize::try_from(mesh).expect("small")]["name"], "ring-body");
        let holder = |name: &str| {
            let nodes = glb.list("nodes");
            let at = nodes.iter().position(|node| node["name"] == name).expect("a node");
            assert!(
                nodes
                    .iter()
                    .any(|node| node["children"].as_array().is_some_and(|all| all.contains(&json!(at))))
            );
            nodes[at]["extensions"]["OMI_physics_body"]["collider"]["shape"].clone()
        };
        assert_eq!([holder("crate-body"), holder("ring-body")], [json!(0), json!(1)]);
    }
}

#[test]
fn engines_that_go_by_names_get_meshes_with_names() {
    let names = |form: &str| -> Vec<(String, usize)> {
        let (glb, _) = bake(&format!("[output]\ncolliders = \"{form}\"\n{BODIES}"));
        let nodes = glb.list("nodes").iter().skip(2);
        let mesh = |node: &Value| usize::try_from(node["mesh"].as_u64().expect("a mesh")).expect("small");
        let all = nodes.map(|node| (node["name"].as_str().expect("a name").to_owned(), mesh(node)));
        let all: Vec<_> = all.collect();
        assert!(all.iter().all(|(_, mesh)| glb.mesh(*mesh).triangles.len() >= 12));
        all
    };
    let found = |form: &str| names(form).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    assert_eq!(found("godot"), ["crate-body-convcolonly", "ring-body-convcolonly"]);
    assert_eq!(found("unreal"), ["UBX_crate_00", "UCX_ring_00"]);
}

#[test]
fn round_bodies_as_meshes_are_closed_and_outward() {
    for (shape, volume) in [
        ("sphere]\nradius = 0.5", PI / 6.0),
        ("cylinder]\nradius = 0.5\nheight = 1", PI / 4.0),
        ("capsule]\nradius = 0.5\nheight = 2", PI * 0.25 * (1.0 + 2.0 / 3.0)),
    ] {
        let text = format!("[output]\ncolliders = \"unreal\"\n[shape.a.{shape}\n[collider.c]\nshape = \"a\"");
        let (glb, compiled) = bake(&text);
        let facts = glb.named("c").facts();
        assert!(facts.closed && facts.euler == 2, "{shape}: {facts:?}");
        // Corners lie on the body: a little less volume.
        assert!(facts.volume < volume && facts.volume > 0.95 * volume, "{shape}: {facts:?}");
        assert_near(compiled.report.as_ref().expect("a report").colliders["c"].volume, volume, 1e-5);
    }
}

/// An angle of two boxes, as a drawing pushed out.
const ANGLE: &str = "[shape.angle.extrude]\nheight = 0.5\nprofile = { polyline = { points = [[0, 0], [2, 0], [2, 0.5], [0.5, 0.5], [0.5, 2], [0, 2]], closed = true } }\n[collider.body]\nshape = \"angle\"\nfit = \"parts\"\n";

#[test]
fn convex_parts_cover_a_shape_in_every_form() {
    let (glb, compiled) = bake(ANGLE);
    let facts = compiled.report.as_ref().expect("a report").colliders["body"].clone();
    let parts = facts.parts.expect("parts");
    assert_eq!((facts.body, parts.parts, facts.vertices), ("parts", 2, Some(16)));
    // Two boxes put together are those boxes.
    assert_near(facts.volume, 0.5 * (1.0 + 0.75), 1e-6);
    assert_near(parts.volume_ratio.expect("it is closed"), 1.0, 1e-6);
    // Within a twentieth of what is allowed, which is 0.03 of the diagonal of 2.87.
    assert!(parts.beyond.expect("it is closed") < 4.4e-3 && facts.outside.expect("shown") < 1e-6);
    assert!(parts.concavity < 1e-6, "{parts:?}");
    let list = glb.list("nodes")[0]["extras"]["colliders"].as_array().expect("a list").clone();
    let said: Vec<_> = list.iter().map(|told| (&told["name"], &told["shape"], &told["part-of"])).collect();
    let [hull, body] = [json!("hull"), json!("body")];
    assert_eq!(said, [(&json!("body-00"), &hull, &body), (&json!("body-01"), &hull, &body)]);
    let names = |form: &str| -> Vec<String> {
        let (glb, _) = bake(&format!("[output]\ncolliders = \"{form}\"\n{ANGLE}"));
        glb.list("nodes")[1..].iter().map(|node| node["name"].as_str().expect("a name").to_owned()).collect()
    };
    assert_eq!(names("godot"), ["body-00-convcolonly", "body-01-convcolonly"]);
    assert_eq!(names("unreal"), ["UCX_angle_00", "UCX_angle_01"]);
    assert_eq!(names("omi"), ["body-00", "body-01"]);
}

#[test]
fn more_parts_fill_less_of_a_hollow() {
    let ring = |rest: &str| {
        let text = format!(
            "tolerance = 0.005\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.1\n[collider.c]\nshape = \"a\"\nfit = \"parts\"\n{rest}"
        );
        let (_, compiled) = bake(&text);
        let codes: Vec<_> = compiled.warnings.iter().map(|warning| warning.code.text()).collect();
        (compiled.report.as_ref().expect("a report").colliders["c"].clone(), codes)
    };
    let (fine, told) = ring("concavity = 0.05");
    let parts = fine.parts.expect("parts");
    assert!(told.is_empty() && (3..=16).contains(&parts.parts), "{told:?} {parts:?}");
    // The diagonal of the box is 1.71.
    assert!(parts.concavity <= 0.05 * 1.71 && fine.outside.expect("shown") <= 1e-6, "{fine:?}");
    let (coarse, told) = ring("concavity = 0.05\nparts = 2");
    let rough = coarse.parts.expect("parts");
    assert_eq!((told, rough.parts), (vec!["K1054"], 2));
    assert!(rough.volume_ratio > parts.volume_ratio && rough.beyond > parts.beyond, "{rough:?} {parts:?}");
    assert!(coarse.outside.expect("shown") <= 1e-6);
    let (few, _) = ring("concavity = 0.05\nvertices = 12");
    assert!(few.vertices.expect("hulls") <= 12 * few.parts.expect("parts").parts, "{few:?}");
    assert!(few.outside.expect("shown") <= 1e-6 && few.volume > fine.volume);
}
