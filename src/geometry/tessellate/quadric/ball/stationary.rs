//! Where a polynomial of the second degree is stationary on the unit sphere.
//!
//! At such a place n the gradient points along n: (A - m I) n = -g for some number m, and the length of n is 1. The square
//! of the length is a sum of three convex terms of m with poles at the eigenvalues of A, so that each interval between
//! poles holds at most two roots, and those beyond them one each: all of them are found by bisection. Source:
//! G. Forsythe, G. Golub, On the stationary values of a second-degree polynomial on the unit sphere, J. SIAM 13 (1965).
//!
//! Promise: of each place where the polynomial is least or greatest within a region of the sphere one point, to about
//! a millionth; where there is a circle of such places, at least one point of it.

use glam::{DMat3, DVec3};

use crate::geometry::number::principal_axes;

/// Components of g that are smaller count as this share of all: the polynomial then changes less than can be seen, and
/// no root falls on a pole.
const LEAST: f64 = 1e-9;

/// Halvings of an interval: more than a double has bits.
const HALVINGS: usize = 80;

/// Unit vectors n where n . A n + 2 g . n is stationary; at most six.
pub(super) fn stationary(a: &DMat3, g: DVec3) -> Vec<DVec3> {
    let axes = principal_axes(a);
    let poles = axes.values;
    let size = poles.iter().map(|pole| pole.abs()).fold(g.length(), f64::max);
    if size == 0.0 {
        return vec![DVec3::Z];
    }
    let g = (axes.axes.transpose() * g)
        .to_array()
        .map(|part| if part.abs() < LEAST * size { (LEAST * size).copysign(part) } else { part });
    let secular = Secular { poles, g };
    // Beyond the poles the length is at most that of g over the distance to the nearest.
    let reach = DVec3::from_array(g).length() * 1.01;
    let mut found = vec![secular.root(poles[0], poles[0] - reach), secular.root(poles[2], poles[2] + reach)];
    for pair in poles.windows(2) {
        if pair[0] < pair[1] {
            let least = secular.least(pair[0], pair[1]);
            if secular.value(least) < 1.0 {
                found.extend([secular.root(pair[0], least), secular.root(pair[1], least)]);
            }
        }
    }
    let all = found.into_iter().map(|m| secular.vector(m)).filter(|vector| vector.is_finite());
    all.map(|vector| (axes.axes * vector).normalize()).collect()
}

/// The square of the length of n as a function of m.
struct Secular {
    poles: [f64; 3],
    g: [f64; 3],
}

impl Secular {
    fn vector(&self, m: f64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| self.g[k] / (m - self.poles[k])))
    }

    fn value(&self, m: f64) -> f64 {
        self.vector(m).length_squared()
    }

    /// Half the slope.
    fn slope(&self, m: f64) -> f64 {
        (0..3)
            .map(|k| {
                let part = self.g[k] / (m - self.poles[k]);
                -part * part / (m - self.poles[k])
            })
            .sum()
    }

    /// Where the length is 1, between a pole, where it is more, and a place where it is less.
    fn root(&self, pole: f64, far: f64) -> f64 {
        halved(pole, far, |m| self.value(m) > 1.0)
    }

    /// Where the length is least between two poles.
    fn least(&self, low: f64, high: f64) -> f64 {
        halved(low, high, |m| self.slope(m) < 0.0)
    }
}

/// Where a condition that holds beside `from` and not at `to` ends.
fn halved(mut from: f64, mut to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(from, to);
        if holds(middle) { from = middle } else { to = middle }
    }
    to
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::stationary;

    /// The least and the greatest value over a lattice of the sphere are not beyond those found.
    #[test]
    fn nothing_lies_beyond_the_stationary_places() {
        let mut tried = 0;
        for k in 0..200_u32 {
            let part = |bits: u32| f64::from((k.wrapping_mul(2_654_435_761) >> bits) % 7) - 3.0;
            let a = DMat3::from_cols(
                DVec3::new(part(1), part(4), part(7)),
                DVec3::new(part(4), part(10), part(13)),
                DVec3::new(part(7), part(13), part(16)),
            );
            let g = DVec3::new(part(19), part(22), part(25)) * if k % 3 == 0 { 0.0 } else { 0.5 };
            let value = |n: DVec3| n.dot(a * n) + 2.0 * g.dot(n);
            let found = stationary(&a, g);
            assert!(!found.is_empty());
            for n in &found {
                let gradient = a * *n + g;
                let along = *n * gradient.dot(*n);
                assert!((gradient - along).length() < 1e-5 * (1.0 + gradient.length()), "{a} {g} {n}");
            }
            let (low, high) = found
                .iter()
                .map(|n| value(*n))
                .fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            for x in -6..=6 {
                for y in -6..=6 {
                    for z in -6..=6 {
                        let n = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                        if n != DVec3::ZERO {
                            let v = value(n.normalize());
                            assert!(v > low - 1e-6 && v < high + 1e-6, "{a} {g}: {v} beyond {low} {high}");
                            tried += 1;
                        }
                    }
                }
            }
        }
        assert!(tried > 100_000);
    }
}
