//! The exact surfaces behind a mesh, for measuring it.

use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::bent::{Bent, Flat};
use super::extents::{Extents, extents};
use super::leaning::Leaning;
use super::nearest::Field;
use super::window::{Window, nearest_near};
use crate::geometry::curve::AnyCurve;
use crate::geometry::field::Quadric;
use crate::geometry::mesh::{self, Anchor};
use crate::geometry::number::hypot;
use crate::geometry::surface::{ExtrudedSurface, RevolvedSurface, SweptWall};
use crate::geometry::tessellate::{
    BasedMap, ClippedQuadric, Closing, FieldSurface, HeightMap, Layer, PerturbedSkin, RoundedBox,
};
use crate::model::{KeptSide, Model, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// How many surfaces the anchors of a recipe tell apart.
pub(super) fn source_count(recipe: &Recipe) -> u32 {
    match recipe {
        Recipe::Cuboid { .. } => 6,
        Recipe::Height(_) | Recipe::Based(_) | Recipe::TwoSided(_) => 3,
        Recipe::Revolution(_) => 3,
        Recipe::Sweep(sweep) => mesh::index(sweep.outlines.len()) + 2,
        Recipe::Extrusion(extrusion) => mesh::index(extrusion.outlines.len()) + 2,
        Recipe::Patches { patches, .. } => mesh::index(patches.surfaces.len() + patches.caps.len()),
        Recipe::Polygons { .. }
        | Recipe::Trimmed(_)
        | Recipe::Implicit { .. }
        | Recipe::Perturbed(_)
        | Recipe::RoundedBox(_)
        | Recipe::Geodesic(_)
        | Recipe::Plane(_)
        | Recipe::Sheet(_) => 1,
        Recipe::Subdivided(_) | Recipe::Displaced(_) => 1,
        Recipe::Wire(curves) => mesh::index(curves.len()),
        Recipe::Quadric(_) => ClippedQuadric::SOURCES,
        Recipe::Assembly(_) | Recipe::Deformed { .. } | Recipe::Solid(_) => 0,
    }
}

/// One exact surface under the map that brings it into the written mesh.
#[derive(Clone, Debug)]
pub struct Source {
    /// The shape that says it.
    shape: ShapeHandle,
    kind: Kind,
    map: DAffine3,
    back: DAffine3,
}

#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// Triangles are the shape, or a flat face whose outline is measured elsewhere.
    Flat(Flat),
    Bent(Box<Bent>),
    /// A ball too: a box without sides.
    Rounded(RoundedBox),
    Revolved(Box<RevolvedSurface>),
    Extruded(Box<ExtrudedSurface>),
    /// An outline, its sense of turning, and how its walls lean.
    Leaning(Box<Leaning>),
    Swept(SweptWall),
    Patch(Box<Field>),
    /// Heights over a rectangle, moved along y.
    Height(Arc<HeightMap>, f64),
    /// A skin over a curved base.
    Based(Arc<BasedMap>, Layer),
    /// A curve by itself.
    Line(AnyCurve),
    /// Where a polynomial is zero.
    Quadric(Quadric),
    /// A surface that follows from others and has no form of its own: that of a hull, of a rounded shape, of a hollow,
    /// of a field with distances to shapes.
    Derived,
    /// Where a field is zero.
    Implicit(Arc<FieldSurface>),
    /// Polygons with bumps.
    Perturbed(Arc<PerturbedSkin>),
}

/// All surfaces of a shape, by the source of an anchor.
#[derive(Clone, Debug)]
pub struct Sources(Vec<Source>);

impl Sources {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> u32 {
        mesh::index(self.0.len())
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The surface of an anchor.
    #[must_use]
    pub fn get(&self, source: u32) -> Option<&Source> {
        self.0.get(source as usize)
    }

    /// The surfaces to which points of a triangle may be nearest, each with the corners' parameters there: its own,
    /// and of patches those that a corner lies on too. A vertex between patches that look the same there is written
    /// once, with the anchor of one of them; and what lies over a chord between two patches may be over either.
    #[must_use]
    pub fn around(&self, corners: &[Anchor; 3], places: &[DVec3; 3]) -> Vec<(&Source, Window)> {
        let own = corners.map(|anchor| (anchor.u, anchor.v));
        let Some(first) = self.get(corners[0].source) else { return Vec::new() };
        let one = corners.iter().all(|anchor| anchor.source == corners[0].source);
        if one && !first.touches_rims(&own) {
            return vec![(first, Window::of(own))];
        }
        let mut found = Vec::new();
        for (number, source) in self.0.iter().enumerate() {
            let known = [0, 1, 2].map(|k| {
                if corners[k].source as usize == number { Some(own[k]) } else { source.rim_place(places[k]) }
            });
            if let Some(any) = known.into_iter().flatten().next() {
                found.push((source, Window::of(known.map(|place| place.unwrap_or(any)))));
            }
        }
        found
    }

