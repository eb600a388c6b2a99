//! The pipeline, one line a stage.
pub fn compile() {}
