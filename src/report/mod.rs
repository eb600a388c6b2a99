//! The report stage.

pub mod facts;
