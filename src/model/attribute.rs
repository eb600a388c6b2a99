//! Attributes of vertices that games read themselves, as recipes.

use glam::{DAffine3, DVec2, DVec3};

use super::ShapeHandle;
use crate::geometry::formula::Formula;

/// Numbers at the vertices of a shape that nodes show.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Its name in the file, with its underscore.
    pub name: String,
    /// The shape.
    pub shape: ShapeHandle,
    /// For each component a formula of x, y, z, of the normal's nx, ny, nz, of u, v and of the weight of a joint.
    pub formulas: Vec<Formula>,
    /// From the metres of the file to the space that the formulas speak of.
    pub space: DAffine3,
    /// The joint of the shape's skeleton whose weight they speak of.
    pub joint: Option<usize>,
    /// Whether they speak of texture coordinates.
    pub wants_uv: bool,
    /// Whether its numbers are bytes of 0 to 1; floats if not.
    pub bytes: bool,
}

/// What stands at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// Its place, metres.
    pub place: DVec3,
    /// Its unit normal, or zero where there is none.
    pub normal: DVec3,
    /// Its texture coordinates.
    pub uv: DVec2,
    /// The weight of the joint.
    pub weight: f64,
}

impl Attribute {
    /// The components at a vertex; `None` where a formula has no value that single precision holds.
    #[must_use]
    pub fn at(&self, at: At) -> Option<Vec<f32>> {
        let normal = (self.space.matrix3.inverse().transpose() * at.normal).normalize_or_zero();
        let place = self.space.transform_point3(at.place);
        let variables =
            [place.x, place.y, place.z, normal.x, normal.y, normal.z, at.uv.x, at.uv.y, at.weight];
        let component = |formula: &Formula| {
            let [value] = formula.evaluate::<f64, 1>(&variables);
            let held = if self.bytes { value.clamp(0.0, 1.0) } else { value };
            // Zero has one form.
            let single = held.is_finite().then(|| crate::geometry::number::single(held) + 0.0)?;
            single.is_finite().then_some(single)
        };
        self.formulas.iter().map(component).collect()
    }
}
