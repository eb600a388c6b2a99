//! The plane that divides a body best.
//!
//! Planes along the axes, evenly, and at edges that lie inward the one that halves the angle and, where they are sharp, those of
//! the faces beside them. The best leaves the least volume between few pieces on both sides and their hulls; of several that leave about
//! as much, that which halves the body and makes short pieces of it: a ring is cut across, though its hulls are no smaller for
//! the first cut.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};

use super::{Hull, Part};
use crate::geometry::mesh::index;
use crate::geometry::number::Bounds;
use crate::geometry::solid::{HalfSpace, SolidFault};

/// Planes along each axis.
const EVENLY: u32 = 11;

/// Most planes at inward edges.
const AT_EDGES: usize = 36;

/// Cosine of the angle from which on an edge is one of two faces, not of one that bends: 30 degrees.
const SHARP: f64 = 0.866;

/// How much worse a plane counts that leaves all on one side than one that halves the body.
const UNEVEN: f64 = 0.2;

/// Part of the size within which a point lies on a plane.
const ON: f64 = 1e-9;

/// The best plane; none where no plane divides the body.
pub(super) fn best(part: &Part) -> Result<Option<HalfSpace>, SolidFault> {
    let planes = candidates(part);
    let directions = directions();
    let scores: Result<Vec<Option<f64>>, SolidFault> =
        planes.par_iter().map(|plane| score(part, plane, &directions)).collect();
    let scored = scores?.into_iter().zip(planes);
    let scored = scored.filter_map(|(score, plane)| Some((score?, plane)));
    Ok(scored.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, plane)| plane))
}

fn candidates(part: &Part) -> Vec<HalfSpace> {
    let bounds = Bounds::of_points(part.points.iter().copied());
    let mut planes = at_inward_edges(part, bounds.diagonal());
    for normal in [DVec3::X, DVec3::Y, DVec3::Z] {
        for step in 1..=EVENLY {
            let share = f64::from(step) / f64::from(EVENLY + 1);
            planes.push(HalfSpace { point: bounds.min.lerp(bounds.max, share), normal });
        }
    }
    planes
}

/// Planes at edges that lie inward, those of the longest and sharpest first.
fn at_inward_edges(part: &Part, size: f64) -> Vec<HalfSpace> {
    /// Part of the size, and of a unit normal, within which planes are one.
    const ALIKE: f64 = 1e-5;
    let corner = |point: u32| part.points[point as usize];
    let normal = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(corner);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut sides: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (number, [a, b, c]) in part.triangles.iter().enumerate() {
        sides.extend([((*a, *b), number), ((*b, *c), number), ((*c, *a), number)]);
    }
    #[expect(clippy::cast_possible_truncation, reason = "a key: what is too large is alike too")]
    let rounded = |value: f64| (value / ALIKE).round() as i64;
    let mut found: BTreeMap<[i64; 4], (f64, HalfSpace)> = BTreeMap::new();
    for ((from, to), one) in sides.iter().filter(|((from, to), _)| from < to) {
        let Some(other) = sides.get(&(*to, *from)) else { continue };
        let (one, other) = (&part.triangles[*one], &part.triangles[*other]);
        let (a, b) = (normal(one), normal(other));
        let apex = other.iter().find(|point| **point != *from && **point != *to);
        let height = apex.map_or(0.0, |apex| (corner(*apex) - corner(*from)).dot(a));
        if height <= 1e-6 * size {
            continue;
        }
        let weight = corner(*from).distance(corner(*to)) * a.cross(b).length();
        let across = (corner(*to) - corner(*from)).cross(a + b).normalize_or_zero();
        // Planes of faces that bend on would cut slivers off.
        let faces = if a.dot(b) < SHARP { [a, b] } else { [DVec3::ZERO; 2] };
        for normal in faces.into_iter().chain([across]).filter(|normal| *normal != DVec3::ZERO) {
            // One of two opposite normals.
            let turned =
                normal.to_array().iter().find(|part| part.abs() > ALIKE).is_some_and(|part| *part < 0.0);
            let normal = if turned { -normal } else { normal };
            let offset = normal.dot(corner(*from)) / size;
            let key = [rounded(normal.x), rounded(normal.y), rounded(normal.z), rounded(offset)];
            let plane = HalfSpace { point: corner(*from), normal };
            found.entry(key).or_insert((0.0, plane)).0 += weight;
        }
    }
    let mut planes: Vec<(f64, HalfSpace)> = found.into_values().collect();
    planes.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    planes.into_iter().take(AT_EDGES).map(|(_, plane)| plane).collect()
}

