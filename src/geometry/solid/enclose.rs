//! Simple bodies around points.
//!
//! Promise: every point lies inside but for rounding. Box and hull are the least of their kind (boxes along the axes); a ball has
//! the middle of the box, capsules and cylinders its axes. A hull of few vertices is cut out of the box by planes that touch the
//! true hull, one after the other where it is farthest.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{SolidFault, engine, hull};
use crate::geometry::mesh::nearest::Nearest;
use crate::geometry::number::Bounds;

/// Part of the size of a body within which places count as one.
const NOISE: f64 = 1e-9;

/// A round body about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round {
    /// The number of its axis: x, y, z.
    pub axis: usize,
    /// Its middle.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
    /// From end to end; of a capsule without the half balls.
    pub height: f64,
}

/// The radius of the ball about the middle of a box of points.
#[must_use]
pub fn enclosing_radius(points: &[DVec3], center: DVec3) -> f64 {
    points.iter().map(|point| point.distance(center)).fold(0.0, f64::max)
}

/// The cylinder of the least volume along an axis.
#[must_use]
pub fn enclosing_cylinder(points: &[DVec3]) -> Round {
    least(points, |round| round.radius * round.radius * round.height, |_, _, height| height)
}

/// The capsule of the least volume along an axis.
#[must_use]
pub fn enclosing_capsule(points: &[DVec3]) -> Round {
    let volume = |round: &Round| round.radius * round.radius * (round.height + 4.0 / 3.0 * round.radius);
    least(points, volume, |across, radius, _| {
        // Each point must lie below the half balls at both ends.
        let reach =
            |(along, away): &(f64, f64)| along.abs() - (radius * radius - away * away).max(0.0).sqrt();
        2.0 * across.iter().map(reach).fold(0.0, f64::max)
    })
}

/// The least of three round bodies; `height` is told by places along the axis and away from it, the radius, and the extent.
fn least(
    points: &[DVec3],
    volume: impl Fn(&Round) -> f64,
    height: impl Fn(&[(f64, f64)], f64, f64) -> f64,
) -> Round {
    let bounds = Bounds::of_points(points.iter().copied());
    let center = bounds.center();
    let of = |axis: usize| {
        let across: Vec<(f64, f64)> = points
            .iter()
            .map(|point| {
                let away = *point - center;
                let along = away[axis];
                (along, (away.length_squared() - along * along).max(0.0).sqrt())
            })
            .collect();
        let radius = across.iter().map(|(_, away)| *away).fold(0.0, f64::max);
        let extent = (bounds.max - bounds.min)[axis];
        Round { axis, center, radius, height: height(&across, radius, extent) }
    };
    // Of two of one volume the one along y, as shapes stand.
    let mut best = of(1);
    for other in [of(0), of(2)] {
        if volume(&other) < volume(&best) * (1.0 - NOISE) {
            best = other;
        }
    }
    best
}

/// A convex body around points with at most so many vertices, which are no fewer than 8.
///
/// # Errors
/// Points that all lie on one plane; a build without the feature `csg`.
pub fn enclosing_hull(points: &[DVec3], most: usize) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), SolidFault> {
    let (corners, triangles) = engine::hull(points)?;
    if corners.len() <= most {
        return Ok((corners, triangles));
    }
    let exact = hull(points, 180.0)?;
    let nearest = Nearest::new(&exact);
    let bounds = Bounds::of_points(corners.iter().copied());
    let mut body = Polytope::of_box(&bounds);
    let noise = NOISE * bounds.diagonal();
    loop {
        let away = |point: &DVec3| nearest.find(*point).map_or(0.0, |found| found.distance);
        let farthest = body.points.iter().max_by(|a, b| away(a).total_cmp(&away(b))).copied();
        let Some(found) = farthest.and_then(|point| Some((point, nearest.find(point)?))) else { break };
        let (point, found) = found;
        if found.distance <= noise {
            break;
        }
        let foot: DVec3 = exact.triangles[found.triangle]
            .iter()
            .zip(found.weights)
            .map(|(corner, part)| exact.points[exact.vertices[corner.subscript()].point.subscript()] * part)
            .sum();
        let Some(normal) = (point - foot).try_normalize() else { break };
        let offset = corners.iter().map(|corner| corner.dot(normal)).fold(f64::NEG_INFINITY, f64::max);
        match body.cut(normal, offset, noise) {
            Some(cut) if cut.points.len() <= most => body = cut,
            _ => break,
        }
    }
    engine::hull(&body.points)
}

/// A convex body as flat faces; each lists its corners counter-clockwise, seen from outside.
struct Polytope {
    points: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
}

impl Polytope {
    fn of_box(bounds: &Bounds) -> Self {
        let pick = |bit: u32, k: u32, axis: usize| {
            if k & bit == 0 { bounds.min[axis] } else { bounds.max[axis] }
        };
        let points = (0..8).map(|k| DVec3::new(pick(1, k, 0), pick(2, k, 1), pick(4, k, 2))).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
            .map(Vec::from)
            .to_vec();
        Self { points, faces }
    }

