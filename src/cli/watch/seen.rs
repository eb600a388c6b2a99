//! Files of a project, with what was read of them noted.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::language::source::{DiskFiles, FileError, FileRecord, Files};

/// What stood in a file; none where it could not be read.
type Content = Option<blake3::Hash>;

/// The files of a project, and what stood in those that were read.
#[derive(Debug)]
pub(super) struct Seen {
    files: DiskFiles,
    read: Mutex<BTreeMap<String, Content>>,
}

impl Seen {
    /// The files under a root.
    pub(super) fn new(root: &Path) -> std::io::Result<Self> {
        Ok(Self { files: DiskFiles::new(root)?, read: Mutex::default() })
    }

    /// Whether any of the files that were read holds something else by now.
    pub(super) fn has_changed(&self) -> bool {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.iter().any(|(path, before)| content(&self.files.read(path)) != *before)
    }

    /// Where the files stand that were asked for, links followed and not.
    pub(super) fn paths(&self) -> Vec<PathBuf> {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let written = read.keys().map(|path| self.files.root().join(path));
        written.flat_map(|path| [path.canonicalize().ok(), Some(path)].into_iter().flatten()).collect()
    }
}

impl Files for Seen {
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let found = self.files.read(path);
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        // Of a file that is read twice the first content counts: if it changed between, it has changed.
        read.entry(path.to_owned()).or_insert_with(|| content(&found));
        found
    }

    fn record(&self) -> Vec<FileRecord> {
        self.files.record()
    }
}

fn content(found: &Result<Arc<[u8]>, FileError>) -> Content {
    found.as_ref().ok().map(|bytes| blake3::hash(bytes))
}

#[cfg(test)]
mod tests {
    use super::Seen;
    use crate::language::source::Files as _;

    #[test]
    fn what_was_read_has_changed_when_it_holds_something_else() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("a", "one");
        let seen = Seen::new(folder.path()).unwrap();
        assert!(seen.read("a").is_ok() && seen.read("b").is_err());
        assert!(!seen.has_changed());
        write("a", "one");
        write("other", "never read");
        assert!(!seen.has_changed(), "the same content, and a file that nothing reads");
        write("a", "two");
        assert!(seen.has_changed());
        write("a", "one");
        assert!(!seen.has_changed());
        write("b", "");
        assert!(seen.has_changed(), "a file that was missing stands there");
    }
}
