//! The Laplacian of a surface of triangles, as finite elements have it.
//!
//! Promise: the matrix is symmetric, none of its eigenvalues is negative, and constants are its kernel on each part
//! that hangs together, whatever the triangles. A triangle that is nearly a line counts for less than it would, so that
//! no entry is very great. Not promised: entries of one sign; with obtuse angles on both sides of an edge a value can be
//! a little outside of those around it.
//!
//! Source: U. Pinkall, K. Polthier, Computing discrete minimal surfaces and their conjugates, 1993 (cotangents);
//! M. Meyer, M. Desbrun, P. Schröder, A. Barr, Discrete differential-geometry operators for triangulated
//! 2-manifolds, 2003 (areas of points).

use glam::DVec3;

/// What a surface does to numbers at its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Laplacian {
    /// Entries (row, column, value) of either half of the matrix, several at one place: half the cotangents, negative
    /// off the diagonal. Without unit.
    pub entries: Vec<(u32, u32, f64)>,
    /// For each point the area that is nearest to it, square metres; thirds of obtuse triangles go by halves and quarters.
    pub areas: Vec<f64>,
}

/// Twice a triangle's area, over its longest side squared, below which it counts as that wide.
const THIN: f64 = 1e-6;

/// The Laplacian of triangles. Linear.
#[must_use]
pub fn laplacian(points: &[DVec3], triangles: &[[u32; 3]]) -> Laplacian {
    let mut all =
        Laplacian { entries: Vec::with_capacity(6 * triangles.len()), areas: vec![0.0; points.len()] };
    for corners in triangles {
        let places = corners.map(|corner| points[corner as usize]);
        let sides = [0, 1, 2].map(|k| places[(k + 2) % 3] - places[(k + 1) % 3]);
        let squares = sides.map(DVec3::length_squared);
        let double = sides[0].cross(sides[1]).length();
        let wide = double.max(THIN * squares.into_iter().fold(0.0, f64::max));
        if wide <= 0.0 {
            continue;
        }
        // Of the angle opposite of side k.
        let cotangents = [0, 1, 2].map(|k| -sides[(k + 1) % 3].dot(sides[(k + 2) % 3]) / wide);
        let obtuse = cotangents.iter().position(|cotangent| *cotangent < 0.0);
        for k in 0..3 {
            let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let half = cotangents[k] / 2.0;
            all.entries.extend([(a, a, half), (b, b, half), (a, b, -half)]);
            all.areas[corners[k] as usize] += match obtuse {
                Some(at) if at == k => double / 4.0,
                Some(_) => double / 8.0,
                None => {
                    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                    (squares[next] * cotangents[next] + squares[last] * cotangents[last]) / 8.0
                }
            };
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::laplacian;

    /// What a function of the points becomes.
    fn applied(points: &[DVec3], triangles: &[[u32; 3]], of: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut sums = vec![0.0; points.len()];
        for (row, column, value) in laplacian(points, triangles).entries {
            let (row, column) = (row as usize, column as usize);
            sums[row] += value * of(points[column]);
            if row != column {
                sums[column] += value * of(points[row]);
            }
        }
        sums
    }

    /// A fan of six uneven triangles around the first point.
    fn fan() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let rim = [[1.0, 0.0], [0.4, 0.9], [-0.6, 0.7], [-1.1, -0.1], [-0.3, -0.8], [0.7, -0.9]];
        let points =
            std::iter::once(DVec3::new(0.1, 0.05, 0.0)).chain(rim.map(|[x, y]| DVec3::new(x, y, 0.0)));
        (points.collect(), (0..6).map(|k| [0, 1 + k, 1 + (k + 1) % 6]).collect())
    }

    #[test]
    fn linear_functions_on_a_plane_are_harmonic_inside() {
        let (points, triangles) = fan();
        let found = applied(&points, &triangles, |point| 3.0 * point.x - 2.0 * point.y + 1.0);
        assert!(found[0].abs() < 1e-14, "{found:?}");
        assert!(found.iter().sum::<f64>().abs() < 1e-14);
    }

    /// On one triangle the energy of a linear function is its slope squared times the area.
    #[test]
    fn the_energy_of_a_slope_is_its_square_times_the_area() {
        let (points, triangles) = fan();
        let slope = |point: DVec3| 3.0 * point.x - 2.0 * point.y;
        let energy: f64 =
            applied(&points, &triangles, slope).iter().zip(&points).map(|(l, p)| l * slope(*p)).sum();
        let area: f64 = laplacian(&points, &triangles).areas.iter().sum();
        let wanted: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| points[k as usize]);
                (b - a).cross(c - a).length() / 2.0
            })
            .sum();
        assert!((area - wanted).abs() < 1e-14 && (energy - 13.0 * area).abs() < 1e-12, "{energy} on {area}");
    }

    #[test]
    fn needles_and_lines_stay_finite_and_never_negative() {
        for thin in [0.0, 1e-300, 1e-12, 1e-3] {
            let points = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, thin, 0.0)];
            for of in [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, -2.0, 1.0]] {
                let value =
                    |point: DVec3| of[points.iter().position(|known| *known == point).expect("known")];
                let found = applied(&points, &[[0, 1, 2]], value);
                let energy: f64 = found.iter().zip(of).map(|(l, value)| l * value).sum();
                assert!(energy.is_finite() && energy >= -1e-9, "{energy} at {thin}");
            }
        }
        let one = laplacian(&[DVec3::X; 3], &[[0, 1, 2]]);
        assert!(one.entries.is_empty() && one.areas == [0.0; 3]);
    }
}
