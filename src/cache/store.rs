//! The folder of a cache: objects under the hash of their bytes, manifests and realized shapes under their keys.
//!
//! Every file is written under another name first and then given its own, so that readers see it whole or not at all. What
//! stands under a key ends with a hash of it and of the key. The last use of a file is its time of modification.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::SystemTime;

use blake3::Hash;

use crate::project::save;

/// The file that marks a folder as a cache, for programs that make backups and for this one. Source: the Cache Directory
/// Tagging Specification, 2004.
const TAG: &str = "CACHEDIR.TAG";
const TAG_TEXT: &str = "Signature: 8a477f597d28d172789f06886806bc55\n# This folder is a cache of Kiln: https://bford.info/cachedir/\n";

/// Files beside the folders, each with its hash behind it.
const NAMED: [&str; 2] = ["stamps", "recent"];

/// What is left when a cache grew beyond its limit: so that not every run has to look at everything.
const KEPT: f64 = 0.8;

/// A cache's folder.
#[derive(Debug)]
pub(super) struct Store {
    folder: PathBuf,
    limit: u64,
    /// Whether something was added.
    grew: AtomicBool,
}

/// How much a cache holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Documents with their options.
    pub documents: u64,
    /// Records and outputs.
    pub objects: u64,
    /// Realized shapes.
    pub shapes: u64,
    /// Bytes of all of them.
    pub bytes: u64,
}

/// What a look at everything found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verified {
    /// What is whole.
    pub whole: Stats,
    /// Files that were broken, and were taken out.
    pub broken: u64,
}

/// The kinds of files: objects under the hash of their bytes, the others under a key.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Object,
    Manifest,
    Shape,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Object, Self::Manifest, Self::Shape];

    const fn folder(self) -> &'static str {
        match self {
            Self::Shape => "shapes",
            Self::Object => "objects",
            Self::Manifest => "manifests",
        }
    }
}

/// A file of the cache.
struct Kept {
    path: PathBuf,
    kind: Kind,
    bytes: u64,
    used: SystemTime,
}

