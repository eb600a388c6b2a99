//! The language: from text to a typed, resolved [`Spec`], or every error found.

pub mod diagnostic;
mod document;
pub mod expression;
mod format;
pub mod source;
pub mod spec;
mod suggest;
pub mod value;

pub use diagnostic::explain;
pub use document::Document;
pub use format::format;
pub use spec::{Spec, reference, schema};
