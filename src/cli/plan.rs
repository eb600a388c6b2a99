//! `kiln plan`: what a bake would read and write, before anything is made, for other builds.
//!
//! Promise: each document's own step, with all files that it is made of as they are now. An include that is added later
//! changes the plan; `bake --depfile` tells of it in the step itself. Not promised: levels of detail in files of their own,
//! of which some may turn out to be none, and pictures beside files, of which some may not be shown.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use serde_json::{Value, json};

use super::Outcome;
use super::arguments::{Plan, PlanFormat, RecordOptions};
use super::bake::shown;
use super::dependencies::escaped;
use super::output::Printer;
use super::project::{Work, each, from_here, loaded, named, out, profiles};
use super::turns::Message;
use crate::compile::{Options, outputs};
use crate::language::source::Files as _;
use crate::project::Task;

/// What one document takes and becomes.
struct Step {
    turn: usize,
    spec: String,
    inputs: Vec<String>,
    outputs: Vec<String>,
    command: Vec<String>,
}

/// Prints the plan; nothing where a document is wrong.
pub(crate) fn run(plan: &mut Plan, printer: &Printer) -> Outcome {
    let (project, tasks) = match named(&mut plan.documents, plan.out.as_ref(), printer) {
        Ok(named) => named,
        Err(outcome) => return outcome,
    };
    plan.profile = profiles(&plan.profile, project.as_ref());
    let folder = out(plan.out.as_ref(), project.as_ref());
    let planned = Planned {
        plan,
        out: &folder,
        project: project.map(|project| from_here(project.place()).display().to_string()),
    };
    let steps = Mutex::new(Vec::new());
    let work = Work { documents: &plan.documents, records: &RecordOptions::default(), printer, budget: None };
    let outcome = each(&work, &tasks, &|turn, task, messages| match planned.step((turn, task), messages) {
        Ok(step) => {
            steps.lock().unwrap_or_else(PoisonError::into_inner).extend(step);
            Outcome::Good
        }
        Err(outcome) => outcome,
    });
    if outcome != Outcome::Good {
        return outcome;
    }
    let mut steps = steps.into_inner().unwrap_or_else(PoisonError::into_inner);
    steps.sort_by_key(|step| step.turn);
    printer.raw(&match plan.form {
        PlanFormat::Json => as_json(&steps),
        PlanFormat::Ninja => as_ninja(&steps),
        PlanFormat::Make => as_make(&steps),
    });
    Outcome::Good
}

/// What is planned.
struct Planned<'a> {
    plan: &'a Plan,
    /// Where outputs go.
    out: &'a Path,
    /// The project file, whose words are a part of every step.
    project: Option<String>,
}

impl Planned<'_> {
    /// The step of a document; none of a library.
    fn step(
        &self,
        (turn, task): (usize, &Task),
        messages: &mut Vec<Message>,
    ) -> Result<Option<Step>, Outcome> {
        let Self { plan, out, project } = self;
        let (files, document) = loaded(task, messages)?;
        if task.found && document.is_library() {
            return Ok(None);
        }
        let folder =
            task.output.rsplit_once('/').map_or_else(|| out.to_path_buf(), |(folder, _)| out.join(folder));
        let mut refused = |list| {
            messages.push(Message::Diagnostics(list));
            Outcome::Errors
        };
        let mut names = Vec::new();
        for variant in std::iter::once(None).chain(document.variants().into_iter().map(Some)) {
            let options = Options {
                variant,
                overrides: plan.documents.overrides(&document),
                name: task.name().to_owned(),
                path: task.path.clone(),
                profiles: plan.profile.clone(),
                ..Options::default()
            };
            names.extend(outputs(&document, &files, &options).map_err(&mut refused)?);
        }
        let below = |name: &str| folder.join(name).display().to_string();
        let outputs = names.iter().flat_map(|name| {
            let report =
                (!plan.no_report).then(|| below(&format!("{}.report.json", name.trim_end_matches(".glb"))));
            std::iter::once(below(name)).chain(report)
        });
        let spec = shown(task, &task.path);
        Ok(Some(Step {
            turn,
            inputs: files
                .record()
                .into_iter()
                .filter(|file| file.found)
                .map(|file| shown(task, &file.path))
                .chain(project.clone())
                .collect(),
            outputs: outputs.collect(),
            command: command(plan, task, (&spec, &folder)),
            spec,
        }))
    }
}

/// The command that makes a step, from the working directory.
fn command(plan: &Plan, task: &Task, (spec, folder): (&str, &Path)) -> Vec<String> {
    let mut command: Vec<String> = ["kiln", "bake", spec, "--out"].map(str::to_owned).to_vec();
    command.push(folder.display().to_string());
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    if here.ok().as_deref() != Some(&task.root) {
        command.extend(["--root".to_owned(), task.root.display().to_string()]);
    }
    for (name, value) in &plan.documents.set {
        command.extend(["--set".to_owned(), format!("{name}={value}")]);
    }
    for profile in &plan.profile {
        command.extend(["--profile".to_owned(), profile.name().to_owned()]);
    }
    if plan.no_report {
        command.push("--no-report".to_owned());
    }
    command.push("--quiet".to_owned());
    command
}

fn as_json(steps: &[Step]) -> String {
    let step = |step: &Step| json!({ "spec": step.spec, "inputs": step.inputs, "outputs": step.outputs, "command": step.command });
    format!("{:#}\n", json!({ "steps": steps.iter().map(step).collect::<Vec<Value>>() }))
}

/// A word of a POSIX shell.
fn quoted(word: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._/=,+:@%".contains(&byte);
    if !word.is_empty() && word.bytes().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

fn in_shell(command: &[String]) -> String {
    command.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// Source: Ninja manual, 2024, section "Ninja file reference": `$` escapes itself, spaces and colons of paths.
fn as_ninja(steps: &[Step]) -> String {
    let path = |path: &String| path.replace('$', "$$").replace(' ', "$ ").replace(':', "$:");
    let list = |paths: &[String]| paths.iter().map(path).collect::<Vec<_>>().join(" ");
    let mut text = String::from("rule kiln\n  command = $bake\n  description = kiln $in\n\n");
    for step in steps {
        let others: Vec<String> = step.inputs.iter().filter(|input| **input != step.spec).cloned().collect();
        let _ = write!(text, "build {}: kiln {}", list(&step.outputs), path(&step.spec));
        if !others.is_empty() {
            let _ = write!(text, " | {}", list(&others));
        }
        let _ = writeln!(text, "\n  bake = {}", in_shell(&step.command).replace('$', "$$"));
    }
    text
}

/// Grouped targets, as GNU Make knows them since 4.3.
fn as_make(steps: &[Step]) -> String {
    let list = |paths: &[String]| paths.iter().map(|path| escaped(path)).collect::<Vec<_>>().join(" ");
    let all: Vec<String> = steps.iter().flat_map(|step| step.outputs.iter().cloned()).collect();
    let mut text = format!(".PHONY: all\nall: {}\n", list(&all));
    for step in steps {
        let command = in_shell(&step.command).replace('$', "$$");
        let _ = writeln!(text, "\n{} &: {}\n\t{command}", list(&step.outputs), list(&step.inputs));
    }
    text
}
