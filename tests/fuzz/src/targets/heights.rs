//! Height maps from any samples, on any base, with any mask and closing.

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let (rows, columns) = (words.from_to(1, 8), words.from_to(1, 8));
    let tolerance = words.pick(&["0.001", "0.05", "0.5"]);
    let grid = |words: &mut Words<'_>| format!("{{ grid = {{ rows = {} }} }}", words.points(rows, columns));
    let mut text = format!("tolerance = {tolerance}\n[map.m]\n");
    words.perhaps(&mut text, 2, "interpolation", |_| "\"bicubic\"".to_owned());
    words.perhaps(&mut text, 4, "no-data", |words| format!("{:?}", words.number()));
    text +=
        &format!("[map.m.grid]\nrows = {}\n[shape.s.height-map]\nmap = \"m\"\n", words.points(rows, columns));
    match words.below(4) {
        0 => text += "on = { sphere = { radius = 20 } }\n",
        1 => text += "on = { cylinder = { radius = 20, height = 4, longitude = [0, 90] } }\n",
        _ => text += "size = [2, 3]\n",
    }
    words.perhaps(&mut text, 2, "range", |words| words.numbers(2));
    words.perhaps(&mut text, 2, "bound", |words| words.pick(&["\"samples\"", "\"dense\""]).to_owned());
    if words.once_in(2) {
        text += &format!("close = \"base\"\nbase = {:?}\n", words.number());
    } else if words.once_in(2) {
        text += &format!("close = \"thickness\"\ndepth = {:?}\n", words.size());
    }
    if words.once_in(2) {
        let level = words.number();
        text += &format!("[[shape.s.height-map.mask]]\nmap = {}\nat-least = {level:?}\n", grid(&mut words));
    }
    bake_made(&format!("{text}{LIMITS}"));
}
