//! Levels of detail: each is the same shape, within its own tolerance.

use kiln::Profile;
use kiln::compile::{Compiled, Options, compile_profiles};
use kiln::geometry::number::{hypot, sin_cos};
use kiln::gltf::read;
use kiln::language::Document;
use kiln::language::diagnostic::Code;
use kiln::packing::unpacked;
use kiln::report::{LevelOrigin, Report};
use serde_json::Value;

use super::glb::{Glb, Mesh};
use super::inputs;

/// The files of a text for some profiles; `ring.obj` is beside it.
pub(super) fn files(text: &str, profiles: &[Profile]) -> Vec<Compiled> {
    let files = inputs().with("ring.obj", ring()).with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let options = Options {
        name: "asset".to_owned(),
        profiles: profiles.to_vec(),
        measure: true,
        ..Options::default()
    };
    compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}\n{text}"))
}

fn one(text: &str) -> Compiled {
    let mut all = files(text, &[]);
    assert_eq!(all.len(), 1, "{text}");
    all.remove(0)
}

fn report(compiled: &Compiled) -> &Report {
    compiled.report.as_ref().expect("a report was asked for")
}

/// A torus of many triangles, with a seam in its texture coordinates and two materials.
fn ring() -> String {
    let (around, across) = (64_u32, 32_u32);
    let mut text = String::new();
    let part = |k: u32, of: u32| f64::from(k) / f64::from(of) * std::f64::consts::TAU;
    for i in 0..around {
        for j in 0..across {
            let ((sine, cosine), (up, out)) = (sin_cos(part(i, around)), sin_cos(part(j, across)));
            let radius = 1.0 + 0.3 * out;
            text.push_str(&format!("v {} {} {}\n", radius * cosine, 0.3 * up, -radius * sine));
        }
    }
    for i in 0..=around {
        for j in 0..=across {
            let share = |k: u32, of: u32| f64::from(k) / f64::from(of);
            text.push_str(&format!("vt {} {}\n", share(i, around), share(j, across)));
        }
    }
    for i in 0..around {
        if i % (around / 2) == 0 {
            text.push_str(if i == 0 { "usemtl red\n" } else { "usemtl blue\n" });
        }
        for j in 0..across {
            let corner = |i: u32, j: u32| {
                let point = (i % around) * across + j % across + 1;
                format!("{point}/{}", i * (across + 1) + j + 1)
            };
            text.push_str(&format!(
                "f {} {} {} {}\n",
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1)
            ));
        }
    }
    text
}

