//! Planes across the axis of a map by which sides are cut: as dense as the map bends.

use glam::DVec3;

use crate::geometry::mesh::Mesh;
use crate::geometry::number::{Bounds, floor_count, floor_index, floor_large, sin_cos_degrees};
use crate::geometry::surface::Deformation;
use crate::geometry::tessellate::TessellateError;

/// Numbered planes across an axis. Between those of two whole numbers a side of a triangle may go without a cut.
pub(super) struct Levels {
    origin: DVec3,
    axis: DVec3,
    /// Stretches between kinks, from the lowest to the highest point.
    stretches: Vec<Stretch>,
    /// Heights nearer than this are one height.
    near: f64,
}

/// Heights between two kinks, or an end.
struct Stretch {
    low: f64,
    high: f64,
    /// Number of its first plane.
    first: f64,
    /// For each of the even pieces the number reached at its end, from 0 to a whole number.
    reached: Vec<f64>,
}

/// A cut of a side.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    /// Number of the plane.
    pub(super) level: u32,
    /// Part of the way along the side.
    pub(super) part: f64,
}

/// Pieces in which a stretch is looked at.
const PIECES: u16 = 128;

/// Directions across the axis in which the shape's reach is looked at; what it misses is under 1 percent.
const DIRECTIONS: u16 = 24;

/// Radians by which the map may turn between two planes, so that images of triangles are nearly triangles.
const MOST_TURN: f64 = 0.5;

/// A cut nearer to the end of a side than this share of the way to the next plane is left out, unless a kink asks for it.
const TOO_NEAR: f64 = 1e-3;

impl Levels {
    /// Planes between which a line along the axis bends by at most `sag`, wherever the points reach.
    ///
    /// # Errors
    /// When there are more planes than triangles are allowed, or too many to be counted.
    pub(super) fn new(
        map: &Deformation,
        points: &[DVec3],
        sag: f64,
        limit: u64,
    ) -> Result<Self, TessellateError> {
        let (origin, axis) = map.axis();
        let height = |point: &DVec3| (*point - origin).dot(axis);
        let low = points.iter().map(height).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
        let bounds = Bounds::of_points(points.iter().copied());
        let near = 1e-12 * bounds.diagonal();
        let mut levels = Self { origin, axis, stretches: Vec::new(), near };
        if points.is_empty() {
            return Ok(levels);
        }
        let mut stops = vec![low];
        let base = origin.dot(axis);
        let kinks = map.kinks(&bounds).into_iter().map(|(_, offset)| offset - base);
        stops.extend(kinks.filter(|kink| *kink > low + near && *kink < high - near));
        stops.push(high);
        stops.sort_by(f64::total_cmp);
        stops.dedup_by(|next, last| *next - *last <= near);
        let outline = outline(points, (origin, axis));
        let mut first = 0.0;
        for pair in stops.windows(2) {
            let stretch = Stretch::new((pair[0], pair[1]), first, |height| {
                density(map, (origin + axis * height, axis), &outline, sag)
            });
            first += stretch.reached[stretch.reached.len() - 1];
            if !(first <= f64::from(u32::MAX) && floor_large(first) <= limit) {
                return Err(TessellateError::TooMany { needed: floor_large(first), limit });
            }
            levels.stretches.push(stretch);
        }
        Ok(levels)
    }

