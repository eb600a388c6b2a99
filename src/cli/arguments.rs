//! What can be written after `kiln`.

mod authoring;

pub(crate) use authoring::{Hidden, New, Render, ShadingName, Watch};

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::values::{assignment, bytes, distance, length, pixels, profile, shard, timeout, view, words};
use crate::gltf::Profile;
use crate::language::Document;
use crate::language::spec::{SubdivisionScheme, Unit, Up};
use crate::preview::View;

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
    /// For people, with annotations for GitHub's workflows
    Github,
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
    /// Format documents; comments stay
    Fmt(Fmt),
    /// Print what a bake would read and write, for other builds
    Plan(Plan),
    /// Print which definitions of a document use which, with the time and memory that shapes take, and what is kept of them
    Graph(Graph),
    /// Hold the reports of baked files against Blender, MeshLab, trimesh, three.js and the Khronos validator, where these are
    /// installed (`pip install kiln-verify`)
    Verify(Verify),
    /// Draw a picture of a document or of a .glb file
    Render(Render),
    /// Bake a document on every save, and show it in a page
    Watch(Watch),
    /// Serve an editor: errors while you type, completion, hover, names (Language Server Protocol)
    Lsp,
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
    /// Make a static page of documents, with pictures and a viewer
    Gallery(Gallery),
    /// Tell what differs between two models: facts, distance, pictures
    ///
    /// Exit codes: 0 the same bytes, 1 they differ, 2 wrong usage, 3 they cannot be compared.
    Diff(Diff),
    /// Make a glTF file of whatever maker small and quick to draw; names, extras and unknown extensions live on
    Optimize(Optimize),
    /// Write the mesh of another program's file as a document: points and faces as text, its polygons kept
    Convert(Convert),
    /// Print what is in a .glb file
    Inspect(Inspect),
    /// Look after the folder of what was baked before
    Cache(CacheCommand),
    /// Print a completion script for a shell
    Completions(Completions),
    /// Write manual pages
    #[command(hide = true)]
    Man(Man),
}

/// Documents and what they are given.
#[derive(Debug, Default, Args)]
pub(crate) struct Documents {
    /// Documents, folders of them, or a project file [default: all of the project, by the kiln.toml here or above]
    #[arg(value_name = "PATH")]
    pub(crate) paths: Vec<PathBuf>,
    /// Set a parameter for all documents
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
    /// Parameters that the project gives to those documents that have them.
    #[arg(skip)]
    pub(crate) given: Vec<(String, String)>,
    /// The folder that no document may read outside of [default: that of the project file, or the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// How many documents are worked on at once [default: one for each core]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Work on one of N equal parts of the documents, from 1, so that N machines share them
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub(crate) shard: Option<Shard>,
    /// Take what is named and nothing else, as builds in sandboxes lay it out: links may lead out of the root; no kiln.toml and no
    /// variable of the environment is heard
    #[arg(long)]
    pub(crate) hermetic: bool,
}

impl Documents {
    /// The parameters of a document: those of the project that it has, then those of the command line, which win.
    pub(crate) fn overrides(&self, document: &Document) -> Vec<(String, String)> {
        let known = if self.given.is_empty() { Vec::new() } else { document.parameters() };
        let given = self.given.iter().filter(|(name, _)| known.contains(name));
        given.chain(&self.set).cloned().collect()
    }
}

/// One of several equal parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shard {
    /// From 1.
    pub(crate) number: usize,
    pub(crate) of: usize,
}