/// Shapes of many kinds, each with the fewest levels that it must have.
const MODELS: [(&str, usize); 17] = [
    ("tolerance = 0.002\n[shape.a.sphere]\nradius = 0.7", 4),
    ("tolerance = 0.001\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.2", 4),
    ("tolerance = 0.001\n[shape.a.tube]\nradius = 0.5\ninner-radius = 0.3\nheight = 1", 3),
    (
        "tolerance = 0.0005\n[curve.c.natural-spline]\npoints = [[0.3, 0], [0.5, 0.4], [0.2, 0.9]]\n[shape.a.revolve]\nprofile = \"c\"\ncaps = false",
        4,
    ),
    (
        "tolerance = 0.0005\n[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { helix = { radius = 0.5, pitch = 0.4, turns = 2 } }",
        4,
    ),
    ("tolerance = 0.0005\n[shape.a.geodesic]\nradius = 1", 4),
    ("[shape.a]\nsegments = [48, 24]\n[shape.a.torus]\nradius = 0.5\ntube-radius = 0.2", 4),
    ("[shape.a.geodesic]\nradius = 1\nfrequency = 16", 4),
    ("[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\nlevels = 5", 4),
    (
        "tolerance = 0.001\n[shape.a.subdivide]\ncage = { polyhedron = { solid = \"icosahedron\", radius = 1 } }\nscheme = \"loop\"",
        3,
    ),
    (
        "tolerance = 0.002\n[map.m.noise]\nseed = 3\nhills = [3, 3]\ncolumns = 65\nrows = 65\n[shape.a.height-map]\nmap = \"m\"\nsize = [2, 2]\nrange = [0, 0.6]\nclose = \"base\"\nbase = -0.9",
        4,
    ),
    (
        "tolerance = 0.002\n[shape.ball.sphere]\nradius = 0.5\n[shape.rod.cylinder]\nradius = 0.2\nheight = 2\n[shape.a.difference]\nof = [\"ball\", \"rod\"]",
        3,
    ),
    (
        "tolerance = 0.002\n[shape.bar.cylinder]\nradius = 0.2\nheight = 2\n[shape.a.bend]\nof = \"bar\"\nangle = 90",
        3,
    ),
    (
        "tolerance = 0.002\n[field.f.skeleton]\nelements = [{ point = [0, 0, 0], radius = 0.8 }, { point = [0.7, 0, 0], radius = 0.6 }]\n[shape.a.implicit]\nfield = \"f\"",
        3,
    ),
    ("[shape.a]\nuv = \"always\"\n[shape.a.import]\nfile = \"ring.obj\"", 3),
    (
        "tolerance = 0.002\n[shape.arm.capsule]\nradius = 0.1\nheight = 1.2\n[skeleton.s.joint.low]\nhead = [0, -0.5, 0]\ntail = [0, 0, 0]\n[skeleton.s.joint.high]\nparent = \"low\"\ntail = [0, 0.5, 0]\n[skin.k]\nshape = \"arm\"\nskeleton = \"s\"\nweights = \"rigid\"\nsmoothing = 3",
        4,
    ),
    (
        "tolerance = 0.002\n[shape.arm.capsule]\nradius = 0.1\nheight = 1.2\n[skeleton.s.chain.c]\npoints = [[0, -0.5, 0], [0, 0, 0], [0, 0.5, 0]]\n[skin.k]\nshape = \"arm\"\nskeleton = \"s\"\nweights = \"heat\"",
        4,
    ),
];

#[test]
fn every_level_is_the_same_shape_within_its_tolerance_in_every_profile() {
    for (text, least) in MODELS {
        let text = format!("{text}\n[lod]\nlevels = 4");
        for made in files(&text, &[Profile::Core, Profile::Quantized, Profile::Web]) {
            assert!(made.warnings.is_empty() || least < 4, "{}\n{text}", made.warnings);
            let report = report(&made);
            assert_eq!(report.lods.len(), 1, "{text}");
            let levels = &report.lods[0];
            assert!(levels.len() >= least, "{} levels of {text}", levels.len());
            let finest = &report.shapes[&levels[0].mesh].facts;
            for pair in levels.windows(2) {
                let (before, level) = (&pair[0], &pair[1]);
                let shape = &report.shapes[&level.mesh];
                let facts = &shape.facts;
                assert!(facts.triangles * 10 <= before.triangles * 9, "{level:?} after {before:?} of {text}");
                assert_eq!(
                    (facts.closed, facts.manifold, facts.components, facts.euler, facts.boundary_loops),
                    (finest.closed, finest.manifold, finest.components, finest.euler, finest.boundary_loops),
                    "{level:?} of {text}"
                );
                let deviation = shape.deviation;
                let within = |most: f64| deviation.bound <= most * (1.0 + 1e-9);
                assert!(deviation.tolerance.is_none_or(within), "{deviation:?} of {text}");
                let measured = deviation.measured.is_none_or(|found| found <= deviation.bound * (1.0 + 1e-9));
                assert!(measured, "{deviation:?} of {level:?} of {text}");
                assert_eq!((level.error, level.triangles), (deviation.bound, facts.triangles));
                assert!(
                    level.coverage <= before.coverage && level.bytes < before.bytes,
                    "{level:?} of {text}"
                );
            }
        }
    }
}

