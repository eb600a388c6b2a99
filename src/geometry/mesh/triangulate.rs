//! One polygon, with holes, into triangles: the checked adapter of the `earcut` crate.
//!
//! Promise: on success every boundary edge is the edge of exactly one triangle, no point is added or left out
//! (collinear ones stay connected, so neighbours meet without T-junctions), no triangle is turned over, and the
//! areas add up. Corners that touch count as one place there; of the corners on a place, triangles name the one
//! whose edge leaves the place at the sector they lie in. Where that cannot be had, the result is an error, never a wrong triangulation. Not promised:
//! that a polygon that winds twice around a region is noticed; ask [`crossing()`] for that.
//!
//! Notation: a *ring* is a closed loop of points; ring 0 is the outer one, the others are holes and may run
//! either way. A *corner* is a place in the rings, counted through all of them.

mod conform;
mod crossing;

use earcut::{Earcut, Refiner};
use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};
use thiserror::Error;

use crate::geometry::mesh::index;
use crate::geometry::mesh::polygon::newell;

pub use crossing::crossing;

/// Most corners of one polygon; the triangulation keeps some hundred bytes for each.
pub const CORNER_LIMIT: usize = 8_000_000;

/// Why a polygon has no triangulation.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TriangulateError {
    /// A ring with fewer than three corners.
    #[error("ring {ring} has {corners} corners; a polygon needs at least three")]
    TooFewCorners {
        /// Which ring; 0 is the outer one.
        ring: u32,
        /// Its corners.
        corners: u32,
    },
    /// More corners than [`CORNER_LIMIT`].
    #[error("the polygon has {corners} corners; at most {CORNER_LIMIT} can be triangulated")]
    TooManyCorners {
        /// How many there are.
        corners: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("corner {corner} has a coordinate that is not a finite number")]
    NotFinite {
        /// Which corner.
        corner: u32,
    },
    /// All points of a ring on one line, or equal areas that cancel.
    #[error("ring {ring} encloses no area")]
    NoArea {
        /// Which ring.
        ring: u32,
    },
    /// Two edges cross or overlap.
    #[error("the edges that begin at corners {} and {} cross", edges[0], edges[1])]
    Crossing {
        /// The corners at which the two edges begin.
        edges: [u32; 2],
    },
    /// No two edges cross, yet no triangulation was found: a hole outside the outer ring or inside another
    /// hole, or points closer together than rounding can tell.
    #[error("no triangulation found: a hole lies outside the polygon, or points nearly coincide")]
    Unsolved,
}

/// Triangles of a polygon in the plane, as corners; they turn the way the outer ring turns.
///
/// Deterministic. O(n log n) on ordinary polygons, O(n^2) at worst.
///
/// # Errors
/// See [`TriangulateError`].
pub fn triangulate(rings: &[&[DVec2]]) -> Result<Vec<[u32; 3]>, TriangulateError> {
    let polygon = Polygon::new(rings)?;
    if let Some(split) = polygon.quad_split() {
        let mut split = split.map(|triangle| polygon.oriented(triangle));
        split.sort_unstable();
        return Ok(split.to_vec());
    }
    let triangles = match polygon.corners.len() {
        3 => vec![[0, 1, 2]],
        _ => polygon.cut().ok_or_else(|| explain(rings))?,
    };
    Ok(triangles.into_iter().map(|triangle| polygon.oriented(triangle)).collect())
}

/// Triangles of a nearly planar polygon in space, as corners; they turn the way the outer ring turns.
///
/// The polygon is looked at along the axis nearest to its normal, so that coordinates (and with them exact
/// collinearity) are kept as they are.
///
/// # Errors
/// See [`TriangulateError`]; a polygon that is so bent that its outline crosses itself in that view is refused.
pub fn triangulate_in_space(rings: &[&[DVec3]]) -> Result<Vec<[u32; 3]>, TriangulateError> {
    let normal = rings.first().map_or(DVec3::ZERO, |ring| newell(ring.iter().copied()));
    if let Some(corner) = rings.iter().flat_map(|ring| ring.iter()).position(|point| !point.is_finite()) {
        return Err(TriangulateError::NotFinite { corner: index(corner) });
    }
    if normal == DVec3::ZERO && rings.first().is_some_and(|ring| ring.len() >= 3) {
        return Err(TriangulateError::NoArea { ring: 0 });
    }
    if let [&[a, b, c, d]] = *rings
        && let Some(split) = split_quad([a, b, c, d])
    {
        return Ok(split.to_vec());
    }
    let flat: Vec<Vec<DVec2>> =
        rings.iter().map(|ring| ring.iter().map(|&point| drop_axis(point, normal)).collect()).collect();
    if hides_a_corner(rings, &flat) {
        return Err(TriangulateError::Unsolved);
    }
    let flat: Vec<&[DVec2]> = flat.iter().map(Vec::as_slice).collect();
    triangulate(&flat)
}

