//! Solids as recipes: other shapes and what is done with them.

use glam::DVec3;

use super::ShapeHandle;
use crate::geometry::solid::{Combination, HalfSpace};

/// Closed shapes and an operation on them.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidRecipe {
    /// The shapes, each once.
    pub parts: Vec<ShapeHandle>,
    /// What is done with them.
    pub operation: SolidOperation,
}

/// An operation on closed shapes.
#[derive(Clone, Debug, PartialEq)]
pub enum SolidOperation {
    /// Set operations; numbers are of the parts.
    Combine(Combination),
    /// One part, cut by a plane.
    Cut(PlaneCut),
    /// The convex body around all parts and these points.
    Hull(Vec<DVec3>),
    /// One part, grown by a ball of this radius, or shrunk by one where it is negative.
    Round(f64),
    /// One part, hollowed out.
    Shell(Hollow),
}

/// A cut by a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneCut {
    /// The side that its normal points to.
    pub above: HalfSpace,
    /// What stays.
    pub keep: KeptSide,
    /// Whether the cut is closed.
    pub cap: bool,
    /// How far both sides are moved apart.
    pub gap: f64,
}

/// What stays of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptSide {
    /// The side that the normal points to.
    Above,
    /// The other.
    Below,
    /// Both.
    Both,
}

/// A wall in place of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Hollow {
    /// Thickness of the wall, more than 0.
    pub thickness: f64,
    /// Whether the wall is in front of the surface.
    pub outside: bool,
    /// Planes of faces that the hollow goes through, looking out.
    pub open: Vec<HalfSpace>,
}

impl SolidRecipe {
    /// The parts of which something is left; what is taken away reaches no further.
    #[must_use]
    pub fn lasting(&self) -> Vec<ShapeHandle> {
        let SolidOperation::Combine(how) = &self.operation else { return self.parts.clone() };
        let mut numbers = Vec::new();
        lasting(how, &mut numbers);
        numbers.into_iter().map(|number| self.parts[number]).collect()
    }

    /// How far the surface stands beyond those of the parts, and how far moved parts go; less than 0 for shrunk ones.
    #[must_use]
    pub fn growth(&self) -> f64 {
        match &self.operation {
            SolidOperation::Round(radius) => *radius,
            SolidOperation::Shell(hollow) if hollow.outside => hollow.thickness,
            SolidOperation::Cut(cut) => cut.gap / 2.0,
            _ => 0.0,
        }
    }
}

fn lasting(how: &Combination, numbers: &mut Vec<usize>) {
    match how {
        Combination::Part(part) => numbers.push(*part),
        Combination::Union(all) => all.iter().for_each(|one| lasting(one, numbers)),
        // Nothing of an intersection reaches beyond the first.
        Combination::Intersection(all) => all.iter().take(1).for_each(|one| lasting(one, numbers)),
        Combination::Difference(first, _) => lasting(first, numbers),
    }
}
