//! `kiln check`: everything that is wrong with documents, nothing written.

use serde_json::json;

use super::Outcome;
use super::arguments::Check;
use super::output::Printer;
use super::project::{Work, each, loaded, tasks};
use super::turns::Message;
use crate::compile::{Options, compile};
use crate::project::{Task, Told};

/// Checks all documents, to the end of the pipeline: what passes here can be baked.
pub(crate) fn run(check: &Check, printer: &Printer) -> Outcome {
    let Some(tasks) = tasks(&check.documents, printer) else { return Outcome::Files };
    let work = Work { documents: &check.documents, records: &check.records, printer };
    each(&work, &tasks, &|_, task, messages| document(check, task, messages))
}

fn document(check: &Check, task: &Task, messages: &mut Vec<Message>) -> Outcome {
    let (files, document) = match loaded(task, messages) {
        Ok(loaded) => loaded,
        Err(outcome) => return outcome,
    };
    if task.found && document.is_library() {
        return Outcome::Good;
    }
    let mut outcome = Outcome::Good;
    let mut told = Told::default();
    for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
        let options = Options {
            variant,
            overrides: check.documents.set.clone(),
            name: task.name().to_owned(),
            path: task.path.clone(),
            ..Options::default()
        };
        let list = match compile(&document, &files, &options) {
            Ok(compiled) => compiled.warnings,
            Err(list) => {
                outcome = Outcome::Errors;
                list
            }
        };
        messages.push(Message::Diagnostics(told.only_new(&document, list, options.variant.as_deref())));
    }
    if outcome == Outcome::Good {
        let object = json!({ "spec": task.path, "good": true });
        messages.push(Message::Result(format!("{}  good", task.path), object));
    }
    outcome
}
