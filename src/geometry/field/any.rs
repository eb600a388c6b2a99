//! Any field of the language, in any kind of number.

use std::sync::Arc;

use glam::DVec3;

use super::tree::{Joined, Placed, Sum};
use super::{Blend, Distance, Field, Join, Perturbed, Primitive, Quadric, Skeleton, Study};
use crate::geometry::formula::{
    Algebra, Binary, Formula, Interval, Jet, Operation, Unary, minus, plus, times,
};
use crate::geometry::number::Bounds;

/// A field of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyField {
    /// A simple body.
    Primitive(Primitive),
    /// Potentials of elements.
    Skeleton(Box<Skeleton>),
    /// A formula of x, y and z.
    Formula(Box<Formula>),
    /// A polynomial of the second degree.
    Quadric(Box<Quadric>),
    /// Several, joined.
    Joined(Joined),
    /// Several, added up.
    Sum(Sum),
    /// Another one, somewhere else.
    Placed(Placed),
    /// Another one with bumps.
    Perturbed(Perturbed),
    /// The skin of another one.
    Skin {
        /// The other one.
        of: Box<Self>,
        /// Half of its thickness.
        half: f64,
    },
    /// The distance to a shape that is not made yet, by its number; it has no value.
    Shape(usize),
    /// The distance to a shape.
    Distance(Arc<Distance>),
    /// Another one, its surface moved outward.
    Grown {
        /// The other one.
        of: Box<Self>,
        /// How far, where values are distances.
        by: f64,
    },
}

/// A field that is not written for every kind of number: values, derivatives and bounds by functions of its own.
pub(super) trait Leaf {
    fn leaf_value(&self, point: DVec3) -> f64;
    fn leaf_gradient(&self, point: DVec3) -> (f64, DVec3);
    fn leaf_study(&self, within: &Bounds) -> Study;
}

impl Leaf for Skeleton {
    fn leaf_value(&self, point: DVec3) -> f64 {
        self.value(point)
    }

    fn leaf_gradient(&self, point: DVec3) -> (f64, DVec3) {
        self.value_gradient(point)
    }

    fn leaf_study(&self, within: &Bounds) -> Study {
        self.study(within)
    }
}

impl Leaf for Quadric {
    fn leaf_value(&self, point: DVec3) -> f64 {
        self.value(point)
    }

    fn leaf_gradient(&self, point: DVec3) -> (f64, DVec3) {
        (self.value(point), self.gradient(point))
    }

    fn leaf_study(&self, within: &Bounds) -> Study {
        let (low, high) = self.range(within);
        let slack = 1e-13 * (low.abs() + high.abs());
        let slopes = self.gradient_range(within);
        let (min, max) = (slopes.min.to_array(), slopes.max.to_array());
        Study {
            value: Interval::new(low - slack, high + slack),
            gradient: [0, 1, 2].map(|axis| {
                let slack = 1e-13 * (min[axis].abs() + max[axis].abs());
                Interval::new(min[axis] - slack, max[axis] + slack)
            }),
        }
    }
}

/// Numbers in which fields can be evaluated.
pub(super) trait Space: Algebra {
    /// A leaf at a place whose coordinates are such numbers.
    fn leaf(of: &impl Leaf, place: [Self; 3]) -> Self;
}

impl Space for f64 {
    fn leaf(of: &impl Leaf, place: [Self; 3]) -> Self {
        of.leaf_value(DVec3::from_array(place))
    }
}

impl Space for Interval {
    fn leaf(of: &impl Leaf, place: [Self; 3]) -> Self {
        of.leaf_study(&box_of(place)).value
    }
}

fn box_of(place: [Interval; 3]) -> Bounds {
    Bounds {
        min: DVec3::from_array(place.map(|side| side.low)),
        max: DVec3::from_array(place.map(|side| side.high)),
    }
}

/// First derivatives alone: fields ask for no more.
type Slope<T> = Jet<T, 3, false>;

