//! `kiln bake`: documents into files.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use serde_json::json;

use super::Outcome;
use super::arguments::Bake;
use super::dependencies::Dependencies;
use super::output::Printer;
use super::project::tasks;
use crate::compile::{Compiled, Options, compile_profiles};
use crate::language::source::Files as _;
use crate::project::{Task, Told, reason, save};
use crate::report::{DeviationFacts, Kind, Report};

/// Bakes all documents; one that fails does not stop the others.
pub(crate) fn run(bake: &Bake, printer: &Printer) -> Outcome {
    let Some(tasks) = tasks(&bake.documents, printer) else { return Outcome::Files };
    if let Some(message) = same_name(&tasks) {
        printer.failure(&message, Some("bake them in separate runs with different --out folders"));
        return Outcome::Usage;
    }
    if bake.check {
        // Nothing is written, the folder neither.
    } else if let Err(error) = std::fs::create_dir_all(&bake.out) {
        let message = format!("cannot make the output folder {}: {}", bake.out.display(), reason(&error));
        printer.failure(&message, None);
        return Outcome::Files;
    }
    let progress = progress(tasks.len(), printer);
    let turn = Mutex::new(Turns::default());
    let worker = Worker { bake, printer, progress: &progress, turn, dependencies: Dependencies::default() };
    let outcome = if let [task] = tasks.as_slice() {
        // Waking a second thread costs more than a small document takes.
        worker.work(0, task)
    } else {
        in_parallel(bake, &tasks, &worker)
    };
    progress.finish_and_clear();
    outcome.max(write_dependencies(bake, &worker.dependencies, printer))
}

fn write_dependencies(bake: &Bake, dependencies: &Dependencies, printer: &Printer) -> Outcome {
    let Some(file) = &bake.depfile else { return Outcome::Good };
    let folder = file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match save(folder, &[(&name, dependencies.text().as_bytes())]) {
        Ok(()) => Outcome::Good,
        Err(error) => {
            printer.failure(&format!("cannot write {}: {}", file.display(), reason(&error)), None);
            Outcome::Files
        }
    }
}

fn in_parallel(bake: &Bake, tasks: &[Task], worker: &Worker<'_>) -> Outcome {
    let numbered: Vec<(usize, &Task)> = tasks.iter().enumerate().collect();
    let all =
        || numbered.par_iter().map(|(index, task)| worker.work(*index, task)).max().unwrap_or(Outcome::Good);
    let threads = bake.documents.jobs.map_or(0, usize::from);
    match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool.install(all),
        Err(_) => {
            numbered.iter().map(|(index, task)| worker.work(*index, task)).max().unwrap_or(Outcome::Good)
        }
    }
}

/// Two documents whose outputs would be one file.
fn same_name(tasks: &[Task]) -> Option<String> {
    let mut seen: BTreeMap<String, &Task> = BTreeMap::new();
    for task in tasks {
        // Some file systems do not tell upper case from lower.
        if let Some(other) = seen.insert(task.output.to_lowercase(), task) {
            return Some(format!(
                "{} and {} would both be written to {}.glb",
                other.path, task.path, task.output
            ));
        }
    }
    None
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

/// What a document's work has to say, and to whom.
enum Message {
    Result(String, serde_json::Value),
    Diagnostics(crate::language::diagnostic::Diagnostics),
    Failure(String),
}

/// Messages wait for their turn, so that they are printed in the order of the documents.
#[derive(Default)]
struct Turns {
    next: usize,
    waiting: BTreeMap<usize, Vec<Message>>,
}

struct Worker<'a> {
    bake: &'a Bake,
    printer: &'a Printer,
    progress: &'a ProgressBar,
    turn: Mutex<Turns>,
    dependencies: Dependencies,
}

