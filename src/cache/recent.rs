//! What came of documents the last time, in one file: a run in which nothing changed opens no other.
//!
//! An entry holds the inputs of a document and what came of it, as its manifest and its record do, which stay what counts: an
//! entry that is gone costs their reading and nothing else. What is found here was used all the same, and has to look so to
//! [`Store::trim`](super::store::Store::trim); that is noted once an hour.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use blake3::Hash;

use super::frame::{In, Out};
use super::manifest::Input;
use super::store::Store;

/// Seconds after which it is noted anew that something was used.
const LATELY: u64 = 3600;

/// Entries that are kept at most; of more the longest unused ones go.
const MOST: usize = 1 << 16;

/// What came of a document.
#[derive(Clone, Debug)]
pub(super) struct Last {
    /// When it was noted that it was used, in seconds of the system.
    noted: u64,
    pub(super) inputs: Vec<Input>,
    /// The hash of the record, and the record.
    pub(super) record: Hash,
    pub(super) text: Vec<u8>,
}

/// What came of documents, by their keys.
#[derive(Debug, Default)]
pub(super) struct Recent {
    bytes: Vec<u8>,
    /// Where each entry begins.
    places: BTreeMap<[u8; blake3::OUT_LEN], usize>,
    new: Mutex<BTreeMap<[u8; blake3::OUT_LEN], Last>>,
}

impl Last {
    pub(super) fn new(inputs: Vec<Input>, record: Hash, text: Vec<u8>) -> Self {
        Self { noted: now(), inputs, record, text }
    }

    /// Whether it was noted lately that it was used. A time to come, of a clock that was set back, is none.
    pub(super) fn was_noted(&self) -> bool {
        now().checked_sub(self.noted).is_some_and(|passed| passed < LATELY)
    }

    fn read(from: &mut In<'_>) -> Option<Self> {
        let noted = from.number()?;
        let record = from.hash()?;
        let text = from.bytes()?.to_vec();
        let count = from.number()?;
        let mut inputs = Vec::new();
        for _ in 0..count {
            let path = from.text()?.to_owned();
            let hash = if from.number()? == 0 { None } else { Some(from.hash()?) };
            inputs.push(Input { path, hash });
        }
        Some(Self { noted, inputs, record, text })
    }

    fn write(&self, out: &mut Out) {
        out.number(self.noted);
        out.hash(&self.record);
        out.bytes(&self.text);
        out.number(self.inputs.len() as u64);
        for input in &self.inputs {
            out.bytes(input.path.as_bytes());
            out.number(u64::from(input.hash.is_some()));
            input.hash.iter().for_each(|hash| out.hash(hash));
        }
    }
}

impl Recent {
    pub(super) fn load(store: &Store) -> Self {
        let bytes = store.named("recent").unwrap_or_default();
        let mut from = In(&bytes);
        let mut places = BTreeMap::new();
        // Each entry stands behind its key and its length, so that none is read that is not asked for.
        while let Some(key) = from.hash() {
            let place = bytes.len() - from.0.len();
            if from.bytes().is_none() {
                break;
            }
            places.insert(*key.as_bytes(), place);
        }
        Self { bytes, places, new: Mutex::default() }
    }

    pub(super) fn find(&self, key: &Hash) -> Option<Last> {
        let mut from = In(self.bytes.get(*self.places.get(key.as_bytes())?..)?);
        Last::read(&mut In(from.bytes()?))
    }

    pub(super) fn add(&self, key: &Hash, last: Last) {
        let mut new = self.new.lock().unwrap_or_else(PoisonError::into_inner);
        new.insert(*key.as_bytes(), last);
    }

    pub(super) fn save(&self, store: &Store) -> std::io::Result<()> {
        let mut new = self.new.lock().unwrap_or_else(PoisonError::into_inner);
        if new.is_empty() {
            return Ok(());
        }
        // What another process noted meanwhile stays.
        let known = Self::load(store);
        let all = known.places.keys().filter_map(|key| Some((*key, known.find(&Hash::from_bytes(*key))?)));
        let mut all: BTreeMap<_, Last> = all.collect();
        all.append(&mut new);
        if all.len() > MOST {
            let mut times: Vec<u64> = all.values().map(|last| last.noted).collect();
            times.sort_unstable();
            let oldest = times[times.len() - MOST / 2];
            all.retain(|_, last| last.noted >= oldest);
        }
        let mut out = Out::default();
        for (key, last) in &all {
            let mut entry = Out::default();
            last.write(&mut entry);
            out.hash(&Hash::from_bytes(*key));
            out.bytes(&entry.0);
        }
        store.put_named("recent", &out.0)
    }
}

fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |passed| passed.as_secs())
}

#[cfg(test)]
mod tests {
    use super::{Last, Recent};
    use crate::cache::manifest::Input;
    use crate::cache::store::Store;

    #[test]
    fn what_is_saved_is_found_and_what_others_saved_stays() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("cache"), 1 << 20).unwrap();
        let key = |name: &str| blake3::hash(name.as_bytes());
        let last = |name: &str| {
            let inputs = [("a.toml", Some(key("text"))), ("b.toml", None)];
            let inputs = inputs.map(|(path, hash)| Input { path: path.to_owned(), hash }).to_vec();
            Last::new(inputs, key("record"), name.as_bytes().to_vec())
        };
        let (one, other) = (Recent::load(&store), Recent::load(&store));
        one.add(&key("one"), last("first"));
        one.save(&store).unwrap();
        other.add(&key("other"), last("second"));
        other.save(&store).unwrap();
        let all = Recent::load(&store);
        for (name, text) in [("one", "first"), ("other", "second")] {
            let found = all.find(&key(name)).unwrap();
            assert_eq!((found.text.as_slice(), found.inputs), (text.as_bytes(), last(text).inputs));
            assert!(all.find(&key(name)).unwrap().was_noted());
        }
        assert!(all.find(&key("none")).is_none());
        // A file that is cut off is none.
        let path = folder.path().join("cache").join("recent");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        assert!(Recent::load(&store).find(&key("one")).is_none());
    }

    #[test]
    fn a_use_is_noted_once_an_hour() {
        let mut last = Last::new(Vec::new(), blake3::hash(b""), Vec::new());
        assert!(last.was_noted());
        last.noted -= 3601;
        assert!(!last.was_noted());
        last.noted += 100_000;
        assert!(!last.was_noted(), "a clock that was set back");
    }
}
