//! Line drawings.

use glam::{DVec2, DVec3};
use kiln::geometry::number::floor_index;
use kiln::preview::lines::{Drawing, Ink, Kind, Trace, draw_lines, postscript, svg};
use kiln::preview::{Camera, Look, Projection, Stage, View, depths};

use super::{parallel, stage, view};

fn drawing(text: &str, from: View, look: &Look) -> (Drawing, Stage, Camera) {
    let (_, stage) = stage(text);
    let camera = Camera::on(&[&stage], from, look);
    (draw_lines(&stage, &camera), stage, camera)
}

fn apart(one: DVec3, other: DVec3) -> f64 {
    one.truncate().distance(other.truncate())
}

fn length(trace: &Trace) -> f64 {
    let back = if trace.closed { apart(trace.places[0], trace.places[trace.places.len() - 1]) } else { 0.0 };
    trace.places.windows(2).map(|pair| apart(pair[0], pair[1])).sum::<f64>() + back
}

fn total(drawing: &Drawing, of: impl Fn(Kind, u32) -> bool) -> f64 {
    drawing.traces.iter().filter(|trace| of(trace.kind, trace.hidden)).map(length).sum()
}

/// A cube seen from a corner: nine edges are seen, three lie behind one face each.
#[test]
fn a_cube_has_nine_edges_before_and_three_behind() {
    let look = parallel(1000);
    let (drawing, ..) =
        drawing("[shape.a.box]\nsize = [1, 1, 1]", View { azimuth: 45.0, elevation: 35.264_389_7 }, &look);
    // Seen along its diagonal all edges are equally long, and the whole is 2 sqrt(2/3) edges high.
    let edge = 880.0 / 2.0;
    let seen = total(&drawing, |kind, hidden| kind == Kind::Crease && hidden == 0);
    let behind = total(&drawing, |_, hidden| hidden == 1);
    assert!((seen - 9.0 * edge).abs() < 0.01 * edge, "{seen} {edge}");
    assert!((behind - 3.0 * edge).abs() < 0.01 * edge, "{behind} {edge}");
    assert!((total(&drawing, |_, _| true) - 12.0 * edge).abs() < 0.01 * edge);
}

/// The outline of a ball is its circle, and nothing else of it is drawn.
#[test]
fn a_ball_is_a_circle() {
    let (drawing, ..) =
        drawing("tolerance = 1e-4\n[shape.a.sphere]\nradius = 1", view("corner"), &parallel(1000));
    let around = total(&drawing, |kind, hidden| kind == Kind::Outline && hidden == 0);
    let circle = std::f64::consts::PI * 880.0;
    // Along the edges of triangles the way is a little longer.
    assert!(around > 0.999 * circle && around < 1.35 * circle, "{around} {circle}");
    let out = drawing.traces.iter().filter(|trace| trace.hidden == 0).flat_map(|trace| &trace.places);
    for place in out {
        let away = place.truncate().distance(DVec2::splat(500.0));
        assert!((away - 440.0).abs() < 440.0 * 0.02, "{away}");
    }
}

/// Bodies that stand, cross, touch and are open.
const BODIES: [&str; 4] = [
    "[shape.a]\nsegments = [24, 12]\n[shape.a.torus]\nradius = 1\ntube-radius = 0.35",
    "[shape.a.box]\nsize = [2, 1, 0.5]\n[shape.b.box]\nsize = [0.4, 2, 1.5]\n\
     [node.a]\nshape = \"a\"\n[node.b]\nshape = \"b\"\nat = [0.3, 0, 0]\nrotate = [10, 20, 0]",
    "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [1, 1, 1]\n\
     [node.a]\nshape = \"a\"\n[node.b]\nshape = \"b\"\nat = [1, 0.25, 0]",
    "[shape.a]\nsegments = [16, 1]\n[shape.a.revolve]\nprofile = { polyline = { points = [[0.4, 0], [0.5, 0.5], [0.2, 1]] } }",
];

/// How many triangles lie before a point, each by itself, and whether that is sure: not where a triangle ends near by, or
/// lies close in front or behind.
fn before(stage: &Stage, camera: &Camera, point: DVec3) -> (usize, bool) {
    let towards = camera.towards(point);
    let (mut count, mut sure) = (0, true);
    for triangle in &stage.triangles {
        let [a, b, c] = triangle.map(|corner| stage.vertices[corner as usize].point);
        let normal = (b - a).cross(c - a);
        let (height, slope, size) = (normal.dot(a - point), normal.dot(towards), normal.length());
        if slope.abs() < 1e-6 * size {
            continue;
        }
        let away = height / slope;
        let hit = point + towards * away;
        let share = |one: DVec3, other: DVec3| (one - hit).cross(other - hit).dot(normal) / (size * size);
        let least = share(b, c).min(share(c, a)).min(share(a, b));
        let on = away.abs() < 1e-6;
        sure &= on || least < -2e-3 || (least > 2e-3 && away.abs() > 2e-3) || away < -2e-3;
        count += usize::from(!on && least > 0.0 && away > 0.0);
    }
    (count, sure)
}

