//! Line drawings: what is seen of the edges of a stage, and what is hidden by how much.
//!
//! Promise: lines are those of the triangles (outlines, creases, rims, borders of materials) and the lines of the file
//! itself; each is cut exactly where a triangle begins or ceases to hide it, and knows how many hide it: A. Appel's
//! quantitative invisibility (The Notion of Quantitative Invisibility and the Machine Rendering of Solids, ACM National
//! Conference, 1967). Appel carries the number along contours, from crossing to crossing; here it is counted anew for each
//! edge, from the intervals of all triangles in front of it, so that open, touching and crossing surfaces are right too.
//! No promise: where triangles pierce each other without an edge, no line is drawn.
//!
//! Cost: edges, times the triangles over the cells of the picture that they cross.

mod feature;
mod hidden;
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
    let edges = feature::edges(stage, camera);
    let pieces = hidden::pieces(stage, camera, &edges);
    Drawing { traces: trace::traces(&pieces) }
}
