//! Polygons as they were authored or imported: faces of any number of corners, with holes.

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::geometry::mesh::{Color, PointIndex, index};
use crate::geometry::number::Bounds;

/// Index into [`PolygonMesh::uvs`] or [`PolygonMesh::normals`] of a corner that has none.
pub const NONE: u32 = u32::MAX;

/// One face: an outer loop and the holes in it. Its loops and corners follow those of the face before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// One past its last loop, an index into [`PolygonMesh::loop_ends`]; the first of its loops is the outer one.
    pub loops_end: u32,
    /// Index into [`PolygonMesh::materials`], if it names one.
    pub material: Option<u32>,
    /// Smoothing group; 0 is none (flat). Read only where [`PolygonMesh::has_smoothing`] holds.
    pub smoothing: u32,
}

/// A mesh of polygons. Loops run counter-clockwise seen from outside, holes the other way.
///
/// Everything is stored flat: `corners` of all loops one after another, `loop_ends` cuts them into loops,
/// [`Face::loops_end`] cuts the loops into faces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolygonMesh {
    /// Positions, metres.
    pub points: Vec<DVec3>,
    /// The point under each corner.
    pub corners: Vec<PointIndex>,
    /// One past the last corner of each loop.
    pub loop_ends: Vec<u32>,
    /// The faces.
    pub faces: Vec<Face>,
    /// Texture coordinates, v growing downwards.
    pub uvs: Vec<DVec2>,
    /// For each corner an index into `uvs`, or [`NONE`]; empty when no corner has one.
    pub corner_uvs: Vec<u32>,
    /// Normals of any length but zero.
    pub normals: Vec<DVec3>,
    /// For each corner an index into `normals`, or [`NONE`]; empty when no corner has one.
    pub corner_normals: Vec<u32>,
    /// Colors.
    pub colors: Vec<Color>,
    /// For each corner an index into `colors`; empty when the mesh has none.
    pub corner_colors: Vec<u32>,
    /// Edges that a file says are sharp where the mesh is subdivided, by their points, and for how many steps.
    pub creases: Vec<([PointIndex; 2], f64)>,
    /// Points that it says are sharp, and for how many steps.
    pub sharp_points: Vec<(PointIndex, f64)>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// Whether [`Face::smoothing`] was given; otherwise an angle decides which edges are hard.
    pub has_smoothing: bool,
    /// Whether [`Face::smoothing`] has a bit for each group, so that a face may be in several; else it is the number of one.
    pub smoothing_masks: bool,
}

/// What is wrong with a [`PolygonMesh`].
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PolygonError {
    /// A coordinate is NaN or infinite.
    #[error("point {point} has a coordinate that is not a finite number: {position}")]
    NotFinite {
        /// Which point.
        point: u32,
        /// Its position.
        position: DVec3,
    },
    /// A corner names a point that does not exist.
    #[error("face {face} uses point {point}, but there are only {count} points")]
    PointOutOfRange {
        /// Which face.
        face: u32,
        /// The point it asks for.
        point: u32,
        /// How many there are.
        count: u32,
    },
    /// A loop of fewer than three corners.
    #[error("face {face} has a loop of {corners} corners; a polygon needs at least three")]
    TooFewCorners {
        /// Which face.
        face: u32,
        /// Corners of the loop.
        corners: u32,
    },
    /// A face without a loop.
    #[error("face {face} has no corners")]
    Empty {
        /// Which face.
        face: u32,
    },
    /// A crease names a point that does not exist.
    #[error("a crease uses point {point}, but there are only {count} points")]
    CreaseOutOfRange {
        /// The point it asks for.
        point: u32,
        /// How many there are.
        count: u32,
    },
    /// Attribute indices that do not fit the corners.
    #[error("face {face} uses {what} {index}, but there are only {count}")]
    AttributeOutOfRange {
        /// Which face.
        face: u32,
        /// `texture coordinate`, `normal`, `color` or `material`.
        what: &'static str,
        /// The index it asks for.
        index: u32,
        /// How many there are.
        count: u32,
    },
    /// The flat arrays disagree in length.
    #[error("{what} has {found} entries where {expected} are needed")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: u32,
        /// The length that fits the rest.
        expected: u32,
    },
}

impl PolygonMesh {
    /// Adds a face whose loops are given as points; the first loop is the outer one.
    pub fn push_face(&mut self, loops: &[&[u32]], material: Option<u32>, smoothing: u32) {
        for corners in loops {
            self.corners.extend(corners.iter().copied().map(PointIndex));
            self.loop_ends.push(index(self.corners.len()));
        }
        self.faces.push(Face { loops_end: index(self.loop_ends.len()), material, smoothing });
    }

    /// A mesh of simple faces without attributes.
    #[must_use]
    pub fn from_faces(points: Vec<DVec3>, faces: &[&[u32]]) -> Self {
        let mut mesh = Self { points, ..Self::default() };
        for face in faces {
            mesh.push_face(&[face], None, 0);
        }
        mesh
    }

