//! Geometry: numbers, formulas, fields, curves, surfaces, meshes, and the step from continuous to discrete.
//!
//! Kernels here compute in `f64`, know nothing of the language, of files or of the number of threads, and
//! give the same bits on every machine.

pub mod curve;
pub mod field;
pub mod formula;
pub mod map;
pub mod mesh;
pub mod number;
pub mod planar;
pub mod profile;
pub mod solid;
pub mod subdivide;
pub mod surface;
pub mod tessellate;
