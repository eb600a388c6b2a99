//! Polynomials in Bernstein form over 0 to 1: n + 1 control points for degree n.

use super::{Control, between};

/// Degrees below this need no allocation.
const INLINE: usize = 8;

/// Runs `work` on a copy of the control points.
#[inline]
fn with_copy<P: Control, R>(control: &[P], work: impl FnOnce(&mut [P]) -> R) -> R {
    if control.len() <= INLINE {
        let mut copy = [P::default(); INLINE];
        copy[..control.len()].copy_from_slice(control);
        work(&mut copy[..control.len()])
    } else {
        work(&mut control.to_vec())
    }
}

/// The point at `t` by de Casteljau's scheme: O(degree^2), stable, exact at both ends.
#[must_use]
pub fn de_casteljau<P: Control>(control: &[P], t: f64) -> P {
    with_copy(control, |b| {
        for level in (1..b.len()).rev() {
            for k in 0..level {
                b[k] = between(b[k], b[k + 1], t);
            }
        }
        b[0]
    })
}

/// Value, first and second derivative at `t`, by de Casteljau's scheme: the last levels hold the derivatives.
#[inline]
#[must_use]
pub fn jet<P: Control>(control: &[P], t: f64) -> [P; 3] {
    match control {
        [a, b, c, d] => cubic([*a, *b, *c, *d], t),
        [a, b, c] => quadratic([*a, *b, *c], t),
        _ => any_jet(control, t),
    }
}

#[inline]
fn cubic<P: Control>([a, b, c, d]: [P; 4], t: f64) -> [P; 3] {
    let (a1, b1, c1) = (between(a, b, t), between(b, c, t), between(c, d, t));
    let (a2, b2) = (between(a1, b1, t), between(b1, c1, t));
    [between(a2, b2, t), (b2 - a2) * 3.0, ((c1 - b1) - (b1 - a1)) * 6.0]
}

#[inline]
fn quadratic<P: Control>([a, b, c]: [P; 3], t: f64) -> [P; 3] {
    let (a1, b1) = (between(a, b, t), between(b, c, t));
    [between(a1, b1, t), (b1 - a1) * 2.0, ((c - b) - (b - a)) * 2.0]
}

fn any_jet<P: Control>(control: &[P], t: f64) -> [P; 3] {
    with_copy(control, |b| {
        let degree = b.len() - 1;
        let (mut first, mut second) = (P::default(), P::default());
        for level in (1..=degree).rev() {
            if level == 2 {
                second = ((b[2] - b[1]) - (b[1] - b[0])) * (degree * (degree - 1)) as f64;
            }
            if level == 1 {
                first = (b[1] - b[0]) * degree as f64;
            }
            for k in 0..level {
                b[k] = between(b[k], b[k + 1], t);
            }
        }
        [b[0], first, second]
    })
}

/// Control points of the two parts before and after `t`, by de Casteljau's scheme.
#[must_use]
pub fn split<P: Control>(control: &[P], t: f64) -> (Vec<P>, Vec<P>) {
    let mut right = control.to_vec();
    let mut left = vec![right[0]];
    for level in (1..right.len()).rev() {
        for k in 0..level {
            right[k] = between(right[k], right[k + 1], t);
        }
        left.push(right[0]);
    }
    (left, right)
}

/// Replaces control points by those of the part from `from` to `to` (0 to 1), by two de Casteljau cuts.
pub fn restrict<P: Control>(control: &mut [P], from: f64, to: f64) {
    let degree = control.len() - 1;
    if to < 1.0 {
        for level in 1..=degree {
            for k in (level..=degree).rev() {
                control[k] = between(control[k - 1], control[k], to);
            }
        }
    }
    if from > 0.0 && to > 0.0 {
        let cut = from / to;
        for level in 1..=degree {
            for k in 0..=degree - level {
                control[k] = between(control[k], control[k + 1], cut);
            }
        }
    }
}

/// Runs `work` on the control points of the part from `from` to `to`.
pub(crate) fn with_part<P: Control, R>(
    control: &[P],
    (from, to): (f64, f64),
    work: impl FnOnce(&[P]) -> R,
) -> R {
    with_copy(control, |part| {
        restrict(part, from, to);
        work(part)
    })
}

