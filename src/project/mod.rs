//! Documents on disk: which are meant, where their project begins, and how their outputs are written.
//!
//! Promise: a folder gives its documents in the order of their paths, whatever the file system; outputs appear whole or
//! not at all. No promise: nothing is printed here.

mod file;
mod save;
mod told;

use std::path::{Path, PathBuf};

use crate::language::source::{DiskFiles, Files};
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
}

impl Task {
    /// Loads the document.
    pub(crate) fn load(
        &self,
    ) -> std::io::Result<(DiskFiles, Result<Document, crate::language::diagnostic::Diagnostics>)> {
        let files = DiskFiles::new(&self.root)?;
        let document = Document::load(&self.path, &files as &dyn Files);
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
    if !real.starts_with(&root) {
        return Err(format!("{} lies outside the project root {}", path.display(), root.display()));
    }
    let (folder, mut files) = if real.is_dir() {
        let mut files = Vec::new();
        walk(&real, &mut files, 0).map_err(explain)?;
        (real.clone(), files)
    } else {
        (real.parent().map_or_else(|| real.clone(), Path::to_path_buf), vec![real.clone()])
    };
    files.sort();
    Ok(files
        .iter()
        .map(|file| {
            let below = file.strip_prefix(&folder).unwrap_or(file);
            Task {
                root: root.clone(),
                path: slashes(file.strip_prefix(&root).unwrap_or(file)),
                output: slashes(&below.with_extension("")),
                found: real.is_dir(),
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