/// The node of a file that has levels, the meshes of these, and what stands in the JSON.
fn extension(glb: &Glb) -> Vec<(usize, Vec<usize>, Vec<f64>)> {
    let index = |value: &Value| usize::try_from(value.as_u64().expect("an index")).expect("it fits");
    let nodes = glb.list("nodes");
    let of = |(at, node): (usize, &Value)| {
        let ids = node["extensions"]["MSFT_lod"]["ids"].as_array()?;
        let meshes = std::iter::once(index(&node["mesh"]))
            .chain(ids.iter().map(|id| index(&nodes[index(id)]["mesh"])));
        let coverage = node["extras"]["MSFT_screencoverage"].as_array().expect("coverage");
        Some((at, meshes.collect(), coverage.iter().map(|value| value.as_f64().expect("a number")).collect()))
    };
    nodes.iter().enumerate().filter_map(of).collect()
}

#[test]
fn msft_lod_hangs_on_a_node_below_each_that_shows_the_mesh() {
    let text = "tolerance = 0.002\n[lod]\nlevels = 3\n[shape.a.sphere]\nradius = 0.7\n[node.left]\nshape = \"a\"\nat = [1, 0, 0]\n\
                [node.right]\nshape = \"a\"\nparent = \"left\"\nrotate = [0, 30, 0]";
    let made = one(text);
    let glb = Glb::new(&made.bytes);
    glb.check();
    assert_eq!(glb.json["extensionsUsed"], serde_json::json!(["MSFT_lod"]));
    assert!(glb.json.get("extensionsRequired").is_none());
    assert_eq!(glb.list("meshes").len(), 3, "instances share the meshes of all levels");
    let found = extension(&glb);
    assert_eq!(found.len(), 2);
    let levels = &report(&made).lods["a"];
    for (node, meshes, coverage) in found {
        assert_eq!(meshes, [0, 1, 2]);
        let until: Vec<f64> = levels[1..].iter().map(|level| level.coverage).chain([0.0]).collect();
        assert_eq!(coverage, until, "each is good until the next is");
        let above = |other: &&Value| {
            other["children"].as_array().is_some_and(|all| all.contains(&serde_json::json!(node)))
        };
        let above = glb.list("nodes").iter().find(above).expect("it hangs on a node");
        assert!(above["name"].is_string() && above.get("mesh").is_none());
    }
    let scene = &glb.list("scenes")[0]["nodes"];
    assert_eq!(*scene, serde_json::json!([0]), "coarser levels stand in no scene");
    let names: Vec<&str> = report(&made).nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["left", "right"]);
    assert_eq!(report(&made).totals.drawn_triangles, 2 * levels[0].triangles);
}

/// Each level is as safe as it says: at its coverage the error is a pixel of a picture of 1080 lines.
#[test]
fn coverage_is_where_the_error_is_a_pixel() {
    let made = one("tolerance = 0.0001\n[lod]\nlevels = 4\n[shape.a.sphere]\nradius = 0.5");
    for level in &report(&made).lods["a"][1..] {
        // The disk around the box of a ball of diameter 1 has a diameter of the root of 3.
        let lines = 3_f64.sqrt() / level.error;
        let disk = std::f64::consts::PI / 4.0 * lines * lines;
        let picture = 1920.0 * 1080.0;
        assert!((level.coverage - (disk / picture).min(1.0)).abs() < 1e-3 * level.coverage, "{level:?}");
    }
}

/// Points of every level lie on the surface, and its texture coordinates are those of their places.
#[test]
fn levels_are_cut_from_the_surface_with_the_same_texture_coordinates() {
    let made = one(
        "tolerance = 0.0005\n[lod]\nlevels = 4\n[shape.a]\nuv = \"always\"\n[shape.a.revolve]\nprofile = { line = { from = [0.5, -0.5], to = [0.5, 0.5] } }\ncaps = false",
    );
    let glb = Glb::new(&made.bytes);
    let seam = |mesh: &Mesh| {
        let uvs = mesh.uvs.as_ref().expect("texture coordinates");
        let turned = |(place, uv): (&[f64; 3], &[f64; 2])| {
            assert!((hypot(place[0], place[2]) - 0.5).abs() < 1e-6, "{place:?}");
            let (sine, cosine) = sin_cos(uv[0] * std::f64::consts::TAU);
            (place[0] * cosine - place[2] * sine, place[0] * sine + place[2] * cosine, place[1] + uv[1])
        };
        let all: Vec<_> = mesh.positions.iter().zip(uvs).map(turned).collect();
        assert_eq!(
            uvs.iter().filter(|uv| uv[0] == 0.0).count(),
            uvs.iter().filter(|uv| uv[0] == 1.0).count()
        );
        all
    };
    let finest = seam(&glb.mesh(0))[0];
    for level in &report(&made).lods["a"] {
        assert!(level.source != LevelOrigin::Triangles);
        for found in seam(&glb.named(&level.mesh)) {
            let apart =
                (found.0 - finest.0).abs().max((found.1 - finest.1).abs()).max((found.2 - finest.2).abs());
            assert!(apart < 1e-5, "{found:?}, not {finest:?} at level {}", level.level);
        }
    }
}