/// A quadrilateral in space cut along its first diagonal, or along the other where only that keeps both halves facing
/// the way of the whole; `None` where neither does. Bent quadrilaterals are as good as flat ones.
#[must_use]
pub fn split_quad([a, b, c, d]: [DVec3; 4]) -> Option<[[u32; 3]; 2]> {
    let normal = (c - a).cross(d - b);
    let faces = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    if faces(a, b, c) && faces(a, c, d) {
        Some([[0, 1, 2], [0, 2, 3]])
    } else if faces(a, b, d) && faces(b, c, d) {
        Some([[0, 1, 3], [1, 2, 3]])
    } else {
        None
    }
}

/// Whether corners apart in space fall on one place in the view: the polygon is too bent to be seen flat.
fn hides_a_corner(rings: &[&[DVec3]], flat: &[Vec<DVec2>]) -> bool {
    let pairs = rings.iter().zip(flat).flat_map(|(ring, flat)| ring.iter().zip(flat));
    // Adding zero turns -0 into 0, which the order would put apart.
    let mut pairs: Vec<(DVec3, DVec2)> = pairs.map(|(&point, &flat)| (point, flat + DVec2::ZERO)).collect();
    pairs.sort_by(|a, b| a.1.x.total_cmp(&b.1.x).then(a.1.y.total_cmp(&b.1.y)));
    pairs.windows(2).any(|pair| pair[0].1 == pair[1].1 && pair[0].0 != pair[1].0)
}

/// The two coordinates across the largest component of `normal`, in the order that makes a ring that turns
/// counter-clockwise around `normal` turn so in the plane.
#[must_use]
pub fn drop_axis(point: DVec3, normal: DVec3) -> DVec2 {
    let size = normal.abs();
    let (flat, along) = if size.x >= size.y && size.x >= size.z {
        (DVec2::new(point.y, point.z), normal.x)
    } else if size.y >= size.z {
        (DVec2::new(point.z, point.x), normal.y)
    } else {
        (DVec2::new(point.x, point.y), normal.z)
    };
    if along < 0.0 { DVec2::new(flat.y, flat.x) } else { flat }
}

