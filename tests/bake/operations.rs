//! Operations on profiles: areas and lengths of school, and that what is exact stays exact.

use core::f64::consts::PI;

use kiln::geometry::curve::{AnyCurve, Continuity, Curve as _, Side, length};
use kiln::language::Document;
use kiln::language::source::MemoryFiles;

use super::bake;

const TOLERANCE: f64 = 1e-5;

/// The area of what a curve in place encloses, and the lengths of its parts.
fn measured(curve: &str) -> (f64, Vec<f64>) {
    let parts = parts(curve);
    let lengths = parts.iter().map(length).collect();
    let text = format!("tolerance = {TOLERANCE}\n[shape.a.sheet]\nprofile = {{ {curve} }}");
    let baked = bake(&text);
    assert_eq!(baked.only().facts.boundary_loops, parts.len() as u64, "{curve}");
    (baked.only().facts.area, lengths)
}

fn parts(curve: &str) -> Vec<AnyCurve> {
    let text = format!("[curve.a.group]\nof = [{{ {curve} }}]");
    let files = MemoryFiles::new().with("spec.toml", text);
    let document = Document::load("spec.toml", &files).unwrap_or_else(|found| panic!("{found}"));
    kiln::compile::curve_parts(&document, &files, &kiln::compile::Options::default(), "a")
        .unwrap_or_else(|found| panic!("{found}"))
        .expect("it is there")
}

/// Area within what chords at the tolerance leave out.
#[track_caller]
fn assert_area(curve: &str, expected: f64) {
    let (area, lengths) = measured(curve);
    let slack = TOLERANCE * lengths.iter().sum::<f64>();
    assert!((area - expected).abs() <= slack, "{curve}: area {area} instead of {expected}");
}

#[track_caller]
fn assert_length(curve: &str, expected: f64) {
    let found: f64 = parts(curve).iter().map(length).sum();
    assert!((found - expected).abs() <= 1e-9 * expected, "{curve}: length {found} instead of {expected}");
}

fn circle(x: f64) -> String {
    format!("{{ circle = {{ radius = 1, center = [{x}, 0] }} }}")
}

const SQUARE: &str = "{ polyline = { points = [[0, 0], [2, 0], [2, 2], [0, 2]], closed = true } }";

#[test]
fn circles_meet_in_lenses() {
    // Two unit circles at distance 1 share the lens 2 pi / 3 - sqrt 3 / 2, bounded by two thirds of a turn.
    let lens = 2.0 * PI / 3.0 - 3.0_f64.sqrt() / 2.0;
    let pair = format!("[{}, {}]", circle(0.0), circle(1.0));
    assert_area(&format!("union = {{ of = {pair} }}"), 2.0 * PI - lens);
    assert_area(&format!("difference = {{ of = {pair} }}"), PI - lens);
    assert_area(&format!("intersection = {{ of = {pair} }}"), lens);
    // The crescents of both meet in two corners, so that no one sheet holds them.
    assert_length(&format!("xor = {{ of = {pair} }}"), 4.0 * PI);
    // Lengths show that arcs stay arcs and crossings are those of the circles.
    assert_length(&format!("union = {{ of = {pair} }}"), 8.0 * PI / 3.0);
    assert_length(&format!("intersection = {{ of = {pair} }}"), 4.0 * PI / 3.0);
}

#[test]
fn corners_are_where_outlines_cross_and_nowhere_else() {
    let parts = parts(&format!("union = {{ of = [{}, {}] }}", circle(0.0), circle(1.0)));
    let [AnyCurve::Path(path)] = parts.as_slice() else { panic!("{parts:?}") };
    let corners: Vec<_> = (0..path.curves().len())
        .filter(|joint| path.meeting(*joint).continuity() < Continuity::G1)
        .map(|joint| path.point(joint as f64))
        .collect();
    assert_eq!(corners.len(), 2);
    for corner in corners {
        assert!(
            (corner.x - 0.5).abs() < 1e-12 && (corner.y.abs() - 0.75_f64.sqrt()).abs() < 1e-12,
            "{corner}"
        );
    }
    assert!((0..path.curves().len()).all(|joint| path.meeting(joint).continuity() > Continuity::Gap));
}

