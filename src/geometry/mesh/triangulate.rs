//! One polygon, with holes, into triangles.
//!
//! Promise: on success every edge of the polygon is the edge of exactly one triangle and all other edges have two, no
//! point is added or left out, no triangle is turned over, and their number is corners + 2 holes - 2. So neighbours
//! meet without T-junctions, and what was closed stays closed. Triangles without area stand where the polygon asks for
//! them: at corners that touch or repeat, and where a corner lies on an edge. Large polygons are cut to be Delaunay as
//! far as their edges allow, small ones to have large angles.
//!
//! [`triangulate`] is exact and refuses polygons whose edges cross; [`triangulate_anyway`] takes every polygon and does
//! the least harm: edges, number and total area are right, but triangles may fold where the polygon does.
//!
//! Notation: a *ring* is a closed loop of points; ring 0 is the outer one, the others are holes and may run
//! either way. A *corner* is a place in the rings, counted through all of them.

mod alone;
mod bend;
mod constrained;
mod corners;
mod ears;
mod round;
mod tolerant;

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::geometry::mesh::index;
use crate::geometry::mesh::polygon::newell;
use crate::geometry::planar::{crossing, turn, twice_area};

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
    /// No two edges cross, yet the rings bound no polygon: a hole outside the outer ring or inside another hole, or a
    /// ring that crosses itself in a corner or touches itself from outside.
    #[error("a hole lies outside the polygon, or an outline crosses or touches itself in a corner")]
    Unsolved,
}

/// Triangles of a polygon in the plane, as corners; they turn the way the outer ring turns.
///
/// Deterministic. O(n log n) on ordinary polygons.
///
/// # Errors
/// See [`TriangulateError`].
pub fn triangulate(rings: &[&[DVec2]]) -> Result<Vec<[u32; 3]>, TriangulateError> {
    let polygon = Polygon::new(rings)?;
    if let Some(ring) = polygon.flat_ring {
        return Err(TriangulateError::NoArea { ring });
    }
    polygon.cut().ok_or_else(|| explain(rings))
}

/// Triangles of any polygon in the plane, exact where [`triangulate`] is, else with the least harm; the second says
/// whether it was exact. Edges, number of triangles and total signed area are right in any case.
///
/// Deterministic. O(n log n) on ordinary polygons; where edges cross O(n^2) at worst.
///
/// # Errors
/// As [`triangulate`], but never `NoArea`, `Crossing` or `Unsolved`.
pub fn triangulate_anyway(rings: &[&[DVec2]]) -> Result<(Vec<[u32; 3]>, bool), TriangulateError> {
    let polygon = Polygon::new(rings)?;
    let exact = if polygon.flat_ring.is_none() { polygon.cut() } else { None };
    let found = exact.is_some();
    Ok((exact.unwrap_or_else(|| polygon.oriented(polygon.least_harm())), found))
}

/// Triangles of a nearly planar polygon in space, as corners; they turn the way the outer ring turns. The second says
/// whether no edges cross, seen along the axis nearest to the normal of the polygon: so coordinates (and with them
/// exact collinearity) are kept as they are. See [`triangulate_anyway`].
///
/// # Errors
/// As [`triangulate_anyway`].
pub fn triangulate_in_space(rings: &[&[DVec3]]) -> Result<(Vec<[u32; 3]>, bool), TriangulateError> {
    if let Some(corner) = rings.iter().flat_map(|ring| ring.iter()).position(|point| !point.is_finite()) {
        return Err(TriangulateError::NotFinite { corner: index(corner) });
    }
    if let [&[a, b, c, d]] = *rings
        && let Some(split) = split_quad([a, b, c, d])
    {
        return Ok((split.to_vec(), true));
    }
    let normal = view(rings);
    let flat: Vec<Vec<DVec2>> =
        rings.iter().map(|ring| ring.iter().map(|&point| drop_axis(point, normal)).collect()).collect();
    let flat: Vec<&[DVec2]> = flat.iter().map(Vec::as_slice).collect();
    triangulate_anyway(&flat)
}

