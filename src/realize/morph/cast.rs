//! Surfaces that have one point on each ray: the place of one is that of another on the same ray.
//!
//! Heights over one rectangle correspond along their upright rays, whole ellipsoids and balls along those from their centers,
//! perturbed patches over the same faces along the rays of the faces. Walls and bases of heights stay where they are, where
//! both are closed in the same way. Everything else that has no parameters has no such rays.

use glam::DVec3;

use super::super::source::{Kind, Source, Sources};
use crate::geometry::field::quadric::{QuadricForm, QuadricKind};
use crate::geometry::field::{Field as _, Quadric};
use crate::geometry::tessellate::{Closing, HeightMap};
use crate::model::{Model, Recipe, ShapeHandle};

/// From the surfaces of one shape to those of another.
pub(super) struct Casts<'s> {
    from: &'s Sources,
    to: &'s Sources,
}

impl<'s> Casts<'s> {
    /// None where the shapes are of other kinds, or end in other ways.
    pub(super) fn between(
        (a, one): (&Model, ShapeHandle),
        (b, other): (&Model, ShapeHandle),
        (from, to): (&'s Sources, &'s Sources),
    ) -> Option<Self> {
        let alike = match (&a.shape(one).recipe, &b.shape(other).recipe) {
            (Recipe::Height(one), Recipe::Height(other)) => like_heights(one, other),
            (Recipe::Quadric(one), Recipe::Quadric(other)) => [one, other]
                .iter()
                .all(|shape| shape.within.is_none() && shape.form().kind == QuadricKind::Ellipsoid),
            (Recipe::Perturbed(one), Recipe::Perturbed(other)) => one.has_faces_of(other),
            _ => false,
        };
        alike.then_some(Self { from, to })
    }

    /// The place of a point of the first shape on the second, and the normals on both, which flat faces leave to their
    /// triangles; none where its ray has no place there.
    pub(super) fn cast(&self, source: u32, point: DVec3) -> Option<(DVec3, Option<[DVec3; 2]>)> {
        let (from, to) = (self.from.get(source)?, self.to.get(source)?);
        let local = from.back().transform_point3(point);
        let (place, normals) = match (from.kind(), to.kind()) {
            (Kind::Height(before, _), Kind::Height(map, lift)) => {
                let at = map.place(local);
                let height = map.field.value(at[0], at[1]) + lift;
                (local.with_y(height), Some([before.normal(at), map.normal(at)]))
            }
            (Kind::Flat(_), Kind::Flat(_)) => (local, None),
            (Kind::Quadric(one), Kind::Quadric(other)) => {
                let (place, gradients) = on_ray(one, other, local)?;
                (place, Some(gradients))
            }
            (Kind::Perturbed(one), Kind::Perturbed(other)) => {
                let (place, gradients) = one.carried(other, local)?;
                (place, Some(gradients))
            }
            _ => return None,
        };
        let [before, after] = [from, to].map(|source| source.map().matrix3.inverse().transpose());
        let turned = normals
            .map(|[one, other]| [before * one, after * other].map(|normal| normal.normalize_or_zero()));
        Some((to.map().transform_point3(place), turned))
    }

    /// Whether a surface is cast before those that only end it.
    pub(super) fn is_curved(&self, source: u32) -> bool {
        self.from.get(source).is_some_and(|source: &Source| !matches!(source.kind(), Kind::Flat(_)))
    }
}

/// Whether heights stand over one rectangle, whole or cut along the same lines, and are closed alike.
fn like_heights(one: &HeightMap, other: &HeightMap) -> bool {
    let closed = match (one.close, other.close) {
        (Closing::Base(one), Closing::Base(other)) => one == other,
        (Closing::Thickness(_), Closing::Thickness(_)) | (Closing::None, Closing::None) => true,
        _ => false,
    };
    closed && one.size == other.size && one.masks == other.masks && one.field.extent() == other.field.extent()
}

/// The point of an ellipsoid on the ray from its center in the direction in which a point of another lies from that one's,
/// and the derivatives of both there.
fn on_ray(one: &Quadric, other: &Quadric, point: DVec3) -> Option<(DVec3, [DVec3; 2])> {
    let [from, to] = [one, other].map(|quadric| QuadricForm::anywhere(quadric).origin);
    let ray = (point - from).try_normalize()?;
    let number = other.on_line(to, ray).into_iter().filter(|number| *number > 0.0).reduce(f64::min)?;
    let place = to + ray * number;
    Some((place, [one.gradient(point), other.gradient(place)]))
}
