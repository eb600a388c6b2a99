//! Surfaces by control points, through the language, against reference values that other programs computed
//! (`tests/data/surfaces`).

use std::io::Read;

use glam::DVec3;
use serde_json::{Value, json};

use kiln::compile::{self, Options};
use kiln::geometry::surface::{AnySurface, Surface, joints, measure};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;
use kiln::model::Recipe;

/// Relative to the size of the surface: both sides compute in double precision, the file keeps 12 decimals.
const POINTS: f64 = 1e-9;

fn cases() -> Vec<Value> {
    let packed = include_bytes!("data/surfaces/surfaces.json.gz");
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed.as_slice()).read_to_string(&mut text).expect("it unpacks");
    let file: Value = serde_json::from_str(&text).expect("it is JSON");
    file["cases"].as_array().expect("a list of cases").clone()
}

fn of_kind(kind: &str, least: usize) -> Vec<Value> {
    let found: Vec<Value> = cases().into_iter().filter(|case| case["kind"] == kind).collect();
    assert!(found.len() >= least, "only {} of {kind}", found.len());
    found
}

/// The surfaces of the first shape of a document.
fn surfaces(text: &str) -> Vec<AnySurface> {
    let files = MemoryFiles::new().with("case.toml", text.as_bytes());
    let document = Document::load("case.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let made = compile::model(&document, &files, &Options::default());
    let model = made.unwrap_or_else(|found| panic!("{found}\n{text}"));
    match &model.shapes[0].recipe {
        Recipe::Patches { patches, .. } => patches.surfaces.clone(),
        other => panic!("not made of surfaces: {other:?}"),
    }
}

fn shape(kind: &str, lines: &str) -> AnySurface {
    let mut all = surfaces(&format!("[shape.s.{kind}]\n{lines}\n"));
    assert_eq!(all.len(), 1);
    all.remove(0)
}

fn point(list: &Value) -> DVec3 {
    let number = |k: usize| list[k].as_f64().expect("a number");
    DVec3::new(number(0), number(1), number(2))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Grids of the file have a row for each step of u, those of documents for each step of v.
fn transposed(grid: &Value) -> Value {
    let rows = grid.as_array().expect("rows");
    let columns = rows[0].as_array().expect("a row").len();
    (0..columns).map(|j| rows.iter().map(|row| row[j].clone()).collect::<Value>()).collect()
}

/// Points, derivatives and normals of all samples.
fn hold(name: &str, surface: &AnySurface, samples: &Value) {
    let samples = samples.as_array().expect("samples");
    let sizes = ["p", "du", "dv"]
        .map(|key| samples.iter().map(|sample| point(&sample[key]).length()).fold(0.0, f64::max));
    for sample in samples {
        let (u, v) = (number(&sample["u"]), number(&sample["v"]));
        let jet = surface.evaluate(u, v);
        for ((found, key), size) in [(jet.point, "p"), (jet.du, "du"), (jet.dv, "dv")].into_iter().zip(sizes)
        {
            let expected = point(&sample[key]);
            let near = found.distance(expected) <= POINTS * size;
            assert!(near, "{name} {key} at {u} {v}: {found}, not {expected}");
        }
        if !sample["n"].is_null() {
            let expected = point(&sample["n"]);
            assert!(jet.normal.distance(expected) <= POINTS, "{name} at {u} {v}: {}", jet.normal);
        }
    }
}

#[track_caller]
fn assert_close(what: &str, found: f64, expected: f64, share: f64) {
    assert!((found - expected).abs() <= share * expected.abs(), "{what}: {found} is not {expected}");
}

fn knots(case: &Value) -> String {
    format!(
        "degree = [{}, {}]\nknots-u = {}\nknots-v = {}\ncontrol = {}\n",
        case["degree_u"],
        case["degree_v"],
        case["knots_u"],
        case["knots_v"],
        transposed(&case["points"])
    )
}

#[test]
fn b_splines_and_nurbs_match() {
    for case in of_kind("bspline_surface", 3) {
        let name = case["name"].as_str().expect("a name");
        let surface = shape("b-spline", &knots(&case));
        hold(name, &surface, &case["samples"]);
        assert_close(name, measure(&surface).area, number(&case["area"]), 1e-9);
    }
    for case in of_kind("nurbs_surface", 2) {
        let name = case["name"].as_str().expect("a name");
        let weights = format!("weights = {}\n", transposed(&case["weights"]));
        let surface = shape("nurbs", &format!("{}{weights}", knots(&case)));
        assert!(matches!(surface, AnySurface::Rational(_)), "{name}");
        hold(name, &surface, &case["samples"]);
        assert_close(name, measure(&surface).area, number(&case["area"]), 1e-8);
    }
}

#[test]
fn uniform_b_spline_patches_match_by_name_and_by_matrix() {
    for case in of_kind("uniform_bicubic_bspline_patch", 1) {
        let control = format!("control = {}\n", transposed(&case["points"]));
        let matrix = "[[-0.16666666666666666, 0.5, -0.5, 0.16666666666666666], [0.5, -1, 0.5, 0], \
            [-0.5, 0, 0.5, 0], [0.16666666666666666, 0.6666666666666666, 0.16666666666666666, 0]]";
        for (basis, ends) in [("\"b-spline\"", "ends = \"cut\"\n"), (matrix, "")] {
            let surface = shape("patches", &format!("basis = {basis}\n{ends}{control}"));
            hold(basis, &surface, &case["samples"]);
            assert_close(basis, measure(&surface).area, number(&case["area"]), 1e-9);
        }
    }
}

#[test]
fn hermite_patches_match_with_twists_and_without() {
    for case in of_kind("bicubic_hermite", 1) {
        let name = case["name"].as_str().expect("a name");
        let [corners, by_u, by_v, twist] =
            ["corners", "tangent_u", "tangent_v", "twist"].map(|key| transposed(&case[key]));
        let lines = format!("points = {corners}\nalong-u = {by_u}\nalong-v = {by_v}\n");
        for twists in [String::new(), format!("twists = {twist}\n")] {
            let surface = shape("hermite", &format!("{lines}{twists}"));
            hold(name, &surface, &case["samples"]);
            assert_close(name, measure(&surface).area, number(&case["area"]), 1e-9);
        }
        // The same as one patch of sixteen vectors.
        let row = |left: &Value, right: &Value| {
            [&left[0], &left[1], &right[0], &right[1]].into_iter().cloned().collect::<Value>()
        };
        let rows = [(&corners, &by_u, 0), (&corners, &by_u, 1), (&by_v, &twist, 0), (&by_v, &twist, 1)];
        let rows: Value = rows.into_iter().map(|(left, right, v)| row(&left[v], &right[v])).collect();
        hold(name, &shape("patches", &format!("basis = \"hermite\"\ncontrol = {rows}\n")), &case["samples"]);
    }
}

/// Samples of a surface whose parameters are exchanged, which turns it around.
fn exchanged(samples: &Value) -> Value {
    let turned = |sample: &Value| {
        let normal = sample["n"].as_array().map(|n| n.iter().map(|x| -number(x)).collect::<Vec<_>>());
        json!({
            "u": sample["v"], "v": sample["u"], "p": sample["p"], "du": sample["dv"], "dv": sample["du"], "n": normal,
        })
    };
    samples.as_array().expect("samples").iter().map(turned).collect()
}

/// Samples, area of each patch, area and volume of all, sides that are a point: of a model of the tea set, which
/// is turned around where the table's patches show their inside.
fn hold_tea(name: &str, patches: &[AnySurface], around: bool) {
    let case = of_kind("bicubic_bezier", 2).into_iter().find(|case| case["name"] == name);
    let case = case.expect("a case of that name");
    assert_eq!(patches.len() as u64, case["patches"].as_u64().expect("a number"));
    for (index, samples) in case["samples"].as_object().expect("samples") {
        let index: usize = index.parse().expect("a number");
        let samples = if around { exchanged(samples) } else { samples.clone() };
        hold(&format!("{name} {index}"), &patches[index], &samples);
    }
    let found: Vec<_> = patches.iter().map(measure).collect();
    let joints = joints(patches);
    for (index, measures) in found.iter().enumerate() {
        // The rules of the reference are good for eight digits, at collapsed sides for six.
        let collapsed = joints.collapsed.iter().any(|(other, _)| *other == index);
        let expected = number(&case["area_per_patch"][index]);
        let share = if collapsed { 1e-6 } else { 1e-8 };
        assert_close(&format!("{name} {index}"), measures.area, expected, share);
    }
    let sum = |of: fn(&kiln::geometry::surface::SurfaceMeasures) -> f64| found.iter().map(of).sum::<f64>();
    assert_close(name, sum(|measures| measures.area), number(&case["area_total"]), 1e-7);
    let volume = if around { -1.0 } else { 1.0 } * number(&case["closed_flux_volume"]);
    assert_close(name, sum(|measures| measures.volume), volume, 1e-9);
    let expected = case["degenerate_patches"].as_array().expect("a list").iter();
    let expected: Vec<u64> = expected.map(|k| k.as_u64().expect("a number")).collect();
    assert_eq!(joints.collapsed.iter().map(|(patch, _)| *patch as u64).collect::<Vec<_>>(), expected);
}

#[test]
fn the_teapot_is_that_of_the_table() {
    hold_tea("teapot_32.bpt", &surfaces(include_str!("../specs/patches/teapot.toml")), false);
}

#[test]
fn the_cup_is_that_of_the_table() {
    hold_tea("teacup_26.json", &surfaces(include_str!("../specs/patches/teacup.toml")), true);
}
