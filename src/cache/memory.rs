//! What was made before, kept in memory for as long as a program runs.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use blake3::Hash;

/// Bytes by their keys; those that were not asked for the longest time go first. One for all threads.
#[derive(Debug)]
pub struct Memory {
    limit: usize,
    kept: Mutex<Shelf>,
}

#[derive(Debug, Default)]
struct Shelf {
    bytes: usize,
    /// Counts what was asked for.
    turn: u64,
    by_key: BTreeMap<[u8; 32], (u64, Vec<u8>)>,
}

impl Memory {
    /// One that holds no more than a number of bytes.
    #[must_use]
    pub fn new(limit: usize) -> Self {
        Self { limit, kept: Mutex::default() }
    }

    /// The bytes under a key.
    #[must_use]
    pub fn find(&self, key: &Hash) -> Option<Vec<u8>> {
        let mut shelf = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        shelf.turn += 1;
        let turn = shelf.turn;
        let (used, bytes) = shelf.by_key.get_mut(key.as_bytes())?;
        *used = turn;
        Some(bytes.clone())
    }

    /// Keeps bytes under a key.
    pub fn keep(&self, key: &Hash, bytes: &[u8]) {
        if bytes.len() > self.limit {
            return;
        }
        let mut shelf = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        shelf.turn += 1;
        let entry = (shelf.turn, bytes.to_vec());
        shelf.bytes += bytes.len();
        if let Some((_, old)) = shelf.by_key.insert(*key.as_bytes(), entry) {
            shelf.bytes -= old.len();
        }
        while shelf.bytes > self.limit {
            let oldest = shelf.by_key.iter().min_by_key(|(_, (used, _))| *used).map(|(key, _)| *key);
            let Some((_, gone)) = oldest.and_then(|key| shelf.by_key.remove(&key)) else { break };
            shelf.bytes -= gone.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Memory;

    #[test]
    fn what_was_not_asked_for_the_longest_time_goes_first() {
        let memory = Memory::new(10);
        let key = |name: &str| blake3::hash(name.as_bytes());
        for name in ["a", "b"] {
            memory.keep(&key(name), &[1; 4]);
        }
        assert_eq!(memory.find(&key("a")), Some(vec![1; 4]));
        memory.keep(&key("c"), &[2; 5]);
        assert_eq!(memory.find(&key("b")), None);
        assert_eq!(memory.find(&key("a")), Some(vec![1; 4]));
        memory.keep(&key("c"), &[3; 6]);
        assert_eq!(memory.find(&key("c")), Some(vec![3; 6]));
        memory.keep(&key("d"), &[0; 11]);
        assert_eq!(memory.find(&key("d")), None, "it is larger than all");
    }
}
