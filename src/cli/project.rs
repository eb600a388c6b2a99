//! Which documents the arguments name, and work on each of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::Outcome;
use super::arguments::{Documents, RecordOptions};
use super::output::Printer;
use super::records::Records;
use super::turns::{Message, Turns};
use crate::language::Document;
use crate::language::source::DiskFiles;
use crate::project::{Task, collect, reason};

/// The documents that the arguments name, of which one shard; `None` after a complaint.
pub(crate) fn tasks(documents: &Documents, printer: &Printer) -> Option<Vec<Task>> {
    let mut tasks = tasks_at(&documents.paths, documents.root.as_deref(), printer)?;
    if let Some(shard) = documents.shard {
        let mut turn = 0;
        tasks.retain(|_| {
            turn += 1;
            (turn - 1) % shard.of == shard.number - 1
        });
    }
    Some(tasks)
}

/// The documents at some paths; `None` after a complaint.
pub(crate) fn tasks_at(paths: &[PathBuf], root: Option<&Path>, printer: &Printer) -> Option<Vec<Task>> {
    let mut tasks = Vec::new();
    let mut good = true;
    for path in paths {
        match collect(path, root) {
            Ok(found) if found.is_empty() => {
                printer.failure(&format!("no document (.toml) in {}", path.display()), None);
                good = false;
            }
            Ok(found) => tasks.extend(found),
            Err(message) => {
                printer.failure(&message, None);
                good = false;
            }
        }
    }
    // A document that is named twice is meant once.
    let mut seen = std::collections::BTreeSet::new();
    tasks.retain(|task| seen.insert((task.root.clone(), task.path.clone())));
    good.then_some(tasks)
}

/// A single document.
pub(crate) fn task(path: &Path, root: Option<&Path>) -> Result<Task, String> {
    let mut tasks = collect(path, root)?;
    if tasks.len() == 1 && path.is_file() {
        return Ok(tasks.remove(0));
    }
    Err(format!("{} is not a document", path.display()))
}

/// A document with the files that it is read from; what is wrong with it is said.
pub(crate) fn loaded(task: &Task, messages: &mut Vec<Message>) -> Result<(DiskFiles, Document), Outcome> {
    let (files, document) = task.load().map_err(|error| {
        messages.push(Message::Failure(format!("{}: {}", task.path, reason(&error))));
        Outcome::Files
    })?;
    let document = document.map_err(|list| {
        messages.push(Message::Diagnostics(list));
        Outcome::Errors
    })?;
    Ok((files, document))
}

/// How documents are worked on.
pub(crate) struct Work<'a> {
    pub(crate) documents: &'a Documents,
    pub(crate) records: &'a RecordOptions,
    pub(crate) printer: &'a Printer,
}

/// What is done with a document: its turn, itself, and what is said of it.
type Job<'a> = &'a (dyn Fn(usize, &Task, &mut Vec<Message>) -> Outcome + Sync);

/// Works on all documents, several at once; one that fails does not stop the others. The worst outcome.
pub(crate) fn each(work: &Work<'_>, tasks: &[Task], job: Job<'_>) -> Outcome {
    let progress = progress(tasks.len(), work.printer);
    let turns = Turns::new(work.printer, &progress);
    let records = Records::default();
    let one = |(turn, task): (usize, &Task)| {
        progress.set_message(task.path.clone());
        let mut messages = Vec::new();
        let outcome =
            catch_unwind(AssertUnwindSafe(|| job(turn, task, &mut messages))).unwrap_or_else(|_| {
                let text = format!("{}: Kiln failed inside; please report this document as a bug", task.path);
                messages.push(Message::Failure(text));
                Outcome::Errors
            });
        records.add(turn, &task.path, outcome, &messages);
        turns.speak(turn, messages);
        progress.inc(1);
        outcome
    };
    let outcome = if let [task] = tasks {
        // Waking a second thread costs more than a small document takes.
        one((0, task))
    } else {
        let numbered: Vec<(usize, &Task)> = tasks.iter().enumerate().collect();
        let all = || numbered.par_iter().map(|numbered| one(*numbered)).max().unwrap_or(Outcome::Good);
        let threads = work.documents.jobs.map_or(0, usize::from);
        match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => pool.install(all),
            Err(_) => numbered.iter().map(|numbered| one(*numbered)).max().unwrap_or(Outcome::Good),
        }
    };
    progress.finish_and_clear();
    outcome.max(records.write(work.records, work.printer))
}

fn progress(count: usize, printer: &Printer) -> ProgressBar {
    if count < 2 || !printer.draws_progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr_with_hz(10));
    if let Ok(style) = ProgressStyle::with_template("{bar:32} {pos}/{len} {wide_msg}") {
        bar.set_style(style);
    }
    bar
}
