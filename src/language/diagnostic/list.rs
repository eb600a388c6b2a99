//! All that is wrong with a document, and the texts that it points into.

use std::sync::Arc;

use crate::language::diagnostic::{Diagnostic, Severity, json, order, render};
use crate::language::source::SourceMap;

/// Errors and warnings, sorted by place, each once, with the texts that they point into.
#[derive(Clone, Debug)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    sources: Arc<SourceMap>,
}

impl Diagnostics {
    /// Sorts by file and place, and drops repetitions.
    #[must_use]
    pub fn new(mut list: Vec<Diagnostic>, sources: Arc<SourceMap>) -> Self {
        list.sort_by(|a, b| order(a).cmp(&order(b)));
        list.dedup();
        Self { list, sources }
    }

    /// Whether any of them is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// All of them, in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them as a list.
    #[must_use]
    pub fn into_vec(self) -> Vec<Diagnostic> {
        self.list
    }

    /// The texts that they point into.
    #[must_use]
    pub fn sources(&self) -> &Arc<SourceMap> {
        &self.sources
    }

    /// For people: each with its lines, carets and hints; ends with a line end. With `color`, ANSI escapes.
    ///
    /// What a document writes is shown with its control characters neutralized. Of very many, the first
    /// hundred are shown and the rest counted.
    #[must_use]
    pub fn render(&self, color: bool) -> String {
        render::all(&self.list, &self.sources, color)
    }

    /// For programs: an array with severity, code, message, file, line, column, the labels and the hints.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        self.list.iter().map(|one| json::one(one, &self.sources)).collect()
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

impl std::fmt::Display for Diagnostics {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostics {}
