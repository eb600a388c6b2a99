//! Curves, through the language, against reference values that other programs computed (`tests/data/curves`).

use std::io::Read;

use glam::DVec3;
use serde_json::Value;

use kiln::compile::{self, Options};
use kiln::geometry::curve::control::Knots;
use kiln::geometry::curve::{AnyCurve, Curve, Side, length};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

/// Relative to the size of the curve: both sides compute in double precision, the file keeps 13 decimals.
const POINTS: f64 = 1e-9;
const LENGTHS: f64 = 1e-8;

fn cases() -> Vec<Value> {
    let packed = include_bytes!("data/curves/curves.json.gz");
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

/// The curve that `[curve.c.KIND]` with these lines makes.
fn curve(kind: &str, lines: &str) -> AnyCurve {
    let text = format!("[curve.c.{kind}]\n{lines}\n[shape.s.sphere]\nradius = 1\n");
    let files = MemoryFiles::new().with("case.toml", text.as_bytes());
    let document = Document::load("case.toml", &files).unwrap_or_else(|found| panic!("{found}\n{text}"));
    let made = compile::curve(&document, &files, &Options::default(), "c");
    made.unwrap_or_else(|found| panic!("{found}\n{text}")).expect("it is defined")
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|number| number.as_f64().expect("a number")).collect()
}

fn point(list: &Value) -> DVec3 {
    let numbers = numbers(list);
    DVec3::new(numbers[0], numbers[1], numbers.get(2).copied().unwrap_or(0.0))
}

/// `name = value` lines of fields of the input.
fn fields(case: &Value, names: &[&str]) -> String {
    names.iter().map(|name| format!("{} = {}\n", name, case["input"][*name])).collect()
}

fn size(case: &Value) -> f64 {
    let rows = case["p"].as_array().expect("points").iter();
    rows.map(|row| numbers(row).iter().map(|x| x.abs()).fold(0.0, f64::max)).fold(0.0, f64::max)
}

#[track_caller]
fn assert_near(name: &Value, found: DVec3, expected: DVec3, size: f64) {
    assert!(found.distance(expected) <= POINTS * size, "{name}: {found} is not {expected}");
}

/// Points, derivatives and length over the parameters of the case.
fn hold(case: &Value, curve: &AnyCurve) {
    let (name, size) = (&case["name"], size(case));
    let domain = curve.domain();
    let places = numbers(&case["t"]);
    let speed = case["dp_dt"].as_array().expect("derivatives").iter();
    let speed = speed.map(|row| point(row).length()).fold(0.0, f64::max);
    assert!((domain.start - places[0]).abs() < 1e-9, "{name}: {domain:?}");
    for (k, t) in places.iter().enumerate() {
        let side = if *t >= domain.end { Side::Before } else { Side::After };
        let jet = curve.evaluate(*t, side);
        assert_near(name, jet.point, point(&case["p"][k]), size);
        assert_near(name, jet.first, point(&case["dp_dt"][k]), speed);
    }
    let expected = case["arc_length"].as_f64().expect("a length");
    let found = length(curve);
    assert!((found - expected).abs() <= LENGTHS * expected, "{name}: {found} is not {expected}");
}

#[test]
fn function_splines_match() {
    for case in of_kind("cubic_spline_function", 3) {
        let (x, y) = (numbers(&case["input"]["x"]), numbers(&case["input"]["y"]));
        let points: Vec<[f64; 2]> = x.iter().zip(&y).map(|(x, y)| [*x, *y]).collect();
        let ends = &case["input"]["ends"];
        let ends = if ends == "periodic" { "periodic = true".to_owned() } else { format!("ends = {ends}") };
        let graph = curve("function-spline", &format!("points = {points:?}\n{ends}"));
        let (heights, slopes) = (&case["p"], &case["dp_dt"]);
        let steepest =
            numbers(&slopes.as_array().expect("slopes").iter().map(|row| row[0].clone()).collect());
        let steepest = steepest.iter().map(|slope| slope.abs()).fold(1.0, f64::max);
        for (k, t) in numbers(&case["t"]).into_iter().enumerate() {
            let jet = graph.evaluate(t, if k == 49 { Side::Before } else { Side::After });
            let height = heights[k][0].as_f64().expect("a number");
            let slope = slopes[k][0].as_f64().expect("a number");
            assert_near(&case["name"], jet.point, DVec3::new(t, height, 0.0), size(&case));
            assert_near(&case["name"], jet.first, DVec3::new(1.0, slope, 0.0), steepest);
        }
    }
}

