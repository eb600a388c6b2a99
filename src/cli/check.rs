//! `kiln check`: everything that is wrong with documents, nothing written.

use serde_json::json;

use super::Outcome;
use super::arguments::Check;
use super::output::Printer;
use super::project::{Work, each, loaded, named, profiles};
use super::turns::Message;
use crate::compile::{Options, compile};
use crate::gltf::Profile;
use crate::project::{Task, Told};

/// Checks all documents, to the end of the pipeline: what passes here can be baked.
pub(crate) fn run(check: &mut Check, printer: &Printer) -> Outcome {
    let (project, tasks) = match named(&mut check.documents, None, printer) {
        Ok(named) => named,
        Err(outcome) => return outcome,
    };
    let profiles = profiles(&[], project.as_ref());
    let work = Work { documents: &check.documents, records: &check.records, printer, budget: None };
    each(&work, &tasks, &|_, task, messages| document((check, &profiles), task, messages))
}

fn document((check, profiles): (&Check, &[Profile]), task: &Task, messages: &mut Vec<Message>) -> Outcome {
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
            overrides: check.documents.overrides(&document),
            name: task.name().to_owned(),
            path: task.path.clone(),
            profiles: profiles.to_vec(),
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