#[test]
fn sides_in_common_are_joined() {
    let beside = "{ polyline = { points = [[2, 0.5], [3, 0.5], [3, 2.5], [2, 2.5]], closed = true } }";
    assert_area(&format!("union = {{ of = [{SQUARE}, {beside}] }}"), 6.0);
    let inside = "{ polyline = { points = [[0, 0], [1, 0], [1, 2], [0, 2]], closed = true } }";
    assert_area(&format!("difference = {{ of = [{SQUARE}, {inside}] }}"), 2.0);
    assert_area(&format!("intersection = {{ of = [{SQUARE}, {SQUARE}] }}"), 4.0);
    // One circle twice, with chords that differ.
    let turned = "{ transform = { of = { circle = { radius = 1 } }, rotate = [0, 0, 33] } }";
    assert_area(&format!("union = {{ of = [{}, {turned}] }}", circle(0.0)), PI);
}

#[test]
fn holes_are_parts() {
    let ring = format!("difference = {{ of = [{{ circle = {{ radius = 3 }} }}, {}] }}", circle(0.5));
    assert_area(&ring, 8.0 * PI);
    assert_eq!(parts(&ring).len(), 2);
    // What has holes can be worked on: a bar across the ring.
    let bar = "{ polyline = { points = [[-4, -0.25], [4, -0.25], [4, 0.25], [-4, 0.25]], closed = true } }";
    let (all, cut) = (
        format!("union = {{ of = [{{ {ring} }}, {bar}] }}"),
        format!("difference = {{ of = [{{ {ring} }}, {bar}] }}"),
    );
    let ((with, _), (without, pieces)) = (measured(&all), measured(&cut));
    assert!((with - without - 4.0).abs() < 1e-3, "{with} {without}");
    assert_eq!(pieces.len(), 2);
}

#[test]
fn parallels_of_convex_outlines_are_those_of_steiner() {
    // Area A + L d + pi d^2, length L + 2 pi d.
    let round = |of: &str, distance: f64| format!("offset = {{ of = {of}, distance = {distance} }}");
    assert_area(&round(SQUARE, 0.5), 4.0 + 8.0 * 0.5 + PI * 0.25);
    assert_length(&round(SQUARE, 0.5), 8.0 + PI);
    assert_area(&round(SQUARE, -0.5), 1.0);
    assert_area(&round(&circle(0.0), 0.25), PI * 1.5625);
    assert_length(&round(&circle(0.0), -0.25), PI * 1.5);
    let ellipse = "{ ellipse = { radii = [3, 2] } }";
    let around = 15.865_439_589_290_59;
    assert_area(&round(ellipse, 0.7), 6.0 * PI + around * 0.7 + PI * 0.49);
    assert_length(&round(ellipse, 0.7), around + 2.0 * PI * 0.7);
    // Inward as far as the sharpest bend, 4 / 3, allows nothing is lost.
    assert_area(&round(ellipse, -1.0), 6.0 * PI - around + PI);
    let open = format!("offset = {{ of = {SQUARE}, distance = 0.5, corner = \"miter\" }}");
    assert_area(&open, 9.0);
    assert_area(&open.replace("miter", "bevel"), 4.0 + 4.0 + 2.0 * 0.25);
    // A tip of a right angle is 1.414 distances away.
    assert_area(
        &format!("offset = {{ of = {SQUARE}, distance = 0.5, corner = \"miter\", miter-limit = 1.4 }}"),
        8.5,
    );
}

