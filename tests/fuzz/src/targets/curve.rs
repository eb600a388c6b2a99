//! Curves of all kinds from any control points, knots and weights, swept along and revolved.

use crate::common::{LIMITS, Words, bake_made};

const KINDS: [&str; 11] = [
    "natural-spline",
    "hermite",
    "catmull-rom",
    "cardinal",
    "kochanek-bartels",
    "bezier",
    "b-spline",
    "nurbs",
    "beta-spline",
    "subdivision",
    "polyline",
];

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let kind = words.pick(&KINDS);
    let use_of = words.below(3);
    let width = if use_of == 0 { 3 } else { 2 };
    let count = words.from_to(2, 9);
    let degree = words.from_to(1, 5);
    let mut text = format!("tolerance = 0.05\n[curve.c.{kind}]\npoints = {}\n", words.points(count, width));
    match kind {
        "hermite" => text += &format!("tangents = {}\n", words.points(count, width)),
        "bezier" => {
            text += &format!("degree = {degree}\n");
            words.perhaps(&mut text, 2, "weights", |words| words.numbers(count));
        }
        "b-spline" | "nurbs" => {
            text += &format!("degree = {degree}\n");
            words.perhaps(&mut text, 2, "knots", |words| words.knots(count + degree + 1));
            if kind == "nurbs" {
                text += &format!("weights = {}\n", words.numbers(count));
            }
        }
        "kochanek-bartels" => {
            for key in ["tension", "continuity", "bias"] {
                words.perhaps(&mut text, 2, key, |words| format!("{:?}", words.number()));
            }
        }
        "subdivision" => {
            text += &format!("scheme = \"{}\"\n", words.pick(&["chaikin", "four-point", "three-point"]))
        }
        "natural-spline" => words.perhaps(&mut text, 2, "parameters", |words| words.knots(count)),
        _ => {}
    }
    if kind != "bezier" {
        words.perhaps(&mut text, 3, "closed", |_| "true".to_owned());
    }
    text += match use_of {
        0 => "[shape.s.sweep]\npath = \"c\"\nprofile = { circle = { radius = 0.1 } }\n",
        1 => "[shape.s.revolve]\nprofile = \"c\"\n",
        _ => "[shape.s.extrude]\nprofile = \"c\"\nheight = 1\n",
    };
    bake_made(&format!("{text}{LIMITS}"));
}
