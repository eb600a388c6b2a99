//! A project on disk: its file, the documents of its roots, and where their outputs belong.
//!
//! Promise: every root that is wrong is told with its place in the file: one that is missing, holds no document, leads out of the
//! project through a link, or lies in another one; and two documents with one output. The order of documents is that of the roots,
//! then that of paths.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::{Task, collect, reason};
#[cfg(feature = "cli")]
use crate::language::PROJECT_FILE;
use crate::language::ProjectFile;
use crate::language::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::language::source::{DiskFiles, Span};
use crate::language::spec::{InnerPath, Sp};

/// A project that was read.
#[derive(Clone, Debug)]
pub(crate) struct Project {
    /// The folder of its file, with all links followed.
    pub(crate) root: PathBuf,
    /// What the file says.
    pub(crate) file: ProjectFile,
}

/// Why a project cannot be worked on.
#[derive(Debug)]
pub(crate) enum ProjectFault {
    /// The file is there and wrong.
    Wrong(Diagnostics),
    /// It cannot be reached.
    Unreachable(String),
}

impl Project {
    /// Reads a project file.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub(crate) fn load(file: &Path) -> Result<Self, ProjectFault> {
        let explain = |error: std::io::Error| {
            ProjectFault::Unreachable(format!("{}: {}", file.display(), reason(&error)))
        };
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let files = DiskFiles::new(folder).map_err(explain)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let root = files.root().to_path_buf();
        let file = ProjectFile::load(&name, &files).map_err(ProjectFault::Wrong)?;
        Ok(Self { root, file })
    }

    /// Where a path of the file leads.
    pub(crate) fn path(&self, path: &InnerPath) -> PathBuf {
        if path.resolved.is_empty() { self.root.clone() } else { self.root.join(&path.resolved) }
    }

    /// All documents.
    ///
    /// # Errors
    /// Every root that is wrong, and documents with one output.
    pub(crate) fn tasks(&self) -> Result<Vec<Task>, Diagnostics> {
        let mut found = Vec::new();
        let mut roots: Vec<(PathBuf, Span)> = Vec::new();
        let mut tasks: Vec<(Task, Span)> = Vec::new();
        for root in &self.file.project.roots {
            match self.root_of(root) {
                Ok((real, of_root)) => {
                    found.extend(overlapping(&roots, &real, root));
                    roots.push((real, root.span));
                    tasks.extend(of_root.into_iter().map(|task| (task, root.span)));
                }
                Err(report) => found.push(*report),
            }
        }
        if found.is_empty() {
            found.extend(same_output(&tasks));
        }
        if found.is_empty() {
            return Ok(tasks.into_iter().map(|(task, _)| self.within(task)).collect());
        }
        Err(self.file.diagnostics(found))
    }

    /// A document with the limits of the project.
    pub(crate) fn within(&self, task: Task) -> Task {
        Task { limits: self.file.project.limits(), ..task }
    }

    /// The documents of a root, and where it really lies.
    fn root_of(&self, root: &Sp<InnerPath>) -> Result<(PathBuf, Vec<Task>), Box<Diagnostic>> {
        let written = &root.value.written;
        let report = |code, message: String, label| {
            Err(Box::new(Diagnostic::error(code, message).at(root.span, label)))
        };
        let path = self.path(&root.value);
        let real = match path.canonicalize() {
            Ok(real) => real,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return report(Code::FileMissing, format!("\"{written}\" does not exist"), "not found");
            }
            Err(error) => {
                let message = format!("\"{written}\" cannot be read: {}", reason(&error));
                return report(Code::FileUnreadable, message, "cannot be read");
            }
        };
        if !real.starts_with(&self.root) {
            let message = format!("\"{written}\" leads out of the project");
            return report(Code::OutsideRoot, message, "must stay inside the project");
        }
        match collect(&real, Some(&self.root)) {
            Ok(tasks) if tasks.is_empty() => {
                report(Code::EmptyRoot, format!("no document (.toml) in \"{written}\""), "nothing to bake")
            }
            Ok(tasks) => Ok((real, tasks)),
            Err(message) => report(Code::FileUnreadable, message, "cannot be read"),
        }
    }
}

/// What commands ask of a project.
#[cfg(feature = "cli")]
impl Project {
    /// The project file in a folder or, where there is none, in the nearest folder above.
    pub(crate) fn above(folder: &Path) -> Option<PathBuf> {
        folder.ancestors().map(|folder| folder.join(PROJECT_FILE)).find(|file| file.is_file())
    }

    /// Where the file lies.
    pub(crate) fn place(&self) -> PathBuf {
        self.root.join(PROJECT_FILE)
    }

    /// Where outputs go.
    pub(crate) fn out(&self) -> PathBuf {
        self.file.project.out.as_ref().map_or_else(|| self.root.join("out"), |out| self.path(&out.value))
    }

    /// A document with the output that it has in the project, if it is one of the project.
    pub(crate) fn placed(&self, mut task: Task) -> Task {
        let real = task.root.join(&task.path);
        let roots =
            self.file.project.roots.iter().filter_map(|root| self.path(&root.value).canonicalize().ok());
        if let Some(below) = roots
            .filter(|root| *root != real)
            .find_map(|root| real.strip_prefix(root).ok().map(Path::to_path_buf))
        {
            task.output = super::slashes(&below.with_extension(""));
        }
        task
    }
}

/// A root that lies in another one, or holds it.
fn overlapping(before: &[(PathBuf, Span)], real: &Path, root: &Sp<InnerPath>) -> Option<Diagnostic> {
    let overlaps = |(other, _): &&(PathBuf, Span)| real.starts_with(other) || other.starts_with(real);
    let (other, span) = before.iter().find(overlaps)?;
    let (how, label) = match other.as_path() {
        other if other == real => ("is named twice", "and here"),
        other if real.starts_with(other) => ("lies in another root", "lies in the other one"),
        _ => ("holds another root", "holds the other one"),
    };
    let report = Diagnostic::error(Code::OverlappingRoots, format!("\"{}\" {how}", root.value.written));
    Some(report.at(root.span, label).also(*span, "the other one").help("leave one of them out"))
}

/// Two documents whose outputs would be one file.
fn same_output(tasks: &[(Task, Span)]) -> Option<Diagnostic> {
    let mut seen: BTreeMap<String, &(Task, Span)> = BTreeMap::new();
    for entry in tasks {
        let (task, span) = entry;
        // Some file systems do not tell upper case from lower.
        if let Some((other, first)) = seen.insert(task.output.to_lowercase(), entry) {
            let message =
                format!("{} and {} would both be written to {}.glb", other.path, task.path, task.output);
            let report = Diagnostic::error(Code::SameOutput, message).at(*span, "of this root");
            let report = if first == span { report } else { report.also(*first, "of this one too") };
            return Some(report.help("rename one of them, or move it to a folder of another name"));
        }
    }
    None
}
