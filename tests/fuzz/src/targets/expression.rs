//! Any text as an expression, as a formula of a surface and of a field.

use crate::common::{LIMITS, bake};

pub(super) fn run(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if text.contains(['\n', '\r']) {
        return;
    }
    let text = text.replace('\\', "\\\\").replace('"', "\\\"");
    bake(
        &format!(
            "tolerance = 0.2\n[parameters]\na = 2\nb = \"= {text}\"\n[shape.s.box]\nsize = [1, \"= abs(b) + 1\", 1]\n{LIMITS}"
        ),
        &[],
    );
    bake(
        &format!(
            "tolerance = 0.2\n[shape.s.parametric]\nu = [0, 2]\nv = [0, 1]\nx = \"= u\"\ny = \"= {text}\"\nz = \"= v\"\n{LIMITS}"
        ),
        &[],
    );
    bake(
        &format!(
            "tolerance = 0.2\n[field.f.formula]\nf = \"= {text}\"\n[shape.s.implicit]\nfield = \"f\"\nwithin = {{ min = [-1, -1, -1], max = [1, 1, 1] }}\nsearch = 0.25\n{LIMITS}"
        ),
        &[],
    );
}
