//! Exact surfaces behind maps that bend, and the flat faces that such maps make curved.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::facets::Facets;
use super::source::Source;
use super::{Window, nearest};
use crate::geometry::curve::{AnyCurve, Curve as _, Side};
use crate::geometry::mesh::convert::{ConvertOptions, convert};
use crate::geometry::mesh::polygon::newell;
use crate::geometry::mesh::{PolygonMesh, VertexIndex};
use crate::geometry::number::sin_cos_degrees;
use crate::geometry::surface::{Deformation, Rim, Surface as _, SweptSurface};
use crate::geometry::tessellate::{Clip, ClippedQuadric, Patchwork, Revolution, Route};
use crate::model::{KeptSide, Model, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// A face that is flat, so that its triangles are exact until a map bends them.
#[derive(Clone, Debug)]
pub(super) enum Flat {
    /// Nothing bends it: there is nothing to measure.
    Exact,
    /// A point and the unit normal of its plane.
    Plane(DVec3, DVec3),
    /// Many faces.
    Facets(Arc<Facets>),
}

impl Flat {
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        match self {
            Self::Exact => 0.0,
            Self::Plane(origin, normal) => (point - *origin).dot(*normal).abs(),
            Self::Facets(facets) => facets.distance(point),
        }
    }

    /// The faces of polygons.
    pub(super) fn of_polygons(mesh: &PolygonMesh) -> Self {
        let Ok(made) = convert(mesh, &ConvertOptions::default()) else { return Self::Exact };
        let made = made.mesh;
        let corner = |vertex: VertexIndex| made.points[made.vertices[vertex.subscript()].point.subscript()];
        let triangles = made.triangles.iter().map(|triangle| triangle.map(corner)).collect();
        Self::Facets(Arc::new(Facets::new(triangles)))
    }

    /// The faces of the box that a quadric is cut by.
    pub(super) fn of_clip(shape: &ClippedQuadric) -> Self {
        /// The six sides, as the numbers of their corners: bit k is the far end of axis k.
        const SIDES: [[usize; 4]; 6] =
            [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 5, 4], [2, 3, 7, 6], [0, 1, 3, 2], [4, 5, 7, 6]];
        let Some(Clip::Box(bounds)) = shape.within else { return Self::Exact };
        let pick = |corner: usize, axis: usize| {
            if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] }
        };
        let place = |corner: usize| DVec3::new(pick(corner, 0), pick(corner, 1), pick(corner, 2));
        let halves = |[a, b, c, d]: [DVec3; 4]| [[a, b, c], [a, c, d]];
        let triangles = SIDES.iter().flat_map(|side| halves(side.map(place))).collect();
        Self::Facets(Arc::new(Facets::new(triangles)))
    }

    /// The six sides of a box, in the order of its sources.
    pub(super) fn of_box(size: DVec3, center: DVec3) -> [Self; 6] {
        let side = |normal: DVec3| Self::Plane(center + normal * size / 2.0, normal);
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].map(side)
    }

    /// The faces at the first and the last angle.
    pub(super) fn of_turn(turned: &Revolution) -> [Self; 2] {
        [turned.start, turned.start + turned.angle].map(|angle| {
            let (sin, cos) = sin_cos_degrees(angle);
            Self::Plane(DVec3::ZERO, DVec3::new(-sin, 0.0, -cos))
        })
    }

    /// The faces at the two ends of a way.
    pub(super) fn of_way(surface: &SweptSurface) -> [Self; 2] {
        let domain = surface.carrier.domain();
        [(domain.start, Side::After), (domain.end, Side::Before)].map(|(v, side)| {
            let plane = surface.carrier.plane(v, side);
            Self::Plane(plane.origin, plane.frame.along)
        })
    }

    /// The flat ends of a patchwork.
    pub(super) fn of_caps(patches: &Patchwork) -> Vec<Self> {
        const PLACES: u32 = 64;
        let end = |rims: &Vec<(u32, Rim)>| {
            let points: Vec<DVec3> = rims
                .iter()
                .flat_map(|(surface, rim)| {
                    let surface = &patches.surfaces[*surface as usize];
                    let (u, v) = (surface.domain_u(), surface.domain_v());
                    (0..PLACES).map(move |k| {
                        let part = f64::from(k) / f64::from(PLACES);
                        let (x, y) = rim.place(part);
                        surface.evaluate(u.at(x), v.at(y)).point
                    })
                })
                .collect();
            match newell(points.iter().copied()).try_normalize() {
                Some(normal) => Self::Plane(points[0], normal),
                None => Self::Exact,
            }
        };
        patches.caps.iter().map(end).collect()
    }
}

/// A surface behind a map that bends.
#[derive(Clone, Debug)]
pub(super) struct Bent {
    pub(super) inner: Source,
    pub(super) map: Arc<Deformation>,
}

