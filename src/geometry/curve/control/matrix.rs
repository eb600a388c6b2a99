//! Cubic pieces by a basis matrix: C(t) = (t^3, t^2, t, 1) M G, with four rows of geometry G.
//!
//! Matrices as in J. Foley, A. van Dam, S. Feiner, J. Hughes, Computer Graphics, 2nd ed. 1990, 11.2.

use super::{Control, from_power, to_power};

/// A 4x4 matrix whose rows belong to t^3, t^2, t and 1 and whose columns belong to the rows of geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasisMatrix(pub [[f64; 4]; 4]);

impl BasisMatrix {
    /// Geometry: four control points.
    pub const BEZIER: Self =
        Self([[-1.0, 3.0, -3.0, 1.0], [3.0, -6.0, 3.0, 0.0], [-3.0, 3.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]);

    /// Geometry: start, end, derivative at the start, derivative at the end.
    pub const HERMITE: Self =
        Self([[2.0, -2.0, 1.0, 1.0], [-3.0, 3.0, -2.0, -1.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0]]);

    /// Geometry: four consecutive points, of which the curve runs between the second and the third.
    pub const CATMULL_ROM: Self =
        Self([[-0.5, 1.5, -1.5, 0.5], [1.0, -2.5, 2.0, -0.5], [-0.5, 0.0, 0.5, 0.0], [0.0, 1.0, 0.0, 0.0]]);

    /// Geometry: four consecutive control points of a uniform cubic B-spline.
    pub const B_SPLINE: Self = Self([
        [-1.0 / 6.0, 0.5, -0.5, 1.0 / 6.0],
        [0.5, -1.0, 0.5, 0.0],
        [-0.5, 0.0, 0.5, 0.0],
        [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    ]);

    /// Geometry: the coefficients of t^3, t^2, t and 1 themselves.
    pub const POWER: Self =
        Self([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);

    /// A cardinal spline: as Catmull-Rom (0.5), with derivatives `scale` times the way between neighbours.
    #[must_use]
    pub const fn cardinal(scale: f64) -> Self {
        let s = scale;
        Self([
            [-s, 2.0 - s, s - 2.0, s],
            [2.0 * s, s - 3.0, 3.0 - 2.0 * s, -s],
            [-s, 0.0, s, 0.0],
            [0.0, 1.0, 0.0, 0.0],
        ])
    }

    /// A uniform beta-spline: as the cubic B-spline (1, 0), where `bias` is the ratio of speeds after and before
    /// each joint and `tension` draws the curve to its control points.
    ///
    /// Source: B. Barsky, The Beta-spline: a local representation based on shape parameters and fundamental
    /// geometric measures, 1981.
    #[must_use]
    pub fn beta(bias: f64, tension: f64) -> Self {
        let (b, t) = (bias, tension);
        let (b2, b3) = (b * b, b * b * b);
        let sum = t + 2.0 * b3 + 4.0 * b2 + 4.0 * b + 2.0;
        Self(
            [
                [-2.0 * b3, 2.0 * (t + b3 + b2 + b), -2.0 * (t + b2 + b + 1.0), 2.0],
                [6.0 * b3, -3.0 * (t + 2.0 * b3 + 2.0 * b2), 3.0 * (t + 2.0 * b2), 0.0],
                [-6.0 * b3, 6.0 * (b3 - b), 6.0 * b, 0.0],
                [2.0 * b3, t + 4.0 * (b2 + b), 2.0, 0.0],
            ]
            .map(|row| row.map(|entry| entry / sum)),
        )
    }

    /// Coefficients of 1, t, t^2 and t^3.
    #[must_use]
    pub fn power<P: Control>(&self, geometry: &[P; 4]) -> [P; 4] {
        let row = |row: &[f64; 4]| {
            row.iter().zip(geometry).fold(P::default(), |sum, (entry, point)| sum + *point * *entry)
        };
        let [cubic, square, linear, constant] = &self.0;
        [row(constant), row(linear), row(square), row(cubic)]
    }

    /// The piece in Bezier form.
    #[must_use]
    pub fn to_bezier<P: Control>(&self, geometry: &[P; 4]) -> [P; 4] {
        let points = from_power(&self.power(geometry));
        [points[0], points[1], points[2], points[3]]
    }

    /// The inverse; `None` where the matrix is singular.
    ///
    /// Gauss-Jordan elimination with row pivots.
    #[must_use]
    pub fn inverse(&self) -> Option<Self> {
        const LOST: f64 = 1e-12;
        let (mut left, mut right) = (self.0, Self::POWER.0);
        let size = left.iter().flatten().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        for column in 0..4 {
            let pivot =
                (column..4).max_by(|a, b| left[*a][column].abs().total_cmp(&left[*b][column].abs()))?;
            if left[pivot][column].abs() <= LOST * size {
                return None;
            }
            left.swap(column, pivot);
            right.swap(column, pivot);
            let scale = 1.0 / left[column][column];
            left[column] = left[column].map(|entry| entry * scale);
            right[column] = right[column].map(|entry| entry * scale);
            for row in (0..4).filter(|row| *row != column) {
                let factor = left[row][column];
                for k in 0..4 {
                    left[row][k] -= factor * left[column][k];
                    right[row][k] -= factor * right[column][k];
                }
            }
        }
        Some(Self(right))
    }
}

/// The geometry of the same cubic for another basis; `None` where that basis is singular.
#[must_use]
pub fn convert<P: Control>(from: &BasisMatrix, to: &BasisMatrix, geometry: &[P; 4]) -> Option<[P; 4]> {
    let [constant, linear, square, cubic] = from.power(geometry);
    let inverse = to.inverse()?;
    let [d, c, b, a] = inverse.power(&[cubic, square, linear, constant]);
    Some([a, b, c, d])
}

/// Power coefficients of a Bezier piece over parameters from `start`, where a step of `span` is its whole.
#[must_use]
pub fn coefficients<P: Control>(control: &[P], span: f64) -> Vec<P> {
    let mut scale = 1.0;
    let scaled = |coefficient: P| {
        let result = coefficient * scale;
        scale /= span;
        result
    };
    to_power(control).into_iter().map(scaled).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{BasisMatrix, convert};
    use crate::geometry::curve::control::{de_casteljau, horner};

    const GEOMETRY: [DVec3; 4] = [
        DVec3::new(0.0, 1.0, 0.5),
        DVec3::new(2.0, -1.0, 0.25),
        DVec3::new(3.0, 4.0, -1.0),
        DVec3::new(-1.0, 0.5, 2.0),
    ];

    fn bases() -> [BasisMatrix; 7] {
        [
            BasisMatrix::BEZIER,
            BasisMatrix::HERMITE,
            BasisMatrix::CATMULL_ROM,
            BasisMatrix::B_SPLINE,
            BasisMatrix::POWER,
            BasisMatrix::cardinal(0.25),
            BasisMatrix::beta(1.7, 4.0),
        ]
    }

    #[test]
    fn forms_are_the_same_curve() {
        for from in bases() {
            let power = from.power(&GEOMETRY);
            let bezier = from.to_bezier(&GEOMETRY);
            for to in bases() {
                let converted = convert(&from, &to, &GEOMETRY).unwrap();
                for step in 0..=8 {
                    let t = f64::from(step) / 8.0;
                    let point = horner(&power, t);
                    assert!(de_casteljau(&bezier, t).distance(point) < 1e-13);
                    assert!(horner(&to.power(&converted), t).distance(point) < 1e-11);
                }
            }
        }
    }

    #[test]
    fn special_cases_meet() {
        assert_eq!(BasisMatrix::cardinal(0.5), BasisMatrix::CATMULL_ROM);
        let beta = BasisMatrix::beta(1.0, 0.0);
        for (row, other) in beta.0.iter().zip(&BasisMatrix::B_SPLINE.0) {
            for (entry, expected) in row.iter().zip(other) {
                assert!((entry - expected).abs() < 1e-15);
            }
        }
        let singular = BasisMatrix([[1.0, 2.0, 3.0, 4.0], [2.0, 4.0, 6.0, 8.0], [0.0; 4], [1.0; 4]]);
        assert_eq!(singular.inverse(), None);
    }

    #[test]
    fn a_hermite_piece_has_its_ends_and_derivatives() {
        let [_, linear, ..] = BasisMatrix::HERMITE.power(&GEOMETRY);
        assert_eq!(linear, GEOMETRY[2]);
        let bezier = BasisMatrix::HERMITE.to_bezier(&GEOMETRY);
        assert!(bezier[3].distance(GEOMETRY[1]) < 1e-14);
        assert!(((bezier[3] - bezier[2]) * 3.0).distance(GEOMETRY[3]) < 1e-13);
    }
}
