//! Surfaces by control points: closed forms that they reach, how fast, and how they close.

use core::f64::consts::PI;

use kiln::compile::Options;
use kiln::geometry::number::ln;

use super::{assert_near, bake, compile};

/// Half a circle (v) turned once (u): poles at both ends, a seam along the middle of every row.
const BALL: &str = "[shape.a.nurbs]
degree = 2
knots-u = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]
knots-v = [0, 0, 0, 1, 1, 2, 2, 2]
control = [
  { count = 9, each = '= [0, -1, 0]' },
  { count = 9, each = '= [round(cos(i * 45)), -1, -round(sin(i * 45))]' },
  { count = 9, each = '= [round(cos(i * 45)), 0, -round(sin(i * 45))]' },
  { count = 9, each = '= [round(cos(i * 45)), 1, -round(sin(i * 45))]' },
  { count = 9, each = '= [0, 1, 0]' },
]
weights = [
  { count = 9, each = '= if(i % 2 == 0, 1, sqrt(0.5))' },
  { count = 9, each = '= if(i % 2 == 0, 1, sqrt(0.5)) * sqrt(0.5)' },
  { count = 9, each = '= if(i % 2 == 0, 1, sqrt(0.5))' },
  { count = 9, each = '= if(i % 2 == 0, 1, sqrt(0.5)) * sqrt(0.5)' },
  { count = 9, each = '= if(i % 2 == 0, 1, sqrt(0.5))' },
]
";

/// A half pipe of radius 1 and length 2 whose middle row of points lies at infinity: (1 - t^2, 2t) / (1 + t^2).
const HALF_PIPE: &str = "[shape.a.nurbs]
degree = [2, 1]
control = [[[1, 0, 0], [0, 0, -1], [-1, 0, 0]], [[1, 2, 0], [0, 0, -1], [-1, 2, 0]]]
weights = [[1, 0, 1], [1, 0, 1]]
";

/// A ring by a closed B-spline: no closed form, but the sum of its own pieces.
const RING: &str = "[shape.a.b-spline]
closed = ['u', 'v']
control = [
  { count = 8, each = '= [3 * cos(i * 45), 1, -3 * sin(i * 45)]' },
  { count = 8, each = '= [2 * cos(i * 45), 0, -2 * sin(i * 45)]' },
  { count = 8, each = '= [3 * cos(i * 45), -1, -3 * sin(i * 45)]' },
  { count = 8, each = '= [4 * cos(i * 45), 0, -4 * sin(i * 45)]' },
]
";

fn exponent(points: &[(f64, f64)]) -> f64 {
    let count = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (ln(*x), ln(*y))).collect();
    let middle = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (x, y) = (middle(|log| log.0), middle(|log| log.1));
    let across: f64 = logs.iter().map(|(a, b)| (a - x) * (b - y)).sum();
    across / logs.iter().map(|(a, _)| (a - x) * (a - x)).sum::<f64>()
}

#[test]
fn a_ball_of_weights_converges_to_the_ball() {
    let (mut areas, mut volumes) = (Vec::new(), Vec::new());
    for tolerance in [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5] {
        let compiled = compile(&format!("tolerance = {tolerance}\n{BALL}"), &Options::default());
        let shape = compiled.expect("it bakes").report.expect("a report").shapes[0].facts.clone();
        let facts = shape;
        assert!(facts.closed && facts.manifold && facts.genus == Some(0), "{facts:?}");
        let volume = facts.volume.expect("closed");
        assert!(volume > 0.0 && volume < 4.0 * PI / 3.0, "chords lie inside, turned outward: {volume}");
        areas.push((tolerance, 4.0 * PI - facts.area));
        volumes.push((tolerance, 4.0 * PI / 3.0 - volume));
    }
    assert!(exponent(&areas) >= 0.9, "{areas:?}");
    assert!(exponent(&volumes) >= 0.9, "{volumes:?}");
}

