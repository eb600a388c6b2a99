//! Line drawings.

use std::collections::BTreeSet;

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

/// The length in space of the lines in which surfaces cross, and of those of them that are seen.
fn crossed(text: &str, from: View) -> (f64, f64) {
    let (drawing, _, camera) = drawing(text, from, &parallel(1000));
    let long = |trace: &Trace| {
        let mut places: Vec<DVec3> = trace.places.iter().map(|place| camera.point(*place)).collect();
        places.extend(trace.closed.then(|| places[0]));
        places.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>()
    };
    let own = || drawing.traces.iter().filter(|trace| trace.kind == Kind::Intersection);
    (own().map(long).sum(), own().filter(|trace| trace.hidden == 0).map(long).sum())
}

/// A bar through a wall: a square around it on each side of the wall, of which half is seen from a corner.
#[test]
fn a_bar_through_a_wall_has_a_square_on_either_side() {
    let text = "[shape.bar.box]\nsize = [4, 1, 1]\n[shape.wall.box]\nsize = [0.5, 3, 3]\n\
                [node.bar]\nshape = \"bar\"\n[node.wall]\nshape = \"wall\"";
    let (all, seen) = crossed(text, View { azimuth: 50.0, elevation: 20.0 });
    assert!((all - 8.0).abs() < 1e-5, "{all}");
    // Before the wall the upper and the front side of the square; the bar hides the other two, the wall the other square.
    assert!((seen - 2.0).abs() < 0.01, "{seen}");
}

/// A plane cuts a torus in two circles, and all of both is seen from above.
#[test]
fn a_plane_cuts_a_torus_in_two_circles() {
    let text = "tolerance = 1e-3\n[shape.ring.torus]\nradius = 1\ntube-radius = 0.4\n\
                [shape.cut.plane]\nsize = [4, 4]\n[node.ring]\nshape = \"ring\"\n\
                [node.cut]\nshape = \"cut\"\nat = [0, 0.1, 0]";
    let (all, seen) = crossed(text, view("top"));
    // Their radii are 1 more and 1 less than the same length: their sum is 2.
    let circles = 4.0 * std::f64::consts::PI;
    assert!((all - circles).abs() < 0.005 * circles, "{all} {circles}");
    assert!((seen - all).abs() < 0.005 * circles, "{seen} of {all}");
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
    // The last two have parts that run through each other.
    for name in [
        "chess/rook",
        "machine/gear",
        "solids/bracket",
        "building/arch",
        "swept/spring",
        "garden/fence",
        "lamps/stool",
    ] {
        let text = std::fs::read_to_string(folder.join(name).with_extension("toml")).expect(name);
        let look = parallel(600);
        let (drawing, stage, camera) = drawing(&text, view("corner"), &look);
        let depths = depths(&stage, &camera, look.size);
        let slack = 0.002 * stage.bounds.diagonal();
        let near = Near::new(&drawing, 600);
        for trace in &drawing.traces {
            for pair in trace.places.windows(2) {
                let place = pair[0].lerp(pair[1], 0.5);
                if near.crowded(place.truncate()) {
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

/// Pieces of lines, by the pixels that they come near to.
struct Near<'a> {
    drawing: &'a Drawing,
    size: usize,
    pixels: Vec<Vec<(usize, usize)>>,
}

impl<'a> Near<'a> {
    /// How near another line is too near, in pixels.
    const REACH: f64 = 1.5;

    fn new(drawing: &'a Drawing, size: usize) -> Self {
        let mut near = Self { drawing, size, pixels: vec![Vec::new(); size * size] };
        for (number, trace) in drawing.traces.iter().enumerate() {
            for (step, pair) in trace.places.windows(2).enumerate() {
                let (low, high) = (pair[0].min(pair[1]) - Self::REACH, pair[0].max(pair[1]) + Self::REACH);
                for y in near.pixel(low.y)..=near.pixel(high.y) {
                    for x in near.pixel(low.x)..=near.pixel(high.x) {
                        near.pixels[y * size + x].push((number, step));
                    }
                }
            }
        }
        near
    }

    fn pixel(&self, place: f64) -> usize {
        floor_index(place).min(self.size - 1)
    }

    /// Whether two different lines pass a place.
    fn crowded(&self, place: DVec2) -> bool {
        let passes = |(number, step): (usize, usize)| {
            let places = &self.drawing.traces[number].places;
            let (start, end) = (places[step].truncate(), places[step + 1].truncate());
            let along = end - start;
            let t = ((place - start).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
            (start + along * t).distance(place) < Self::REACH
        };
        let own = self.pixels[self.pixel(place.y) * self.size + self.pixel(place.x)].iter().copied();
        let passing: BTreeSet<usize> = own.filter(|piece| passes(*piece)).map(|(number, _)| number).collect();
        passing.len() > 1
    }
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