#[test]
fn subdivisions_are_refined_less_often() {
    let made =
        one("[lod]\nlevels = 4\n[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\nlevels = 4");
    let triangles: Vec<u64> = report(&made).lods["a"].iter().map(|level| level.triangles).collect();
    assert_eq!(triangles, [3072, 768, 192, 48]);
}

/// A cage that is a surface itself is cut as finely for every level: the surface is the same.
#[test]
fn the_cage_is_as_fine_at_every_level() {
    let made = one(
        "[lod]\nlevels = 3\n[shape.ball]\ntolerance = 0.05\n[shape.ball.sphere]\nradius = 1\n[shape.a.subdivide]\ncage = \"ball\"\nlevels = 3\nscheme = \"loop\"",
    );
    let triangles: Vec<u64> = report(&made).lods["a"].iter().map(|level| level.triangles).collect();
    assert_eq!((triangles[0], triangles[1]), (16 * triangles[2], 4 * triangles[2]));
}

#[test]
fn explicit_tolerances_hold_for_every_shape() {
    let text = "unit = \"cm\"\ntolerance = 0.05\n[lod]\ntolerances = [0.2, 1]\n[shape.a.sphere]\nradius = 50\n[shape.b]\ntolerance = 0.5\n[shape.b.sphere]\nradius = 50\n[node.n]\nshape = \"a\"\nscale = 2\n[node.m]\nshape = \"b\"\nat = [200, 0, 0]";
    let made = one(text);
    let tolerance = |mesh: &str| report(&made).shapes[mesh].deviation.tolerance.expect("a tolerance");
    let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found}, not {wanted}");
    near(tolerance("a_LOD1"), 0.002);
    near(tolerance("a_LOD2"), 0.01);
    assert!(made.warnings.is_empty(), "{}", made.warnings);
    // The coarser shape has nothing to gain from the first of them.
    near(tolerance("b"), 0.005);
    near(tolerance("b_LOD1"), 0.01);
    assert_eq!(report(&made).lods["b"].len(), 2);
}

#[test]
fn meshes_without_a_surface_lose_triangles_and_stay_closed() {
    let text = "[lod]\nlevels = 4\n[material.red]\ncolor = \"#ff0000\"\n[material.blue]\ncolor = \"#0000ff\"\n[shape.a]\nuv = \"always\"\n[shape.a.import]\nfile = \"ring.obj\"\nmaterials = { red = \"red\", blue = \"blue\" }";
    let made = one(text);
    let (report, glb) = (report(&made), Glb::new(&made.bytes));
    let levels = &report.lods["a"];
    assert!(levels.len() >= 3 && levels[1..].iter().all(|level| level.source == LevelOrigin::Triangles));
    let diagonal = (2.6_f64 * 2.6 * 2.0 + 0.36).sqrt();
    for (level, tolerance) in levels[1..].iter().zip([4.0, 16.0, 64.0]) {
        assert!(level.error > 0.0 && level.error <= tolerance * diagonal / 2000.0 * 1.001, "{level:?}");
        assert_eq!(report.shapes[&level.mesh].primitives, 2, "both materials are there");
        // No vertex is new: each stands where one of the finest stands, with its texture coordinates.
        let key = |mesh: &Mesh| -> std::collections::BTreeSet<[u64; 5]> {
            let uvs = mesh.uvs.clone().expect("texture coordinates");
            let all = mesh.positions.iter().zip(uvs);
            all.map(|([x, y, z], [u, v])| [*x, *y, *z, u, v].map(f64::to_bits)).collect()
        };
        assert!(key(&glb.named(&level.mesh)).is_subset(&key(&glb.mesh(0))), "{level:?}");
    }
}

