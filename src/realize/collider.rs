//! Bodies for physics: what a shape is by its recipe, or what encloses its triangles.
//!
//! Promise: a shape that is a box, a ball, a capsule or a cylinder gives exactly that body, by the numbers of its recipe and not
//! of its triangles, whatever placement moves, turns or evenly scales it. Every vertex of any other lies in its body, or in one
//! of its parts.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::shape::{self, Maker};
use super::{Options, RealizeError};
use crate::geometry::curve::AnyCurve;
use crate::geometry::mesh::{Mesh, Wire};
use crate::geometry::number::Bounds;
use crate::geometry::solid::{
    ConvexPart, Decomposing, Round, SolidFault, decompose, enclosing_capsule, enclosing_cylinder,
    enclosing_hull, enclosing_radius,
};
use crate::model::{self, Fit, Model, Recipe, ShapeHandle};
use crate::scene::{Body, Collider, ColliderPart, Scene};

/// Part of a length within which two are equal.
const EQUAL: f64 = 1e-9;

/// A body and where it stands.
type Placed = (Body, DAffine3);

/// The colliders of a model around what its scene has; `shapes` are those of its geometries.
///
/// # Errors
/// Shapes without volume, and those that cannot be made.
pub fn colliders(
    model: &Model,
    options: &Options<'_>,
    shapes: &[ShapeHandle],
    scene: &Scene,
) -> Result<Vec<Collider>, Vec<(ShapeHandle, RealizeError)>> {
    let mut all = Vec::new();
    let mut errors = Vec::new();
    for (index, collider) in model.colliders.iter().enumerate() {
        match body(model, options, (index, collider), shapes, scene) {
            Ok(made) => all.extend(of_nodes(model, collider, &made)),
            Err(error) => errors.push((collider.shape, error)),
        }
    }
    if errors.is_empty() { Ok(all) } else { Err(errors) }
}

/// The bodies that stand for a shape.
struct Made {
    bodies: Vec<Placed>,
    /// Whether they are the shape itself.
    exact: bool,
    /// Of several that stand for parts how far from convex each is, and may be, metres.
    concavities: Option<(Vec<f64>, f64)>,
}

fn of_nodes(model: &Model, collider: &model::Collider, made: &Made) -> Vec<Collider> {
    let many = collider.nodes.len() > 1;
    let mut all = Vec::new();
    for node in &collider.nodes {
        // Nodes that show one shape have a collider each.
        let own = &collider.name;
        let name = if many { format!("{own}.{}", model.nodes[*node].name) } else { own.clone() };
        for (number, (body, map)) in made.bodies.iter().enumerate() {
            let part = made.concavities.as_ref().map(|(concavities, allowed)| ColliderPart {
                of: name.clone(),
                concavity: concavities[number],
                allowed: *allowed,
            });
            all.push(Collider {
                name: if part.is_some() { format!("{name}-{number:02}") } else { name.clone() },
                shape: model.shape(collider.shape).name.clone(),
                node: *node,
                holder: None,
                body: body.clone(),
                translation: map.translation,
                rotation: DQuat::from_mat3(&map.matrix3).normalize(),
                exact: made.exact,
                part,
            });
        }
    }
    all
}

