//! Line drawings: what is seen of the edges of a stage, and what is hidden by how much.
//!
//! Promise: lines are those of the triangles (outlines, creases, rims, borders of materials), those in which triangles run
//! through each other without an edge, and the lines of the file itself; each is cut exactly where a triangle begins or
//! ceases to hide it, and knows how many hide it: A. Appel's quantitative invisibility (The Notion of Quantitative
//! Invisibility and the Machine Rendering of Solids, ACM National Conference, 1967). Appel carries the number along
//! contours, from crossing to crossing; here it is counted anew for each edge, from the intervals of all triangles in front
//! of it, so that open, touching and crossing surfaces are right too.
//! No promise: surfaces that lie on each other, or cross at less than a degree, have no line there.
//!
//! Cost: edges, times the triangles over the cells of the picture that they cross.

mod feature;
mod hidden;
mod pierce;
mod trace;
mod write;

pub use feature::Kind;
pub use trace::Trace;
pub use write::{Ink, postscript, svg};

use super::camera::Camera;
use super::stage::Stage;

/// A stage as lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Lines, those that are hidden first: others are drawn over them.
    pub traces: Vec<Trace>,
}

/// Draws the lines of a stage.
#[must_use]
pub fn draw_lines(stage: &Stage, camera: &Camera) -> Drawing {
    let points = feature::points(stage);
    let mut edges = feature::edges(stage, camera, &points);
    edges.extend(pierce::edges(stage, camera, &points));
    let pieces = hidden::pieces(stage, camera, &edges);
    Drawing { traces: trace::traces(&pieces) }
}
