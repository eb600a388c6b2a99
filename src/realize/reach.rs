//! How far a shape reaches along a direction, from its exact recipe.
//!
//! Not from a mesh: what follows from it must be the same at every tolerance. Corners and the ends of curves are
//! exact; between, curves are looked at in many places.

use glam::{DAffine3, DVec3};

use super::cloud::{cloud, points};
use super::extents::Extents;
use crate::geometry::number::{Bounds, hypot};
use crate::model::{Model, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// Shapes that are looked at themselves; in groups of groups of more, the rest by their boxes.
const MOST: u32 = 10_000;

/// Shapes whose points are followed through a map that bends; of more, the boxes.
const MOST_BENT: u32 = 64;

/// The least and greatest of `direction . p` over a shape. `extents` knows all shapes up to it.
pub(super) fn reach(model: &Model, extents: &Extents, handle: ShapeHandle, direction: DVec3) -> (f64, f64) {
    let mut search = Search { model, extents, left: MOST };
    search.shape(handle, &DAffine3::IDENTITY, direction)
}

struct Search<'a> {
    model: &'a Model,
    extents: &'a Extents,
    left: u32,
}

impl Search<'_> {
    /// A shape under a map; its own placement is applied first.
    fn shape(&mut self, handle: ShapeHandle, map: &DAffine3, direction: DVec3) -> (f64, f64) {
        let shape = self.model.shape(handle);
        let moved = |map: &DAffine3, (low, high): (f64, f64)| {
            let offset = map.translation.dot(direction);
            (low + offset, high + offset)
        };
        if self.left == 0 || is_box(&shape.recipe) {
            let local = map.matrix3.transpose() * direction;
            return moved(map, of_box(&self.extents.bounds(handle), local));
        }
        self.left -= 1;
        if let Recipe::Displaced(recipe) = &shape.recipe {
            let growth = super::displace::growth(self.model, self.extents, recipe);
            let map = *map * shape.options.placement;
            let (low, high) = self.shape(recipe.of, &map, direction);
            let growth = growth * (map.matrix3.transpose() * direction).length();
            return (low - growth, high + growth);
        }
        let map = *map * shape.options.placement;
        // On the points of the recipe the map and the direction are one linear function.
        let local = map.matrix3.transpose() * direction;
        match &shape.recipe {
            Recipe::Assembly(parts) => parts
                .iter()
                .map(|(part, inner)| self.shape(*part, &(map * *inner), direction))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |all, part| (all.0.min(part.0), all.1.max(part.1))),
            Recipe::Deformed { of, .. } => {
                let Ok(bending) = self.extents.map(handle) else { return moved(&map, (0.0, 0.0)) };
                let points = bent(self.model, self.extents, *of).into_iter();
                moved(&map, of_points(points.map(|point| bending.apply(point).point), local))
            }
            Recipe::Solid(solid) => self.solid(solid, &map, direction),
            Recipe::Subdivided(refined) => self.shape(refined.cage, &map, direction),
            recipe => moved(&map, of_recipe(recipe, local)),
        }
    }
}

impl Search<'_> {
    /// As far as the parts of which something is left, and what is grown.
    fn solid(&mut self, solid: &SolidRecipe, map: &DAffine3, direction: DVec3) -> (f64, f64) {
        let parts = solid.lasting().into_iter().map(|part| self.shape(part, map, direction));
        let (mut low, mut high) = parts
            .fold((f64::INFINITY, f64::NEG_INFINITY), |all, part| (all.0.min(part.0), all.1.max(part.1)));
        if let SolidOperation::Hull(points) = &solid.operation {
            for place in points.iter().map(|point| map.transform_point3(*point).dot(direction)) {
                (low, high) = (low.min(place), high.max(place));
            }
        }
        let growth = solid.growth() * (map.matrix3.transpose() * direction).length();
        (low - growth, high + growth)
    }
}

/// Whether of a recipe alone no more is known than a box.
fn is_box(recipe: &Recipe) -> bool {
    matches!(recipe, Recipe::Implicit { shapes, .. } if !shapes.is_empty())
}

fn of_points(points: impl Iterator<Item = DVec3>, direction: DVec3) -> (f64, f64) {
    let all = (f64::INFINITY, f64::NEG_INFINITY);
    points.map(|point| point.dot(direction)).fold(all, |(low, high), value| (low.min(value), high.max(value)))
}

