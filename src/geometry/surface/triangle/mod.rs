//! Bezier triangles: patches over barycentric coordinates, by triangular nets of control points.
//!
//! Promise: what changes the form of a net (raising its degree, cutting it, bringing it to rows of equal length) does not
//! change the surface, and is made of convex combinations alone; so every patch lies in the hull of its net. As a surface over
//! two parameters a triangle is a Bezier patch with one side drawn together to corner 0, which is exact.
//!
//! Sources: G. Farin, Triangular Bernstein-Bezier patches, CAGD 3 (1986); P. de Casteljau, Formes a poles, 1985; M. Sabin,
//! The use of piecewise forms for the numerical representation of shape, 1977.

mod joint;
mod net;
#[cfg(test)]
mod tests;

pub use joint::{Coordinates, side_of, triangle_joints};
pub use net::TriangleNet;
