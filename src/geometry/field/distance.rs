//! The distance to the triangles of a closed shape, negative inside.
//!
//! Promise: the value is the distance to the nearest point of the triangles but for rounding, and its sign is right for every
//! closed, oriented surface that does not cross itself. Ranges hold every value, by what is near a box: nothing changes by
//! more than one moves, and near its nearest point the slope is a normal of the triangle, side or corner there. Edges of the
//! triangles are edges of the level 0; outside they are rounded, inside they stay sharp. Not promised: that triangles of a
//! smooth shape look smooth; [`Distance::slope`] has the normals that they were given.
//!
//! Source: J. Bærentzen, H. Aanæs, Signed distance computation using the angle weighted pseudonormal, 2005.
//!
//! Cost: a tree of boxes, O(n log n); some ten boxes for each value, and for a range what is near.

use core::fmt;

use glam::DVec3;

use super::Study;
use super::any::Leaf;
use super::normal_cone::{self, Cone};
use crate::geometry::formula::{Interval, Quality};
use crate::geometry::mesh::index;
use crate::geometry::mesh::nearest::{Part, nearest_of_triangle, nearest_part, weights};
use crate::geometry::mesh::tree::Tree;
use crate::geometry::number::{Bounds, cos_degrees};

/// Triangles that meet at less than this many degrees from flat make no edge of a surface.
const SHARP: f64 = 12.0;

/// More triangles than this near a box tell nothing of slopes.
const MOST_NEAR: usize = 256;

/// Normals of a corner that differ by no more than this are one.
const SAME_NORMAL: f64 = 1e-9;

/// What triangles meet in.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    /// The sum of their normals by their angles: what lies on its side is outside.
    normal: DVec3,
    /// All slopes where it is the nearest.
    cone: Cone,
    /// Whether the triangles have one normal there, as those of smooth surfaces do.
    soft: bool,
}

/// The triangles of a closed shape.
pub struct Distance {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// The normal of each triangle's plane.
    planes: Vec<DVec3>,
    /// The normals that each triangle was given at its corners.
    normals: Vec<[DVec3; 3]>,
    corners: Vec<Meeting>,
    /// For each side of each triangle its edge.
    sides: Vec<[u32; 3]>,
    edges: Vec<Meeting>,
    sharp: bool,
    tree: Tree,
}

/// A nearest place.
struct Near {
    triangle: usize,
    place: DVec3,
    part: Part,
}

