//! Parts of smooth surfaces inside given lines, into triangles within a tolerance.
//!
//! A region lies on a surface that plane coordinates (a [`Chart`]) cover once. Its lines are cut before, once for all
//! regions that share them; here the inside is filled. So regions never crack. Triangles are Delaunay in the plane of
//! the chart, and points are added where the surface is furthest from them until all are within the tolerance.
//!
//! Sources: L. P. Chew, Constrained Delaunay triangulations, Algorithmica 4 (1989); M. Garland, P. Heckbert, Fast
//! polygonal approximation of terrains and height fields, CMU-CS-95-181 (greedy insertion).

mod fill;
mod line;
mod section;

pub(super) use fill::{Chart, Fault, Filled, Judgment, NO_LINE, Outline, Place, Wanted, fill};
pub(super) use line::{Cut, Line, stations};
pub(super) use section::{Arc, PlaneSection};
