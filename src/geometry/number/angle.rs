//! Trigonometry in degrees, exact at the multiples of 90.

use super::elementary;
use super::whole::nearest;

/// Sine and cosine of an angle in degrees; exactly 0, 1 or -1 at the multiples of 90 degrees.
///
/// The angle is reduced exactly to [-45, 45] degrees first, so that equal directions give equal bits and a
/// full turn closes without a seam.
#[must_use]
pub fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    // Whole turns of greater angles are taken away first; of smaller ones every step below is exact.
    const MANY: f64 = 1e9;
    let turned = if angle.abs() < MANY { angle } else { angle % 360.0 };
    let quarter = nearest(turned / 90.0);
    let (sin, cos) = elementary::sin_cos((turned - quarter as f64 * 90.0).to_radians());
    match quarter & 3 {
        1 => (cos, -sin),
        2 => (-sin, -cos),
        3 => (-cos, sin),
        _ => (sin, cos),
    }
}

/// Sine of an angle in degrees.
#[must_use]
pub fn sin_degrees(angle: f64) -> f64 {
    sin_cos_degrees(angle).0
}

/// Cosine of an angle in degrees.
#[must_use]
pub fn cos_degrees(angle: f64) -> f64 {
    sin_cos_degrees(angle).1
}

/// Tangent of an angle in degrees; infinite at the odd multiples of 90.
#[must_use]
pub fn tan_degrees(angle: f64) -> f64 {
    let (sin, cos) = sin_cos_degrees(angle);
    sin / cos
}

#[cfg(test)]
mod tests {
    use super::{sin_cos_degrees, tan_degrees};

    #[test]
    fn quarter_turns_are_exact() {
        for (angle, expected) in [
            (0.0, (0.0, 1.0)),
            (90.0, (1.0, 0.0)),
            (180.0, (0.0, -1.0)),
            (270.0, (-1.0, 0.0)),
            (360.0, (0.0, 1.0)),
            (-90.0, (-1.0, 0.0)),
            (-450.0, (-1.0, 0.0)),
            (36_000_090.0, (1.0, 0.0)),
            (360e12 + 90.0, (1.0, 0.0)),
        ] {
            assert_eq!(sin_cos_degrees(angle), expected, "{angle}");
        }
    }

    #[test]
    fn other_angles_agree_with_radians() {
        for step in -1000..1000 {
            let angle = f64::from(step) * 0.77;
            let (sin, cos) = sin_cos_degrees(angle);
            assert!((sin - libm::sin(angle.to_radians())).abs() < 4e-15, "{angle}");
            assert!((cos - libm::cos(angle.to_radians())).abs() < 4e-15, "{angle}");
        }
        for turns in [1.0, -3.0, 1e6] {
            let (near, far) = (sin_cos_degrees(33.75), sin_cos_degrees(33.75 + 360.0 * turns));
            assert_eq!(near, far, "{turns} turns");
        }
        assert!((tan_degrees(45.0) - 1.0).abs() < 1e-15);
    }
}