/// At poles the normal is a limit: there and everywhere that of the ball.
#[test]
fn normals_of_the_ball_point_from_its_center() {
    let baked = bake(&format!("tolerance = 1e-3\n{BALL}"));
    let mesh = baked.glb.named("a");
    for (place, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let away = (0..3).map(|k| (place[k] - normal[k]).abs()).fold(0.0, f64::max);
        assert!(away < 1e-5, "{normal:?} at {place:?}");
    }
    let facts = &baked.only().facts;
    assert_eq!(facts.degenerate_triangles, 0, "{facts:?}");
}

#[test]
fn points_at_infinity_make_an_exact_half_circle() {
    let baked = bake(&format!("tolerance = 1e-4\n{HALF_PIPE}"));
    let facts = &baked.only().facts;
    assert_near(facts.area, 2.0 * PI, 1e-4);
    for place in &baked.glb.named("a").positions {
        let radius = (place[0] * place[0] + place[2] * place[2]).sqrt();
        assert!((radius - 1.0).abs() < 1e-6, "{place:?}");
    }
    assert_eq!((facts.boundary_loops, facts.components), (1, 1));
}

#[test]
fn closed_directions_leave_no_seam() {
    let baked = bake(&format!("tolerance = 1e-3\n{RING}"));
    let facts = &baked.only().facts;
    assert!(facts.closed && facts.manifold && facts.genus == Some(1), "{facts:?}");
    assert!(facts.volume.expect("closed") > 0.0, "inside out");
    let deviation = baked.only().deviation;
    assert!(deviation.measured.expect("asked for") <= deviation.bound && deviation.bound <= 1e-3);
}

/// The tea set: what is one skin is joined, what only touches is not, collapsed sides give no slivers.
#[test]
fn the_tea_set_has_no_cracks() {
    // Body, lid, spout and handle of the pot; cup and handle; the spoon: skins and borders of their tables, counted by
    // control points that sides have in common.
    for (text, components, loops) in [
        (include_str!("../../specs/patches/teapot.toml"), 4, 6),
        (include_str!("../../specs/patches/teacup.toml"), 2, 4),
        (include_str!("../../specs/patches/teaspoon.toml"), 1, 2),
    ] {
        let compiled = compile(text, &Options { measure: true, ..Options::default() });
        let report = compiled.unwrap_or_else(|found| panic!("{found}")).report.expect("a report");
        let (name, shape) = report.shapes.get_index(0).expect("a shape");
        let (facts, deviation) = (&shape.facts, shape.deviation);
        assert_eq!((facts.components, facts.boundary_loops), (components, loops), "{name}: {facts:?}");
        assert_eq!(
            (facts.degenerate_triangles, facts.crowded_edges, facts.misoriented_edges),
            (0, 0, 0),
            "{name}"
        );
        assert!(deviation.measured.expect("asked for") <= deviation.bound, "{name}: {deviation:?}");
        assert!(deviation.bound <= deviation.tolerance.expect("written"), "{name}: {deviation:?}");
    }
}

/// What a table lists as patches and what a grid says is one surface.
#[test]
fn lists_and_grids_agree() {
    let grid = bake(
        "tolerance = 1e-3\n[shape.a.patches]\ndegree = 2\ncontrol = [[[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, -1, 0], [4, 0, 0]], [[0, 1, 1], [1, 2, 1], [2, 1, 1], [3, 0, 1], [4, 1, 1]], [[0, 0, 2], [1, 1, 2], [2, 0, 2], [3, -1, 2], [4, 0, 2]]]",
    );
    let list = bake(
        "tolerance = 1e-3\n[shape.a.patches]\ndegree = 2\npoints = [[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, -1, 0], [4, 0, 0], [0, 1, 1], [1, 2, 1], [2, 1, 1], [3, 0, 1], [4, 1, 1], [0, 0, 2], [1, 1, 2], [2, 0, 2], [3, -1, 2], [4, 0, 2]]\npatches = [[0, 1, 2, 5, 6, 7, 10, 11, 12], [2, 3, 4, 7, 8, 9, 12, 13, 14]]",
    );
    let (one, other) = (&grid.only().facts, &list.only().facts);
    assert_near(one.area, other.area, 1e-3);
    assert_eq!((one.components, one.boundary_loops), (1, 1));
    assert_eq!((other.components, other.boundary_loops), (1, 1));
}