impl Distance {
    /// The distance to triangles that are closed, look outward and do not cross; for each the normals of its corners.
    #[must_use]
    pub fn new(points: Vec<DVec3>, triangles: Vec<[u32; 3]>, normals: Vec<[DVec3; 3]>) -> Self {
        let planes: Vec<DVec3> = triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| points[corner as usize]);
                (b - a).cross(c - a).normalize_or_zero()
            })
            .collect();
        let tree = Tree::new(&points, &triangles);
        let mut made = Self {
            points,
            triangles,
            planes,
            normals,
            corners: Vec::new(),
            sides: Vec::new(),
            edges: Vec::new(),
            sharp: false,
            tree,
        };
        made.meet_at_edges();
        made.meet_at_corners();
        made
    }

    /// A box around the triangles.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.tree.bounds()
    }

    /// How many triangles there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Whether its surface has edges.
    pub(super) fn has_edges(&self) -> bool {
        self.sharp
    }

    fn places(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| self.points[corner as usize])
    }

    fn meet_at_edges(&mut self) {
        let mut all: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (triangle, corners) in (0..).zip(&self.triangles) {
            for side in 0..3 {
                let (a, b) = (corners[side], corners[(side + 1) % 3]);
                all.push((a.min(b), a.max(b), 3 * triangle + index(side)));
            }
        }
        all.sort_unstable();
        self.sides = vec![[0; 3]; self.triangles.len()];
        let crease = cos_degrees(SHARP);
        for edge in all.chunk_by(|one, other| (one.0, one.1) == (other.0, other.1)) {
            let of = |use_of: &(u32, u32, u32)| (use_of.2 / 3) as usize;
            let planes: Vec<DVec3> = edge.iter().map(|one| self.planes[of(one)]).collect();
            let ends = [edge[0].0, edge[0].1];
            let number = index(self.edges.len());
            self.edges.push(Meeting {
                normal: planes.iter().sum(),
                cone: normal_cone::of_edge(&planes),
                soft: ends.iter().all(|end| self.is_soft(*end, edge.iter().map(of))),
            });
            self.sharp |= planes.len() == 2 && planes[0].dot(planes[1]) < crease;
            for one in edge {
                self.sides[of(one)][(one.2 % 3) as usize] = number;
            }
        }
    }

    /// Whether some triangles have one normal at a point.
    fn is_soft(&self, point: u32, triangles: impl Iterator<Item = usize>) -> bool {
        let mut normals = triangles.filter_map(|triangle| {
            let corner = self.triangles[triangle].iter().position(|corner| *corner == point)?;
            Some(self.normals[triangle][corner])
        });
        let Some(first) = normals.next() else { return false };
        normals.all(|normal| normal.distance(first) <= SAME_NORMAL)
    }

    fn meet_at_corners(&mut self) {
        let mut around = vec![Vec::new(); self.points.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            corners.iter().for_each(|corner| around[*corner as usize].push(triangle));
        }
        let meeting = |(point, triangles): (usize, &Vec<usize>)| {
            let middle = self.points[point];
            let mut normal = DVec3::ZERO;
            let mut rays = Vec::with_capacity(2 * triangles.len());
            for triangle in triangles {
                let corners = self.triangles[*triangle];
                let at = corners.iter().position(|corner| *corner as usize == point).unwrap_or(0);
                let to = [1, 2].map(|step| {
                    (self.points[corners[(at + step) % 3] as usize] - middle).normalize_or_zero()
                });
                let plane = self.planes[*triangle];
                normal += plane * normal_cone::angle(to[0], to[1]);
                rays.push(to[0]);
            }
            let planes: Vec<DVec3> = triangles.iter().map(|triangle| self.planes[*triangle]).collect();
            Meeting {
                normal,
                cone: normal_cone::of_corner(&planes, &rays, normal),
                soft: self.is_soft(index(point), triangles.iter().copied()),
            }
        };
        self.corners = around.iter().enumerate().map(meeting).collect();
    }

    fn nearest(&self, point: DVec3) -> Near {
        let away = |triangle: u32| nearest_of_triangle(self.places(triangle as usize), point).distance(point);
        let triangle = self.tree.least(point, away).map_or(0, |(triangle, _)| triangle as usize);
        let (place, part) = nearest_part(self.places(triangle), point);
        Near { triangle, place, part }
    }

    fn meeting(&self, near: &Near) -> Option<&Meeting> {
        match near.part {
            Part::Corner(corner) => Some(&self.corners[self.triangles[near.triangle][corner] as usize]),
            Part::Side(side) => Some(&self.edges[self.sides[near.triangle][side] as usize]),
            Part::Inside => None,
        }
    }

    fn value_slope(&self, point: DVec3) -> (f64, DVec3, Near) {
        let near = self.nearest(point);
        let (value, slope) = match self.meeting(&near) {
            None => {
                let plane = self.planes[near.triangle];
                ((point - near.place).dot(plane), plane)
            }
            Some(meeting) => {
                let away = point - near.place;
                let (distance, sign) =
                    (away.length(), if away.dot(meeting.normal) < 0.0 { -1.0 } else { 1.0 });
                let slope = if distance > 1e-12 * self.bounds().reach() {
                    away * (sign / distance)
                } else {
                    meeting.normal.normalize_or(self.planes[near.triangle])
                };
                (sign * distance, slope)
            }
        };
        (value, slope, near)
    }

    /// The value and a slope that is the normal of a smooth shape where the triangles stand for one.
    #[must_use]
    pub fn slope(&self, point: DVec3) -> (f64, DVec3) {
        let (value, slope, near) = self.value_slope(point);
        if self.meeting(&near).is_some_and(|meeting| !meeting.soft) {
            return (value, slope);
        }
        let shares = weights(self.places(near.triangle), near.place);
        let normals = self.normals[near.triangle];
        let sum: DVec3 = (0..3).map(|corner| normals[corner] * shares[corner]).sum();
        (value, sum.normalize_or(slope))
    }

    /// All slopes at places no further than `room` from a place, whose nearest points are no further from it than `reach`; none
    /// where too much is near.
    fn slopes(&self, center: DVec3, room: f64, reach: f64) -> Option<Cone> {
        let mut all: Option<Cone> = None;
        let mut add = |cone: Option<Cone>| {
            if let Some(cone) = cone {
                all = Some(all.map_or(cone, |all| all.union(cone)));
            }
        };
        let mut count = 0;
        let over = room + 1e-13 * (self.bounds().reach() + reach);
        self.tree.visit_near(center, reach, |triangle| {
            let triangle = triangle as usize;
            let places = self.places(triangle);
            if nearest_of_triangle(places, center).distance(center) <= reach {
                count += 1;
                // A place is over the triangle if its foot on the plane is in it.
                let plane = self.planes[triangle];
                let foot = center - plane * (center - places[0]).dot(plane);
                if nearest_of_triangle(places, foot).distance(foot) <= over {
                    add(Some(Cone::of_one(plane)));
                }
                for side in 0..3 {
                    let (from, to) = (places[side], places[(side + 1) % 3]);
                    let (far, away) = normal_cone::far(from, to, center);
                    if far <= reach {
                        let edge = &self.edges[self.sides[triangle][side] as usize];
                        add(edge.cone.seen(away, room, edge.normal));
                    }
                    let away = center - from;
                    if away.length() <= reach {
                        let corner = &self.corners[self.triangles[triangle][side] as usize];
                        add(corner.cone.seen(away, room, corner.normal));
                    }
                }
            }
            count <= MOST_NEAR
        });
        if count <= MOST_NEAR { all } else { None }
    }
}