/// Twice the area of triangle abc, positive when counter-clockwise; the sign is exact.
pub(super) fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |point: DVec2| Coord { x: point.x, y: point.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Twice the signed area of a ring.
fn ring_area(ring: &[DVec2]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    ring.windows(2).map(|pair| (pair[0] - origin).perp_dot(pair[1] - origin)).sum()
}

/// A polygon made ready: repeated neighbours left out, outer ring counter-clockwise, holes clockwise.
struct Polygon {
    /// Positions, scaled by a power of two where products could overflow.
    corners: Vec<DVec2>,
    /// Where each hole begins in `corners`.
    hole_starts: Vec<u32>,
    /// For each of `corners` its number in the caller's rings.
    names: Vec<u32>,
    /// Whether the caller's outer ring runs clockwise.
    flipped: bool,
    /// Twice the area of the polygon.
    area: f64,
}

impl Polygon {
    fn new(rings: &[&[DVec2]]) -> Result<Self, TriangulateError> {
        let count: usize = rings.iter().map(|ring| ring.len()).sum();
        if count > CORNER_LIMIT {
            return Err(TriangulateError::TooManyCorners { corners: count });
        }
        if rings.is_empty() {
            return Err(TriangulateError::TooFewCorners { ring: 0, corners: 0 });
        }
        let all = || rings.iter().flat_map(|ring| ring.iter());
        if let Some(corner) = all().position(|point| !point.is_finite()) {
            return Err(TriangulateError::NotFinite { corner: index(corner) });
        }
        let scale = safe_scale(all().fold(0.0, |reach, point| f64::max(reach, point.abs().max_element())));
        let mut polygon =
            Self { corners: vec![], hole_starts: vec![], names: vec![], flipped: false, area: 0.0 };
        let mut name = 0;
        for (number, ring) in rings.iter().enumerate() {
            polygon.push_ring(index(number), ring, (name, scale))?;
            name += index(ring.len());
        }
        Ok(polygon)
    }

    fn push_ring(
        &mut self,
        ring: u32,
        points: &[DVec2],
        (name, scale): (u32, f64),
    ) -> Result<(), TriangulateError> {
        if points.len() < 3 {
            return Err(TriangulateError::TooFewCorners { ring, corners: index(points.len()) });
        }
        let mut kept: Vec<(u32, DVec2)> = Vec::with_capacity(points.len());
        for (corner, &point) in points.iter().enumerate() {
            let next = points[(corner + 1) % points.len()];
            if point != next {
                kept.push((name + index(corner), point * scale));
            }
        }
        let area = ring_area(&kept.iter().map(|&(_, point)| point).collect::<Vec<_>>());
        if kept.len() < 3 || area == 0.0 {
            return Err(TriangulateError::NoArea { ring });
        }
        if ring == 0 {
            self.flipped = area < 0.0;
        } else {
            self.hole_starts.push(index(self.corners.len()));
        }
        if (area < 0.0) == (ring == 0) {
            kept.reverse();
        }
        self.area += if ring == 0 { area.abs() } else { -area.abs() };
        self.names.extend(kept.iter().map(|&(name, _)| name));
        self.corners.extend(kept.iter().map(|&(_, point)| point));
        Ok(())
    }

    /// The directed edges of all rings; the polygon lies to their left.
    fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let starts = std::iter::once(0).chain(self.hole_starts.iter().copied());
        let ends = self.hole_starts.iter().copied().chain(std::iter::once(index(self.corners.len())));
        starts.zip(ends).flat_map(|(start, end)| {
            (start..end).map(move |corner| [corner, if corner + 1 == end { start } else { corner + 1 }])
        })
    }

    fn turn(&self, [a, b, c]: [u32; 3]) -> f64 {
        turn(self.corners[a as usize], self.corners[b as usize], self.corners[c as usize])
    }

    /// A quadrilateral cut along its first diagonal, or along the other where the first lies outside: the
    /// choice that Blender and most readers make.
    fn quad_split(&self) -> Option<[[u32; 3]; 2]> {
        if self.corners.len() != 4 || !self.hole_starts.is_empty() {
            return None;
        }
        // Counted by the caller's corners, so that the choice does not depend on the way the ring runs.
        let first = self.names.iter().position(|&name| name == 0)?;
        let at = |step: usize| index((first + step) % 4);
        let splits =
            [[[at(0), at(1), at(2)], [at(0), at(2), at(3)]], [[at(0), at(1), at(3)], [at(1), at(2), at(3)]]];
        splits.into_iter().find(|split| split.iter().all(|&triangle| self.turn(triangle) > 0.0))
    }

    /// The general case: cut ears, make the result conform to the boundary, check it.
    fn cut(&self) -> Option<Vec<[u32; 3]>> {
        let data: Vec<[f64; 2]> = self.corners.iter().map(|point| point.to_array()).collect();
        let mut flat: Vec<u32> = Vec::new();
        Earcut::new().earcut_slice(&data, &self.hole_starts, &mut flat);
        let mut triangles: Vec<[u32; 3]> = flat.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        if triangles.iter().map(|&triangle| self.turn(triangle)).sum::<f64>() < 0.0 {
            triangles.iter_mut().for_each(|triangle| triangle.reverse());
        }
        let conforming = conform::conform(self, triangles)?;
        Some(self.refine(&data, conforming))
    }

    /// Turns diagonals towards Delaunay where that keeps the triangulation right: fewer slivers.
    fn refine(&self, data: &[[f64; 2]], triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
        if conform::has_touching_corners(self) {
            return triangles;
        }
        let mut flat: Vec<u32> = triangles.iter().flatten().copied().collect();
        Refiner::new().refine(&mut flat, data);
        let refined = flat.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        conform::conform(self, refined).unwrap_or(triangles)
    }

    /// A triangle in the caller's corners and the caller's sense.
    fn oriented(&self, triangle: [u32; 3]) -> [u32; 3] {
        let [a, b, c] = triangle.map(|corner| self.names[corner as usize]);
        if self.flipped { [a, c, b] } else { [a, b, c] }
    }
}

/// What to say when no triangulation was found.
fn explain(rings: &[&[DVec2]]) -> TriangulateError {
    crossing(rings).map_or(TriangulateError::Unsolved, |edges| TriangulateError::Crossing { edges })
}

/// A power of two that brings coordinates of size `reach` to where their products neither overflow nor vanish;
/// 1 for ordinary sizes, so that ordinary coordinates are used as they are.
fn safe_scale(reach: f64) -> f64 {
    if (1e-70..=1e70).contains(&reach) || reach == 0.0 {
        return 1.0;
    }
    let exponent = (reach.to_bits() >> 52) & 0x7ff;
    f64::from_bits((2046 - exponent.clamp(1, 2045)) << 52)
}

#[cfg(test)]
mod tests;
