//! The one door to files: paths stay inside the project root, and what was read is recorded.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Reads files by their path from the project root, with `/` between its parts.
pub trait Files: Sync {
    /// The bytes of a file.
    ///
    /// # Errors
    /// When the path leaves the root, nothing stands there, or it cannot be read.
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError>;

    /// What was read so far, each path once, in the order of the paths.
    fn record(&self) -> Vec<FileRecord>;
}

/// A file that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRecord {
    /// The path from the root.
    pub path: String,
    /// Whether it could be read.
    pub found: bool,
    /// The hash of the bytes that were read; none also where they were not the same each time.
    pub hash: Option<blake3::Hash>,
}

/// Why a file could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// Nothing stands there.
    #[error("no such file")]
    Missing,
    /// The path is absolute.
    #[error("the path is absolute")]
    Absolute,
    /// The path, or a link on its way, leads out of the root.
    #[error("the path leads out of the project")]
    Outside,
    /// The path has parts that mean something on one system only.
    #[error("the path is not portable")]
    NotPortable,
    /// It is a folder.
    #[error("it is a folder")]
    Folder,
    /// It is larger than a file may be.
    #[error("it has {0} bytes, more than a file may have")]
    TooLarge(u64),
    /// The system says no.
    #[error("{0}")]
    Unreadable(String),
}

/// The largest file that is read, in bytes.
const LARGEST: u64 = 4 << 30;

impl FileError {
    /// The message of a diagnostic on the path as it is written.
    #[must_use]
    pub fn message(&self, written: &str) -> String {
        // A path may hold anything; a message is one line.
        let path = format!("\"{}\"", written.replace(char::is_control, "?"));
        match self {
            Self::Missing => format!("{path} does not exist"),
            Self::Absolute => format!("{path} is an absolute path"),
            Self::Outside => format!("{path} leads out of the project"),
            Self::NotPortable => format!("{path} is not a portable path"),
            Self::Folder => format!("{path} is a folder"),
            Self::TooLarge(bytes) => format!("{path} has {bytes} bytes, more than {LARGEST}"),
            Self::Unreadable(why) => format!("{path} cannot be read: {why}"),
        }
    }

    /// The label of a diagnostic under the path.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            Self::Missing => "not found",
            Self::Absolute => "write it relative to this document",
            Self::Outside => "must stay inside the project",
            Self::NotPortable => {
                "use `/` between parts, none of `\\ : * ? \" < > |`, and no name that Windows reserves"
            }
            Self::Folder => "expected a file",
            Self::TooLarge(_) => "too large",
            Self::Unreadable(_) => "cannot be read",
        }
    }
}

/// The path from the root that `written` means in the file `from`.
///
/// # Errors
/// When it is absolute, leads out of the root, or holds a backslash or a character that Windows refuses.
pub fn join(from: &str, written: &str) -> Result<String, FileError> {
    let drive = written.as_bytes().get(1) == Some(&b':') && written.as_bytes()[0].is_ascii_alphabetic();
    if written.starts_with(['/', '\\']) || drive {
        return Err(FileError::Absolute);
    }
    let portable = |c: char| !c.is_control() && !matches!(c, '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|');
    if !written.chars().all(portable) {
        return Err(FileError::NotPortable);
    }
    if written.split('/').any(is_special_on_windows) {
        return Err(FileError::NotPortable);
    }
    let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in written.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop().ok_or(FileError::Outside)?;
            }
            part => parts.push(part),
        }
    }
    if parts.is_empty() {
        return Err(FileError::Folder);
    }
    Ok(parts.join("/"))
}

/// Whether a part of a path names a device on Windows, or loses its end there.
fn is_special_on_windows(part: &str) -> bool {
    const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];
    let stem = part.split('.').next().unwrap_or_default().to_ascii_lowercase();
    let port = stem.strip_prefix("com").or(stem.strip_prefix("lpt"));
    let numbered = port.is_some_and(|digit| digit.len() == 1 && digit.as_bytes()[0].is_ascii_digit());
    let trimmed = !matches!(part, "." | "..") && part.ends_with(['.', ' ']);
    DEVICES.contains(&stem.as_str()) || numbered || trimmed
}

