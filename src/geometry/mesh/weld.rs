//! Joins points that are equal, or nearer to each other than a tolerance.
//!
//! The result names, for each point, the first point of its kind in the order given; it does not depend on hashing.

use std::collections::HashMap;

use glam::DVec3;

use crate::geometry::mesh::{PointIndex, PolygonMesh, index};

/// Points that remain and, for each point given, which of them it became.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Welded {
    /// The points that remain, in the order of their first use.
    pub points: Vec<DVec3>,
    /// For each point given, an index into `points`.
    pub map: Vec<u32>,
}

impl PolygonMesh {
    /// Joins points within `tolerance` metres of each other; see [`weld_near`]. Faces keep their corners, so some may
    /// become degenerate.
    pub fn weld(&mut self, tolerance: f64) {
        let welded = weld_near(&self.points, tolerance);
        self.points = welded.points;
        for corner in &mut self.corners {
            *corner = PointIndex(welded.map[corner.subscript()]);
        }
        let of = |point: PointIndex| PointIndex(welded.map[point.subscript()]);
        self.creases.iter_mut().for_each(|(ends, _)| *ends = ends.map(of));
        self.creases.retain(|([a, b], _)| a != b);
        self.sharp_points.iter_mut().for_each(|(point, _)| *point = of(*point));
    }
}

/// Joins points with equal coordinates (0 and -0 are equal). Linear.
#[must_use]
pub fn weld_equal(points: &[DVec3]) -> Welded {
    let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(points.len() / 4);
    let mut welded = Welded { points: Vec::new(), map: Vec::with_capacity(points.len()) };
    for &point in points {
        let point = point + DVec3::ZERO;
        let kept = *first.entry(point.to_array().map(f64::to_bits)).or_insert_with(|| {
            welded.points.push(point);
            index(welded.points.len() - 1)
        });
        welded.map.push(kept);
    }
    welded
}

/// Joins each point to the nearest kept point within `tolerance` metres of it; a point without one is kept. No two
/// kept points are within the tolerance, and no point moves further than it. Linear.
///
/// A tolerance of zero or less, or NaN, joins equal points only.
#[must_use]
pub fn weld_near(points: &[DVec3], tolerance: f64) -> Welded {
    if tolerance.is_nan() || tolerance <= 0.0 {
        return weld_equal(points);
    }
    let mut welded = Welded { points: Vec::new(), map: Vec::with_capacity(points.len()) };
    let mut cells: HashMap<[u64; 3], Vec<u32>> = HashMap::new();
    for &point in points {
        let cell = point / tolerance;
        let near = nearest_kept(&welded.points, &cells, (point, cell), tolerance);
        welded.map.push(near.unwrap_or_else(|| {
            let kept = index(welded.points.len());
            welded.points.push(point);
            cells.entry(cell_key(cell, DVec3::ZERO)).or_default().push(kept);
            kept
        }));
    }
    welded
}

fn nearest_kept(
    kept: &[DVec3],
    cells: &HashMap<[u64; 3], Vec<u32>>,
    (point, cell): (DVec3, DVec3),
    tolerance: f64,
) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for step in 0..27_u8 {
        let offset =
            DVec3::new(f64::from(step % 3), f64::from(step / 3 % 3), f64::from(step / 9)) - DVec3::ONE;
        for &other in cells.get(&cell_key(cell, offset)).into_iter().flatten() {
            let candidate = (kept[other as usize].distance(point), other);
            if candidate.0 <= tolerance && best.is_none_or(|best| candidate < best) {
                best = Some(candidate);
            }
        }
    }
    best.map(|(_, other)| other)
}

/// The cell as the bits of its whole coordinates: any size of number has a cell.
fn cell_key(cell: DVec3, offset: DVec3) -> [u64; 3] {
    (cell.floor() + offset + DVec3::ZERO).to_array().map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{weld_equal, weld_near};

    #[test]
    fn negative_zero_is_zero() {
        let welded = weld_equal(&[DVec3::ZERO, -DVec3::ZERO, DVec3::X]);
        assert_eq!(welded.map, [0, 0, 1]);
        assert_eq!(welded.points, [DVec3::ZERO, DVec3::X]);
    }

    #[test]
    fn near_points_join_across_cells() {
        for at in [0.0, 0.999_999, 1.0, -1.0, 1e6] {
            let points = [DVec3::splat(at), DVec3::splat(at + 0.5), DVec3::splat(at + 1.5)];
            assert_eq!(weld_near(&points, 1.0).map, [0, 0, 1], "at {at}");
        }
    }

    #[test]
    fn kept_points_are_apart_and_none_moves_far() {
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 40).expect("24 bits")) / 16_777_216.0
        };
        let points: Vec<DVec3> = (0..2000).map(|_| DVec3::new(random(), random(), random()) - 0.5).collect();
        let tolerance = 0.07;
        let welded = weld_near(&points, tolerance);
        for (point, &kept) in points.iter().zip(&welded.map) {
            assert!(point.distance(welded.points[kept as usize]) <= tolerance);
        }
        for (number, a) in welded.points.iter().enumerate() {
            assert!(welded.points[..number].iter().all(|b| a.distance(*b) > tolerance));
        }
        assert!(welded.points.len() > 100 && welded.points.len() < 1500, "{}", welded.points.len());
    }

    #[test]
    fn zero_tolerance_joins_equal_points_only() {
        let points = [DVec3::ZERO, DVec3::splat(f64::MIN_POSITIVE), DVec3::ZERO];
        assert_eq!(weld_near(&points, 0.0).map, [0, 1, 0]);
        assert_eq!(weld_near(&points, f64::NAN).map, [0, 1, 0]);
    }
}
