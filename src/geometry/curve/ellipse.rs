//! Arcs of circles and ellipses.

use glam::DVec3;

use super::{Curve, Domain, Jet, Side};
use crate::geometry::number;
use crate::geometry::number::Bounds;

/// The arc center + x cos t + y sin t for t from `from` to `to` in degrees. `x` and `y` are conjugate half
/// diameters: perpendicular and of equal length they make a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct EllipseArc {
    /// Center, metres.
    pub center: DVec3,
    /// Half diameter at 0 degrees.
    pub x: DVec3,
    /// Half diameter at 90 degrees.
    pub y: DVec3,
    /// First angle, degrees.
    pub from: f64,
    /// Last angle, degrees; may be less than the first, never equal.
    pub to: f64,
}

impl EllipseArc {
    /// A full ellipse in the plane z = center.z, counter-clockwise from +x.
    #[must_use]
    pub fn full(center: DVec3, radius_x: f64, radius_y: f64) -> Self {
        Self { center, x: DVec3::X * radius_x, y: DVec3::Y * radius_y, from: 0.0, to: 360.0 }
    }

    /// An arc of a circle in the plane z = center.z; angles in degrees from +x.
    #[must_use]
    pub fn circle(center: DVec3, radius: f64, from: f64, to: f64) -> Self {
        Self { center, x: DVec3::X * radius, y: DVec3::Y * radius, from, to }
    }

    /// The circular arc from `start` through `through` to `end`; `None` when the three are on one line.
    #[must_use]
    pub fn through(start: DVec3, through: DVec3, end: DVec3) -> Option<Self> {
        let (a, b) = (through - start, end - start);
        let normal = a.cross(b);
        let square = normal.length_squared();
        // Three points whose triangle is this thin have a radius beyond 1e12 times their distance.
        if square <= 1e-24 * a.length_squared() * b.length_squared() {
            return None;
        }
        let to_center =
            (normal.cross(a) * b.length_squared() + b.cross(normal) * a.length_squared()) / (2.0 * square);
        let center = start + to_center;
        let x = -to_center;
        let y = normal.normalize().cross(x);
        let spoke = end - center;
        let mut to = number::atan2(spoke.dot(y), spoke.dot(x)).to_degrees();
        if to <= 0.0 {
            to += 360.0;
        }
        Some(Self { center, x, y, from: 0.0, to })
    }

    /// Greatest distance from the center over unit steps of either half diameter: a bound on the size of the
    /// second derivative by radians.
    fn reach(&self) -> f64 {
        // The greatest singular value of the 2-column matrix (x, y).
        let (xx, yy, xy) = (self.x.length_squared(), self.y.length_squared(), self.x.dot(self.y));
        let half = (xx + yy) / 2.0;
        let spread = number::hypot((xx - yy) / 2.0, xy);
        (half + spread).sqrt()
    }

    /// Whether it is an arc of a circle, but for rounding.
    fn is_round(&self, reach: f64) -> bool {
        let square = reach * reach;
        let same = (self.x.length_squared() - self.y.length_squared()).abs() <= 1e-12 * square;
        same && self.x.dot(self.y).abs() <= 1e-12 * square
    }

    fn angle(&self, t: f64) -> f64 {
        t.clamp(self.from.min(self.to), self.from.max(self.to))
    }
}

impl Curve for EllipseArc {
    /// The parameter runs 0 to 1 from `from` to `to`.
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn is_closed(&self) -> bool {
        (self.to - self.from).abs() == 360.0
    }

    fn evaluate(&self, t: f64, _side: Side) -> Jet {
        let span = self.to - self.from;
        let angle = if t >= 1.0 { self.to } else { self.angle(self.from + span * t) };
        let (sin, cos) = number::sin_cos_degrees(angle);
        let rate = span.to_radians();
        let spoke = self.x * cos + self.y * sin;
        Jet {
            point: self.center + spoke,
            first: (self.y * cos - self.x * sin) * rate,
            second: -spoke * (rate * rate),
        }
    }