/// Records of what came of documents.
#[derive(Debug, Default, Args)]
pub(crate) struct RecordOptions {
    /// Write errors and warnings as SARIF too, for code scanning
    #[arg(long, value_name = "FILE")]
    pub(crate) sarif: Option<PathBuf>,
    /// Write what came of each document as a report for `JUnit` too
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Bake {
    #[command(flatten)]
    pub(crate) documents: Documents,
    /// Where outputs go; documents found in folders keep their place below it [default: what the project says, else out]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Measure the distance from the true surface by dense sampling too
    #[arg(long, conflicts_with = "no_report")]
    pub(crate) measure: bool,
    /// Be quick and coarse: tolerances eight times as wide, no levels of detail, no lightmaps and occlusion, assertions not checked
    #[arg(long, conflicts_with = "check")]
    pub(crate) draft: bool,
    /// For whom files are; several make several files [default: what the document says, else core]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = profile)]
    pub(crate) profile: Vec<Profile>,
    /// Write no report, and check no assertions
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Write nothing; fail where a file is not what would be written
    #[arg(long, conflicts_with = "depfile")]
    pub(crate) check: bool,
    /// Write which files each output was made of, for Make and Ninja
    #[arg(long, value_name = "FILE")]
    pub(crate) depfile: Option<PathBuf>,
    /// How much memory documents may take that are baked at one time, by estimate: heavy ones wait for one another, and one alone
    /// is always baked
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub(crate) memory: Option<u64>,
    #[command(flatten)]
    pub(crate) cache: CacheOptions,
    #[command(flatten)]
    pub(crate) records: RecordOptions,
}

#[derive(Debug, Args)]
pub(crate) struct Plan {
    #[command(flatten)]
    pub(crate) documents: Documents,
    /// Where outputs would go [default: what the project says, else out]
    #[arg(short, long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// What the plan is written as
    #[arg(long = "as", value_enum, default_value_t = PlanFormat::Json)]
    pub(crate) form: PlanFormat,
    /// For whom files would be
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = profile)]
    pub(crate) profile: Vec<Profile>,
    /// Without reports
    #[arg(long)]
    pub(crate) no_report: bool,
}

/// What a plan is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PlanFormat {
    /// A list of steps
    Json,
    /// A file for Ninja
    Ninja,
    /// A file for GNU Make, 4.3 or later
    Make,
}

#[derive(Debug, Args)]
pub(crate) struct Graph {
    /// The document
    pub(crate) file: PathBuf,
    /// What the graph is written as
    #[arg(long = "as", value_enum, default_value_t = GraphFormat::Dot)]
    pub(crate) form: GraphFormat,
    /// The variant of the document
    #[arg(long, value_name = "NAME")]
    pub(crate) variant: Option<String>,
    /// For whom files would be
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = profile)]
    pub(crate) profile: Vec<Profile>,
    /// The folder that the document may not read outside of [default: that of the project file, or the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// Set a parameter of the document
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) cache: CacheOptions,
}

/// What a graph is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum GraphFormat {
    /// The language of Graphviz
    Dot,
    /// One object
    Json,
}

#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// Folders of baked files, and options of kiln-verify
    #[arg(required = true, value_name = "OUT", trailing_var_arg = true, allow_hyphen_values = true)]
    pub(crate) words: Vec<std::ffi::OsString>,
}

#[derive(Debug, Args)]
pub(crate) struct Man {
    /// Where the pages go, one for each command
    pub(crate) folder: PathBuf,
}