/// The direction from which a polygon is looked at: its normal, or where its parts cancel that of its largest
/// triangle on the first corner.
#[must_use]
pub fn view(rings: &[&[DVec3]]) -> DVec3 {
    let Some(&outer) = rings.first() else { return DVec3::ZERO };
    let normal = newell(outer.iter().copied());
    if normal != DVec3::ZERO {
        return normal;
    }
    let fan = outer.windows(2).map(|pair| (pair[0] - outer[0]).cross(pair[1] - outer[0]));
    fan.fold(
        DVec3::ZERO,
        |best, next| if next.length_squared() > best.length_squared() { next } else { best },
    )
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

/// A polygon made ready: outer ring counter-clockwise, holes clockwise.
struct Polygon {
    /// Positions, scaled by a power of two where products could overflow.
    corners: Vec<DVec2>,
    /// One past the last corner of each ring.
    ring_ends: Vec<u32>,
    /// For each of `corners` its number in the caller's rings.
    names: Vec<u32>,
    /// Whether the caller's outer ring runs clockwise.
    flipped: bool,
    /// The first ring that encloses no area.
    flat_ring: Option<u32>,
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
        let mut polygon = Self {
            corners: Vec::with_capacity(count),
            ring_ends: Vec::with_capacity(rings.len()),
            names: Vec::with_capacity(count),
            flipped: false,
            flat_ring: None,
        };
        for ring in rings {
            polygon.push_ring(ring, scale)?;
        }
        Ok(polygon)
    }

    fn push_ring(&mut self, points: &[DVec2], scale: f64) -> Result<(), TriangulateError> {
        let ring = index(self.ring_ends.len());
        if points.len() < 3 {
            return Err(TriangulateError::TooFewCorners { ring, corners: index(points.len()) });
        }
        let start = self.corners.len();
        self.corners.extend(points.iter().map(|point| *point * scale));
        self.names.extend((start..self.corners.len()).map(index));
        self.ring_ends.push(index(self.corners.len()));
        let area = twice_area(&self.corners[start..]);
        if area == 0.0 && self.flat_ring.is_none() {
            self.flat_ring = Some(ring);
        }
        self.flipped |= ring == 0 && area < 0.0;
        if (area < 0.0) == (ring == 0) {
            self.corners[start..].reverse();
            self.names[start..].reverse();
        }
        Ok(())
    }

    /// The corners of each ring.
    fn rings(&self) -> impl Iterator<Item = std::ops::Range<u32>> + '_ {
        let starts = std::iter::once(0).chain(self.ring_ends.iter().copied());
        starts.zip(self.ring_ends.iter().copied()).map(|(start, end)| start..end)
    }

    /// The directed edges of all rings; the polygon lies to their left.
    fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.rings().flat_map(|ring| {
            let start = ring.start;
            let end = ring.end;
            ring.map(move |corner| [corner, if corner + 1 == end { start } else { corner + 1 }])
        })
    }

    fn turn(&self, [a, b, c]: [u32; 3]) -> f64 {
        turn(self.corners[a as usize], self.corners[b as usize], self.corners[c as usize])
    }

    /// A quadrilateral cut along its first diagonal, or along the other where the first lies outside: the
    /// choice that Blender and most readers make.
    fn quad_split(&self) -> Option<[[u32; 3]; 2]> {
        if self.corners.len() != 4 {
            return None;
        }
        // Counted by the caller's corners, so that the choice does not depend on the way the ring runs.
        let first = self.names.iter().position(|&name| name == 0)?;
        let at = |step: usize| index((first + step) % 4);
        let splits =
            [[[at(0), at(1), at(2)], [at(0), at(2), at(3)]], [[at(0), at(1), at(3)], [at(1), at(2), at(3)]]];
        splits.into_iter().find(|split| split.iter().all(|&triangle| self.turn(triangle) > 0.0))
    }

    /// The exact way, in the caller's corners; `None` where edges cross or rings are no polygon.
    fn cut(&self) -> Option<Vec<[u32; 3]>> {
        if self.corners.len() == 3 {
            return Some(vec![[0, 1, 2]]);
        }
        if let Some(split) = self.quad_split() {
            let mut split = self.oriented(split.to_vec());
            split.sort_unstable();
            return Some(split);
        }
        ears::cut(self)
            .or_else(|| round::cut(self))
            .or_else(|| constrained::triangulate(self))
            .map(|triangles| self.oriented(triangles))
    }

    /// Of two ways to cut a polygon whose edges cross, the one that turns triangles over by less.
    fn least_harm(&self) -> Vec<[u32; 3]> {
        let bent = if self.flat_ring.is_none() { constrained::triangulate_bent(self) } else { None };
        let harm = |triangles: &[[u32; 3]]| {
            triangles.iter().map(|triangle| self.turned_over(*triangle)).fold(0.0, f64::max)
        };
        let Some(bent) = bent else { return tolerant::cut(self) };
        let least = harm(&bent);
        if least == 0.0 {
            return bent;
        }
        let cut = tolerant::cut(self);
        if harm(&cut) < least { cut } else { bent }
    }

    /// How wide a triangle is that is turned over; 0 for others.
    fn turned_over(&self, triangle: [u32; 3]) -> f64 {
        let area = self.turn(triangle);
        if area >= 0.0 {
            return 0.0;
        }
        let [a, b, c] = triangle.map(|corner| self.corners[corner as usize]);
        -area / a.distance(b).max(b.distance(c)).max(c.distance(a))
    }

    /// Triangles in the caller's corners and the caller's sense, the least corner of each first.
    fn oriented(&self, triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
        let turned = |triangle: [u32; 3]| {
            let [a, b, c] = triangle.map(|corner| self.names[corner as usize]);
            let turned = if self.flipped { [a, c, b] } else { [a, b, c] };
            let least = (0..3).min_by_key(|&k| turned[k]).unwrap_or(0);
            [turned[least], turned[(least + 1) % 3], turned[(least + 2) % 3]]
        };
        triangles.into_iter().map(turned).collect()
    }
}

/// What to say when no triangulation was found.
fn explain(rings: &[&[DVec2]]) -> TriangulateError {
    crossing(rings).map_or(TriangulateError::Unsolved, |edges| TriangulateError::Crossing { edges })
}

/// A power of two that brings coordinates of size `reach` to where their products neither overflow nor vanish;
/// 1 for ordinary sizes, so that ordinary coordinates are used as they are.
fn safe_scale(reach: f64) -> f64 {
    if (1e-30..=1e50).contains(&reach) || reach == 0.0 {
        return 1.0;
    }
    let exponent = (reach.to_bits() >> 52) & 0x7ff;
    f64::from_bits((2046 - exponent.clamp(1, 2045)) << 52)
}

#[cfg(test)]
mod tests;
