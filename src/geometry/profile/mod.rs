//! Operations on flat closed curves: sets of what they enclose, parallels, and rounded or cut corners.
//!
//! Promise: what is left of a curve is a part of that very curve, not an approximation: chords decide only what goes
//! where, and each crossing is found again on the curves themselves, to about 1e-12 of their size. Parallels of lines
//! and arcs of circles are lines and arcs; those of other curves are followed to 1e-9 of the size. Outlines of results
//! turn counter-clockwise, holes clockwise. Deterministic.
//!
//! Curves lie in z = 0 and do not cross themselves.

mod boolean;
mod chords;
mod corner;
mod offset;
mod span;
mod trace;

pub use boolean::combine;
pub use corner::{CornerFault, CornerShape, corners, cut_corners};
pub use offset::{OffsetCorner, offset};

use glam::DVec2;
use thiserror::Error;

use crate::geometry::tessellate::TessellateError;

/// Why an operation has no result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ProfileError {
    /// Too many chords would be needed to tell what goes where.
    #[error("the outlines are too intricate: {0}")]
    Intricate(#[from] TessellateError),
    /// Two outlines come so close that it cannot be told whether they cross.
    #[error("two outlines touch near [{}, {}] without clearly crossing there", .0.x, .0.y)]
    Touch(DVec2),
    /// The result is empty.
    #[error("nothing is left")]
    Nothing,
}

/// Most chords with which a curve is judged.
const CHORDS: u64 = 1 << 18;

/// Chords deviate by at most this part of the size of all curves.
const ROUGH: f64 = 2e-5;