impl Leaf for Distance {
    fn leaf_value(&self, point: DVec3) -> f64 {
        self.value_slope(point).0
    }

    fn leaf_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let (value, slope, _) = self.value_slope(point);
        (value, slope)
    }

    fn leaf_study(&self, within: &Bounds) -> Study {
        let (center, half) = (within.center(), within.diagonal() / 2.0);
        let value = self.leaf_value(center);
        let slack = 1e-13 * (self.bounds().reach() + center.abs().max_element() + half);
        let cone = self.slopes(center, half, value.abs() + 2.0 * half + slack).unwrap_or(Cone::ALL);
        // The middle is as far off as all corners: the slopes tell how much of that counts.
        let sides = (within.max - within.min) / 2.0;
        let most = cone.low.abs().max(cone.high.abs()).dot(sides).min(half);
        let quality = if cone.is_one() { Quality::Smooth } else { Quality::Continuous };
        let reach = most * (1.0 + 1e-12) + slack;
        let value = Interval { low: value - reach, high: value + reach, quality };
        let (low, high) = (cone.low.to_array(), cone.high.to_array());
        Study {
            value,
            gradient: [0, 1, 2].map(|axis| Interval { quality, ..Interval::new(low[axis], high[axis]) }),
        }
    }
}

impl fmt::Debug for Distance {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Distance").field("triangles", &self.triangles.len()).finish_non_exhaustive()
    }
}

impl PartialEq for Distance {
    fn eq(&self, other: &Self) -> bool {
        self.triangles == other.triangles && self.points == other.points && self.normals == other.normals
    }
}
