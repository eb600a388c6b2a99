//! Any text as a document. Seeds: the gallery.

use crate::common::{LIMITS, bake};

pub(super) fn run(bytes: &[u8]) {
    if let Ok(text) = std::str::from_utf8(bytes) {
        bake(&format!("{text}\n{LIMITS}"), &[]);
    }
}
