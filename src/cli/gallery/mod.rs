//! `kiln gallery`: a static page of documents, each with its picture, its facts, its text, and a viewer that shows its bytes.
//!
//! Promise: the page needs no server of its own and no other site; what it shows are the files beside it. The viewer is
//! three.js, of which the modules that are needed are copied from where it is installed; without it there are pictures.
//! The same documents give the same pages.
//! No promise: browsers load modules from servers alone, so that the viewer does not open from a folder (`file:`).

mod page;

use std::path::Path;

use serde_json::json;

use super::Outcome;
use super::arguments::Gallery;
use super::output::Printer;
use super::project::named;
use super::three::Three;
use crate::compile::{Compiled, Options, compile};
use crate::language::source::Files as _;
use crate::preview::{Camera, Look, Moment, Stage, View, asset, draw_picture};
use crate::project::{Task, reason, save};
use page::Entry;

/// What opens the viewer.
const SCRIPT: &str = include_str!("gallery.js");
/// The viewer of `kiln watch`.
const VIEWER: &str = include_str!("../watch/page/viewer.js");
/// The page's look.
const STYLE: &str = include_str!("gallery.css");

pub(crate) fn run(gallery: &mut Gallery, printer: &Printer) -> Outcome {
    let tasks = match named(&mut gallery.documents, None, printer) {
        Ok((_, tasks)) => tasks,
        Err(outcome) => return outcome,
    };
    let root = tasks.first().map_or(Path::new("."), |task| task.root.as_path());
    let three = match Three::find(gallery.three.as_deref(), root) {
        Ok(three) => three,
        Err(message) => {
            printer.failure(&message, None);
            return Outcome::Usage;
        }
    };
    let mut outcome = Outcome::Good;
    let mut entries = Vec::new();
    for task in &tasks {
        match entry(task, gallery, printer) {
            Ok(Some(entry)) => entries.push(entry),
            Ok(None) => {}
            Err(failed) => outcome = outcome.max(failed),
        }
    }
    let modules = three.as_ref().map(|three| three.needed(VIEWER)).unwrap_or_default();
    if three.is_none() {
        let note = "three.js was not found: the page has pictures and no viewer; `npm install three`, or --three DIR";
        printer.result(&format!("note: {note}"), &json!({ "note": note }));
    }
    let mut files = vec![("index.html".to_owned(), page::page(&entries, three.is_some()).into_bytes())];
    files.push(("gallery.css".to_owned(), STYLE.as_bytes().to_vec()));
    if three.is_some() {
        files.push(("gallery.js".to_owned(), SCRIPT.as_bytes().to_vec()));
        files.push(("viewer.js".to_owned(), VIEWER.as_bytes().to_vec()));
        files.extend(modules.into_iter().map(|(path, bytes)| (format!("three/{path}"), bytes)));
    }
    for (path, bytes) in &files {
        outcome = outcome.max(put(&gallery.out, path, bytes, printer));
    }
    let index = gallery.out.join("index.html").display().to_string();
    printer.result(
        &format!("{index}  {} models", entries.len()),
        &json!({ "page": index, "models": entries.len(), "viewer": three.is_some() }),
    );
    outcome
}

/// Bakes a document, writes its files, and gives what the page says of it; nothing for a library.
fn entry(task: &Task, gallery: &Gallery, printer: &Printer) -> Result<Option<Entry>, Outcome> {
    let unread = |error: std::io::Error| {
        printer.failure(&format!("{}: {}", task.path, reason(&error)), None);
        Outcome::Files
    };
    let (files, document) = task.load().map_err(unread)?;
    let told = |list| {
        printer.diagnostics(&list);
        Outcome::Errors
    };
    let document = document.map_err(told)?;
    if task.found && document.is_library() {
        return Ok(None);
    }
    let options = Options {
        overrides: gallery.documents.overrides(&document),
        name: task.name().to_owned(),
        path: task.path.clone(),
        ..Options::default()
    };
    let compiled = compile(&document, &files, &options).map_err(told)?;
    let text = files.read(&task.path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let picture = picture(&compiled).map_err(|message| {
        printer.failure(&format!("{}: {message}", task.path), None);
        Outcome::Errors
    })?;
    for (path, bytes) in [("glb", &compiled.bytes), ("png", &picture)] {
        match put(&gallery.out, &format!("models/{}.{path}", task.output), bytes, printer) {
            Outcome::Good => {}
            failed => return Err(failed),
        }
    }
    let (name, path) = (task.output.clone(), task.path.clone());
    Ok(Some(Entry { name, path, text: text.unwrap_or_default(), line: super::baked::line(&compiled) }))
}

/// Pixels of the pictures.
const SIZE: (u32, u32) = (480, 360);

fn picture(compiled: &Compiled) -> Result<Vec<u8>, String> {
    let asset = asset::read(&compiled.bytes).map_err(|error| error.to_string())?;
    let stage = Stage::new(&asset, &Moment::default()).map_err(|error| error.to_string())?;
    let look = Look { size: SIZE, ..Look::default() };
    let corner = View { azimuth: 35.0, elevation: 22.0 };
    let camera = Camera::on(&[&stage], corner, &look);
    draw_picture(&asset, &stage, &camera, &look).png().map_err(|error| error.to_string())
}

fn put(out: &Path, path: &str, bytes: &[u8], printer: &Printer) -> Outcome {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    match save(&out.join(folder), &[(name, bytes)]) {
        Ok(()) => Outcome::Good,
        Err(error) => {
            let message = format!("cannot write {}: {}", out.join(path).display(), reason(&error));
            printer.failure(&message, None);
            Outcome::Files
        }
    }
}