/// The same curve with one control point more.
///
/// Source: A. Forrest, Interactive interpolation and approximation by Bezier polynomials, 1972.
#[must_use]
pub fn elevate<P: Control>(control: &[P]) -> Vec<P> {
    let count = control.len();
    let inner = (1..count).map(|k| between(control[k], control[k - 1], k as f64 / count as f64));
    std::iter::once(control[0]).chain(inner).chain(std::iter::once(control[count - 1])).collect()
}

/// The derivative in Bernstein form: one degree lower. Empty for a single point.
#[must_use]
pub fn hodograph<P: Control>(control: &[P]) -> Vec<P> {
    let degree = control.len() - 1;
    control.windows(2).map(|pair| (pair[1] - pair[0]) * degree as f64).collect()
}

/// `n` over `k`; exact up to n = 56.
#[must_use]
pub fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64)
}

/// The product of two polynomials in Bernstein form; degrees add.
#[must_use]
pub fn product<P: Control>(points: &[P], numbers: &[f64]) -> Vec<P> {
    let (m, n) = (points.len() - 1, numbers.len() - 1);
    let mut sum = vec![P::default(); m + n + 1];
    for (i, point) in points.iter().enumerate() {
        for (j, number) in numbers.iter().enumerate() {
            let share = binomial(m, i) * binomial(n, j) / binomial(m + n, i + j);
            sum[i + j] = sum[i + j] + *point * (share * number);
        }
    }
    sum
}

