//! The body of a skin as a field: all points below its surface.
//!
//! Of a single convex face it is what lies under the surface between the walls of its rays, down to a floor. Of a closed
//! skin about a center it is what the surface encloses.

use glam::DVec3;

use super::net::{NEAR_CENTER, NoSolid, ball};
use super::{NetBase, PerturbedFace, PerturbedNet, PerturbedSkin};
use crate::geometry::field::{AnyField, Blend, Join, Joined, Primitive, Quadric, Relief, ReliefBump, Sheet};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::field::FieldSurface;

/// Room around a body in the box where it is searched, as a share of its size.
const ROOM: f64 = 0.02;

/// The body of a skin.
pub(super) fn body(
    net: &PerturbedNet,
    skin: &PerturbedSkin,
    radius: Option<f64>,
) -> Result<FieldSurface, NoSolid> {
    let (field, bounds) = match skin.faces.as_slice() {
        [face] => below(net, face)?,
        _ => enclosed(net, skin, radius)?,
    };
    let room = ROOM * bounds.diagonal();
    let within = Bounds { min: bounds.min - room, max: bounds.max + room };
    Ok(FieldSurface { field, within, least: None })
}

fn all_of(of: Vec<AnyField>) -> AnyField {
    AnyField::Joined(Joined { join: Join::Intersection(Blend::Sharp), of })
}

fn half_space(normal: DVec3, point: DVec3) -> AnyField {
    AnyField::Primitive(Primitive::Plane { normal, offset: normal.dot(point) })
}

/// What lies below one face, down to its floor.
fn below(net: &PerturbedNet, face: &PerturbedFace) -> Result<(AnyField, Bounds), NoSolid> {
    if !face.is_convex() {
        return Err(NoSolid::NotConvex);
    }
    let walls = face.sides().map(|[from, to]| half_space(face.rays.wall(from, to), face.rays.foot(from)));
    let (low, high) = face.reach;
    let rest = face.outline.iter().map(|at| face.rest(*at)).fold(f64::INFINITY, f64::min);
    let stretch = face.rays.stretch();
    let middle = glam::DVec2::ZERO;
    let axis = face.rays.direction(middle) / stretch;
    let (bottom, floor) = if let (NetBase::Ball(center), Some(radius)) = (net.base, face.radius) {
        let deepest = net.depth.map_or(low.min(1.0) / 2.0, |depth| 1.0 - depth / radius);
        let share = deepest.max(NEAR_CENTER);
        let inner = ball(center, radius * share);
        let zero = Quadric::new(DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, 0.0);
        (AnyField::Quadric(Box::new(zero.plus(&inner, -1.0))), share * rest)
    } else {
        let floor = match net.depth {
            Some(depth) => rest - depth / stretch,
            None if face.rays.is_central() => low.min(rest) / 2.0,
            // Below all hollows by half of what lies above them, so that no wall is thin.
            None => low.min(rest) - (high - low) / 2.0,
        };
        let floor = if face.rays.is_central() { floor.max(NEAR_CENTER) } else { floor };
        (half_space(-axis, face.rays.point(middle, floor)), floor)
    };
    let field = all_of([face.relief.field(), bottom].into_iter().chain(walls).collect());
    let bounds = face.rays.block(face.rectangle(), (floor, high));
    Ok((field, bounds))
}

/// What a closed skin encloses.
fn enclosed(
    net: &PerturbedNet,
    skin: &PerturbedSkin,
    radius: Option<f64>,
) -> Result<(AnyField, Bounds), NoSolid> {
    if !skin.is_closed() {
        return Err(NoSolid::Open);
    }
    if net.bumps.iter().any(|bump| bump.faces.as_ref().is_some_and(|faces| faces.len() < skin.faces.len())) {
        return Err(NoSolid::OwnBumps);
    }
    let mut bounds = Bounds::of_points(net.points.iter().copied());
    let base = match net.base {
        NetBase::Flat => return Err(NoSolid::NoCenter),
        NetBase::Ball(center) => {
            let radius = radius.unwrap_or(1.0);
            bounds = Bounds { min: center - radius, max: center + radius };
            AnyField::Quadric(Box::new(ball(center, radius)))
        }
        NetBase::FlatAround(_) => {
            let planes: Vec<Quadric> = skin.faces.iter().map(|face| face.relief.base).collect();
            let slack = 1e-9 * bounds.diagonal();
            let outside = |plane: &Quadric| net.points.iter().any(|p| p.dot(plane.b) + plane.c > slack);
            if planes.iter().any(outside) {
                return Err(NoSolid::NotConvex);
            }
            all_of(planes.into_iter().map(|plane| AnyField::Quadric(Box::new(plane))).collect())
        }
    };
    let reach = net.reach.unwrap_or(bounds.diagonal() / 2.0);
    let hills = net.bumps.iter().filter(|bump| bump.bump.factor > 0.0);
    let all = hills.fold(bounds, |all, hill| match hill.bump.bounds() {
        Some(own) => all.union(*own),
        None => all.union(Bounds { min: bounds.min - reach, max: bounds.max + reach }),
    });
    let bumps: Vec<ReliefBump> = net.bumps.iter().map(|bump| bump.bump.clone()).collect();
    Ok((Relief::on(base, &bumps), all))
}

impl PerturbedSkin {
    /// Its surface as that of fields: of its body, or face by face between the walls of the rays; none where a face is not
    /// convex.
    #[must_use]
    pub fn sheets(&self) -> Option<Vec<Sheet>> {
        match &self.solid {
            Some(body) => Some(vec![Sheet::whole(body.field.clone(), body.within)]),
            None => self.faces.iter().map(between_walls).collect(),
        }
    }
}

/// The surface of one face: between the walls of its rays, and between the numbers of rays that it does not leave.
fn between_walls(face: &PerturbedFace) -> Option<Sheet> {
    if !face.is_convex() {
        return None;
    }
    let walls = face.sides().map(|[from, to]| half_space(face.rays.wall(from, to), face.rays.foot(from)));
    let (low, high) = face.reach;
    let middle = glam::DVec2::ZERO;
    let axis = face.rays.direction(middle) / face.rays.stretch();
    let ends =
        [half_space(-axis, face.rays.point(middle, low)), half_space(axis, face.rays.point(middle, high))];
    Some(Sheet {
        field: face.relief.field(),
        inside: walls.chain(ends).collect(),
        bounds: face.rays.block(face.rectangle(), face.reach),
    })
}
