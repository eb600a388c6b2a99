//! How well an index buffer uses a vertex cache.

use serde::Serialize;

use super::Corner;

/// Vertices in the simulated cache: first in, first out, as in meshoptimizer's README.
pub const FIFO_SIZE: u32 = 16;

/// Figures of [`vertex_cache`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct VertexCache {
    /// Average cache miss ratio: vertices transformed for each triangle; 0 without triangles.
    pub acmr: f64,
    /// Average transformed vertex ratio: vertices transformed for each vertex used; 0 without triangles.
    pub atvr: f64,
}

/// Simulates the cache over an index buffer. Indices out of range of `vertices` count as misses. Linear.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "ratios of counts below 2^53")]
pub fn vertex_cache<I: Corner>(indices: &[I], vertices: usize) -> VertexCache {
    // The number of misses at which each vertex entered the cache, counted from FIFO_SIZE + 1; 0 for never. Counts
    // that wrap around would need 2^32 misses.
    let mut entered = vec![0_u32; vertices];
    let mut misses = 0_u64;
    let mut clock = FIFO_SIZE + 1;
    let mut used = 0_u64;
    for index in indices {
        let Some(entry) = entered.get_mut(index.vertex() as usize) else {
            misses += 1;
            continue;
        };
        if clock.wrapping_sub(*entry) > FIFO_SIZE {
            used += u64::from(*entry == 0);
            *entry = clock;
            clock = clock.wrapping_add(1);
            misses += 1;
        }
    }
    if indices.len() < 3 {
        return VertexCache::default();
    }
    VertexCache { acmr: misses as f64 / (indices.len() / 3) as f64, atvr: misses as f64 / used.max(1) as f64 }
}
