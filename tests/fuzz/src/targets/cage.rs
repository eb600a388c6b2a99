//! Subdivision of any cage, with any creases.

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let scheme =
        words.pick(&["catmull-clark", "loop", "sqrt3", "doo-sabin", "mid-edge", "butterfly", "bilinear"]);
    let count = words.from_to(3, 12);
    let points = words.points(count, 3);
    let faces: Vec<Vec<usize>> = (0..words.from_to(1, 14))
        .map(|_| (0..words.from_to(3, 5)).map(|_| words.below(count)).collect())
        .collect();
    let mut text = format!("tolerance = 0.1\n[shape.s.subdivide]\nscheme = \"{scheme}\"\n");
    text += &format!("cage = {{ mesh = {{ points = {points}, faces = {faces:?} }} }}\n");
    words.perhaps(&mut text, 2, "levels", |words| words.from_to(1, 3).to_string());
    words.perhaps(&mut text, 3, "limit", |_| "false".to_owned());
    words.perhaps(&mut text, 3, "triangulate", |_| "true".to_owned());
    words.perhaps(&mut text, 3, "border", |_| "\"corners\"".to_owned());
    if words.once_in(2) {
        let edge = [words.below(count), words.below(count)];
        text += &format!("creases = [{{ edges = [{edge:?}], sharpness = {:?} }}]\n", words.size());
    }
    bake_made(&format!("{text}{LIMITS}"));
}
