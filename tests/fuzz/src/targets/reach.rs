//! Inverse kinematics of any chain, with any limits, toward any targets.

use std::fmt::Write as _;

use crate::common::{LIMITS, Words, bake_made};

pub(super) fn run(bytes: &[u8]) {
    let mut words = Words::new(bytes);
    let count = words.from_to(1, 6);
    let mut text = "[shape.b.box]\nsize = [1, 1, 1]\n".to_owned();
    let mut head = [0.0; 3];
    for k in 0..count {
        let _ = writeln!(text, "[skeleton.s.joint.j{k}]\nhead = {head:?}");
        let step = [words.number(), words.size(), words.number()];
        for (axis, step) in head.iter_mut().zip(step) {
            *axis += step;
        }
        let _ = writeln!(text, "tail = {head:?}");
        if k > 0 {
            let _ = writeln!(text, "parent = \"j{}\"", k - 1);
        }
        if words.once_in(2) {
            let (low, high) = (words.number(), words.number());
            let axis = words.pick(&["x", "y", "z"]);
            let _ = writeln!(text, "limits = {{ {axis} = [{:?}, {:?}] }}", low.min(high), low.max(high));
        }
    }
    let _ = writeln!(text, "[clip.c]\nduration = 0.25\n[[clip.c.reach]]\njoint = \"j{}\"", count - 1);
    if words.once_in(2) {
        let _ = writeln!(text, "target = {}", words.numbers(3));
    } else {
        let _ = writeln!(
            text,
            "keys = [{{ at = 0, value = {} }}, {{ at = 0.25, value = {} }}]",
            words.numbers(3),
            words.numbers(3)
        );
    }
    words.perhaps(&mut text, 3, "pole", |words| words.numbers(3));
    bake_made(&format!("{text}{LIMITS}"));
}