impl Bent {
    /// Distance from a point to the bent surface: the distance before the map, turned into one behind it by the
    /// derivative of the map there. What that leaves out is smaller by another factor of the distance itself.
    pub(super) fn distance(&self, point: DVec3, window: &Window) -> f64 {
        let mut origins = Vec::new();
        self.trace(point, DMat3::IDENTITY, &mut origins);
        origins.into_iter().map(|origin| origin.distance(window)).fold(f64::INFINITY, f64::min)
    }

    /// The places before this map, and all maps within it, that come to a point; `outer` is the derivative of the maps
    /// after it.
    fn trace<'a>(&'a self, point: DVec3, outer: DMat3, all: &mut Vec<Origin<'a>>) {
        for place in self.map.origins(point) {
            let jacobian = outer * self.map.apply(place).jacobian;
            match self.inner.bent() {
                Some((bent, map, back)) => {
                    bent.trace(back.transform_point3(place), jacobian * map.matrix3, all);
                }
                None => all.push(Origin { source: &self.inner, place, jacobian }),
            }
        }
    }
}

/// A place before all maps that bend.
struct Origin<'a> {
    source: &'a Source,
    place: DVec3,
    /// The derivative of all maps there.
    jacobian: DMat3,
}

impl Origin<'_> {
    fn distance(&self, window: &Window) -> f64 {
        let before = self.source.distance(self.place, window);
        if before == 0.0 {
            return 0.0;
        }
        let step = 0.01 * before;
        let change = |axis: DVec3| {
            self.source.distance(self.place + axis * step, window)
                - self.source.distance(self.place - axis * step, window)
        };
        let across = DVec3::new(change(DVec3::X), change(DVec3::Y), change(DVec3::Z));
        let jacobian = self.jacobian;
        let Some(across) = across.try_normalize() else {
            let columns = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
            return before * columns.iter().map(|column| column.length()).fold(0.0, f64::max);
        };
        if self.source.is_line() {
            return (jacobian * across).length() * before;
        }
        before / (jacobian.inverse().transpose() * across).length()
    }
}

/// For each source of a shape the parameters after which u and v come round again; infinite where they do not.
pub(super) fn periods(model: &Model, handle: ShapeHandle, all: &mut Vec<(f64, f64)>) {
    const NEVER: f64 = f64::INFINITY;
    let round = |curve: &AnyCurve| if curve.is_closed() { curve.domain().span() } else { NEVER };
    match &model.shape(handle).recipe {
        Recipe::Revolution(turned) => {
            let around = if turned.angle == 360.0 { 360.0 } else { NEVER };
            all.extend([(around, round(&turned.profile)), (NEVER, NEVER), (NEVER, NEVER)]);
        }
        Recipe::Extrusion(pushed) => {
            all.extend(pushed.outlines.iter().map(|outline| (round(outline), NEVER)));
            all.extend([(NEVER, NEVER); 2]);
        }
        Recipe::Sweep(sweep) => {
            let way = match &sweep.route {
                Route::Path { path, .. } => round(path),
                Route::Screw(_) => NEVER,
            };
            let of = |curves: &Vec<AnyCurve>| match curves.as_slice() {
                [only] => round(only),
                // Several share a parameter from 0 to 1.
                _ if curves[0].is_closed() => 1.0,
                _ => NEVER,
            };
            all.extend(sweep.outlines.iter().map(|curves| (of(curves), way)));
            all.extend([(NEVER, NEVER); 2]);
        }
        Recipe::Trimmed(shape) => all.push(nearest::periods(shape.surface())),
        Recipe::Wire(curves) => all.extend(curves.iter().map(|curve| (round(curve), NEVER))),
        Recipe::Patches { patches, .. } => {
            all.extend(patches.surfaces.iter().map(nearest::periods));
            all.extend(patches.caps.iter().map(|_| (NEVER, NEVER)));
        }
        Recipe::Assembly(parts) => parts.iter().for_each(|(part, _)| periods(model, *part, all)),
        Recipe::Deformed { of, .. } => periods(model, *of, all),
        Recipe::Solid(solid) => of_solid(model, solid, all),
        other => all.extend((0..super::source::source_count(other)).map(|_| (NEVER, NEVER))),
    }
}

/// Those of the parts of a solid, and of the surface that it adds.
fn of_solid(model: &Model, solid: &SolidRecipe, all: &mut Vec<(f64, f64)>) {
    const NEVER: (f64, f64) = (f64::INFINITY, f64::INFINITY);
    let times = match &solid.operation {
        SolidOperation::Hull(_) | SolidOperation::Round(_) => return all.push(NEVER),
        SolidOperation::Cut(cut) if cut.keep == KeptSide::Both => 2,
        _ => 1,
    };
    for _ in 0..times {
        solid.parts.iter().for_each(|part| periods(model, *part, all));
        if !matches!(solid.operation, SolidOperation::Combine(_)) {
            all.push(NEVER);
        }
    }
}
