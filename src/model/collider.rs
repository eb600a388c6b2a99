//! Bodies that stand for shapes.

use super::ShapeHandle;

/// A body that physics takes for a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// Its name.
    pub name: String,
    /// The shape.
    pub shape: ShapeHandle,
    /// The nodes that it belongs to, indices into [`Model::nodes`](super::Model::nodes).
    pub nodes: Vec<usize>,
    /// What body it is.
    pub fit: Fit,
    /// The most vertices of a hull.
    pub vertices: u32,
    /// The most convex parts.
    pub parts: u32,
    /// How far from convex parts may be, as part of the diagonal of the shape's box.
    pub concavity: f64,
}

/// What body stands for a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// The shape itself where it is a simple body, else its hull.
    Auto,
    /// A box.
    Box,
    /// A ball.
    Sphere,
    /// A capsule.
    Capsule,
    /// A cylinder.
    Cylinder,
    /// The hull.
    Hull,
    /// Hulls of parts.
    Parts,
}
