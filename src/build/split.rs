//! Bodies of parts on split planes into recipes.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::Builder;
use crate::geometry::map::GridField;
use crate::geometry::mesh;
use crate::geometry::number::Bounds;
use crate::geometry::solid::Combination;
use crate::geometry::tessellate::{Closing, HeightBound, HeightMap, TwoSided};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{ShapeOptions, Split, SplitOperation, SplitPart};
use crate::model::{Recipe, Shape, ShapeHandle, SolidOperation, SolidRecipe};

/// Most samples of a grid on which two maps of a plane are brought.
const MOST_SAMPLES: usize = 1 << 24;

/// A part, its heights over the rectangle, and where it is written.
#[derive(Clone)]
struct Part {
    map: HeightMap,
    normal: DVec3,
    point: DVec3,
    operation: SplitOperation,
    span: Span,
}

/// A body on one plane.
struct Body {
    recipe: Recipe,
    place: DAffine3,
    bounds: Bounds,
    operation: SplitOperation,
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
        let joined = bodies.iter().all(|body| body.operation == SplitOperation::Union);
        let apart = joined && !(0..bodies.len()).any(reach);
        if apart && bodies.len() == 1 {
            return bodies.into_iter().next().map(|body| (body.recipe, body.place));
        }
        let operations: Vec<SplitOperation> = bodies.iter().map(|body| body.operation).collect();
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
        let operation = SolidOperation::Combine(combined(&operations));
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
        let (normal, point) = (written.normal.value.normalize(), written.point.value);
        Some(Part { map, normal, point, operation: written.operation.value, span })
    }

    /// Pairs of parts on one plane, and what is left alone.
    fn bodies(&mut self, parts: Vec<Part>) -> Option<Vec<Body>> {
        if let Some(first) = parts.first().filter(|first| first.operation != SplitOperation::Union) {
            let report =
                Diagnostic::error(Code::SplitParts, "the first part of a split body has no parts before it")
                    .at(first.span, "has an operation")
                    .help("write the part that is changed first");
            self.report(report);
            return None;
        }
        let mut waiting: Vec<Option<(usize, Part)>> = parts.into_iter().enumerate().map(Some).collect();
        let mut bodies = Vec::new();
        for k in 0..waiting.len() {
            let Some((number, part)) = waiting[k].take() else { continue };
            let place = frame(part.normal, part.point);
            // Added parts alone are stitched, and none is moved before one that takes something away.
            let added = |part: &Part| part.operation == SplitOperation::Union;
            let faces_it =
                |other: &Part| other.point == part.point && (other.normal + part.normal).length() < 1e-9;
            let near = waiting[k + 1..]
                .iter()
                .take_while(|other| other.as_ref().is_none_or(|(_, other)| added(&part) && added(other)));
            let mut near = near.enumerate();
            let found = near.find(|(_, other)| other.as_ref().is_some_and(|(_, other)| faces_it(other)));
            let found = found.map(|(at, _)| at);
            let other = found.and_then(|at| waiting[k + 1 + at].take());
            let (recipe, depth) = match other {
                None => (Recipe::Height(part.map.clone()), 0.0),
                Some((other_number, back)) => {
                    let Some([front, behind]) = common([&part.map.field, &back.map.field]) else {
                        self.report(unequal([&part, &back], [number, other_number]));
                        return None;
                    };
                    let (mut part, mut back) = (part.clone(), back);
                    (part.map.field, back.map.field) = (front, behind);
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
            let operation = part.operation;
            bodies.push(Body { recipe, place, bounds: Bounds::of_points(corners), operation });
        }
        Some(bodies)
    }
}

/// Two fields on one grid on which both are what they were; none where that would be too fine.
fn common(fields: [&Arc<GridField>; 2]) -> Option<[Arc<GridField>; 2]> {
    let steps = fields.map(|field| [field.columns() - 1, field.rows() - 1]);
    if steps[0] == steps[1] {
        return Some(fields.map(Arc::clone));
    }
    let both = [0, 1].map(|axis| least_multiple(steps[0][axis], steps[1][axis]));
    let samples = both[0].checked_add(1)?.checked_mul(both[1].checked_add(1)?)?;
    if samples > MOST_SAMPLES {
        return None;
    }
    Some([0, 1].map(|k| Arc::new(fields[k].refined(both[0] / steps[k][0], both[1] / steps[k][1]))))
}

fn least_multiple(a: usize, b: usize) -> usize {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}

/// Each body joined to all before it by its operation.
fn combined(operations: &[SplitOperation]) -> Combination {
    let mut whole = Combination::Part(0);
    for (number, operation) in operations.iter().enumerate().skip(1) {
        let part = Combination::Part(number);
        whole = match (operation, whole) {
            (SplitOperation::Union, Combination::Union(mut parts)) => {
                parts.push(part);
                Combination::Union(parts)
            }
            (SplitOperation::Union, whole) => Combination::Union(vec![whole, part]),
            (SplitOperation::Difference, whole) => Combination::Difference(Box::new(whole), vec![part]),
            (SplitOperation::Intersection, whole) => Combination::Intersection(vec![whole, part]),
        };
    }
    whole
}

fn unequal(parts: [&Part; 2], numbers: [usize; 2]) -> Diagnostic {
    let counts = parts.map(|part| format!("{} x {}", part.map.field.columns(), part.map.field.rows()));
    let message = format!(
        "parts {} and {} lie on one plane, but their maps have {} and {} samples, which share no grid of less than 16 777 216",
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
