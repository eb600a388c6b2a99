//! What was baked before, under the content of all that went into it.
//!
//! The key of a document names the compiler, the document's path and all options. Its manifest lists sets of inputs, every
//! file that was asked for with the hash of its bytes or as missing, and for each set what came of it: a record. Records
//! and outputs are objects, stored under the hash of their bytes.
//!
//! Below that, realized shapes stand under the hash of all that they depend on: a document whose materials alone changed cuts no
//! surface again.
//!
//! Promise: what is found is what a bake would give. Every object is hashed before it is used; what is broken, cut off or
//! gone counts as not found and is made again. Any number of processes may use one folder, and be killed at any moment:
//! files appear whole or not at all. A folder that cannot be written costs its use and nothing else. Not promised: that a
//! file is read again whose size, times and number the system reports as they were; a change that keeps all of them is not
//! seen.

#[cfg(feature = "remote")]
mod credentials;
mod far;
mod frame;
mod manifest;
mod memory;
mod recent;
mod record;
#[cfg(feature = "remote")]
mod remote;
mod stamp;
mod store;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use blake3::Hash;

use crate::language::source::{DiskFiles, FileRecord, Files as _};
pub use far::RemoteOptions;
use far::{Far, Place, far};
use manifest::{Input, Manifest};
pub use memory::Memory;
use recent::{Last, Recent};
pub use record::{Baked, OutputFile, Record};
use stamp::Stamps;
use store::{Kind, Store, seal, sealed};
pub use store::{Stats, Verified};

/// What a document is baked with; equal keys with equal inputs give equal outputs.
#[derive(Clone, Debug)]
pub struct Key(Hash);

/// The hash of the program that runs: another build is another compiler. One that was not touched is not read again.
fn compiler(stamps: &Stamps) -> Hash {
    let own = std::env::current_exe().ok();
    let hash = |path: &Path| Some(blake3::hash(&std::fs::read(path).ok()?));
    let known = own.and_then(|path| stamps.hash(&path, || hash(&path)));
    known.unwrap_or_else(|| blake3::hash(env!("CARGO_PKG_VERSION").as_bytes()))
}

/// A folder of what was baked. One for all threads.
#[derive(Debug)]
pub struct Cache {
    store: Store,
    stamps: Stamps,
    recent: Recent,
    compiler: Hash,
    /// The first trouble with writing; the rest would be the same.
    trouble: Mutex<Option<String>>,
    /// Realized shapes that were found, and that were kept.
    shapes: [AtomicUsize; 2],
    /// One that machines share.
    far: Option<Box<dyn Far>>,
}

/// What is known of a document.
#[derive(Clone, Debug)]
pub struct Hit {
    /// What came of it.
    pub record: Record,
    /// The paths from the root of all files that it was made of.
    pub inputs: Vec<String>,
}

impl Cache {
    /// The cache in a folder, which is made where it is missing; `limit` is how many bytes it may take.
    ///
    /// # Errors
    /// When the folder cannot be made, or holds other things.
    pub fn open(folder: &Path, limit: u64) -> std::io::Result<Self> {
        let store = Store::open(folder, limit)?;
        let stamps = Stamps::load(&store);
        let compiler = compiler(&stamps);
        let recent = Recent::load(&store);
        let (trouble, shapes) = (Mutex::default(), Default::default());
        Ok(Self { store, stamps, recent, compiler, trouble, shapes, far: None })
    }

    /// The same, which looks into a shared cache for what the folder does not have. What is found there comes into the folder.
    ///
    /// # Errors
    /// When the address is none, or this build has no shared caches; in words. No network is touched yet.
    pub fn with_remote(self, options: &RemoteOptions) -> Result<Self, String> {
        Ok(Self { far: Some(far(options)?), ..self })
    }

