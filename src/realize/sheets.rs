//! The surfaces of shapes as those of fields, where they are: what can be drawn and proved without a triangle.
//!
//! Balls, boxes, cylinders, cones and tori have fields of their own; quadrics, implicit surfaces and perturbed patches are
//! fields; solids of such bodies, cut by planes too, join their fields, and groups take all of them. Other shapes have
//! none: surfaces over parameters, heights, polygons, distances to shapes, and what is bent, displaced, refined, rounded or hulled.

use glam::{DAffine3, DVec3};

use crate::geometry::curve::AnyCurve;
use crate::geometry::field::{AnyField, Blend, Join, Joined, Placed, Primitive, Sheet};
use crate::geometry::number::Bounds;
use crate::geometry::solid::Combination;
use crate::geometry::tessellate::{Clip, ClippedQuadric, Revolution};
use crate::model::{KeptSide, Model, PlaneCut, Recipe, ShapeHandle, SolidOperation, SolidRecipe};

/// Most surfaces of a shape: with more of them triangles are quicker and as good.
const MOST: usize = 256;

/// Room around a surface in its box, as a share of its size: faces on the sides of a box lie inside it.
const ROOM: f64 = 1e-6;

/// The same where the field has no other surface beside the body.
const WIDE: f64 = 0.02;

/// A closed body and a box around it.
type Body = (AnyField, Bounds);

/// The surfaces of a shape as it stands in the file, each with the map that brings it there; none where a part of it is not
/// the surface of a field.
#[must_use]
pub fn sheets(model: &Model, handle: ShapeHandle) -> Option<Vec<(Sheet, DAffine3)>> {
    let mut all = Vec::new();
    collect(model, handle, &model.frame.map(), &mut all)?;
    Some(all)
}

fn collect(
    model: &Model,
    handle: ShapeHandle,
    outer: &DAffine3,
    all: &mut Vec<(Sheet, DAffine3)>,
) -> Option<()> {
    let shape = model.shape(handle);
    let map = *outer * shape.options.placement;
    let found = match &shape.recipe {
        Recipe::Assembly(parts) if parts.len() <= MOST => {
            return parts.iter().try_for_each(|(part, inner)| collect(model, *part, &(map * *inner), all));
        }
        Recipe::Quadric(quadric) if !quadric.closed => open(quadric)?,
        Recipe::Perturbed(skin) => skin.sheets()?,
        recipe => {
            let (field, bounds) = body(model, recipe)?;
            let room = if matches!(recipe, Recipe::Implicit { .. }) { ROOM } else { WIDE };
            vec![Sheet::whole(field, roomy(bounds, room))]
        }
    };
    all.extend(found.into_iter().map(|sheet| (sheet, map)));
    (all.len() <= MOST && map.matrix3.determinant() != 0.0).then_some(())
}

fn roomy(bounds: Bounds, share: f64) -> Bounds {
    let room = share * bounds.diagonal();
    Bounds { min: bounds.min - room, max: bounds.max + room }
}

fn intersection(of: Vec<AnyField>) -> AnyField {
    AnyField::Joined(Joined { join: Join::Intersection(Blend::Sharp), of })
}

fn moved(field: Primitive, by: DVec3) -> AnyField {
    let field = AnyField::Primitive(field);
    if by == DVec3::ZERO {
        return field;
    }
    AnyField::Placed(Placed::new(field, &DAffine3::from_translation(by)))
}

fn half_space(normal: DVec3, point: DVec3) -> AnyField {
    AnyField::Primitive(Primitive::Plane { normal, offset: normal.dot(point) })
}

/// A box by its sides: their bounds are tighter than those of its distance.
fn sides(bounds: &Bounds) -> AnyField {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let pairs = axes.iter().flat_map(|axis| [half_space(*axis, bounds.max), half_space(-*axis, bounds.min)]);
    intersection(pairs.collect())
}

fn cut_off_by(clip: &Clip) -> AnyField {
    match clip {
        Clip::Box(bounds) => sides(bounds),
        Clip::Ball(ball) => moved(Primitive::Sphere { radius: ball.radius }, ball.center),
    }
}

/// A quadric that ends where it is cut off.
fn open(quadric: &ClippedQuadric) -> Option<Vec<Sheet>> {
    if quadric.form().kind.is_flat() {
        return None;
    }
    Some(vec![Sheet {
        field: AnyField::Quadric(Box::new(quadric.quadric)),
        inside: quadric.within.iter().map(cut_off_by).collect(),
        bounds: roomy(quadric.bounds(), ROOM),
    }])
}

