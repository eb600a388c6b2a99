//! Chords, and the bound of one that stands for several parts.

use glam::DVec3;

use super::pieces::distance_to_segment;

/// The straight way between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Chord {
    pub(super) start: DVec3,
    pub(super) end: DVec3,
    /// Unit vector from start to end; zero where they are equal.
    pub(super) direction: DVec3,
    /// Two unit vectors that are perpendicular to it and to each other; one lies in the plane of a plane curve.
    pub(super) normals: [DVec3; 2],
}

impl Chord {
    pub(super) fn new(start: DVec3, end: DVec3) -> Self {
        let direction = (end - start).normalize_or_zero();
        let flat = DVec3::new(-direction.y, direction.x, 0.0);
        let first = if flat.length_squared() > 1e-4 { flat } else { direction.cross(DVec3::X) };
        let first = first.normalize_or(DVec3::Y);
        Self { start, end, direction, normals: [first, direction.cross(first).normalize_or(DVec3::Z)] }
    }

    pub(super) fn distance(&self, point: DVec3) -> f64 {
        distance_to_segment(point, (self.start, self.end))
    }
}

/// The bound of a chord over parts that follow each other, each given by its end and the bound of its own
/// chord: a part is as far from the chord as the further of its ends, and as its own chord leaves out.
pub(super) fn joined(chord: &Chord, parts: impl Iterator<Item = (DVec3, f64)>) -> f64 {
    let mut deviation = 0.0_f64;
    let mut previous = 0.0;
    let mut parts = parts.peekable();
    while let Some((end, own)) = parts.next() {
        let distance = if parts.peek().is_none() { 0.0 } else { chord.distance(end) };
        deviation = deviation.max(distance.max(previous) + own);
        previous = distance;
    }
    deviation
}