/// All directions of small whole numbers.
fn directions() -> Vec<DVec3> {
    let steps = [-2.0, -1.0, 0.0, 1.0, 2.0];
    let all = steps.iter().flat_map(|x| steps.iter().flat_map(move |y| steps.map(|z| DVec3::new(*x, *y, z))));
    // Those of even numbers are others twice as long.
    all.filter(|all| all.to_array().iter().any(|part| part.abs() == 1.0)).collect()
}

/// What lies on one side of a plane and hangs together.
struct Piece {
    /// The farthest place in each direction.
    extremes: Vec<(f64, DVec3)>,
}

impl Piece {
    fn reach(&mut self, place: DVec3, directions: &[DVec3]) {
        for (extreme, direction) in self.extremes.iter_mut().zip(directions) {
            let along = place.dot(*direction);
            if along > extreme.0 {
                *extreme = (along, place);
            }
        }
    }
}

/// How good a plane is, the less the better; none where it leaves all on one side.
///
/// The volume of a side is that of the cones from a point of the plane to its triangles: the cut itself adds none. The hulls
/// are those of the farthest places in some directions.
fn score(part: &Part, plane: &HalfSpace, directions: &[DVec3]) -> Result<Option<f64>, SolidFault> {
    let size = Bounds::of_points(part.points.iter().copied()).diagonal();
    let depth =
        |point: &DVec3| Some(plane.depth(*point)).filter(|depth| depth.abs() > ON * size).unwrap_or(0.0);
    let depths: Vec<f64> = part.points.iter().map(depth).collect();
    let roots = roots(part, &depths);
    let mut pieces: BTreeMap<u32, Piece> = BTreeMap::new();
    let mut reach = |point: u32, place: DVec3| {
        let none = || Piece { extremes: vec![(f64::NEG_INFINITY, DVec3::ZERO); directions.len()] };
        pieces.entry(roots[point as usize]).or_insert_with(none).reach(place, directions);
    };
    for (point, place) in (0..).zip(&part.points).filter(|(point, _)| depths[*point as usize] != 0.0) {
        reach(point, *place);
    }
    let mut inside = 0.0;
    for triangle in &part.triangles {
        let mut kept: Vec<DVec3> = Vec::with_capacity(4);
        for k in 0..3 {
            let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
            let (before, after) = (depths[from as usize], depths[to as usize]);
            let (start, end) = (part.points[from as usize], part.points[to as usize]);
            if before >= 0.0 {
                kept.push(start);
            }
            if before * after < 0.0 {
                let crossing = start.lerp(end, before / (before - after));
                kept.push(crossing);
                reach(from, crossing);
                reach(to, crossing);
            } else if before == 0.0 && after != 0.0 {
                reach(to, start);
            } else if before != 0.0 && after == 0.0 {
                reach(from, end);
            }
        }
        for k in 2..kept.len() {
            let across = (kept[k - 1] - kept[0]).cross(kept[k] - kept[0]);
            inside += across.dot(kept[0] - plane.point) / 6.0;
        }
    }
    let shares = [inside / part.volume, 1.0 - inside / part.volume];
    if shares.iter().any(|share| *share < 1e-6) {
        return Ok(None);
    }
    let (mut hulls, mut largest) = (0.0, 0.0_f64);
    for piece in pieces.values() {
        let places: Vec<DVec3> = piece.extremes.iter().map(|(_, place)| *place).collect();
        hulls += Hull::around(&places)?.map_or(0.0, |hull| hull.volume);
        largest = largest.max(Bounds::of_points(places).diagonal() / size);
    }
    // More pieces at once are no merit: as many cuts elsewhere do better. What curves leaves a fourth to twice the pieces.
    let many = f64::from(index(pieces.len()));
    let beyond = (hulls - part.volume).max(0.0) * many * many;
    Ok(Some(beyond * largest * (1.0 + UNEVEN * (shares[0] - shares[1]).abs())))
}

/// For each point one that it hangs together with on its side of a plane: the same for all of them. Points on the plane stay
/// by themselves.
fn roots(part: &Part, depths: &[f64]) -> Vec<u32> {
    let mut parents: Vec<u32> = (0..index(depths.len())).collect();
    fn root(parents: &mut [u32], mut of: u32) -> u32 {
        while parents[of as usize] != of {
            let above = parents[parents[of as usize] as usize];
            parents[of as usize] = above;
            of = above;
        }
        of
    }
    for [a, b, c] in &part.triangles {
        for (from, to) in [(*a, *b), (*b, *c), (*c, *a)] {
            if depths[from as usize] * depths[to as usize] > 0.0 {
                let (one, other) = (root(&mut parents, from), root(&mut parents, to));
                parents[one.max(other) as usize] = one.min(other);
            }
        }
    }
    (0..index(depths.len())).map(|point| root(&mut parents, point)).collect()
}