/// Two balls that hardly overlap come apart when they are cut coarsely: then triangles of the level before are taken away.
#[test]
fn a_level_that_comes_apart_is_made_from_the_one_before() {
    let text = "tolerance = 0.0005\n[lod]\ntolerances = [0.004, 0.04]\n[shape.one.sphere]\nradius = 0.5\n[shape.other]\nat = [0.97, 0.1, 0.05]\n[shape.other.sphere]\nradius = 0.5\n[shape.a.union]\nof = [\"one\", \"other\"]";
    let made = one(text);
    let levels = &report(&made).lods["a"];
    let parts = |mesh: &str| report(&made).shapes[mesh].facts.components;
    assert!(levels.iter().all(|level| parts(&level.mesh) == 1), "{levels:?}");
    assert_eq!(levels[1].source, LevelOrigin::Surface);
    assert!(levels.get(2).is_none_or(|level| level.source == LevelOrigin::Triangles), "{levels:?}");
}

#[test]
fn what_has_nothing_to_lose_has_no_levels() {
    let made = one("[lod]\nlevels = 4\n[shape.a.box]\nsize = [1, 2, 3]");
    assert!(report(&made).lods.is_empty() && made.warnings.is_empty(), "{}", made.warnings);
    let plain = one("[shape.a.box]\nsize = [1, 2, 3]");
    assert_eq!(made.bytes, plain.bytes);
    let text = "[lod]\nlevels = 8\n[shape.a]\nsegments = [64, 32]\n[shape.a.sphere]\nradius = 1";
    let codes: Vec<Code> = one(text).warnings.into_iter().map(|one| one.code).collect();
    assert_eq!(codes, [Code::FewerLevels]);
}

#[test]
fn levels_stand_as_named_nodes_where_that_is_asked_for() {
    let text = "tolerance = 0.002\n[lod]\nlevels = 3\nform = \"nodes\"\n[shape.a.sphere]\nradius = 0.7\n[shape.b.box]\nsize = [1, 1, 1]\n\
                [node.ball]\nshape = \"a\"\nat = [2, 0, 0]\n[node.cube]\nshape = \"b\"\nparent = \"ball\"";
    for made in files(text, &[Profile::Core, Profile::Quantized, Profile::Web]) {
        let plain = unpacked(&made.bytes).expect("it was written so");
        let root = read(&plain).expect("it was written so").root;
        let name = |index: usize| root.nodes[index].name.clone().unwrap_or_default();
        let ball = root.nodes.iter().find(|node| node.name.as_deref() == Some("ball")).expect("a node");
        let below: Vec<String> = ball.children.iter().flatten().map(|child| name(child.value())).collect();
        assert_eq!(below, ["cube", "ball_LOD0", "ball_LOD1", "ball_LOD2"], "{:?}", made.profile);
        assert!(ball.mesh.is_none() && !root.extensions_used.contains(&"MSFT_lod".to_owned()));
        let bounds = &report(&made).totals.bounds;
        assert!((bounds.max[0] - 2.7).abs() < 0.01 && (bounds.min[0] - 1.3).abs() < 0.01, "{bounds:?}");
        assert_eq!(report(&made).lods["a"].len(), 3);
    }
}