    /// All of them, in the order of the sources of anchors.
    pub fn iter(&self) -> std::slice::Iter<'_, Source> {
        self.0.iter()
    }

    /// Whether each has a form of its own, so that distances to it can be told.
    #[must_use]
    pub fn known(&self) -> bool {
        self.0.iter().all(Source::is_known)
    }

    /// Whether any of them is curved.
    #[must_use]
    pub fn curved(&self) -> bool {
        self.0.iter().any(|source| !matches!(source.kind, Kind::Flat(Flat::Exact)))
    }
}

/// The surfaces of a shape as it stands in the file, in metres.
#[must_use]
pub fn sources(model: &Model, handle: ShapeHandle) -> Sources {
    let mut all = Vec::new();
    let collector = Collector { model, extents: extents(model) };
    collector.collect(handle, &model.frame.map(), false, &mut all);
    Sources(all)
}

struct Collector<'a> {
    model: &'a Model,
    extents: Extents,
}

impl Collector<'_> {
    /// The surfaces of a shape under a map; flat faces are told apart where something bends them.
    fn collect(&self, handle: ShapeHandle, outer: &DAffine3, bends: bool, all: &mut Vec<Source>) {
        let shape = self.model.shape(handle);
        let map = *outer * shape.options.placement;
        match &shape.recipe {
            Recipe::Assembly(parts) => {
                for (part, inner) in parts {
                    self.collect(*part, &(map * *inner), bends, all);
                }
            }
            Recipe::Deformed { of, .. } => {
                let mut inner = Vec::new();
                self.collect(*of, &DAffine3::IDENTITY, true, &mut inner);
                let Ok(bending) = self.extents.map(handle) else { return };
                all.extend(inner.into_iter().map(|inner| {
                    let shape = inner.shape;
                    let kind = Kind::Bent(Box::new(Bent { inner, map: Arc::clone(bending) }));
                    Source { shape, kind, map, back: map.inverse() }
                }));
            }
            Recipe::Solid(solid) => self.collect_solid((handle, solid), &map, bends, all),
            Recipe::Subdivided(_) | Recipe::Displaced(_) => {
                all.push(Source { shape: handle, kind: Kind::Derived, map, back: map.inverse() });
            }
            recipe => {
                let kinds = kinds(recipe, bends).into_iter();
                all.extend(kinds.map(|kind| Source { shape: handle, kind, map, back: map.inverse() }));
            }
        }
    }
}

impl Collector<'_> {
    /// The surfaces of the parts of a solid, and the one that it adds.
    fn collect_solid(
        &self,
        (shape, solid): (ShapeHandle, &SolidRecipe),
        map: &DAffine3,
        bends: bool,
        all: &mut Vec<Source>,
    ) {
        let one = |kind: Kind, map: DAffine3| Source { shape, kind, map, back: map.inverse() };
        let parts = |map: &DAffine3, all: &mut Vec<Source>| {
            solid.parts.iter().for_each(|part| self.collect(*part, map, bends, all));
        };
        match &solid.operation {
            SolidOperation::Combine(_) => parts(map, all),
            SolidOperation::Shell(_) => {
                parts(map, all);
                all.push(one(Kind::Derived, *map));
            }
            SolidOperation::Hull(_) | SolidOperation::Round(_) => all.push(one(Kind::Derived, *map)),
            SolidOperation::Cut(cut) => {
                let plane = Flat::Plane(cut.above.point, cut.above.normal);
                // Sides that are moved apart have surfaces of their own, those below first.
                let shift =
                    |way: f64| *map * DAffine3::from_translation(cut.above.normal * (way * cut.gap / 2.0));
                let shifts =
                    if cut.keep == KeptSide::Both { vec![shift(-1.0), shift(1.0)] } else { vec![*map] };
                for map in shifts {
                    parts(&map, all);
                    all.push(one(Kind::Flat(if bends { plane.clone() } else { Flat::Exact }), map));
                }
            }
        }
    }
}

