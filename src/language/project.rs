//! Project files: read, checked, and what can be said of them.
//!
//! Promise: every error of the file comes in one run, each with its place, as those of documents do. Nothing is looked up: whether
//! a folder is there is told by who uses it.

use std::sync::Arc;

use crate::language::diagnostic::{Diagnostic, Diagnostics};
use crate::language::document::single;
use crate::language::source::{Files, SourceMap, Span};
use crate::language::spec::{Project, read_whole};

/// The name of a project file.
pub(crate) const PROJECT_FILE: &str = "kiln.toml";

/// A project file that was read.
#[derive(Clone, Debug)]
pub(crate) struct ProjectFile {
    pub(crate) project: Project,
    sources: Arc<SourceMap>,
}

impl ProjectFile {
    /// Reads a project file; `path` is its path from the root of `files`.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub(crate) fn load(path: &str, files: &dyn Files) -> Result<Self, Diagnostics> {
        let (sources, table, mut found) = single(path, files);
        let start = sources.files().next().map_or(Span::NONE, |main| sources.span(main, 0..0));
        let mut project = None;
        if found.is_empty()
            && let Some(table) = table
        {
            let (read, more) = read_whole(table, start, &sources);
            project = read;
            found.extend(more);
        }
        let sources = Arc::new(sources);
        match project.filter(|_| found.is_empty()) {
            Some(project) => Ok(Self { project, sources }),
            None => Err(Diagnostics::new(found, sources)),
        }
    }

    /// What is wrong with places of this file.
    pub(crate) fn diagnostics(&self, list: Vec<Diagnostic>) -> Diagnostics {
        Diagnostics::new(list, Arc::clone(&self.sources))
    }

    /// The line of a place.
    #[cfg(feature = "cli")]
    pub(crate) fn line(&self, span: Span) -> usize {
        self.sources.locate(span).map_or(1, |place| place.line)
    }
}