    fn joints(&self) -> Vec<f64> {
        Vec::new()
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        let turn = ((to - from) * (self.to - self.from)).abs();
        if turn > 180.0 {
            return 2.0 * self.reach();
        }
        let rise = number::sin_degrees(turn / 4.0);
        let drop = 2.0 * rise * rise;
        let reach = self.reach();
        if self.is_round(reach) {
            return reach * drop;
        }
        // About the middle m of the range the arc is A cos s + B sin s with the spoke A and the tangent B at
        // m, and the chord is A cos h + B sin s: they differ by A (cos s - cos h).
        let middle = self.from + (self.to - self.from) * ((from + to) / 2.0);
        let (sin, cos) = number::sin_cos_degrees(middle);
        let (spoke, tangent) = (self.x * cos + self.y * sin, self.y * cos - self.x * sin);
        chord_height(spoke, tangent, drop, number::tan_degrees(turn / 2.0)).min(reach * drop)
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let middle = self.evaluate((from + to) / 2.0, Side::After).second;
        let rate = (self.to - self.from).to_radians();
        // The third derivative has the size of the half diameters in each direction.
        let third = DVec3::new(
            number::hypot(self.x.x, self.y.x),
            number::hypot(self.x.y, self.y.y),
            number::hypot(self.x.z, self.y.z),
        );
        let reach = third * (rate * rate * rate * (to - from) / 2.0).abs();
        Some(Bounds { min: middle - reach, max: middle + reach })
    }
}

/// How far an arc A c(s) + B s(s) of an ellipse or hyperbola is from its chord, for s from -h to h: the two
/// differ by A times at most `drop`. Where the arc runs along the chord without turning back, which it does
/// while the share of A along B times `slope` (the tangent of h, circular or hyperbolic) is at most B, only
/// the part of A across the chord counts.
pub(super) fn chord_height(spoke: DVec3, tangent: DVec3, drop: f64, slope: f64) -> f64 {
    let speed = tangent.length();
    let direction = tangent / speed;
    let along = spoke.dot(direction);
    let across = if along.abs() * slope <= speed { spoke - direction * along } else { spoke };
    across.length() * drop
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::EllipseArc;
    use crate::geometry::curve::{Curve, Side};

    #[test]
    fn arc_through_three_points_passes_them_in_order() {
        let points = [DVec3::new(1.0, 0.2, 0.0), DVec3::new(-0.5, 1.0, 2.0), DVec3::new(0.3, -2.0, 1.0)];
        let arc = EllipseArc::through(points[0], points[1], points[2]).unwrap();
        assert!(arc.point(0.0).distance(points[0]) < 1e-14);
        assert!(arc.point(1.0).distance(points[2]) < 1e-13);
        let nearest = (0..=3600)
            .map(|step| arc.point(f64::from(step) / 3600.0).distance(points[1]))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest < 5e-3);
        let radius = arc.center.distance(points[0]);
        assert!((arc.center.distance(points[1]) - radius).abs() < 1e-13);
        assert!(EllipseArc::through(DVec3::ZERO, DVec3::X, DVec3::X * 3.0).is_none());
    }

    #[test]
    fn full_circle_closes_to_the_bit() {
        let circle = EllipseArc::full(DVec3::new(0.1, 0.2, 0.3), 0.7, 0.7);
        assert_eq!(circle.point(0.0), circle.evaluate(1.0, Side::Before).point);
        assert!(circle.is_closed());
    }

    #[test]
    fn sagitta_of_a_circle_is_exact() {
        let circle = EllipseArc::full(DVec3::ZERO, 2.0, 2.0);
        let expected = 2.0 * (1.0 - crate::geometry::number::cos(core::f64::consts::PI / 16.0));
        assert!((circle.chord_deviation(0.0, 1.0 / 16.0) - expected).abs() < 1e-15);
    }
}
