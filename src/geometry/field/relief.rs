//! Quadrics with bumps, in the form that proofs about their surface need: bounds on values, slopes and bends over boxes and
//! triangles.
//!
//! Promise: every bound holds all values over its zone, up to rounding; a bump that does not reach into a zone costs nothing
//! there; along a direction the slope and the bend of a quadric are bounded exactly. A relief is twice differentiable but
//! at the rims of bumps, where its second derivative jumps; bounds over a box hold both sides of the jump, so that
//! Taylor's bounds hold across rims too. Not promised: bounds of bumps on bumps are wider than need be.
//!
//! F' = F - sum of f Q² where Q < 0, with F a quadric and Q a relief; inside is where F' < 0.
//!
//! Source: S. Vyatkin, Complex surface modeling using perturbation functions, Optoelectronics, Instrumentation and Data
//! Processing 43 (2007): perturbations of planes and quadrics, max(Q + R) <= max Q + max R.

use glam::{DAffine3, DVec3};

use super::quadric::QuadricForm;
use super::quadric::QuadricKind;
use super::{AnyField, Bump, Field, Perturbed, Primitive, Quadric};
use crate::geometry::formula::{Algebra, Interval, minus, plus, times};
use crate::geometry::number::Bounds;

/// A quadric with bumps on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Relief {
    /// F.
    pub base: Quadric,
    /// What is added.
    pub bumps: Vec<ReliefBump>,
}

/// A bump of a relief.
#[derive(Clone, Debug, PartialEq)]
pub struct ReliefBump {
    /// Q: the bump is where it is negative.
    pub field: Relief,
    /// f: positive makes a hill, negative a hollow.
    pub factor: f64,
    /// A box around the bump; none where it goes on without end.
    bounds: Option<Bounds>,
}

/// Where a bound shall hold.
#[derive(Clone, Copy, Debug)]
pub enum Zone<'a> {
    /// All over a box.
    Box(&'a Bounds),
    /// On the segment or the triangle between points: much less than their box where it lies along a surface.
    Between(&'a [DVec3]),
}

impl Zone<'_> {
    /// The smallest box that holds it.
    fn bounds(&self) -> Bounds {
        match self {
            Self::Box(bounds) => **bounds,
            Self::Between(corners) => Bounds::of_points(corners.iter().copied()),
        }
    }

    /// Bounds on a quadric.
    fn values(&self, of: &Quadric) -> Interval {
        match self {
            Self::Box(bounds) => {
                let (low, high) = of.range(bounds);
                widened(low, high, of.c.abs())
            }
            Self::Between(corners) => {
                let values: Vec<f64> = corners.iter().map(|corner| of.value(*corner)).collect();
                let spread = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
                let extremes = values.iter().copied().chain(turning(of, corners, &values));
                let (low, high) = extremes.fold((f64::INFINITY, f64::NEG_INFINITY), spread);
                let terms = corners.iter().map(|corner| of.b.dot(*corner).abs() + of.bent(*corner).abs());
                widened(low, high, terms.fold(of.c.abs(), f64::max))
            }
        }
    }

    /// Bounds on the slope of a quadric along a direction, which is linear.
    fn slope(&self, of: &Quadric, along: DVec3) -> Interval {
        match self {
            Self::Box(bounds) => {
                let center = of.gradient(bounds.center()).dot(along);
                let half = (bounds.max - bounds.min) / 2.0;
                let reach = (of.a * along * 2.0).abs().dot(half);
                widened(center - reach, center + reach, center.abs())
            }
            Self::Between(corners) => {
                let slopes = corners.iter().map(|corner| of.gradient(*corner).dot(along));
                let spread = |(low, high): (f64, f64), slope: f64| (low.min(slope), high.max(slope));
                let (low, high) = slopes.fold((f64::INFINITY, f64::NEG_INFINITY), spread);
                widened(low, high, of.b.dot(along).abs())
            }
        }
    }
}

/// Values of a quadric where it does not change to first order: on the sides between corners, and inside of a triangle.
fn turning(of: &Quadric, corners: &[DVec3], values: &[f64]) -> Vec<f64> {
    let mut found = Vec::with_capacity(4);
    let bent = |i: usize, j: usize| of.bent(corners[j] - corners[i]);
    for j in 1..corners.len() {
        for i in 0..j {
            // a (1 - t) + b t - t (1 - t) bent.
            let (a, b, bent) = (values[i], values[j], bent(i, j));
            let t = 0.5 * (1.0 - (b - a) / bent);
            if t > 0.0 && t < 1.0 {
                found.push(a * (1.0 - t) + b * t - t * (1.0 - t) * bent);
            }
        }
    }
    if let ([_, _, _], [a, b, c]) = (corners, values) {
        let (p, q, r) = (bent(0, 1), bent(0, 2), bent(1, 2));
        let (slope_u, slope_v, mixed) = (b - a - p, c - a - q, p + q - r);
        let det = 4.0 * p * q - mixed * mixed;
        let (u, v) =
            ((mixed * slope_v - 2.0 * q * slope_u) / det, (mixed * slope_u - 2.0 * p * slope_v) / det);
        if u > 0.0 && v > 0.0 && u + v < 1.0 {
            found.push(a + 0.5 * (slope_u * u + slope_v * v));
        }
    }
    found
}

