//! Subdivision surfaces as recipes.

use super::ShapeHandle;
use crate::geometry::subdivide::{Crease, Scheme};

/// A cage and how it is refined.
#[derive(Clone, Debug, PartialEq)]
pub struct SubdivisionRecipe {
    /// The coarse shape.
    pub cage: ShapeHandle,
    /// The scheme.
    pub scheme: Scheme,
    /// How often; as often as the tolerance asks when it is not said.
    pub levels: Option<u32>,
    /// Whether vertices are put on the limit surface.
    pub limit: bool,
    /// Whether vertices of a border that belong to one face stay.
    pub border_corners: bool,
    /// Sharp edges.
    pub creases: Vec<Crease>,
    /// Sharp vertices.
    pub corners: Vec<(u32, f64)>,
    /// Whether faces are cut into triangles where the scheme wants that.
    pub triangulate: bool,
}
