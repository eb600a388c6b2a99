//! The images of triangles, and how far they are from flat.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::DeformError;
use super::split::{Splitter, key};
use crate::geometry::mesh::{Mesh, VertexIndex};
use crate::geometry::number::Bounds;
use crate::geometry::surface::{Deformation, SecondRange, SurfaceJet, Warped};
use crate::geometry::tessellate::patch::judge::{Chart, judge, judge_chord};
use crate::geometry::tessellate::patch::rows::{Corner, Free};
use crate::geometry::tessellate::{Deviation, Evidence};

/// Sides of this share of the longest are split with it where a triangle is folded.
const LIKE_THE_LONGEST: f64 = 0.74;

/// Sides that bend by this share of the worst are split with it.
const LIKE_THE_WORST: f64 = 0.55;

/// Below this share of a volume nothing is left of it.
const NO_VOLUME: f64 = 1e-9;

/// The image of a point, unless the map turns its surroundings inside out.
pub(super) fn image_of(map: &Deformation, point: DVec3) -> Result<Warped, DeformError> {
    let image = map.apply(point);
    if image.jacobian.determinant() > NO_VOLUME && image.point.is_finite() {
        return Ok(image);
    }
    Err(DeformError::Folds { at: point, bend: map.bend(point) })
}

/// The images of the points of a mesh.
pub(super) struct Images<'a> {
    pub(super) map: &'a Deformation,
    pub(super) points: Vec<DVec3>,
}

/// A triangle before the map as a surface: its parameters are places in its plane.
pub(super) struct FlatChart<'a> {
    map: &'a Deformation,
    origin: DVec3,
    across: DVec3,
    up: DVec3,
    /// The middle of the triangle, and how far its corners are from it.
    middle: DVec3,
    reach: f64,
}

/// The verdict on one triangle.
#[derive(Clone, Copy)]
pub(super) struct Judged {
    pub(super) deviation: Deviation,
    /// How much each side bends away; side k lies opposite of corner k.
    pub(super) sides: [f64; 3],
    pub(super) ends: [(u32, u32); 3],
    lengths: [f64; 3],
}

impl Judged {
    /// Marks the sides that bend most; where none does (a triangle that stands across its image), the longest ones.
    pub(super) fn mark(&self, marks: &mut HashMap<(u32, u32), f64>) {
        let worst = self.sides.into_iter().fold(0.0, f64::max);
        let longest = self.lengths.into_iter().fold(0.0, f64::max);
        for side in 0..3 {
            let chosen = if worst > 0.0 {
                self.sides[side] >= LIKE_THE_WORST * worst
            } else {
                self.lengths[side] >= LIKE_THE_LONGEST * longest
            };
            if chosen {
                marks.insert(self.ends[side], 0.5);
            }
        }
    }
}