fn of_box(bounds: &Bounds, direction: DVec3) -> (f64, f64) {
    let half = (bounds.max - bounds.min).dot(direction.abs()) / 2.0;
    let middle = bounds.center().dot(direction);
    (middle - half, middle + half)
}

/// Points of a shape that is to be bent, its placement applied. They reach as far as it does, or a little further where
/// it has very many parts.
pub(super) fn bent(model: &Model, extents: &Extents, handle: ShapeHandle) -> Vec<DVec3> {
    let mut gathering = Gathering { model, extents, left: MOST_BENT, all: Vec::new() };
    gathering.shape(handle, &|point| point);
    gathering.all
}

struct Gathering<'a> {
    model: &'a Model,
    extents: &'a Extents,
    left: u32,
    all: Vec<DVec3>,
}

impl Gathering<'_> {
    fn shape(&mut self, handle: ShapeHandle, map: &dyn Fn(DVec3) -> DVec3) {
        if self.left == 0 || is_box(&self.model.shape(handle).recipe) {
            self.all.extend(box_lattice(&self.extents.bounds(handle)).into_iter().map(map));
            return;
        }
        self.left -= 1;
        let shape = self.model.shape(handle);
        let placed = |point: DVec3| map(shape.options.placement.transform_point3(point));
        match &shape.recipe {
            Recipe::Assembly(parts) => {
                for (part, inner) in parts {
                    self.shape(*part, &|point| placed(inner.transform_point3(point)));
                }
            }
            Recipe::Deformed { of, .. } => {
                if let Ok(bending) = self.extents.map(handle) {
                    self.shape(*of, &|point| placed(bending.apply(point).point));
                }
            }
            Recipe::Solid(solid) => {
                solid.lasting().into_iter().for_each(|part| self.shape(part, &placed));
                if let SolidOperation::Hull(points) = &solid.operation {
                    self.all.extend(points.iter().copied().map(placed));
                }
                if solid.growth() > 0.0 {
                    self.all.extend(box_lattice(&self.extents.bounds(handle)).into_iter().map(map));
                }
            }
            Recipe::Subdivided(refined) => self.shape(refined.cage, &placed),
            Recipe::Displaced(_) => {
                self.all.extend(box_lattice(&self.extents.bounds(handle)).into_iter().map(map));
            }
            recipe => self.all.extend(cloud(recipe).into_iter().map(placed)),
        }
    }
}

/// A lattice of points of a box.
fn box_lattice(bounds: &Bounds) -> Vec<DVec3> {
    const STEPS: u32 = 16;
    if bounds.is_empty() {
        return Vec::new();
    }
    let part = |k: u32| f64::from(k) / f64::from(STEPS);
    let size = bounds.max - bounds.min;
    let places = (0..=STEPS).flat_map(|i| {
        (0..=STEPS).flat_map(move |j| (0..=STEPS).map(move |k| DVec3::new(part(i), part(j), part(k))))
    });
    places.map(|place| bounds.min + size * place).collect()
}

/// Of what is round in closed form; of the rest by its points.
fn of_recipe(recipe: &Recipe, direction: DVec3) -> (f64, f64) {
    let ball = |radius: f64, inner: f64| {
        let most = inner + radius * direction.length();
        (-most, most)
    };
    match recipe {
        Recipe::Revolution(turned) if turned.angle == 360.0 => {
            // The farthest to either side of a circle.
            let flat = hypot(direction.x, direction.z);
            let side = if flat > 0.0 { direction.with_y(0.0) / flat } else { DVec3::ZERO };
            let across = |point: DVec3| [1.0, -1.0].map(|sign| side * (sign * point.x) + DVec3::Y * point.y);
            of_points(points(&turned.profile).into_iter().flat_map(across), direction)
        }
        Recipe::RoundedBox(shape) => {
            ball(shape.radius, (shape.size / 2.0 - shape.radius).dot(direction.abs()))
        }
        Recipe::Geodesic(shape) => ball(shape.radius, 0.0),
        Recipe::Cuboid { .. } | Recipe::Plane(_) => of_box(&super::extents::extent(recipe), direction),
        other => of_points(cloud(other).into_iter(), direction),
    }
}
