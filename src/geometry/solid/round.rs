//! Bodies grown or shrunk by a ball.
//!
//! The ball is replaced by a convex body of corners on it, dense enough that none of its faces is nearer to the middle
//! than the radius less the tolerance. Each point of a grown body then stands off from the body by no more than the
//! radius, and no less than it without the tolerance; of a shrunk one likewise, inward. The corners of the ball are its
//! extremes along the axes, a lattice between them and, where a body has few flat faces, their normals: such faces move
//! by exactly the radius.
//!
//! Source: the sum of two sets is the union of the sums of their convex pieces; H. Hadwiger, Vorlesungen ueber Inhalt,
//! Oberflaeche und Isoperimetrie, 1957, section 4.2.

use glam::DVec3;

use super::check::Check;
use super::parts::solids;
use super::skin::skin;
use super::{Combination, Making, SolidFault, Stock, engine};
use crate::geometry::mesh::{Mesh, VertexIndex};

/// The most that a sweep may take: faces of the body times corners of the ball.
pub const MOST_SWEPT: u64 = 500_000;

/// Directions of faces beyond which a body has no few of them.
const FEW: usize = 96;

/// Most pieces of an edge of the octahedron that becomes the ball.
const FINEST: u32 = 256;

/// A body grown by a radius, or shrunk where it is negative, and the length by which the radius is missed at most.
/// Edges of the result that turn by more than `crease_angle` degrees look sharp.
///
/// Cost: O(n m log n) for n faces and a ball of m corners; of a convex body O(n log n).
///
/// # Errors
/// A body that is no solid, more work than [`MOST_SWEPT`], and a body that is shrunk to nothing.
pub fn offset(
    mesh: &Mesh,
    radius: f64,
    tolerance: f64,
    (resolution, crease_angle, check): (f64, f64, Check),
) -> Result<(Mesh, f64), SolidFault> {
    let mut stock = Stock::default();
    stock.add(mesh, 0);
    let making = Making { resolution, periods: &[], check: &[check] };
    let solids = solids(&stock, &Combination::Part(0), &making)?;
    let body = engine::body(&solids, resolution)?;
    let faces = mesh.triangles.len() as u64;
    let most = (MOST_SWEPT / faces.max(1)).max(6);
    let (ball, missed) = ball(radius.abs(), tolerance, &directions(mesh), most)
        .map_err(|corners| SolidFault::TooMuch { needed: faces * corners, limit: MOST_SWEPT })?;
    let made = if radius > 0.0 { body.dilated(&ball)? } else { body.eroded(&ball)? };
    let (points, triangles) = made.triangles();
    if triangles.is_empty() {
        return Err(SolidFault::Nothing);
    }
    Ok((skin(points, &triangles, crease_angle)?, missed))
}

/// The different normals of the faces of a mesh; none where there are many.
fn directions(mesh: &Mesh) -> Vec<DVec3> {
    /// Difference up to which two normals are one.
    const ALIKE: f64 = 1e-9;
    let corner = |vertex: VertexIndex| mesh.points[mesh.vertices[vertex.subscript()].point.subscript()];
    let mut found: Vec<DVec3> = Vec::new();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(corner);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        if found.iter().all(|known| (*known - normal).abs().max_element() > ALIKE) {
            found.push(normal);
        }
        if found.len() > FEW {
            return Vec::new();
        }
    }
    found
}

/// Corners of a convex body on a ball, with how far its nearest face lies inside the ball. Fails with the number of
/// corners that were too many.
fn ball(radius: f64, tolerance: f64, extra: &[DVec3], most: u64) -> Result<(Vec<DVec3>, f64), u64> {
    // Edges of the lattice turn by up to 1.2 times a quarter turn over their number; a face's circle is wider by 1.16.
    let estimate = 1.1 / (2.0 * tolerance / radius).sqrt();
    let start = (1..FINEST).find(|pieces| f64::from(*pieces) >= 0.7 * estimate).unwrap_or(FINEST);
    for pieces in start..=FINEST {
        let corners = lattice(pieces, extra);
        let count = corners.len() as u64;
        if count > most {
            return Err(count);
        }
        let missed = radius * (1.0 - inner(&corners));
        if missed <= tolerance {
            return Ok((corners.into_iter().map(|corner| corner * radius).collect(), missed));
        }
    }
    Err(u64::from(FINEST) * u64::from(FINEST) * 4)
}

/// Points of the unit sphere: the corners of an octahedron's faces divided evenly, and `extra` with its opposites.
fn lattice(pieces: u32, extra: &[DVec3]) -> Vec<DVec3> {
    let whole = i64::from(pieces);
    let mut corners = Vec::new();
    for x in -whole..=whole {
        let rest = whole - x.abs();
        for y in -rest..=rest {
            let z = rest - y.abs();
            let both = if z == 0 { &[0][..] } else { &[z, -z][..] };
            // Whole numbers of a lattice of at most 256 pieces.
            #[expect(clippy::cast_precision_loss, reason = "small whole numbers")]
            corners.extend(both.iter().map(|z| DVec3::new(x as f64, y as f64, *z as f64).normalize()));
        }
    }
    for direction in extra.iter().flat_map(|direction| [*direction, -*direction]) {
        if corners.iter().all(|known| known.distance(direction) > 1e-6) {
            corners.push(direction);
        }
    }
    corners
}

/// Distance from the middle to the nearest face of the hull of points on the unit sphere.
fn inner(corners: &[DVec3]) -> f64 {
    let Ok((points, triangles)) = engine::hull(corners) else { return 0.0 };
    let away = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| points[*corner as usize]);
        (b - a).cross(c - a).try_normalize().map_or(1.0, |normal| normal.dot(a))
    };
    triangles.iter().map(away).fold(1.0, f64::min)
}
