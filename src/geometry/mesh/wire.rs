//! Chains of points: curves as a renderer draws lines.

use glam::{DAffine3, DVec3};

use crate::geometry::mesh::{Anchor, Color, index};
use crate::geometry::number::Bounds;

/// Curves as chains of points. Strands cover all points in order; each has a point of its own for every corner, so
/// that strands never hang together by accident.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wire {
    /// The points of all strands, one strand after the other.
    pub points: Vec<WirePoint>,
    /// The strands.
    pub strands: Vec<Strand>,
}

/// A point of a strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WirePoint {
    /// Where it is, metres.
    pub position: DVec3,
    /// Its color; white where it has none.
    pub color: Color,
    /// Place on the exact curve: its source and, as u, its parameter.
    pub anchor: Anchor,
}

/// One chain of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strand {
    /// One past its last point.
    pub end: u32,
    /// Whether its last point is joined to its first.
    pub closed: bool,
    /// Index into the table of origins that travels beside the wire.
    pub origin: u32,
}

impl Wire {
    /// Whether there is nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.strands.is_empty()
    }

    /// Adds a strand.
    ///
    /// # Panics
    /// When there would be 2^32 points; limits are checked before.
    pub fn push(&mut self, points: impl IntoIterator<Item = WirePoint>, closed: bool, origin: u32) {
        self.points.extend(points);
        self.strands.push(Strand { end: index(self.points.len()), closed, origin });
    }

    /// The strands with the ranges of their points.
    pub fn ranges(&self) -> impl Iterator<Item = (Strand, std::ops::Range<u32>)> + '_ {
        let starts = std::iter::once(0).chain(self.strands.iter().map(|strand| strand.end));
        starts.zip(&self.strands).map(|(start, strand)| (*strand, start..strand.end))
    }

    /// The two points of each segment of the strands of an origin.
    pub fn segments(&self, origin: u32) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.ranges().filter(move |(strand, _)| strand.origin == origin).flat_map(|(strand, range)| {
            let (first, last) = (range.start, range.end - 1);
            let back = (strand.closed && last > first).then_some([last, first]);
            (first..last).map(|point| [point, point + 1]).chain(back)
        })
    }

    /// The smallest box that holds all points.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.points.iter().map(|point| point.position))
    }

    /// Applies an affine map.
    pub fn transform(&mut self, map: &DAffine3) {
        for point in &mut self.points {
            point.position = map.transform_point3(point.position);
        }
    }

    /// Adds the strands of another wire; their origins are moved up by `origin_offset`.
    ///
    /// # Panics
    /// When the sum has 2^32 points; limits are checked before.
    pub fn append(&mut self, other: &Self, origin_offset: u32) {
        for (strand, range) in other.ranges() {
            let points = &other.points[range.start as usize..range.end as usize];
            self.push(points.iter().copied(), strand.closed, strand.origin + origin_offset);
        }
    }

    /// Brings the strands of each origin together, origins renumbered by `names`; strands of one origin keep their order.
    #[must_use]
    pub fn regrouped(&self, names: &[u32]) -> Self {
        let mut order: Vec<_> = self.ranges().collect();
        order.sort_by_key(|(strand, _)| names[strand.origin as usize]);
        let mut grouped = Self::default();
        for (strand, range) in order {
            let points = &self.points[range.start as usize..range.end as usize];
            grouped.push(points.iter().copied(), strand.closed, names[strand.origin as usize]);
        }
        grouped
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::{Wire, WirePoint};
    use crate::geometry::mesh::Anchor;

    fn points(count: u32) -> Vec<WirePoint> {
        (0..count)
            .map(|k| WirePoint {
                position: DVec3::X * f64::from(k),
                color: crate::geometry::mesh::Color::WHITE,
                anchor: Anchor::default(),
            })
            .collect()
    }

    #[test]
    fn segments_follow_their_strand_and_close_it() {
        let mut wire = Wire::default();
        wire.push(points(3), false, 0);
        wire.push(points(3), true, 1);
        wire.push(points(2), false, 0);
        assert_eq!(wire.segments(0).collect::<Vec<_>>(), [[0, 1], [1, 2], [6, 7]]);
        assert_eq!(wire.segments(1).collect::<Vec<_>>(), [[3, 4], [4, 5], [5, 3]]);
        let grouped = wire.regrouped(&[1, 0]);
        assert_eq!(grouped.segments(0).collect::<Vec<_>>(), [[0, 1], [1, 2], [2, 0]]);
        assert_eq!(grouped.segments(1).collect::<Vec<_>>(), [[3, 4], [4, 5], [6, 7]]);
    }

    #[test]
    fn wires_are_moved_and_joined() {
        let mut wire = Wire::default();
        wire.push(points(3), true, 0);
        let mut moved = wire.clone();
        moved.transform(&DAffine3::from_translation(DVec3::Y));
        wire.append(&moved, 5);
        assert_eq!(wire.strands[1].origin, 5);
        assert_eq!((wire.bounds().min, wire.bounds().max), (DVec3::ZERO, DVec3::new(2.0, 1.0, 0.0)));
    }
}
