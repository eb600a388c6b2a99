//! Parameters that an affine map of the points does not change.
//!
//! Distances are measured in the norm of the points themselves: with V their covariance, the square of d is
//! d V^-1 d. Steps are these distances, longer where the polygon turns. Sources: G. Nielsen, Coordinate free
//! scattered data interpolation, 1987; G. Nielsen, T. Foley, A survey of applications of an affine invariant norm,
//! in Mathematical Methods in CAGD, 1989; T. Foley, Interpolation with interval and point tension controls using
//! cubic weighted nu-splines, ACM TOMS 13 (1987).

use glam::{DMat3, DVec3};

use super::spline::SplineError;
use crate::geometry::number::atan2;

/// Steps between neighbouring points, back to the first too when `closed`. Cost: O(points).
///
/// # Errors
/// When two neighbouring points are equal.
pub(super) fn steps(points: &[DVec3], closed: bool) -> Result<Vec<f64>, SplineError> {
    let norm = Norm::of(points);
    let count = points.len();
    let steps = if closed { count } else { count - 1 };
    let ways: Vec<DVec3> = (0..steps).map(|k| norm.whiten(points[(k + 1) % count] - points[k])).collect();
    let distances: Vec<f64> = ways.iter().map(|way| way.length()).collect();
    if let Some(first) = distances.iter().position(|distance| *distance == 0.0) {
        return Err(SplineError::Repeated { first, second: (first + 1) % count });
    }
    // What the turn between two steps adds to both, before it is shared between them.
    let bent = |before: usize, after: usize| {
        let (one, other) = (ways[before], ways[after]);
        1.5 * atan2(one.cross(other).length(), one.dot(other)).min(core::f64::consts::FRAC_PI_2)
    };
    let step = |k: usize| {
        let own = distances[k];
        let before = (k > 0).then(|| k - 1).or(closed.then_some(steps - 1));
        let after = (k + 1 < steps).then_some(k + 1).or(closed.then_some(0));
        let share = |neighbor: usize, turn: f64| turn * distances[neighbor] / (distances[neighbor] + own);
        let first = before.map_or(0.0, |before| share(before, bent(before, k)));
        let last = after.map_or(0.0, |after| share(after, bent(k, after)));
        own * (1.0 + first + last)
    };
    Ok((0..steps).map(step).collect())
}

/// The norm of a set of points, in the plane or line they span where they do not fill space.
struct Norm {
    /// Rows of a factor L^-1 of the covariance V = L L^T, on the pivot axes.
    rows: [DVec3; 3],
}

impl Norm {
    fn of(points: &[DVec3]) -> Self {
        let mean = points.iter().copied().sum::<DVec3>() / points.len() as f64;
        let outer = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
        let sum = points.iter().fold(DMat3::ZERO, |sum, point| sum + outer(*point - mean));
        let mut left = (sum * (1.0 / points.len() as f64)).to_cols_array_2d();
        // Cholesky's factorization with pivots: each step takes out the axis that is left with the greatest
        // variance. On the span of the points the axes taken determine the others, so they alone measure.
        const LOST: f64 = 1e-14;
        let whole = left[0][0] + left[1][1] + left[2][2];
        let mut rows = [DVec3::ZERO; 3];
        for step in 0..3 {
            let pivot = (0..3).max_by(|a, b| left[*a][*a].total_cmp(&left[*b][*b])).unwrap_or(0);
            let variance = left[pivot][pivot];
            if variance <= LOST * whole || variance == 0.0 {
                break;
            }
            // What is left of a vector's pivot entry after the earlier steps, in standard deviations.
            let mut row = DVec3::ZERO;
            row[pivot] = 1.0;
            for earlier in &rows[..step] {
                let along = covariance(&sum, points.len(), *earlier, DVec3::AXES[pivot]);
                row -= *earlier * along;
            }
            rows[step] = row / variance.sqrt();
            let column = [left[0][pivot], left[1][pivot], left[2][pivot]];
            for i in 0..3 {
                for j in 0..3 {
                    left[i][j] -= column[i] * column[j] / variance;
                }
            }
        }
        Self { rows }
    }

    /// The vector in coordinates in which the points have unit variance along every axis.
    fn whiten(&self, vector: DVec3) -> DVec3 {
        DVec3::from_array(self.rows.map(|row| row.dot(vector)))
    }
}

/// The covariance of the points along two directions.
fn covariance(sum: &DMat3, count: usize, a: DVec3, b: DVec3) -> f64 {
    a.dot(*sum * b) / count as f64
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::{Norm, steps};

    const POINTS: [DVec3; 6] = [
        DVec3::new(0.0, 0.0, 0.0),
        DVec3::new(1.0, 2.0, 0.5),
        DVec3::new(3.0, 2.5, 1.0),
        DVec3::new(3.5, 0.5, 2.0),
        DVec3::new(6.0, 1.0, 0.0),
        DVec3::new(6.5, 1.25, 0.5),
    ];

    fn map() -> DMat3 {
        DMat3::from_cols(DVec3::new(30.0, 2.0, 0.0), DVec3::new(-7.0, 0.5, 0.1), DVec3::new(0.3, 0.0, 2.0))
    }

    #[test]
    fn affine_maps_do_not_change_the_steps() {
        let flat = POINTS.map(|p| DVec3::new(p.x, p.y, 0.0));
        let straight = POINTS.map(|p| DVec3::new(p.x, 2.0 * p.x, -p.x));
        for points in [POINTS, flat, straight] {
            for closed in [false, true] {
                let own = steps(&points, closed).unwrap();
                let moved = points.map(|p| map() * p + DVec3::new(5.0, -3.0, 2.0));
                let other = steps(&moved, closed).unwrap();
                assert_eq!(own.len(), if closed { 6 } else { 5 });
                for (a, b) in own.iter().zip(&other) {
                    assert!((a / b - 1.0).abs() < 1e-9, "{own:?} became {other:?}");
                }
            }
        }
    }

    /// The norm whitens: in it the points have unit variance along each of their axes.
    #[test]
    fn points_have_unit_variance_in_their_own_norm() {
        let mean = POINTS.iter().copied().sum::<DVec3>() / 6.0;
        let norm = Norm::of(&POINTS);
        let variance = POINTS.iter().map(|p| norm.whiten(*p - mean).length_squared()).sum::<f64>() / 6.0;
        assert!((variance - 3.0).abs() < 1e-12, "{variance}");
    }

    /// On a line nothing turns: the steps are the distances, by the deviation.
    #[test]
    fn on_a_line_steps_are_distances() {
        let line = [0.0, 1.0, 3.0, 3.5].map(|x| DVec3::new(x, 2.0 * x, 0.0));
        let found = steps(&line, false).unwrap();
        assert!((found[1] / found[0] - 2.0).abs() < 1e-12 && (found[2] / found[0] - 0.5).abs() < 1e-12);
    }

    /// Where the way turns by a quarter or more, equal steps grow by 1.5 pi / 2 halves: Foley's formula.
    #[test]
    fn turns_lengthen_the_steps_beside_them() {
        let corner = [DVec3::ZERO, DVec3::X, DVec3::ONE - DVec3::Z, DVec3::new(0.0, 1.0, 0.0)];
        let found = steps(&corner, false).unwrap();
        // The covariance of a square's corners is a multiple of the identity, so angles are the true ones.
        let turn = 0.75 * core::f64::consts::FRAC_PI_2;
        assert!((found[0] / 2.0 - (1.0 + turn)).abs() < 1e-12, "{found:?}");
        assert!((found[1] / 2.0 - (1.0 + 2.0 * turn)).abs() < 1e-12, "{found:?}");
    }
}
