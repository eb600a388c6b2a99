//! Arcs of hyperbolas.

use glam::DVec3;

use super::ellipse::chord_height;
use super::{Curve, Domain, Jet, Side};
use crate::geometry::number;

/// The arc center + x cosh t + y sinh t for t from `from` to `to`. `x` and `y` are conjugate half diameters:
/// perpendicular they are the half axes. The branch lies on the side of `x`.
#[derive(Clone, Debug, PartialEq)]
pub struct HyperbolaArc {
    /// Where the asymptotes cross, metres.
    pub center: DVec3,
    /// From the center to the point at t = 0.
    pub x: DVec3,
    /// The tangent there; the asymptotes run along x + y and x - y.
    pub y: DVec3,
    /// First parameter.
    pub from: f64,
    /// Last parameter; may be less than the first, never equal.
    pub to: f64,
}

impl HyperbolaArc {
    /// The parameter of the hyperbola at a fraction of the arc.
    fn inner(&self, t: f64) -> f64 {
        if t >= 1.0 { self.to } else { self.from + (self.to - self.from) * t.max(0.0) }
    }
}

impl Curve for HyperbolaArc {
    /// The parameter runs 0 to 1 from `from` to `to`.
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn is_closed(&self) -> bool {
        false
    }

    fn evaluate(&self, t: f64, _side: Side) -> Jet {
        let inner = self.inner(t);
        let (sinh, cosh) = (number::sinh(inner), number::cosh(inner));
        let rate = self.to - self.from;
        let spoke = self.x * cosh + self.y * sinh;
        Jet {
            point: self.center + spoke,
            first: (self.x * sinh + self.y * cosh) * rate,
            second: spoke * (rate * rate),
        }
    }

    fn joints(&self) -> Vec<f64> {
        Vec::new()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        // About the middle m of the range the arc is A cosh s + B sinh s with the spoke A and the tangent B
        // at m, and the chord is A cosh h + B sinh s: they differ by A (cosh h - cosh s).
        let (start, end) = (self.inner(from), self.inner(to));
        let (middle, half) = ((start + end) / 2.0, (end - start).abs() / 2.0);
        let (sinh, cosh) = (number::sinh(middle), number::cosh(middle));
        let (spoke, tangent) = (self.x * cosh + self.y * sinh, self.x * sinh + self.y * cosh);
        let rise = number::sinh(half / 2.0);
        chord_height(spoke, tangent, 2.0 * rise * rise, number::tanh(half))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::HyperbolaArc;
    use crate::geometry::curve::{Curve, Side, length};

    #[test]
    fn points_keep_the_equation_and_the_chord_height_is_exact() {
        let arc = HyperbolaArc {
            center: DVec3::new(1.0, 2.0, 0.0),
            x: DVec3::X * 3.0,
            y: DVec3::Y * 0.5,
            from: -1.5,
            to: 2.0,
        };
        for step in 0..=50 {
            let place = arc.evaluate(f64::from(step) / 50.0, Side::After).point - arc.center;
            let equation = (place.x / 3.0) * (place.x / 3.0) - (place.y / 0.5) * (place.y / 0.5);
            assert!((equation - 1.0).abs() < 1e-13, "{equation}");
        }
        // Even about the vertex: the chord stands at x = 3 cosh 1.5, the vertex at x = 3.
        let even = HyperbolaArc { to: 1.5, ..arc };
        let expected = 3.0 * (crate::geometry::number::cosh(1.5) - 1.0);
        assert!((even.chord_deviation(0.0, 1.0) - expected).abs() < 1e-13);
    }

    #[test]
    fn length_of_a_rectangular_hyperbola() {
        // Its speed is sqrt(sinh^2 + cosh^2) = sqrt(cosh 2t).
        let arc = HyperbolaArc { center: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, from: 0.0, to: 1.0 };
        let sum: f64 = (0..2000)
            .map(|k| crate::geometry::number::cosh((f64::from(k) + 0.5) / 1000.0).sqrt() / 2000.0)
            .sum();
        // The midpoint rule errs by f'' / 24 n^2, below 1e-7.
        assert!((length(&arc) - sum).abs() < 1e-7);
    }
}
