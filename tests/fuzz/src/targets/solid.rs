//! Solids of any primitives in any places: much of what they do coincides.

use std::fmt::Write as _;

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let count = words.from_to(2, 4);
    let mut text = "tolerance = 0.2\n".to_owned();
    for k in 0..count {
        let _ = writeln!(text, "[shape.s{k}]\nat = {}", words.numbers(3));
        words.perhaps(&mut text, 3, "rotate", |words| words.numbers(3));
        let [a, b, c] = [words.size(), words.size(), words.size()];
        let _ = match words.below(5) {
            0 => writeln!(text, "[shape.s{k}.sphere]\nradius = {a:?}"),
            1 => writeln!(text, "[shape.s{k}.cylinder]\nradius = {a:?}\nheight = {b:?}"),
            2 => writeln!(text, "[shape.s{k}.cone]\nradius = {a:?}\nheight = {b:?}"),
            3 => writeln!(text, "[shape.s{k}.torus]\nradius = {a:?}\ntube-radius = {b:?}"),
            _ => writeln!(text, "[shape.s{k}.box]\nsize = [{a:?}, {b:?}, {c:?}]"),
        };
    }
    let of: Vec<String> = (0..count).map(|k| format!("\"s{k}\"")).collect();
    let of = of.join(", ");
    match words.below(7) {
        0 => text += &format!("[shape.whole.union]\nof = [{of}]\n"),
        1 => text += &format!("[shape.whole.difference]\nof = [{of}]\n"),
        2 => text += &format!("[shape.whole.intersection]\nof = [{of}]\n"),
        3 => text += &format!("[shape.whole.hull]\nof = [{of}]\n"),
        4 => {
            text += &format!(
                "[shape.whole.cut]\nof = \"s0\"\nplane = {{ normal = {}, point = {} }}\n",
                words.numbers(3),
                words.numbers(3)
            )
        }
        5 => text += &format!("[shape.whole.shell]\nof = \"s0\"\nthickness = {:?}\n", words.size()),
        _ => text += &format!("[shape.whole.minkowski-round]\nof = \"s0\"\nradius = {:?}\n", words.number()),
    }
    bake_made(&format!("{text}{LIMITS}"));
}
