//! The limit of the four-point scheme, evaluated exactly.
//!
//! The limit curve has no formula, but every number of the machine is dyadic: halving the interval around a
//! parameter, with the few points that act there, ends on the parameter itself after at most some sixty levels,
//! where position and derivative are exact up to rounding. Source: N. Dyn, D. Levin, J. Gregory, A 4-point
//! interpolatory subdivision scheme for curve design, CAGD 4 (1987); the limit is C1 for 0 < w < 1/8. It has no second
//! derivative at most places: second differences over h grow as log(1 / h).

use glam::DVec3;

use super::subdivision::{Border, Scheme, continued, fewest};
use super::{Curve, Domain, Jet, Side};
use crate::geometry::number::floor_index;

/// The limit curve of the four-point scheme; parameter k is point k (k + 2 where the ends are cut).
///
/// Evaluation takes about 50 levels for a general parameter (half a microsecond) and ten at least; it is exact up
/// to rounding. `second` of a jet is a difference quotient of the derivative over 1/1024 of an edge.
#[derive(Clone, Debug, PartialEq)]
pub struct FourPointCurve {
    points: Vec<DVec3>,
    tension: f64,
    border: Border,
}

/// Levels at which the second difference is taken.
const BEND_LEVEL: u32 = 10;

/// Levels after which an interval is shorter than rounding.
const LEVELS: u32 = 60;

impl FourPointCurve {
    /// The limit for a tension strictly between 0 and 1/8; `None` for another tension or too few points.
    #[must_use]
    pub fn new(points: Vec<DVec3>, tension: f64, border: Border) -> Option<Self> {
        let enough = points.len() >= fewest(Scheme::FourPoint { tension }, border);
        (enough && tension > 0.0 && tension < 0.125).then_some(Self { points, tension, border })
    }

    /// Number of the point at parameter 0.
    fn first(&self) -> isize {
        if self.border == Border::Cut { 2 } else { 0 }
    }

    fn at(&self, k: isize) -> DVec3 {
        continued(&self.points, k, self.border)
    }

    fn edges(&self) -> usize {
        match self.border {
            Border::Closed => self.points.len(),
            Border::Reflect => self.points.len() - 1,
            Border::Cut => self.points.len() - 5,
        }
    }

    /// The points from number `low` to `high` of the polygon after `level` refinements.
    ///
    /// Each level needs one point more on both sides of half the range, so at most `high - low` + 7 points are held.
    fn level_points(&self, level: u32, low: isize, high: isize) -> Vec<DVec3> {
        if level == 0 {
            return (low..=high).map(|k| self.at(k)).collect();
        }
        let start = low.div_euclid(2) - 1;
        let above = self.level_points(level - 1, start, high.div_euclid(2) + 2);
        let point = |k: isize| {
            let at = (k.div_euclid(2) - start).cast_unsigned();
            if k.rem_euclid(2) == 0 {
                return above[at];
            }
            (above[at] + above[at + 1]) * (0.5 + self.tension)
                - (above[at - 1] + above[at + 2]) * self.tension
        };
        (low..=high).map(point).collect()
    }

    /// First derivative at the middle of five divided differences: the left eigenvector of the refinement for its
    /// eigenvalue 1/2, scaled so that even steps give their own speed.
    fn velocity(&self, d: [DVec3; 4]) -> DVec3 {
        let w = self.tension;
        let near = d[1] + d[2];
        (near - (d[0] + near + d[3]) * (2.0 * w)) * (1.0 / (2.0 - 8.0 * w))
    }
}

impl Curve for FourPointCurve {
    fn domain(&self) -> Domain {
        Domain { start: 0.0, end: self.edges() as f64 }
    }

    fn is_closed(&self) -> bool {
        self.border == Border::Closed
            || self.at(self.first()) == self.at(self.first() + self.edges().cast_signed())
    }

