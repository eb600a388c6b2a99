//! What a shape gets from those that use it.

use glam::DAffine3;

use super::Level;
use super::shape::stretch;

/// What a shape gets from those that use it, as lengths in the space where it is placed.
#[derive(Clone, Copy)]
pub(super) struct Inherited {
    /// What they ask for, unless it asks for another itself.
    pub(super) tolerance: Option<f64>,
    /// What rounding to single precision will add.
    pub(super) rounding: f64,
    pub(super) uv: bool,
    /// Its least tolerance is in the space where the shape is placed, as the one asked for.
    pub(super) level: Level,
}

impl Inherited {
    /// Behind a map that stretches lengths.
    pub(super) fn within(self, map: &DAffine3) -> Self {
        let stretch = stretch(&map.matrix3);
        Self {
            tolerance: self.tolerance.map(|tolerance| tolerance / stretch),
            rounding: self.rounding / stretch,
            level: Level { least: self.level.least / stretch, ..self.level },
            ..self
        }
    }

    /// A tolerance that is a part of what is asked for.
    pub(super) fn share(self, tolerance: f64, part: f64) -> Self {
        let level = Level { least: self.level.least * part, ..self.level };
        Self { tolerance: Some(tolerance), level, ..self }
    }
}