/// The bodies of a collider, in metres.
fn body(
    model: &Model,
    options: &Options<'_>,
    (index, collider): (usize, &model::Collider),
    shapes: &[ShapeHandle],
    scene: &Scene,
) -> Result<Made, RealizeError> {
    let one = |placed: Placed, exact: bool| Made { bodies: vec![placed], exact, concavities: None };
    let asked = |body: &Body| match collider.fit {
        Fit::Auto => true,
        Fit::Box => matches!(body, Body::Box { .. }),
        Fit::Sphere => matches!(body, Body::Sphere { .. }),
        Fit::Capsule => matches!(body, Body::Capsule { .. }),
        Fit::Cylinder => matches!(body, Body::Cylinder { .. }),
        Fit::Hull | Fit::Parts => false,
    };
    let own = simple(model, collider.shape).and_then(|(body, map)| scaled(body, model.frame.map() * map));
    if let Some(own) = own.filter(|(body, _)| asked(body)) {
        return Ok(one(own, true));
    }
    let made;
    let (mesh, wire) = match shapes.iter().position(|shape| *shape == collider.shape) {
        Some(geometry) => (&scene.geometries[geometry].mesh, &scene.geometries[geometry].wire),
        None => {
            let mut shape = Maker::new(model, options).make(collider.shape, false)?;
            shape::to_metres(&mut shape, &model.frame);
            made = shape;
            (&made.mesh, &made.wire)
        }
    };
    let points = points_of(&mesh.points, wire);
    let bounds = Bounds::of_points(points.iter().copied());
    let flat = || RealizeError::FlatCollider { collider: index };
    if bounds.is_empty() || (bounds.max - bounds.min).min_element() <= EQUAL * bounds.diagonal() {
        return Err(flat());
    }
    let middle = DAffine3::from_translation(bounds.center());
    let placed = match collider.fit {
        Fit::Box => (Body::Box { size: bounds.max - bounds.min }, middle),
        Fit::Sphere => (Body::Sphere { radius: enclosing_radius(&points, bounds.center()) }, middle),
        Fit::Capsule => {
            let round = enclosing_capsule(&points);
            (Body::Capsule { radius: round.radius, height: round.height }, along(&round))
        }
        Fit::Cylinder => {
            let round = enclosing_cylinder(&points);
            (Body::Cylinder { radius: round.radius, height: round.height }, along(&round))
        }
        Fit::Auto | Fit::Hull => {
            let (points, triangles) = enclosing_hull(&points, collider.vertices as usize)
                .map_err(|fault| RealizeError::Solid { shape: collider.shape, part: None, fault })?;
            (Body::Hull { points, triangles }, DAffine3::IDENTITY)
        }
        Fit::Parts => {
            return parts(collider, mesh, wire, bounds.diagonal())
                .map_err(|fault| RealizeError::ColliderParts { collider: index, fault });
        }
    };
    Ok(one(placed, false))
}

/// Convex parts of a mesh in metres.
fn parts(collider: &model::Collider, mesh: &Mesh, wire: &Wire, size: f64) -> Result<Made, SolidFault> {
    if !wire.is_empty() {
        return Err(SolidFault::Lines { part: 0 });
    }
    let concavity = collider.concavity * size;
    let (most, vertices) = (collider.parts as usize, collider.vertices as usize);
    let found = decompose(mesh, &Decomposing { most, concavity, vertices })?;
    let concavities = found.iter().map(|part| part.concavity).collect();
    let body = |part: ConvexPart| Body::Hull { points: part.points, triangles: part.triangles };
    Ok(Made {
        bodies: found.into_iter().map(|part| (body(part), DAffine3::IDENTITY)).collect(),
        exact: false,
        concavities: Some((concavities, concavity)),
    })
}

fn points_of(points: &[DVec3], wire: &Wire) -> Vec<DVec3> {
    points.iter().copied().chain(wire.points.iter().map(|point| point.position)).collect()
}

/// Where a round body along an axis stands.
fn along(round: &Round) -> DAffine3 {
    let turn = match round.axis {
        0 => DQuat::from_rotation_arc(DVec3::Y, DVec3::X),
        2 => DQuat::from_rotation_arc(DVec3::Y, DVec3::Z),
        _ => DQuat::IDENTITY,
    };
    DAffine3::from_rotation_translation(turn, round.center)
}

/// The body that a recipe is, in the document's unit, under a map that may scale.
fn simple(model: &Model, handle: ShapeHandle) -> Option<Placed> {
    let shape = model.shape(handle);
    let (body, map) = match &shape.recipe {
        Recipe::Cuboid { size, center } => (Body::Box { size: *size }, DAffine3::from_translation(*center)),
        Recipe::Geodesic(ball) => (Body::Sphere { radius: ball.radius }, DAffine3::IDENTITY),
        Recipe::Revolution(turned) if turned.angle.abs() == 360.0 => {
            let (body, height) = turned_body(&turned.profile)?;
            (body, DAffine3::from_translation(DVec3::Y * height))
        }
        Recipe::Assembly(parts) => match parts[..] {
            [(part, map)] => {
                let (body, inner) = simple(model, part)?;
                (body, map * inner)
            }
            _ => return None,
        },
        _ => return None,
    };
    Some((body, shape.options.placement * map))
}

