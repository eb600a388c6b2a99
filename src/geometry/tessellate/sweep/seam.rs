//! How the section meets itself where a closed way ends.

use glam::DVec3;

use super::columns::Columns;
use super::rows::Row;
use crate::geometry::surface::Stand;

/// The columns of the first row that those of the last row are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Seam {
    /// The same.
    Same,
    /// So many columns further around.
    Shifted(usize),
    /// In reverse: half a turn of an open section.
    Reversed,
}

impl Seam {
    /// The column of the first row, of so many with the end.
    pub(super) fn column(self, column: usize, count: usize) -> usize {
        match self {
            Self::Same => column,
            Self::Shifted(by) => (column + by) % (count - 1),
            Self::Reversed => count - 1 - column,
        }
    }
}

/// How the last section lies on the first: the way in which its points come nearest, and whether it is the same,
/// column for column. A section that does not come back to itself exactly, such as a circle after any turn, lies
/// between columns.
pub(super) fn find(columns: &Columns, first: &Row, last: &Row) -> (Seam, bool) {
    let points = |row: &Row, stand: &Stand| -> Vec<DVec3> {
        columns.places(&stand.mix).into_iter().map(|place| row.point(stand, place)).collect()
    };
    let (start, end) = (points(first, &first.after), points(last, &last.before));
    let count = start.len();
    let size = start.iter().map(|point| point.distance(start[0])).fold(0.0, f64::max);
    let gap = |column: &dyn Fn(usize) -> usize| {
        (0..count).map(|k| end[k].distance(start[column(k)])).fold(0.0, f64::max)
    };
    if gap(&|k| k) <= 1e-7 * size {
        return (Seam::Same, true);
    }
    if !columns.closed {
        let reversed = |k: usize| count - 1 - k;
        return (if gap(&reversed) < gap(&|k| k) { Seam::Reversed } else { Seam::Same }, false);
    }
    // A column may have several near it, where the section comes close to itself: all near ones are tried.
    let distance = |k: usize| end[0].distance(start[k]);
    let nearest = (0..count).map(distance).fold(f64::INFINITY, f64::min);
    let near = (0..count).filter(|k| distance(*k) <= nearest + 0.05 * size);
    let shift = near.min_by(|a, b| gap(&|k| (k + a) % count).total_cmp(&gap(&|k| (k + b) % count)));
    match shift {
        Some(0) | None => (Seam::Same, false),
        Some(by) => (Seam::Shifted(by), false),
    }
}
