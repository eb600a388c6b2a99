//! From text to a typed document, or to messages.

mod cases;
mod codes;
mod schema;
mod toml_corpus;
