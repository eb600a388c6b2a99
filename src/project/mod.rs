//! Documents on disk: which are meant, where their project begins, and how their outputs are written.
//!
//! Promise: a folder gives its documents in the order of their paths, whatever the file system; outputs appear whole or
//! not at all. No promise: nothing is printed here.

mod file;
mod save;
mod told;

use std::path::{Path, PathBuf};

use crate::language::source::{DiskFiles, Files};
use crate::language::spec::Limits;
use crate::language::{Document, PROJECT_FILE};
pub(crate) use file::{Project, ProjectFault};
pub(crate) use save::save;
pub(crate) use told::Told;

/// A document to work on.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    /// The project root.
    pub(crate) root: PathBuf,
    /// Path from the root, with `/` between its parts.
    pub(crate) path: String,
    /// Name of its outputs below the output folder, without ending: `chess/pawn`.
    pub(crate) output: String,
    /// Whether it was found in a folder: a library of materials is then passed over.
    pub(crate) found: bool,
    /// Whether links may lead out of the root.
    pub(crate) linked: bool,
    /// How much it may ask for.
    pub(crate) limits: Limits,
}

impl Task {
    /// Loads the document.
    pub(crate) fn load(
        &self,
    ) -> std::io::Result<(DiskFiles, Result<Document, crate::language::diagnostic::Diagnostics>)> {
        let files = if self.linked { DiskFiles::linked(&self.root) } else { DiskFiles::new(&self.root) }?;
        let document = Document::load_within(&self.path, &files as &dyn Files, self.limits);
        Ok((files, document))
    }

    /// The last part of the output name.
    pub(crate) fn name(&self) -> &str {
        self.output.rsplit('/').next().unwrap_or(&self.output)
    }
}

/// The documents of a path: itself, or those in it and in its folders.
pub(crate) fn collect(path: &Path, root: Option<&Path>) -> Result<Vec<Task>, String> {
    let explain = |error: std::io::Error| format!("{}: {}", path.display(), reason(&error));
    let real = path.canonicalize().map_err(explain)?;
    let root = match root {
        Some(root) => {
            root.canonicalize().map_err(|error| format!("{}: {}", root.display(), reason(&error)))?
        }
        None => default_root(&real)?,
    };
    below(path, &real, &root, false)
}

/// The same, with links left as they are: a file belongs to the root that it is named below, wherever it lies. The root is the
/// working directory where none is named.
#[cfg(feature = "cli")]
pub(crate) fn collect_linked(path: &Path, root: Option<&Path>) -> Result<Vec<Task>, String> {
    let explain = |path: &Path, error: std::io::Error| format!("{}: {}", path.display(), reason(&error));
    let absolute = |path: &Path| std::path::absolute(path).map_err(|error| explain(path, error));
    std::fs::metadata(path).map_err(|error| explain(path, error))?;
    let root = absolute(root.unwrap_or(Path::new(".")))?;
    below(path, &absolute(path)?, &root, true)
}

/// The documents of a place below a root.
fn below(path: &Path, place: &Path, root: &Path, linked: bool) -> Result<Vec<Task>, String> {
    if !place.starts_with(root) {
        return Err(format!("{} lies outside the project root {}", path.display(), root.display()));
    }
    let (folder, mut files) = if place.is_dir() {
        let mut files = Vec::new();
        walk(place, &mut files, 0).map_err(|error| format!("{}: {}", path.display(), reason(&error)))?;
        (place, files)
    } else {
        (place.parent().unwrap_or(place), vec![place.to_path_buf()])
    };
    files.sort();
    Ok(files
        .iter()
        .map(|file| {
            let below = file.strip_prefix(folder).unwrap_or(file);
            Task {
                root: root.to_path_buf(),
                path: slashes(file.strip_prefix(root).unwrap_or(file)),
                output: slashes(&below.with_extension("")),
                found: place.is_dir(),
                linked,
                limits: Limits::default(),
            }
        })
        .collect())
}

/// A path with `/` between its parts.
fn slashes(path: &Path) -> String {
    path.components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect::<Vec<_>>()
        .join("/")
}

/// The working directory where the document lies in it, else the document's own folder.
fn default_root(real: &Path) -> Result<PathBuf, String> {
    let own = if real.is_dir() { real } else { real.parent().unwrap_or(real) };
    match std::env::current_dir().and_then(|directory| directory.canonicalize()) {
        Ok(directory) if real.starts_with(&directory) => Ok(directory),
        _ => Ok(own.to_path_buf()),
    }
}

/// Folders deeper than this are not looked into. Links to folders are not followed: they may have no end.
const DEPTH: usize = 32;

fn walk(folder: &Path, files: &mut Vec<PathBuf>, depth: usize) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') || name == PROJECT_FILE {
            continue;
        }
        let kind = entry.file_type()?;
        if kind.is_dir() && depth < DEPTH {
            walk(&entry.path(), files, depth + 1)?;
        } else if name.ends_with(".toml") && (kind.is_file() || kind.is_symlink() && !entry.path().is_dir()) {
            // A link is taken too: where it leads out of the root, or to nothing, reading it says so.
            files.push(entry.path());
        }
    }
    Ok(())
}

/// The reason of a file error without the system's number.
pub(crate) fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "no such file or folder".to_owned(),
        std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    }
}
