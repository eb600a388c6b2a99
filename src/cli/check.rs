//! `kiln check`: everything that is wrong with documents, nothing written.

use serde_json::json;

use super::Outcome;
use super::arguments::Check;
use super::output::Printer;
use super::project::{reason, tasks};
use crate::compile::{Options, compile};

/// Checks all documents, to the end of the pipeline: what passes here can be baked.
pub(crate) fn run(check: &Check, printer: &Printer) -> Outcome {
    let Some(tasks) = tasks(&check.documents, printer) else { return Outcome::Files };
    let mut outcome = Outcome::Good;
    for task in &tasks {
        let (files, document) = match task.load() {
            Ok(loaded) => loaded,
            Err(error) => {
                printer.failure(&format!("{}: {}", task.path, reason(&error)), None);
                outcome = outcome.max(Outcome::Files);
                continue;
            }
        };
        let document = match document {
            Ok(document) => document,
            Err(list) => {
                printer.diagnostics(&list);
                outcome = outcome.max(Outcome::Errors);
                continue;
            }
        };
        if task.found && document.is_library() {
            continue;
        }
        let mut good = true;
        for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
            let options = Options {
                variant,
                overrides: check.documents.set.clone(),
                name: task.name().to_owned(),
                path: task.path.clone(),
                ..Options::default()
            };
            match compile(&document, &files, &options) {
                Ok(compiled) => printer.diagnostics(&compiled.warnings),
                Err(list) => {
                    printer.diagnostics(&list);
                    good = false;
                }
            }
        }
        if good {
            printer.result(&format!("{}  good", task.path), &json!({ "spec": task.path, "good": true }));
        } else {
            outcome = outcome.max(Outcome::Errors);
        }
    }
    outcome
}