    /// The smallest box that holds all points, also those that no face uses.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        Bounds::of_points(self.points.iter().copied())
    }

    /// The loops of a face as an index range of `loop_ends`.
    #[must_use]
    pub fn loops_of(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.faces[face - 1].loops_end as usize };
        start..self.faces[face].loops_end as usize
    }

    /// The corners of a loop as an index range of `corners`.
    #[must_use]
    pub fn corners_of_loop(&self, ring: usize) -> std::ops::Range<usize> {
        let start = if ring == 0 { 0 } else { self.loop_ends[ring - 1] as usize };
        start..self.loop_ends[ring] as usize
    }

    /// All corners of a face, outer loop and holes, as an index range of `corners`.
    #[must_use]
    pub fn corners_of(&self, face: usize) -> std::ops::Range<usize> {
        let loops = self.loops_of(face);
        if loops.is_empty() {
            return 0..0;
        }
        self.corners_of_loop(loops.start).start..self.corners_of_loop(loops.end - 1).end
    }

    /// Position under a corner.
    #[must_use]
    pub fn position(&self, corner: usize) -> DVec3 {
        self.points[self.corners[corner].subscript()]
    }

    /// Twice the vector area of a face by Newell's sums, holes subtracted: its direction is the normal of the
    /// best plane, its length twice the area. Zero for a face without area.
    ///
    /// Source: M. Newell's method as in I. Sutherland, R. Sproull, R. Schumacker, "A Characterization of Ten
    /// Hidden-Surface Algorithms", 1974.
    #[must_use]
    pub fn newell(&self, face: usize) -> DVec3 {
        self.loops_of(face).map(|ring| self.newell_of_loop(ring)).sum()
    }

    /// Newell's vector of one loop; see [`PolygonMesh::newell`].
    #[must_use]
    pub fn newell_of_loop(&self, ring: usize) -> DVec3 {
        newell(self.corners_of_loop(ring).map(|corner| self.position(corner)))
    }

    /// Checks every index and number; everything else in `geometry::mesh` relies on it.
    ///
    /// # Errors
    /// The first thing that is wrong, in the order lengths, points, faces. Linear in the size of the mesh.
    pub fn validate(&self) -> Result<(), PolygonError> {
        self.validate_lengths()?;
        if let Some(point) = self.points.iter().position(|point| !point.is_finite()) {
            return Err(PolygonError::NotFinite { point: index(point), position: self.points[point] });
        }
        let count = self.points.len();
        let ends = self.creases.iter().flat_map(|(ends, _)| ends);
        let mut sharp = ends.chain(self.sharp_points.iter().map(|(point, _)| point));
        if let Some(point) = sharp.find(|point| point.subscript() >= count) {
            return Err(PolygonError::CreaseOutOfRange { point: point.0, count: index(count) });
        }
        (0..self.faces.len()).try_for_each(|face| self.validate_face(face))
    }

    fn validate_lengths(&self) -> Result<(), PolygonError> {
        let corners = self.corners.len();
        let check = |what, found: usize, expected: usize| {
            if found == expected {
                return Ok(());
            }
            Err(PolygonError::Length { what, found: index(found), expected: index(expected) })
        };
        let loops_end = last_of_rising(self.faces.iter().map(|face| face.loops_end));
        check("loop_ends", self.loop_ends.len(), loops_end.unwrap_or(0) as usize)?;
        let corners_end = last_of_rising(self.loop_ends.iter().copied());
        check("corners", corners, corners_end.unwrap_or(0) as usize)?;
        if !self.corner_uvs.is_empty() {
            check("corner_uvs", self.corner_uvs.len(), corners)?;
        }
        if !self.corner_normals.is_empty() {
            check("corner_normals", self.corner_normals.len(), corners)?;
        }
        if !self.corner_colors.is_empty() {
            check("corner_colors", self.corner_colors.len(), corners)?;
        }
        Ok(())
    }

    fn validate_face(&self, face: usize) -> Result<(), PolygonError> {
        let loops = self.loops_of(face);
        if loops.is_empty() {
            return Err(PolygonError::Empty { face: index(face) });
        }
        for ring in loops {
            let corners = self.corners_of_loop(ring);
            if corners.len() < 3 {
                return Err(PolygonError::TooFewCorners { face: index(face), corners: index(corners.len()) });
            }
        }
        let count = self.points.len();
        for corner in self.corners_of(face) {
            let point = self.corners[corner];
            if point.subscript() >= count {
                return Err(PolygonError::PointOutOfRange {
                    face: index(face),
                    point: point.0,
                    count: index(count),
                });
            }
        }
        self.validate_attributes(face)
    }

    fn validate_attributes(&self, face: usize) -> Result<(), PolygonError> {
        let check = |what, used: u32, count: usize| {
            if used == NONE || (used as usize) < count {
                return Ok(());
            }
            Err(PolygonError::AttributeOutOfRange {
                face: index(face),
                what,
                index: used,
                count: index(count),
            })
        };
        for corner in self.corners_of(face) {
            if let Some(&uv) = self.corner_uvs.get(corner) {
                check("texture coordinate", uv, self.uvs.len())?;
            }
            if let Some(&normal) = self.corner_normals.get(corner) {
                check("normal", normal, self.normals.len())?;
            }
            if let Some(&color) = self.corner_colors.get(corner)
                && color as usize >= self.colors.len()
            {
                let count = index(self.colors.len());
                return Err(PolygonError::AttributeOutOfRange {
                    face: index(face),
                    what: "color",
                    index: color,
                    count,
                });
            }
        }
        self.faces[face].material.map_or(Ok(()), |used| {
            if (used as usize) < self.materials.len() {
                return Ok(());
            }
            let count = index(self.materials.len());
            Err(PolygonError::AttributeOutOfRange { face: index(face), what: "material", index: used, count })
        })
    }
}