    fn evaluate(&self, t: f64, _side: Side) -> Jet {
        let t = t.clamp(0.0, self.edges() as f64);
        let edge = floor_index(t);
        let mut rest = t - edge as f64;
        let start = edge.cast_signed() + self.first();
        let mut base = self.at(start);
        // Divided differences from edge -2 to edge 2 about the base; a level makes those about the same place,
        // or about the middle of the edge after it.
        let mut d = [-2, -1, 0, 1, 2].map(|k| self.at(start + k + 1) - self.at(start + k));
        let mut step = 1.0;
        let mut second = DVec3::ZERO;
        let double = 2.0 * self.tension;
        for level in 1..=LEVELS {
            let turn = [1, 2, 3].map(|k| (d[k - 1] - d[k + 1]) * double);
            let fine = [
                d[1] + turn[0],
                d[1] - turn[0],
                d[2] + turn[1],
                d[2] - turn[1],
                d[3] + turn[2],
                d[3] - turn[2],
            ];
            step *= 0.5;
            rest *= 2.0;
            if rest >= 1.0 {
                rest -= 1.0;
                base += fine[2] * step;
                d = [fine[1], fine[2], fine[3], fine[4], fine[5]];
            } else {
                d = [fine[0], fine[1], fine[2], fine[3], fine[4]];
            }
            if level == BEND_LEVEL {
                let (here, next) =
                    (self.velocity([d[0], d[1], d[2], d[3]]), self.velocity([d[1], d[2], d[3], d[4]]));
                second = (next - here) * (1.0 / step);
            }
            if rest == 0.0 && level >= BEND_LEVEL {
                break;
            }
        }
        Jet { point: base, first: self.velocity([d[0], d[1], d[2], d[3]]), second }
    }

    fn joints(&self) -> Vec<f64> {
        Vec::new()
    }

    fn breaks(&self) -> Vec<f64> {
        (1..self.edges()).map(|k| k as f64).collect()
    }

    fn has_curvature(&self) -> bool {
        false
    }

    /// Proof: let s be the greatest second difference of the refined polygon about an edge. One more level moves the
    /// middle of the edge by w (s + s) at most and leaves second differences of at most max(4 w, 1/2 - 2 w + 2 w) s,
    /// which is s / 2 for w <= 1/8. So the limit lies within 2 w s (1 + 1/2 + 1/4 + ...) = 4 w s of the polygon.
    /// Points of the polygon lie on the curve; the rest is the distance of the polygon from the chord. As the polygon
    /// is refined with the length of the chord, the bound is sharp.
    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        const CELLS: f64 = 8.0;
        let domain = self.domain();
        let (from, to) = (from.clamp(domain.start, domain.end), to.clamp(domain.start, domain.end));
        let (mut level, mut scale) = (0, 1.0);
        while (to - from) * scale < CELLS && level < LEVELS / 2 {
            level += 1;
            scale *= 2.0;
        }
        let shift = self.first() * (1 << level);
        let number = |t: f64| floor_index(t * scale).cast_signed() + shift;
        let (low, high) = (number(from), number(to) + 1);
        // A cell is bent by the second differences up to one point beyond it.
        let fine = self.level_points(level, low - 2, high + 2);
        let bend = fine.windows(3).map(|run| (run[2] - run[1] * 2.0 + run[0]).length()).fold(0.0, f64::max);
        let off = 4.0 * self.tension * bend;
        let chord = (self.point(from), self.point(to));
        let inner = &fine[3..fine.len() - 3];
        let apart =
            inner.iter().map(|point| super::pieces::distance_to_segment(*point, chord)).fold(off, f64::max);
        off + apart
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::FourPointCurve;
    use crate::geometry::curve::pieces::distance_to_segment;
    use crate::geometry::curve::subdivision::{Border, Scheme, refine};
    use crate::geometry::curve::{Curve, Side};

    fn points() -> Vec<DVec3> {
        [(0.0, 0.0), (2.0, -0.5), (3.0, 1.0), (2.2, 2.5), (0.7, 2.2), (-0.6, 1.4), (-2.0, 0.0)]
            .map(|(x, y)| DVec3::new(x, y, 0.3 * x * y))
            .to_vec()
    }

    const BORDERS: [Border; 3] = [Border::Closed, Border::Reflect, Border::Cut];

    fn curve(tension: f64, border: Border) -> FourPointCurve {
        FourPointCurve::new(points(), tension, border).unwrap()
    }

