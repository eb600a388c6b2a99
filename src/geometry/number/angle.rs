//! Trigonometry in degrees, exact at the multiples of 90.

use super::elementary;

/// Sine and cosine of an angle in degrees; exactly 0, 1 or -1 at the multiples of 90 degrees.
///
/// The angle is reduced exactly to [-45, 45] degrees first, so that equal directions give equal bits and a
/// full turn closes without a seam.
#[must_use]
pub fn sin_cos_degrees(angle: f64) -> (f64, f64) {
    let turned = angle % 360.0;
    let quarter = (turned / 90.0).round();
    let (sin, cos) = elementary::sin_cos((turned - quarter * 90.0).to_radians());
    match quarter.rem_euclid(4.0) {
        1.0 => (cos, -sin),
        2.0 => (-sin, -cos),
        3.0 => (-cos, sin),
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
        assert!((tan_degrees(45.0) - 1.0).abs() < 1e-15);
    }
}
