//! What is wrong with an expression, at a place of its text.

use std::ops::Range;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;

/// An error in an expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What kind of error.
    pub code: Code,
    /// What is wrong.
    pub message: String,
    /// Where, in bytes of the expression's text.
    pub range: Range<usize>,
    /// Text beside the underline.
    pub label: String,
    /// What to do.
    pub help: Option<String>,
    /// What to write in place of the range.
    pub replacement: Option<String>,
    /// Whether it only follows from something that was reported before.
    pub reported: bool,
}

impl Fault {
    pub(crate) fn new(code: Code, range: Range<usize>, message: impl Into<String>) -> Self {
        let (label, help, replacement, reported) = (String::new(), None, None, false);
        Self { code, message: message.into(), range, label, help, replacement, reported }
    }

    /// A fault that needs no words: its cause was reported.
    pub(crate) fn reported(range: Range<usize>) -> Self {
        Self { reported: true, ..Self::new(Code::ExpressionValue, range, "a name in it has no value") }
    }

    pub(crate) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    pub(crate) fn replace(mut self, replacement: impl Into<String>) -> Self {
        self.replacement = Some(replacement.into());
        self
    }

    /// As a diagnostic. `place` finds the span of a range, or of the whole string where escapes hide it;
    /// in the latter case nothing can be replaced.
    pub(crate) fn diagnostic(self, place: impl Fn(Range<usize>) -> (Span, bool)) -> Diagnostic {
        let (span, exact) = place(self.range);
        let mut diagnostic = Diagnostic::error(self.code, self.message).at(span, self.label);
        if let Some(help) = self.help {
            diagnostic = diagnostic.help(help);
        }
        match self.replacement {
            Some(replacement) if exact => {
                let sign = matches!(replacement.trim(), "+" | "-");
                let text = if sign { "add the space".to_owned() } else { format!("write `{replacement}`") };
                diagnostic.suggest(span, replacement, text)
            }
            _ => diagnostic,
        }
    }
}
