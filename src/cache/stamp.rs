//! What files looked like when they were hashed, so that those that were not touched need not be read.
//!
//! A stamp is the size, both times and the number of a file as the system reports them. One that was changed in the last
//! moments before it was hashed gets none: a second change within the clock's grain would look the same. Source: the Git
//! project, Documentation/technical/racy-git.txt.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use blake3::Hash;

use super::frame::{In, Out};
use super::store::Store;

/// A file must not have been changed for this long before its hash is trusted.
const QUIET: Duration = Duration::from_secs(2);

/// Stamps that are kept at most; the rest are made again when they are needed.
const MOST: usize = 1 << 18;

/// What a file looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Look {
    size: u64,
    modified: [u64; 2],
    changed: [i64; 2],
    number: u64,
}

#[derive(Clone, Copy, Debug)]
struct Stamp {
    look: Look,
    hash: Hash,
}

/// The stamps of all files that were looked at.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    known: BTreeMap<PathBuf, Stamp>,
    new: Mutex<BTreeMap<PathBuf, Stamp>>,
}

impl Stamps {
    pub(super) fn load(store: &Store) -> Self {
        let bytes = store.named("stamps").unwrap_or_default();
        let mut from = In(&bytes);
        let known = std::iter::from_fn(|| Stamp::read(&mut from)).collect();
        Self { known, new: Mutex::default() }
    }

    /// The hash of a file that stands at a path; `read` hashes it where nothing is known. None where there is no such file.
    pub(super) fn hash(&self, path: &Path, read: impl FnOnce() -> Option<Hash>) -> Option<Hash> {
        let look = look(path);
        let stamp = self.known.get(path).filter(|stamp| Some(stamp.look) == look);
        if let Some(stamp) = stamp {
            return Some(stamp.hash);
        }
        let hash = read()?;
        // Only what looks the same after it was read was read whole.
        if let (Some(look), true) =
            (look, look.is_some_and(|look| look.is_quiet()) && look == self::look(path))
        {
            let mut new = self.new.lock().unwrap_or_else(PoisonError::into_inner);
            new.insert(path.to_path_buf(), Stamp { look, hash });
        }
        Some(hash)
    }

    pub(super) fn save(&self, store: &Store) -> std::io::Result<()> {
        let mut new = self.new.lock().unwrap_or_else(PoisonError::into_inner);
        if new.is_empty() {
            return Ok(());
        }
        // What another process noted meanwhile stays.
        let mut all = Self::load(store).known;
        all.append(&mut new);
        if all.len() > MOST {
            all.retain(|path, stamp| look(path) == Some(stamp.look));
        }
        let mut out = Out::default();
        all.iter().for_each(|(path, stamp)| stamp.write(path, &mut out));
        store.put_named("stamps", &out.0)
    }
}

impl Stamp {
    fn read(from: &mut In<'_>) -> Option<(PathBuf, Self)> {
        let path = PathBuf::from(from.text()?);
        let hash = from.hash()?;
        let mut numbers = [0; 6];
        for number in &mut numbers {
            *number = from.number()?;
        }
        let [size, seconds, nanoseconds, changed, changed_nanoseconds, number] = numbers;
        let changed = [changed, changed_nanoseconds].map(u64::cast_signed);
        Some((path, Self { look: Look { size, modified: [seconds, nanoseconds], changed, number }, hash }))
    }

    /// A path that is no text has no stamp, and is read each time.
    fn write(&self, path: &Path, out: &mut Out) {
        let Some(path) = path.to_str() else { return };
        let Look { size, modified, changed, number } = self.look;
        out.bytes(path.as_bytes());
        out.hash(&self.hash);
        let changed = changed.map(i64::cast_unsigned);
        for number in [size, modified[0], modified[1], changed[0], changed[1], number] {
            out.number(number);
        }
    }
}

impl Look {
    /// Whether the last change lies some time back. Times to come, of a clock that was set back, are none.
    fn is_quiet(&self) -> bool {
        let [seconds, nanos] = self.modified;
        let changed = u64::try_from(self.changed[0]).unwrap_or(0).max(seconds);
        let nanos = u32::try_from(nanos).unwrap_or(0);
        let last = UNIX_EPOCH + Duration::new(changed, nanos);
        SystemTime::now().duration_since(last).is_ok_and(|passed| passed > QUIET)
    }
}

fn look(path: &Path) -> Option<Look> {
    let facts = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    let modified = facts.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    let (changed, number) = system(&facts);
    let modified = [modified.as_secs(), u64::from(modified.subsec_nanos())];
    Some(Look { size: facts.len(), modified, changed, number })
}

/// The time of the last change of any kind, and the number of the file.
#[cfg(unix)]
fn system(facts: &std::fs::Metadata) -> ([i64; 2], u64) {
    use std::os::unix::fs::MetadataExt as _;
    ([facts.ctime(), facts.ctime_nsec()], facts.ino())
}

#[cfg(not(unix))]
fn system(_: &std::fs::Metadata) -> ([i64; 2], u64) {
    ([0; 2], 0)
}
