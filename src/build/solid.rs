//! Solid operations of a document into recipes.

use super::Builder;
use crate::geometry::solid::{AVAILABLE, Combination, HalfSpace};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{
    Cut, Hull, Keep, MinkowskiRound, Plane, ShapeReference, Shell, SolidExpression, SolidFormula, SolidSet,
    WallSide,
};
use crate::model::{Hollow, KeptSide, PlaneCut, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// The set operations.
#[derive(Clone, Copy)]
pub(super) enum SetOf {
    Union,
    Difference,
    Intersection,
}

impl Builder<'_> {
    pub(super) fn solid_set(
        &mut self,
        name: &str,
        set: &SolidSet,
        operation: SetOf,
        span: Span,
    ) -> Option<Recipe> {
        let handles = self.shapes_of(name, &set.of);
        self.needs_solids(span)?;
        let handles = handles?;
        let mut parts = Vec::new();
        let mut all: Vec<Combination> =
            handles.into_iter().map(|handle| Combination::Part(number(&mut parts, handle))).collect();
        let how = match operation {
            SetOf::Union => Combination::Union(all),
            SetOf::Intersection => Combination::Intersection(all),
            SetOf::Difference => {
                let first = all.remove(0);
                Combination::Difference(Box::new(first), all)
            }
        };
        Some(Recipe::Solid(SolidRecipe { parts, operation: SolidOperation::Combine(how) }))
    }

    pub(super) fn solid_formula(&mut self, solid: &SolidFormula, span: Span) -> Option<Recipe> {
        let mut parts = Vec::new();
        let how = self.combination(&solid.of.value, &mut parts);
        self.needs_solids(span)?;
        Some(Recipe::Solid(SolidRecipe { parts, operation: SolidOperation::Combine(how?) }))
    }

    /// The combination that an expression says; all its shapes are built, so that no fault hides.
    fn combination(&mut self, of: &SolidExpression, parts: &mut Vec<ShapeHandle>) -> Option<Combination> {
        match of {
            SolidExpression::Shape(name) => {
                let handle = self.named_shape(&name.value)?;
                Some(Combination::Part(number(parts, handle)))
            }
            SolidExpression::Union(one, other) => {
                let (one, other) = (self.combination(one, parts), self.combination(other, parts));
                Some(Combination::Union(match one? {
                    Combination::Union(mut all) => {
                        all.push(other?);
                        all
                    }
                    one => vec![one, other?],
                }))
            }
            SolidExpression::Intersection(one, other) => {
                let (one, other) = (self.combination(one, parts), self.combination(other, parts));
                Some(Combination::Intersection(vec![one?, other?]))
            }
            SolidExpression::Difference(one, other) => {
                let (one, other) = (self.combination(one, parts), self.combination(other, parts));
                Some(match one? {
                    Combination::Difference(first, mut rest) => {
                        rest.push(other?);
                        Combination::Difference(first, rest)
                    }
                    one => Combination::Difference(Box::new(one), vec![other?]),
                })
            }
        }
    }

    pub(super) fn cut(&mut self, name: &str, cut: &Cut, span: Span) -> Option<Recipe> {
        let of = self.shape_of(name, 0, &cut.of);
        if cut.cap.value {
            self.needs_solids(span)?;
        }
        let keep = match cut.keep.value {
            Keep::Above => KeptSide::Above,
            Keep::Below => KeptSide::Below,
            Keep::Both => KeptSide::Both,
        };
        let above = half_space(&cut.plane.value);
        let operation = SolidOperation::Cut(PlaneCut { above, keep, cap: cut.cap.value, gap: cut.gap.value });
        Some(Recipe::Solid(SolidRecipe { parts: vec![of?], operation }))
    }

    pub(super) fn hull(&mut self, name: &str, hull: &Hull, span: Span) -> Option<Recipe> {
        let handles = self.shapes_of(name, &hull.of);
        self.needs_solids(span)?;
        let mut parts = Vec::new();
        for handle in handles? {
            number(&mut parts, handle);
        }
        let points = hull.points.iter().map(|point| point.value).collect();
        Some(Recipe::Solid(SolidRecipe { parts, operation: SolidOperation::Hull(points) }))
    }

    pub(super) fn minkowski_round(
        &mut self,
        name: &str,
        round: &MinkowskiRound,
        span: Span,
    ) -> Option<Recipe> {
        let of = self.shape_of(name, 0, &round.of);
        self.needs_solids(span)?;
        let operation = SolidOperation::Round(round.radius.value);
        Some(Recipe::Solid(SolidRecipe { parts: vec![of?], operation }))
    }

    pub(super) fn shell(&mut self, name: &str, shell: &Shell, span: Span) -> Option<Recipe> {
        let of = self.shape_of(name, 0, &shell.of);
        self.needs_solids(span)?;
        let operation = SolidOperation::Shell(Hollow {
            thickness: shell.thickness.value,
            outside: shell.side.value == WallSide::Outside,
            open: shell.open.iter().map(|plane| half_space(&plane.value)).collect(),
        });
        Some(Recipe::Solid(SolidRecipe { parts: vec![of?], operation }))
    }

    /// All shapes of a list, built even where one fails.
    fn shapes_of(&mut self, name: &str, of: &[ShapeReference]) -> Option<Vec<ShapeHandle>> {
        let all: Vec<_> =
            of.iter().enumerate().map(|(index, part)| self.shape_of(name, index, part)).collect();
        all.into_iter().collect()
    }

    /// A build without the solid library says so.
    pub(super) fn needs_solids(&mut self, span: Span) -> Option<()> {
        if AVAILABLE {
            return Some(());
        }
        let message = "solid operations need the feature `csg`, which this build of Kiln lacks";
        let report = Diagnostic::error(Code::MissingFeature, message)
            .at(span, "a solid operation")
            .help("build Kiln with `features = [\"csg\"]`");
        self.report(report);
        None
    }
}

/// The number of a part, added at its first use.
fn number(parts: &mut Vec<ShapeHandle>, handle: ShapeHandle) -> usize {
    parts.iter().position(|known| *known == handle).unwrap_or_else(|| {
        parts.push(handle);
        parts.len() - 1
    })
}

fn half_space(plane: &Plane) -> HalfSpace {
    HalfSpace { point: plane.point, normal: plane.normal.normalize() }
}
