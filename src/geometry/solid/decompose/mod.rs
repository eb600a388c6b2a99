//! Bodies into convex parts.
//!
//! Promise: every point of a body lies in one of its parts but for rounding; the parts are convex, no more than was asked for,
//! with no more corners each. A hollow that nothing reaches is filled. The same input gives the same bits for any number of
//! threads. Not promised: the fewest parts that would do, or that they lie beside each other: they may overlap.
//!
//! A body is cut by planes, exactly, the least convex part first, until each part is as convex as asked or there are twice
//! as many as allowed; then parts are joined again as long as what they make together is as convex, and further until there
//! are few enough. How far a part is from convex is a length: the greater of how far its hull's surface lies from it, and 0.3
//! of the radius of a ball of the volume that its hull has beyond it.
//!
//! Source: X. Wei, M. Liu, Z. Ling, H. Su, Approximate Convex Decomposition for 3D Meshes with Collision-Aware Concavity and
//! Tree Search, 2022, sections 3.2 and 4 (what is measured, cutting and joining); the plane is the best of a list, without a
//! search ahead. Cost: for each part some 60 planes of O(n) and one exact cut of O(n log n).

mod join;
mod plane;
#[cfg(test)]
mod tests;

use glam::DVec3;

use super::check::moments;
use super::engine::Body;
use super::parts::solids;
use super::{Combination, Making, SolidFault, Stock, enclosing_hull, engine};
use crate::geometry::mesh::Mesh;
use crate::geometry::mesh::distance::Sheet;
use crate::geometry::number::cbrt;

/// How a body is decomposed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decomposing {
    /// The most parts.
    pub most: usize,
    /// How far from convex what a part stands for may be, in the unit of the mesh.
    pub concavity: f64,
    /// The most corners of each part, no fewer than 8.
    pub vertices: usize,
}

/// A convex part of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexPart {
    /// Its corners.
    pub points: Vec<DVec3>,
    /// Counter-clockwise, seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// How far from convex that is what it stands for.
    pub concavity: f64,
}

/// Part of the radius of a ball of the volume that a hull adds that counts as concavity: as in the source.
const BALL: f64 = 0.3;

/// Part of the volume of a hull that rounding may add to it.
const ROUNDING: f64 = 1e-9;

/// Parts that a body may be in before it is cut.
pub const MOST_BODIES: usize = 256;

/// Convex parts that cover a body, in an order that the body alone decides.
///
/// # Errors
/// A body that is no solid; one that is more than [`MOST_BODIES`] bodies apart from each other.
pub fn decompose(mesh: &Mesh, how: &Decomposing) -> Result<Vec<ConvexPart>, SolidFault> {
    let mut stock = Stock::default();
    stock.add(mesh, 0);
    let solids = solids(&stock, &Combination::Part(0), &Making::default())?;
    let accuracy = how.concavity / 8.0;
    let mut parts = Vec::new();
    for body in engine::body(&solids, 0.0)?.components() {
        parts.extend(Part::new(body, accuracy)?);
    }
    if parts.is_empty() {
        return Err(SolidFault::Flat);
    }
    if parts.len() > MOST_BODIES {
        return Err(SolidFault::Scattered { bodies: parts.len(), limit: MOST_BODIES });
    }
    while parts.len() < 2 * how.most {
        let rough = |part: &&mut Part| !part.last && part.concavity > how.concavity;
        let worst = parts.iter_mut().filter(rough).max_by(|a, b| a.concavity.total_cmp(&b.concavity));
        let Some(worst) = worst else { break };
        match worst.divided(accuracy)? {
            made if made.len() < 2 => worst.last = true,
            mut made => {
                *worst = made.swap_remove(0);
                parts.append(&mut made);
            }
        }
    }
    let convex = |part: Part| {
        let (points, triangles) = enclosing_hull(&part.hull.points, how.vertices)?;
        Ok(ConvexPart { points, triangles, concavity: part.concavity })
    };
    join::joined(parts, how)?.into_iter().map(convex).collect()
}

/// The least convex body around something.
#[derive(Clone, Debug)]
struct Hull {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    volume: f64,
}

impl Hull {
    /// None around points that lie on one plane.
    fn around(points: &[DVec3]) -> Result<Option<Self>, SolidFault> {
        let (points, triangles) = match engine::hull(points) {
            Ok(found) => found,
            Err(SolidFault::Flat) => return Ok(None),
            Err(fault) => return Err(fault),
        };
        let volume = moments(&points, triangles.iter().copied()).0 / 6.0;
        Ok(Some(Self { points, triangles, volume }))
    }
}

/// What one convex body is to stand for.
#[derive(Clone)]
struct Part {
    /// Nothing where parts were joined.
    body: Option<Body>,
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    volume: f64,
    hull: Hull,
    concavity: f64,
    /// Whether no plane divides it.
    last: bool,
}

impl Part {
    /// None of a body that is a hollow, or as flat as a plane.
    fn new(body: Body, accuracy: f64) -> Result<Option<Self>, SolidFault> {
        let (points, triangles) = body.triangles();
        let volume = moments(&points, triangles.iter().copied()).0 / 6.0;
        if volume <= 0.0 {
            return Ok(None);
        }
        let Some(hull) = Hull::around(&points)? else { return Ok(None) };
        let concavity = concavity((&points, &triangles), volume, &hull, accuracy);
        Ok(Some(Self { body: Some(body), points, triangles, volume, hull, concavity, last: false }))
    }

    /// Its pieces on both sides of the best plane; fewer than two where no plane divides it.
    fn divided(&self, accuracy: f64) -> Result<Vec<Self>, SolidFault> {
        let Some(body) = &self.body else { return Ok(Vec::new()) };
        let Some(plane) = plane::best(self)? else { return Ok(Vec::new()) };
        let mut made = Vec::new();
        for side in body.halves(&plane)? {
            for piece in side.components() {
                made.extend(Self::new(piece, accuracy)?);
            }
        }
        Ok(made)
    }
}

/// How far something of a volume is from its hull.
fn concavity((points, triangles): (&[DVec3], &[[u32; 3]]), volume: f64, hull: &Hull, accuracy: f64) -> f64 {
    if hull.volume - volume <= ROUNDING * hull.volume {
        return 0.0;
    }
    let own = Sheet::new(points.to_vec(), triangles.to_vec());
    let around = Sheet::new(hull.points.clone(), hull.triangles.clone());
    let away = around.zip(own).map_or(0.0, |(hull, own)| hull.farthest_from(&own, accuracy).at_most);
    away.max(ball(hull.volume - volume))
}

/// What a volume beyond a body counts as concavity.
fn ball(volume: f64) -> f64 {
    BALL * cbrt(3.0 * volume.max(0.0) / (4.0 * std::f64::consts::PI))
}
