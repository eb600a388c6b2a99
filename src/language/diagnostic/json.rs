//! Diagnostics for programs.

use serde_json::{Value as Json, json};

use crate::language::diagnostic::{Diagnostic, Severity};
use crate::language::source::{SourceMap, Span};

/// One diagnostic as an object. `file`, `line`, `column`, `end_line` and `end_column` (one past the last
/// character) are null where it has no place; lines and columns count from 1, columns in characters.
pub(crate) fn one(diagnostic: &Diagnostic, sources: &SourceMap) -> Json {
    let mut object = place(diagnostic.place(), sources);
    object["severity"] = json!(match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    });
    object["code"] = json!(diagnostic.code.text());
    object["message"] = json!(diagnostic.message);
    object["labels"] =
        diagnostic.labels.iter().map(|one| label(one.span, &one.text, one.primary, sources)).collect();
    object["notes"] = json!(diagnostic.notes);
    object["help"] = json!(diagnostic.help);
    object["suggestion"] = diagnostic.suggestion.as_ref().map_or(Json::Null, |suggestion| {
        let mut object = place(Some(suggestion.span), sources);
        object["replacement"] = json!(suggestion.replacement);
        object["text"] = json!(suggestion.text);
        object
    });
    object
}

fn label(span: Span, text: &str, primary: bool, sources: &SourceMap) -> Json {
    let mut object = place(Some(span), sources);
    object["text"] = json!(text);
    object["primary"] = json!(primary);
    object
}

fn place(span: Option<Span>, sources: &SourceMap) -> Json {
    let start = span.and_then(|span| sources.locate(span));
    let end = span.and_then(|span| sources.locate(Span::new(span.end, span.end)));
    json!({
        "file": start.as_ref().map(|start| start.file),
        "line": start.as_ref().map(|start| start.line),
        "column": start.as_ref().map(|start| start.column),
        "end_line": end.as_ref().map(|end| end.line),
        "end_column": end.as_ref().map(|end| end.column),
    })
}
