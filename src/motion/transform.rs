//! Scale, rotation and translation, as glTF composes them.

use glam::{DAffine3, DQuat, DVec3};

/// A place relative to a parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Applied last, metres.
    pub translation: DVec3,
    /// Applied second, of unit length.
    pub rotation: DQuat,
    /// Applied first.
    pub scale: DVec3,
}

impl Transform {
    /// No change.
    pub const IDENTITY: Self =
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    /// The map of points.
    #[must_use]
    pub fn map(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}
