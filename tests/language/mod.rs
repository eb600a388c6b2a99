//! From text to a typed document, or to messages.

mod cases;
mod toml_corpus;
