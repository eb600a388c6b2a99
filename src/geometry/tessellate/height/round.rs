//! Maps that close in themselves: sides that are one line, sides that are one point.
//!
//! Where opposite sides are one line, corners stand at the same places of both, and two lines between them that stay
//! edges keep every edge shorter than half the way around: so no edge begins where it ends, and no two join the same
//! points. Where a side is a point, a ring one node away from it is cut once, and triangles from the ring to the point
//! are a cone, in which the bilinear function of the lattice's first row lies exactly.

use super::delaunay::{Delaunay, FIXED, Place};
use super::drawn::Tangled;

/// How a map closes.
#[derive(Clone, Debug)]
pub(super) struct Round {
    /// Whether the first column and the last are one line, and the first row and the last.
    pub(super) closed: [bool; 2],
    /// Whether the first row and the last are each one point.
    pub(super) poles: [bool; 2],
    /// From a pole to its ring, in units.
    pub(super) ring: i32,
    /// Lines between sides that stay edges.
    pub(super) lines: Vec<Vec<Place>>,
}

impl Round {
    /// A map whose sides are sides.
    pub(super) const OPEN: Self = Self { closed: [false; 2], poles: [false; 2], ring: 0, lines: Vec::new() };

    /// The first and the last row in which corners may be set.
    pub(super) fn rows(&self, far: Place) -> [i32; 2] {
        let skip = |pole: bool| if pole { self.ring + 1 } else { 1 };
        [skip(self.poles[0]), far[1] - skip(self.poles[1])]
    }

    /// Whether a triangle lies between a pole and its ring. Crossings of other lines with the ring are rounded.
    pub(super) fn at_pole(&self, mesh: &Delaunay, triangle: u32) -> bool {
        if self.poles == [false; 2] {
            return false;
        }
        let rows = mesh.corners_of(triangle).map(|corner| mesh.places[corner as usize][1]);
        let last = mesh.places[2][1];
        (self.poles[0] && rows.iter().all(|row| *row <= self.ring + 1))
            || (self.poles[1] && rows.iter().all(|row| *row >= last - self.ring - 1))
    }

    /// The place that stands for all places of one point.
    pub(super) fn place(&self, far: Place, place: Place) -> Place {
        let [mut x, mut y] = place;
        if (self.poles[0] && y == 0) || (self.poles[1] && y == far[1]) {
            return [0, y];
        }
        if self.closed[0] && x == far[0] {
            x = 0;
        }
        if self.closed[1] && y == far[1] {
            y = 0;
        }
        [x, y]
    }

    /// Gives both sides of a seam the corners of each other.
    pub(super) fn share(&self, mesh: &mut Delaunay) {
        let far = mesh.places[2];
        for axis in 0..2 {
            if !self.closed[axis] {
                continue;
            }
            for corner in 0..mesh.places.len() {
                let mut place = mesh.places[corner];
                if place[axis] == 0 || place[axis] == far[axis] {
                    place[axis] = far[axis] - place[axis];
                    mesh.corner_at(place, 0);
                }
            }
        }
    }
}

/// Draws lines that stay edges and bound nothing.
pub(super) fn draw_fixed(mesh: &mut Delaunay, lines: &[Vec<Place>]) -> Result<(), Tangled> {
    if lines.is_empty() {
        return Ok(());
    }
    mesh.allow_lines();
    let mut drawn = Vec::new();
    for line in lines {
        let corners = line.iter().map(|place| mesh.corner_at(*place, 0).ok_or(Tangled));
        drawn.push(corners.collect::<Result<Vec<u32>, Tangled>>()?);
    }
    for pair in drawn.iter().flat_map(|corners| corners.windows(2)) {
        mesh.draw(pair[0], pair[1], FIXED)?;
    }
    Ok(())
}