/// The body that a profile turned about the y axis is, and how high its middle stands.
fn turned_body(profile: &AnyCurve) -> Option<(Body, f64)> {
    match profile {
        AnyCurve::Ellipse(_) => {
            let (radius, y, whole) = arc_about_axis(profile)?;
            whole.then_some((Body::Sphere { radius }, y))
        }
        AnyCurve::Polyline(line) => {
            let [a, b, c, d] = *line.points() else { return None };
            let radius = b.x;
            let cylinder = a.x == 0.0 && d.x == 0.0 && c.x == radius && a.y == b.y && c.y == d.y;
            let height = (c.y - b.y).abs();
            (cylinder && radius > 0.0 && height > 0.0)
                .then_some((Body::Cylinder { radius, height }, (b.y + c.y) / 2.0))
        }
        AnyCurve::Path(path) => {
            let [low, AnyCurve::Polyline(side), high] = path.curves() else { return None };
            let ((radius, below, _), (other, above, _)) = (arc_about_axis(low)?, arc_about_axis(high)?);
            let [from, to] = *side.points() else { return None };
            let near = |a: f64, b: f64| (a - b).abs() <= EQUAL * radius;
            let straight =
                near(from.x, radius) && near(to.x, radius) && near(from.y, below) && near(to.y, above);
            let height = (above - below).abs();
            (near(radius, other) && straight)
                .then_some((Body::Capsule { radius, height }, (below + above) / 2.0))
        }
        _ => None,
    }
}

/// Radius and height of the middle of an arc of a circle about a point of the axis that runs from the axis to its equator, or
/// to the other pole; and whether it does that.
fn arc_about_axis(curve: &AnyCurve) -> Option<(f64, f64, bool)> {
    let AnyCurve::Ellipse(arc) = curve else { return None };
    let radius = arc.x.length();
    let near = |a: f64, b: f64| (a - b).abs() <= EQUAL * radius;
    let circle = near(arc.y.length(), radius) && arc.x.dot(arc.y).abs() <= EQUAL * radius * radius;
    let plane =
        near(arc.center.x, 0.0) && near(arc.center.z, 0.0) && near(arc.x.x, radius) && near(arc.y.y, radius);
    let ends = [arc.from.min(arc.to), arc.from.max(arc.to)];
    let whole = ends == [-90.0, 90.0];
    let half = ends == [-90.0, 0.0] || ends == [0.0, 90.0];
    (circle && plane && radius > 0.0 && (whole || half)).then_some((radius, arc.center.y, whole))
}

/// A body under a map without its scale; `None` where that makes another kind of body of it.
fn scaled(body: Body, map: DAffine3) -> Option<Placed> {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let [x, y, z] = columns.map(|column| column.length());
    let square = [(0, 1), (1, 2), (2, 0)].iter().all(|(a, b)| {
        columns[*a].dot(columns[*b]).abs() <= EQUAL * columns[*a].length() * columns[*b].length()
    });
    let least = x.min(y).min(z);
    if !square || least.is_nan() || least <= 0.0 {
        return None;
    }
    let same = |a: f64, b: f64| (a - b).abs() <= EQUAL * a.max(b);
    let body = match body {
        Body::Box { size } => Body::Box { size: size * DVec3::new(x, y, z) },
        Body::Sphere { radius } if same(x, y) && same(y, z) => Body::Sphere { radius: radius * x },
        Body::Capsule { radius, height } if same(x, y) && same(y, z) => {
            Body::Capsule { radius: radius * x, height: height * x }
        }
        Body::Cylinder { radius, height } if same(x, z) => {
            Body::Cylinder { radius: radius * x, height: height * y }
        }
        _ => return None,
    };
    let [a, b, _] = columns.map(|column| column.normalize());
    // All of them are their own mirror images: a map that mirrors turns as one does that does not.
    Some((body, DAffine3 { matrix3: DMat3::from_cols(a, b, a.cross(b)), translation: map.translation }))
}
