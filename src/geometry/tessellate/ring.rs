//! Rings of vertices and the bands of triangles between them.

use crate::geometry::mesh::VertexIndex;

/// A row of vertices at even steps of angle. A pole is a row whose vertices share one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// First vertex.
    pub(super) base: u32,
    /// Number of steps.
    pub(super) steps: u32,
    /// How the vertices lie.
    pub(super) kind: RowKind,
}

/// How the vertices of a row lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowKind {
    /// `steps` + 1 vertices; the last closes the row, on the first point or on its own.
    Open,
    /// `steps` vertices; the row returns to the first.
    Round,
    /// One vertex.
    Pole,
    /// A pole with a vertex for each step of its neighbour.
    Fan,
}

impl Row {
    fn vertex(&self, k: u32) -> VertexIndex {
        VertexIndex(match self.kind {
            RowKind::Open | RowKind::Fan => self.base + k,
            RowKind::Round => self.base + k % self.steps,
            RowKind::Pole => self.base,
        })
    }
}

/// Fills the band between two rows, `upper` to the left of the way along `lower`, so that triangles turn
/// counter-clockwise seen from the side where angles grow to the right and `upper` is up.
///
/// Rows of different counts are zipped: with o the angle by which the lower end of the front is ahead and
/// d, e the steps below and above, the lower side advances while o + d is at most (d + e) / 2, so every
/// edge across the band spans at most (d + e) / 2. With equal counts this is the usual grid.
pub(super) fn stitch(lower: &Row, upper: &Row, triangles: &mut Vec<[VertexIndex; 3]>) {
    match (lower.kind, upper.kind) {
        (RowKind::Pole | RowKind::Fan, RowKind::Pole | RowKind::Fan) => {}
        (RowKind::Pole | RowKind::Fan, _) => {
            triangles
                .extend((0..upper.steps).map(|k| [lower.vertex(k), upper.vertex(k + 1), upper.vertex(k)]));
        }
        (_, RowKind::Pole | RowKind::Fan) => {
            triangles
                .extend((0..lower.steps).map(|k| [lower.vertex(k), lower.vertex(k + 1), upper.vertex(k)]));
        }
        _ => zip(lower, upper, triangles),
    }
}

fn zip(lower: &Row, upper: &Row, triangles: &mut Vec<[VertexIndex; 3]>) {
    if lower.steps == upper.steps {
        for k in 0..lower.steps {
            let (left, right) =
                ((lower.vertex(k), upper.vertex(k)), (lower.vertex(k + 1), upper.vertex(k + 1)));
            triangles.push([left.0, right.0, left.1]);
            triangles.push([right.0, right.1, left.1]);
        }
        return;
    }
    // Angles are counted in units of a turn / (lower steps * upper steps), so that all is exact.
    let (below, above) = (u64::from(upper.steps), u64::from(lower.steps));
    let (mut i, mut j) = (0, 0);
    while i < lower.steps || j < upper.steps {
        let (front_below, front_above) = (u64::from(i) * below, u64::from(j) * above);
        let advance_below = i < lower.steps
            && (j == upper.steps || 2 * (front_below + below) <= 2 * front_above + below + above);
        if advance_below {
            triangles.push([lower.vertex(i), lower.vertex(i + 1), upper.vertex(j)]);
            i += 1;
        } else {
            triangles.push([lower.vertex(i), upper.vertex(j + 1), upper.vertex(j)]);
            j += 1;
        }
    }
}

/// Number of triangles that [`stitch`] makes.
pub(super) fn count(lower_steps: u32, upper_steps: u32) -> u64 {
    u64::from(lower_steps) + u64::from(upper_steps)
}

#[cfg(test)]
mod tests {
    use super::{Row, RowKind, stitch};

    #[test]
    fn every_pair_of_counts_makes_a_closed_band_of_short_edges() {
        for below in 1..=24u32 {
            for above in 1..=24u32 {
                let lower = Row { base: 0, steps: below, kind: RowKind::Open };
                let upper = Row { base: 1000, steps: above, kind: RowKind::Open };
                let mut triangles = Vec::new();
                stitch(&lower, &upper, &mut triangles);
                assert_eq!(crate::geometry::mesh::index(triangles.len()), below + above);
                let angle = |vertex: u32| {
                    if vertex >= 1000 {
                        f64::from(vertex - 1000) / f64::from(above)
                    } else {
                        f64::from(vertex) / f64::from(below)
                    }
                };
                let reach = 0.5 / f64::from(below) + 0.5 / f64::from(above) + 1e-12;
                let mut across = std::collections::BTreeMap::new();
                for [a, b, c] in triangles.iter().map(|triangle| triangle.map(|vertex| vertex.0)) {
                    for (from, to) in [(a, b), (b, c), (c, a)] {
                        if (from >= 1000) != (to >= 1000) {
                            assert!((angle(from) - angle(to)).abs() <= reach, "{below} {above}");
                            *across.entry((from.min(to), from.max(to))).or_insert(0) +=
                                if from < to { 1 } else { -1 };
                        }
                    }
                }
                let open: Vec<_> =
                    across.iter().filter(|(_, uses)| **uses != 0).map(|(edge, _)| *edge).collect();
                assert_eq!(open, [(0, 1000), (below, 1000 + above)]);
            }
        }
    }
}
