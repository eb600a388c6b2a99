//! From text to a typed document, or to messages.

mod toml_corpus;
