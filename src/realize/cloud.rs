//! Points of a shape's exact surface, as many as tell how far it reaches.

use glam::{DVec2, DVec3};

use super::extents::extent;
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::number::sin_cos_degrees;
use crate::geometry::surface::{AnySurface, Surface, SweptWall};
use crate::geometry::tessellate::{Density, Revolution, RoundedBox, Sweep, TrimmedSurface, discretize};
use crate::model::Recipe;

/// Pieces in which curves are looked at; a multiple of 4, so that circles are as wide as they are.
const PIECES: u32 = 48;

/// Steps in which surfaces are looked at along each parameter.
const STEPS: u32 = 24;

/// Points of the surface of a recipe that is made of no other shape: corners and ends of curves, and a dense lattice
/// between them. Flat faces are there by their outlines, and those of boxes by a lattice too, as maps may bend them.
pub(super) fn cloud(recipe: &Recipe) -> Vec<DVec3> {
    match recipe {
        Recipe::Cuboid { size, center } => {
            faces(*size / 2.0).into_iter().map(|place| place + *center).collect()
        }
        Recipe::RoundedBox(shape) => rounded(shape),
        Recipe::Geodesic(ball) => sphere().into_iter().map(|place| place * ball.radius).collect(),
        Recipe::Plane(flat) => lattice_of(|part| {
            let place = (part - 0.5) * flat.size;
            DVec3::new(place.x, 0.0, place.y)
        }),
        Recipe::Polygons { mesh, .. } => mesh.points.clone(),
        Recipe::Revolution(turned) => turn(turned),
        Recipe::Extrusion(pushed) => {
            let heights: Vec<f64> = (0..=STEPS)
                .map(|k| pushed.bottom + pushed.height * (f64::from(k) / f64::from(STEPS)))
                .collect();
            let outlines = pushed.outlines.iter().flat_map(points);
            outlines.flat_map(|point| heights.iter().map(move |z| point.with_z(*z))).collect()
        }
        Recipe::Sheet(sheet) => sheet.outlines.iter().flat_map(points).collect(),
        Recipe::Sweep(sweep) => swept(sweep),
        Recipe::Patches { patches, .. } => patches.surfaces.iter().flat_map(lattice).collect(),
        Recipe::Trimmed(shape) => trimmed(shape),
        Recipe::Based(map) => super::height::points_of_based(map),
        Recipe::Perturbed(skin) => skin.samples(),
        // No further than its box, and hardly less.
        Recipe::Quadric(_) | Recipe::Height(_) | Recipe::TwoSided(_) | Recipe::Implicit { .. } => {
            let bounds = extent(recipe);
            let half = (bounds.max - bounds.min) / 2.0;
            faces(half).into_iter().map(|place| place + bounds.center()).collect()
        }
        Recipe::Wire(curves) => curves.iter().flat_map(points).collect(),
        Recipe::Assembly(_)
        | Recipe::Deformed { .. }
        | Recipe::Displaced(_)
        | Recipe::Solid(_)
        | Recipe::Subdivided(_) => Vec::new(),
    }
}

/// Parameters of even stations along a curve, its corners and its ends.
fn parameters(curve: &AnyCurve) -> Vec<f64> {
    let stations = discretize(curve, Density::Count(PIECES), u64::MAX).unwrap_or_default();
    stations.iter().map(|station| station.t).collect()
}

/// Points along a curve.
pub(super) fn points(curve: &AnyCurve) -> Vec<DVec3> {
    let end = curve.domain().end;
    let side = |t: f64| if t >= end { Side::Before } else { Side::After };
    parameters(curve).into_iter().map(|t| curve.evaluate(t, side(t)).point).collect()
}

fn even(start: f64, joints: Vec<f64>, end: f64) -> Vec<f64> {
    let step = |k: u32| start + (end - start) * (f64::from(k) / f64::from(STEPS));
    let mut all: Vec<f64> = (0..=STEPS).map(step).chain(joints).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn lattice(surface: &AnySurface) -> Vec<DVec3> {
    let (u, v) = (surface.domain_u(), surface.domain_v());
    let (u, v) = (even(u.start, surface.joints_u(), u.end), even(v.start, surface.joints_v(), v.end));
    v.iter().flat_map(|v| u.iter().map(|u| surface.evaluate(*u, *v).point)).collect()
}

/// Points over the rectangle of parameters around the outlines.
fn trimmed(shape: &TrimmedSurface) -> Vec<DVec3> {
    let (low, high) = shape.range();
    let (u, v) = (even(low.x, Vec::new(), high.x), even(low.y, Vec::new(), high.y));
    v.iter().flat_map(|v| u.iter().map(|u| shape.point(DVec2::new(*u, *v)))).collect()
}

fn swept(sweep: &Sweep) -> Vec<DVec3> {
    let surface = std::sync::Arc::new(sweep.surface());
    let way = surface.carrier.domain();
    let along = match surface.carrier.path() {
        Some(path) => parameters(path),
        None => even(way.start, surface.joints(), way.end),
    };
    let mut all = Vec::new();
    for (outline, curves) in sweep.outlines.iter().enumerate() {
        let wall = SweptWall { surface: surface.clone(), outline };
        let domain = wall.domain_u();
        let across = match curves.as_slice() {
            [only] => parameters(only),
            _ => even(domain.start, Vec::new(), domain.end),
        };
        all.extend(along.iter().flat_map(|v| across.iter().map(|u| wall.evaluate(*u, *v).point)));
    }
    all
}

fn turn(turned: &Revolution) -> Vec<DVec3> {
    let spokes: Vec<(f64, f64)> = (0..=PIECES)
        .map(|k| sin_cos_degrees(turned.start + turned.angle * (f64::from(k) / f64::from(PIECES))))
        .collect();
    let around = |point: DVec3| {
        spokes.iter().map(move |(sin, cos)| DVec3::new(point.x * cos, point.y, -point.x * sin))
    };
    points(&turned.profile).into_iter().flat_map(around).collect()
}

/// Points of a lattice over a square of sides 1.
fn lattice_of(place: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    let part = |k: u32| f64::from(k) / f64::from(STEPS);
    let all = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| DVec2::new(part(i), part(j))));
    all.map(place).collect()
}

/// Points on the six sides of a box about the origin.
fn faces(half: DVec3) -> Vec<DVec3> {
    let sides =
        [(DVec3::X, DVec3::Y, DVec3::Z), (DVec3::Y, DVec3::Z, DVec3::X), (DVec3::Z, DVec3::X, DVec3::Y)];
    let side = |(out, across, up): (DVec3, DVec3, DVec3), sign: f64| {
        lattice_of(|part| (out * sign + across * (2.0 * part.x - 1.0) + up * (2.0 * part.y - 1.0)) * half)
    };
    sides.into_iter().flat_map(|axes| [1.0, -1.0].map(|sign| side(axes, sign))).flatten().collect()
}

/// Points of a sphere of radius 1.
fn sphere() -> Vec<DVec3> {
    lattice_of(|part| {
        let (sin, cos) = sin_cos_degrees(360.0 * part.x);
        let (rise, wide) = sin_cos_degrees(180.0 * part.y - 90.0);
        DVec3::new(cos * wide, rise, sin * wide)
    })
}

fn rounded(shape: &RoundedBox) -> Vec<DVec3> {
    let inner = shape.size / 2.0 - shape.radius;
    let corner = |direction: DVec3| direction * shape.radius + inner * direction.signum();
    let sides =
        [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| faces(inner + axis * shape.radius));
    sphere().into_iter().map(corner).chain(sides).collect()
}