/// What is remembered of earlier runs.
#[derive(Debug, Args)]
pub(crate) struct CacheOptions {
    /// Take what was baked before from a folder, and keep there what is baked now; `KILN_CACHE` names one too
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    pub(crate) cache: Option<PathBuf>,
    /// Use no cache, whatever `KILN_CACHE` says
    #[arg(long)]
    pub(crate) no_cache: bool,
    /// How much the folder may take; what was not used for the longest time goes first [default: 1 GB]
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub(crate) cache_limit: Option<u64>,
    /// A cache that machines share, which is asked for what the folder does not have: `https://HOST/PATH` or `s3://BUCKET/PREFIX`;
    /// `KILN_REMOTE_CACHE` names one too
    #[arg(long, value_name = "URL", conflicts_with = "no_cache")]
    pub(crate) remote_cache: Option<String>,
    /// Store what is baked there too
    #[arg(long)]
    pub(crate) remote_cache_write: bool,
    /// Seconds that one request to it may take [default: 10]
    #[arg(long, value_name = "SECONDS", value_parser = timeout)]
    pub(crate) remote_cache_timeout: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct CacheCommand {
    #[command(subcommand)]
    pub(crate) action: CacheAction,
    /// The folder [default: what `KILN_CACHE` names, else that of the project]
    #[arg(long, global = true, value_name = "DIR")]
    pub(crate) cache: Option<PathBuf>,
}

/// What is done with a cache.
#[derive(Clone, Copy, Debug, Subcommand)]
pub(crate) enum CacheAction {
    /// Print how much it holds
    Stats,
    /// Take everything out
    Clear,
    /// Hash everything, and take out what is broken
    Verify,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    #[command(flatten)]
    pub(crate) documents: Documents,
    #[command(flatten)]
    pub(crate) records: RecordOptions,
}

#[derive(Debug, Args)]
pub(crate) struct Fmt {
    /// Documents, folders of them, or `-` for standard input to standard output
    #[arg(required = true, value_name = "PATH")]
    pub(crate) paths: Vec<PathBuf>,
    /// Write nothing; fail where a document is not formatted
    #[arg(long)]
    pub(crate) check: bool,
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
pub(crate) struct Inspect {
    /// The file
    pub(crate) file: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Optimize {
    /// The file, .glb or .gltf with its data in it or beside it
    pub(crate) file: PathBuf,
    /// The .glb file that is written
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// For whom it is
    #[arg(long, value_name = "NAME", default_value = "web", value_parser = profile)]
    pub(crate) profile: Profile,
    /// How far a point may move, in units of the scene [default: half of a 16384th of its extent along each axis]
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub(crate) tolerance: Option<f64>,
    /// Version of the compression: 0 for `EXT_meshopt_compression`, 1 for the shorter `KHR_meshopt_compression`
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=1))]
    pub(crate) codec: u8,
    /// Pixels of the longer side of a picture: larger PNG and JPEG pictures are made smaller, as PNG
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) texture_size: Option<u32>,
    /// Write PNG pictures anew in the shortest of many ways
    #[arg(long)]
    pub(crate) compress_textures: bool,
    /// Write sizes, counts and measured errors as JSON too
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Convert {
    /// The file: glTF, OBJ, STL, PLY, 3DS, DXF, MD2, MD3 or MD5
    pub(crate) file: PathBuf,
    /// The document that is written; it ends in .toml
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The name of the shape [default: that of the document]
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Only the faces of this group, object or solid
    #[arg(long, value_name = "NAME")]
    pub(crate) group: Option<String>,
    /// Join points that are within this distance, in the units of the file; 0 joins equal points
    #[arg(long, value_name = "LENGTH", value_parser = distance)]
    pub(crate) weld: Option<f64>,
    /// The unit of the file
    #[arg(long, value_name = "UNIT", default_value = "m", value_parser = words(&Unit::ALL, Unit::text))]
    pub(crate) unit: Unit,
    /// The axis of the file that points up [default: y for glTF, OBJ and PLY, z for the others]
    #[arg(long, value_name = "AXIS", value_parser = words(&Up::ALL, Up::text))]
    pub(crate) up: Option<Up>,
    /// Make the mesh the cage of a subdivision surface by this scheme
    #[arg(long, value_name = "SCHEME", value_parser = words(&SubdivisionScheme::ALL, SubdivisionScheme::text))]
    pub(crate) subdivide: Option<SubdivisionScheme>,
    /// Write over a document that is there
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Gallery {
    #[command(flatten)]
    pub(crate) documents: Documents,
    /// The folder of the page
    #[arg(short, long, value_name = "DIR", default_value = "site")]
    pub(crate) out: PathBuf,
    /// The folder of three.js [default: where npm installed it, for this folder, the project, or one above]
    #[arg(long, value_name = "DIR")]
    pub(crate) three: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Diff {
    /// A document, a .glb file, or REVISION:PATH for either as it stood in a revision of git
    #[arg(value_name = "A")]
    pub(crate) one: String,
    /// The same, of what it became
    #[arg(value_name = "B")]
    pub(crate) other: String,
    /// Write a picture of both side by side (.png), or a page with all that changed (.html)
    #[arg(short, long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// From where they are seen: a name or AZIMUTH,ELEVATION in degrees, as for `render`
    #[arg(long, value_name = "VIEW", default_value = "corner", allow_hyphen_values = true, value_parser = view)]
    pub(crate) view: View,
    /// Pixels of each picture
    #[arg(long, value_name = "N|WIDTHxHEIGHT", default_value = "512", value_parser = pixels)]
    pub(crate) size: (u32, u32),
    /// The folder that documents may not read outside of [default: the working directory]
    #[arg(long, value_name = "DIR")]
    pub(crate) root: Option<PathBuf>,
    /// The variant of the documents
    #[arg(long, value_name = "NAME")]
    pub(crate) variant: Option<String>,
    /// Set a parameter of the documents
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    pub(crate) set: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}
