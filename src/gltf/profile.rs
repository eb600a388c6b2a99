//! What a file may hold, for whom it is.

/// An output profile: for everyone, or for one engine.
///
/// Engines read what their loaders of autumn 2026 read: Bevy 0.20, Godot 4, Unreal 5 (Interchange), Unity (glTFast), three.js
/// r187, Babylon.js 9, Blender 4.5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Profile {
    /// Floats; needs no extension. Every engine opens it, but for Bevy where clips change materials, lights or cameras: its reader
    /// refuses such a file, and its own profile leaves that out.
    #[default]
    Core,
    /// Positions on one grid of 16 bits, normals and tangents in 8, texture coordinates in 16 where they lie in the unit
    /// square, colors in 8; needs `KHR_mesh_quantization`.
    Quantized,
    /// As quantized, on the coarsest grid that the tolerance allows, and compressed; needs `KHR_mesh_quantization` and
    /// `EXT_meshopt_compression`.
    Web,
    /// As core; closed meshes say which of their vertices are one, by `EXT_mesh_manifold`, which is not required.
    Verify,
    /// As core: Bevy refuses files that require an extension for whole numbers.
    Bevy,
    /// As core, for the same reason; bodies have the names that Godot makes bodies of.
    Godot,
    /// As core; bodies have the names that Unreal makes bodies of.
    Unreal,
    /// As quantized.
    Unity,
    /// As quantized.
    Three,
    /// As quantized.
    Babylon,
    /// As core, which older versions read too.
    Blender,
}

impl Profile {
    /// All of them, by name.
    pub const NAMED: [(&'static str, Self); 11] = [
        ("core", Self::Core),
        ("quantized", Self::Quantized),
        ("web", Self::Web),
        ("verify", Self::Verify),
        ("bevy", Self::Bevy),
        ("godot", Self::Godot),
        ("unreal", Self::Unreal),
        ("unity", Self::Unity),
        ("three", Self::Three),
        ("babylon", Self::Babylon),
        ("blender", Self::Blender),
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Core => "core",
            Self::Quantized => "quantized",
            Self::Web => "web",
            Self::Verify => "verify",
            Self::Bevy => "bevy",
            Self::Godot => "godot",
            Self::Unreal => "unreal",
            Self::Unity => "unity",
            Self::Three => "three",
            Self::Babylon => "babylon",
            Self::Blender => "blender",
        }
    }

    /// The profile of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(own, _)| *own == name).map(|(_, profile)| *profile)
    }

    /// The engine that it is for, as a person writes it.
    #[must_use]
    pub const fn engine(self) -> Option<&'static str> {
        Some(match self {
            Self::Core | Self::Quantized | Self::Web | Self::Verify => return None,
            Self::Bevy => "Bevy",
            Self::Godot => "Godot",
            Self::Unreal => "Unreal",
            Self::Unity => "Unity",
            Self::Three => "three.js",
            Self::Babylon => "Babylon.js",
            Self::Blender => "Blender",
        })
    }

    /// Whether attributes are whole numbers.
    #[must_use]
    pub const fn is_quantized(self) -> bool {
        matches!(self, Self::Quantized | Self::Web | Self::Unity | Self::Three | Self::Babylon)
    }

    /// Whether closed meshes say which of their vertices are one.
    #[must_use]
    pub const fn tells_manifolds(self) -> bool {
        matches!(self, Self::Verify)
    }

    /// Whether files say what changes of materials, lights and cameras: Bevy refuses those that do.
    #[must_use]
    pub const fn reads_properties(self) -> bool {
        !matches!(self, Self::Bevy)
    }

    /// Whether many copies of a mesh are drawn at once by `EXT_mesh_gpu_instancing`, which is then required: who does not read
    /// it would show one of them.
    #[must_use]
    pub const fn draws_instances(self) -> bool {
        matches!(self, Self::Web | Self::Unity | Self::Three | Self::Babylon | Self::Blender)
    }

    /// Whether buffer views are compressed.
    #[must_use]
    pub const fn is_compressed(self) -> bool {
        matches!(self, Self::Web)
    }
}
