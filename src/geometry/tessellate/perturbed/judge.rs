//! How far triangles and chords lie from the surface of a relief: proved bounds.
//!
//! With corners c on the surface, what F' is on a triangle follows from its second derivatives alone. By Taylor's formula
//! from a place x of shares l towards each corner, `2 F'(x) = - sum of l_i H_i(x - c_i, x - c_i)`, with means H of second
//! derivatives between x and the corner. If all H were one this would be `- sum of l_i l_j H(e_ij, e_ij)` over the sides e;
//! from bounds m +- r on `H(e_ij, e_ij)` over the triangle follows that it is that sum of the m, within
//! `sum of l_i l_j (1 + 2 l_k) r`. From a place where F' is f, and its slope along n at least g, the surface is met along n
//! after 2 f / (g + sqrt(g² - 2 f b)) or before, where b bounds the bend.

use glam::{DVec2, DVec3};

use super::PerturbedFace;
use crate::geometry::field::{Relief, Zone};
use crate::geometry::number::Bounds;
use crate::geometry::tessellate::quadric::greatest;
use crate::geometry::tessellate::region::{Chart, Judgment, Line};

/// A face as a chart.
pub(super) struct FaceChart<'a> {
    pub(super) face: &'a PerturbedFace,
}

impl Chart for FaceChart<'_> {
    fn lift(&self, place: DVec2) -> Option<DVec3> {
        self.face.root(place)
    }

    fn judge(&self, _: [DVec2; 3], corners: [DVec3; 3]) -> Judgment {
        judge(&self.face.relief, corners)
    }

    fn judge_edge(&self, _: [DVec2; 2], [from, to]: [DVec3; 2]) -> f64 {
        chord(&self.face.relief, from, to, None)
    }
}

/// A triangle with corners on the surface.
fn judge(relief: &Relief, corners: [DVec3; 3]) -> Judgment {
    let within = Zone::Between(&corners);
    let [a, b, c] = corners;
    // Opposite corner a, b, c.
    let bends = [c - b, a - c, b - a].map(|side| relief.second(within, side));
    let middles = bends.map(|bend| (bend.low + bend.high) / 2.0);
    let spreads = bends.map(|bend| bend.width() / 2.0);
    let (value, worst) = greatest(middles);
    let widest = spreads.into_iter().fold(0.0, f64::max);
    // The greatest of l_i l_j (1 + 2 l_k) is 1/4, that of the sum of three is 5/9.
    let spread = (spreads.iter().sum::<f64>() / 4.0).min(widest * 5.0 / 9.0);
    let value = (value + spread) / 2.0;
    let mean: DVec3 = corners.iter().map(|corner| relief.value_gradient(*corner).1).sum();
    let bound = reach(relief, &corners, value, mean.normalize_or_zero());
    if bound.is_finite() {
        Judgment { bound, worst }
    } else {
        Judgment { bound, worst: DVec3::splat(1.0 / 3.0) }
    }
}

/// How far the surface can be, along a direction, from places between points where F' has at most a size.
fn reach(relief: &Relief, corners: &[DVec3], value: f64, along: DVec3) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let least = relief.slope(Zone::Between(corners), along).low;
    if least.is_nan() || least <= 0.0 {
        return f64::INFINITY;
    }
    let room = 2.0 * value / least;
    let within = Bounds::of_points(corners.iter().copied());
    let around = Bounds { min: within.min - room, max: within.max + room };
    let inner = least * least - 2.0 * value * relief.bend(&around);
    if inner.is_nan() || inner < 0.0 {
        return f64::INFINITY;
    }
    2.0 * value / (least + inner.sqrt())
}

/// How far the surface is from the chord between two of its points; along a wall through both where one is given.
pub(super) fn chord(relief: &Relief, from: DVec3, to: DVec3, wall: Option<DVec3>) -> f64 {
    let bend = relief.second(Zone::Between(&[from, to]), to - from);
    let value = bend.size() / 8.0;
    let mean = relief.value_gradient(from).1 + relief.value_gradient(to).1;
    let flat = wall.map_or(mean, |wall| mean - wall * wall.dot(mean));
    reach(relief, &[from, to], value, flat.normalize_or_zero())
}

/// The line of a surface in the wall over a side of a face.
pub(super) struct Rim<'a> {
    pub(super) face: &'a PerturbedFace,
    /// The ends of the side in coordinates of the face.
    pub(super) from: DVec2,
    pub(super) to: DVec2,
}

impl Line for Rim<'_> {
    fn bulge(&self, from: DVec3, to: DVec3) -> (DVec3, f64) {
        let wall = self.face.rays.wall(self.from, self.to);
        let bound = chord(&self.face.relief, from, to, Some(wall));
        (self.settled((from + to) / 2.0), bound)
    }

    fn settled(&self, point: DVec3) -> DVec3 {
        let along = self.to - self.from;
        let (at, _) = self.face.rays.drop(point);
        let share = ((at - self.from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        self.face.root(self.from + along * share).unwrap_or(point)
    }
}
