//! Positions and indices as numbers, or as the bytes of a file where they stand.

/// The position of a vertex.
pub trait Position: Copy + Sync {
    /// Its coordinates.
    fn coordinates(self) -> [f32; 3];
}

impl Position for [f32; 3] {
    #[inline]
    fn coordinates(self) -> [f32; 3] {
        self
    }
}

/// Little-endian.
impl Position for [u8; 12] {
    #[inline]
    fn coordinates(self) -> [f32; 3] {
        let [a, b, c, d, e, f, g, h, i, j, k, l] = self;
        [f32::from_le_bytes([a, b, c, d]), f32::from_le_bytes([e, f, g, h]), f32::from_le_bytes([i, j, k, l])]
    }
}

/// An index: which vertex stands at a corner.
pub trait Corner: Copy + Sync {
    /// The vertex.
    fn vertex(self) -> u32;
}

impl Corner for u32 {
    #[inline]
    fn vertex(self) -> u32 {
        self
    }
}

/// Little-endian.
impl Corner for [u8; 2] {
    #[inline]
    fn vertex(self) -> u32 {
        u16::from_le_bytes(self).into()
    }
}

/// Little-endian.
impl Corner for [u8; 4] {
    #[inline]
    fn vertex(self) -> u32 {
        u32::from_le_bytes(self)
    }
}