#[test]
fn parallels_lose_what_has_no_room() {
    // A dumbbell: the bar goes, the ends stay.
    let bone = "{ union = { of = [{ circle = { radius = 1 } }, { circle = { radius = 1, center = [5, 0] } }, { polyline = { points = [[0, -0.2], [5, -0.2], [5, 0.2], [0, 0.2]], closed = true } }] } }";
    let (area, parts) = measured(&format!("offset = {{ of = {bone}, distance = -0.5 }}"));
    assert_eq!(parts.len(), 2);
    // Between the two inner corners of an end a little more stays than a disk.
    assert!((2.0 * PI * 0.25..2.0 * PI * 0.25 + 0.01).contains(&area), "{area}");
    // Far inward of an ellipse, beyond the bends at its ends: two arcs that cross on the long axis.
    let (area, parts) = measured("offset = { of = { ellipse = { radii = [3, 1] } }, distance = -0.9 }");
    assert_eq!(parts.len(), 1);
    assert!(area > 0.0 && area < 0.4, "{area}");
    // A ring grows on both sides, until its hole is gone.
    let ring = format!("{{ difference = {{ of = [{{ circle = {{ radius = 3 }} }}, {}] }} }}", circle(0.0));
    assert_area(&format!("offset = {{ of = {ring}, distance = 0.5 }}"), PI * (12.25 - 0.25));
    assert_area(&format!("offset = {{ of = {ring}, distance = 1.5 }}"), PI * 20.25);
}

#[test]
fn fillets_are_tangent_arcs() {
    let rounded = format!("fillet = {{ of = {SQUARE}, radius = 0.5 }}");
    assert_area(&rounded, 4.0 - (4.0 - PI) * 0.25);
    assert_length(&rounded, 4.0 + PI);
    assert!(parts(&rounded)[0].joints().is_empty(), "nothing of the corners is left");
    assert_area(
        &format!("fillet = {{ of = {SQUARE}, radius = 0.5, corners = [1] }}"),
        4.0 - (1.0 - PI / 4.0) * 0.25,
    );
    // The whole side is used up.
    assert_length(&format!("fillet = {{ of = {SQUARE}, radius = 1 }}"), 2.0 * PI);
    // A half disk: an arc and its chord. The center lies at distance r above the chord and 1 - r from the middle.
    let half = "{ path = { start = [-1, 0], segments = [{ line = [[1, 0]] }, { arc = { through = [0, 1], to = [-1, 0] } }], joints = [\"corner\"] } }";
    let parts = parts(&format!("fillet = {{ of = {half}, radius = 0.25 }}"));
    let curve = &parts[0];
    assert!(curve.joints().is_empty() && curve.is_closed());
    let center = (0.75_f64 * 0.75 - 0.0625).sqrt();
    let domain = curve.domain();
    let mut touched = 0;
    for k in 0..=4000 {
        let jet = curve.evaluate(domain.at(f64::from(k) / 4000.0), Side::Before);
        let away = (jet.point - glam::DVec3::new(jet.point.x.signum() * center, 0.25, 0.0)).length();
        touched += usize::from((away - 0.25).abs() < 1e-12);
        assert!(jet.point.y > -1e-12 && jet.point.length() < 1.0 + 1e-12);
    }
    assert!(touched > 500, "{touched} places lie on the two arcs");
}

#[test]
fn chamfers_cut_corners() {
    assert_area(&format!("chamfer = {{ of = {SQUARE}, distance = 0.5 }}"), 4.0 - 4.0 * 0.125);
    assert_length(&format!("chamfer = {{ of = {SQUARE}, distance = 0.5 }}"), 4.0 + 4.0 * 0.5_f64.sqrt());
    assert_area(&format!("chamfer = {{ of = {SQUARE}, distance = 1 }}"), 2.0);
}

#[test]
fn operations_follow_one_another() {
    // A keyhole plate: rounded, with a slot made of a hole and a bar, and a wall around all of it.
    let slot = "{ union = { of = [{ circle = { radius = 0.3, center = [1, 1.2] } }, { polyline = { points = [[0.9, 0.5], [1.1, 0.5], [1.1, 1.2], [0.9, 1.2]], closed = true } }] } }";
    let plate =
        format!("{{ difference = {{ of = [{{ fillet = {{ of = {SQUARE}, radius = 0.25 }} }}, {slot}] }} }}");
    let wall =
        format!("difference = {{ of = [{{ offset = {{ of = {plate}, distance = 0.1 }} }}, {plate}] }}");
    let (area, lengths) = measured(&wall);
    assert_eq!(lengths.len(), 4);
    // Twice the mean of inner and outer lengths: each band is 0.1 wide.
    let around: f64 = lengths.iter().sum();
    assert!((area - around * 0.05).abs() < 0.02, "{area} {around}");
}
