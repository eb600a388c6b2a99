//! The curve in which a quadric meets the surface of a ball.
//!
//! Each region of the sphere where the quadric has one sign holds a stationary place of it ([`stationary`]), and of
//! regions that one curve bounds there are at least as many as curves, less one; so from the stationary places of both
//! signs, along arcs between them, every curve is found. Each is then followed until it returns.
//!
//! Promise: every curve once, as points so close that the curve turns by less than 12 degrees from one to the next.

use glam::{DMat3, DVec3};

use super::stationary::stationary;
use crate::geometry::field::{Field, Quadric};
use crate::geometry::number::{atan2, sin_cos};
use crate::geometry::tessellate::TessellateError;
use crate::geometry::tessellate::quadric::judge::judge;
use crate::geometry::tessellate::region::Line;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its center.
    pub center: DVec3,
    /// Its radius, positive.
    pub radius: f64,
}

impl Ball {
    /// The polynomial that is zero on its surface and negative inside; its gradient there is twice the outward normal.
    #[must_use]
    pub fn quadric(&self) -> Quadric {
        let around = Quadric::new(DVec3::ONE, DVec3::ZERO, DVec3::ZERO, -self.radius * self.radius);
        let moved = around.around(-self.center);
        Quadric { a: moved.a / self.radius, b: moved.b / self.radius, c: moved.c / self.radius }
    }
}

/// Two surfaces that meet.
pub(super) struct Meeting<'a> {
    pub(super) quadric: &'a Quadric,
    pub(super) sphere: Quadric,
    pub(super) ball: Ball,
}

/// The longest step as a share of the radius.
const LONGEST: f64 = 0.1;

/// The shortest: where the curve turns faster it has a corner.
const SHORTEST: f64 = 1e-9;

/// Cosine of the greatest turn from one point to the next.
const TURN: f64 = 0.98;

/// Most points of one curve.
const MOST: usize = 1 << 16;

impl Meeting<'_> {
    /// All curves: points around, the first not repeated.
    ///
    /// # Errors
    /// A curve that touches itself, or comes nearer to that than steps can follow.
    pub(super) fn curves(&self) -> Result<Vec<Vec<DVec3>>, TessellateError> {
        let mut curves: Vec<Vec<DVec3>> = Vec::new();
        for start in self.starts() {
            if !curves.iter().any(|curve| self.is_on(curve, start)) {
                curves.push(self.followed(start)?);
            }
        }
        Ok(curves)
    }

    /// Points of curves, at least one of each.
    fn starts(&self) -> Vec<DVec3> {
        let Ball { center, radius } = self.ball;
        let local = self.quadric.around(center);
        let places = stationary(&(self.quadric.a * radius * radius), local.b * radius / 2.0);
        let value = |place: DVec3| self.quadric.value(center + place * radius);
        let (inside, outside): (Vec<DVec3>, Vec<DVec3>) =
            places.into_iter().partition(|place| value(*place) < 0.0);
        // Shares of an arc, closer and closer at both ends: regions can be small.
        let halves = std::iter::successors(Some(0.5), |share| Some(share / 2.0));
        let mut near: Vec<f64> = halves.take(39).collect();
        near.reverse();
        let shares: Vec<f64> = std::iter::once(0.0)
            .chain(near.iter().copied())
            .chain(near.iter().rev().skip(1).map(|share| 1.0 - share))
            .chain([1.0])
            .collect();
        let mut starts = Vec::new();
        for from in &inside {
            for to in &outside {
                let arc = GreatArc::new(*from, *to);
                for pair in shares.windows(2) {
                    let (mut low, mut high) = (pair[0], pair[1]);
                    let sign = value(arc.at(low)) < 0.0;
                    if sign == (value(arc.at(high)) < 0.0) {
                        continue;
                    }
                    for _ in 0..60 {
                        let middle = f64::midpoint(low, high);
                        if (value(arc.at(middle)) < 0.0) == sign { low = middle } else { high = middle }
                    }
                    starts.push(self.settled(center + arc.at(low) * radius));
                }
            }
        }
        starts
    }

    fn direction(&self, point: DVec3) -> DVec3 {
        self.quadric.gradient(point).cross(self.sphere.gradient(point)).normalize_or_zero()
    }

    /// The curve from a point until it returns.
    fn followed(&self, start: DVec3) -> Result<Vec<DVec3>, TessellateError> {
        let longest = LONGEST * self.ball.radius;
        let (mut at, mut direction, mut step) = (start, self.direction(start), longest);
        let first = direction;
        let mut points = vec![start];
        loop {
            let guess = at + direction * step;
            let next = self.settled(guess);
            let turned = self.direction(next);
            if next.distance(guess) > LONGEST * step || turned.dot(direction) < TURN || !next.is_finite() {
                step /= 2.0;
                if step < SHORTEST * self.ball.radius {
                    return Err(TessellateError::Tangled);
                }
                continue;
            }
            let back = start - at;
            let ahead = back.dot(direction);
            if points.len() > 2
                && ahead > 0.0
                && ahead <= 1.01 * step
                && (back - direction * ahead).length() <= 0.2 * step
                && first.dot(direction) > 0.9
            {
                // A last step that is much shorter than the others serves nothing.
                if ahead < 0.1 * step {
                    points.pop();
                }
                return Ok(points);
            }
            points.push(next);
            if points.len() > MOST {
                return Err(TessellateError::Tangled);
            }
            (at, direction) = (next, turned);
            step = (1.5 * step).min(longest);
        }
    }

    /// Whether a point of some curve lies on this one.
    fn is_on(&self, curve: &[DVec3], point: DVec3) -> bool {
        around(curve).any(|[from, to]| {
            let chord = to - from;
            let share = (point - from).dot(chord) / chord.length_squared();
            let foot = from.lerp(to, share);
            (-0.05..=1.05).contains(&share)
                && point.distance(foot) <= 0.2 * chord.length()
                && self.across(from, to, share).distance(point) <= 1e-8 * self.ball.radius
        })
    }

    /// The point of the curve in the plane across a chord, at a share of it.
    fn across(&self, from: DVec3, to: DVec3, share: f64) -> DVec3 {
        let along = (to - from).normalize_or_zero();
        let foot = from.lerp(to, share);
        let mut point = foot;
        for _ in 0..8 {
            let rows = [self.quadric.gradient(point), self.sphere.gradient(point), along];
            let matrix = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
            let off =
                DVec3::new(self.quadric.value(point), self.sphere.value(point), along.dot(point - foot));
            let step = matrix.inverse() * off;
            if !step.is_finite() || step.length() > (to - from).length() {
                break;
            }
            point -= step;
        }
        point
    }

    /// Where a curve crosses a plane: the number of the point before, the share of the way to the next, and the place.
    pub(super) fn crossings(
        &self,
        curve: &[DVec3],
        depth: impl Fn(DVec3) -> f64,
    ) -> Vec<(usize, f64, DVec3)> {
        let crosses = |(index, [from, to]): (usize, [DVec3; 2])| {
            let sign = depth(from) < 0.0;
            if sign == (depth(to) < 0.0) {
                return None;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = f64::midpoint(low, high);
                if (depth(self.across(from, to, middle)) < 0.0) == sign {
                    low = middle
                } else {
                    high = middle
                }
            }
            Some((index, low, self.across(from, to, low)))
        };
        around(curve).enumerate().filter_map(crosses).collect()
    }
}