/// The surfaces of a recipe that is made of no other shape, in the order of its anchors.
fn kinds(recipe: &Recipe, bends: bool) -> Vec<Kind> {
    let flat = |face: Flat| Kind::Flat(if bends { face } else { Flat::Exact });
    let rounded = |size: DVec3, radius: f64| vec![Kind::Rounded(RoundedBox { size, radius })];
    match recipe {
        Recipe::Cuboid { size, center } => Flat::of_box(*size, *center).into_iter().map(flat).collect(),
        Recipe::Polygons { mesh, .. } => {
            vec![Kind::Flat(if bends { Flat::of_polygons(mesh) } else { Flat::Exact })]
        }
        Recipe::Plane(_) => vec![flat(Flat::Plane(DVec3::ZERO, DVec3::Y))],
        Recipe::Sheet(_) => vec![flat(Flat::Plane(DVec3::ZERO, DVec3::Z))],
        Recipe::RoundedBox(shape) => rounded(shape.size, shape.radius),
        Recipe::Geodesic(ball) => rounded(DVec3::splat(2.0 * ball.radius), ball.radius),
        Recipe::Revolution(revolution) => {
            let wall = Kind::Revolved(Box::new(RevolvedSurface {
                profile: revolution.profile.clone(),
                start: revolution.start,
                angle: revolution.angle,
            }));
            std::iter::once(wall).chain(Flat::of_turn(revolution).map(flat)).collect()
        }
        Recipe::Extrusion(extrusion) => {
            let walls = (0..extrusion.outlines.len()).map(|index| match Leaning::of(extrusion, index) {
                Some(leaning) => Kind::Leaning(Box::new(leaning)),
                None => Kind::Extruded(Box::new(ExtrudedSurface {
                    profile: extrusion.outlines[index].clone(),
                    bottom: extrusion.bottom,
                    height: extrusion.height,
                })),
            });
            let ends = [extrusion.bottom, extrusion.bottom + extrusion.height];
            walls.chain(ends.map(|z| flat(Flat::Plane(DVec3::Z * z, DVec3::Z)))).collect()
        }
        Recipe::Height(map) => {
            let shared = Arc::new(map.clone());
            let depth = if let Closing::Thickness(depth) = map.close { depth } else { 0.0 };
            let sides = Kind::Flat(Flat::Exact);
            vec![Kind::Height(shared.clone(), 0.0), sides, Kind::Height(shared, -depth)]
        }
        Recipe::Based(map) => {
            let shared = Arc::new(map.as_ref().clone());
            let layers = map.layers();
            let skin = |layer: Layer| Kind::Based(shared.clone(), layer);
            let under = layers.get(1).map_or(Kind::Flat(Flat::Exact), |layer| skin(*layer));
            vec![skin(layers[0]), Kind::Flat(Flat::Exact), under]
        }
        Recipe::TwoSided(body) => {
            let mut back = body.back.clone();
            back.field = Arc::new(back.field.scaled(-1.0, 0.0));
            let sides = [body.front.clone(), back].map(|map| Kind::Height(Arc::new(map), 0.0));
            let [front, back] = sides;
            vec![front, Kind::Flat(Flat::Exact), back]
        }
        Recipe::Sweep(sweep) => {
            let surface = Arc::new(sweep.surface());
            let wall = |outline| Kind::Swept(SweptWall { surface: surface.clone(), outline });
            let walls: Vec<Kind> = (0..sweep.outlines.len()).map(wall).collect();
            walls.into_iter().chain(Flat::of_way(&surface).map(flat)).collect()
        }
        Recipe::Patches { patches, .. } => {
            let fields = patches.surfaces.iter().map(|surface| Kind::Patch(Box::new(Field::new(surface))));
            fields.chain(Flat::of_caps(patches).into_iter().map(flat)).collect()
        }
        Recipe::Trimmed(shape) => vec![Kind::Patch(Box::new(Field::new(shape.surface())))],
        Recipe::Quadric(shape) => {
            let faces = if bends { Flat::of_clip(shape) } else { Flat::Exact };
            let flat = |source| {
                let cut = !shape.is_sheet(source);
                Kind::Flat(if cut { faces.clone() } else { Flat::Exact })
            };
            let kind = |source| shape.surface(source).map_or_else(|| flat(source), Kind::Quadric);
            (0..ClippedQuadric::SOURCES).map(kind).collect()
        }
        Recipe::Implicit { shapes, .. } if !shapes.is_empty() => vec![Kind::Derived],
        Recipe::Implicit { surface, .. } => vec![Kind::Implicit(Arc::new(surface.as_ref().clone()))],
        Recipe::Perturbed(skin) => vec![Kind::Perturbed(Arc::new(skin.as_ref().clone()))],
        Recipe::Wire(curves) => curves.iter().map(|curve| Kind::Line(curve.clone())).collect(),
        Recipe::Assembly(_)
        | Recipe::Deformed { .. }
        | Recipe::Displaced(_)
        | Recipe::Solid(_)
        | Recipe::Subdivided(_) => Vec::new(),
    }
}

