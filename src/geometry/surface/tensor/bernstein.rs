//! Bernstein polynomials and what they make of the control points of one piece.

use crate::geometry::curve::control::Control;

/// The highest degree in each direction. Beyond it control points of common size say nothing in double
/// precision: binomial coefficients alone take half of the digits.
pub const MOST_DEGREE: usize = 25;

/// The Bernstein polynomials of one degree at one place, with derivatives.
pub(super) struct Basis {
    values: [f64; MOST_DEGREE + 1],
    first: [f64; MOST_DEGREE + 1],
    second: [f64; MOST_DEGREE + 1],
    count: usize,
}

impl Basis {
    /// By the recursion of de Casteljau: O(degree^2), no value is negative and they add to 1.
    pub(super) fn new(degree: usize, t: f64) -> Self {
        let mut basis = Self {
            values: [0.0; MOST_DEGREE + 1],
            first: [0.0; MOST_DEGREE + 1],
            second: [0.0; MOST_DEGREE + 1],
            count: degree + 1,
        };
        let values = &mut basis.values;
        values[0] = 1.0;
        for level in 1..=degree {
            if level + 1 == degree {
                differences::<2>(&values[..level], (degree * (degree - 1)) as f64, &mut basis.second);
            }
            if level == degree {
                differences::<1>(&values[..level], degree as f64, &mut basis.first);
            }
            for k in (0..=level).rev() {
                let below = if k > 0 { values[k - 1] * t } else { 0.0 };
                let beside = if k < level { values[k] * (1.0 - t) } else { 0.0 };
                values[k] = beside + below;
            }
        }
        basis
    }

    fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }

    fn first(&self) -> &[f64] {
        &self.first[..self.count]
    }

    fn second(&self) -> &[f64] {
        &self.second[..self.count]
    }
}

/// Derivatives of the polynomials `ORDER` degrees higher, from the values of these.
fn differences<const ORDER: usize>(values: &[f64], factor: f64, result: &mut [f64; MOST_DEGREE + 1]) {
    let signs: &[f64] = if ORDER == 1 { &[-1.0, 1.0] } else { &[1.0, -2.0, 1.0] };
    for (k, value) in values.iter().enumerate() {
        for (shift, sign) in signs.iter().enumerate() {
            result[k + shift] += factor * sign * value;
        }
    }
}

/// Value and derivatives by u and v at local parameters of a piece with rows of `degree.0 + 1` points.
#[inline]
pub(super) fn jet<P: Control>(control: &[P], degree: (usize, usize), u: f64, v: f64) -> [P; 3] {
    match degree {
        (3, 3) => {
            let (cubic_u, cubic_v) = (cubic(u), cubic(v));
            combine::<P, 4>(control, (&cubic_u.0, &cubic_u.1), (&cubic_v.0, &cubic_v.1))
        }
        (2, 2) => {
            let (square_u, square_v) = (quadratic(u), quadratic(v));
            combine::<P, 3>(control, (&square_u.0, &square_u.1), (&square_v.0, &square_v.1))
        }
        (p, q) => {
            let (along, across) = (Basis::new(p, u), Basis::new(q, v));
            sums(control, (along.values(), along.first()), (across.values(), across.first()))
        }
    }
}

fn cubic(t: f64) -> ([f64; 4], [f64; 4]) {
    let s = 1.0 - t;
    let (ss, st, tt) = (s * s, s * t, t * t);
    (
        [ss * s, 3.0 * ss * t, 3.0 * s * tt, tt * t],
        [-3.0 * ss, 3.0 * (ss - 2.0 * st), 3.0 * (2.0 * st - tt), 3.0 * tt],
    )
}

fn quadratic(t: f64) -> ([f64; 3], [f64; 3]) {
    let s = 1.0 - t;
    ([s * s, 2.0 * s * t, t * t], [-2.0 * s, 2.0 * (s - t), 2.0 * t])
}

/// [`sums`] for a number of points that the compiler knows.
#[inline]
fn combine<P: Control, const N: usize>(
    control: &[P],
    u: (&[f64; N], &[f64; N]),
    v: (&[f64; N], &[f64; N]),
) -> [P; 3] {
    sums(&control[..N * N], (u.0, u.1), (v.0, v.1))
}

#[inline]
fn sums<P: Control>(control: &[P], u: (&[f64], &[f64]), v: (&[f64], &[f64])) -> [P; 3] {
    let [mut point, mut by_u, mut by_v] = [P::default(); 3];
    for (row, (value, slope)) in control.chunks_exact(u.0.len()).zip(v.0.iter().zip(v.1)) {
        let (along, onward) = (weighed(row, u.0), weighed(row, u.1));
        point = point + along * *value;
        by_u = by_u + onward * *value;
        by_v = by_v + along * *slope;
    }
    [point, by_u, by_v]
}

#[inline]
fn weighed<P: Control>(row: &[P], weights: &[f64]) -> P {
    row.iter().zip(weights).fold(P::default(), |sum, (point, weight)| sum + *point * *weight)
}

/// Second derivatives twice by u, by u and v, and twice by v.
pub(super) fn second<P: Control>(control: &[P], degree: (usize, usize), u: f64, v: f64) -> [P; 3] {
    let (along, across) = (Basis::new(degree.0, u), Basis::new(degree.1, v));
    let [mut uu, mut uv, mut vv] = [P::default(); 3];
    for (j, row) in control.chunks_exact(degree.0 + 1).enumerate() {
        uu = uu + weighed(row, along.second()) * across.values()[j];
        uv = uv + weighed(row, along.first()) * across.first()[j];
        vv = vv + weighed(row, along.values()) * across.second()[j];
    }
    [uu, uv, vv]
}

#[cfg(test)]
mod tests {
    use super::{Basis, MOST_DEGREE, cubic, quadratic};
    use crate::geometry::curve::control::binomial;

    /// t^n without a power function.
    fn power(t: f64, n: usize) -> f64 {
        (0..n).fold(1.0, |product, _| product * t)
    }

    #[test]
    fn polynomials_are_those_of_bernstein() {
        for degree in 1..=MOST_DEGREE {
            for step in 0..=8 {
                let t = f64::from(step) / 8.0;
                let of = |n: usize, k: Option<usize>| match k {
                    Some(k) if k <= n => binomial(n, k) * power(t, k) * power(1.0 - t, n - k),
                    _ => 0.0,
                };
                let basis = Basis::new(degree, t);
                let n = degree as f64;
                for k in 0..=degree {
                    let below = |down: usize, shift: usize| match degree.checked_sub(down) {
                        Some(lower) => of(lower, k.checked_sub(shift)),
                        None => 0.0,
                    };
                    assert!((basis.values()[k] - below(0, 0)).abs() < 1e-14);
                    let first = n * (below(1, 1) - below(1, 0));
                    assert!((basis.first()[k] - first).abs() < 1e-14 * n);
                    let second = n * (n - 1.0) * (below(2, 2) - 2.0 * below(2, 1) + below(2, 0));
                    assert!((basis.second()[k] - second).abs() < 1e-14 * n * n);
                }
            }
        }
    }

    #[test]
    fn short_cuts_are_the_same_polynomials() {
        for step in 0..=16 {
            let t = f64::from(step) / 16.0;
            let (three, two) = (Basis::new(3, t), Basis::new(2, t));
            let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15 * 8.0);
            assert!(same(&cubic(t).0, three.values()) && same(&cubic(t).1, three.first()));
            assert!(same(&quadratic(t).0, two.values()) && same(&quadratic(t).1, two.first()));
        }
    }
}
