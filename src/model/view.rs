//! Cameras and lights.

/// A camera: what it sees, not where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// How it draws things together.
    pub lens: Lens,
    /// Width of its picture over the height.
    pub aspect: f64,
    /// It sees nothing nearer, metres, more than 0.
    pub near: f64,
    /// It sees nothing further, metres, more than `near`; without end where none is given.
    pub far: Option<f64>,
}

/// How a camera draws things together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// What is further is smaller.
    Perspective {
        /// Degrees that it sees upright, more than 0 and less than 180.
        upright: f64,
    },
    /// Everything has its size at any distance. It sees to some end.
    Parallel {
        /// What it sees upright, metres, more than 0.
        height: f64,
    },
}

/// A light: how it shines, not from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it shines.
    pub kind: LightKind,
    /// Red, green and blue, linear, 0 to 1.
    pub color: [f64; 3],
    /// Candela, of a sun lux; not negative.
    pub intensity: f64,
    /// It shines no further, metres, more than 0; without end where none is given.
    pub range: Option<f64>,
}

/// Where a light shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// All around.
    Point,
    /// The same way everywhere.
    Sun,
    /// In a cone.
    Spot {
        /// Degrees from the middle to where it begins to fade, at least 0 and less than `outer`.
        inner: f64,
        /// Degrees from the middle to where it ends, at most 90.
        outer: f64,
    },
}
