//! What came of baking a document.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::language::diagnostic::Diagnostic;

/// What came of a document.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Record {
    /// One for each variant and profile.
    pub assets: Vec<Baked>,
    /// The names of its parameters, those of its variants too.
    pub parameters: Vec<String>,
}

/// An asset that was baked.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Baked {
    /// Its name among the outputs of the document.
    pub file: String,
    /// What is told of it, for people and for programs.
    pub line: String,
    /// The same for programs.
    pub facts: Value,
    /// Its files.
    pub files: Vec<OutputFile>,
    /// What a person should know. Places count the bytes of the document's texts, which are the same where this is found.
    pub warnings: Vec<Diagnostic>,
}

/// A file that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputFile {
    /// Its name.
    pub name: String,
    /// The BLAKE3 hash of its bytes, hexadecimal.
    pub hash: String,
}

impl OutputFile {
    /// A file of these bytes.
    #[must_use]
    pub fn of(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.to_owned(), hash: blake3::hash(bytes).to_hex().to_string() }
    }
}
