//! Skeletons: elements with potentials that add up; the surface lies where the sum reaches a level.
//!
//! Promise: what is beyond the reach of a potential costs nothing and does not change a bit of the result; ranges
//! over boxes hold every value. Gaussian potentials reach without end. (1 - d²/R²) alone is only continuous at its
//! rim: there the surface has a crease wherever another element carries it.
//!
//! Sources: J. Blinn, A generalization of algebraic surface drawing, 1982 (Gaussian); H. Nishimura and others,
//! Metaballs, 1985; G. Wyvill, C. `McPheeters`, B. Wyvill, Data structure for soft objects, The Visual Computer 2
//! (1986): 1 - 4/9 d⁶/R⁶ + 17/9 d⁴/R⁴ - 22/9 d²/R².

use glam::DVec3;

use super::{Element, Form, Study};
use crate::geometry::formula::{Interval, Quality};
use crate::geometry::number::{Bounds, exp, ln};

/// How a potential of strength 1 falls off with the distance d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Potential {
    /// e^(-sharpness d²).
    Gaussian {
        /// How fast.
        sharpness: f64,
    },
    /// (1 - d²/R²)^n up to R, then 0.
    Power {
        /// Where it ends.
        radius: f64,
        /// 1, 2 or 3.
        exponent: u32,
    },
    /// Wyvill's polynomial of the sixth degree up to R, then 0.
    Wyvill {
        /// Where it ends.
        radius: f64,
    },
}

impl Potential {
    /// The square of the distance at which it ends.
    fn end(self) -> f64 {
        match self {
            Self::Gaussian { .. } => f64::INFINITY,
            Self::Power { radius, .. } | Self::Wyvill { radius } => radius * radius,
        }
    }

    /// Whether it ends with a slope.
    fn ends_hard(self) -> bool {
        matches!(self, Self::Power { exponent: 1, .. })
    }

    /// The value at the square of a distance.
    fn value(self, square: f64) -> f64 {
        match self {
            Self::Gaussian { sharpness } => exp(-sharpness * square),
            _ if square >= self.end() => 0.0,
            Self::Power { radius, exponent } => {
                let rest = 1.0 - square / (radius * radius);
                match exponent {
                    1 => rest,
                    2 => rest * rest,
                    _ => rest * rest * rest,
                }
            }
            Self::Wyvill { radius } => {
                let s = square / (radius * radius);
                1.0 + s * (-22.0 + s * (17.0 - 4.0 * s)) / 9.0
            }
        }
    }

    /// Its derivative by the square of the distance. It rises with the square, up to 0.
    fn slope(self, square: f64) -> f64 {
        match self {
            Self::Gaussian { sharpness } => -sharpness * exp(-sharpness * square),
            _ if square >= self.end() => 0.0,
            Self::Power { radius, exponent } => {
                let r = radius * radius;
                let rest = 1.0 - square / r;
                match exponent {
                    1 => -1.0 / r,
                    2 => -2.0 / r * rest,
                    _ => -3.0 / r * rest * rest,
                }
            }
            Self::Wyvill { radius } => {
                let r = radius * radius;
                let s = square / r;
                (-22.0 + s * (34.0 - 12.0 * s)) / (9.0 * r)
            }
        }
    }

    /// The greatest size of its second derivative by the square of the distance.
    fn curve(self) -> f64 {
        match self {
            Self::Gaussian { sharpness } => sharpness * sharpness,
            Self::Power { radius, exponent } => {
                [0.0, 2.0, 6.0][exponent as usize - 1] / (radius * radius * radius * radius)
            }
            Self::Wyvill { radius } => 34.0 / (9.0 * (radius * radius * radius * radius)),
        }
    }

    /// The distance beyond which it stays below a share of its value at 0.
    fn reach(self, share: f64) -> f64 {
        match self {
            Self::Gaussian { sharpness } if share >= 1.0 => 0.0 * sharpness,
            Self::Gaussian { sharpness } => (-ln(share) / sharpness).sqrt(),
            Self::Power { radius, .. } | Self::Wyvill { radius } => radius,
        }
    }
}

/// Elements whose potentials add up; negative inside, where the sum is greater than the level.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    elements: Vec<Element>,
    /// For each element a box around its potential.
    boxes: Vec<Bounds>,
    level: f64,
}

impl Skeleton {
    /// How many elements it has.
    pub(super) fn len(&self) -> usize {
        self.elements.len()
    }

    /// About how many simple bodies one value costs as much as.
    pub(super) fn weight(&self) -> u64 {
        let of = |element: &Element| match &element.form {
            Form::Point(_) | Form::Segment(..) => 1,
            Form::Triangles(all) => all.len() as u64,
            // The nearest place of a curve takes several steps.
            Form::Curves(all) => 8 * all.len() as u64,
        };
        self.elements.iter().map(of).sum::<u64>().max(1)
    }

    /// Of these elements, with the surface where the potentials reach `level`, which is positive.
    #[must_use]
    pub fn new(elements: Vec<Element>, level: f64) -> Self {
        let boxes = elements.iter().map(|element| {
            let (own, end) = (element.form.bounds(), element.potential.end().sqrt());
            Bounds { min: own.min - end, max: own.max + end }
        });
        Self { boxes: boxes.collect(), elements, level }
    }

