//! What is wrong with a document, as data: place, message, hint. Rendering is apart.

mod code;
mod explain;
mod index;
mod json;
mod list;
mod render;

pub use code::Code;
pub use explain::{Example, example, explain};
pub use index::errors;
pub use list::Diagnostics;

use serde::{Deserialize, Serialize};

use crate::language::source::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Severity {
    /// The document cannot be baked.
    Error,
    /// It can be baked, but hardly as it was meant.
    Warning,
}

/// A place and what is to be said of it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// Short text beside the underline; may be empty.
    pub text: String,
    /// Whether it is the place of the error, rather than one that explains it.
    pub primary: bool,
}

/// A change of the text that would mend it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Suggestion {
    /// What to replace; empty to insert.
    pub span: Span,
    /// What to write there.
    pub replacement: String,
    /// What it does, as a sentence without a full stop.
    pub text: String,
}

/// One error or warning.
///
/// The message is lower case without a full stop and names the value; the help says what to write instead.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// Stable code, for `kiln explain`.
    pub code: Code,
    /// What is wrong, with the value.
    pub message: String,
    /// Where; the first primary label is the place of the diagnostic.
    pub labels: Vec<Label>,
    /// Facts that explain it.
    pub notes: Vec<String>,
    /// What to do.
    pub help: Vec<String>,
    /// A change that would mend it.
    pub suggestion: Option<Suggestion>,
}

impl Diagnostic {
    /// An error that has no place yet.
    #[must_use]
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message.into())
    }

    /// A warning that has no place yet.
    #[must_use]
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message.into())
    }

    fn new(severity: Severity, code: Code, message: String) -> Self {
        let (labels, notes, help) = (Vec::new(), Vec::new(), Vec::new());
        Self { severity, code, message, labels, notes, help, suggestion: None }
    }

    /// Adds the place of the error, with a short text that may be empty.
    #[must_use]
    pub fn at(self, span: Span, text: impl Into<String>) -> Self {
        self.label(Label { span, text: text.into(), primary: true })
    }

    /// Adds a place that explains the error.
    #[must_use]
    pub fn also(self, span: Span, text: impl Into<String>) -> Self {
        self.label(Label { span, text: text.into(), primary: false })
    }

    fn label(mut self, label: Label) -> Self {
        if !label.span.is_none() {
            self.labels.push(label);
        }
        self
    }

    /// Adds a fact that explains it.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    /// Adds what to do.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
        self
    }

    /// Adds a change of the text that would mend it.
    #[must_use]
    pub fn suggest(mut self, span: Span, replacement: impl Into<String>, text: impl Into<String>) -> Self {
        if !span.is_none() {
            self.suggestion = Some(Suggestion { span, replacement: replacement.into(), text: text.into() });
        }
        self
    }

    /// The place of the error: its first primary label, else any label.
    #[must_use]
    pub fn place(&self) -> Option<Span> {
        let primary = self.labels.iter().find(|label| label.primary);
        primary.or(self.labels.first()).map(|label| label.span)
    }
}

fn order(one: &Diagnostic) -> (Span, Severity, Code, &str, &[Label]) {
    (one.place().unwrap_or(Span::NONE), one.severity, one.code, &one.message, &one.labels)
}
