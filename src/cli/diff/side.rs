//! One of the models that are compared: a document, a `.glb` file, or either as it stood in a git revision.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use serde_json::Value;

use crate::cli::arguments::Diff;
use crate::cli::inspect;
use crate::cli::project::task;
use crate::compile::{Options, compile};
use crate::language::Document;
use crate::language::diagnostic::Diagnostics;
use crate::language::source::{FileError, FileRecord, Files, join};
use crate::preview::asset::{self, Asset};
use crate::preview::{Moment, Stage};
use crate::project::reason;

/// A model, read.
pub(super) struct Side {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
    pub(super) facts: Value,
    pub(super) asset: Asset,
    pub(super) stage: Stage,
}

/// Why there is none.
pub(super) enum Trouble {
    Document(Diagnostics),
    Other(String),
}

impl Side {
    /// The model that an argument names.
    pub(super) fn read(named: &str, diff: &Diff) -> Result<Self, Trouble> {
        let path = Path::new(named);
        let other = |message: String| Trouble::Other(format!("{named}: {message}"));
        let glb = |path: &str| path.to_lowercase().ends_with(".glb");
        let bytes = match named.split_once(':') {
            Some((revision, path)) if !Path::new(named).exists() => {
                let files = Revision::new(revision).map_err(other)?;
                let path = files.path(path).map_err(other)?;
                if glb(&path) {
                    files.read(&path).map_err(|error| other(error.to_string()))?.to_vec()
                } else {
                    document(&path, &files, diff)?
                }
            }
            _ if glb(named) => std::fs::read(path).map_err(|error| other(reason(&error)))?,
            _ => {
                let task = task(path, diff.root.as_deref()).map_err(Trouble::Other)?;
                let files = crate::language::source::DiskFiles::new(&task.root);
                let files = files.map_err(|error| other(reason(&error)))?;
                document(&task.path, &files, diff)?
            }
        };
        let facts = inspect::facts(&bytes).map_err(other)?;
        let asset = asset::read(&bytes).map_err(|error| other(error.to_string()))?;
        let stage = Stage::new(&asset, &Moment::default()).map_err(|error| other(error.to_string()))?;
        Ok(Self { name: named.to_owned(), bytes, facts, asset, stage })
    }
}

fn document(path: &str, files: &dyn Files, diff: &Diff) -> Result<Vec<u8>, Trouble> {
    // The name of a document is no difference: both have that of the second.
    let name = Path::new(&diff.other).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let options = Options {
        variant: diff.variant.clone(),
        overrides: diff.set.clone(),
        name,
        path: path.to_owned(),
        no_report: true,
        ..Options::default()
    };
    let compiled = Document::load(path, files).and_then(|document| compile(&document, files, &options));
    compiled.map(|compiled| compiled.bytes).map_err(Trouble::Document)
}

/// The files of a git revision, from the top of its tree.
struct Revision {
    /// The commit, in digits.
    commit: String,
    /// The top of the working tree.
    top: PathBuf,
    /// The working directory, from the top.
    here: String,
}

impl Revision {
    fn new(named: &str) -> Result<Self, String> {
        let here = git(&["rev-parse", "--show-prefix"], None)?;
        let top = git(&["rev-parse", "--show-toplevel"], None)?;
        let commit = git(
            &["rev-parse", "--verify", "--quiet", "--end-of-options", &format!("{named}^{{commit}}")],
            None,
        );
        let commit = commit.map_err(|_| format!("there is no revision `{named}`"))?;
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).trim_end_matches('\n').to_owned();
        // A path that begins with `./` is one of the working directory.
        let here = format!("{}.", text(here));
        Ok(Self { commit: text(commit), top: PathBuf::from(text(top)), here })
    }

    /// The path from the top of one from the working directory.
    fn path(&self, written: &str) -> Result<String, String> {
        join(&self.here, written).map_err(|error| error.to_string())
    }
}

impl Files for Revision {
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let path = join("", path)?;
        let found = git(&["cat-file", "blob", &format!("{}:{path}", self.commit)], Some(&self.top));
        found.map(Arc::from).map_err(|_| FileError::Missing)
    }

    fn record(&self) -> Vec<FileRecord> {
        Vec::new()
    }
}

/// What git prints.
fn git(arguments: &[&str], folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let mut command = Command::new("git");
    command.args(arguments);
    if let Some(folder) = folder {
        command.current_dir(folder);
    }
    let done = command.output().map_err(|error| format!("git cannot be run: {}", reason(&error)))?;
    if done.status.success() {
        return Ok(done.stdout);
    }
    Err(String::from_utf8_lossy(&done.stderr).trim().to_owned())
}