    /// Its elements.
    #[must_use]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    fn near(&self, point: DVec3) -> impl Iterator<Item = &Element> {
        let inside = move |within: &Bounds| point.cmpge(within.min).all() && point.cmple(within.max).all();
        self.elements
            .iter()
            .zip(&self.boxes)
            .filter(move |(_, within)| inside(within))
            .map(|(element, _)| element)
    }

    /// The value.
    #[must_use]
    pub fn value(&self, point: DVec3) -> f64 {
        let part = |element: &Element| {
            element.strength * element.potential.value(element.form.away(point).length_squared())
        };
        self.level - self.near(point).map(part).sum::<f64>()
    }

    /// Value and derivative.
    #[must_use]
    pub fn value_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let (mut value, mut gradient) = (self.level, DVec3::ZERO);
        for element in self.near(point) {
            let away = element.form.away(point);
            let square = away.length_squared();
            value -= element.strength * element.potential.value(square);
            gradient -= away * (2.0 * element.strength * element.potential.slope(square));
        }
        (value, gradient)
    }

    /// Whether its surface may have edges: where a potential ends with a slope, or the nearest place of an element jumps.
    #[must_use]
    pub fn has_kinks(&self) -> bool {
        self.elements.iter().any(|element| element.potential.ends_hard() || !element.form.is_convex())
    }

    /// What each element adds at a point; negative ones take away.
    #[must_use]
    pub fn shares(&self, point: DVec3) -> Vec<f64> {
        let share = |element: &Element| {
            element.strength * element.potential.value(element.form.away(point).length_squared())
        };
        self.elements.iter().map(share).collect()
    }

    /// Bounds on values and derivatives over a box.
    #[must_use]
    pub fn study(&self, within: &Bounds) -> Study {
        let (center, radius) = (within.center(), within.diagonal() / 2.0);
        let (mut low, mut high) = (self.level, self.level);
        let mut gradient = [[0.0; 2]; 3];
        let mut quality = Quality::Smooth;
        for (element, reach) in self.elements.iter().zip(&self.boxes) {
            if within.min.cmpgt(reach.max).any() || within.max.cmplt(reach.min).any() {
                continue;
            }
            let ways = element.form.ways(center, radius);
            let distance = element.form.away(center).length();
            let (near, far) = ((distance - radius).max(0.0), distance + radius);
            let squares = (near * near * (1.0 - 1e-14), far * far * (1.0 + 1e-14));
            let (potential, strength) = (element.potential, element.strength);
            let values = [potential.value(squares.0) * strength, potential.value(squares.1) * strength];
            low -= values[0].max(values[1]);
            high -= values[0].min(values[1]);
            let slopes =
                [potential.slope(squares.0), potential.slope(squares.1)].map(|slope| -2.0 * strength * slope);
            let end = potential.end();
            let ends_here = potential.ends_hard() && squares.0 <= end && end <= squares.1;
            if ends_here || !ways.smooth {
                quality = Quality::Continuous;
            }
            let (min, max) = (ways.within.min.to_array(), ways.within.max.to_array());
            for axis in 0..3 {
                let products = [
                    slopes[0] * min[axis],
                    slopes[0] * max[axis],
                    slopes[1] * min[axis],
                    slopes[1] * max[axis],
                ];
                gradient[axis][0] += products.iter().copied().fold(f64::INFINITY, f64::min);
                gradient[axis][1] += products.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            }
        }
        // Sums of so many numbers are rounded by less than this.
        let slack = 1e-13 * (self.level.abs() + low.abs() + high.abs());
        let wide = |[low, high]: [f64; 2]| {
            let slack = 1e-13 * (low.abs() + high.abs());
            Interval::new(low - slack, high + slack)
        };
        Study {
            value: Interval::new(low - slack, high + slack).at_best(quality),
            gradient: gradient.map(wide),
        }
    }

    /// A bound on second derivatives anywhere, of elements whose distance is smooth.
    #[must_use]
    pub fn bend(&self, within: &Bounds) -> f64 {
        let radius = within.diagonal() / 2.0;
        let part = |element: &Element| {
            let far = element.form.away(within.center()).length() + radius;
            let far = far.min(element.potential.end().sqrt());
            let steepest = element.potential.slope(0.0).abs();
            element.strength.abs() * (2.0 * steepest + 4.0 * element.potential.curve() * far * far)
        };
        self.elements.iter().map(part).sum()
    }

    /// A box outside of which the sum is below the level.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let positive = self.elements.iter().filter(|element| element.strength > 0.0);
        let total: f64 = positive.clone().map(|element| element.strength).sum();
        let around = |element: &Element| {
            // Where every one is below its share of the level, so is the sum.
            let (own, reach) = (element.form.bounds(), element.potential.reach(self.level / total));
            Bounds { min: own.min - reach, max: own.max + reach }
        };
        positive.map(around).fold(Bounds::EMPTY, Bounds::union)
    }
}
