//! Principal axes of symmetric matrices.

use glam::{DMat3, DVec3};

/// Eigenvalues and eigenvectors of a symmetric matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalAxes {
    /// Eigenvalues, increasing.
    pub values: [f64; 3],
    /// Their unit eigenvectors as columns, right-handed.
    pub axes: DMat3,
}

/// The principal axes of a symmetric matrix, by Jacobi rotations: eigenvalues within a few units in the last place of
/// the largest, eigenvectors perpendicular to the same. A diagonal matrix keeps its axes to the bit. At most 16 sweeps
/// of three rotations; 6 or fewer are the rule.
///
/// Source: G. Golub, C. Van Loan, Matrix Computations, 4th ed. 2013, section 8.5.
#[must_use]
pub fn principal_axes(matrix: &DMat3) -> PrincipalAxes {
    let mut rows = [matrix.row(0).to_array(), matrix.row(1).to_array(), matrix.row(2).to_array()];
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..16 {
        let off = rows[0][1].abs() + rows[0][2].abs() + rows[1][2].abs();
        let size = rows[0][0].abs() + rows[1][1].abs() + rows[2][2].abs();
        if off <= f64::EPSILON * 1e-3 * size || off == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut rows, &mut axes, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| rows[*a][*a].total_cmp(&rows[*b][*b]));
    let values = order.map(|k| rows[k][k]);
    let [x, y, z] = order.map(|k| axes[k]);
    let z = if x.cross(y).dot(z) < 0.0 { -z } else { z };
    PrincipalAxes { values, axes: DMat3::from_cols(x, y, z) }
}

/// One rotation in the plane of axes p and q, which makes their common entry zero.
fn rotate(rows: &mut [[f64; 3]; 3], axes: &mut [DVec3; 3], p: usize, q: usize) {
    let entry = rows[p][q];
    if entry == 0.0 {
        return;
    }
    // The smaller of the two angles, by a form that does not cancel.
    let theta = (rows[q][q] - rows[p][p]) / (2.0 * entry);
    let t = theta.signum() / (theta.abs() + (1.0 + theta * theta).sqrt());
    let cos = 1.0 / (1.0 + t * t).sqrt();
    let sin = t * cos;
    let r = 3 - p - q;
    let (at_p, at_q) = (rows[r][p], rows[r][q]);
    rows[p][p] -= t * entry;
    rows[q][q] += t * entry;
    (rows[p][q], rows[q][p]) = (0.0, 0.0);
    let (new_p, new_q) = (cos * at_p - sin * at_q, sin * at_p + cos * at_q);
    (rows[r][p], rows[p][r]) = (new_p, new_p);
    (rows[r][q], rows[q][r]) = (new_q, new_q);
    (axes[p], axes[q]) = (axes[p] * cos - axes[q] * sin, axes[p] * sin + axes[q] * cos);
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::principal_axes;

    #[test]
    fn axes_diagonalize() {
        for seed in 0..200 {
            let entry = |k: i32| f64::from((seed * 7919 + k * 104_729) % 2001 - 1000) / 100.0;
            let (a, b, c, d, e, f) = (entry(1), entry(2), entry(3), entry(4), entry(5), entry(6));
            let scale = if seed % 3 == 0 { 1e-9 } else { 1.0 };
            let matrix = DMat3::from_cols(
                DVec3::new(a, d, e),
                DVec3::new(d, b, f * scale),
                DVec3::new(e, f * scale, c),
            );
            let found = principal_axes(&matrix);
            assert!(found.values.windows(2).all(|pair| pair[0] <= pair[1]));
            assert!((found.axes.determinant() - 1.0).abs() < 1e-14);
            let size = matrix.to_cols_array().iter().map(|x| x.abs()).fold(0.0, f64::max);
            for k in 0..3 {
                let axis = found.axes.col(k);
                assert!((matrix * axis).distance(axis * found.values[k]) < 4e-15 * size, "{seed}");
            }
        }
    }

    #[test]
    fn diagonal_matrices_keep_their_axes() {
        let found = principal_axes(&DMat3::from_diagonal(DVec3::new(3.0, 1.0, 2.0)));
        assert_eq!(found.values, [1.0, 2.0, 3.0]);
        assert_eq!(found.axes.x_axis, DVec3::Y);
        assert_eq!(found.axes.z_axis, DVec3::X);
        let round = principal_axes(&DMat3::IDENTITY);
        assert_eq!(round.axes, DMat3::IDENTITY);
    }
}