/// What a leaf gives, by the variables of its place.
fn chained<T: Algebra>(value: T, gradient: [T; 3], place: &[Slope<T>; 3]) -> Slope<T>
where
    Slope<T>: Algebra,
{
    let mut jet = Jet { value, first: [T::constant(0.0); 3], second: [[T::constant(0.0); 3]; 3] };
    for axis in 0..3 {
        let parts = (0..3).map(|k| times(gradient[k], place[k].first[axis]));
        jet.first[axis] = parts.reduce(plus).unwrap_or(T::constant(0.0));
    }
    jet
}

impl Space for Slope<f64> {
    fn leaf(of: &impl Leaf, place: [Self; 3]) -> Self {
        let (value, gradient) = of.leaf_gradient(DVec3::from_array(place.map(|part| part.value)));
        chained(value, gradient.to_array(), &place)
    }
}

impl Space for Slope<Interval> {
    fn leaf(of: &impl Leaf, place: [Self; 3]) -> Self {
        let study = of.leaf_study(&box_of(place.map(|part| part.value)));
        chained(study.value, study.gradient, &place)
    }
}

impl AnyField {
    /// The field in any kind of number.
    pub(super) fn evaluate<S: Space>(&self, place: [S; 3]) -> S {
        match self {
            Self::Primitive(body) => body.evaluate(place),
            Self::Skeleton(skeleton) => S::leaf(skeleton.as_ref(), place),
            Self::Formula(formula) => {
                let [value] = formula.evaluate::<S, 1>(&place);
                value
            }
            Self::Quadric(quadric) => S::leaf(quadric.as_ref(), place),
            Self::Shape(_) => S::constant(f64::NAN),
            Self::Distance(shape) => S::leaf(shape.as_ref(), place),
            Self::Joined(joined) => joined.evaluate(place),
            Self::Sum(sum) => sum.evaluate(place),
            Self::Placed(placed) => placed.evaluate(place),
            Self::Perturbed(perturbed) => perturbed.evaluate(place),
            // (f² - h²) / 2h has its zeros where |f| is h, slopes of the same size there, and no kink.
            Self::Skin { of, half } => {
                let square = S::power(of.evaluate(place), 2.0);
                minus(times(S::constant(0.5 / half), square), S::constant(half / 2.0))
            }
            Self::Grown { of, by } => minus(of.evaluate(place), S::constant(*by)),
        }
    }

    /// Value and derivative.
    #[must_use]
    pub fn value_gradient(&self, point: DVec3) -> (f64, DVec3) {
        match self {
            Self::Skeleton(skeleton) => skeleton.value_gradient(point),
            Self::Quadric(quadric) => quadric.leaf_gradient(point),
            Self::Distance(shape) => shape.leaf_gradient(point),
            Self::Perturbed(perturbed) => perturbed.value_gradient(point),
            Self::Joined(_) | Self::Sum(_) | Self::Placed(_) | Self::Skin { .. } | Self::Grown { .. } => {
                self.made_of(point, Self::value_gradient)
            }
            Self::Primitive(_) | Self::Formula(_) | Self::Shape(_) => {
                let place = point.to_array();
                let jet = self.evaluate([0, 1, 2].map(|axis| Slope::<f64>::variable(place[axis], axis)));
                (jet.value, DVec3::from_array(jet.first))
            }
        }
    }

    /// Value and derivative, where triangles stand for a smooth shape with the normals of that one.
    #[must_use]
    pub fn value_normal(&self, point: DVec3) -> (f64, DVec3) {
        match self {
            Self::Distance(shape) => shape.slope(point),
            Self::Joined(_) | Self::Sum(_) | Self::Placed(_) | Self::Skin { .. } | Self::Grown { .. } => {
                self.made_of(point, Self::value_normal)
            }
            _ => self.value_gradient(point),
        }
    }

    /// Value and derivative of what is made of others, from theirs.
    fn made_of(&self, point: DVec3, each: fn(&Self, DVec3) -> (f64, DVec3)) -> (f64, DVec3) {
        match self {
            Self::Joined(joined) => joined.value_gradient(point, each),
            Self::Sum(sum) => sum.value_gradient(point, each),
            Self::Placed(placed) => placed.value_gradient(point, each),
            Self::Skin { of, half } => {
                let (value, gradient) = each(of, point);
                ((value * value / half - half) / 2.0, gradient * (value / half))
            }
            Self::Grown { of, by } => {
                let (value, gradient) = each(of, point);
                (value - by, gradient)
            }
            _ => each(self, point),
        }
    }

