//! Which documents the arguments name, and work on each of them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::Outcome;
use super::arguments::{Documents, RecordOptions};
use super::budget;
use super::output::Printer;
use super::records::Records;
use super::turns::{Message, Turns};
use crate::compile::profile_of;
use crate::gltf::Profile;
use crate::language::source::DiskFiles;
use crate::language::{Document, PROJECT_FILE};
use crate::project::{Project, ProjectFault, Task, collect, collect_linked, reason};

/// The documents that the arguments name, and the project that these belong to; how the command ends after a complaint. Outputs of
/// single documents too have the place that they have in the project, unless another folder is named for them.
pub(crate) fn named(
    documents: &mut Documents,
    out: Option<&PathBuf>,
    printer: &Printer,
) -> Result<(Option<Project>, Vec<Task>), Outcome> {
    let project = project(documents, printer)?;
    let mut tasks = tasks(documents, project.as_ref(), printer)?;
    if let Some(project) = &project {
        let placed = |task| if out.is_none() { project.placed(task) } else { task };
        tasks = tasks.into_iter().map(|task| project.within(placed(task))).collect();
    }
    Ok((project, tasks))
}

/// The project of the arguments: the file that they name, else the one of the working directory, unless they name documents that
/// lie elsewhere. The arguments take from it what they do not say themselves.
fn project(documents: &mut Documents, printer: &Printer) -> Result<Option<Project>, Outcome> {
    let named = match documents.paths.as_slice() {
        [file] if file.file_name().is_some_and(|name| name == PROJECT_FILE) => Some(file.clone()),
        _ => None,
    };
    if documents.hermetic {
        if documents.paths.is_empty() || named.is_some() {
            let help = format!("--hermetic hears no {PROJECT_FILE}: name documents or folders");
            printer.failure("no document is named", Some(&help));
            return Err(Outcome::Usage);
        }
        return Ok(None);
    }
    let Some(file) = named.clone().or_else(project_here) else {
        if documents.paths.is_empty() {
            let message = format!("no document is named, and there is no {PROJECT_FILE} here or above");
            let help =
                format!("name documents or folders, or write a {PROJECT_FILE} with `roots = [\"specs\"]`");
            printer.failure(&message, Some(&help));
            return Err(Outcome::Usage);
        }
        return Ok(None);
    };
    if named.is_some() {
        documents.paths.clear();
    }
    let beside = |path: &PathBuf| {
        let root = file.parent().and_then(|root| root.canonicalize().ok());
        path.canonicalize().ok().zip(root).is_some_and(|(path, root)| path.starts_with(root))
    };
    if !documents.paths.iter().all(beside) {
        return Ok(None);
    }
    let project = loaded_project(&file, printer)?;
    documents.root.get_or_insert_with(|| project.root.clone());
    let parameters = project.file.project.parameters.iter();
    documents.given = parameters.map(|(name, text)| (name.clone(), text.value.0.clone())).collect();
    Ok(Some(project))
}

/// The project file of the working directory, or of the nearest folder above that has one.
pub(crate) fn project_here() -> Option<PathBuf> {
    std::env::current_dir().ok().and_then(|here| Project::above(&here))
}

/// A project; what is wrong with its file is said.
pub(crate) fn loaded_project(file: &Path, printer: &Printer) -> Result<Project, Outcome> {
    Project::load(file).map_err(|fault| match fault {
        ProjectFault::Wrong(list) => {
            printer.diagnostics(&list);
            Outcome::Errors
        }
        ProjectFault::Unreachable(message) => {
            printer.failure(&message, None);
            Outcome::Files
        }
    })
}

/// For whom files are: what the command line says, else what the project says, if anything.
pub(crate) fn profiles(written: &[Profile], project: Option<&Project>) -> Vec<Profile> {
    let of_project = || project.and_then(|project| project.file.project.profiles.as_ref());
    if written.is_empty()
        && let Some(list) = of_project()
    {
        return list.value.iter().map(|name| profile_of(name.value)).collect();
    }
    written.to_vec()
}

