//! Which of the bodies that a field is made of a place on its surface belongs to.
//!
//! Each element of a skeleton is a body, and each field that is made of no others; of sums and perturbed fields the first
//! counts alone. They are numbered in the order in which they stand.

use glam::DVec3;

use super::{AnyField, Field, Join, Joined};

impl AnyField {
    /// How many bodies it is made of.
    #[must_use]
    pub fn owners(&self) -> usize {
        match self {
            Self::Skeleton(skeleton) => skeleton.len(),
            Self::Joined(joined) => joined.of.iter().map(Self::owners).sum(),
            _ => self.inner(DVec3::ZERO).map_or(1, |(of, _)| of.owners()),
        }
    }

    /// The body that is nearest to a place on the surface: of a skeleton the one whose share is greatest; of fields that are
    /// joined the one that says the value, which of a difference may be what is taken away.
    #[must_use]
    pub fn owner(&self, point: DVec3) -> usize {
        match self {
            Self::Skeleton(_) => {
                let shares = self.shares(point).into_iter().enumerate();
                let best = shares.reduce(|best, one| if one.1 > best.1 { one } else { best });
                best.map_or(0, |(number, _)| number)
            }
            Self::Joined(joined) => joined.owner(point),
            _ => self.inner(point).map_or(0, |(of, place)| of.owner(place)),
        }
    }

    /// Of a field that is made of one other, or of one other above all, that one and a place there.
    fn inner(&self, point: DVec3) -> Option<(&Self, DVec3)> {
        match self {
            Self::Placed(placed) => Some((&placed.of, placed.back.transform_point3(point))),
            Self::Sum(sum) => Some((&sum.of.first()?.1, point)),
            Self::Perturbed(perturbed) => Some((&perturbed.base, point)),
            Self::Skin { of, .. } | Self::Grown { of, .. } => Some((of, point)),
            _ => None,
        }
    }
}

impl Joined {
    fn owner(&self, point: DVec3) -> usize {
        let mut best: Option<(f64, usize, &AnyField)> = None;
        let mut first = 0;
        for (place, field) in self.of.iter().enumerate() {
            let value = field.value(point);
            // The least says the value of a union, the greatest that of an intersection.
            let rank = match self.join {
                Join::Union(_) => value,
                Join::Difference(_) if place > 0 => value,
                Join::Intersection(_) | Join::Difference(_) => -value,
            };
            if best.as_ref().is_none_or(|(least, ..)| rank < *least) {
                best = Some((rank, first, field));
            }
            first += field.owners();
        }
        best.map_or(0, |(_, first, field)| first + field.owner(point))
    }
}
