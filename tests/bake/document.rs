//! What surrounds the shapes: units, variants, nodes, materials, assertions, limits.

use kiln::compile::Options;
use kiln::language::Document;

use super::{Baked, assert_near, bake, bake_with, compile, inputs};

fn options(variant: Option<&str>, overrides: &[(&str, &str)]) -> Options {
    Options {
        variant: variant.map(str::to_owned),
        overrides: overrides.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect(),
        name: "asset".to_owned(),
        ..Options::default()
    }
}

fn volume(baked: &Baked) -> f64 {
    baked.only().facts.volume.expect("it is closed")
}

#[test]
fn overrides_and_variants_change_the_result() {
    let text = "[parameters]\nsize = 1\n[shape.a.box]\nsize = [\"= size\", 1, 1]\n[variant.wide.parameters]\nsize = 3\n\
                [variant.round.shape.b.sphere]\nradius = 1";
    assert_eq!(volume(&bake_with(text, &options(None, &[]))), 1.0);
    assert_eq!(volume(&bake_with(text, &options(None, &[("size", "2")]))), 2.0);
    let wide = bake_with(text, &options(Some("wide"), &[]));
    assert_eq!((volume(&wide), wide.compiled.file.as_str()), (3.0, "asset.wide.glb"));
    assert_eq!(wide.report().variant.as_deref(), Some("wide"));
    assert_eq!(volume(&bake_with(text, &options(Some("wide"), &[("size", "5")]))), 5.0);
    let round = bake_with(text, &options(Some("round"), &[]));
    assert_eq!(round.report().shapes.keys().collect::<Vec<_>>(), ["a", "b"]);
}

#[test]
fn included_definitions_are_as_if_written_here() {
    let part = "[material.clay]\ncolor = \"#ff0000\"\n[curve.ring.circle]\nradius = 0.25\ncenter = [1, 0]\n";
    let text = "include = [\"parts/part.toml\"]\n[shape.a]\nmaterial = \"clay\"\n[shape.a.revolve]\nprofile = \"ring\"\n";
    let files = inputs().with("spec.toml", text).with("parts/part.toml", part);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let included =
        kiln::compile(&document, &files, &options(None, &[])).unwrap_or_else(|found| panic!("{found}"));
    let (_, rest) = text.split_once('\n').expect("two lines");
    let written =
        compile(&format!("{part}{rest}"), &options(None, &[])).unwrap_or_else(|found| panic!("{found}"));
    assert_eq!(included.bytes, written.bytes);
}

/// The same solid in millimetres with z up and in metres with y up: the same numbers in the file.
#[test]
fn units_and_axes_convert() {
    let metres = "tolerance = 0.001\n[shape.a]\nat = [0.5, 0.25, -0.125]\nrotate = [0, 90, 0]\n[shape.a.cylinder]\nradius = 0.5\nheight = 2\n\
                  [node.root]\nat = [0, 1, 0]\n[node.leaf]\nshape = \"a\"\nparent = \"root\"\nscale = [1, 2, 3]";
    let feet = metres.replace("tolerance = 0.001", "unit = \"m\"\nup = \"y\"\ntolerance = 0.001");
    let (plain, same) = (bake(metres), bake(&feet));
    assert_eq!(plain.compiled.bytes, same.compiled.bytes);
    // y up of the file is z of the document, and z of the file is minus its y.
    let millimetres = "unit = \"mm\"\nup = \"z\"\ntolerance = 1\n[shape.a]\nat = [500, 125, 250]\nrotate = [90, 0, 0]\n\
                       [shape.a.copy]\nof = { cylinder = { radius = 500, height = 2000 } }\n\
                       [node.root]\nat = [0, 0, 1000]\n[node.leaf]\nshape = \"a\"\nparent = \"root\"\nscale = [1, 3, 2]";
    let other = bake(millimetres);
    let (one, two) = (plain.only(), other.only());
    let (a, b) = (one.facts.bounds.expect("points"), two.facts.bounds.expect("points"));
    for axis in 0..3 {
        assert!(
            (a.min[axis] - b.min[axis]).abs() < 2e-6 && (a.max[axis] - b.max[axis]).abs() < 2e-6,
            "{a:?} {b:?}"
        );
    }
    assert_eq!(one.facts.triangles, two.facts.triangles);
    assert_near(two.facts.area, one.facts.area, 1e-6);
    assert_near(two.deviation.bound, one.deviation.bound, 1e-3);
    let matrices = |baked: &Baked| baked.report().nodes.iter().map(|node| node.matrix).collect::<Vec<_>>();
    for (one, two) in matrices(&plain).iter().flatten().zip(matrices(&other).iter().flatten()) {
        assert!((one - two).abs() < 1e-6, "{:?} {:?}", matrices(&plain), matrices(&other));
    }
    let inches = bake("unit = \"in\"\n[shape.a.box]\nsize = [1, 1, 1]");
    assert_near(volume(&inches), 0.0254_f64 * 0.0254 * 0.0254, 1e-6);
    let feet = bake("unit = \"ft\"\nup = \"z\"\n[shape.a.box]\nsize = [1, 2, 3]");
    let bounds = feet.only().facts.bounds.expect("points");
    assert_eq!(bounds.max, [0.1524_f32, 0.4572, 0.3048]);
}