impl Worker<'_> {
    fn work(&self, index: usize, task: &Task) -> Outcome {
        self.progress.set_message(task.path.clone());
        let mut messages = Vec::new();
        let outcome = catch_unwind(AssertUnwindSafe(|| self.document((index, task), &mut messages)))
            .unwrap_or_else(|_| {
                messages.push(Message::Failure(format!(
                    "{}: Kiln failed inside; please report this document as a bug",
                    task.path
                )));
                Outcome::Errors
            });
        self.speak(index, messages);
        self.progress.inc(1);
        outcome
    }

    fn speak(&self, index: usize, messages: Vec<Message>) {
        let Ok(mut turns) = self.turn.lock() else { return };
        turns.waiting.insert(index, messages);
        loop {
            let next = turns.next;
            let Some(messages) = turns.waiting.remove(&next) else { return };
            turns.next += 1;
            self.progress.suspend(|| messages.iter().for_each(|message| self.print(message)));
        }
    }

    fn print(&self, message: &Message) {
        match message {
            Message::Result(text, object) => self.printer.result(text, object),
            Message::Diagnostics(list) => self.printer.diagnostics(list),
            Message::Failure(text) => self.printer.failure(text, None),
        }
    }

    /// Bakes a document and its variants.
    fn document(&self, (index, task): (usize, &Task), messages: &mut Vec<Message>) -> Outcome {
        let (files, document) = match task.load() {
            Ok(loaded) => loaded,
            Err(error) => {
                messages.push(Message::Failure(format!("{}: {}", task.path, reason(&error))));
                return Outcome::Files;
            }
        };
        let document = match document {
            Ok(document) => document,
            Err(list) => {
                messages.push(Message::Diagnostics(list));
                return Outcome::Errors;
            }
        };
        if task.found && document.is_library() {
            if self.printer.verbose {
                let text = format!("passed over {}: it defines nothing to show", task.path);
                messages.push(Message::Result(text, json!({ "skipped": task.path })));
            }
            return Outcome::Good;
        }
        let mut outcome = Outcome::Good;
        let mut told = Told::default();
        let mut outputs = Vec::new();
        let variants = std::iter::once(None).chain(document.variants().into_iter().map(Some));
        for variant in variants {
            let options = Options {
                variant,
                overrides: self.bake.documents.set.clone(),
                name: task.name().to_owned(),
                path: task.path.clone(),
                no_report: self.bake.no_report,
                measure: self.bake.measure,
                origins: false,
                profiles: self.bake.profile.clone(),
            };
            outcome = outcome.max(match compile_profiles(&document, &files, &options) {
                Ok(compiled) => {
                    let put = |mut compiled: Compiled| {
                        compiled.warnings =
                            told.only_new(&document, compiled.warnings, options.variant.as_deref());
                        self.put(task, compiled, (messages, &mut outputs))
                    };
                    compiled.into_iter().map(put).max().unwrap_or(Outcome::Good)
                }
                Err(list) => {
                    let list = told.only_new(&document, list, options.variant.as_deref());
                    messages.push(Message::Diagnostics(list));
                    Outcome::Errors
                }
            });
        }
        if self.bake.depfile.is_some() {
            let found = files.record().into_iter().filter(|record| record.found);
            let inputs = found.map(|record| shown(task, &record.path)).collect();
            self.dependencies.add(index, outputs, inputs);
        }
        outcome
    }

    /// Writes an asset, or holds it against the files that there are.
    fn put(
        &self,
        task: &Task,
        compiled: Compiled,
        (messages, outputs): (&mut Vec<Message>, &mut Vec<String>),
    ) -> Outcome {
        let folder = match task.output.rsplit_once('/') {
            Some((folder, _)) => self.bake.out.join(folder),
            None => self.bake.out.clone(),
        };
        let target = folder.join(&compiled.file);
        let failed = |verb: &str, error: std::io::Error| {
            Message::Failure(format!("cannot {verb} {}: {}", target.display(), reason(&error)))
        };
        let files = match files_of(&compiled) {
            Ok(files) => files,
            Err(error) => {
                messages.push(failed("write", error));
                return Outcome::Files;
            }
        };
        let list: Vec<(&str, &[u8])> =
            files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_ref())).collect();
        if self.bake.check {
            let differs = |name: &&str| {
                Message::Failure(format!("{} is not what is baked", folder.join(name).display()))
            };
            let other = |(name, bytes): &&(&str, &[u8])| {
                std::fs::read(folder.join(name)).ok().as_deref() != Some(*bytes)
            };
            let before = messages.len();
            messages.extend(list.iter().filter(other).map(|(name, _)| differs(name)));
            if messages.len() > before {
                return Outcome::Errors;
            }
        } else if let Err(error) = save(&folder, &list) {
            messages.push(failed("write", error));
            return Outcome::Files;
        }
        outputs.extend(files.iter().map(|(name, _)| folder.join(name).display().to_string()));
        let object = json!({
            "asset": target.display().to_string(),
            "spec": task.path,
            "variant": compiled.report.as_ref().and_then(|report| report.variant.clone()),
            "profile": compiled.profile.name(),
            "bytes": compiled.bytes.len(),
            "triangles": compiled.report.as_ref().map(|report| report.totals.triangles),
            "deviation": compiled.report.as_ref().and_then(worst),
        });
        messages.push(Message::Result(line(&target, &compiled), object));
        if !compiled.warnings.is_empty() {
            messages.push(Message::Diagnostics(compiled.warnings));
        }
        Outcome::Good
    }
}