#[test]
fn levels_stand_in_files_of_their_own_where_that_is_asked_for() {
    let text = "tolerance = 0.002\n[lod]\nlevels = 3\nform = \"files\"\n[shape.a.sphere]\nradius = 0.7\n[shape.b.box]\nsize = [1, 1, 1]\n\
                [node.ball]\nshape = \"a\"\n[node.cube]\nshape = \"b\"\nat = [3, 0, 0]\n[assert]\n\"shapes.a.deviation.bound\" = { at-most = 0.002 }";
    let made = files(text, &[Profile::Core, Profile::Web]);
    let names: Vec<&str> = made.iter().map(|file| file.file.as_str()).collect();
    let wanted = [
        "asset.glb",
        "asset.lod1.glb",
        "asset.lod2.glb",
        "asset.web.glb",
        "asset.lod1.web.glb",
        "asset.lod2.web.glb",
    ];
    assert_eq!(names, wanted);
    for (number, file) in (0..3).zip(&made) {
        let report = report(file);
        assert_eq!(report.lods["a"].len(), 1);
        assert_eq!(report.lods["a"][0].level, number);
        assert_eq!(report.totals.meshes, 2, "a mesh without levels stands in all files");
        assert!(!Glb::new(&file.bytes).json.to_string().contains("MSFT_lod"));
    }
    let whole = files(&text.replace("files", "msft-lod"), &[Profile::Core]);
    let all: Vec<_> = made[..3].iter().map(|file| report(file).lods["a"][0].triangles).collect();
    let inside: Vec<_> = report(&whole[0]).lods["a"].iter().map(|level| level.triangles).collect();
    assert_eq!(all, inside, "the levels are the same");
}

#[test]
fn a_variant_named_as_a_level_is_refused() {
    let text = "[lod]\nlevels = 3\nform = \"files\"\n[shape.a.sphere]\nradius = 1\n[variant.lod1.shape.a.sphere]\nradius = 2";
    let found = super::compile(text, &Options { name: "asset".to_owned(), ..Options::default() })
        .expect_err("one file");
    assert!(found.to_string().contains("the variant `lod1` and the level `lod1`"), "{found}");
}

/// What carries a point of a coarser level is what carries the nearest place of the finest.
#[test]
fn levels_are_carried_as_the_finest_is() {
    let text = "tolerance = 0.002\n[lod]\nlevels = 3\n[shape.arm.capsule]\nradius = 0.1\nheight = 1.2\n[skeleton.s.joint.low]\nhead = [0, -0.5, 0]\ntail = [0, 0, 0]\n\
                [skeleton.s.joint.high]\nparent = \"low\"\ntail = [0, 0.5, 0]\n[skin.k]\nshape = \"arm\"\nskeleton = \"s\"\nweights = \"rigid\"\n\
                [clip.c]\nduration = 1\n[[clip.c.track]]\njoint = \"high\"\npath = \"rotation\"\nkeys = [{ at = 0, value = [0, 0, 0] }, { at = 1, value = [0, 0, 60] }]";
    for profile in [Profile::Core, Profile::Quantized] {
        let made = files(text, &[profile]).remove(0);
        let glb = Glb::new(&made.bytes);
        let found = if profile == Profile::Core { extension(&glb) } else { Vec::new() };
        for (node, meshes, _) in found {
            assert_eq!(glb.list("nodes")[node]["name"], "arm", "what joints carry hangs on its own node");
            for mesh in meshes {
                let attributes = &glb.list("meshes")[mesh]["primitives"][0]["attributes"];
                let row = |name: &str| {
                    glb.accessor(usize::try_from(attributes[name].as_u64().expect("there")).expect("it fits"))
                };
                for (place, (joints, weights)) in
                    row("POSITION").iter().zip(row("JOINTS_0").iter().zip(row("WEIGHTS_0")))
                {
                    if place[1].abs() < 0.3 {
                        continue;
                    }
                    let carrier = if place[1] > 0.0 { 1.0 } else { 0.0 };
                    assert_eq!((joints[0], weights[0]), (carrier, 255.0), "at {place:?} of mesh {mesh}");
                }
            }
        }
        assert_eq!(report(&made).lods["arm"].len(), 3);
        assert_eq!(report(&made).clips.len(), 1);
    }
}

