//! Bodies of parts on split planes into recipes.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::Builder;
use crate::geometry::mesh;
use crate::geometry::number::Bounds;
use crate::geometry::solid::Combination;
use crate::geometry::tessellate::{Closing, HeightBound, HeightMap, TwoSided};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{ShapeOptions, Split, SplitPart};
use crate::model::{Recipe, Shape, ShapeHandle, SolidOperation, SolidRecipe};

/// A part, its heights over the rectangle, and where it is written.
struct Part {
    map: HeightMap,
    normal: DVec3,
    point: DVec3,
    span: Span,
}

/// A body on one plane.
struct Body {
    recipe: Recipe,
    place: DAffine3,
    bounds: Bounds,
}

impl Builder<'_> {
    pub(super) fn split(
        &mut self,
        name: &str,
        written: &Split,
        options: &ShapeOptions,
        span: Span,
    ) -> Option<(Recipe, DAffine3)> {
        if let Some(segments) = options.segments {
            let report = Diagnostic::error(Code::Conflict, "a split body is not cut into `segments`")
                .at(segments.span, "no effect")
                .help("write a `tolerance`");
            self.report(report);
            return None;
        }
        let parts: Vec<_> = written.part.value.iter().map(|part| self.split_part(written, part)).collect();
        let parts: Vec<Part> = parts.into_iter().collect::<Option<_>>()?;
        let bodies = self.bodies(parts)?;
        let reach = |k: usize| bodies[..k].iter().any(|other| overlap(&other.bounds, &bodies[k].bounds));
        let apart = !(0..bodies.len()).any(reach);
        if apart && bodies.len() == 1 {
            return bodies.into_iter().next().map(|body| (body.recipe, body.place));
        }
        let mut all = Vec::new();
        for (k, body) in bodies.into_iter().enumerate() {
            let mut own = self.options(options)?;
            (own.placement, own.material) = (body.place, None);
            self.model.shapes.push(Shape {
                name: format!("{name}-{}", k + 1),
                recipe: body.recipe,
                options: own,
            });
            self.places.push(span);
            self.faces.push(Vec::new());
            all.push(ShapeHandle(mesh::index(self.model.shapes.len()) - 1));
        }
        let here = DAffine3::IDENTITY;
        if apart {
            return Some((Recipe::Assembly(all.into_iter().map(|part| (part, here)).collect()), here));
        }
        self.needs_solids(span)?;
        let union = (0..all.len()).map(Combination::Part).collect();
        let operation = SolidOperation::Combine(Combination::Union(union));
        Some((Recipe::Solid(SolidRecipe { parts: all, operation }), here))
    }

    fn split_part(&mut self, whole: &Split, written: &SplitPart) -> Option<Part> {
        let field = self.map_of(&written.map);
        let common = self.masks(&whole.mask);
        let own = self.masks(&written.mask);
        let (field, masks, mut own) = (field?, common?, own?);
        let [low, high] = written.range.value.to_array();
        let mut field =
            if (low, high) == (0.0, 1.0) { field } else { Arc::new(field.scaled(high - low, low)) };
        if written.mirror.value {
            field = Arc::new(field.mirrored());
            own.iter_mut().for_each(|mask| mask.field = Arc::new(mask.field.mirrored()));
        }
        let map = HeightMap {
            field,
            size: whole.size.value,
            bound: HeightBound::Surface,
            close: Closing::Base(0.0),
            masks: [masks, own].concat(),
        };
        let span = written.map.span();
        Some(Part { map, normal: written.normal.value.normalize(), point: written.point.value, span })
    }

    /// Pairs of parts on one plane, and what is left alone.
    fn bodies(&mut self, parts: Vec<Part>) -> Option<Vec<Body>> {
        let mut waiting: Vec<Option<(usize, Part)>> = parts.into_iter().enumerate().map(Some).collect();
        let mut bodies = Vec::new();
        for k in 0..waiting.len() {
            let Some((number, part)) = waiting[k].take() else { continue };
            let place = frame(part.normal, part.point);
            let faces_it = |other: &Option<(usize, Part)>| {
                other.as_ref().is_some_and(|(_, other)| {
                    other.point == part.point && (other.normal + part.normal).length() < 1e-9
                })
            };
            let other = waiting[k + 1..].iter().position(faces_it).and_then(|at| waiting[k + 1 + at].take());
            let (recipe, depth) = match other {
                None => (Recipe::Height(part.map.clone()), 0.0),
                Some((other_number, back)) => {
                    if back.map.field.extent() != part.map.field.extent() {
                        self.report(unequal([&part, &back], [number, other_number]));
                        return None;
                    }
                    let depth = back.map.field.range().1.max(0.0);
                    let both = TwoSided { front: part.map.clone(), back: back.map };
                    (Recipe::TwoSided(Box::new(both)), depth)
                }
            };
            let half = part.map.size / 2.0;
            let high = part.map.field.range().1.max(0.0);
            let corners = (0..8_u32).map(|bits| {
                let pick = |bit: u32, low: f64, high: f64| if bits & bit == 0 { low } else { high };
                let corner =
                    DVec3::new(pick(1, -half.x, half.x), pick(2, -depth, high), pick(4, -half.y, half.y));
                place.transform_point3(corner)
            });
            bodies.push(Body { recipe, place, bounds: Bounds::of_points(corners) });
        }
        Some(bodies)
    }
}

fn unequal(parts: [&Part; 2], numbers: [usize; 2]) -> Diagnostic {
    let counts = parts.map(|part| format!("{} x {}", part.map.field.columns(), part.map.field.rows()));
    let message = format!(
        "parts {} and {} lie on one plane, but their maps have {} and {} samples",
        numbers[0] + 1,
        numbers[1] + 1,
        counts[0],
        counts[1]
    );
    Diagnostic::error(Code::SplitParts, message)
        .at(parts[1].span, "another grid")
        .also(parts[0].span, "the grid of the first")
        .help("bring one onto the grid of the other with `combine`, which stretches all maps over the first")
}

/// The place of a rectangle that looks along a normal: as it stands for +y, turned about the shortest way.
fn frame(normal: DVec3, point: DVec3) -> DAffine3 {
    let across =
        if normal.x == 0.0 && normal.z == 0.0 { DVec3::X } else { DVec3::Y.cross(normal).normalize() };
    let across = if normal.x == 0.0 && normal.z == 0.0 && normal.y < 0.0 { DVec3::NEG_X } else { across };
    DAffine3 { matrix3: DMat3::from_cols(across, normal, across.cross(normal)), translation: point }
}

/// Whether two boxes share more than a face.
fn overlap(one: &Bounds, other: &Bounds) -> bool {
    let (low, high) = (one.min.max(other.min), one.max.min(other.max));
    let slack = 1e-9 * (one.max - one.min).length();
    (high - low).min_element() > slack
}
