//! `kiln check`: everything that is wrong with documents, nothing written.

use serde_json::json;

use super::Outcome;
use super::arguments::Check;
use super::output::Printer;
use super::project::tasks;
use crate::compile::{Options, compile};
use crate::project::{Told, reason};

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
        let mut told = Told::default();
        for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
            let options = Options {
                variant,
                overrides: check.documents.set.clone(),
                name: task.name().to_owned(),
                path: task.path.clone(),
                ..Options::default()
            };
            match compile(&document, &files, &options) {
                Ok(compiled) => {
                    let list = told.only_new(&document, compiled.warnings, options.variant.as_deref());
                    printer.diagnostics(&list);
                }
                Err(list) => {
                    printer.diagnostics(&told.only_new(&document, list, options.variant.as_deref()));
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
