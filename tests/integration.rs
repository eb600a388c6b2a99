//! The integration tests: one binary, a module for each theme.

mod architecture;
mod bake;
mod build_script;
mod counts;
mod curves;
mod import;
mod import_gltf;
mod language;
mod laws;
mod preview;
mod repack;
mod surfaces;