/// The number of triangles that hide a line is the one that is counted at its points, triangle by triangle.
#[test]
fn what_is_hidden_is_hidden_by_as_many_triangles_as_lie_before() {
    let mut checked = 0;
    for text in BODIES {
        for projection in [Projection::Orthographic, Projection::Perspective] {
            let look = Look { projection, ..parallel(1000) };
            let (drawing, stage, camera) = drawing(text, View { azimuth: 33.0, elevation: 21.0 }, &look);
            for trace in &drawing.traces {
                for pair in trace.places.windows(2) {
                    let point = camera.point(pair[0].lerp(pair[1], 0.437));
                    let (count, sure) = before(&stage, &camera, point);
                    if sure {
                        checked += 1;
                        assert_eq!(trace.hidden as usize, count, "{text}\nat {point}, {:?}", trace.kind);
                    }
                }
            }
        }
    }
    assert!(checked > 300, "only {checked} places were checked");
}

/// The nearest and the farthest that a z-buffer sees in a pixel and its neighbors.
fn around(depths: &[f32], size: usize, place: DVec2) -> (f64, f64) {
    let within = |value: f64| (floor_index(value - 1.0), floor_index(value + 1.0).min(size - 1));
    let ((left, right), (top, bottom)) = (within(place.x), within(place.y));
    let own = (top..=bottom).flat_map(|y| (left..=right).map(move |x| f64::from(depths[y * size + x])));
    own.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), own| (low.min(own), high.max(own)))
}

/// Lines that are seen lie on what the z-buffer sees, and hidden ones behind it: 99.9 % of the places that are further than
/// 1.5 pixels from other edges.
#[test]
fn lines_agree_with_the_z_buffer() {
    let (mut agree, mut all) = (0_u32, 0_u32);
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("specs");
    for name in ["chess/rook", "machine/gear", "solids/bracket", "building/arch", "swept/spring"] {
        let text = std::fs::read_to_string(folder.join(name).with_extension("toml")).expect(name);
        let look = parallel(600);
        let (drawing, stage, camera) = drawing(&text, view("corner"), &look);
        let depths = depths(&stage, &camera, look.size);
        let slack = 0.002 * stage.bounds.diagonal();
        for trace in &drawing.traces {
            for pair in trace.places.windows(2) {
                let place = pair[0].lerp(pair[1], 0.5);
                if crowded(&drawing, place.truncate()) {
                    continue;
                }
                let (nearest, farthest) = around(&depths, 600, place.truncate());
                all += 1;
                // Beside a line that is seen, what is seen lies on it or behind it; a hidden one lies behind something.
                let right =
                    if trace.hidden == 0 { place.z <= farthest + slack } else { place.z >= nearest - slack };
                agree += u32::from(right);
            }
        }
    }
    assert!(all > 500, "only {all} places");
    assert!(f64::from(agree) >= 0.999 * f64::from(all), "{agree} of {all} agree");
}

/// Whether two different lines pass a place within 1.5 pixels.
fn crowded(drawing: &Drawing, place: DVec2) -> bool {
    let near = |pair: &[DVec3]| {
        let (start, along) = (pair[0].truncate(), (pair[1] - pair[0]).truncate());
        let t = ((place - start).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        (start + along * t).distance(place) < 1.5
    };
    let passing = |trace: &Trace| trace.places.windows(2).any(near);
    drawing.traces.iter().filter(|trace| passing(trace)).count() > 1
}

/// The files are what their formats ask for, and draw the same lines.
#[test]
fn both_files_hold_the_same_lines() {
    let (drawing, ..) = drawing(BODIES[1], view("corner"), &parallel(500));
    let ink = Ink { size: (500, 500), hidden: true, paper: Some([255, 255, 255]) };
    let (vector, script) = (svg(&drawing, &ink), postscript(&drawing, &ink));
    assert_eq!(vector.matches("<path").count(), drawing.traces.len());
    assert_eq!(script.matches("stroke\n").count(), drawing.traces.len());
    assert!(vector.contains("stroke-dasharray") && script.contains("] 0 setdash"));
    assert!(script.starts_with("%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 500 500\n"));
    assert!(script.ends_with("%%EOF\n"));
    let seen = Ink { hidden: false, ..ink };
    let count = drawing.traces.iter().filter(|trace| trace.hidden == 0).count();
    assert_eq!(svg(&drawing, &seen).matches("<path").count(), count);
    assert!(!svg(&drawing, &seen).contains("dasharray"));
}