fn apart(a: &Bounds, b: &Bounds) -> bool {
    a.max.cmplt(b.min).any() || b.max.cmplt(a.min).any()
}

fn exactly(number: f64) -> Interval {
    Interval::new(number, number)
}

/// The numbers from `low` to `high`, widened for the rounding of the sums they come from.
fn widened(low: f64, high: f64, terms: f64) -> Interval {
    let slack = 1e-14 * (low.abs() + high.abs() + terms);
    Interval::new(low - slack, high + slack)
}

impl ReliefBump {
    /// A bump with the box that it reaches over.
    #[must_use]
    pub fn new(field: Relief, factor: f64) -> Self {
        let bounds = field.bounds();
        Self { field, factor, bounds }
    }

    /// A box around the bump; none where it goes on without end.
    #[must_use]
    pub fn bounds(&self) -> Option<&Bounds> {
        self.bounds.as_ref()
    }

    fn misses(&self, within: &Bounds) -> bool {
        self.bounds.as_ref().is_some_and(|own| apart(own, within))
    }

    /// What is negative of the values over a zone; none where it surely has no bump.
    #[must_use]
    pub fn depth(&self, within: Zone<'_>) -> Option<Interval> {
        if self.bounds.is_some() && self.misses(&within.bounds()) {
            return None;
        }
        let values = self.field.values(within);
        (values.low < 0.0).then(|| Interval::new(values.low, values.high.min(0.0)))
    }
}

impl Relief {
    /// A quadric without bumps.
    #[must_use]
    pub fn smooth(base: Quadric) -> Self {
        Self { base, bumps: Vec::new() }
    }