    /// What lies below a plane; `None` where that is all of it, or nothing.
    fn cut(&self, normal: DVec3, offset: f64, noise: f64) -> Option<Self> {
        let side: Vec<f64> = self.points.iter().map(|point| point.dot(normal) - offset).collect();
        let inside = |corner: u32| side[corner as usize] <= noise;
        if (0..).zip(&self.points).all(|(corner, _)| inside(corner)) {
            return None;
        }
        let mut points = self.points.clone();
        let mut made: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut faces = Vec::new();
        // For each face that is cut, where its border comes back in, to where it went out.
        let mut rim: BTreeMap<u32, u32> = BTreeMap::new();
        for face in &self.faces {
            let (mut kept, mut out, mut back) = (Vec::new(), None, None);
            for (place, a) in face.iter().enumerate() {
                let b = face[(place + 1) % face.len()];
                if inside(*a) {
                    kept.push(*a);
                }
                if inside(*a) == inside(b) {
                    continue;
                }
                let key = (*a.min(&b), *a.max(&b));
                let new = *made.entry(key).or_insert_with(|| {
                    let (low, high) = (key.0 as usize, key.1 as usize);
                    let share = side[low] / (side[low] - side[high]);
                    points.push(self.points[low].lerp(self.points[high], share));
                    crate::geometry::mesh::index(points.len() - 1)
                });
                kept.push(new);
                if inside(*a) {
                    out = Some(new);
                } else {
                    back = Some(new);
                }
            }
            if let (Some(out), Some(back)) = (out, back) {
                rim.insert(back, out);
            }
            if kept.len() >= 3 {
                faces.push(kept);
            }
        }
        let first = *rim.keys().next()?;
        let mut cap = vec![first];
        while let Some(next) = rim.get(cap.last()?).copied().filter(|next| *next != first) {
            if cap.len() > rim.len() {
                return None;
            }
            cap.push(next);
        }
        if cap.len() != rim.len() || cap.len() < 3 {
            return None;
        }
        faces.push(cap);
        Some(Self { points, faces }.compacted())
    }

    /// Without points that no face uses.
    fn compacted(self) -> Self {
        let mut names: BTreeMap<u32, u32> = BTreeMap::new();
        let mut points = Vec::new();
        let mut name = |corner: u32| {
            *names.entry(corner).or_insert_with(|| {
                points.push(self.points[corner as usize]);
                crate::geometry::mesh::index(points.len() - 1)
            })
        };
        let faces = self.faces.iter().map(|face| face.iter().map(|corner| name(*corner)).collect()).collect();
        Self { points, faces }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{enclosing_capsule, enclosing_cylinder, enclosing_hull, enclosing_radius};

    /// Points on an ellipsoid.
    fn cloud() -> Vec<DVec3> {
        let part = |k: u32, step: u32| f64::from(k * step % 1009) / 504.5 - 1.0;
        let point = |k: u32| DVec3::new(part(k, 7), part(k, 31), part(k, 113)).normalize_or(DVec3::X);
        (1..1009).map(|k| point(k) * DVec3::new(1.0, 2.0, 0.5)).collect()
    }

    #[cfg(feature = "csg")]
    #[test]
    fn hulls_of_few_vertices_hold_all_points_and_come_nearer() {
        let cloud = cloud();
        let mut before = f64::INFINITY;
        for most in [8, 16, 32, 64, 128] {
            let (points, triangles) = enclosing_hull(&cloud, most).expect("a body");
            assert!(points.len() <= most, "{} of {most}", points.len());
            let place = |corner: u32| points[corner as usize];
            let volume: f64 =
                triangles.iter().map(|[a, b, c]| place(*a).dot(place(*b).cross(place(*c))) / 6.0).sum();
            for [a, b, c] in &triangles {
                let normal = (place(*b) - place(*a)).cross(place(*c) - place(*a));
                let outside = cloud.iter().map(|point| (*point - place(*a)).dot(normal)).fold(0.0, f64::max);
                assert!(outside <= 1e-8 * normal.length().max(1e-3), "{outside} with {most} vertices");
            }
            assert!(volume < before, "{volume} after {before}");
            before = volume;
        }
        // The ellipsoid itself has 4/3 pi.
        assert!(before > 4.0 && before < 4.6, "{before}");
    }

    #[test]
    fn round_bodies_hold_all_points_along_the_best_axis() {
        // Half axes of 1, 2 and 0.7: a cylinder along y has the least volume by far.
        let cloud: Vec<DVec3> = cloud().into_iter().map(|point| point * DVec3::new(1.0, 1.0, 1.4)).collect();
        let (capsule, cylinder) = (enclosing_capsule(&cloud), enclosing_cylinder(&cloud));
        assert_eq!((capsule.axis, cylinder.axis), (1, 1));
        for point in &cloud {
            let local = *point - capsule.center;
            let along = (local.y.abs() - capsule.height / 2.0).max(0.0);
            assert!(DVec3::new(local.x, along, local.z).length() <= capsule.radius * (1.0 + 1e-12));
            let local = *point - cylinder.center;
            assert!(local.y.abs() <= cylinder.height / 2.0 * (1.0 + 1e-12));
            assert!(DVec3::new(local.x, 0.0, local.z).length() <= cylinder.radius * (1.0 + 1e-12));
        }
        assert!(enclosing_radius(&cloud, DVec3::ZERO) <= 2.0);
    }
}
