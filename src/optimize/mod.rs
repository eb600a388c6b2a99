//! The optimize stage.
