//! Links the C++ runtime into the command, where the compiler has it as an archive: loading the shared one takes
//! as long as baking a small model. `meshopt` needs three symbols of it. Elsewhere the shared one serves.

use std::env::var;
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CXX");
    if let Some(folder) = archives() {
        println!("cargo:rustc-link-arg-bins=-L{}", folder.display());
    }
}

/// A folder where the linker finds archives under the names of the shared libraries.
fn archives() -> Option<PathBuf> {
    let is = |name: &str, value: &str| var(name).is_ok_and(|found| found == value);
    let native = var("HOST").ok()? == var("TARGET").ok()?;
    let gnu = is("CARGO_CFG_TARGET_OS", "linux") && is("CARGO_CFG_TARGET_ENV", "gnu");
    if !native || !gnu || var("CARGO_FEATURE_CLI").is_err() {
        return None;
    }
    let folder = Path::new(&var("OUT_DIR").ok()?).join("archives");
    std::fs::create_dir_all(&folder).ok()?;
    for (archive, shared) in [("libstdc++.a", "libstdc++.a"), ("libgcc_eh.a", "libgcc_s.a")] {
        std::fs::copy(found(archive)?, folder.join(shared)).ok()?;
    }
    Some(folder)
}

/// Where the C++ compiler has an archive.
fn found(archive: &str) -> Option<PathBuf> {
    let compiler = var("CXX").unwrap_or_else(|_| "c++".to_owned());
    let answer = Command::new(compiler).arg(format!("-print-file-name={archive}")).output().ok()?;
    let path = PathBuf::from(String::from_utf8(answer.stdout).ok()?.trim());
    path.is_absolute().then_some(path)
}
