//! Colors of vertices.
//!
//! A vertex without a color is white: colors multiply those of materials, and each other where several are given.
//! Promise: parts stay between 0 and 1 under every operation here, and colors between equal ones are that color, to the
//! last bit. Not promised: that a mesh is fine enough to show how colors change between its vertices.

use crate::geometry::number::single;

/// Linear red, green, blue and alpha, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color(pub [f32; 4]);

impl Color {
    /// Opaque white, which changes nothing.
    pub const WHITE: Self = Self([1.0; 4]);

    /// A color of parts in double precision; what is beyond 0 or 1 is held back, and what is no number is 0.
    #[must_use]
    pub fn held(parts: [f64; 4]) -> Self {
        Self(parts.map(|part| single(part.clamp(0.0, 1.0).max(0.0)) + 0.0))
    }

    /// The parts in double precision.
    #[must_use]
    pub fn parts(self) -> [f64; 4] {
        self.0.map(f64::from)
    }

    /// Both, as one filter behind the other.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self([0, 1, 2, 3].map(|part| self.0[part] * other.0[part]))
    }

    /// The sum of colors by weights whose sum is 1.
    #[must_use]
    pub fn mixed<const N: usize>(colors: [Self; N], weights: [f64; N]) -> Self {
        if colors.windows(2).all(|pair| pair[0] == pair[1]) {
            return colors.first().copied().unwrap_or(Self::WHITE);
        }
        let sum = |part: usize| (0..N).map(|k| f64::from(colors[k].0[part]) * weights[k]).sum();
        Self::held([0, 1, 2, 3].map(sum))
    }

    /// The color at a part of the way from this one to another.
    #[must_use]
    pub fn lerp(self, other: Self, part: f64) -> Self {
        Self::mixed([self, other], [1.0 - part, part])
    }
}

impl Default for Color {
    fn default() -> Self {
        Self::WHITE
    }
}

#[cfg(test)]
mod tests {
    use super::Color;

    #[test]
    fn colors_between_equal_ones_are_that_color_and_others_stay_within_bounds() {
        let own = Color([0.1, 0.7, 0.3, 0.9]);
        assert_eq!(Color::mixed([own; 3], [0.3, 0.3, 0.4]), own);
        assert_eq!(Color::mixed([Color::WHITE, own], [1.5, -0.5]).0[3], 1.0);
        let half = own.lerp(Color::WHITE, 0.5);
        for part in 0..4 {
            assert!((half.0[part] - f32::midpoint(own.0[part], 1.0)).abs() < 1e-7);
        }
        assert_eq!(own.times(Color::WHITE), own);
        assert_eq!(Color::held([f64::NAN, -1.0, 2.0, 0.5]), Color([0.0, 0.0, 1.0, 0.5]));
    }
}
