//! What can be seen from the points of a surface.
//!
//! Promise: a line of sight that runs through an edge or a corner is blocked as by a face. Triangles that meet where the line
//! starts do not block it. Cost: a tree of boxes, O(n log n), and those boxes of it that a line meets.

use glam::DVec3;

use super::tree::Tree;

/// A surface that blocks lines of sight.
pub struct Sight<'a> {
    points: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    tree: Tree,
}

/// The share of a line at both of its ends where nothing blocks it: what it ends at may lie on the surface.
const ENDS: f64 = 1e-6;

impl<'a> Sight<'a> {
    /// For points and triangles of them.
    #[must_use]
    pub fn new(points: &'a [DVec3], triangles: &'a [[u32; 3]]) -> Self {
        Self { points, triangles, tree: Tree::new(points, triangles) }
    }

    /// Whether a place can be seen from a point of the surface.
    #[must_use]
    pub fn sees(&self, from: u32, to: DVec3) -> bool {
        let start = self.points[from as usize];
        let mut seen = true;
        self.tree.visit_along(start, to, |triangle| {
            let corners = self.triangles[triangle as usize];
            let blocks = !corners.contains(&from)
                && crosses(corners.map(|corner| self.points[corner as usize]), start, to - start, ENDS);
            seen = seen && !blocks;
            seen
        });
        seen
    }
}

impl Sight<'_> {
    /// Whether nothing lies between two places that are not on the surface.
    #[must_use]
    pub fn is_free(&self, from: DVec3, to: DVec3) -> bool {
        let mut free = true;
        self.tree.visit_along(from, to, |triangle| {
            let corners = self.triangles[triangle as usize].map(|corner| self.points[corner as usize]);
            free = !crosses(corners, from, to - from, 0.0);
            free
        });
        free
    }
}

/// Whether a line meets a triangle away from its ends, by so much of its length.
///
/// Source: T. Möller, B. Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
fn crosses([a, b, c]: [DVec3; 3], start: DVec3, along: DVec3, ends: f64) -> bool {
    /// Shares of sides that rounding may add.
    const ROUNDING: f64 = 1e-12;
    let (ab, ac) = (b - a, c - a);
    let across = along.cross(ac);
    let determinant = ab.dot(across);
    if determinant == 0.0 {
        return false;
    }
    let from = start - a;
    let u = from.dot(across) / determinant;
    let over = from.cross(ab);
    let v = along.dot(over) / determinant;
    let t = ac.dot(over) / determinant;
    u >= -ROUNDING && v >= -ROUNDING && u + v <= 1.0 + ROUNDING && t > ends && t < 1.0 - ends
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::Sight;
    use crate::geometry::mesh::platonic::{Platonic, PlatonicSize, Pose, platonic};

    #[test]
    fn bodies_hide_what_is_beyond_them() {
        let solid = platonic(Platonic::Octahedron, PlatonicSize::Circumradius(1.0), Pose::Axes);
        let triangles: Vec<[u32; 3]> =
            solid.corners.chunks(3).map(|corners| [corners[0].0, corners[1].0, corners[2].0]).collect();
        let sight = Sight::new(&solid.points, &triangles);
        for (from, point) in (0..).zip(&solid.points) {
            assert!(sight.sees(from, DVec3::ZERO) && sight.sees(from, 5.0 * *point));
            // Through the corner on the other side, and beside it.
            assert!(!sight.sees(from, -5.0 * *point));
            assert!(!sight.sees(from, -5.0 * *point + DVec3::new(0.3, 0.2, 0.1)));
            // Up to that corner, which it may end at.
            assert!(sight.sees(from, -*point));
            // Along an edge of its own to the corner there, not beyond it.
            let other = solid.points.iter().find(|other| other.dot(*point) == 0.0).expect("a neighbor");
            assert!(sight.sees(from, *other) && !sight.sees(from, 2.0 * *other - *point));
        }
    }
}
