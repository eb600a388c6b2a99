//! The scene stage.
