//! Fields that are distances to shapes, before and after these are made.

use std::sync::Arc;

use super::{AnyField, Bump, Distance, Joined, Perturbed, Placed, Sum};

impl AnyField {
    /// The same with another field for each distance to a shape that is not made yet, by its number.
    #[must_use]
    pub fn with_shapes(&self, of: &mut dyn FnMut(usize) -> Self) -> Self {
        match self {
            Self::Shape(number) => of(*number),
            Self::Joined(Joined { join, of: fields }) => {
                let fields = fields.iter().map(|field| field.with_shapes(of)).collect();
                Self::Joined(Joined { join: *join, of: fields })
            }
            Self::Sum(Sum { of: fields, constant }) => {
                let fields = fields.iter().map(|(factor, field)| (*factor, field.with_shapes(of))).collect();
                Self::Sum(Sum { of: fields, constant: *constant })
            }
            Self::Placed(placed) => {
                Self::Placed(Placed { of: Box::new(placed.of.with_shapes(of)), ..placed.clone() })
            }
            Self::Perturbed(Perturbed { base, bumps }) => {
                let base = Box::new(base.with_shapes(of));
                let bump = |bump: &Bump| Bump { field: bump.field.with_shapes(of), factor: bump.factor };
                Self::Perturbed(Perturbed { base, bumps: bumps.iter().map(bump).collect() })
            }
            Self::Skin { of: field, half } => Self::Skin { of: Box::new(field.with_shapes(of)), half: *half },
            Self::Grown { of: field, by } => Self::Grown { of: Box::new(field.with_shapes(of)), by: *by },
            Self::Primitive(_)
            | Self::Skeleton(_)
            | Self::Formula(_)
            | Self::Quadric(_)
            | Self::Distance(_) => self.clone(),
        }
    }

    /// The numbers of the shapes that are not made yet, each once, in the order of their first use.
    #[must_use]
    pub fn shapes(&self) -> Vec<usize> {
        let mut all = Vec::new();
        let _ = self.with_shapes(&mut |number| {
            if !all.contains(&number) {
                all.push(number);
            }
            Self::Shape(number)
        });
        all
    }

    /// The distances to shapes that are made.
    #[must_use]
    pub fn distances(&self) -> Vec<&Arc<Distance>> {
        match self {
            Self::Distance(shape) => vec![shape],
            Self::Joined(joined) => joined.of.iter().flat_map(Self::distances).collect(),
            Self::Sum(sum) => sum.of.iter().flat_map(|(_, field)| field.distances()).collect(),
            Self::Placed(placed) => placed.of.distances(),
            Self::Perturbed(perturbed) => {
                let bumps = perturbed.bumps.iter().map(|bump| &bump.field);
                std::iter::once(&*perturbed.base).chain(bumps).flat_map(Self::distances).collect()
            }
            Self::Skin { of, .. } | Self::Grown { of, .. } => of.distances(),
            Self::Primitive(_) | Self::Skeleton(_) | Self::Formula(_) | Self::Quadric(_) | Self::Shape(_) => {
                Vec::new()
            }
        }
    }
}