#[test]
fn splines_through_points_match() {
    for case in of_kind("natural_cubic_spline", 6) {
        let word = match case["input"]["parametrisation"].as_str() {
            Some("chord") => "chordal",
            Some(word) => word,
            None => panic!("{} says no parametrisation", case["name"]),
        };
        let points = fields(&case, &["points"]);
        hold(&case, &curve("natural-spline", &format!("{points}parameters = \"{word}\"")));
        let given = fields(&case, &["points", "parameters"]);
        hold(&case, &curve("spline", &format!("{given}ends = \"natural\"")));
    }
    for case in of_kind("periodic_cubic_spline", 1) {
        let closed = fields(&case, &["points", "closed", "parameters"]);
        hold(&case, &curve("spline", &closed));
        hold(&case, &curve("natural-spline", &closed));
    }
    for case in of_kind("hermite", 2) {
        hold(&case, &curve("hermite", &fields(&case, &["points", "tangents", "parameters"])));
    }
}

#[test]
fn bezier_curves_b_splines_and_nurbs_match() {
    for case in of_kind("bezier", 4) {
        hold(&case, &curve("bezier", &fields(&case, &["points", "degree"])));
    }
    for case in of_kind("bspline", 3) {
        hold(&case, &curve("b-spline", &fields(&case, &["points", "degree", "knots"])));
        let ones = vec![1; case["input"]["points"].as_array().expect("points").len()];
        let weighed = format!("{}weights = {ones:?}", fields(&case, &["points", "degree", "knots"]));
        hold(&case, &curve("nurbs", &weighed));
    }
    for case in of_kind("nurbs", 2) {
        hold(&case, &curve("nurbs", &fields(&case, &["points", "degree", "knots", "weights"])));
    }
    for case in of_kind("bspline_periodic_uniform", 1) {
        let loop_ = curve("b-spline", &fields(&case, &["points", "degree", "closed"]));
        assert!(loop_.is_closed());
        hold(&case, &loop_);
    }
}

/// Pieces between points, each over its own 0 to 1.
fn hold_segments(case: &Value, curve: &AnyCurve) {
    let domain = curve.domain();
    let knots = [vec![domain.start], curve.breaks(), vec![domain.end]].concat();
    for segment in case["segments"].as_array().expect("segments") {
        let k = segment["segment"].as_u64().and_then(|k| usize::try_from(k).ok()).expect("a number");
        for (u, expected) in numbers(&segment["u"]).into_iter().zip(segment["p"].as_array().expect("points"))
        {
            let t = knots[k] * (1.0 - u) + knots[k + 1] * u;
            assert_near(&case["name"], curve.evaluate(t, Side::Before).point, point(expected), 10.0);
        }
    }
}

#[test]
fn splines_by_their_neighbours_match() {
    for case in of_kind("catmull_rom", 6) {
        hold_segments(&case, &curve("catmull-rom", &fields(&case, &["points", "closed", "alpha"])));
    }
    for case in of_kind("kochanek_bartels", 2) {
        let lines = fields(&case, &["points", "closed", "tension", "continuity", "bias"]);
        hold_segments(&case, &curve("kochanek-bartels", &lines));
    }
    for case in of_kind("cardinal", 1) {
        hold_segments(&case, &curve("cardinal", &fields(&case, &["points", "closed", "scale"])));
        let scale = case["input"]["scale"].as_f64().expect("a number");
        let tension = format!("{}tension = {}", fields(&case, &["points", "closed"]), 1.0 - 2.0 * scale);
        hold_segments(&case, &curve("cardinal", &tension));
    }
}

