//! How well two curves join, and by how much they fail to.
//!
//! Source: B. Barsky, T. `DeRose`, Geometric continuity of parametric curves, IEEE CG&A 10 (1990).

use std::fmt;

use glam::DVec3;

use super::{Curve, Jet, Side};
use crate::geometry::number;

/// How well two curves join. C2 includes all others, C1 and G2 each include G1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Continuity {
    /// The ends do not meet.
    Gap,
    /// The ends meet.
    G0,
    /// Directions agree.
    G1,
    /// First derivatives agree.
    C1,
    /// Directions and curvatures agree.
    G2,
    /// First and second derivatives agree.
    C2,
}

impl fmt::Display for Continuity {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Gap => "gap",
            Self::G0 => "G0",
            Self::G1 => "G1",
            Self::C1 => "C1",
            Self::G2 => "G2",
            Self::C2 => "C2",
        };
        to.write_str(text)
    }
}

/// What is measured where one curve ends and the next begins.
///
/// Numbers agree when they differ by less than 1e-9 of themselves, curvatures when the radii that a curve of this size
/// would have differ by less than 1e-6 of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Where the first curve ends.
    pub point: DVec3,
    /// Distance between the ends.
    pub gap: f64,
    /// Angle between the directions, radians.
    pub turn: f64,
    /// First derivatives of both, by the common parameter.
    pub first: [DVec3; 2],
    /// Second derivatives of both.
    pub second: [DVec3; 2],
    /// Vectors of curvature of both: towards the center, one over the radius long. Not finite where a curve stands
    /// still.
    pub curvature: [DVec3; 2],
    /// The length that rounding is measured against.
    size: f64,
}

impl Meeting {
    /// Of the curve up to `before` and the curve from `after` on: one parameter inside the curve, or its end and its
    /// start.
    #[must_use]
    pub fn of(curve: &impl Curve, before: f64, after: f64, size: f64) -> Self {
        let jets = [curve.evaluate(before, Side::Before), curve.evaluate(after, Side::After)];
        let (one, other) = (curve.direction(before, Side::Before), curve.direction(after, Side::After));
        Self {
            point: jets[0].point,
            gap: jets[0].point.distance(jets[1].point),
            turn: number::atan2(one.cross(other).length(), one.dot(other)),
            first: jets.map(|jet| jet.first),
            second: jets.map(|jet| jet.second),
            curvature: jets.map(|jet| curvature(&jet)),
            size,
        }
    }

    /// Whether the curves join so well.
    #[must_use]
    pub fn holds(&self, declared: Continuity) -> bool {
        match declared {
            Continuity::Gap => true,
            Continuity::G0 => self.gap <= ROUNDING * self.size,
            Continuity::G1 => self.holds(Continuity::G0) && self.turn <= ROUNDING,
            Continuity::C1 => self.holds(Continuity::G1) && agree(self.first, 0.0),
            Continuity::G2 => {
                let [one, other] = self.curvature;
                self.holds(Continuity::G1) && one.distance(other) * self.size <= ROUNDING * 1e3
            }
            Continuity::C2 => self.holds(Continuity::C1) && agree(self.second, self.first[0].length()),
        }
    }

    /// The best that holds; where both C1 and G2 do, G2.
    #[must_use]
    pub fn continuity(&self) -> Continuity {
        let all = [Continuity::C2, Continuity::G2, Continuity::C1, Continuity::G1, Continuity::G0];
        all.into_iter().find(|one| self.holds(*one)).unwrap_or(Continuity::Gap)
    }
}

/// Share by which numbers differ through rounding.
const ROUNDING: f64 = 1e-9;

/// Whether two vectors differ by rounding only: of the longer, or of a length given.
fn agree([one, other]: [DVec3; 2], least: f64) -> bool {
    one.distance(other) <= ROUNDING * one.length().max(other.length()).max(least)
}

fn curvature(jet: &Jet) -> DVec3 {
    let speed = jet.first.length_squared();
    let along = jet.first * (jet.second.dot(jet.first) / speed);
    (jet.second - along) / speed
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Continuity, Meeting};
    use crate::geometry::curve::{AnyCurve, BezierSpline, EllipseArc, Path, Polyline};

    fn meeting(one: AnyCurve, other: AnyCurve) -> Meeting {
        Path::new(vec![one, other]).unwrap().meeting(1)
    }

    fn line(from: [f64; 2], to: [f64; 2]) -> AnyCurve {
        let points = [from, to].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        AnyCurve::Polyline(Polyline::new(points, false).unwrap())
    }

    /// A quarter circle of this radius from (0, 0), leaving along x.
    fn quarter(radius: f64) -> AnyCurve {
        AnyCurve::Ellipse(EllipseArc::circle(DVec3::new(0.0, radius, 0.0), radius, -90.0, 0.0))
    }

    #[test]
    fn each_kind_of_joint() {
        let found = meeting(line([-2.0, 0.0], [0.0, 0.0]), quarter(1.0));
        assert_eq!(found.continuity(), Continuity::G1);
        assert!(!found.holds(Continuity::C1) && !found.holds(Continuity::G2));
        assert!((found.curvature[1].distance(DVec3::Y)) < 1e-12 && found.curvature[0] == DVec3::ZERO);
        // As fast as the arc: a quarter turn of radius 1 in one unit of the parameter.
        let half = core::f64::consts::FRAC_PI_2;
        assert_eq!(meeting(line([-half, 0.0], [0.0, 0.0]), quarter(1.0)).continuity(), Continuity::C1);
        assert_eq!(
            meeting(line([-2.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [1.0, 0.0])).continuity(),
            Continuity::G2
        );
        assert_eq!(
            meeting(line([-2.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [2.0, 0.0])).continuity(),
            Continuity::C2
        );
        let bent = meeting(line([-2.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [1.0, 1.0]));
        assert_eq!(bent.continuity(), Continuity::G0);
        assert!((bent.turn - core::f64::consts::FRAC_PI_4).abs() < 1e-12);
        let apart = meeting(line([-2.0, 0.0], [-1.0, 0.0]), line([0.0, 0.0], [1.0, 0.0]));
        assert_eq!((apart.continuity(), apart.gap), (Continuity::Gap, 1.0));
    }

    #[test]
    fn a_circle_goes_on_and_a_mirrored_one_bends_the_other_way() {
        let before = AnyCurve::Ellipse(EllipseArc::circle(DVec3::new(0.0, 2.0, 0.0), 2.0, -180.0, -90.0));
        assert_eq!(meeting(before.clone(), quarter(2.0)).continuity(), Continuity::C2);
        let mirrored = EllipseArc::circle(DVec3::new(0.0, -2.0, 0.0), 2.0, 90.0, 0.0);
        assert_eq!(meeting(before, AnyCurve::Ellipse(mirrored)).continuity(), Continuity::C1);
    }

    #[test]
    fn where_a_curve_starts_at_rest_its_direction_counts() {
        // The first two control points are equal: the derivative there is zero, and the curve leaves along x.
        let points = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [2.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let resting = AnyCurve::Bezier(BezierSpline::new(3, points.to_vec()).unwrap());
        let found = meeting(line([-1.0, 0.0], [0.0, 0.0]), resting);
        assert_eq!(found.continuity(), Continuity::G1);
    }
}
