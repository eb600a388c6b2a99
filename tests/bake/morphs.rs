//! States of shapes in the file: held against closed forms, and against shapes baked by themselves.

use std::collections::BTreeMap;

use kiln::compile::{Compiled, Options};
use kiln::geometry::number::{sin_cos_degrees, sin_degrees};
use kiln::gltf::Profile;
use kiln::language::Document;
use kiln::report::Kind;

use super::{Baked, bake, inputs};

/// A flag that waves, with a wave of another height as its state.
const FLAG: &str = "
tolerance = 0.002
[parameters]
high = 0.02
[shape.flag]
uv = \"always\"
[shape.flag.parametric]
x = \"= u\"
y = \"= v\"
z = \"= high * u * sin(720 * u)\"
u = [0, 1]
v = [0, 0.6]
[morph.flag.storm]
with = { high = 0.2 }
";

fn flag(high: f64, [x, y, z]: [f64; 3]) -> f64 {
    assert!((-1e-6..=0.6 + 1e-6).contains(&y));
    (z - high * x * sin_degrees(720.0 * x)).abs()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

fn length(a: [f64; 3]) -> f64 {
    distance(a, [0.0; 3])
}

/// The greatest distance between middles of triangles' sides and what a function says it is.
fn between(baked: &Baked, places: &[[f64; 3]], off: impl Fn([f64; 3]) -> f64) -> f64 {
    let triangles = baked.glb.mesh(0).triangles;
    let middle = |a: usize, b: usize| [0, 1, 2].map(|axis| (places[a][axis] + places[b][axis]) / 2.0);
    let sides = triangles.iter().flat_map(|[a, b, c]| [middle(*a, *b), middle(*b, *c), middle(*c, *a)]);
    sides.map(off).fold(0.0, f64::max)
}

/// The shape is nearly flat and needs few triangles; it has as many as its state needs, and both are on their surfaces.
#[test]
fn one_triangulation_is_fine_enough_for_every_state() {
    let baked = bake(FLAG);
    let [storm, normals] = baked.glb.targets(0).remove(0);
    let base = baked.glb.mesh(0);
    assert!(base.positions.iter().all(|place| flag(0.02, *place) < 1e-6));
    assert!(storm.iter().all(|place| flag(0.2, *place) < 1e-6));
    let facts = &baked.report().shapes["flag"];
    let state = &facts.morphs["storm"];
    for (deviation, high, places) in
        [(&facts.deviation, 0.02, &base.positions), (&state.deviation, 0.2, &storm)]
    {
        let found = between(&baked, places, |place| flag(high, place));
        // Along z the surface is further than across it.
        assert!(found <= 3.0 * deviation.bound, "{found} of {}", deviation.bound);
        assert!(
            deviation.bound <= deviation.tolerance.expect("a tolerance") && deviation.kind == Kind::Sampled
        );
    }
    let alone = bake(&FLAG.replace("[morph.flag.storm]\nwith = { high = 0.2 }", ""));
    assert!(alone.only().facts.triangles * 2 < facts.facts.triangles, "{}", facts.facts.triangles);
    // Normals by the derivative of the formula.
    for (place, normal) in storm.iter().zip(&normals) {
        let (sin, cos) = sin_cos_degrees(720.0 * place[0]);
        let slope = 0.2 * (sin + place[0] * 720.0_f64.to_radians() * cos);
        let wanted = [-slope, 0.0, 1.0].map(|part| part / (1.0 + slope * slope).sqrt());
        assert!(distance(*normal, wanted) < 1e-5, "{normal:?} at {place:?} instead of {wanted:?}");
    }
    assert_eq!((state.weight, state.furthest > 0.15), (0.0, true));
    assert!(state.bounds.min[2] < -0.15 && facts.facts.bounds.expect("a box").min[2] > -0.02);
}

/// A turned profile whose pieces change their lengths: corners stay corners, poles stay poles, caps stay flat.
#[test]
fn pieces_of_a_profile_correspond() {
    let text = "
tolerance = 0.001
[parameters]
belly = 0.4
[shape.vase]
at = [1, 2, 3]
[shape.vase.revolve]
angle = 200
profile = { path = { start = [0, 0], segments = [{ line = [[0.2, 0]] }, { natural-spline = [[\"= belly\", 0.5], [0.15, 1]] }, { line = [[0, 1]] }] } }
[morph.vase.slim]
with = { belly = 0.18 }
weight = 0.25
";
    let baked = bake(text);
    let base = baked.glb.mesh(0);
    let [slim, normals] = baked.glb.targets(0).remove(0);
    let alone = bake(&text.split("[morph").next().expect("text").replace("belly = 0.4", "belly = 0.18"));
    let other = alone.glb.mesh(0);
    let near = |a: [f64; 3]| other.positions.iter().map(|b| distance(a, *b)).fold(f64::INFINITY, f64::min);
    // Every corner of the slim one is there, and what stands on one point goes to one.
    for place in &other.positions {
        let found = slim.iter().map(|own| distance(*own, *place)).fold(f64::INFINITY, f64::min);
        assert!(found < 0.12, "{place:?} is {found} from all");
    }
    let mut known: BTreeMap<[u64; 3], [f64; 3]> = BTreeMap::new();
    for (from, to) in base.positions.iter().zip(&slim) {
        let same = known.entry(from.map(f64::to_bits)).or_insert(*to);
        assert!(distance(*same, *to) < 1e-7, "{from:?} tears");
        let [radius, thinner] = [*from, *to].map(|[x, _, z]| length([x - 1.0, 0.0, z - 3.0]));
        assert!(thinner <= radius + 1e-6, "{from:?} to {to:?}");
        let flat = (from[1] - 2.0).abs() < 1e-6 || (from[1] - 3.0).abs() < 1e-6;
        assert!(!flat || distance(*from, *to) < 0.25 && near(*to) < 0.2);
    }
    assert!(normals.iter().all(|normal| (length(*normal) - 1.0).abs() < 1e-6));
    // Triangles look where their vertices do.
    for [a, b, c] in &base.triangles {
        let [p, q, r] = [a, b, c].map(|vertex| slim[*vertex]);
        let (s, t) = ([0, 1, 2].map(|k| q[k] - p[k]), [0, 1, 2].map(|k| r[k] - p[k]));
        let cross = [s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]];
        let along: f64 = (0..3).map(|k| cross[k] * (normals[*a][k] + normals[*b][k] + normals[*c][k])).sum();
        assert!(along > 0.0, "{p:?} {q:?} {r:?}");
    }
    let facts = &baked.only().morphs["slim"];
    assert!(facts.deviation.bound <= facts.deviation.tolerance.expect("a tolerance"));
    assert_eq!(facts.weight, 0.25);
    assert_eq!(baked.glb.list("meshes")[0]["weights"][0], 0.25);
    assert_eq!(baked.glb.list("meshes")[0]["extras"]["targetNames"][0], "slim");
}

/// Bodies that are only scaled keep the proof of their tessellation where their triangles are the same.
#[test]
fn states_of_polygons_and_cages_are_the_other_shapes() {
    let cage = |name: &str, high: f64| {
        format!(
            "[shape.{name}-cage.box]\nsize = [1, {high}, 1]\n[shape.{name}.subdivide]\ncage = \"{name}-cage\"\n"
        )
    };
    let text = format!(
        "tolerance = 0.01\n[node.low]\nshape = \"low\"\n{}{}[morph.low.high]\nshape = \"high\"\n",
        cage("low", 1.0),
        cage("high", 6.0)
    );
    let baked = bake(&text);
    let [high, _] = baked.glb.targets(0).remove(0);
    let alone = bake(&format!("tolerance = 0.01\n{}", cage("high", 6.0)));
    // The taller needs one level more; the shape has it too.
    let (own, other) = (baked.glb.mesh(0), alone.glb.mesh(0));
    assert_eq!(own.triangles.len(), other.triangles.len());
    let sorted = |list: &[[f64; 3]]| {
        let mut all: Vec<[i64; 3]> = list
            .iter()
            .map(|place| {
                #[expect(clippy::cast_possible_truncation, reason = "a few millions")]
                place.map(|part| (part * 1e5).round() as i64)
            })
            .collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    assert_eq!(sorted(&high), sorted(&other.positions));
}

/// Where one corner moves, what is written is that corner.
#[test]
fn few_vertices_that_move_are_sparse() {
    let sheet = |name: &str, lift: f64| {
        let point = |k: u32| {
            let (x, z) = (k % 20, k / 20);
            let y = if k == 190 { lift } else { 0.0 };
            format!("[{x}, {y}, {z}]")
        };
        let face = |k: u32| {
            let at = k % 19 + k / 19 * 20;
            format!("[{at}, {}, {}, {}]", at + 20, at + 21, at + 1)
        };
        let points = (0..400).map(point).collect::<Vec<_>>().join(", ");
        let faces = (0..361).map(face).collect::<Vec<_>>().join(", ");
        format!(
            "[shape.{name}]\nsmoothing = \"smooth\"\n[shape.{name}.mesh]\npoints = [{points}]\nfaces = [{faces}]\n"
        )
    };
    let text = format!("{}{}[morph.a.tip]\nshape = \"b\"\n", sheet("a", 0.0), sheet("b", 0.5));
    let baked = bake(&text);
    let target = &baked.glb.list("meshes")[0]["primitives"][0]["targets"][0];
    let accessor = |name: &str| {
        let index = usize::try_from(target[name].as_u64().expect("an index")).expect("small");
        &baked.glb.list("accessors")[index]
    };
    assert_eq!(accessor("POSITION")["sparse"]["count"], 1);
    assert_eq!(accessor("POSITION")["max"][1], 0.5);
    // Its own normal and those of the neighbours.
    assert_eq!(accessor("NORMAL")["sparse"]["count"], 8);
    let [places, _] = baked.glb.targets(0).remove(0);
    let lifted: Vec<&[f64; 3]> = places.iter().filter(|place| place[1] != 0.0).collect();
    assert_eq!(lifted, [&[10.0, 0.5, 9.0]]);
    assert_eq!(baked.report().shapes["a"].morphs["tip"].moved, 1);
    // All of them move: then a list is shorter.
    let all = bake(
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [2, 2, 2]\n[morph.a.large]\nshape = \"b\"\n",
    );
    let index =
        all.glb.list("meshes")[0]["primitives"][0]["targets"][0]["POSITION"].as_u64().expect("an index");
    assert!(all.glb.list("accessors")[usize::try_from(index).expect("small")].get("sparse").is_none());
}

fn profiles(text: &str) -> Vec<Compiled> {
    let files = inputs().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    let profiles = vec![Profile::Core, Profile::Quantized, Profile::Web];
    let options = Options { name: "asset".to_owned(), profiles, ..Options::default() };
    kiln::compile::compile_profiles(&document, &files, &options).unwrap_or_else(|found| panic!("{found}"))
}

/// The same poses in every profile, within the grids' steps, with weights on the node that a player finds.
#[test]
fn every_profile_morphs_alike() {
    let clip = "[[clip.blow.track]]\nmorph = \"flag.storm\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }, { at = 2, value = -0.5 }]\n";
    let all = profiles(&format!("{FLAG}{clip}"));
    let reports: Vec<_> = all.iter().map(|one| one.report.as_ref().expect("a report")).collect();
    for report in &reports {
        let (facts, clip) = (&report.shapes["flag"].morphs["storm"], &report.clips["blow"]);
        assert!(
            facts.deviation.bound <= facts.deviation.tolerance.expect("a tolerance") * 1.001,
            "{facts:?}"
        );
        let first = &reports[0].clips["blow"];
        assert_eq!((clip.keys, clip.duration), (first.keys, 2.0));
        for (pose, other) in clip.poses.iter().zip(&first.poses) {
            assert_eq!(pose.weights["flag"], other.weights["flag"]);
        }
        for axis in 0..3 {
            let off = (clip.bounds.max[axis] - first.bounds.max[axis]).abs();
            assert!(off < 2.0 * facts.deviation.tolerance.expect("a tolerance"), "{off}");
        }
    }
    assert!(reports[1].grid.is_some() && reports[2].grid.is_some());
    let [core, quantized, web] = [0, 1, 2].map(|at: usize| all[at].bytes.len());
    assert!(web < quantized && quantized < core, "{core} {quantized} {web}");
}

/// Steps and straight lines stay what they are; what rests is left out of the values but not of their count.
#[test]
fn weights_of_a_mesh_are_one_track() {
    let text = "
[shape.a.box]
size = [1, 1, 1]
[shape.high.box]
size = [1, 2, 1]
[shape.wide.box]
size = [2, 1, 1]
[shape.deep.box]
size = [1, 1, 2]
[morph.a.high]
shape = \"high\"
[morph.a.wide]
shape = \"wide\"
weight = 0.5
[morph.a.deep]
shape = \"deep\"
[node.first]
shape = \"a\"
[node.second]
shape = \"a\"
at = [5, 0, 0]
[[clip.c.track]]
morph = \"a.high\"
between = \"step\"
keys = [{ at = 0, value = 0 }, { at = 0.5, value = 1 }, { at = 1, value = 0 }]
[[clip.d.track]]
morph = \"a.high\"
node = \"second\"
keys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]
[[clip.d.track]]
morph = \"a.deep\"
node = \"second\"
keys = [{ at = 0, value = 0 }, { at = 0.5, value = 1 }, { at = 1, value = 1 }]
";
    let baked = bake(text);
    let animations = baked.glb.list("animations");
    let values = |animation: usize, channel: usize| {
        let sampler = &animations[animation]["samplers"][channel];
        let index = |key: &str| usize::try_from(sampler[key].as_u64().expect("an index")).expect("small");
        let flat = |key: &str| baked.glb.accessor(index(key)).concat();
        (flat("input"), flat("output"), sampler["interpolation"].as_str().unwrap_or("LINEAR").to_owned())
    };
    assert_eq!(animations[0]["channels"].as_array().map(Vec::len), Some(2), "both nodes");
    let (times, rows, way) = values(0, 0);
    assert_eq!((times, way.as_str()), (vec![0.0, 0.5, 1.0], "STEP"));
    assert_eq!(rows, [0.0, 0.5, 0.0, 1.0, 0.5, 0.0, 0.0, 0.5, 0.0]);
    assert_eq!(animations[1]["channels"][0]["target"]["node"], 1);
    assert_eq!(animations[1]["channels"][0]["target"]["path"], "weights");
    let (times, rows, way) = values(1, 0);
    assert_eq!((times, way.as_str()), (vec![0.0, 0.5, 1.0], "LINEAR"));
    assert_eq!(rows, [0.0, 0.5, 0.0, 0.5, 0.5, 1.0, 1.0, 0.5, 1.0]);
    // The box over the motion holds both nodes at their widest: 1.5 wide, 2 high, 2 deep.
    let bounds = &animations[1]["extras"]["bounds"];
    let part = |end: &str, axis: usize| bounds[end][axis].as_f64().expect("a number");
    for (axis, (least, most)) in [(-0.75, 5.75), (-1.0, 1.0), (-1.0, 1.0)].into_iter().enumerate() {
        assert!(
            (part("min", axis) - least).abs() < 1e-3 && (part("max", axis) - most).abs() < 1e-3,
            "{bounds}"
        );
    }
}

/// Normals of a normal map's space: tangents have states where the shape has tangents.
#[test]
fn tangents_morph_with_their_surfaces() {
    let text = format!("{FLAG}[material.cloth]\nnormal-texture = {{ file = \"bumps.png\" }}\n")
        .replace("[shape.flag]\n", "[shape.flag]\nmaterial = \"cloth\"\n");
    let baked = bake(&text);
    let primitive = &baked.glb.list("meshes")[0]["primitives"][0];
    let index =
        |value: &serde_json::Value| usize::try_from(value.as_u64().expect("an index")).expect("small");
    let base = baked.glb.accessor(index(&primitive["attributes"]["TANGENT"]));
    let ways = baked.glb.accessor(index(&primitive["targets"][0]["TANGENT"]));
    let [places, normals] = baked.glb.targets(0).remove(0);
    for ((base, way), (place, normal)) in base.iter().zip(&ways).zip(places.iter().zip(&normals)) {
        let tangent = [0, 1, 2].map(|axis| base[axis] + way[axis]);
        assert!((length(tangent) - 1.0).abs() < 1e-5, "{tangent:?}");
        // u runs along x; tangents are means over faces, so near the normals' plane.
        let off: f64 = tangent.iter().zip(normal).map(|(a, b)| a * b).sum();
        assert!(off.abs() < 0.02 && tangent[0].abs() > 0.1, "{off} at {place:?}");
    }
}

/// Joints carry what weights have moved.
#[test]
fn a_skinned_shape_morphs() {
    let text = "
[parameters]
thick = 0.2
[shape.stick]
at = [0, 1, 0]
[shape.stick.box]
size = [\"= thick\", 2, \"= thick\"]
[morph.stick.thick]
with = { thick = 0.6 }
[skeleton.arm.joint.upper]
head = [0, 0, 0]
tail = [0, 1, 0]
[skeleton.arm.joint.lower]
parent = \"upper\"
tail = [0, 2, 0]
[skin.stick]
shape = \"stick\"
skeleton = \"arm\"
weights = \"rigid\"
[[clip.bend.track]]
joint = \"lower\"
path = \"rotation\"
axis = \"x\"
keys = [{ at = 0, value = 0 }, { at = 2, value = 90 }]
[[clip.bend.track]]
morph = \"stick.thick\"
keys = [{ at = 0, value = 0 }, { at = 2, value = 1 }]
";
    let baked = bake(text);
    let last = baked.report().clips["bend"].poses.last().expect("poses");
    let [thick, _] = baked.glb.targets(0).remove(0);
    for vertex in &last.vertices["stick"] {
        let [x, y, z] = thick[vertex.vertex];
        let expected = if y > 1.0 { [x, 1.0 - z, y - 1.0] } else { [x, y, z] };
        assert!(distance(vertex.at, expected) < 1e-6, "{vertex:?}");
    }
    let bounds = &baked.report().clips["bend"].bounds;
    let written = &baked.glb.list("animations")[0]["extras"]["bounds"];
    for axis in 0..3 {
        assert!(written["min"][axis].as_f64().expect("a number") <= bounds.min[axis] + 1e-6);
        assert!(written["max"][axis].as_f64().expect("a number") >= bounds.max[axis] - 1e-6);
    }
}