/// The closed body of a recipe, in its own space.
fn body(model: &Model, recipe: &Recipe) -> Option<Body> {
    let bounded = |field: AnyField| {
        let bounds = field.bounds()?;
        Some((field, bounds))
    };
    match recipe {
        Recipe::Cuboid { size, center } => {
            let bounds = Bounds { min: *center - *size / 2.0, max: *center + *size / 2.0 };
            Some((sides(&bounds), bounds))
        }
        Recipe::RoundedBox(shape) => {
            bounded(moved(Primitive::Box { half: shape.size / 2.0, radius: shape.radius }, DVec3::ZERO))
        }
        Recipe::Geodesic(ball) => bounded(moved(Primitive::Sphere { radius: ball.radius }, DVec3::ZERO)),
        Recipe::Revolution(revolution) => bounded(turned(revolution)?),
        Recipe::Implicit { surface, shapes, .. } if shapes.is_empty() => {
            Some((surface.field.clone(), surface.within))
        }
        Recipe::Quadric(quadric) if !quadric.form().kind.is_flat() => {
            let own = AnyField::Quadric(Box::new(quadric.quadric));
            let field = match &quadric.within {
                Some(clip) => intersection(vec![own, cut_off_by(clip)]),
                None => own,
            };
            (quadric.closed || quadric.within.is_none()).then_some((field, quadric.bounds()))
        }
        Recipe::Perturbed(skin) if skin.is_solid() => {
            let sheet = skin.sheets()?.pop()?;
            Some((sheet.field, sheet.bounds))
        }
        Recipe::Solid(solid) => of_solid(model, solid),
        _ => None,
    }
}

/// The body of a shape under its placement.
fn placed(model: &Model, handle: ShapeHandle) -> Option<Body> {
    let shape = model.shape(handle);
    let (field, bounds) = body(model, &shape.recipe)?;
    let map = shape.options.placement;
    if map == DAffine3::IDENTITY {
        return Some((field, bounds));
    }
    let around = Bounds::of_points(bounds.corners().map(|corner| map.transform_point3(corner)));
    (map.matrix3.determinant() != 0.0).then(|| (AnyField::Placed(Placed::new(field, &map)), around))
}

fn of_solid(model: &Model, solid: &SolidRecipe) -> Option<Body> {
    match &solid.operation {
        SolidOperation::Combine(how) => combined(how, &|part| placed(model, solid.parts[part])),
        SolidOperation::Cut(PlaneCut { above, keep, cap: true, .. }) => {
            let (field, bounds) = placed(model, *solid.parts.first()?)?;
            let normal = match keep {
                KeptSide::Above => -above.normal,
                KeptSide::Below => above.normal,
                KeptSide::Both => return None,
            };
            Some((intersection(vec![field, half_space(normal, above.point)]), bounds))
        }
        _ => None,
    }
}

fn combined(how: &Combination, part: &dyn Fn(usize) -> Option<Body>) -> Option<Body> {
    let all = |of: &[Combination]| of.iter().map(|one| combined(one, part)).collect::<Option<Vec<Body>>>();
    let joined = |join: Join, bodies: Vec<Body>, bounds: Bounds| {
        let of = bodies.into_iter().map(|(field, _)| field).collect();
        Some((AnyField::Joined(Joined { join, of }), bounds))
    };
    match how {
        Combination::Part(number) => part(*number),
        Combination::Union(of) => {
            let bodies = all(of)?;
            let bounds = bodies.iter().fold(Bounds::EMPTY, |all, (_, own)| all.union(*own));
            joined(Join::Union(Blend::Sharp), bodies, bounds)
        }
        Combination::Intersection(of) => {
            let bodies = all(of)?;
            let bounds = bodies.first()?.1;
            joined(Join::Intersection(Blend::Sharp), bodies, bounds)
        }
        Combination::Difference(first, others) => {
            let mut bodies = vec![combined(first, part)?];
            bodies.extend(all(others)?);
            let bounds = bodies[0].1;
            joined(Join::Difference(Blend::Sharp), bodies, bounds)
        }
    }
}

/// A profile turned all the way that makes a ball, a torus, a cylinder or a cone.
fn turned(revolution: &Revolution) -> Option<AnyField> {
    if revolution.angle != 360.0 {
        return None;
    }
    match &revolution.profile {
        AnyCurve::Ellipse(arc) => {
            let radius = arc.x.x;
            if arc.x != DVec3::X * radius || arc.y != DVec3::Y * radius || arc.center.z != 0.0 {
                return None;
            }
            let up = DVec3::Y * arc.center.y;
            let whole = (arc.to - arc.from).abs() == 360.0;
            if arc.center.x == 0.0 && (arc.from, arc.to) == (-90.0, 90.0) {
                return Some(moved(Primitive::Sphere { radius }, up));
            }
            let ring = Primitive::Torus { major: arc.center.x, minor: radius };
            (whole && arc.center.x > radius).then(|| moved(ring, up))
        }
        AnyCurve::Polyline(line) => {
            let (low, from, to, high) = match line.points() {
                [low, from, to, high] => (low, from, to, high),
                [low, from, high] if low.y == from.y => (low, from, high, high),
                [low, to, high] => (low, low, to, high),
                _ => return None,
            };
            let level = low.y == from.y && to.y == high.y && from.y < to.y && low.x == 0.0 && high.x == 0.0;
            let (bottom, top, half) = (from.x, to.x, (to.y - from.y) / 2.0);
            let middle = DVec3::Y * f64::midpoint(from.y, to.y);
            (level && bottom.max(top) > 0.0).then(|| moved(Primitive::Cone { bottom, top, half }, middle))
        }
        _ => None,
    }
}