#[test]
fn nodes_that_show_one_shape_share_one_mesh() {
    let text = "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.sphere]\nradius = 1\n\
                [node.root]\n[node.one]\nshape = \"a\"\nparent = \"root\"\nat = [2, 0, 0]\n[node.two]\nshape = \"a\"\nparent = \"one\"\nrotate = [0, 0, 90]\n\
                [node.three]\nshape = \"b\"\nparent = \"two\"\nat = [1, 0, 0]";
    let baked = bake(text);
    assert_eq!((baked.report().totals.meshes, baked.report().totals.nodes), (2, 4));
    assert_eq!(baked.report().totals.draw_calls, 3);
    let nodes = baked.glb.list("nodes");
    assert_eq!(nodes[1]["mesh"], nodes[2]["mesh"]);
    assert!(nodes[0].get("mesh").is_none());
    assert_eq!(baked.glb.list("scenes")[0]["nodes"], serde_json::json!([0]));
    // The last node: turned by 90 degrees about z after its parent stands at x = 2; its own x is up.
    let matrix = baked.report().nodes[3].matrix;
    let expected = [0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 1.0, 0.0, 1.0];
    for (found, expected) in matrix.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-6, "{matrix:?}");
    }
}

#[test]
fn a_shape_in_another_material_shares_its_vertices() {
    let text = "[shape.a]\nmaterial = \"red\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = [0, 0, 1]\n\
                [node.one]\nshape = \"a\"\n[node.two]\nshape = \"a\"\nmaterial = \"blue\"\nat = [2, 0, 0]\n[node.three]\nshape = \"a\"\nmaterial = \"blue\"";
    let baked = bake(text);
    let meshes = baked.glb.list("meshes");
    assert_eq!(meshes.len(), 2);
    let primitive = |mesh: usize| &meshes[mesh]["primitives"][0];
    assert_eq!(primitive(0)["attributes"], primitive(1)["attributes"]);
    assert_eq!(primitive(0)["indices"], primitive(1)["indices"]);
    assert_ne!(primitive(0)["material"], primitive(1)["material"]);
    assert_eq!(baked.glb.list("nodes")[1]["mesh"], baked.glb.list("nodes")[2]["mesh"]);
    let materials = baked.glb.list("materials");
    assert_eq!(materials[0]["name"], "red");
    assert_eq!(
        materials[1]["pbrMetallicRoughness"]["baseColorFactor"],
        serde_json::json!([0.0, 0.0, 1.0, 1.0])
    );
}

#[test]
fn parts_keep_their_materials_and_each_material_is_one_primitive() {
    let text = "[material.x]\n[material.y]\n[shape.p]\nmaterial = \"x\"\n[shape.p.box]\nsize = [1, 1, 1]\n\
                [shape.q]\nat = [3, 0, 0]\n[shape.q.box]\nsize = [1, 1, 1]\n\
                [shape.a]\nmaterial = \"y\"\n[shape.a.group]\nof = [\"p\", \"q\", { copy = { of = \"p\" } }]";
    let baked = bake(text);
    assert_eq!(baked.report().shapes.keys().collect::<Vec<_>>(), ["a"]);
    let primitives = baked.glb.list("meshes")[0]["primitives"].as_array().expect("primitives").clone();
    assert_eq!(primitives.len(), 2);
    let counts = |primitive: &serde_json::Value| {
        let accessor = primitive["indices"].as_u64().expect("indices");
        baked.glb.list("accessors")[usize::try_from(accessor).expect("small")]["count"].as_u64()
    };
    assert_eq!((counts(&primitives[0]), counts(&primitives[1])), (Some(72), Some(36)));
    let name = |primitive: &serde_json::Value| {
        let place = primitive["material"].as_u64().expect("a material");
        baked.glb.list("materials")[usize::try_from(place).expect("small")]["name"].clone()
    };
    assert_eq!((name(&primitives[0]), name(&primitives[1])), ("x".into(), "y".into()));
}

