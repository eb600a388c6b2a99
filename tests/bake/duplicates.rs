//! What is equal stands in a file once, under all its names.

use std::collections::BTreeSet;

use kiln::Profile;
use kiln::compile::{Options, compile_profiles};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;
use serde_json::Value;

use super::glb::Glb;
use super::{bake, inputs};

/// The accessors that meshes and animations name.
fn named(glb: &Glb) -> BTreeSet<u64> {
    let mut all = BTreeSet::new();
    for primitive in
        glb.list("meshes").iter().flat_map(|mesh| mesh["primitives"].as_array().expect("primitives"))
    {
        all.extend(
            primitive["attributes"].as_object().expect("attributes").values().filter_map(Value::as_u64),
        );
        all.extend(primitive["indices"].as_u64());
        for target in primitive["targets"].as_array().into_iter().flatten() {
            all.extend(target.as_object().expect("attributes").values().filter_map(Value::as_u64));
        }
    }
    for sampler in glb.list("animations").iter().flat_map(|one| one["samplers"].as_array().expect("samplers"))
    {
        all.extend([&sampler["input"], &sampler["output"]].into_iter().filter_map(Value::as_u64));
    }
    all.extend(glb.list("skins").iter().filter_map(|skin| skin["inverseBindMatrices"].as_u64()));
    all
}

/// Nothing stands twice, and nothing is left over.
fn assert_single(glb: &Glb) {
    let accessors = glb.list("accessors");
    assert_eq!(named(glb).len(), accessors.len(), "all are used");
    let different: BTreeSet<String> = accessors.iter().map(ToString::to_string).collect();
    assert_eq!(different.len(), accessors.len(), "all are different");
    let views: Vec<(&[u8], &Value)> = (0..glb.list("bufferViews").len())
        .map(|k| (glb.view(k), &glb.list("bufferViews")[k]["target"]))
        .collect();
    for (number, view) in views.iter().enumerate() {
        assert!(!views[..number].contains(view), "view {number} was written before");
    }
}

#[test]
fn equal_shapes_share_their_accessors_and_keep_their_names() {
    let one = "tolerance = 0.01\n[shape.a.torus]\nradius = 1\ntube-radius = 0.3\n";
    let both = format!("{one}[shape.b.torus]\nradius = 1\ntube-radius = 0.3\n");
    let (one, both) = (bake(one), bake(&both));
    assert_single(&both.glb);
    assert_eq!(both.glb.list("accessors"), one.glb.list("accessors"));
    let names: Vec<_> = both.glb.list("meshes").iter().map(|mesh| mesh["name"].as_str()).collect();
    assert_eq!(names, [Some("a"), Some("b")]);
    assert_eq!(both.report().shapes["b"].facts, one.report().shapes["a"].facts);
    assert!(both.compiled.bytes.len() < one.compiled.bytes.len() + 400);
}

/// The normals of the unit ball are its points: two accessors of one view, which then says how far apart they stand.
#[test]
fn accessors_of_one_view_say_how_far_apart_elements_stand() {
    let baked = bake("tolerance = 0.01\n[shape.a.geodesic]\nradius = 1");
    let attributes = &baked.glb.list("meshes")[0]["primitives"][0]["attributes"];
    let accessor = |name: &str| {
        &baked.glb.list("accessors")
            [usize::try_from(attributes[name].as_u64().expect("an index")).expect("small")]
    };
    let (position, normal) = (accessor("POSITION"), accessor("NORMAL"));
    assert_eq!(position["bufferView"], normal["bufferView"], "they are equal bytes");
    let view = position["bufferView"].as_u64().and_then(|view| usize::try_from(view).ok()).expect("a view");
    assert_eq!(baked.glb.list("bufferViews")[view]["byteStride"], 12);
    assert!(normal.get("min").is_none() && position.get("min").is_some());
    assert_single(&baked.glb);
}

#[test]
fn a_material_in_place_of_several_makes_one_primitive() {
    let text = "[shape.a.group]\nof = [\"left\", \"right\"]\n[shape.left]\nmaterial = \"red\"\n[shape.left.box]\nsize = [1, 1, 1]\n[shape.right]\nmaterial = \"blue\"\nat = [3, 0, 0]\n[shape.right.box]\nsize = [1, 2, 1]\n[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n[material.gray]\ncolor = \"#808080\"\n[node.own]\nshape = \"a\"\n[node.gray]\nshape = \"a\"\nmaterial = \"gray\"\n";
    let glb = bake(text).glb;
    let primitives = |name: &str| {
        let mesh =
            glb.list("meshes").iter().find(|mesh| mesh["name"] == name).unwrap_or_else(|| panic!("{name}"));
        mesh["primitives"].as_array().expect("primitives").len()
    };
    assert_eq!((primitives("a"), primitives("a.gray")), (2, 1));
    assert_eq!(glb.named("a").triangles, glb.named("a.gray").triangles);
    assert_single(&glb);
    // Alone, the accessors of its parts are left out.
    let alone = bake(&text.replace("[node.own]\nshape = \"a\"\n", "")).glb;
    assert_eq!(alone.list("meshes")[0]["primitives"].as_array().expect("primitives").len(), 1);
    assert_single(&alone);
}

#[test]
fn equal_pictures_are_one_under_two_paths() {
    let text = "[shape.a]\nmaterial = \"one\"\n[shape.a.box]\nsize = [1, 1, 1]\n[shape.b]\nmaterial = \"two\"\n[shape.b.box]\nsize = [1, 1, 2]\n[material.one]\ncolor-texture = \"label.png\"\n[material.two]\ncolor-texture = \"again.png\"\nroughness = 0.5\n";
    let files = inputs()
        .with("again.png", include_bytes!("../../specs/inputs/label.png").as_slice())
        .with("asset.toml", text);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let made =
        kiln::compile(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let glb = Glb::new(&made.bytes);
    glb.check();
    let counts = ["images", "textures", "samplers", "materials"].map(|key| glb.list(key).len());
    assert_eq!(counts, [1, 1, 1, 2]);
    assert_single(&glb);
}

/// Boxes of all sizes have the same normals and indices.
#[test]
fn parts_of_different_shapes_are_shared_in_every_profile() {
    let text: String = (1..=8).map(|k| format!("[shape.box-{k}.box]\nsize = [{k}, 1, 2]\n")).collect();
    assert_single(&bake(&text).glb);
    let files = MemoryFiles::new().with("asset.toml", text);
    let document = Document::load("asset.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let profiles = vec![Profile::Core, Profile::Quantized, Profile::Web];
    let options = Options { name: "asset".to_owned(), profiles, ..Options::default() };
    for made in compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}")) {
        let plain = kiln::packing::unpacked(&made.bytes).expect("it was written so");
        let read = kiln::gltf::read(&plain).expect("it was written so");
        // Positions of each; normals are those of all, and indices of those whose triangles come in one order.
        let count = read.root.accessors.len();
        assert!((8 + 2..8 + 5).contains(&count), "{count}");
        for (k, geometry) in (1_u8..).zip(&read.geometries) {
            let far =
                (0..geometry.positions.len()).map(|vertex| geometry.position(vertex)[0]).fold(0.0, f32::max);
            assert!((far - f32::from(k) / 2.0).abs() < 1e-3, "{far} of {k}");
        }
    }
}
