//! What a file may hold, for whom it is.

/// An output profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Profile {
    /// Floats; needs no extension. Every engine opens it.
    #[default]
    Core,
    /// Positions on one grid of 16 bits, normals and tangents in 8, texture coordinates in 16 where they lie in the unit
    /// square; needs `KHR_mesh_quantization`.
    Quantized,
    /// As quantized, on the coarsest grid that the tolerance allows, and compressed; needs `KHR_mesh_quantization` and
    /// `EXT_meshopt_compression`.
    Web,
}

impl Profile {
    /// All of them, by name.
    pub const NAMED: [(&'static str, Self); 3] =
        [("core", Self::Core), ("quantized", Self::Quantized), ("web", Self::Web)];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Core => "core",
            Self::Quantized => "quantized",
            Self::Web => "web",
        }
    }

    /// The profile of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(own, _)| *own == name).map(|(_, profile)| *profile)
    }

    /// Whether attributes are whole numbers.
    #[must_use]
    pub const fn is_quantized(self) -> bool {
        !matches!(self, Self::Core)
    }

    /// Whether buffer views are compressed.
    #[must_use]
    pub const fn is_compressed(self) -> bool {
        matches!(self, Self::Web)
    }
}