    /// The key of this compiler and the parts in their order.
    #[must_use]
    pub fn key<'a>(&self, parts: impl IntoIterator<Item = &'a str>) -> Key {
        let mut hasher = blake3::Hasher::new();
        hasher.update(self.compiler.as_bytes());
        for part in parts {
            // Lengths keep `ab` + `c` apart from `a` + `bc`.
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part.as_bytes());
        }
        Key(hasher.finalize())
    }

    /// What came of a document when all its inputs were as they are now.
    #[must_use]
    pub fn find(&self, key: &Key, root: &Path) -> Option<Hit> {
        let read = |path: &str| DiskFiles::new(root).ok()?.read(path).ok();
        let same = |path: &str, hash: Option<Hash>| {
            let found = self.stamps.hash(&root.join(path), || read(path).map(|bytes| blake3::hash(&bytes)));
            found == hash
        };
        if let Some(last) = self.recent.find(&key.0)
            && last.inputs.iter().all(|input| same(&input.path, input.hash))
            && let Ok(record) = serde_json::from_slice(&last.text)
        {
            let inputs = present(&last.inputs);
            if !last.was_noted() {
                self.store.touch(Kind::Manifest, &key.0);
                self.store.touch(Kind::Object, &last.record);
                self.recent.add(&key.0, Last::new(last.inputs, last.record, last.text));
            }
            return Some(Hit { record, inputs });
        }
        let mut manifest = Manifest::read(&self.store, &key.0);
        if manifest.find(same).is_none()
            && let Some(shared) = self.far_entry(&key.0)
        {
            manifest.adopt(Manifest::of(Some(shared)));
            self.note(manifest.write(&self.store, &key.0));
        }
        let entry = manifest.find(same)?;
        let bytes = self.object(&entry.record)?;
        let record = serde_json::from_slice(&bytes).ok()?;
        self.store.touch(Kind::Manifest, &key.0);
        self.recent.add(&key.0, Last::new(entry.inputs.clone(), entry.record, bytes));
        Some(Hit { record, inputs: present(&entry.inputs) })
    }

    /// The bytes of an output, whole and unbroken.
    #[must_use]
    pub fn bytes(&self, file: &OutputFile) -> Option<Vec<u8>> {
        self.object(&Hash::from_hex(&file.hash).ok()?)
    }

    /// An object of the folder, or of the shared cache.
    fn object(&self, hash: &Hash) -> Option<Vec<u8>> {
        self.store.object(hash).or_else(|| {
            let far = self.far.as_ref()?;
            let bytes = far.get(Place::Object, hash)?;
            if blake3::hash(&bytes) != *hash {
                far.is_broken();
                return None;
            }
            self.note(self.store.put(&bytes).map(drop));
            Some(bytes)
        })
    }

    /// What the shared cache has under a key.
    fn far_entry(&self, key: &Hash) -> Option<Vec<u8>> {
        let far = self.far.as_ref()?;
        let bytes = sealed(key, far.get(Place::Entry, key)?);
        if bytes.is_none() {
            far.is_broken();
        }
        bytes
    }

    /// Whether a file on disk holds what an output is.
    #[must_use]
    pub fn is_there(&self, path: &Path, file: &OutputFile) -> bool {
        let found = self.stamps.hash(path, || std::fs::read(path).ok().map(|bytes| blake3::hash(&bytes)));
        found.is_some_and(|found| Hash::from_hex(&file.hash).is_ok_and(|hash| hash == found))
    }

    /// Keeps what came of a document: `files` are the bytes of the record's outputs, `read` what was asked for meanwhile.
    /// A file that was read twice with different bytes leaves nothing to keep.
    pub fn keep(&self, key: &Key, read: &[FileRecord], record: &Record, files: &[&[u8]]) {
        if read.iter().any(|file| file.found && file.hash.is_none()) {
            return;
        }
        self.note(self.write(key, read, record, files));
    }

    /// A realized shape under what it depends on, whole and unbroken.
    #[must_use]
    pub fn shape(&self, key: &Hash) -> Option<Vec<u8>> {
        let key = self.of_compiler(key);
        let bytes = match self.store.entry(Kind::Shape, &key) {
            Some(bytes) => {
                self.store.touch(Kind::Shape, &key);
                bytes
            }
            None => {
                let bytes = self.far_entry(&key)?;
                self.note(self.store.put_entry(Kind::Shape, &key, &bytes));
                bytes
            }
        };
        self.shapes[0].fetch_add(1, Ordering::Relaxed);
        Some(bytes)
    }

    /// Keeps a realized shape under what it depends on.
    pub fn keep_shape(&self, key: &Hash, bytes: &[u8]) {
        let key = self.of_compiler(key);
        self.shapes[1].fetch_add(1, Ordering::Relaxed);
        self.note(self.store.put_entry(Kind::Shape, &key, bytes));
        if let Some(far) = &self.far {
            far.put(Place::Entry, &key, &seal(&key, bytes));
        }
    }

    /// What a person should know of the shared cache, each once.
    #[must_use]
    pub fn remote_troubles(&self) -> Vec<String> {
        self.far.as_ref().map(|far| far.troubles()).unwrap_or_default()
    }

    /// How many realized shapes were found, and how many were made and kept.
    #[must_use]
    pub fn shape_counts(&self) -> [usize; 2] {
        [0, 1].map(|which| self.shapes[which].load(Ordering::Relaxed))
    }

    fn of_compiler(&self, key: &Hash) -> Hash {
        blake3::keyed_hash(self.compiler.as_bytes(), key.as_bytes())
    }

    fn note(&self, result: std::io::Result<()>) {
        if let Err(error) = result {
            let mut trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner);
            trouble.get_or_insert(error.to_string());
        }
    }

    fn write(&self, key: &Key, read: &[FileRecord], record: &Record, files: &[&[u8]]) -> std::io::Result<()> {
        for bytes in files {
            self.store.put(bytes)?;
        }
        let text = serde_json::to_vec(record)?;
        let hash = self.store.put(&text)?;
        // What another process wrote meanwhile can be lost here; it would then be baked once more.
        let mut manifest = Manifest::read(&self.store, &key.0);
        manifest.add(read, hash);
        manifest.write(&self.store, &key.0)?;
        if let Some(newest) = manifest.newest() {
            self.recent.add(&key.0, Last::new(newest.inputs.clone(), hash, text.clone()));
        }
        if let Some(far) = &self.far {
            files.iter().for_each(|bytes| far.put(Place::Object, &blake3::hash(bytes), bytes));
            far.put(Place::Object, &hash, &text);
            far.put(Place::Entry, &key.0, &seal(&key.0, &manifest.text()?));
        }
        Ok(())
    }

    /// Ends a run: notes what files looked like, and takes away what was not used for the longest time where the limit is
    /// passed. What went wrong with the folder, if anything did.
    #[must_use]
    pub fn finish(&self) -> Option<String> {
        let saved = self.stamps.save(&self.store).and_then(|()| self.recent.save(&self.store));
        let ended = saved.and_then(|()| self.store.trim());
        let mut trouble = self.trouble.lock().unwrap_or_else(PoisonError::into_inner);
        if let Err(error) = ended {
            trouble.get_or_insert(error.to_string());
        }
        trouble.take()
    }
}

/// The paths of files that there were.
fn present(inputs: &[Input]) -> Vec<String> {
    inputs.iter().filter(|input| input.hash.is_some()).map(|input| input.path.clone()).collect()
}

/// How much a cache holds.
///
/// # Errors
/// When there is none in the folder, or it cannot be read.
pub fn stats(folder: &Path) -> std::io::Result<Stats> {
    Store::existing(folder)?.stats()
}

/// Takes everything out of a cache.
///
/// # Errors
/// When there is none in the folder, or it cannot be emptied.
pub fn clear(folder: &Path) -> std::io::Result<Stats> {
    Store::existing(folder)?.clear()
}

/// Hashes everything in a cache, and takes out what is broken.
///
/// # Errors
/// When there is none in the folder, or it cannot be read.
pub fn verify(folder: &Path) -> std::io::Result<Verified> {
    Store::existing(folder)?.verify()
}