    /// The relief that a field is: a quadric, a half space, one of these moved or perturbed by such, and sums of quadrics.
    /// `None` for other fields.
    #[must_use]
    pub fn of(field: &AnyField) -> Option<Self> {
        match field {
            AnyField::Quadric(quadric) => Some(Self::smooth(**quadric)),
            AnyField::Primitive(Primitive::Plane { normal, offset }) => {
                Some(Self::smooth(Quadric::new(DVec3::ZERO, DVec3::ZERO, *normal, -offset)))
            }
            AnyField::Placed(placed) => Some(Self::of(&placed.of)?.mapped(&placed.back, placed.scale)),
            AnyField::Grown { of, by } => {
                let mut inner = Self::of(of)?;
                inner.base.c -= by;
                Some(inner)
            }
            AnyField::Sum(sum) => {
                let mut whole = Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, sum.constant);
                let mut bumps = Vec::new();
                for (weight, part) in &sum.of {
                    let part = Self::of(part)?;
                    whole = whole.plus(&part.base, *weight);
                    let weighted = |bump: ReliefBump| ReliefBump { factor: bump.factor * weight, ..bump };
                    bumps.extend(part.bumps.into_iter().map(weighted));
                }
                Some(Self { base: whole, bumps })
            }
            AnyField::Perturbed(perturbed) => {
                let mut relief = Self::of(&perturbed.base)?;
                for bump in &perturbed.bumps {
                    relief.bumps.push(ReliefBump::new(Self::of(&bump.field)?, bump.factor));
                }
                Some(relief)
            }
            _ => None,
        }
    }

    /// Values of `scale` times the relief at `back` of a point. The factors of bumps are those of squares, which grow with
    /// the square of the scale.
    fn mapped(&self, back: &DAffine3, scale: f64) -> Self {
        let moved = |bump: &ReliefBump| ReliefBump::new(bump.field.mapped(back, scale), bump.factor / scale);
        let zero = Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        Self {
            base: zero.plus(&self.base.mapped(back), scale),
            bumps: self.bumps.iter().map(moved).collect(),
        }
    }

    /// The same as a field of the language.
    #[must_use]
    pub fn field(&self) -> AnyField {
        Self::on(AnyField::Quadric(Box::new(self.base)), &self.bumps)
    }

    /// Bumps on any base.
    #[must_use]
    pub fn on(base: AnyField, bumps: &[ReliefBump]) -> AnyField {
        if bumps.is_empty() {
            return base;
        }
        let bumps = bumps.iter().map(|bump| Bump { field: bump.field.field(), factor: bump.factor });
        AnyField::Perturbed(Perturbed { base: Box::new(base), bumps: bumps.collect() })
    }

    /// F' at a point.
    #[must_use]
    pub fn value(&self, point: DVec3) -> f64 {
        self.value_gradient(point).0
    }

    /// F' and its derivative.
    #[must_use]
    pub fn value_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let (mut value, mut gradient) = (self.base.value(point), self.base.gradient(point));
        for bump in &self.bumps {
            let beside = |own: &Bounds| point.cmplt(own.min).any() || point.cmpgt(own.max).any();
            if bump.bounds.as_ref().is_some_and(beside) {
                continue;
            }
            let (depth, slope) = bump.field.value_gradient(point);
            if depth < 0.0 {
                value -= bump.factor * depth * depth;
                gradient -= slope * (2.0 * bump.factor * depth);
            }
        }
        (value, gradient)
    }

    /// Bounds on F' over a zone.
    #[must_use]
    pub fn values(&self, within: Zone<'_>) -> Interval {
        let mut sum = within.values(&self.base);
        for bump in &self.bumps {
            let Some(depth) = bump.depth(within) else { continue };
            sum = minus(sum, times(exactly(bump.factor), <Interval as Algebra>::power(depth, 2.0)));
        }
        sum
    }

    /// Bounds on the derivative along a direction of any length, over a zone.
    #[must_use]
    pub fn slope(&self, within: Zone<'_>, along: DVec3) -> Interval {
        let mut sum = within.slope(&self.base, along);
        for bump in &self.bumps {
            let Some(depth) = bump.depth(within) else { continue };
            let part = times(depth, bump.field.slope(within, along));
            sum = minus(sum, times(exactly(2.0 * bump.factor), part));
        }
        sum
    }

    /// Bounds on the second derivative along a direction of any length, over a zone; where it jumps on both sides.
    #[must_use]
    pub fn second(&self, within: Zone<'_>, along: DVec3) -> Interval {
        let bent = 2.0 * self.base.bent(along);
        let mut sum = widened(bent, bent, 0.0);
        for bump in &self.bumps {
            let Some(depth) = bump.depth(within) else { continue };
            let square = <Interval as Algebra>::power(bump.field.slope(within, along), 2.0);
            let whole = plus(square, times(depth, bump.field.second(within, along)));
            // Beside the rim there is no bump.
            let whole = if depth.high < 0.0 { whole } else { whole.hull(exactly(0.0)) };
            sum = minus(sum, times(exactly(2.0 * bump.factor), whole));
        }
        sum
    }

    /// A bound on the size of the second derivative in any direction, over a box.
    #[must_use]
    pub fn bend(&self, within: &Bounds) -> f64 {
        let bump = |bump: &ReliefBump| {
            let depth = bump.depth(Zone::Box(within))?.size();
            let steep = bump.field.steepness(within);
            Some(2.0 * bump.factor.abs() * (steep * steep + depth * bump.field.bend(within)))
        };
        2.0 * self.base.stretch() + self.bumps.iter().filter_map(bump).sum::<f64>()
    }

    /// A bound on the length of the gradient, over a box.
    #[must_use]
    pub fn steepness(&self, within: &Bounds) -> f64 {
        let center = self.base.gradient(within.center()).length();
        let own = center + self.base.stretch() * within.diagonal();
        let bump = |bump: &ReliefBump| {
            let depth = bump.depth(Zone::Box(within))?.size();
            Some(2.0 * bump.factor.abs() * depth * bump.field.steepness(within))
        };
        own + self.bumps.iter().filter_map(bump).sum::<f64>()
    }

    /// A box that holds all points where F' < 0; none where they go on without end.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let form = QuadricForm::anywhere(&self.base);
        let own = match form.kind {
            QuadricKind::Ellipsoid if self.base.bent(DVec3::X) > 0.0 => form.box_around(),
            // Positive everywhere, but for a point.
            QuadricKind::Empty | QuadricKind::Point if self.base.value(form.origin) >= 0.0 => Bounds::EMPTY,
            _ => return None,
        };
        let hills = self.bumps.iter().filter(|bump| bump.factor > 0.0);
        hills.map(|hill| hill.bounds).try_fold(own, |all, hill| Some(all.union(hill?)))
    }

    /// How many quadrics it is made of.
    #[must_use]
    pub fn weight(&self) -> u64 {
        1 + self.bumps.iter().map(|bump| bump.field.weight()).sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::{Relief, ReliefBump, Zone};
    use crate::geometry::field::{AnyField, Bump, Field, Perturbed, Placed, Primitive, Quadric};
    use crate::geometry::number::{Bounds, sin};

    /// A quadric with a hill, which has a dent and a ridge without end.
    fn field() -> AnyField {
        let quadric = |squares: DVec3, linear: DVec3, constant: f64| {
            AnyField::Quadric(Box::new(Quadric::new(squares, DVec3::new(0.3, -0.2, 0.1), linear, constant)))
        };
        let perturbed = |base: AnyField, bumps: Vec<(AnyField, f64)>| {
            let bumps = bumps.into_iter().map(|(field, factor)| Bump { field, factor }).collect();
            AnyField::Perturbed(Perturbed { base: Box::new(base), bumps })
        };
        let dent = quadric(DVec3::new(9.0, 8.0, 7.0), DVec3::new(-1.0, 2.0, 0.5), -0.8);
        let ridge = quadric(DVec3::new(6.0, 0.0, 5.0), DVec3::ZERO, -0.5);
        let hill =
            perturbed(quadric(DVec3::new(2.0, 3.0, 1.5), DVec3::X, -1.0), vec![(dent, -0.7), (ridge, 0.4)]);
        let map = DAffine3::from_rotation_z(0.6)
            * DAffine3::from_translation(DVec3::new(0.2, 0.1, 0.0))
            * DAffine3::from_scale(DVec3::splat(0.8));
        let plane = AnyField::Primitive(Primitive::Plane { normal: DVec3::Z, offset: 0.2 });
        perturbed(plane, vec![(AnyField::Placed(Placed::new(hill, &map)), 0.6)])
    }

    fn point(k: u32) -> DVec3 {
        let t = f64::from(k);
        DVec3::new(sin(1.7 * t), sin(2.3 * t + 0.4), sin(3.1 * t + 1.1))
    }

    #[test]
    fn a_relief_is_the_field_it_came_from() {
        let field = field();
        let relief = Relief::of(&field).expect("made of quadrics");
        let again = relief.field();
        for k in 0..200 {
            let at = point(k);
            let (value, gradient) = relief.value_gradient(at);
            assert!((value - field.value(at)).abs() < 1e-12, "{at}");
            assert!(gradient.distance(field.gradient(at)) < 1e-12, "{at}");
            assert!((value - again.value(at)).abs() < 1e-12, "{at}");
        }
        assert_eq!(Relief::of(&AnyField::Primitive(Primitive::Sphere { radius: 1.0 })), None);
    }

    #[test]
    fn bounds_hold_all_over_their_zones() {
        let relief = Relief::of(&field()).expect("made of quadrics");
        for k in 0..300 {
            let size = 0.4 / (1.0 + f64::from(k % 8));
            let corners = [point(k), point(k) + point(k + 7) * size, point(k) + point(k + 13) * size];
            let along = point(k + 21);
            let whole = Bounds::of_points(corners);
            for zone in [Zone::Box(&whole), Zone::Between(&corners)] {
                let (values, slope, second) =
                    (relief.values(zone), relief.slope(zone, along), relief.second(zone, along));
                for i in 0..=8 {
                    for j in 0..=8 - i {
                        let (s, t) = (f64::from(i) / 8.0, f64::from(j) / 8.0);
                        let at = corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t;
                        let (value, gradient) = relief.value_gradient(at);
                        assert!(values.contains(value), "{value} {values:?}");
                        assert!(slope.contains(gradient.dot(along)), "{gradient} {slope:?}");
                        let step = 1e-5;
                        let slopes = [1.0, -1.0]
                            .map(|side| relief.value_gradient(at + along * (side * step)).1.dot(along));
                        let bend = (slopes[0] - slopes[1]) / (2.0 * step);
                        // Differences round, and reach over rims that lie just beside the zone.
                        let slack = 1e-3 * (1.0 + second.size());
                        assert!(bend > second.low - slack && bend < second.high + slack, "{bend} {second:?}");
                        assert!(bend.abs() <= relief.bend(&whole) * along.length_squared() + slack);
                        assert!(gradient.length() <= relief.steepness(&whole) + 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn a_box_holds_all_that_is_inside() {
        let relief = |center: DVec3, constant: f64| {
            Relief::smooth(Quadric::new(DVec3::new(4.0, 1.0, 9.0), DVec3::ZERO, -2.0 * center, constant))
        };
        let mut one = relief(DVec3::ZERO, -1.0);
        assert_eq!(one.bounds().expect("an ellipsoid").max.y.to_bits(), 1.0_f64.to_bits());
        one.bumps.push(ReliefBump::new(relief(DVec3::new(3.0, 1.0, 0.0), 2.0), 50.0));
        let bounds = one.bounds().expect("both end");
        for k in 0..4000 {
            let at = point(k) * 2.0;
            let beside = at.cmplt(bounds.min).any() || at.cmpgt(bounds.max).any();
            assert!(!beside || one.value(at) >= 0.0, "{at}");
        }
        let endless = Quadric::new(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO, DVec3::ZERO, -1.0);
        one.bumps.push(ReliefBump::new(Relief::smooth(endless), 1.0));
        assert_eq!(one.bounds(), None);
    }
}
