//! Quadratic polynomials of three variables and the surfaces where they vanish.
//!
//! Promise: classification by principal axes, with coefficients that cannot move the surface by more than a billionth
//! of its size taken as zero; sheets that carry smooth coordinates without poles or seams inside.

mod form;
mod sheet;
#[cfg(test)]
mod tests;

pub use form::{QuadricForm, QuadricKind};
pub use sheet::{HalfSpace, Sheet};

use glam::{DAffine3, DMat3, DVec3};

use super::Field;
use crate::geometry::number::Bounds;

/// The polynomial x . A x + b . x + c, A symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadric {
    /// Coefficients of the squares and products.
    pub a: DMat3,
    /// Coefficients of x, y, z.
    pub b: DVec3,
    /// The constant.
    pub c: f64,
}

impl Quadric {
    /// By its coefficients: those of x^2, y^2, z^2; of x y, y z, z x; of x, y, z; and the constant.
    #[must_use]
    pub fn new(squares: DVec3, products: DVec3, linear: DVec3, constant: f64) -> Self {
        let half = products / 2.0;
        let a = DMat3::from_cols(
            DVec3::new(squares.x, half.x, half.z),
            DVec3::new(half.x, squares.y, half.y),
            DVec3::new(half.z, half.y, squares.z),
        );
        Self { a, b: linear, c: constant }
    }

    /// The same polynomial of a point counted from `origin`.
    #[must_use]
    pub fn around(&self, origin: DVec3) -> Self {
        Self { a: self.a, b: self.gradient(origin), c: self.value(origin) }
    }

    /// The polynomial that has at every point the value of this one at the point's image under `back`.
    #[must_use]
    pub fn mapped(&self, back: &DAffine3) -> Self {
        let matrix = back.matrix3;
        Self {
            a: matrix.transpose() * self.a * matrix,
            b: matrix.transpose() * self.gradient(back.translation),
            c: self.value(back.translation),
        }
    }

    /// The sum with another one times a factor.
    #[must_use]
    pub fn plus(&self, other: &Self, factor: f64) -> Self {
        Self { a: self.a + other.a * factor, b: self.b + other.b * factor, c: self.c + other.c * factor }
    }

    /// A box around an ellipsoid; none for surfaces without end.
    #[must_use]
    pub fn ends(&self) -> Option<Bounds> {
        let form = QuadricForm::anywhere(self);
        (form.kind == QuadricKind::Ellipsoid && self.bent(DVec3::X) > 0.0).then(|| form.box_around())
    }

    /// What the squares and products make of a direction.
    #[must_use]
    pub fn bent(&self, direction: DVec3) -> f64 {
        direction.dot(self.a * direction)
    }

    /// A bound on the greatest factor by which A stretches.
    #[must_use]
    pub fn stretch(&self) -> f64 {
        let rows = [self.a.x_axis, self.a.y_axis, self.a.z_axis];
        rows.iter().map(|row| row.abs().element_sum()).fold(0.0, f64::max)
    }

    /// Parameters t, increasing, at which the line origin + t direction meets the surface: none, one or two. A line
    /// that lies on the surface has none.
    #[must_use]
    pub fn on_line(&self, origin: DVec3, direction: DVec3) -> Vec<f64> {
        let (a, b, c) = (self.bent(direction), self.gradient(origin).dot(direction), self.value(origin));
        roots(a, b, c)
    }

    /// The point of the surface nearest along the gradient; `None` where the gradient vanishes or leads nowhere.
    #[must_use]
    pub fn settled(&self, mut point: DVec3) -> Option<DVec3> {
        for _ in 0..4 {
            let (value, gradient) = (self.value(point), self.gradient(point));
            let length = gradient.length();
            if length == 0.0 || !length.is_finite() {
                return None;
            }
            let direction = gradient / length;
            let step = nearest_root(self.bent(direction), length, value)?;
            let next = point + direction * step;
            if next == point {
                break;
            }
            point = next;
        }
        Some(point)
    }
}

/// Real roots of a t^2 + b t + c, increasing, by the form that does not cancel (W. Kahan, On the cost of floating-point
/// computation without extra-precise arithmetic, 2004).
#[must_use]
pub fn roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    if a == 0.0 {
        return if b == 0.0 { Vec::new() } else { vec![-c / b] };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 || !discriminant.is_finite() {
        return Vec::new();
    }
    let q = -0.5 * (b + if b < 0.0 { -1.0 } else { 1.0 } * discriminant.sqrt());
    if q == 0.0 {
        return vec![0.0];
    }
    let (one, other) = (q / a, c / q);
    if one == other { vec![one] } else { vec![one.min(other), one.max(other)] }
}

/// The root of a t^2 + b t + c nearest to 0.
fn nearest_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = b + if b < 0.0 { -1.0 } else { 1.0 } * discriminant.sqrt();
    (q != 0.0).then(|| -2.0 * c / q)
}

impl Field for Quadric {
    fn value(&self, point: DVec3) -> f64 {
        point.dot(self.a * point + self.b) + self.c
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        (self.a * point) * 2.0 + self.b
    }

    fn range(&self, within: &Bounds) -> (f64, f64) {
        let center = within.center();
        let half = (within.max - within.min) / 2.0;
        let (value, slope) = (self.value(center), self.gradient(center).abs().dot(half));
        // Squares of a coordinate lie between 0 and the square of its half width; products on both sides of 0.
        let squares = [self.a.x_axis.x, self.a.y_axis.y, self.a.z_axis.z];
        let widths = half.to_array();
        let (mut low, mut high) = (value - slope, value + slope);
        for k in 0..3 {
            let most = squares[k] * widths[k] * widths[k];
            low += most.min(0.0);
            high += most.max(0.0);
        }
        let products = 2.0
            * (self.a.x_axis.y.abs() * half.x * half.y
                + self.a.y_axis.z.abs() * half.y * half.z
                + self.a.z_axis.x.abs() * half.z * half.x);
        (low - products, high + products)
    }

    fn gradient_range(&self, within: &Bounds) -> Bounds {
        let center = self.gradient(within.center());
        let reach = self.a.abs() * (within.max - within.min);
        Bounds { min: center - reach, max: center + reach }
    }

    fn bend(&self, _within: &Bounds) -> f64 {
        2.0 * self.stretch()
    }
}
