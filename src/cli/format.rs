//! `kiln fmt`: documents with their spaces, indents and commas set one way.
//!
//! Promise: a document that is not TOML is left alone and told; what is written means what stood there before, which is
//! held against both texts before anything is written; files appear whole or not at all.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::json;

use super::Outcome;
use super::arguments::{Documents, Fmt};
use super::output::Printer;
use super::project::{found, tasks_found};
use crate::language::diagnostic::Diagnostics;
use crate::language::format;
use crate::language::source::{SourceMap, decode};
use crate::language::value::parse;
use crate::project::{reason, save};

pub(crate) fn run(fmt: &Fmt, printer: &Printer) -> Outcome {
    let (streams, paths): (Vec<PathBuf>, Vec<PathBuf>) =
        fmt.paths.iter().cloned().partition(|path| path == Path::new("-"));
    let mut outcome = Outcome::Good;
    if !streams.is_empty() {
        outcome = outcome.max(stream(fmt, printer));
    }
    let Some(tasks) = tasks_found(paths.iter().map(|path| found(path, &Documents::default())), printer)
    else {
        return Outcome::Files;
    };
    for task in &tasks {
        outcome = outcome.max(file(&task.root.join(&task.path), &task.path, fmt, printer));
    }
    outcome
}

fn stream(fmt: &Fmt, printer: &Printer) -> Outcome {
    let mut bytes = Vec::new();
    if let Err(error) = std::io::stdin().lock().read_to_end(&mut bytes) {
        printer.failure(&format!("standard input: {}", reason(&error)), None);
        return Outcome::Files;
    }
    match formatted(&bytes, "standard input", printer) {
        Ok(text) if fmt.check => checked(text.as_bytes() == bytes, "standard input", printer),
        Ok(text) => {
            printer.raw(&text);
            Outcome::Good
        }
        Err(outcome) => outcome,
    }
}

fn file(path: &Path, shown: &str, fmt: &Fmt, printer: &Printer) -> Outcome {
    let failed = |verb: &str, error: &std::io::Error| {
        printer.failure(&format!("cannot {verb} {shown}: {}", reason(error)), None);
        Outcome::Files
    };
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) => return failed("read", &error),
    };
    let text = match formatted(&bytes, shown, printer) {
        Ok(text) => text,
        Err(outcome) => return outcome,
    };
    let same = text.as_bytes() == bytes;
    if fmt.check {
        return checked(same, shown, printer);
    }
    if same {
        return Outcome::Good;
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match save(folder, &[(&name, text.as_bytes())]) {
        Ok(()) => {
            printer.result(shown, &json!({ "formatted": shown }));
            Outcome::Good
        }
        Err(error) => failed("write", &error),
    }
}

fn checked(same: bool, shown: &str, printer: &Printer) -> Outcome {
    if same {
        return Outcome::Good;
    }
    printer.failure(&format!("{shown} is not formatted"), Some("`kiln fmt` formats it"));
    Outcome::Errors
}

/// A text, formatted; or how the command ends, after a complaint.
fn formatted(bytes: &[u8], shown: &str, printer: &Printer) -> Result<String, Outcome> {
    let text = decode(bytes).map_err(|fault| {
        printer.failure(&format!("{shown}: {fault}"), Some("save the document as UTF-8"));
        Outcome::Errors
    })?;
    let mut sources = SourceMap::new();
    let id = sources.add(shown, text).ok_or_else(|| {
        printer.failure(&format!("{shown} is larger than 4 GiB"), None);
        Outcome::Errors
    })?;
    let (_, found) = parse(&sources, id);
    if !found.is_empty() {
        printer.diagnostics(&Diagnostics::new(found, Arc::new(sources)));
        return Err(Outcome::Errors);
    }
    let Some(after) = meaning_kept(text) else {
        printer.failure(&format!("{shown}: Kiln failed inside; please report this document as a bug"), None);
        return Err(Outcome::Errors);
    };
    Ok(after)
}

/// A text, formatted; `None` where it is not TOML, or would mean something else.
pub(super) fn meaning_kept(text: &str) -> Option<String> {
    let after = format(text);
    // As texts: what is not a number equals itself.
    let meaning = |text: &str| toml::from_str::<toml::Table>(text).map(|table| format!("{table:?}")).ok();
    (meaning(text)? == meaning(&after)? && format(&after) == after).then_some(after)
}
