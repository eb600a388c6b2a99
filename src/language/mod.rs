//! The language: from text to a typed, resolved [`Spec`], or every error found.

pub mod diagnostic;
mod document;
pub mod expression;
mod format;
mod project;
pub mod source;
pub mod spec;
mod suggest;
pub mod value;

pub use diagnostic::{errors, explain};
pub use document::Document;
pub use format::format;
pub(crate) use project::{PROJECT_FILE, ProjectFile};
pub use spec::{Spec, project_schema, reference, schema};