/// Coefficients of 1, t, t^2, ... from control points.
///
/// Where the curve is small against its distance from the origin digits cancel, as in every power form.
#[must_use]
pub fn to_power<P: Control>(control: &[P]) -> Vec<P> {
    let degree = control.len() - 1;
    let mut differences = control.to_vec();
    let mut coefficients = Vec::with_capacity(control.len());
    for order in 0..=degree {
        coefficients.push(differences[0] * binomial(degree, order));
        differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    coefficients
}

/// Control points from the coefficients of 1, t, t^2, ...
#[must_use]
pub fn from_power<P: Control>(coefficients: &[P]) -> Vec<P> {
    let degree = coefficients.len() - 1;
    let point = |i: usize| {
        let share = |j: usize| coefficients[j] * (binomial(i, j) / binomial(degree, j));
        (0..=i).map(share).fold(P::default(), |sum, part| sum + part)
    };
    (0..=degree).map(point).collect()
}

/// The value at `t` of a polynomial by its coefficients of 1, t, t^2, ..., by Horner's scheme: O(degree).
#[must_use]
pub fn horner<P: Control>(coefficients: &[P], t: f64) -> P {
    coefficients.iter().rev().fold(P::default(), |sum, coefficient| sum * t + *coefficient)
}

/// The values at 0, 1 / steps, ..., 1 of a polynomial by its coefficients, by forward differences: `degree`
/// additions a point. Rounding grows as steps^degree; for many steps of a high degree use [`horner`].
///
/// The difference of order j at 0 of t^k with step d is d^k j! S(k, j), with Stirling's numbers of the second
/// kind S. Source: J. Foley, A. van Dam et al., Computer Graphics, 2nd ed. 1990, 11.2.9.
#[must_use]
pub fn evenly<P: Control>(coefficients: &[P], steps: u32) -> Vec<P> {
    let count = coefficients.len();
    let step = 1.0 / f64::from(steps);
    let mut differences = vec![P::default(); count];
    // Row k of j! S(k, j), from row k - 1: j (S'(k - 1, j) + S'(k - 1, j - 1)).
    let mut surjections = vec![0.0; count];
    surjections[0] = 1.0;
    let mut power = 1.0;
    for coefficient in coefficients {
        for (difference, number) in differences.iter_mut().zip(&surjections) {
            *difference = *difference + *coefficient * (power * number);
        }
        for j in (0..count).rev() {
            let below = if j > 0 { surjections[j - 1] } else { 0.0 };
            surjections[j] = j as f64 * (surjections[j] + below);
        }
        power *= step;
    }
    let mut values = vec![differences[0]];
    for _ in 0..steps {
        for j in 0..count - 1 {
            differences[j] = differences[j] + differences[j + 1];
        }
        values.push(differences[0]);
    }
    values
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{
        de_casteljau, elevate, evenly, from_power, hodograph, horner, jet, product, restrict, split, to_power,
    };

    /// Control points that no symmetry hides behind.
    fn control(degree: usize) -> Vec<DVec3> {
        let number = |k: usize| ((k * k * 7 + k * 3 + 1) % 11) as f64 - 4.0;
        (0..=degree).map(|k| DVec3::new(k as f64, number(k), number(k + 5) * 0.5)).collect()
    }

    fn assert_near(a: DVec3, b: DVec3, allowed: f64) {
        assert!(a.distance(b) <= allowed, "{a} is not {b}");
    }

    #[test]
    fn four_ways_of_evaluating_agree() {
        for degree in 1..=9 {
            let b = control(degree);
            let power = to_power(&b);
            let even = evenly(&power, 40);
            for (step, stepped) in even.iter().enumerate() {
                let t = step as f64 / 40.0;
                let point = de_casteljau(&b, t);
                assert_near(jet(&b, t)[0], point, 1e-14 * 10.0);
                // Power coefficients grow as 2^degree binomials; forward differences lose steps^degree more.
                let growth = power.iter().map(|c| c.length()).sum::<f64>() * 1e-16;
                assert_near(horner(&power, t), point, 10.0 * growth);
                let growth = growth * (0..degree).map(|_| 6.0).product::<f64>();
                assert_near(*stepped, point, 10.0 * growth);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_the_hodograph() {
        for degree in 1..=9 {
            let b = control(degree);
            let first = hodograph(&b);
            for t in [0.0, 0.3, 0.5, 0.77, 1.0] {
                let [_, d1, d2] = jet(&b, t);
                assert_near(d1, de_casteljau(&first, t), 1e-12);
                if degree > 1 {
                    assert_near(d2, de_casteljau(&hodograph(&first), t), 1e-11);
                } else {
                    assert_eq!(d2, DVec3::ZERO);
                }
            }
        }
    }

    #[test]
    fn parts_higher_degrees_and_powers_are_the_same_curve() {
        for degree in 1..=9 {
            let b = control(degree);
            let raised = elevate(&elevate(&b));
            assert_eq!(raised.len(), degree + 3);
            let back = from_power(&to_power(&b));
            let (left, right) = split(&b, 0.3);
            let mut part = b.clone();
            restrict(&mut part, 0.3, 0.9);
            for step in 0..=10 {
                let t = f64::from(step) / 10.0;
                assert_near(de_casteljau(&raised, t), de_casteljau(&b, t), 1e-13);
                assert_near(de_casteljau(&back, t), de_casteljau(&b, t), 1e-11);
                assert_near(de_casteljau(&left, t), de_casteljau(&b, 0.3 * t), 1e-13);
                assert_near(de_casteljau(&right, t), de_casteljau(&b, 0.3 + 0.7 * t), 1e-13);
                assert_near(de_casteljau(&part, t), de_casteljau(&b, 0.3 + 0.6 * t), 1e-13);
            }
        }
    }

    #[test]
    fn products_multiply_values() {
        let (points, numbers) = (control(4), [1.0, -2.0, 0.5]);
        let both = product(&points, &numbers);
        assert_eq!(both.len(), 7);
        for step in 0..=10 {
            let t = f64::from(step) / 10.0;
            assert_near(
                de_casteljau(&both, t),
                de_casteljau(&points, t) * de_casteljau(&numbers, t),
                1e-13 * 10.0,
            );
        }
    }

    /// The third forward difference of a t^3 is 6 a d^3.
    #[test]
    fn forward_differences_of_a_cube() {
        let values = evenly(&[0.0, 0.0, 0.0, 5.0], 4);
        assert_eq!(values, [0.0, 5.0 / 64.0, 40.0 / 64.0, 135.0 / 64.0, 5.0]);
    }
}