impl Store {
    pub(super) fn open(folder: &Path, limit: u64) -> io::Result<Self> {
        let store = Self { folder: folder.to_path_buf(), limit, grew: AtomicBool::new(false) };
        if !store.is_tagged() {
            if folder.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
                let message = "it holds other things; name a new folder";
                return Err(io::Error::new(io::ErrorKind::AlreadyExists, message));
            }
            save(folder, &[(TAG, TAG_TEXT.as_bytes())])?;
        }
        Ok(store)
    }

    /// The cache in a folder that holds one.
    pub(super) fn existing(folder: &Path) -> io::Result<Self> {
        let store = Self { folder: folder.to_path_buf(), limit: u64::MAX, grew: AtomicBool::new(false) };
        if store.is_tagged() {
            return Ok(store);
        }
        Err(io::Error::new(io::ErrorKind::NotFound, "there is no cache"))
    }

    fn is_tagged(&self) -> bool {
        std::fs::read(self.folder.join(TAG)).is_ok_and(|bytes| bytes == TAG_TEXT.as_bytes())
    }

    fn place(&self, kind: Kind, hash: &Hash) -> (PathBuf, String) {
        let name = hash.to_hex().to_string();
        (self.folder.join(kind.folder()).join(&name[..2]), name)
    }

    /// An object, unless it is broken: then it is taken out.
    pub(super) fn object(&self, hash: &Hash) -> Option<Vec<u8>> {
        let (folder, name) = self.place(Kind::Object, hash);
        let path = folder.join(name);
        let bytes = std::fs::read(&path).ok()?;
        if blake3::hash(&bytes) != *hash {
            let _ = std::fs::remove_file(&path);
            return None;
        }
        used(&path);
        Some(bytes)
    }

    /// Stores an object.
    pub(super) fn put(&self, bytes: &[u8]) -> io::Result<Hash> {
        let hash = blake3::hash(bytes);
        let (folder, name) = self.place(Kind::Object, &hash);
        let path = folder.join(&name);
        // One of another length is broken, and replaced.
        if std::fs::metadata(&path).is_ok_and(|facts| facts.len() == bytes.len() as u64) {
            used(&path);
            return Ok(hash);
        }
        save(&folder, &[(&name, bytes)])?;
        self.grew.store(true, Ordering::Relaxed);
        Ok(hash)
    }

    /// What is kept under a key, unless it is broken.
    pub(super) fn entry(&self, kind: Kind, key: &Hash) -> Option<Vec<u8>> {
        let (folder, name) = self.place(kind, key);
        sealed(key, std::fs::read(folder.join(name)).ok()?)
    }

    /// Keeps something under a key.
    pub(super) fn put_entry(&self, kind: Kind, key: &Hash, bytes: &[u8]) -> io::Result<()> {
        let (folder, name) = self.place(kind, key);
        self.grew.store(true, Ordering::Relaxed);
        save(&folder, &[(&name, &seal(key, bytes))])
    }

    /// Notes that what is kept under a key was used.
    pub(super) fn touch(&self, kind: Kind, key: &Hash) {
        let (folder, name) = self.place(kind, key);
        used(&folder.join(name));
    }

    /// What is kept under a name of its own, unless it is broken.
    pub(super) fn named(&self, name: &str) -> Option<Vec<u8>> {
        sealed(&blake3::hash(name.as_bytes()), std::fs::read(self.folder.join(name)).ok()?)
    }

    /// Keeps something under a name of its own, one of [`NAMED`].
    pub(super) fn put_named(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        save(&self.folder, &[(name, &seal(&blake3::hash(name.as_bytes()), bytes))])
    }

    /// All files; those that vanish meanwhile are not counted.
    fn all(&self) -> io::Result<Vec<Kept>> {
        let mut all = Vec::new();
        for kind in Kind::ALL {
            let folders = match std::fs::read_dir(self.folder.join(kind.folder())) {
                Ok(folders) => folders,
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                Err(error) => return Err(error),
            };
            for folder in folders {
                let Ok(entries) = std::fs::read_dir(folder?.path()) else { continue };
                for entry in entries.flatten() {
                    let Ok(facts) = entry.metadata() else { continue };
                    let used = facts.modified().unwrap_or(SystemTime::UNIX_EPOCH);
                    all.push(Kept { path: entry.path(), kind, bytes: facts.len(), used });
                }
            }
        }
        Ok(all)
    }

    /// Takes out what was not used for the longest time, where the limit is passed.
    pub(super) fn trim(&self) -> io::Result<()> {
        if !self.grew.load(Ordering::Relaxed) {
            return Ok(());
        }
        let mut all = self.all()?;
        let mut total: u64 = all.iter().map(|kept| kept.bytes).sum();
        if total <= self.limit {
            return Ok(());
        }
        all.sort_by(|a, b| a.used.cmp(&b.used).then_with(|| a.path.cmp(&b.path)));
        for kept in all {
            if total as f64 <= self.limit as f64 * KEPT {
                break;
            }
            // Another process may have been quicker.
            let _ = std::fs::remove_file(&kept.path);
            total -= kept.bytes;
        }
        Ok(())
    }

    pub(super) fn stats(&self) -> io::Result<Stats> {
        Ok(count(&self.all()?))
    }

    pub(super) fn clear(&self) -> io::Result<Stats> {
        let before = self.stats()?;
        for kind in Kind::ALL {
            gone(std::fs::remove_dir_all(self.folder.join(kind.folder())))?;
        }
        for name in NAMED {
            gone(std::fs::remove_file(self.folder.join(name)))?;
        }
        Ok(before)
    }

    pub(super) fn verify(&self) -> io::Result<Verified> {
        let (whole, broken): (Vec<Kept>, Vec<Kept>) = self.all()?.into_iter().partition(Kept::is_whole);
        for kept in &broken {
            gone(std::fs::remove_file(&kept.path))?;
        }
        Ok(Verified { whole: count(&whole), broken: broken.len() as u64 })
    }
}

impl Kept {
    fn is_whole(&self) -> bool {
        let Ok(bytes) = std::fs::read(&self.path) else { return false };
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        match self.kind {
            Kind::Object => blake3::hash(&bytes).to_hex().as_str() == name,
            Kind::Manifest | Kind::Shape => {
                Hash::from_hex(name.as_bytes()).is_ok_and(|key| sealed(&key, bytes).is_some())
            }
        }
    }
}

fn count(all: &[Kept]) -> Stats {
    let of = |kind: Kind| all.iter().filter(|kept| kept.kind == kind).count() as u64;
    Stats {
        documents: of(Kind::Manifest),
        objects: of(Kind::Object),
        shapes: of(Kind::Shape),
        bytes: all.iter().map(|kept| kept.bytes).sum(),
    }
}

/// What is gone already need not be taken away.
fn gone(result: io::Result<()>) -> io::Result<()> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Notes that a file was used; where that cannot be written it only looks older than it is.
fn used(path: &Path) {
    let file = std::fs::File::options().append(true).open(path);
    let _ = file.and_then(|file| file.set_modified(SystemTime::now()));
}

/// What stands under a key, with a hash of both behind it.
pub(super) fn seal(key: &Hash, bytes: &[u8]) -> Vec<u8> {
    let hash = blake3::keyed_hash(key.as_bytes(), bytes).to_hex();
    [bytes, b"\n", hash.as_bytes()].concat()
}

/// What was sealed under a key; none where it is broken, or was sealed under another one.
pub(super) fn sealed(key: &Hash, mut bytes: Vec<u8>) -> Option<Vec<u8>> {
    let length = bytes.len().checked_sub(2 * blake3::OUT_LEN + 1)?;
    let hash = blake3::keyed_hash(key.as_bytes(), &bytes[..length]).to_hex();
    if bytes[length] != b'\n' || &bytes[length + 1..] != hash.as_bytes() {
        return None;
    }
    bytes.truncate(length);
    Some(bytes)
}
