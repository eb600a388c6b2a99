//! Implicit surfaces of any skeletons.

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let mut elements = Vec::new();
    for _ in 0..words.from_to(1, 5) {
        let shape = match words.below(3) {
            0 => format!("point = {}", words.numbers(3)),
            1 => format!("segment = {}", words.points(2, 3)),
            _ => format!("polygon = {}", words.points(3, 3)),
        };
        let strength = if words.once_in(2) { words.number() } else { 1.0 };
        elements.push(format!("{{ {shape}, radius = {:?}, strength = {strength:?} }}", words.size()));
    }
    let mut text = format!("tolerance = 0.2\n[field.f.skeleton]\nelements = [{}]\n", elements.join(", "));
    words.perhaps(&mut text, 2, "level", |words| format!("{:?}", words.size()));
    text += "[shape.s.implicit]\nfield = \"f\"\n";
    words.perhaps(&mut text, 2, "level", |words| format!("{:?}", words.number()));
    bake_made(&format!("{text}{LIMITS}"));
}
