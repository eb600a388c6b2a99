//! Elements of a skeleton: points, segments, polygons and curves, with the distances to them.
//!
//! Promise: nearest points are exact to rounding. Bounds over a ball hold for every point in it: distances change no
//! faster than places, and the way to the nearest point of a convex set no faster either; of what is not convex every
//! piece that may be nearest is looked at.

use glam::DVec3;

use crate::geometry::mesh::nearest::nearest_of_triangle;
use crate::geometry::number::Bounds;

use super::line::Line;
use super::skeleton::Potential;

/// A part of a skeleton and the potential around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// What it is.
    pub form: Form,
    /// How the potential falls off with the distance.
    pub potential: Potential,
    /// Factor of the potential; negative takes away.
    pub strength: f64,
}

/// The form of an element.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A point.
    Point(DVec3),
    /// A segment.
    Segment(DVec3, DVec3),
    /// Flat polygons, as triangles.
    Triangles(Vec<[DVec3; 3]>),
    /// A curve, in one part or more.
    Curves(Vec<Line>),
}

/// Where on a segment the nearest point lies, from 0 to 1.
pub(super) fn share_of(a: DVec3, b: DVec3, point: DVec3) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    if square > 0.0 { ((point - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// What is known of the ways from an element to the points of a ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// A box that holds them.
    pub(super) within: Bounds,
    /// Whether they are known not to jump.
    pub(super) smooth: bool,
}

impl Default for Ways {
    fn default() -> Self {
        Self { within: Bounds::EMPTY, smooth: true }
    }
}

impl Ways {
    /// Adds those from another part of the element.
    pub(super) fn add(&mut self, other: Self) {
        self.smooth &= other.smooth && self.within.is_empty();
        self.within = self.within.union(other.within);
    }
}

impl Form {
    /// The way from the nearest point of the element to a point.
    pub(super) fn away(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Point(center) => point - *center,
            Self::Segment(a, b) => point - a.lerp(*b, share_of(*a, *b, point)),
            Self::Triangles(all) => {
                let ways = all.iter().map(|corners| point - nearest_of_triangle(*corners, point));
                ways.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                    .unwrap_or(DVec3::INFINITY)
            }
            Self::Curves(lines) => {
                let ways = lines.iter().map(|line| point - line.nearest(point));
                ways.min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                    .unwrap_or(DVec3::INFINITY)
            }
        }
    }

    /// The ways of all points within `radius` of `center`.
    pub(super) fn ways(&self, center: DVec3, radius: f64) -> Ways {
        let around =
            |way: DVec3| Ways { within: Bounds { min: way - radius, max: way + radius }, smooth: true };
        let own = self.away(center);
        let reach = own.length() + 2.0 * radius;
        let mut all = Ways::default();
        match self {
            Self::Point(_) | Self::Segment(..) => all = around(own),
            Self::Triangles(corners) => {
                let ways = corners.iter().map(|corners| center - nearest_of_triangle(*corners, center));
                ways.filter(|way| way.length() <= reach).for_each(|way| all.add(around(way)));
            }
            Self::Curves(lines) => {
                for line in lines {
                    line.add_ways((center, radius), reach, &mut all);
                }
            }
        }
        all
    }

    /// Whether the way to its nearest place never jumps.
    pub(super) fn is_convex(&self) -> bool {
        match self {
            Self::Point(_) | Self::Segment(..) => true,
            Self::Triangles(all) => all.len() == 1,
            Self::Curves(lines) => lines.len() == 1 && lines[0].is_straight(),
        }
    }

    /// A box around the element.
    pub(super) fn bounds(&self) -> Bounds {
        match self {
            Self::Point(center) => Bounds { min: *center, max: *center },
            Self::Segment(a, b) => Bounds::of_points([*a, *b]),
            Self::Triangles(all) => Bounds::of_points(all.iter().flatten().copied()),
            Self::Curves(lines) => lines.iter().map(Line::bounds).fold(Bounds::EMPTY, Bounds::union),
        }
    }
}
