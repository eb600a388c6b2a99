//! Kiln bakes declarative model specs (TOML text) into optimized, indexed glTF.
//!
//! # The pipeline
//! [`compile()`] is the map: text becomes a `Spec`, the `Spec` an exact `Model`, the `Model` a discrete
//! `Scene` at a tolerance, the `Scene` checked bytes, and the bytes a report that is measured on them.
//!
//! # Import table
//! A module may use only the modules named in its row (`tests/architecture.rs` enforces the table).
//!
//! | module | may use |
//! | --- | --- |
//! | `geometry::number` | |
//! | `geometry::planar` | `geometry::number` |
//! | `geometry::formula` | `geometry::number` |
//! | `geometry::curve` | `geometry::number`, `geometry::formula` |
//! | `geometry::mesh` | `geometry::number`, `geometry::planar` |
//! | `geometry::solid` | `geometry::number`, `geometry::mesh` |
//! | `geometry::subdivide` | `geometry::number`, `geometry::mesh` |
//! | `geometry::surface` | `geometry::number`, `geometry::formula`, `geometry::curve` |
//! | `geometry::field` | `geometry::number`, `geometry::formula`, `geometry::curve`, `geometry::mesh` |
//! | `geometry::map` | `geometry::number` |
//! | `geometry::tessellate` | `geometry::number`, `geometry::formula`, `geometry::planar`, `geometry::curve`, `geometry::mesh`, `geometry::surface`, `geometry::field`, `geometry::map` |
//! | `geometry::profile` | `geometry::number`, `geometry::planar`, `geometry::curve`, `geometry::tessellate` |
//! | `motion` | `geometry::number`, `geometry::formula`, `geometry::curve`, `geometry::mesh`, `geometry::surface` |
//! | `packing` | |
//! | `import` | `geometry::number`, `geometry::mesh`, `packing` |
//! | `model` | `geometry`, `motion` |
//! | `scene` | `geometry::number`, `geometry::mesh`, `geometry::tessellate`, `motion`, `model` |
//! | `realize` | `geometry`, `motion`, `model`, `scene` |
//! | `optimize` | `geometry::number`, `geometry::mesh`, `geometry::tessellate`, `motion`, `packing`, `scene` |
//! | `gltf` | `geometry::number`, `geometry::mesh`, `geometry::tessellate`, `motion`, `packing`, `scene` |
//! | `repack` | `geometry::number`, `geometry::mesh`, `packing`, `import`, `optimize`, `gltf` |
//! | `report` | `geometry`, `motion`, `model`, `packing`, `scene`, `realize`, `gltf` |
//! | `preview` | `geometry::number`, `geometry::formula`, `geometry::mesh`, `geometry::field`, `packing`, `import` |
//! | `language` | `geometry::number` |
//! | `build` | `geometry`, `motion`, `import`, `language`, `model` |
//! | `compile` | everything but `cli` |
//! | `project` | `language` |
//! | `cache` | `language`, `project` |
//! | `build_script` | everything but `cli` |
//! | `cli` | everything |
//!
//! Rows stand in the order of the direction: a row names only rows above it. `scene` uses of `model` the
//! materials, which are the same in both, and of `geometry::tessellate` the deviation, as `optimize` does; `optimize` and `gltf`
//! see neither `model` nor `realize`.

pub mod build;
pub mod build_script;
pub mod cache;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compile;
pub mod geometry;
pub mod gltf;
pub mod import;
pub mod language;
pub mod model;
pub mod motion;
pub mod optimize;
pub mod packing;
pub mod preview;
mod project;
pub mod realize;
pub mod repack;
pub mod report;
pub mod scene;

pub use build_script::Build;
pub use compile::compile;
pub use gltf::Profile;

/// The lines of the README that a build script takes are compiled with the documentation's tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
