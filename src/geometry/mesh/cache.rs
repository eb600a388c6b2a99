//! The model of a processor's vertex cache: first in, first out.
//!
//! Promise: the misses of any row of vertices, in constant time each. Source: the model of meshoptimizer's README; no
//! processor promises to be like it.

/// Vertices in the cache that orders are made and judged for.
pub const FIFO_SIZE: u32 = 16;

/// A cache of vertices: what came more than [`FIFO_SIZE`] misses ago is forgotten.
#[derive(Clone, Debug)]
pub struct FifoCache {
    /// The number of misses at which each vertex entered, counted from above the size; 0 for never. Counts that wrap
    /// around would need 2^32 misses.
    entered: Vec<u32>,
    clock: u32,
}

impl FifoCache {
    /// An empty cache for vertices below `vertices`. Four bytes a vertex.
    #[must_use]
    pub fn new(vertices: usize) -> Self {
        Self { entered: vec![0; vertices], clock: FIFO_SIZE + 1 }
    }

    /// Empties the cache.
    pub fn forget(&mut self) {
        self.clock = self.clock.wrapping_add(FIFO_SIZE + 1);
    }

    /// Whether a vertex is not in the cache; it then enters it. A vertex out of range always misses.
    pub fn misses(&mut self, vertex: u32) -> bool {
        let Some(entered) = self.entered.get_mut(vertex as usize) else { return true };
        let missed = self.clock.wrapping_sub(*entered) > FIFO_SIZE;
        if missed {
            *entered = self.clock;
            self.clock = self.clock.wrapping_add(1);
        }
        missed
    }

    /// How many corners of a triangle are not in the cache; they enter it.
    pub fn misses_of(&mut self, triangle: [u32; 3]) -> u32 {
        triangle.into_iter().map(|vertex| u32::from(self.misses(vertex))).sum()
    }

    /// How many of the vertices in range ever entered. Linear in all of them.
    #[must_use]
    pub fn used(&self) -> usize {
        self.entered.iter().filter(|entered| **entered > 0).count()
    }
}
