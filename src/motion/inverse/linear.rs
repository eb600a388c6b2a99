//! The damped step: the shortest one, in eased freedoms, that takes off most of the residual.

/// With J the rows and E the eases, -E Jᵀ (J E Jᵀ + d I)⁻¹ r, by Cholesky's factorization of a matrix as large as the
/// residual. O(rows² * columns).
pub(super) fn damped(rows: &[Vec<f64>], residual: &[f64], eases: &[f64], damping: f64) -> Vec<f64> {
    let count = rows.len();
    let mut matrix = vec![vec![0.0; count]; count];
    for i in 0..count {
        for j in 0..=i {
            let products = rows[i].iter().zip(&rows[j]).zip(eases);
            matrix[i][j] = products.map(|((a, b), ease)| a * b * ease).sum();
        }
        matrix[i][i] += damping;
    }
    let solved = solve(matrix, residual);
    let mut step = vec![0.0; eases.len()];
    for (row, share) in rows.iter().zip(&solved) {
        for ((part, slope), ease) in step.iter_mut().zip(row).zip(eases) {
            *part -= ease * slope * share;
        }
    }
    step
}

/// The solution of a system whose matrix is symmetric and positive; its lower half is given.
fn solve(mut lower: Vec<Vec<f64>>, right: &[f64]) -> Vec<f64> {
    let count = right.len();
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = lower[i][j] - known;
            // Damping keeps it above zero; rounding may not.
            lower[i][j] = if i == j { rest.max(1e-300).sqrt() } else { rest / lower[j][j] };
        }
    }
    let mut found = right.to_vec();
    for i in 0..count {
        let known: f64 = (0..i).map(|k| lower[i][k] * found[k]).sum();
        found[i] = (found[i] - known) / lower[i][i];
    }
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| lower[k][i] * found[k]).sum();
        found[i] = (found[i] - known) / lower[i][i];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{damped, solve};

    #[test]
    fn a_symmetric_system_is_solved() {
        let lower = vec![vec![4.0], vec![2.0, 5.0], vec![-1.0, 0.5, 3.0]];
        let full = [[4.0, 2.0, -1.0], [2.0, 5.0, 0.5], [-1.0, 0.5, 3.0]];
        let padded = lower
            .into_iter()
            .map(|mut row| {
                row.resize(3, 0.0);
                row
            })
            .collect();
        let found = solve(padded, &[1.0, -2.0, 3.0]);
        for (row, right) in full.iter().zip([1.0, -2.0, 3.0]) {
            let sum: f64 = row.iter().zip(&found).map(|(a, b)| a * b).sum();
            assert!((sum - right).abs() < 1e-14);
        }
    }

    #[test]
    fn without_damping_the_residual_goes_and_stiff_ones_move_less() {
        let step = damped(&[vec![1.0, 1.0]], &[3.0], &[1.0, 0.5], 1e-15);
        assert!((step[0] + 2.0).abs() < 1e-12 && (step[1] + 1.0).abs() < 1e-12, "{step:?}");
        assert_eq!(damped(&[vec![1.0, 1.0]], &[3.0], &[1.0, 0.0], 1e-15)[1], 0.0);
    }
}
