//! The inputs of a document, and what came of each set of them.

use blake3::Hash;
use serde::{Deserialize, Serialize};

use super::store::{Kind, Store};
use crate::language::source::FileRecord;

/// Sets of inputs that are remembered: who goes back to what was there before finds it.
const MOST: usize = 8;

/// Sets of inputs with what came of them, the newest first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Manifest {
    entries: Vec<Entry>,
}

/// A set of inputs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) inputs: Vec<Input>,
    /// The record's object.
    #[serde(with = "hexadecimal")]
    pub(super) record: Hash,
}

/// A file that was asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Input {
    /// Path from the root.
    pub(super) path: String,
    /// The hash of its bytes; none where there was no such file.
    #[serde(with = "hexadecimal::optional")]
    pub(super) hash: Option<Hash>,
}

impl Manifest {
    pub(super) fn read(store: &Store, key: &Hash) -> Self {
        Self::of(store.entry(Kind::Manifest, key))
    }

    /// The manifest of some bytes; empty where they are none.
    pub(super) fn of(bytes: Option<Vec<u8>>) -> Self {
        bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
    }

    pub(super) fn text(&self) -> serde_json::Result<Vec<u8>> {
        serde_json::to_vec(self)
    }

    /// Adds the sets of another one behind its own.
    pub(super) fn adopt(&mut self, other: Self) {
        for entry in other.entries {
            if !self.entries.iter().any(|known| known.inputs == entry.inputs) {
                self.entries.push(entry);
            }
        }
        self.entries.truncate(MOST);
    }

    pub(super) fn write(&self, store: &Store, key: &Hash) -> std::io::Result<()> {
        store.put_entry(Kind::Manifest, key, &self.text()?)
    }

    /// The first set whose inputs are all the same.
    pub(super) fn find(&self, same: impl Fn(&str, Option<Hash>) -> bool) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.inputs.iter().all(|input| same(&input.path, input.hash)))
    }

    /// The set that was added last.
    pub(super) fn newest(&self) -> Option<&Entry> {
        self.entries.first()
    }

    /// Adds a set as the newest.
    pub(super) fn add(&mut self, read: &[FileRecord], record: Hash) {
        let inputs: Vec<Input> =
            read.iter().map(|file| Input { path: file.path.clone(), hash: file.hash }).collect();
        self.entries.retain(|entry| entry.inputs != inputs);
        self.entries.insert(0, Entry { inputs, record });
        self.entries.truncate(MOST);
    }
}

/// Hashes as hexadecimal text.
pub(super) mod hexadecimal {
    use blake3::Hash;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub(in crate::cache) fn serialize<S: Serializer>(hash: &Hash, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&hash.to_hex())
    }

    pub(in crate::cache) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Hash, D::Error> {
        let text = String::deserialize(deserializer)?;
        Hash::from_hex(text).map_err(D::Error::custom)
    }

    pub(in crate::cache) mod optional {
        use blake3::Hash;
        use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

        pub(in crate::cache) fn serialize<S: Serializer>(
            hash: &Option<Hash>,
            serializer: S,
        ) -> Result<S::Ok, S::Error> {
            hash.map(|hash| hash.to_hex().to_string()).serialize(serializer)
        }

        pub(in crate::cache) fn deserialize<'de, D: Deserializer<'de>>(
            deserializer: D,
        ) -> Result<Option<Hash>, D::Error> {
            let text = Option::<String>::deserialize(deserializer)?;
            text.map(|text| Hash::from_hex(text).map_err(D::Error::custom)).transpose()
        }
    }
}
