//! Surfaces from any control nets, knots and weights.

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let kind = words.pick(&["b-spline", "nurbs", "hermite", "patches", "quadric"]);
    let (rows, columns) = (words.from_to(2, 5), words.from_to(2, 5));
    let degrees = [words.from_to(1, 3), words.from_to(1, 3)];
    let mut text = format!("tolerance = 0.1\n[shape.s.{kind}]\n");
    match kind {
        "b-spline" | "nurbs" => {
            text += &format!("control = {}\ndegree = {degrees:?}\n", words.grid(rows, columns, 3));
            if kind == "nurbs" {
                text += &format!("weights = {}\n", words.points(rows, columns));
            }
            words.perhaps(&mut text, 2, "knots-u", |words| words.knots(columns + degrees[0] + 1));
            words.perhaps(&mut text, 2, "knots-v", |words| words.knots(rows + degrees[1] + 1));
            words.perhaps(&mut text, 4, "closed", |words| {
                words.pick(&["[\"u\"]", "[\"v\"]", "[\"u\", \"v\"]"]).to_owned()
            });
        }
        "hermite" => {
            text += &format!("points = {}\n", words.grid(rows, columns, 3));
            text += &format!("along-u = {}\n", words.grid(rows, columns, 3));
            text += &format!("along-v = {}\n", words.grid(rows, columns, 3));
            words.perhaps(&mut text, 2, "twists", |words| words.grid(rows, columns, 3));
        }
        "patches" => text += &format!("control = {}\n", words.grid(4, 4, 3)),
        _ => {
            for key in ["xx", "yy", "zz", "xy", "yz", "zx", "x", "y", "z", "constant"] {
                words.perhaps(&mut text, 2, key, |words| format!("{:?}", words.number()));
            }
            text += "within = { radius = 3 }\n";
        }
    }
    bake_made(&format!("{text}{LIMITS}"));
}
