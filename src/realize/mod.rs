//! The realize stage.
