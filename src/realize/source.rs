//! The exact surfaces behind a mesh, for measuring it.

use glam::{DAffine3, DVec3};

use super::shape::frame_map;
use crate::geometry::curve::{AnyCurve, Curve as _, Side, distance_within};
use crate::geometry::number::{Bounds, hypot};
use crate::geometry::surface::SweptSurface;
use crate::geometry::tessellate::{Density, discretize};
use crate::model::{Model, Recipe, ShapeHandle};

/// How many surfaces the anchors of a recipe tell apart.
pub(super) fn source_count(recipe: &Recipe) -> u32 {
    match recipe {
        Recipe::Cuboid { .. } => 6,
        Recipe::Revolution(_) | Recipe::Sweep(_) => 3,
        Recipe::Extrusion(extrusion) => extrusion.outlines.len() as u32 + 2,
        Recipe::Polygons { .. } => 1,
        Recipe::Assembly(_) => 0,
    }
}

/// One exact surface under the map that brings it into the written mesh.
#[derive(Clone, Debug)]
pub struct Source {
    kind: Kind,
    map: DAffine3,
    back: DAffine3,
}

#[derive(Clone, Debug)]
enum Kind {
    /// Triangles are the shape, or a flat face whose outline is measured elsewhere.
    Exact,
    Revolved(AnyCurve),
    Extruded(AnyCurve),
    Swept(Box<SweptSurface>),
}

/// All surfaces of a shape, by the source of an anchor.
#[derive(Clone, Debug)]
pub struct Sources(Vec<Source>);

impl Sources {
    /// The surface of an anchor.
    #[must_use]
    pub fn get(&self, source: u32) -> Option<&Source> {
        self.0.get(source as usize)
    }

    /// Whether any of them is curved.
    #[must_use]
    pub fn curved(&self) -> bool {
        self.0.iter().any(|source| !matches!(source.kind, Kind::Exact))
    }
}

/// The surfaces of a shape as it stands in the file, in metres.
#[must_use]
pub fn sources(model: &Model, handle: ShapeHandle) -> Sources {
    let mut all = Vec::new();
    collect(model, handle, &frame_map(&model.frame), &mut all);
    Sources(all)
}

fn collect(model: &Model, handle: ShapeHandle, outer: &DAffine3, all: &mut Vec<Source>) {
    let shape = model.shape(handle);
    let map = *outer * shape.options.placement;
    let mut push = |kind: Kind| all.push(Source { kind, map, back: map.inverse() });
    match &shape.recipe {
        Recipe::Cuboid { .. } => (0..6).for_each(|_| push(Kind::Exact)),
        Recipe::Polygons { .. } => push(Kind::Exact),
        Recipe::Revolution(revolution) => {
            push(Kind::Revolved(revolution.profile.clone()));
            push(Kind::Exact);
            push(Kind::Exact);
        }
        Recipe::Extrusion(extrusion) => {
            extrusion.outlines.iter().for_each(|outline| push(Kind::Extruded(outline.clone())));
            push(Kind::Exact);
            push(Kind::Exact);
        }
        Recipe::Sweep(sweep) => {
            let surface = SweptSurface::new(sweep.profile.clone(), sweep.path.clone(), sweep.twist);
            push(Kind::Swept(Box::new(surface)));
            push(Kind::Exact);
            push(Kind::Exact);
        }
        Recipe::Assembly(parts) => {
            for (part, inner) in parts {
                collect(model, *part, &(map * *inner), all);
            }
        }
    }
}

/// A range of parameters in which the nearest point is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Least u and v.
    pub low: (f64, f64),
    /// Greatest u and v.
    pub high: (f64, f64),
}

impl Source {
    /// Distance from a point of the written mesh to the nearest point of this surface within a window of its
    /// parameters: never less than the distance to the whole surface.
    #[must_use]
    pub fn distance(&self, point: DVec3, window: &Window) -> f64 {
        let local = self.back.transform_point3(point);
        let away = match &self.kind {
            Kind::Exact => return 0.0,
            Kind::Revolved(profile) => {
                let radius = hypot(local.x, local.z);
                let flat = DVec3::new(radius, local.y, 0.0);
                distance_within(profile, flat, window.low.1, window.high.1)
            }
            Kind::Extruded(outline) => {
                let flat = DVec3::new(local.x, local.y, 0.0);
                distance_within(outline, flat, window.low.0, window.high.0)
            }
            Kind::Swept(surface) => swept_distance(surface, local, window),
        };
        away * super::shape::stretch(&self.map.matrix3)
    }
}

/// The section that holds the point is found by Newton's method on its place along the path; the rest is a
/// distance in the plane of that section.
fn swept_distance(surface: &SweptSurface, point: DVec3, window: &Window) -> f64 {
    let (low, high) = (window.low.1, window.high.1);
    let mut v = (low + high) / 2.0;
    for _ in 0..8 {
        let section = surface.section(v, Side::After);
        let away = point - section.origin;
        let ahead = away.dot(section.frame.along);
        let lean = 1.0 - away.dot(section.curvature);
        if lean <= 0.0 {
            break;
        }
        v = (v + ahead / (section.speed * lean)).clamp(low, high);
    }
    let side = if v >= high { Side::Before } else { Side::After };
    let section = surface.section(v, side);
    let away = point - section.origin;
    let flat = DVec3::new(away.dot(section.frame.side), away.dot(section.frame.up), 0.0);
    let across = distance_within(&surface.profile, flat, window.low.0, window.high.0);
    hypot(across, away.dot(section.frame.along))
}

/// The box of a recipe that is not an assembly, from points along its curves.
pub(super) fn extent(recipe: &Recipe) -> Bounds {
    match recipe {
        Recipe::Cuboid { size, center } => Bounds { min: *center - *size / 2.0, max: *center + *size / 2.0 },
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
            let outline = along(&extrusion.outlines[0]);
            Bounds {
                min: outline.min.with_z(extrusion.bottom),
                max: outline.max.with_z(extrusion.bottom + extrusion.height),
            }
        }
        Recipe::Sweep(sweep) => {
            let (path, profile) = (along(&sweep.path), along(&sweep.profile));
            let reach = DVec3::splat(profile.reach());
            Bounds { min: path.min - reach, max: path.max + reach }
        }
        Recipe::Assembly(_) => Bounds::EMPTY,
    }
}

fn along(curve: &AnyCurve) -> Bounds {
    let stations = discretize(curve, Density::Count(64), u64::MAX).unwrap_or_default();
    let domain = curve.domain();
    let ends = [curve.point(domain.start), curve.evaluate(domain.end, Side::Before).point];
    Bounds::of_points(stations.iter().map(|station| station.point).chain(ends))
}
