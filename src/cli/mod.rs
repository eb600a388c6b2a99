//! The command line, the only part that prints.
//!
//! Exit codes: 0 all went well, 1 errors in documents, 2 wrong usage, 3 files that cannot be read or written.

mod arguments;
mod bake;
mod baked;
mod budget;
mod cache;
mod check;
mod convert;
mod dependencies;
mod describe;
mod diff;
mod format;
mod gallery;
mod graph;
mod html;
mod input;
mod inspect;
mod lsp;
mod optimize;
mod output;
mod plan;
mod project;
mod records;
mod render;
mod sample;
mod sample_curve;
mod sample_surface;
mod starter;
mod three;
mod timed;
mod turns;
mod values;
mod verify;
mod watch;

use std::process::ExitCode;

use clap::Parser as _;

use arguments::{Arguments, Command};

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outcome {
    /// All went well.
    Good,
    /// Errors in documents.
    Errors,
    /// Wrong usage.
    Usage,
    /// Files that cannot be read or written.
    Files,
}

impl Outcome {
    fn code(self) -> u8 {
        match self {
            Self::Good => 0,
            Self::Errors => 1,
            Self::Usage => 2,
            Self::Files => 3,
        }
    }
}

/// Runs the command named by the process arguments and gives its exit code.
#[must_use]
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let help = !error.use_stderr();
            // A closed pipe is no reason to fail.
            let _ = error.print();
            return ExitCode::from(if help { Outcome::Good.code() } else { Outcome::Usage.code() });
        }
    };
    let printer = output::Printer::new(&arguments.common);
    let outcome = match arguments.command {
        Command::Bake(mut bake) => bake::run(&mut bake, &printer),
        Command::Check(mut check) => check::run(&mut check, &printer),
        Command::Fmt(fmt) => format::run(&fmt, &printer),
        Command::Plan(mut plan) => plan::run(&mut plan, &printer),
        Command::Graph(graph) => graph::run(&graph, &printer),
        Command::Verify(verify) => verify::run(&verify, &printer),
        Command::Render(render) => render::run(&render, &printer),
        Command::Watch(mut watch) => watch::run(&mut watch, &printer),
        Command::Sample(sample) => sample::run(&sample, &printer),
        Command::Schema => describe::schema(&printer),
        Command::Reference => describe::reference(&printer),
        Command::Explain(explain) => describe::explain(&explain, &printer),
        Command::New(new) => starter::run(&new, &printer),
        Command::Diff(diff) => diff::run(&diff, &printer),
        Command::Gallery(mut gallery) => gallery::run(&mut gallery, &printer),
        Command::Lsp => lsp::run(&printer),
        Command::Convert(convert) => convert::run(&convert, &printer),
        Command::Optimize(optimize) => optimize::run(&optimize, &printer),
        Command::Inspect(inspect) => inspect::run(&inspect, &printer),
        Command::Cache(command) => cache::run(&command, &printer),
        Command::Completions(completions) => describe::completions(&completions),
        Command::Man(man) => describe::manual(&man, &printer),
    };
    let outcome = if output::all_printed() { outcome } else { outcome.max(Outcome::Files) };
    ExitCode::from(outcome.code())
}