    /// Bounds on values over a box.
    #[must_use]
    pub fn values(&self, within: &Bounds) -> Interval {
        self.evaluate(sides(within))
    }

    /// Bounds on values and derivatives over a box.
    #[must_use]
    pub fn study(&self, within: &Bounds) -> Study {
        match self {
            Self::Skeleton(skeleton) => skeleton.study(within),
            Self::Perturbed(perturbed) => perturbed.study(within),
            Self::Joined(joined) => joined.study(within),
            Self::Placed(placed) => placed.study(within),
            Self::Distance(shape) => shape.leaf_study(within),
            _ => {
                let sides = sides(within);
                let jet = self.evaluate([0, 1, 2].map(|axis| Slope::variable(sides[axis], axis)));
                Study { value: jet.value, gradient: jet.first }
            }
        }
    }

    /// Of a skeleton, moved or not, what each element adds at a point; none of other fields.
    #[must_use]
    pub fn shares(&self, point: DVec3) -> Vec<f64> {
        match self {
            Self::Skeleton(skeleton) => skeleton.shares(point),
            Self::Placed(placed) => placed.of.shares(placed.back.transform_point3(point)),
            Self::Sum(sum) => sum.of.first().map_or_else(Vec::new, |(_, of)| of.shares(point)),
            Self::Skin { of, .. } | Self::Grown { of, .. } => of.shares(point),
            _ => Vec::new(),
        }
    }

    /// Whether its surface may have edges.
    #[must_use]
    pub fn has_kinks(&self) -> bool {
        match self {
            Self::Primitive(body) => body.has_edges(),
            Self::Skeleton(skeleton) => skeleton.has_kinks(),
            Self::Quadric(_) | Self::Shape(_) => false,
            Self::Distance(shape) => shape.has_edges(),
            Self::Formula(formula) => formula.operations().iter().any(kinked),
            Self::Joined(joined) => {
                !matches!(
                    joined.join,
                    Join::Union(Blend::Smooth(_))
                        | Join::Intersection(Blend::Smooth(_))
                        | Join::Difference(Blend::Smooth(_))
                ) || joined.of.iter().any(Self::has_kinks)
            }
            Self::Sum(sum) => sum.of.iter().any(|(_, field)| field.has_kinks()),
            Self::Placed(placed) => placed.of.has_kinks(),
            Self::Perturbed(perturbed) => {
                perturbed.base.has_kinks() || perturbed.bumps.iter().any(|bump| bump.field.has_kinks())
            }
            // Distances have kinks away from their surface, which may come to lie on the moved one.
            Self::Skin { of, .. } | Self::Grown { of, .. } => {
                of.has_kinks()
                    || matches!(
                        **of,
                        Self::Primitive(Primitive::Box { .. })
                            | Self::Placed(_)
                            | Self::Joined(_)
                            | Self::Distance(_)
                    )
            }
        }
    }

    /// About how many simple bodies one value costs as much as; at least 1.
    #[must_use]
    pub fn weight(&self) -> u64 {
        match self {
            Self::Primitive(_) | Self::Quadric(_) | Self::Shape(_) => 1,
            // Some boxes on the way down the tree, and the triangles at its end.
            Self::Distance(shape) => 4 + u64::from(shape.len().max(1).ilog2()),
            Self::Skeleton(skeleton) => skeleton.weight(),
            Self::Formula(formula) => (formula.operations().len() as u64).max(1),
            Self::Joined(joined) => joined.of.iter().map(Self::weight).sum::<u64>().max(1),
            Self::Sum(sum) => sum.of.iter().map(|(_, field)| field.weight()).sum::<u64>().max(1),
            Self::Placed(placed) => placed.of.weight(),
            Self::Perturbed(perturbed) => {
                perturbed.base.weight() + perturbed.bumps.iter().map(|bump| bump.field.weight()).sum::<u64>()
            }
            Self::Skin { of, .. } | Self::Grown { of, .. } => of.weight(),
        }
    }

