//! What it took to make the shapes of a model.
//!
//! Promise: times and sizes are those of this run; a shape that others are made from counts in their times too. Not promised:
//! that they are the same in the next run, so nothing that is written depends on them.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// What it took to make shapes, by their names. One for all threads.
#[derive(Debug, Default)]
pub struct WorkLog(Mutex<BTreeMap<String, ShapeWork>>);

/// What it took to make a shape at the finest level, as often as it was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShapeWork {
    /// How long that took together, what it is made from included.
    pub time: Duration,
    /// Bytes of its triangles in memory, of the largest where it was made in several ways.
    pub bytes: usize,
    /// Its triangles, of the most.
    pub triangles: usize,
    /// Where it came from; of several the last one that stands in the order of [`Origin`].
    pub origin: Origin,
}

/// Where a shape came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// It was kept from before.
    Found,
    /// It was made, and is kept now.
    Kept,
    /// It was made, and is not kept: there is nowhere to keep it, or it is quicker made than read.
    Made,
}

impl WorkLog {
    /// Notes that a shape was made or found once more.
    pub(super) fn add(&self, name: &str, work: ShapeWork) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(known) = all.get_mut(name) else {
            all.insert(name.to_owned(), work);
            return;
        };
        *known = ShapeWork {
            time: known.time + work.time,
            bytes: known.bytes.max(work.bytes),
            triangles: known.triangles.max(work.triangles),
            origin: known.origin.max(work.origin),
        };
    }

    /// What is known of a shape.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<ShapeWork> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(name).copied()
    }
}