fn distance_near(curve: &AnyCurve, point: DVec3, corners: [f64; 3]) -> f64 {
    nearest_near(curve, point, corners).0
}

impl Source {
    /// The shape that says it: that of a part where the whole is made of parts.
    #[must_use]
    pub fn shape(&self) -> ShapeHandle {
        self.shape
    }

    pub(super) fn kind(&self) -> &Kind {
        &self.kind
    }

    /// The map that brings it into the written mesh.
    pub(super) fn map(&self) -> &DAffine3 {
        &self.map
    }

    /// The map back from there.
    pub(super) fn back(&self) -> &DAffine3 {
        &self.back
    }

    fn is_known(&self) -> bool {
        match &self.kind {
            Kind::Derived => false,
            Kind::Bent(bent) => bent.inner.is_known(),
            _ => true,
        }
    }

    /// Whether one of these places lies on a side of a patch, which others may have too.
    fn touches_rims(&self, places: &[(f64, f64); 3]) -> bool {
        match &self.kind {
            Kind::Patch(field) => places.iter().any(|place| field.on_rim(*place)),
            Kind::Bent(bent) => bent.inner.touches_rims(places),
            _ => false,
        }
    }

    /// Parameters of a point of the written mesh that lies on a side of this patch.
    fn rim_place(&self, point: DVec3) -> Option<(f64, f64)> {
        let local = self.back.transform_point3(point);
        match &self.kind {
            Kind::Patch(field) => field.rim_place(local),
            Kind::Bent(bent) => {
                bent.map.origins(local).into_iter().find_map(|origin| bent.inner.rim_place(origin))
            }
            _ => None,
        }
    }

    /// Whether it is a curve by itself.
    pub(super) fn is_line(&self) -> bool {
        matches!(self.kind, Kind::Line(_))
    }

    /// What is bent, the map after that, and its inverse.
    pub(super) fn bent(&self) -> Option<(&Bent, &DAffine3, &DAffine3)> {
        match &self.kind {
            Kind::Bent(bent) => Some((bent, &self.map, &self.back)),
            _ => None,
        }
    }

    /// Distance from a point of the written mesh to the nearest point of this surface near the
    /// parameters of a triangle: never less than the distance to the whole surface.
    #[must_use]
    pub fn distance(&self, point: DVec3, window: &Window) -> f64 {
        let local = self.back.transform_point3(point);
        let away = match &self.kind {
            Kind::Flat(Flat::Exact) | Kind::Derived => return 0.0,
            Kind::Flat(face) => face.distance(local),
            Kind::Bent(bent) => bent.distance(local, window),
            Kind::Rounded(shape) => shape.distance(local),
            Kind::Revolved(turned) => {
                let radius = hypot(local.x, local.z);
                let flat = DVec3::new(radius, local.y, 0.0);
                distance_near(&turned.profile, flat, window.v)
            }
            Kind::Extruded(pushed) => {
                let flat = DVec3::new(local.x, local.y, 0.0);
                distance_near(&pushed.profile, flat, window.u)
            }
            Kind::Leaning(wall) => wall.distance(local, window),
            Kind::Swept(wall) => super::swept::distance(wall, local, window),
            Kind::Patch(surface) => surface.distance(local, window),
            Kind::Height(map, lift) => super::height::distance(map, local - DVec3::Y * *lift),
            Kind::Based(map, layer) => super::height::distance_to_skin(map, *layer, local, window),
            Kind::Line(curve) => distance_near(curve, local, window.u),
            Kind::Implicit(surface) => surface.distance(local),
            Kind::Perturbed(skin) => skin.distance(local),
            Kind::Quadric(quadric) => {
                quadric.settled(local).map_or(f64::INFINITY, |nearest| nearest.distance(local))
            }
        };
        away * super::shape::stretch(&self.map.matrix3)
    }
}