    /// Interpolating: every point of every level stays on the curve.
    #[test]
    fn refined_points_are_points_of_the_limit() {
        for border in BORDERS {
            for tension in [1.0 / 16.0, 0.02, 0.12] {
                let limit = curve(tension, border);
                for level in 0..7 {
                    let fine = refine(&points(), Scheme::FourPoint { tension }, border, level);
                    let scale = f64::from(1 << level);
                    // Cut polygons shrink towards the limit's domain, each level by one of its steps.
                    let first = if border == Border::Cut { 2.0 * (1.0 - 1.0 / scale) - 2.0 } else { 0.0 };
                    for (k, point) in fine.iter().enumerate() {
                        let t = first + k as f64 / scale;
                        if t >= 0.0 && t <= limit.domain().end {
                            assert!(limit.point(t).distance(*point) < 1e-13, "{border:?} {level} {k}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        for border in BORDERS {
            for tension in [1.0 / 16.0, 0.02, 0.12] {
                let limit = curve(tension, border);
                for k in 1..200 {
                    let t = limit.domain().at(f64::from(k) / 200.0);
                    let quotient = |h: f64| (limit.point(t + h) - limit.point(t - h)) / (2.0 * h);
                    let velocity = limit.evaluate(t, Side::After).first;
                    let apart = [1e-3, 1e-4, 1e-5, 1e-6].map(|h| quotient(h).distance(velocity));
                    let bend = limit.evaluate(t, Side::After).second.length() + velocity.length();
                    for (apart, h) in apart.iter().zip([1e-3, 1e-4, 1e-5, 1e-6]) {
                        // The derivative has a modulus of continuity of h^a; a falls to 0.1 as w comes near 1/8.
                        let modulus =
                            if tension > 0.1 { crate::geometry::number::pow(h, 0.15) } else { h * 20.0 };
                        assert!(*apart < modulus * bend, "{border:?} {tension} {t} {h}: {apart}");
                    }
                }
            }
        }
    }

    #[test]
    fn bounds_hold_and_are_sharp() {
        for border in BORDERS {
            for tension in [1.0 / 16.0, 0.02, 0.12] {
                let limit = curve(tension, border);
                for (from, to) in
                    [(0.0, 1.0), (0.0, 0.2), (0.31, 0.32), (0.5, 0.8), (0.7, 0.70001), (0.99, 1.0)]
                {
                    let (from, to) = (limit.domain().at(from), limit.domain().at(to));
                    let bound = limit.chord_deviation(from, to);
                    let chord = (limit.point(from), limit.point(to));
                    let worst = (0..=2000)
                        .map(|step| limit.point(from + (to - from) * f64::from(step) / 2000.0))
                        .map(|point| distance_to_segment(point, chord))
                        .fold(0.0, f64::max);
                    assert!(worst <= bound + 1e-15, "{border:?} {tension} {from} {to}: {worst} > {bound}");
                    assert!(bound < 2.0 * worst + 1e-14, "{from} {to}: {bound} is loose for {worst}");
                }
            }
        }
    }

    /// With tension 1/16 cubics are reproduced, and so are their derivatives.
    #[test]
    fn cubics_are_reproduced() {
        let cubic = |t: f64| DVec3::new(t, t * t - 2.0 * t, t * t * t);
        let p: Vec<DVec3> = (0..9).map(|k| cubic(f64::from(k))).collect();
        let limit = FourPointCurve::new(p, 1.0 / 16.0, Border::Cut).unwrap();
        assert_eq!(limit.domain().end, 4.0);
        for k in 0..=77 {
            let t = 4.0 * f64::from(k) / 77.0;
            let jet = limit.evaluate(t, Side::After);
            assert!(jet.point.distance(cubic(t + 2.0)) < 1e-12);
            let s = t + 2.0;
            assert!(jet.first.distance(DVec3::new(1.0, 2.0 * s - 2.0, 3.0 * s * s)) < 1e-11, "{t}");
        }
    }

    #[test]
    fn closed_curves_meet_to_the_bit_and_bad_tension_is_refused() {
        let limit = curve(1.0 / 16.0, Border::Closed);
        assert!(limit.is_closed());
        assert_eq!(limit.evaluate(0.0, Side::After), limit.evaluate(7.0, Side::Before));
        for tension in [0.0, 0.125, -0.1, f64::NAN] {
            assert!(FourPointCurve::new(points(), tension, Border::Closed).is_none());
        }
        assert!(FourPointCurve::new(points()[..5].to_vec(), 0.05, Border::Cut).is_none());
    }
}
