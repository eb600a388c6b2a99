//! A triangle moved exactly, and how far its chord plane is from that.

use glam::{DVec2, DVec3};

use super::{Directions, Heights, Verdict};
use crate::geometry::mesh::Mesh;
use crate::geometry::number::floor_count;

/// A triangle before it is moved, and its corners after.
pub(super) struct Facet<'a> {
    heights: &'a Heights<'a>,
    places: [DVec3; 3],
    ways: [DVec3; 3],
    uvs: [DVec2; 3],
    smooth: bool,
    moved: [DVec3; 3],
}

/// A triangle smaller than this part of the tolerance that still is not near lies over a jump.
const JUMP: f64 = 1.0 / 256.0;

/// Most steps of detail along a side that is still looked at as a whole.
const FINEST: f64 = 24.0;

impl<'a> Facet<'a> {
    pub(super) fn of(
        mesh: &Mesh,
        directions: &Directions,
        heights: &'a Heights<'a>,
        moved: &[f64],
        triangle: usize,
    ) -> Self {
        let vertices = mesh.triangles[triangle].map(|corner| mesh.vertices[corner.subscript()]);
        let points = vertices.map(|vertex| vertex.point.subscript());
        let ways = points.map(|point| directions.at(point));
        let places = points.map(|point| mesh.points[point]);
        Self {
            heights,
            places,
            ways,
            uvs: vertices.map(|vertex| vertex.uv),
            smooth: points.iter().all(|point| directions.is_smooth(*point)),
            moved: [0, 1, 2].map(|k| places[k] + ways[k] * moved[points[k]]),
        }
    }

    /// The moved surface at barycentric coordinates.
    fn at(&self, weights: [f64; 3]) -> DVec3 {
        let (place, height, way) = self.parts(weights);
        place + way * height
    }

    /// The place before it is moved, its height and its way.
    fn parts(&self, weights: [f64; 3]) -> (DVec3, f64, DVec3) {
        let sum = |of: [DVec3; 3]| of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2];
        let uv = self.uvs[0] * weights[0] + self.uvs[1] * weights[1] + self.uvs[2] * weights[2];
        let (place, way) = (sum(self.places), sum(self.ways));
        let way = if self.smooth { way.normalize_or(self.ways[0]) } else { way };
        (place, (self.heights.height)(place, uv), way)
    }

    fn chord(&self, weights: [f64; 3]) -> DVec3 {
        self.moved[0] * weights[0] + self.moved[1] * weights[1] + self.moved[2] * weights[2]
    }

    /// What must be split. Places are looked at twice to a step of detail, and five to a side at the least.
    pub(super) fn judge(&self, aim: f64) -> Verdict {
        let detail = [0, 1, 2].map(|k| {
            let other = (k + 1) % 3;
            (self.heights.detail)([self.places[k], self.places[other]], [self.uvs[k], self.uvs[other]])
        });
        let most = detail.into_iter().fold(0.0, f64::max);
        if most > FINEST {
            return Verdict { split: detail.map(|own| own >= most), error: f64::INFINITY, jumps: false };
        }
        let steps = floor_count(2.0 * most).max(8);
        let part = |k: u32| f64::from(k) / f64::from(steps);
        let mut sides = [0.0_f64; 3];
        let mut inside = 0.0_f64;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let weights = [part(steps - i - j), part(i), part(j)];
                if weights.contains(&1.0) {
                    continue;
                }
                let away = self.at(weights).distance(self.chord(weights));
                // Where there is no height, corners come and tell it.
                let error = if away.is_nan() { f64::INFINITY } else { away };
                match weights.iter().position(|weight| *weight == 0.0) {
                    // The side opposite to corner k begins at the corner after it.
                    Some(k) => sides[(k + 1) % 3] = sides[(k + 1) % 3].max(error),
                    None => inside = inside.max(error),
                }
            }
        }
        let mut split = sides.map(|error| error > aim);
        if !split.contains(&true) && inside > aim {
            let length = |k: usize| self.places[k].distance_squared(self.places[(k + 1) % 3]);
            let longest = if length(0) >= length(1) { 0 } else { 1 };
            split[if length(longest) >= length(2) { longest } else { 2 }] = true;
        }
        let length = |k: usize| self.places[k].distance(self.places[(k + 1) % 3]);
        let longest = length(0).max(length(1)).max(length(2));
        let error = sides.into_iter().fold(inside, f64::max);
        Verdict { split, error, jumps: error > aim && longest < JUMP * aim }
    }

    /// The normal of the moved surface at barycentric coordinates. Where the mesh is smooth it is taken for the round
    /// surface that its normals speak of, not for the flat triangle.
    pub(super) fn normal_at(&self, weights: [f64; 3]) -> Option<DVec3> {
        /// Part of the way to a corner over which differences are taken.
        const STEP: f64 = 1e-4;
        // Toward the two corners that are furthest.
        let nearest = (0..3).max_by(|a, b| weights[*a].total_cmp(&weights[*b]))?;
        let (next, last) = ((nearest + 1) % 3, (nearest + 2) % 3);
        let (place, height, way) = self.parts(weights);
        let toward = |corner: usize| {
            let mut there = weights.map(|weight| weight * (1.0 - STEP));
            there[corner] += STEP;
            let (moved, other, turned) = self.parts(there);
            let step = moved - place;
            let step = if self.smooth { step - way * step.dot(way) } else { step };
            step + way * (other - height) + (turned - way) * height
        };
        toward(next).cross(toward(last)).try_normalize()
    }

    /// Whether the moved surface is turned over at a corner: the height reaches below the center of its curvature. Of a
    /// triangle at a sharp edge that cannot be told here.
    pub(super) fn is_folded(&self, corner: usize) -> bool {
        if !self.smooth {
            return false;
        }
        let mut weights = [0.0; 3];
        weights[corner] = 1.0;
        let (_, height, way) = self.parts(weights);
        let across = [1, 2].map(|step| {
            let other = (corner + step) % 3;
            let side = self.places[other] - self.places[corner];
            (side - way * side.dot(way), self.ways[other] - way)
        });
        let turn = |height: f64| {
            let [a, b] = across.map(|(side, turned)| side + turned * height);
            a.cross(b).dot(way)
        };
        turn(height) <= 0.0 && turn(0.0) > 0.0
    }

    /// The moved corners.
    pub(super) fn corners(&self) -> [DVec3; 3] {
        self.moved
    }

    /// The normal at a corner, from inside of the triangle, and the angle there.
    pub(super) fn normal(&self, corner: usize) -> Option<(DVec3, f64)> {
        let mut weights = [0.0; 3];
        weights[corner] = 1.0;
        let (next, last) = ((corner + 1) % 3, (corner + 2) % 3);
        let (one, other) = (self.moved[next] - self.moved[corner], self.moved[last] - self.moved[corner]);
        self.normal_at(weights).map(|normal| (normal, one.angle_between(other)))
    }
}