    /// Whether values outside are at least distances, so that moving the surface moves its box as far.
    fn is_distance(&self) -> bool {
        match self {
            Self::Primitive(body) => !matches!(body, Primitive::Cone { .. }),
            Self::Placed(placed) => placed.of.is_distance(),
            Self::Joined(joined) => {
                matches!(joined.join, Join::Union(Blend::Sharp)) && joined.of.iter().all(Self::is_distance)
            }
            Self::Grown { of, .. } => of.is_distance(),
            Self::Distance(_) => true,
            // The values of a skin are squares.
            _ => false,
        }
    }

    /// Whether its values are known not to jump, whatever their bounds say: those of some bodies are chosen between two
    /// distances that agree where the choice changes.
    #[must_use]
    pub fn is_continuous(&self) -> bool {
        match self {
            Self::Primitive(_) | Self::Skeleton(_) | Self::Quadric(_) | Self::Distance(_) => true,
            Self::Formula(_) | Self::Shape(_) => false,
            Self::Joined(joined) => joined.of.iter().all(Self::is_continuous),
            Self::Sum(sum) => sum.of.iter().all(|(_, field)| field.is_continuous()),
            Self::Placed(placed) => placed.of.is_continuous(),
            Self::Perturbed(perturbed) => {
                perturbed.base.is_continuous()
                    && perturbed.bumps.iter().all(|bump| bump.field.is_continuous())
            }
            Self::Skin { of, .. } | Self::Grown { of, .. } => of.is_continuous(),
        }
    }

    /// A box that holds the surface and all that is inside of it; none where no such box is known.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Primitive(body) => body.bounds(),
            Self::Skeleton(skeleton) => Some(skeleton.bounds()),
            Self::Joined(joined) => joined.bounds(),
            Self::Placed(placed) => placed.bounds(),
            Self::Quadric(quadric) => quadric.ends(),
            Self::Distance(shape) => Some(shape.bounds()),
            Self::Perturbed(perturbed) => perturbed.bounds(),
            Self::Skin { of, half: by } | Self::Grown { of, by } if of.is_distance() => {
                let inner = of.bounds()?;
                Some(Bounds { min: inner.min - *by, max: inner.max + *by })
            }
            Self::Formula(_) | Self::Shape(_) | Self::Sum(_) | Self::Skin { .. } | Self::Grown { .. } => None,
        }
    }
}

/// Whether an operation has kinks or jumps.
fn kinked(operation: &Operation) -> bool {
    match operation {
        Operation::Unary(unary, _) => {
            matches!(unary, Unary::Abs | Unary::Sign | Unary::Floor | Unary::Round | Unary::Not)
        }
        Operation::Binary(binary, ..) => matches!(
            binary,
            Binary::Minimum
                | Binary::Maximum
                | Binary::Less
                | Binary::LessOrEqual
                | Binary::Equal
                | Binary::And
                | Binary::Or
        ),
        Operation::Select(..) => true,
        _ => false,
    }
}

fn sides(within: &Bounds) -> [Interval; 3] {
    let (min, max) = (within.min.to_array(), within.max.to_array());
    [0, 1, 2].map(|axis| Interval::new(min[axis], max[axis]))
}

impl Field for AnyField {
    fn value(&self, point: DVec3) -> f64 {
        self.evaluate(point.to_array())
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        self.value_gradient(point).1
    }

    fn range(&self, within: &Bounds) -> (f64, f64) {
        let values = self.values(within);
        (values.low, values.high)
    }

    fn gradient_range(&self, within: &Bounds) -> Bounds {
        box_of(self.study(within).gradient)
    }

    fn bend(&self, within: &Bounds) -> f64 {
        match self {
            Self::Skeleton(skeleton) => skeleton.bend(within),
            Self::Quadric(quadric) => quadric.bend(within),
            _ => f64::INFINITY,
        }
    }
}