/// For each path the hash of what was read, if it could be; and whether it was the same each time.
#[derive(Debug, Default)]
struct Record(Mutex<BTreeMap<String, (Option<blake3::Hash>, bool)>>);

impl Record {
    fn add(&self, path: &str, read: Result<&[u8], &FileError>) {
        let hash = read.ok().map(blake3::hash);
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (known, same) = seen.entry(path.to_owned()).or_insert((hash, true));
        *same &= *known == hash;
        *known = known.or(hash);
    }

    fn list(&self) -> Vec<FileRecord> {
        let seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let record = |(path, (hash, same)): (&String, &(Option<blake3::Hash>, bool))| FileRecord {
            path: path.clone(),
            found: hash.is_some(),
            hash: hash.filter(|_| *same),
        };
        seen.iter().map(record).collect()
    }
}

/// The files of a folder on disk.
#[derive(Debug)]
pub struct DiskFiles {
    root: PathBuf,
    /// Whether links may lead out of the root.
    linked: bool,
    record: Record,
}

impl DiskFiles {
    /// The files under a root.
    ///
    /// # Errors
    /// When the root is no folder that can be reached.
    pub fn new(root: impl AsRef<Path>) -> io::Result<Self> {
        let root = root.as_ref().canonicalize()?;
        if !root.is_dir() {
            return Err(io::Error::new(io::ErrorKind::NotADirectory, "the project root is not a folder"));
        }
        Ok(Self { root, linked: false, record: Record::default() })
    }

    /// The same, where links may lead out of the root: for builds that lay out as links what may be read. Paths that are written in
    /// documents still lead nowhere else.
    ///
    /// # Errors
    /// When the root is no folder that can be reached.
    pub fn linked(root: impl AsRef<Path>) -> io::Result<Self> {
        Ok(Self { linked: true, ..Self::new(root)? })
    }

    /// The root, with all links followed.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    fn read_inside(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let path = join("", path)?;
        // Links are followed before the check, so that none leads out.
        let full = self.root.join(path).canonicalize().map_err(|error| file_error(&error))?;
        if !self.linked && !full.starts_with(&self.root) {
            return Err(FileError::Outside);
        }
        let facts = std::fs::metadata(&full).map_err(|error| file_error(&error))?;
        if facts.is_dir() {
            return Err(FileError::Folder);
        }
        if !facts.is_file() {
            return Err(FileError::Unreadable("it is not a regular file".to_owned()));
        }
        if facts.len() > LARGEST {
            return Err(FileError::TooLarge(facts.len()));
        }
        std::fs::read(&full).map(Arc::from).map_err(|error| file_error(&error))
    }
}

impl Files for DiskFiles {
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let bytes = self.read_inside(path);
        self.record.add(path, bytes.as_deref());
        bytes
    }

    fn record(&self) -> Vec<FileRecord> {
        self.record.list()
    }
}

/// Errors of the system in words that are the same on every system.
fn file_error(error: &io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => FileError::Missing,
        io::ErrorKind::PermissionDenied => FileError::Unreadable("permission denied".to_owned()),
        io::ErrorKind::IsADirectory => FileError::Folder,
        _ => FileError::Unreadable(error.to_string()),
    }
}

/// Files in memory.
#[derive(Debug, Default)]
pub struct MemoryFiles {
    files: BTreeMap<String, Arc<[u8]>>,
    record: Record,
}

impl MemoryFiles {
    /// No file.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file, or replaces it.
    #[must_use]
    pub fn with(mut self, path: impl Into<String>, bytes: impl AsRef<[u8]>) -> Self {
        self.files.insert(path.into(), Arc::from(bytes.as_ref()));
        self
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &str) -> Result<Arc<[u8]>, FileError> {
        let found = join("", path).and_then(|path| self.files.get(&path).cloned().ok_or(FileError::Missing));
        self.record.add(path, found.as_deref());
        found
    }

    fn record(&self) -> Vec<FileRecord> {
        self.record.list()
    }
}