    /// Unit direction of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.axis
    }

    fn height(&self, point: DVec3) -> f64 {
        (point - self.origin).dot(self.axis)
    }

    fn level(&self, height: f64) -> f64 {
        let next = self.stretches.partition_point(|stretch| stretch.high < height);
        let stretch = self.stretches.get(next).or(self.stretches.last());
        stretch.map_or(0.0, |stretch| stretch.level(height))
    }

    /// Where a side is cut, from its first end on.
    pub(super) fn cuts(&self, start: DVec3, end: DVec3) -> Vec<Cut> {
        let (from, to) = (self.height(start), self.height(end));
        let (low, high) = (from.min(to), from.max(to));
        if high - low <= self.near {
            return Vec::new();
        }
        let (least, most) = (self.level(low), self.level(high));
        let long = most - least > 1.0 + 1e-6;
        let mut cuts = Vec::new();
        for stretch in &self.stretches {
            let count = floor_index(stretch.reached[stretch.reached.len() - 1] + 0.5);
            let (first, last) = (least - stretch.first, most - stretch.first);
            // The first plane of a stretch is where a kink is, but for that of the first one.
            for k in floor_index(first)..count.min(floor_index(last + 2.0)) {
                let number = stretch.first + k as f64;
                let asked = if k == 0 {
                    stretch.low > low + self.near && stretch.low < high - self.near
                } else {
                    long && number > least + TOO_NEAR && number < most - TOO_NEAR
                };
                if asked {
                    let part = (stretch.place(k as f64) - from) / (to - from);
                    cuts.push(Cut { level: floor_count(number + 0.5), part });
                }
            }
        }
        if from > to {
            cuts.reverse();
        }
        cuts
    }

    /// Whether a side goes from plane to plane, or nearly.
    fn goes_along(&self, start: DVec3, end: DVec3) -> bool {
        (self.level(self.height(start)) - self.level(self.height(end))).abs() > 0.5
    }

    /// Whether a triangle is half of a cell of a ladder whose two long sides bend alike: then more planes help.
    pub(super) fn is_rung(&self, mesh: &Mesh, ends: &[(u32, u32); 3], sides: &[f64; 3]) -> bool {
        let point = |index: u32| mesh.points[index as usize];
        let mut long = (0..3).filter(|k| self.goes_along(point(ends[*k].0), point(ends[*k].1)));
        let (Some(one), Some(other)) = (long.next(), long.next()) else { return false };
        let (one, other) = (sides[one], sides[other]);
        one.min(other) >= 0.5 * one.max(other)
    }
}

impl Stretch {
    fn new((low, high): (f64, f64), first: f64, density: impl Fn(f64) -> f64) -> Self {
        let step = (high - low) / f64::from(PIECES);
        let mut reached = vec![0.0];
        let mut sum = 0.0;
        for k in 0..PIECES {
            sum += step * density(low + step * (f64::from(k) + 0.5));
            reached.push(sum);
        }
        let count = if sum.is_nan() { f64::INFINITY } else { (sum - 1e-9).ceil().max(1.0) };
        for (k, number) in (0..).zip(&mut reached) {
            *number = if sum > 0.0 { *number * (count / sum) } else { f64::from(k) / f64::from(PIECES) };
        }
        reached[usize::from(PIECES)] = count;
        Self { low, high, first, reached }
    }

    fn level(&self, height: f64) -> f64 {
        let place = ((height - self.low) / (self.high - self.low)).clamp(0.0, 1.0) * f64::from(PIECES);
        let piece = floor_index(place).min(usize::from(PIECES) - 1);
        let part = place - piece as f64;
        self.first + self.reached[piece] * (1.0 - part) + self.reached[piece + 1] * part
    }

    /// The height of a plane, counted from the first of the stretch.
    fn place(&self, number: f64) -> f64 {
        let next = self.reached.partition_point(|reached| *reached < number).clamp(1, usize::from(PIECES));
        let (before, after) = (self.reached[next - 1], self.reached[next]);
        let part = if after > before { (number - before) / (after - before) } else { 0.0 };
        let share = ((next - 1) as f64 + part) / f64::from(PIECES);
        self.low + (self.high - self.low) * share
    }
}

/// How far points reach across an axis, as offsets from it.
fn outline(points: &[DVec3], (origin, axis): (DVec3, DVec3)) -> Vec<DVec3> {
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let around = (0..DIRECTIONS).map(|k| {
        let (sin, cos) = sin_cos_degrees(360.0 * f64::from(k) / f64::from(DIRECTIONS));
        let direction = side * cos + up * sin;
        let far = |a: &&DVec3, b: &&DVec3| a.dot(direction).total_cmp(&b.dot(direction));
        points.iter().max_by(far).map_or(DVec3::ZERO, |point| {
            let away = *point - origin;
            away - axis * away.dot(axis)
        })
    });
    around.collect()
}

/// Planes for a unit of height.
fn density(map: &Deformation, (center, axis): (DVec3, DVec3), outline: &[DVec3], sag: f64) -> f64 {
    let bends = outline.iter().map(|offset| {
        let place = center + *offset;
        map.second(place, place, (axis, axis)).length()
    });
    let most = bends.fold(0.0, f64::max);
    (most / (8.0 * sag)).sqrt().max(map.turn_rate(center) / MOST_TURN)
}