#[test]
fn subdivision_curves_match() {
    for (kind, scheme, least) in [
        ("chaikin", "chaikin", 3),
        ("four_point_w1_16", "four-point", 2),
        ("lane_riesenfeld_cubic", "three-point", 2),
    ] {
        for case in of_kind(kind, least) {
            let name = &case["name"];
            let cut = if case["input"]["closed"] == true { "" } else { "ends = \"cut\"\n" };
            let lines = format!("{}{cut}scheme = \"{scheme}\"\n", fields(&case, &["points", "closed"]));
            let limit = curve("subdivision", &lines);
            for step in case["steps"].as_array().expect("steps") {
                let refined = curve("subdivision", &format!("{lines}levels = {}", step["step"]));
                let AnyCurve::Polyline(line) = &refined else { panic!("{name} is no polyline") };
                let count = expected_count(step) + f64::from(u8::from(cut.is_empty()));
                assert_eq!(line.points().len() as f64, count, "{name}");
                // The finest steps are given by their count and perimeter alone.
                let expected: Vec<DVec3> =
                    step["points"].as_array().into_iter().flatten().map(point).collect();
                let found = &line.points()[..expected.len()];
                for (found, expected) in found.iter().zip(&expected) {
                    assert_near(name, *found, *expected, 4.0);
                }
                if let Some(perimeter) = step["perimeter"].as_f64() {
                    assert!((length(&refined) / perimeter - 1.0).abs() < LENGTHS, "{name}");
                }
                if scheme == "four-point" {
                    // Interpolating: all points of all steps stay on the limit curve.
                    let count = case["input"]["points"].as_array().expect("points").len();
                    for (k, expected) in expected.iter().enumerate() {
                        let t = (k * count) as f64 / expected_count(step);
                        assert_near(name, limit.point(t), *expected, 4.0);
                    }
                }
            }
            hold_limit(&case, &limit);
        }
    }
}

fn expected_count(step: &Value) -> f64 {
    step["count"].as_f64().expect("a number")
}

fn hold_limit(case: &Value, limit: &AnyCurve) {
    if let Some(points) = case["limit_points"].as_array() {
        for (t, expected) in numbers(&case["limit_t"]).into_iter().zip(points) {
            assert_near(&case["name"], limit.point(t), point(expected), 4.0);
        }
    }
    if let Some(points) = case["limit_of_control_points"].as_array() {
        for (k, expected) in points.iter().enumerate() {
            assert_near(&case["name"], limit.point(k as f64), point(expected), 4.0);
        }
    }
    if let Some(expected) = case["limit_signed_area"].as_f64() {
        let domain = limit.domain();
        let at = |k: u32| limit.point(domain.at(f64::from(k) / 4000.0));
        let area: f64 = (0..4000).map(|k| at(k).cross(at(k + 1)).z / 2.0).sum();
        // A polygon of 4000 chords is short of the area by about a part in 4000^2.
        assert!((area / expected - 1.0).abs() < 1e-6, "{}: {area} is not {expected}", case["name"]);
    }
}

#[test]
fn the_published_basis_functions_match() {
    let [case] = <[Value; 1]>::try_from(of_kind("published_fact", 1)).expect("one case");
    let knots = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0]).expect("they fit");
    let (_, functions) = knots.basis(2.5);
    for (order, name) in ["N", "dN", "ddN"].into_iter().enumerate() {
        let found: Vec<f64> = functions.iter().map(|function| function[order]).collect();
        assert_eq!(found, numbers(&case[name]), "{name}");
    }
    for (t, span) in case["knot_span"].as_object().expect("spans") {
        assert_eq!(Some(knots.span(t.parse().expect("a number")) as u64), span.as_u64(), "{t}");
    }
}

#[test]
fn every_kind_of_case_is_held() {
    let held = [
        "bezier",
        "bspline",
        "bspline_periodic_uniform",
        "cardinal",
        "catmull_rom",
        "chaikin",
        "cubic_spline_function",
        "four_point_w1_16",
        "hermite",
        "kochanek_bartels",
        "lane_riesenfeld_cubic",
        "natural_cubic_spline",
        "nurbs",
        "periodic_cubic_spline",
        "published_fact",
    ];
    for case in cases() {
        assert!(held.iter().any(|kind| case["kind"] == *kind), "{}", case["kind"]);
    }
}

/// Kinds that are determined by their points, with fields that leave affine maps alone, and whether the curve stays
/// in the hull of its points.
const AFFINE: [(&str, &str, bool); 15] = [
    ("natural-spline", "parameters = \"uniform\"", false),
    ("spline", "parameters = \"nielsen\"\nends = \"not-a-knot\"", false),
    ("spline", "parameters = \"nielsen\"\nclosed = true", false),
    ("catmull-rom", "alpha = 0", false),
    ("cardinal", "tension = 0.3\nclosed = true", false),
    ("kochanek-bartels", "tension = 0.3\ncontinuity = -0.2\nbias = 0.5", false),
    ("bezier", "degree = 5", true),
    ("bezier", "degree = 5\nweights = [1, 2, 0.5, 3, 1, 1]", true),
    ("b-spline", "", true),
    ("b-spline", "degree = 4\nclosed = true", true),
    ("nurbs", "weights = [1, 2, 0.5, 3, 1, 1]", true),
    ("beta-spline", "bias = 2\ntension = 5\nends = \"cut\"", true),
    ("subdivision", "scheme = \"chaikin\"", true),
    ("subdivision", "scheme = \"three-point\"\nclosed = true", true),
    ("subdivision", "scheme = \"four-point\"", false),
];