#[test]
fn faces_have_materials_of_their_own() {
    // A closed tetrahedron, one face red, the others of the material named last; as it is and as a cage.
    let mesh = "points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\n\
                faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]\n\
                face-materials = [\"blue\", \"red\", \"blue\", \"blue\"]";
    let text = format!(
        "[material.red]\n[material.blue]\n[shape.a.mesh]\n{mesh}\n\
         [shape.b.subdivide]\ncage = \"a\"\nlevels = 2\n[node.a]\nshape = \"a\"\n[node.b]\nshape = \"b\""
    );
    let baked = bake(&text);
    // Catmull-Clark cuts a triangle into 3 quads, each of these into 4, each of two triangles.
    for (mesh, share) in baked.glb.list("meshes").iter().zip([3, 3 * 4 * 2 * 3]) {
        let primitives = mesh["primitives"].as_array().expect("primitives");
        let named = primitives.iter().map(|primitive| {
            let at = |key: &str| usize::try_from(primitive[key].as_u64().expect("an index")).expect("small");
            let count = baked.glb.list("accessors")[at("indices")]["count"].as_u64().expect("a count");
            (baked.glb.list("materials")[at("material")]["name"].clone(), count)
        });
        let mut named: Vec<_> = named.map(|(name, count)| (name.to_string(), count)).collect();
        named.sort();
        assert_eq!(named, [("\"blue\"".to_owned(), 3 * share), ("\"red\"".to_owned(), share)]);
    }
    let closed = baked.report().shapes.values().all(|shape| shape.facts.closed);
    assert!(closed, "the border of materials is no hole");
}

#[test]
fn images_are_embedded_once_and_as_they_are() {
    let text = "[material.x]\ncolor-texture = \"label.png\"\nocclusion-texture = { file = \"label.png\", wrap = \"clamp\" }\n\
                [material.y]\ncolor-texture = \"./label.png\"\nemissive-texture = { file = \"label.png\", filter = \"nearest\" }\n\
                [material.unused]\ncolor-texture = \"bumps.png\"\n\
                [shape.a]\nmaterial = \"x\"\n[shape.a.box]\nsize = [1, 1, 1]\n[shape.b]\nmaterial = \"y\"\n[shape.b.box]\nsize = [1, 1, 1]";
    let baked = bake(text);
    let images = baked.glb.list("images");
    assert_eq!(images.len(), 1, "{images:?}");
    assert_eq!((&images[0]["mimeType"], &images[0]["name"]), (&"image/png".into(), &"label".into()));
    let view = usize::try_from(images[0]["bufferView"].as_u64().expect("a view")).expect("small");
    assert_eq!(baked.glb.view(view), include_bytes!("../../specs/inputs/label.png"));
    assert_eq!((baked.glb.list("textures").len(), baked.glb.list("samplers").len()), (3, 3));
    let y = &baked.glb.list("materials")[1];
    assert_eq!(y["emissiveFactor"], serde_json::json!([1.0, 1.0, 1.0]), "a texture alone glows as it is");
}

#[test]
fn tangents_are_written_if_and_only_if_a_normal_texture_shows() {
    let shape = "[shape.a]\nmaterial = \"x\"\n[shape.a.sphere]\nradius = 1\n";
    for (material, tangents, uvs) in [
        ("[material.x]\n", false, false),
        ("[material.x]\ncolor-texture = \"label.png\"\n", false, true),
        ("[material.x]\nnormal-texture = \"bumps.png\"\n", true, true),
    ] {
        let baked = bake(&format!("{material}{shape}"));
        let attributes = &baked.glb.list("meshes")[0]["primitives"][0]["attributes"];
        assert_eq!(attributes.get("TANGENT").is_some(), tangents, "{material}");
        assert_eq!(attributes.get("TEXCOORD_0").is_some(), uvs, "{material}");
    }
    // One node shows bumps, another does not: only the first mesh refers to the tangents.
    let text = format!(
        "[material.x]\n[material.bumpy]\nnormal-texture = \"bumps.png\"\n{shape}[node.one]\nshape = \"a\"\n[node.two]\nshape = \"a\"\nmaterial = \"bumpy\""
    );
    let baked = bake(&text);
    let has =
        |mesh: usize| baked.glb.list("meshes")[mesh]["primitives"][0]["attributes"].get("TANGENT").is_some();
    assert_eq!((has(0), has(1)), (false, true));
}

