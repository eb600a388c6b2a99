//! How far shapes reach.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::deformation::deformation;
use super::reach::bent;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::field::{AnyField, Placed, Primitive};
use crate::geometry::number::Bounds;
use crate::geometry::subdivide::Scheme;
use crate::geometry::surface::{AnySurface, Deformation, Surface as _};
use crate::geometry::tessellate::{DeformError, Density, Route, discretize};
use crate::model::{Model, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// How far shapes reach, and the maps that bend them.
#[derive(Clone, Debug)]
pub(super) struct Extents {
    /// A box around each shape, its placement applied, in the document's unit.
    boxes: Vec<Bounds>,
    /// For each shape that is another one deformed, the map.
    maps: Vec<Option<Result<Arc<Deformation>, DeformError>>>,
}

impl Extents {
    /// The box of a shape.
    pub(super) fn bounds(&self, handle: ShapeHandle) -> Bounds {
        self.boxes[handle.0 as usize]
    }

    /// The map of a deformed shape.
    ///
    /// # Errors
    /// When the shape cannot be deformed so.
    pub(super) fn map(&self, handle: ShapeHandle) -> Result<&Arc<Deformation>, DeformError> {
        match &self.maps[handle.0 as usize] {
            Some(found) => found.as_ref().map_err(Clone::clone),
            None => Err(DeformError::NoLength),
        }
    }
}

/// The extents of all shapes of a model.
pub(super) fn extents(model: &Model) -> Extents {
    let mut all = Extents { boxes: Vec::new(), maps: Vec::new() };
    for shape in &model.shapes {
        // A recipe refers only to shapes before it.
        let mut map = None;
        let own = match &shape.recipe {
            Recipe::Assembly(parts) => parts
                .iter()
                .map(|(part, map)| mapped(&all.bounds(*part), map))
                .fold(Bounds::EMPTY, Bounds::union),
            Recipe::Deformed { of, by } => {
                let found = deformation(model, &all, *of, by).map(Arc::new);
                let own = found.as_ref().map_or(all.bounds(*of), |map| {
                    let points = bent(model, &all, *of).into_iter();
                    Bounds::of_points(points.map(|point| map.apply(point).point))
                });
                map = Some(found);
                own
            }
            Recipe::Solid(solid) => of_solid(&all, solid),
            Recipe::Displaced(recipe) => {
                let (own, more) = (all.bounds(recipe.of), super::displace::growth(model, &all, recipe));
                Bounds { min: own.min - more, max: own.max + more }
            }
            Recipe::Subdivided(refined) => of_cage(&all.bounds(refined.cage), refined.scheme),
            Recipe::Implicit { surface, shapes, .. } if surface.within.is_empty() => {
                of_field(&all, &surface.field, shapes)
            }
            recipe => extent(recipe),
        };
        all.boxes.push(mapped(&own, &shape.options.placement));
        all.maps.push(map);
    }
    all
}

/// The box of a solid: that of the parts of which something is left, as far as it grows.
fn of_solid(all: &Extents, solid: &SolidRecipe) -> Bounds {
    let lasting = solid.lasting();
    let mut bounds = lasting.iter().map(|part| all.bounds(*part)).fold(Bounds::EMPTY, Bounds::union);
    if let SolidOperation::Hull(points) = &solid.operation {
        bounds = points.iter().fold(bounds, |bounds, point| bounds.with_point(*point));
    }
    let growth = solid.growth().max(0.0);
    Bounds { min: bounds.min - growth, max: bounds.max + growth }
}

/// The box of a field by those of the shapes in it.
fn of_field(all: &Extents, field: &AnyField, shapes: &[ShapeHandle]) -> Bounds {
    let stand_in = |number: usize| {
        let bounds = shapes.get(number).map_or(Bounds::EMPTY, |shape| all.bounds(*shape));
        let half = ((bounds.max - bounds.min) / 2.0).max(DVec3::ZERO);
        let body = AnyField::Primitive(Primitive::Box { half, radius: 0.0 });
        AnyField::Placed(Placed::new(body, &DAffine3::from_translation(bounds.center())))
    };
    field.with_shapes(&mut |number| stand_in(number)).bounds().unwrap_or(Bounds::EMPTY)
}

/// The box of a subdivision surface: its points lie between those of the cage, but for the scheme that goes through them.
fn of_cage(cage: &Bounds, scheme: Scheme) -> Bounds {
    let more = if scheme == Scheme::Butterfly { cage.diagonal() / 4.0 } else { 0.0 };
    Bounds { min: cage.min - more, max: cage.max + more }
}

/// The box around a mapped box.
fn mapped(bounds: &Bounds, map: &DAffine3) -> Bounds {
    if bounds.is_empty() {
        return Bounds::EMPTY;
    }
    let pick = |bit: u32, low: f64, high: f64| if bit == 0 { low } else { high };
    let (low, high) = (bounds.min, bounds.max);
    let corner = |k: u32| {
        DVec3::new(pick(k & 1, low.x, high.x), pick(k & 2, low.y, high.y), pick(k & 4, low.z, high.z))
    };
    Bounds::of_points((0..8).map(|k| map.transform_point3(corner(k))))
}

/// The box of a recipe that is not an assembly, from points along its curves.
pub(super) fn extent(recipe: &Recipe) -> Bounds {
    match recipe {
        Recipe::Cuboid { size, center } => Bounds { min: *center - *size / 2.0, max: *center + *size / 2.0 },
        Recipe::RoundedBox(shape) => Bounds { min: -shape.size / 2.0, max: shape.size / 2.0 },
        Recipe::Geodesic(ball) => Bounds { min: DVec3::splat(-ball.radius), max: DVec3::splat(ball.radius) },
        Recipe::Plane(flat) => {
            let half = DVec3::new(flat.size.x, 0.0, flat.size.y) / 2.0;
            Bounds { min: -half, max: half }
        }
        Recipe::Polygons { mesh, .. } => mesh.bounds(),
        Recipe::Revolution(revolution) => {
            let profile = along(&revolution.profile);
            let radius = profile.max.x;
            Bounds {
                min: DVec3::new(-radius, profile.min.y, -radius),
                max: DVec3::new(radius, profile.max.y, radius),
            }
        }
        Recipe::Extrusion(extrusion) => {
            let outline = extrusion.outlines.iter().map(along).fold(Bounds::EMPTY, Bounds::union);
            Bounds {
                min: outline.min.with_z(extrusion.bottom),
                max: outline.max.with_z(extrusion.bottom + extrusion.height),
            }
        }
        Recipe::Sheet(sheet) => sheet.outlines.iter().map(along).fold(Bounds::EMPTY, Bounds::union),
        Recipe::Sweep(sweep) => {
            let curves = sweep.outlines.iter().flatten().map(along).fold(Bounds::EMPTY, Bounds::union);
            let scale = sweep.change.scale.greatest().max_element();
            match &sweep.route {
                Route::Path { path, .. } => {
                    let (path, reach) = (along(path), DVec3::splat(curves.reach() * scale));
                    Bounds { min: path.min - reach, max: path.max + reach }
                }
                Route::Screw(screw) => {
                    let radius = curves.max.x * scale;
                    let (low, high) = (curves.min.y * scale, curves.max.y * scale);
                    let (down, up) = (screw.rise.min(0.0), screw.rise.max(0.0));
                    Bounds {
                        min: DVec3::new(-radius, low + down, -radius),
                        max: DVec3::new(radius, high + up, radius),
                    }
                }
            }
        }
        Recipe::Height(map) => super::height::extent(map),
        Recipe::Based(map) => Bounds::of_points(super::height::points_of_based(map)),
        Recipe::TwoSided(body) => super::height::extent_of_two(body),
        Recipe::Patches { patches, .. } => {
            patches.surfaces.iter().map(lattice).fold(Bounds::EMPTY, Bounds::union)
        }
        Recipe::Wire(curves) => curves.iter().map(along).fold(Bounds::EMPTY, Bounds::union),
        Recipe::Quadric(shape) => shape.bounds(),
        Recipe::Implicit { surface, .. } => surface.within,
        Recipe::Perturbed(skin) => skin.bounds(),
        Recipe::Trimmed(shape) => shape.bounds(),
        Recipe::Assembly(_)
        | Recipe::Deformed { .. }
        | Recipe::Displaced(_)
        | Recipe::Solid(_)
        | Recipe::Subdivided(_) => Bounds::EMPTY,
    }
}

fn along(curve: &AnyCurve) -> Bounds {
    let stations = discretize(curve, Density::Count(64), u64::MAX).unwrap_or_default();
    let domain = curve.domain();
    let ends = [curve.point(domain.start), curve.evaluate(domain.end, Side::Before).point];
    Bounds::of_points(stations.iter().map(|station| station.point).chain(ends))
}

/// The box of a lattice of points of a surface.
fn lattice(surface: &AnySurface) -> Bounds {
    const STEPS: u32 = 16;
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let part = |k: u32| f64::from(k) / f64::from(STEPS);
    let places = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (u.at(part(i)), v.at(part(j)))));
    Bounds::of_points(places.map(|(u, v)| surface.evaluate(u, v).point))
}