const POLYGON: [DVec3; 6] = [
    DVec3::new(0.0, 0.0, 0.0),
    DVec3::new(2.0, -0.5, 1.0),
    DVec3::new(3.0, 1.0, 0.0),
    DVec3::new(2.2, 2.5, 0.5),
    DVec3::new(0.7, 2.2, 2.0),
    DVec3::new(-0.6, 1.4, 0.0),
];

fn through(kind: &str, points: &[DVec3], lines: &str) -> AnyCurve {
    let points: Vec<[f64; 3]> = points.iter().map(|point| point.to_array()).collect();
    curve(kind, &format!("points = {points:?}\n{lines}"))
}

#[test]
fn the_curve_of_mapped_points_is_the_mapped_curve() {
    let map = glam::DAffine3 {
        matrix3: glam::DMat3::from_cols(
            DVec3::new(3.0, 0.2, 0.0),
            DVec3::new(-0.7, 0.5, 0.1),
            DVec3::new(0.3, 0.0, 2.0),
        ),
        translation: DVec3::new(1.0, -2.0, 0.5),
    };
    let images = POLYGON.map(|point| map.transform_point3(point));
    for (kind, lines, _) in AFFINE {
        let (own, mapped) = (through(kind, &POLYGON, lines), through(kind, &images, lines));
        for k in 0..=200 {
            let share = f64::from(k) / 200.0;
            let (point, image) = (own.point(own.domain().at(share)), mapped.point(mapped.domain().at(share)));
            assert!(map.transform_point3(point).distance(image) < 1e-11, "{kind} {lines} at {share}");
        }
    }
}

#[test]
fn curves_stay_in_the_hull_of_their_points() {
    // In every direction the curve reaches no further than the farthest point.
    let directions = (0..500).map(|k| {
        let (turn, rise) = (f64::from(k) * 2.399_963, f64::from(k) / 250.0 - 1.0);
        let (sin, cos) = kiln::geometry::number::sin_cos(turn);
        DVec3::new(cos * (1.0 - rise * rise).sqrt(), sin * (1.0 - rise * rise).sqrt(), rise)
    });
    let directions: Vec<DVec3> = directions.collect();
    for (kind, lines, inside) in AFFINE {
        let own = through(kind, &POLYGON, lines);
        let points: Vec<DVec3> =
            (0..=300).map(|k| own.point(own.domain().at(f64::from(k) / 300.0))).collect();
        let reach = |points: &[DVec3], way: DVec3| points.iter().map(|p| p.dot(way)).fold(f64::MIN, f64::max);
        let beyond = directions.iter().any(|way| reach(&points, *way) > reach(&POLYGON, *way) + 1e-12);
        assert_eq!(beyond, !inside, "{kind} {lines}");
    }
}

/// A projective map of homogeneous points maps a rational curve; a polynomial one is not mapped so.
#[test]
fn rational_curves_are_projectively_invariant_and_polynomial_ones_are_not() {
    let weigh = |p: DVec3| 1.0 + 0.2 * p.x + 0.1 * p.y + 0.05 * p.z;
    let image = |p: DVec3| p / weigh(p);
    let images = POLYGON.map(image);
    let weights = POLYGON.map(weigh);
    let plain = through("b-spline", &POLYGON, "");
    let rational = through("nurbs", &images, &format!("weights = {weights:?}"));
    let polynomial = through("b-spline", &images, "");
    let mut apart = 0.0_f64;
    for k in 0..=100 {
        let share = f64::from(k) / 100.0;
        let expected = image(plain.point(plain.domain().at(share)));
        assert!(rational.point(rational.domain().at(share)).distance(expected) < 1e-13);
        apart = apart.max(polynomial.point(polynomial.domain().at(share)).distance(expected));
    }
    assert!(apart > 0.01, "{apart}");
}
