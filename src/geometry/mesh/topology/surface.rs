//! The quick way for meshes that are surfaces: around each point the triangles make one fan, closed or open.
//!
//! Each corner is a link (point after it, point before it) of the chain around its own point; around a point of an
//! oriented surface where one link ends the next begins. That is all there is to prove: no edge is sorted or hashed,
//! and each is seen from both its ends. Anything else (an edge with three triangles, two neighbours of opposite
//! orientation, parts that touch at a point, a triangle that uses a point twice) is left to the general way.

use super::{Joined, NONE, Topology};
use crate::geometry::mesh::index;

/// The points after and before a point in one of its triangles.
type Link = [u32; 2];

/// Measures an oriented surface, with or without boundary; none when the mesh is not one. There are fewer than 2^31
/// corners. Linear; at its peak 12 bytes a triangle and 8 bytes a point.
pub(super) fn of_surface(
    triangles: usize,
    points: usize,
    point_of: &impl Fn(usize) -> u32,
) -> Option<Topology> {
    let mut corners = Corners::new(triangles, points);
    for triangle in 0..triangles {
        let first = 3 * triangle;
        corners.add([point_of(first), point_of(first + 1), point_of(first + 2)])?;
    }
    let components = corners.parts.sets();
    let mut fan: Vec<Link> = Vec::new();
    let mut boundary: Vec<[u32; 2]> = Vec::new();
    let mut used = 0;
    for point in 0..index(points) {
        fan.clear();
        let mut corner = corners.places[point as usize].corner;
        while corner != NONE {
            let [after, before] = others(corner);
            fan.push([point_of(after as usize), point_of(before as usize)]);
            corner = corners.earlier.as_flattened()[corner as usize];
        }
        if fan.is_empty() {
            continue;
        }
        used += 1;
        if !corners.is_closed(&fan)? {
            boundary.push([point, corners.first_of_open(&fan)?]);
        }
    }
    Some(Topology {
        points: used,
        edges: (3 * triangles + boundary.len()) as u64 / 2,
        triangles: triangles as u64,
        closed: boundary.is_empty(),
        manifold: boundary.is_empty(),
        components,
        boundary_edges: boundary.len() as u64,
        boundary_loops: corners.loops(&boundary),
        ..Topology::default()
    })
}

/// What is known of a point.
#[derive(Clone, Copy)]
struct Place {
    /// The last of its corners.
    corner: u32,
    /// While corners are added, the part of the surface it is in. Later a link of the point at hand that was noted
    /// for it: whether the note is of another point's links is seen by looking at the link itself, so notes need not
    /// be cleared.
    note: u32,
}

/// The corners of each point as a chain, and the sets of triangles that share points: on a surface these are the
/// sets that share edges.
struct Corners {
    places: Vec<Place>,
    /// For each corner the corner of the same point before it.
    earlier: Vec<[u32; 3]>,
    parts: Joined,
}

impl Corners {
    fn new(triangles: usize, points: usize) -> Self {
        Self {
            places: vec![Place { corner: NONE, note: NONE }; points],
            earlier: Vec::with_capacity(triangles),
            parts: Joined::new(0),
        }
    }

    /// Adds a triangle; none when it uses a point twice.
    #[inline]
    fn add(&mut self, points: [u32; 3]) -> Option<()> {
        let [a, b, c] = points;
        if a == b || b == c || c == a {
            return None;
        }
        let first = 3 * index(self.earlier.len());
        let mut parts = [NONE; 3];
        let mut earlier = [NONE; 3];
        for (step, corner) in (first..first + 3).enumerate() {
            let place = &mut self.places[points[step] as usize];
            parts[step] = place.note;
            earlier[step] = std::mem::replace(&mut place.corner, corner);
        }
        self.earlier.push(earlier);
        if parts[0] != parts[1] || parts[1] != parts[2] || parts[2] == NONE {
            self.unite(points, parts);
        }
        Some(())
    }

    /// Puts the points of a triangle, which are in these parts or in none yet, into one part.
    #[inline]
    fn unite(&mut self, points: [u32; 3], parts: [u32; 3]) {
        let least = parts[0].min(parts[1]).min(parts[2]);
        let part = if least == NONE { self.parts.add() } else { least };
        for step in 0..3 {
            if parts[step] == NONE {
                self.places[points[step] as usize].note = part;
            } else if parts[step] != part {
                self.parts.join(parts[step], part);
            }
        }
    }

    /// Notes each link for the point on one of its sides.
    #[inline]
    fn note(&mut self, fan: &[Link], side: usize) {
        for (place, link) in (0..).zip(fan) {
            self.places[link[side] as usize].note = place;
        }
    }

    /// The link with this point on this side.
    #[inline]
    fn find(&self, fan: &[Link], side: usize, point: u32) -> Option<usize> {
        let place = self.places[point as usize].note as usize;
        fan.get(place).filter(|link| link[side] == point).map(|_| place)
    }

    /// Whether the links make one closed chain; none when they make closed chains that touch. Of two links that
    /// begin at one point only one is found, so such links are no closed chain.
    #[inline]
    fn is_closed(&mut self, fan: &[Link]) -> Option<bool> {
        self.note(fan, 0);
        let mut at = 0;
        for step in 1..=fan.len() {
            match self.find(fan, 0, fan[at][1]) {
                Some(0) => return (step == fan.len()).then_some(true),
                Some(after) => at = after,
                None => return Some(false),
            }
        }
        // A chain that never comes back to its first link runs into itself.
        None
    }

    /// The point at which the one open chain of all links begins; none when there is no such chain.
    fn first_of_open(&mut self, fan: &[Link]) -> Option<u32> {
        let after = self.is_distinct(fan, 0).then(|| self.follow(fan, 0))?;
        self.note(fan, 1);
        let before = self.is_distinct(fan, 1).then(|| self.follow(fan, 1))?;
        // Where all are distinct there are chains and rings side by side: this is the chain of the first link.
        (after.1 + before.1 + 1 == fan.len()).then_some(fan[before.0][0])
    }

    /// Whether the links, noted by this side, have different points on it.
    fn is_distinct(&self, fan: &[Link], side: usize) -> bool {
        (0..).zip(fan).all(|(place, link)| self.places[link[side] as usize].note == place)
    }

    /// The last link met from the first on, looking for links by this side, and the number of steps to it.
    fn follow(&self, fan: &[Link], side: usize) -> (usize, usize) {
        let mut at = 0;
        for step in 0..fan.len() {
            match self.find(fan, side, fan[at][1 - side]) {
                Some(onward) => at = onward,
                None => return (at, step),
            }
        }
        (at, fan.len())
    }

    /// Closed chains of boundary edges: each point on the boundary has one edge that leaves it and one that comes.
    fn loops(mut self, boundary: &[[u32; 2]]) -> u64 {
        for &[from, to] in boundary {
            self.places[from as usize].corner = to;
        }
        let mut loops = 0;
        for &[from, _] in boundary {
            let mut at = from;
            let mut fresh = false;
            while at != NONE {
                let onward = std::mem::replace(&mut self.places[at as usize].corner, NONE);
                fresh |= onward != NONE;
                at = onward;
            }
            loops += u64::from(fresh);
        }
        loops
    }
}

/// The corners after and before a corner in its triangle.
#[inline]
fn others(corner: u32) -> [u32; 2] {
    match corner % 3 {
        0 => [corner + 1, corner + 2],
        1 => [corner + 1, corner - 1],
        _ => [corner - 2, corner - 1],
    }
}
