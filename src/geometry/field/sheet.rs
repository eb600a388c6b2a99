//! Surfaces of fields as they are drawn and measured without triangles: where one field is zero, as far as others are
//! negative.

use super::AnyField;
use crate::geometry::number::Bounds;

/// Where a field is zero inside of others.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The field; its slope points outward.
    pub field: AnyField,
    /// Points where one of these is positive do not belong to it.
    pub inside: Vec<AnyField>,
    /// A box around it.
    pub bounds: Bounds,
}

impl Sheet {
    /// All of the surface of a field in a box that it does not leave.
    #[must_use]
    pub fn whole(field: AnyField, bounds: Bounds) -> Self {
        Self { field, inside: Vec::new(), bounds }
    }
}