/// The last of numbers that never fall, 0 when there is none; `None` when one falls.
fn last_of_rising(mut ends: impl Iterator<Item = u32>) -> Option<u32> {
    ends.try_fold(0, |last, end| (end >= last).then_some(end))
}

/// Newell's vector of a closed loop of points: twice its vector area. Summed relative to the first point, so that
/// the distance from the origin costs no accuracy.
#[must_use]
pub fn newell(points: impl IntoIterator<Item = DVec3>) -> DVec3 {
    let mut points = points.into_iter();
    let Some(origin) = points.next() else { return DVec3::ZERO };
    let mut before = DVec3::ZERO;
    let mut sum = DVec3::ZERO;
    for point in points {
        let arm = point - origin;
        sum += before.cross(arm);
        before = arm;
    }
    sum
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::{NONE, PolygonError, PolygonMesh, newell};
    use crate::geometry::mesh::{Color, PointIndex};

    fn square() -> PolygonMesh {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        PolygonMesh::from_faces(points, &[&[0, 1, 2, 3]])
    }

    #[test]
    fn newell_is_twice_the_vector_area() {
        let mesh = square();
        assert_eq!(mesh.newell(0), DVec3::new(0.0, 0.0, 2.0));
        let far = mesh.points.iter().map(|&point| point + DVec3::splat(1e9));
        assert_eq!(newell(far), DVec3::new(0.0, 0.0, 2.0));
    }

    #[test]
    fn holes_are_subtracted() {
        let mut mesh = square();
        mesh.points.extend(
            [(0.25, 0.25), (0.25, 0.75), (0.75, 0.75), (0.75, 0.25)].map(|(x, y)| DVec3::new(x, y, 0.0)),
        );
        mesh.faces.clear();
        mesh.loop_ends.clear();
        mesh.corners.clear();
        mesh.push_face(&[&[0, 1, 2, 3], &[4, 5, 6, 7]], None, 0);
        assert_eq!(mesh.newell(0), DVec3::new(0.0, 0.0, 1.5));
        assert_eq!(mesh.validate(), Ok(()));
    }

    #[test]
    fn every_fault_is_found() {
        let mut mesh = square();
        mesh.points[2].y = f64::NAN;
        assert!(matches!(mesh.validate(), Err(PolygonError::NotFinite { point: 2, .. })));

        let mut mesh = square();
        mesh.push_face(&[&[0, 1, 4]], None, 0);
        assert_eq!(mesh.validate(), Err(PolygonError::PointOutOfRange { face: 1, point: 4, count: 4 }));

        let mut mesh = square();
        mesh.push_face(&[&[0, 1]], None, 0);
        assert_eq!(mesh.validate(), Err(PolygonError::TooFewCorners { face: 1, corners: 2 }));

        let mut mesh = square();
        mesh.push_face(&[], None, 0);
        assert_eq!(mesh.validate(), Err(PolygonError::Empty { face: 1 }));

        let mut mesh = square();
        mesh.push_face(&[&[0, 1, 2]], Some(0), 0);
        let expected = PolygonError::AttributeOutOfRange { face: 1, what: "material", index: 0, count: 0 };
        assert_eq!(mesh.validate(), Err(expected));

        let mut mesh = square();
        mesh.uvs = vec![DVec2::ZERO];
        mesh.corner_uvs = vec![0, NONE, 1, 0];
        let expected =
            PolygonError::AttributeOutOfRange { face: 0, what: "texture coordinate", index: 1, count: 1 };
        assert_eq!(mesh.validate(), Err(expected));

        let mut mesh = square();
        mesh.corner_uvs = vec![NONE];
        let expected = PolygonError::Length { what: "corner_uvs", found: 1, expected: 4 };
        assert_eq!(mesh.validate(), Err(expected));

        let mut mesh = square();
        mesh.colors = vec![Color::WHITE];
        mesh.corner_colors = vec![0, 0, NONE, 0];
        let expected = PolygonError::AttributeOutOfRange { face: 0, what: "color", index: NONE, count: 1 };
        assert_eq!(mesh.validate(), Err(expected));

        let mut mesh = square();
        mesh.creases = vec![([PointIndex(0), PointIndex(4)], 1.0)];
        assert_eq!(mesh.validate(), Err(PolygonError::CreaseOutOfRange { point: 4, count: 4 }));

        let mut mesh = square();
        mesh.loop_ends[0] = 9;
        assert_eq!(mesh.validate(), Err(PolygonError::Length { what: "corners", found: 4, expected: 9 }));
    }
}
