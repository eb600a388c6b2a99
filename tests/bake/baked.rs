//! What is baked into vertices: places on a lightmap that none share, and colors that what hides the sky darkens.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::language::Document;
use kiln::report::ShapeFacts;

use super::glb::Glb;
use super::{assert_near, inputs};

fn made(text: &str, profiles: &[Profile]) -> Result<Vec<Compiled>, String> {
    let files = inputs().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options { name: "asset".to_owned(), profiles: profiles.to_vec(), ..Options::default() };
    compile_profiles(&document, &files, &options).map_err(|found| found.to_string())
}

fn shape(compiled: &Compiled, name: &str) -> ShapeFacts {
    compiled.report.as_ref().expect("a report").shapes[name].clone()
}

const RING: &str = "tolerance = 0.004\n[shape.a]\nlightmap = { size = 256, padding = 2 }\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.15\n";

#[test]
fn lightmaps_are_dense_and_no_places_share_one_in_every_profile() {
    for compiled in made(RING, &[Profile::Core, Profile::Quantized, Profile::Web]).expect("it bakes") {
        let map = shape(&compiled, "a").lightmap.expect("a lightmap");
        assert_eq!((map.size, map.overlaps), (256, 0), "{map:?}");
        assert!(map.filled > 0.3 && map.filled < 1.0 && map.density > 50.0, "{map:?}");
        assert!(map.least_density > map.density / 3.0 && map.greatest_density < map.density * 3.0, "{map:?}");
        let glb = Glb::new(&compiled.bytes);
        let attributes = &glb.list("meshes")[0]["primitives"][0]["attributes"];
        assert!(attributes["TEXCOORD_0"].is_u64() && attributes["TEXCOORD_1"].is_u64(), "{attributes}");
    }
}

#[test]
fn levels_states_skins_and_tangents_keep_a_lightmap() {
    let text = format!("{RING}[lod]\nlevels = 3\n");
    let compiled = made(&text, &[Profile::Core]).expect("it bakes").remove(0);
    for name in ["a", "a_LOD1", "a_LOD2"] {
        assert_eq!(shape(&compiled, name).lightmap.expect("a lightmap").overlaps, 0, "{name}");
    }
    let text = "[parameters]\nbend = 0\n[shape.a]\nmaterial = \"m\"\nlightmap = { size = 128 }\n[shape.a.sphere]\nradius = \"= 0.5 + bend\"\n[shape.a.sphere.x]\n";
    let text = text.replace("[shape.a.sphere.x]\n", "")
        + "[morph.a.grown]\nwith = { bend = 0.2 }\n[material.m]\nnormal-texture = \"bumps.png\"\n";
    let compiled = made(&text, &[Profile::Core]).expect("it bakes").remove(0);
    let facts = shape(&compiled, "a");
    assert_eq!(facts.lightmap.expect("a lightmap").overlaps, 0);
    assert_eq!(facts.morphs.len(), 1);
    let glb = Glb::new(&compiled.bytes);
    let primitive = &glb.list("meshes")[0]["primitives"][0];
    assert!(primitive["attributes"]["TANGENT"].is_u64() && primitive["targets"].is_array(), "{primitive}");
}

#[test]
fn a_cube_is_laid_out_in_six_equal_squares() {
    let text = "[shape.a]\nlightmap = { size = 512, padding = 1 }\n[shape.a.box]\nsize = [1, 1, 1]\n";
    let compiled = made(text, &[Profile::Core]).expect("it bakes").remove(0);
    let map = shape(&compiled, "a").lightmap.expect("a lightmap");
    assert_near(map.least_density / map.density, 1.0, 1e-4);
    assert_near(map.greatest_density / map.density, 1.0, 1e-4);
    assert_near(map.filled, 6.0 * (map.density / 512.0) * (map.density / 512.0), 1e-4);
    assert_eq!(shape(&compiled, "a").facts.vertices, 24);
}

#[test]
fn what_cannot_be_laid_out_is_told() {
    let small = "[shape.a]\nlightmap = { size = 16, padding = 7 }\n[shape.a.box]\nsize = [1, 1, 1]\n";
    let told = made(small, &[Profile::Core]).expect_err("it does not fit");
    assert!(told.contains("K1055") && told.contains("shape `a` has no lightmap"), "{told}");
    let none = "[shape.a]\nuv = \"none\"\nlightmap = {}\n[shape.a.box]\nsize = [1, 1, 1]\n";
    assert!(made(none, &[Profile::Core]).expect_err("no first ones").contains("K0105"));
    let many = "tolerance = 0.001\n[shape.a]\nsegments = 400\nocclusion = { samples = 65536 }\n[shape.a.sphere]\nradius = 1\n";
    assert!(made(many, &[Profile::Core]).expect_err("too much work").contains("K0901"));
}

#[test]
fn what_hides_the_sky_darkens_colors() {
    let range =
        |text: &str| shape(&made(text, &[Profile::Core]).expect("it bakes")[0], "a").colors.expect("colors");
    // Nothing hides the sky of what is convex.
    let open = range("[shape.a]\nocclusion = {}\n[shape.a.box]\nsize = [1, 1, 1]\n");
    assert_eq!((open.min, open.max), ([1.0; 4], [1.0; 4]));
    // All of it is hidden in a ball that is seen from inside: a mesh whose faces look inward.
    let inside = "[shape.a]\nocclusion = { samples = 32, strength = 0.75 }\nvertex-color = [1, 0.5, 1]\n[shape.a.mesh]\npoints = [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]\nfaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]\n";
    let hidden =
        range(&inside.replace(
            "[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]",
            "[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]",
        ));
    let turned = range(inside);
    let dark = |found: [f32; 4]| (found[0] - 0.25).abs() < 1e-6 && (found[1] - 0.125).abs() < 1e-6;
    // One of both ways round looks inward.
    assert!(dark(hidden.max) != dark(turned.max), "{hidden:?} {turned:?}");
    // In the corner of an angle about half of the sky is hidden, at its ends none; the nearer, the less.
    let angle = |rest: &str| {
        range(&format!(
            "[shape.a]\nocclusion = {{ samples = 512{rest} }}\n[shape.a.extrude]\nheight = 8\nprofile = {{ polyline = {{ points = [[0, 0], [8, 0], [8, 0.5], [0.5, 0.5], [0.5, 8], [0, 8]], closed = true }} }}\n"
        ))
    };
    let far = angle("");
    assert!(far.max[0] == 1.0 && far.min[0] > 0.4 && far.min[0] < 0.8, "{far:?}");
    let near = angle(", distance = 0.01");
    assert!(near.min[0] > far.min[0], "{near:?}");
    assert_eq!(angle(", seed = 5").max, far.max);
}

#[test]
fn the_same_document_gives_the_same_bytes() {
    let text = format!(
        "{RING}[shape.b]\nocclusion = {{ samples = 16 }}\n[shape.b.torus]\nradius = 1\ntube-radius = 0.2\n"
    );
    let bytes = || made(&text, &[Profile::Web]).expect("it bakes")[0].bytes.clone();
    assert_eq!(bytes(), bytes());
}