/// glTF demands texture coordinates where a texture shows, so a shape without them cannot wear one.
#[test]
fn a_texture_on_a_shape_without_coordinates_is_refused() {
    let text = "[material.x]\ncolor-texture = \"label.png\"\n[shape.a]\nuv = \"none\"\n[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\nmaterial = \"x\"";
    let found = compile(text, &options(None, &[])).expect_err("it is refused");
    assert_eq!(found.iter().map(|one| one.code.text()).collect::<Vec<_>>(), ["K0105"], "{found}");
}

#[test]
fn materials_are_written_as_they_are_said() {
    let text = "[material.x]\ncolor = \"#ff000080\"\nmetallic = 0.25\nroughness = 0.5\nemissive = [0.5, 0, 1]\nalpha = \"mask\"\nalpha-cutoff = 0.75\ndouble-sided = true\n\
                normal-texture = \"bumps.png\"\nnormal-scale = 0.5\nocclusion-texture = \"label.png\"\nocclusion-strength = 0.25\n\
                [shape.a]\nmaterial = \"x\"\n[shape.a.box]\nsize = [1, 1, 1]";
    let baked = bake(text);
    let material = &baked.glb.list("materials")[0];
    let pbr = &material["pbrMetallicRoughness"];
    assert_eq!((pbr["metallicFactor"].as_f64(), pbr["roughnessFactor"].as_f64()), (Some(0.25), Some(0.5)));
    let color: Vec<f64> = pbr["baseColorFactor"]
        .as_array()
        .expect("four")
        .iter()
        .filter_map(serde_json::Value::as_f64)
        .collect();
    assert_eq!(color[..3], [1.0, 0.0, 0.0]);
    assert_near(color[3], 128.0 / 255.0, 1e-6);
    assert_eq!(material["emissiveFactor"], serde_json::json!([0.5, 0.0, 1.0]));
    assert_eq!((&material["alphaMode"], material["alphaCutoff"].as_f64()), (&"MASK".into(), Some(0.75)));
    assert_eq!(material["doubleSided"], true);
    assert_eq!(material["normalTexture"]["scale"], 0.5);
    assert_eq!(material["occlusionTexture"]["strength"], 0.25);
}

#[test]
fn assertions_that_hold_stand_in_the_report() {
    let text = "[shape.a.box]\nsize = [1, 2, 3]\n[assert]\nclosed = true\nvolume = { equals = 6, tolerance = 1e-6 }\n\
                triangles = 12\n\"shapes.a.genus\" = { at-least = 0, at-most = 0 }\nasset = \"asset\"\n\"bounds.max.1\" = 1";
    let report = bake(text).report().clone();
    assert_eq!(report.assertions.len(), 6);
    assert_eq!(report.assertions[2].found, 12);
}

#[test]
fn without_a_report_nothing_is_measured() {
    let options = Options { no_report: true, ..options(None, &[]) };
    let compiled =
        compile("[shape.a.box]\nsize = [1, 1, 1]", &options).unwrap_or_else(|found| panic!("{found}"));
    assert!(compiled.report.is_none());
    let measured = bake("[shape.a.box]\nsize = [1, 1, 1]");
    assert_eq!(compiled.bytes, measured.compiled.bytes, "measuring changes nothing");
}

#[test]
fn limits_count_the_whole_asset() {
    let spheres = |count: usize| {
        (0..count)
            .map(|k| format!("[shape.s{k}]\nsegments = [16, 8]\n[shape.s{k}.sphere]\nradius = 1\n"))
            .collect::<String>()
    };
    let triangles = 16 * 7 * 2;
    let allowed = format!("[limits]\ntriangles = {}\n{}", 3 * triangles, spheres(3));
    assert_eq!(bake(&allowed).report().totals.triangles, 3 * triangles);
    for text in [
        format!("[limits]\ntriangles = {}\n{}", 3 * triangles - 1, spheres(3)),
        format!("[limits]\nvertices = 300\n{}", spheres(3)),
        format!("[limits]\nmemory = \"16 KiB\"\n{}", spheres(3)),
    ] {
        let found = compile(&text, &options(None, &[])).expect_err("it is refused");
        assert!(found.iter().all(|one| one.code.text() == "K0901" && one.place().is_some()), "{found}");
    }
}
