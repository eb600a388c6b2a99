//! What stands in for the solid library in a build without it: every operation says so.

use glam::DVec3;

use super::half::HalfSpace;
use super::parts::Solids;
use super::{Combination, Raw, SolidFault, Stock};

/// Triangles that enclose something.
#[derive(Clone, Debug)]
pub(super) struct Body;

pub(super) fn combine(_: &Stock, _: &Solids, _: &[u32], _: &Combination, _: f64) -> Result<Raw, SolidFault> {
    Err(SolidFault::Missing)
}

pub(super) fn hull(_: &[DVec3]) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), SolidFault> {
    Err(SolidFault::Missing)
}

pub(super) fn body(_: &Solids, _: f64) -> Result<Body, SolidFault> {
    Err(SolidFault::Missing)
}

impl Body {
    pub(super) fn dilated(&self, _: &[DVec3]) -> Result<Self, SolidFault> {
        Err(SolidFault::Missing)
    }

    pub(super) fn eroded(&self, _: &[DVec3]) -> Result<Self, SolidFault> {
        Err(SolidFault::Missing)
    }

    pub(super) fn halves(&self, _: &HalfSpace) -> Result<[Self; 2], SolidFault> {
        Err(SolidFault::Missing)
    }

    pub(super) fn components(&self) -> Vec<Self> {
        Vec::new()
    }

    pub(super) fn triangles(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        (Vec::new(), Vec::new())
    }
}
