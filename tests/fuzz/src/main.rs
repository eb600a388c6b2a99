//! All fuzz targets in one program: the variable `KILN_FUZZ` names the one that runs. `scripts/fuzz` builds and runs them.

#![no_main]

mod common;
mod targets;

use std::sync::OnceLock;

use libfuzzer_sys::fuzz_target;

static TARGET: OnceLock<fn(&[u8])> = OnceLock::new();

fn chosen() -> fn(&[u8]) {
    let name = std::env::var("KILN_FUZZ").expect("KILN_FUZZ names a target");
    targets::named(&name).unwrap_or_else(|| panic!("there is no target `{name}`"))
}

fuzz_target!(|bytes: &[u8]| TARGET.get_or_init(chosen)(bytes));