/// Pairs of points that follow each other on a closed curve.
fn around(curve: &[DVec3]) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    (0..curve.len()).map(|k| [curve[k], curve[(k + 1) % curve.len()]])
}

/// The shorter great circle between two places of the unit sphere.
struct GreatArc {
    from: DVec3,
    across: DVec3,
    angle: f64,
}

impl GreatArc {
    fn new(from: DVec3, to: DVec3) -> Self {
        let side = to - from * to.dot(from);
        // Opposite places: any circle.
        let across = if side.length() < 1e-6 { from.any_orthonormal_vector() } else { side.normalize() };
        Self { from, across, angle: atan2(to.dot(across), to.dot(from)) }
    }

    fn at(&self, share: f64) -> DVec3 {
        let (sin, cos) = sin_cos(self.angle * share);
        self.from * cos + self.across * sin
    }
}

impl Line for Meeting<'_> {
    /// The chord lies within the bound of both surfaces, which is proved, and of the curve's middle.
    fn bulge(&self, from: DVec3, to: DVec3) -> (DVec3, f64) {
        let chord = to - from;
        let middle = (from + to) / 2.0;
        if chord == DVec3::ZERO {
            return (middle, 0.0);
        }
        let top = self.across(from, to, 0.5);
        // No place of a chord is further from the surface than from the nearer of its ends.
        let most = chord.length() / 2.0;
        let from_surface = |quadric: &Quadric| judge(quadric, [from, to, middle]).bound.min(most);
        let bound = from_surface(self.quadric).max(from_surface(&self.sphere));
        (top, bound.max(top.distance(middle)))
    }

    fn settled(&self, point: DVec3) -> DVec3 {
        let mut point = point;
        for _ in 0..8 {
            let (p, q) = (self.quadric.gradient(point), self.sphere.gradient(point));
            let (pp, pq, qq) = (p.dot(p), p.dot(q), q.dot(q));
            let (f, h) = (self.quadric.value(point), self.sphere.value(point));
            let determinant = pp * qq - pq * pq;
            let step = (p * (f * qq - h * pq) + q * (h * pp - f * pq)) / determinant;
            if !step.is_finite() || step == DVec3::ZERO {
                break;
            }
            point -= step;
        }
        point
    }
}
