//! Which documents the arguments name.

use std::path::{Path, PathBuf};

use super::arguments::Documents;
use super::output::Printer;
use crate::project::{Task, collect};

/// The documents that the arguments name; `None` after a complaint.
pub(crate) fn tasks(documents: &Documents, printer: &Printer) -> Option<Vec<Task>> {
    tasks_at(&documents.paths, documents.root.as_deref(), printer)
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