impl Images<'_> {
    /// Maps the points that have been added.
    pub(super) fn follow(&mut self, mesh: &Mesh) -> Result<(), DeformError> {
        for point in &mesh.points[self.points.len()..] {
            self.points.push(image_of(self.map, *point)?.point);
        }
        Ok(())
    }

    pub(super) fn judge(
        &self,
        splitter: &Splitter<'_>,
        triangle: &[VertexIndex; 3],
        tolerance: f64,
    ) -> Judged {
        let mesh = &splitter.mesh;
        let points = triangle.map(|vertex| mesh.vertices[vertex.subscript()].point);
        let before = points.map(|point| mesh.points[point.subscript()]);
        let after = points.map(|point| self.points[point.subscript()]);
        let chart = FlatChart::new(self.map, before);
        let corners = before.map(|place| chart.corner(place));
        let ends = [0, 1, 2].map(|side| key(points[(side + 1) % 3].0, points[(side + 2) % 3].0));
        let lengths = [0, 1, 2].map(|side| before[(side + 1) % 3].distance(before[(side + 2) % 3]));
        let normals = corners.map(|corner| chart.jet(corner.u, corner.v).normal);
        let verdict = judge(&chart, (corners, normals), after, tolerance);
        let (mut bound, mut evidence) = verdict.bound(tolerance);
        // The corners lie on the surface, and no point of a triangle is further from all three than this.
        let longest = (0..3).map(|side| after[side].distance(after[(side + 1) % 3])).fold(0.0, f64::max);
        if longest / 3.0_f64.sqrt() < bound {
            (bound, evidence) = (longest / 3.0_f64.sqrt(), Evidence::Proved);
        }
        let mut sides = verdict.sides;
        for side in 0..3 {
            if splitter.is_line(ends[side]) {
                let (i, j) = ((side + 1) % 3, (side + 2) % 3);
                let (chord, how) =
                    judge_chord(&chart, (&corners[i], &corners[j]), [after[i], after[j]], tolerance);
                bound = bound.max(chord);
                evidence = evidence.max(how);
                // A line that is good enough does not say where a triangle that is folded is to be split.
                if chord > tolerance {
                    sides[side] = sides[side].max(chord);
                }
            }
        }
        let evidence = if bound == 0.0 { Evidence::Exact } else { evidence };
        Judged { deviation: Deviation { bound, evidence }, sides, ends, lengths }
    }

    /// The mesh where the map takes it. Normals go by the inverse transpose.
    pub(super) fn moved(self, mut mesh: Mesh) -> Mesh {
        for vertex in &mut mesh.vertices {
            let jacobian = self.map.apply(mesh.points[vertex.point.subscript()]).jacobian;
            let [x, y, z] = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
            // The cofactors are the inverse transpose times the determinant, which is positive.
            let normal =
                y.cross(z) * vertex.normal.x + z.cross(x) * vertex.normal.y + x.cross(y) * vertex.normal.z;
            vertex.normal = normal.try_normalize().unwrap_or(vertex.normal);
        }
        mesh.points = self.points;
        mesh
    }
}

impl<'a> FlatChart<'a> {
    pub(super) fn new(map: &'a Deformation, [a, b, c]: [DVec3; 3]) -> Self {
        let across = (b - a).try_normalize().unwrap_or(DVec3::X);
        let up = (c - a) - across * (c - a).dot(across);
        let up = up.try_normalize().unwrap_or_else(|| across.any_orthonormal_vector());
        let middle = (a + b + c) / 3.0;
        let reach = [a, b, c].iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        Self { map, origin: a, across, up, middle, reach }
    }

    pub(super) fn corner(&self, place: DVec3) -> Corner {
        let away = place - self.origin;
        Corner { u: away.dot(self.across), v: away.dot(self.up), point: 0, free: Free::Neither }
    }

    fn place(&self, u: f64, v: f64) -> DVec3 {
        self.origin + self.across * u + self.up * v
    }
}

impl Chart for FlatChart<'_> {
    fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let image = self.map.apply(self.place(u, v));
        let (du, dv) = (image.jacobian * self.across, image.jacobian * self.up);
        SurfaceJet { point: image.point, du, dv, normal: du.cross(dv).normalize_or_zero() }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let center = DVec2::new(u.0 + u.1, v.0 + v.1) / 2.0;
        let middle = self.place(center.x, center.y);
        let half = (DVec2::new(u.1 - u.0, v.1 - v.0) / 2.0).length();
        let change = self.map.third_bound(self.middle, self.reach + half)? * half;
        let around = |bend: DVec3| Bounds { min: bend - change, max: bend + change };
        let second = |d: DVec3, e: DVec3| around(self.map.second(middle, self.middle, (d, e)));
        Some(SecondRange {
            uu: second(self.across, self.across),
            uv: second(self.across, self.up),
            vv: second(self.up, self.up),
        })
    }

    fn limits(&self) -> ((f64, f64), (f64, f64)) {
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        (all, all)
    }
}
