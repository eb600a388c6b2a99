//! From text to a typed document, or to messages.

pub(crate) mod cases;
mod codes;
mod files;
mod format;
mod robust;
mod schema;
mod shown;
mod toml_corpus;
mod values;