/// A ball that grows: every place of a level, at rest and grown, is within the level's error of a ball, by its radius.
const GROWING: &str = "tolerance = 0.002\n[lod]\nlevels = 4\n[parameters]\nr = 0.5\n[shape.ball.sphere]\nradius = \"= r\"\n[morph.ball.big]\nwith = { r = 1.25 }\n\
                       [node.ball]\nshape = \"ball\"\n[clip.c]\nduration = 1\n[[clip.c.track]]\nmorph = \"ball.big\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]";

#[test]
fn levels_of_what_morphs_hold_in_every_state() {
    let made = files(GROWING, &[Profile::Core]).remove(0);
    assert!(made.warnings.is_empty(), "{}", made.warnings);
    let (glb, report) = (Glb::new(&made.bytes), report(&made));
    let levels = &report.lods["ball"];
    assert!(levels.len() == 4 && levels[1..].iter().all(|level| level.source == LevelOrigin::Surface));
    for (level, tolerance) in levels.iter().zip([0.002, 0.008, 0.032, 0.128]) {
        let place = glb.list("meshes").iter().position(|mesh| mesh["name"] == level.mesh.as_str());
        let place = place.expect("the mesh of the level");
        let (mesh, [big, _]) = (glb.mesh(place), glb.targets(place).remove(0));
        for (places, radius) in [(&mesh.positions, 0.5), (&big, 1.25)] {
            let length = |place: [f64; 3]| place.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!(places.iter().all(|place| (length(*place) - radius).abs() < 1e-6), "{level:?}");
            let middle = |corners: &[usize; 3]| {
                [0, 1, 2].map(|axis| corners.iter().map(|corner| places[*corner][axis]).sum::<f64>() / 3.0)
            };
            let off = mesh.triangles.iter().map(|corners| radius - length(middle(corners)));
            let off = off.fold(0.0, f64::max);
            assert!(off <= level.error && level.error <= tolerance, "{off} of {level:?}");
        }
    }
    for pair in levels.windows(2) {
        assert!(pair[1].triangles * 2 < pair[0].triangles, "{levels:?}");
    }
}

/// Where weights move, they move every level that can be shown, in every form.
#[test]
fn what_moves_weights_moves_those_of_all_levels() {
    let bones = "[skeleton.s.joint.low]\nhead = [0, -0.5, 0]\ntail = [0, 0, 0]\n[skin.k]\nshape = \"ball\"\nskeleton = \"s\"\nweights = \"rigid\"\n";
    for (form, carried) in
        [("msft-lod", ""), ("msft-lod", bones), ("nodes", ""), ("nodes", bones), ("files", "")]
    {
        let text = format!(
            "{}\n{carried}",
            GROWING.replace("levels = 4", &format!("levels = 4\nform = \"{form}\""))
        );
        let profiles: &[Profile] =
            if carried.is_empty() { &[Profile::Core, Profile::Quantized] } else { &[Profile::Core] };
        for made in files(&text, profiles) {
            let glb = Glb::new(&made.bytes);
            let nodes = glb.list("nodes").iter().enumerate();
            let shows = nodes.filter(|(_, node)| node.get("mesh").is_some()).map(|(index, _)| index as u64);
            let shows: Vec<u64> = shows.collect();
            assert_eq!(shows.len(), if form == "files" { 1 } else { 4 }, "{text}");
            let channels = glb.list("animations")[0]["channels"].as_array().expect("channels");
            let mut moved: Vec<u64> = channels
                .iter()
                .filter(|channel| channel["target"]["path"] == "weights")
                .map(|channel| channel["target"]["node"].as_u64().expect("a node"))
                .collect();
            moved.sort_unstable();
            assert_eq!(moved, shows, "{text}");
        }
    }
}

/// Any number of threads makes the same levels.
#[test]
fn levels_are_the_same_on_any_number_of_threads() {
    let text = "tolerance = 0.002\n[lod]\nlevels = 3\n[shape.a.sphere]\nradius = 0.7\n[shape.b]\nat = [3, 0, 0]\n[shape.b.import]\nfile = \"ring.obj\"\n[shape.c.torus]\nradius = 2\ntube-radius = 0.1";
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| one(text).bytes)
    };
    assert_eq!(bake(1), bake(4));
}