/// Where outputs go: what the command line says, else what the project says, else `out`.
pub(crate) fn out(written: Option<&PathBuf>, project: Option<&Project>) -> PathBuf {
    let of_project = || project.map(|project| from_here(project.out()));
    written.cloned().or_else(of_project).unwrap_or_else(|| PathBuf::from("out"))
}

/// A path from the working directory, where it lies in that.
pub(crate) fn from_here(path: PathBuf) -> PathBuf {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    here.ok().and_then(|here| path.strip_prefix(here).ok().map(Path::to_path_buf)).unwrap_or(path)
}

/// The documents that the arguments name, or all of the project, of which one shard.
fn tasks(documents: &Documents, project: Option<&Project>, printer: &Printer) -> Result<Vec<Task>, Outcome> {
    let mut tasks = match project {
        Some(project) if documents.paths.is_empty() => project.tasks().map_err(|list| {
            printer.diagnostics(&list);
            Outcome::Errors
        })?,
        _ => {
            let find = |path: &PathBuf| found(path, documents);
            tasks_found(documents.paths.iter().map(find), printer).ok_or(Outcome::Files)?
        }
    };
    if let Some(shard) = documents.shard {
        let mut turn = 0;
        tasks.retain(|_| {
            turn += 1;
            (turn - 1) % shard.of == shard.number - 1
        });
    }
    Ok(tasks)
}

/// The documents of a path.
pub(crate) fn found(path: &Path, documents: &Documents) -> Result<Vec<Task>, String> {
    let root = documents.root.as_deref();
    let found = if documents.hermetic { collect_linked(path, root) } else { collect(path, root) };
    found.and_then(|found| match found.is_empty() {
        true => Err(format!("no document (.toml) in {}", path.display())),
        false => Ok(found),
    })
}

/// The documents that were found; `None` after a complaint.
pub(crate) fn tasks_found(
    found: impl Iterator<Item = Result<Vec<Task>, String>>,
    printer: &Printer,
) -> Option<Vec<Task>> {
    let mut tasks = Vec::new();
    let mut good = true;
    for found in found {
        match found {
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

/// A single document of the arguments, as one of its project where it has one: with what `bake` would give it. The documents of the
/// arguments hold its parameters.
pub(crate) fn single(
    path: &Path,
    (root, set): (Option<&Path>, &[(String, String)]),
    printer: &Printer,
) -> Result<(Option<Project>, Task, Documents), Outcome> {
    let mut documents = Documents {
        paths: vec![path.to_path_buf()],
        root: root.map(Path::to_path_buf),
        set: set.to_vec(),
        ..Documents::default()
    };
    let project = project(&mut documents, printer)?;
    let task = task(path, documents.root.as_deref()).map_err(|message| {
        printer.failure(&message, None);
        Outcome::Files
    })?;
    let task = match &project {
        Some(project) => project.within(task),
        None => task,
    };
    Ok((project, task, documents))
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
    /// How much those that run at one time may cost, and what one costs; as many as there are threads where it is not said.
    pub(crate) budget: Option<Budget<'a>>,
}

/// How much documents that run at one time may cost, and what one costs.
pub(crate) type Budget<'a> = (u64, &'a (dyn Fn(&Task) -> u64 + Sync));

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
        match (rayon::ThreadPoolBuilder::new().num_threads(threads).build(), work.budget) {
            (Ok(pool), None) => pool.install(all),
            (Ok(pool), Some((bytes, cost))) => {
                let costs: Vec<u64> = pool.install(|| tasks.par_iter().map(cost).collect());
                let worst = Mutex::new(Outcome::Good);
                budget::run(bytes, &costs, &pool, &|turn| {
                    let outcome = one(numbered[turn]);
                    let mut worst = worst.lock().unwrap_or_else(PoisonError::into_inner);
                    *worst = (*worst).max(outcome);
                });
                worst.into_inner().unwrap_or_else(PoisonError::into_inner)
            }
            (Err(_), _) => numbered.iter().map(|numbered| one(*numbered)).max().unwrap_or(Outcome::Good),
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
