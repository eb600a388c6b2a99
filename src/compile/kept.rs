//! Realized shapes in the folder of a cache, or in memory.

use blake3::Hash;

use crate::cache::{Cache, Memory};
use crate::realize::Keep;

impl Keep for Cache {
    fn find(&self, key: &Hash) -> Option<Vec<u8>> {
        self.shape(key)
    }

    fn keep(&self, key: &Hash, bytes: &[u8]) {
        self.keep_shape(key, bytes);
    }
}

impl Keep for Memory {
    fn find(&self, key: &Hash) -> Option<Vec<u8>> {
        Self::find(self, key)
    }

    fn keep(&self, key: &Hash, bytes: &[u8]) {
        Self::keep(self, key, bytes);
    }
}
