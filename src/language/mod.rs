//! The language stage.
