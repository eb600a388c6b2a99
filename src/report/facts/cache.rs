//! How well an index buffer uses a vertex cache.

use serde::Serialize;

use super::Corner;
use crate::geometry::mesh::cache::FifoCache;

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
    if indices.len() < 3 {
        return VertexCache::default();
    }
    let mut cache = FifoCache::new(vertices);
    let misses = indices.iter().filter(|index| cache.misses(index.vertex())).count();
    VertexCache {
        acmr: misses as f64 / (indices.len() / 3) as f64,
        atvr: misses as f64 / cache.used().max(1) as f64,
    }
}
