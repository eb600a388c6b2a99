//! What can be written after `kiln`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Bakes model specs (TOML) into glTF.
#[derive(Debug, Parser)]
#[command(name = "kiln", version, about, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 all went well, 1 errors in documents, 2 wrong usage, 3 files that cannot be read or written."
)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What every command understands.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Common {
    /// How results and errors are printed
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// When to color what is printed
    #[arg(long, global = true, value_enum, default_value_t = Color::Auto)]
    pub(crate) color: Color,
    /// Print errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Print more
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    Text,
    /// One JSON object a line
    Json,
}

/// When to color.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    /// Where a terminal shows it
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Bake documents into .glb files and reports
    Bake(Bake),
    /// Find everything that is wrong with documents, and write nothing
    Check(Check),
    /// Print points and derivatives of a curve or a surface as JSON
    Sample(Sample),
    /// Print the JSON Schema of documents, for editors
    Schema,
    /// Print the reference page of the language
    Reference,
    /// Explain the code of an error
    Explain(Explain),
    /// Write a commented document to start from
    New(New),
    /// Print what is in a .glb file
    Inspect(Inspect),
    /// Print a completion script for a shell
    Completions(Completions),
}

/// Documents and what they are given.
#[derive(Debug, Args)]
pub(crate) struct Documents {
    /// Documents, or folders of them
    #[arg(required = true, value_name = "PATH")]
    pub(crate) paths: Vec<PathBuf>,
    /// Set a parameter for all documents
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
    /// The folder that no document may read outside of [default: the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// How many documents are worked on at once [default: one for each core]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
}

#[derive(Debug, Args)]
pub(crate) struct Bake {
    #[command(flatten)]
    pub(crate) documents: Documents,
    /// Where outputs go; documents found in folders keep their place below it
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
    /// Measure the distance from the true surface by dense sampling too
    #[arg(long, conflicts_with = "no_report")]
    pub(crate) measure: bool,
    /// Write no report, and check no assertions
    #[arg(long)]
    pub(crate) no_report: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    #[command(flatten)]
    pub(crate) documents: Documents,
}

#[derive(Debug, Args)]
pub(crate) struct Sample {
    /// The document
    pub(crate) file: PathBuf,
    /// Name of the curve
    #[arg(long, value_name = "NAME", conflicts_with = "shape", required_unless_present = "shape")]
    pub(crate) curve: Option<String>,
    /// Name of the shape, one with a surface: revolve, extrude, sweep, sphere, cylinder
    #[arg(long, value_name = "NAME")]
    pub(crate) shape: Option<String>,
    /// Parameters: T of a curve, U,V of a surface
    #[arg(long, value_name = "T|U,V", num_args = 1.., allow_negative_numbers = true, conflicts_with = "count")]
    pub(crate) at: Vec<String>,
    /// This many even steps over the domain
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub(crate) count: u32,
    /// Print only how many nanoseconds the curve, or the surface by control points, takes for a point and its derivatives
    #[arg(long, conflicts_with = "at")]
    pub(crate) time: bool,
    /// Set a parameter of the document
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub(crate) struct Explain {
    /// The code, as in `K0101`; all codes when left out
    pub(crate) code: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct New {
    /// Name of the document, in kebab-case; `.toml` is added
    pub(crate) name: String,
}

#[derive(Debug, Args)]
pub(crate) struct Inspect {
    /// The file
    pub(crate) file: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE, as in `height=0.3`".to_owned()),
    }
}
