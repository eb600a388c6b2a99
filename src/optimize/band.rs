//! Triangles that come in rows, cut into bands that a cache of vertices holds.
//!
//! Most surfaces are made row by row. A row is longer than the cache, so that each of its vertices is transformed once
//! for the row below and once for the row above. Cut across, the pieces of neighboring rows that lie beside each other
//! share their vertices while they are still known. Where triangles do not come in rows nothing is gained, and nothing
//! lost: the order is as good or bad as it was.

use std::ops::Range;

use crate::geometry::mesh::VertexIndex;

/// Triangles of a row in a band: the 8 vertices on each side of them are together what the cache holds.
const WIDTH: usize = 14;

/// Rows of a cluster.
const ROWS: usize = 16;

/// Triangles in bands.
pub(super) struct Bands {
    pub(super) triangles: Vec<[VertexIndex; 3]>,
    /// Some rows of a band each, in order.
    pub(super) clusters: Vec<Range<usize>>,
}

/// Cuts rows into bands. O(triangles).
pub(super) fn bands(triangles: &[[VertexIndex; 3]]) -> Bands {
    let rows = rows(triangles);
    let mut made = Bands { triangles: Vec::with_capacity(triangles.len()), clusters: Vec::new() };
    for group in rows.chunk_by(|a, b| a.len() < 2 * b.len() && b.len() < 2 * a.len()) {
        let longest = group.iter().map(Range::len).max().unwrap_or(0);
        let count = longest.div_ceil(WIDTH);
        for band in 0..count {
            for some in group.chunks(ROWS) {
                let start = made.triangles.len();
                for row in some {
                    // Pieces of neighboring rows lie beside each other also where one row has more triangles.
                    let cut = |band: usize| row.start + band * row.len() / count;
                    made.triangles.extend_from_slice(&triangles[cut(band)..cut(band + 1)]);
                }
                if made.triangles.len() > start {
                    made.clusters.push(start..made.triangles.len());
                }
            }
        }
    }
    made
}

/// Rows: as far as each triangle goes on from the one before.
fn rows(triangles: &[[VertexIndex; 3]]) -> Vec<Range<usize>> {
    let mut rows = Vec::new();
    let mut start = 0;
    for at in 1..triangles.len() {
        if !goes_on(&triangles[start..at], triangles[at]) {
            rows.push(start..at);
            start = at;
        }
    }
    if !triangles.is_empty() {
        rows.push(start..triangles.len());
    }
    rows
}

/// Strips share an edge with the triangle before; quadrilaterals that are cut in two touch the one before that. A row
/// that closes touches the next in a single vertex.
fn goes_on(row: &[[VertexIndex; 3]], next: [VertexIndex; 3]) -> bool {
    let shared = |back: usize| {
        let before = row.len().checked_sub(back).map(|at| row[at]);
        before.map_or(0, |before| next.iter().filter(|vertex| before.contains(vertex)).count())
    };
    match shared(1) {
        0 => shared(2) > 0,
        1 => false,
        _ => true,
    }
}