/// The greatest deviation of all shapes.
fn worst(report: &Report) -> Option<DeviationFacts> {
    let deviations = report.shapes.values().map(|shape| shape.deviation);
    deviations.max_by(|a, b| a.bound.total_cmp(&b.bound))
}

/// An asset in a line.
pub(super) fn line(target: &Path, compiled: &Compiled) -> String {
    let bytes = size(compiled.bytes.len());
    let Some(report) = &compiled.report else { return format!("{}  {bytes}", target.display()) };
    let accuracy = worst(report).map_or_else(String::new, |deviation| {
        let how = match deviation.kind {
            Kind::Exact => "exact".to_owned(),
            Kind::Proved => format!("within {} (proved)", metres(deviation.bound)),
            Kind::Sampled => format!("within {} (sampled)", metres(deviation.bound)),
        };
        let measured =
            deviation.measured.map_or_else(String::new, |found| format!(", measured {}", metres(found)));
        format!("  {how}{measured}")
    });
    let drawn = match (report.totals.triangles, report.totals.segments) {
        (triangles, 0) => format!("{triangles} triangles"),
        (0, segments) => format!("{segments} line segments"),
        (triangles, segments) => format!("{triangles} triangles  {segments} line segments"),
    };
    format!("{}  {drawn}  {bytes}{accuracy}", target.display())
}

/// A length for people.
fn metres(length: f64) -> String {
    match length {
        _ if length >= 1.0 => format!("{length:.3} m"),
        _ if length >= 1e-3 => format!("{:.3} mm", length * 1e3),
        _ => format!("{:.3} um", length * 1e6),
    }
}

fn size(bytes: usize) -> String {
    match bytes as f64 {
        bytes if bytes >= 1e6 => format!("{:.1} MB", bytes / 1e6),
        bytes if bytes >= 1e3 => format!("{:.1} kB", bytes / 1e3),
        bytes => format!("{bytes} B"),
    }
}

/// The file and its report.
pub(super) fn files_of(compiled: &Compiled) -> std::io::Result<Vec<(String, Cow<'_, [u8]>)>> {
    let mut files = vec![(compiled.file.clone(), Cow::Borrowed(compiled.bytes.as_slice()))];
    if let Some(report) = &compiled.report {
        let mut text = serde_json::to_vec_pretty(report)?;
        text.push(b'\n');
        files.push((format!("{}.report.json", compiled.file.trim_end_matches(".glb")), Cow::Owned(text)));
    }
    Ok(files)
}

/// The path of an input from the working directory, where it lies in that.
fn shown(task: &Task, path: &str) -> String {
    let whole = task.root.join(path);
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    let below = here.ok().and_then(|here| whole.strip_prefix(here).ok().map(Path::to_path_buf));
    below.unwrap_or(whole).display().to_string()
}
