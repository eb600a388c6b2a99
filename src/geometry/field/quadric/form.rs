//! Which surface a quadratic polynomial makes, and where its axes lie.

use glam::{DMat3, DVec3};

use super::Quadric;
use crate::geometry::field::Field;
use crate::geometry::number::{Bounds, principal_axes};

/// The surface of a quadric. In the frame of its axes, with half lengths a, b, c:
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadricKind {
    /// X^2/a^2 + Y^2/b^2 + Z^2/c^2 = 1.
    Ellipsoid,
    /// X^2/a^2 + Y^2/b^2 - Z^2/c^2 = 1.
    OneSheet,
    /// X^2/a^2 + Y^2/b^2 - Z^2/c^2 = -1.
    TwoSheets,
    /// X^2/a^2 + Y^2/b^2 = Z^2/c^2.
    Cone,
    /// X^2/a^2 + Y^2/b^2 = Z/c.
    EllipticParaboloid,
    /// X^2/a^2 - Y^2/b^2 = Z/c.
    HyperbolicParaboloid,
    /// X^2/a^2 + Y^2/b^2 = 1.
    EllipticCylinder,
    /// X^2/a^2 - Y^2/b^2 = 1.
    HyperbolicCylinder,
    /// X^2/a^2 = Y/b.
    ParabolicCylinder,
    /// X^2/a^2 = Y^2/b^2.
    CrossingPlanes,
    /// X^2/a^2 = 1.
    ParallelPlanes,
    /// X = 0, simply or twice.
    Plane,
    /// The axis Z alone: no surface.
    Line,
    /// One point: no surface.
    Point,
    /// Nothing.
    Empty,
    /// All coefficients vanish.
    Everything,
}

impl QuadricKind {
    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Ellipsoid => "ellipsoid",
            Self::OneSheet => "hyperboloid of one sheet",
            Self::TwoSheets => "hyperboloid of two sheets",
            Self::Cone => "cone",
            Self::EllipticParaboloid => "elliptic paraboloid",
            Self::HyperbolicParaboloid => "hyperbolic paraboloid",
            Self::EllipticCylinder => "elliptic cylinder",
            Self::HyperbolicCylinder => "hyperbolic cylinder",
            Self::ParabolicCylinder => "parabolic cylinder",
            Self::CrossingPlanes => "pair of crossing planes",
            Self::ParallelPlanes => "pair of parallel planes",
            Self::Plane => "plane",
            Self::Line => "line",
            Self::Point => "point",
            Self::Empty => "empty set",
            Self::Everything => "whole space",
        }
    }

    /// Whether it has one center, and half lengths along all three axes.
    #[must_use]
    pub const fn has_center(self) -> bool {
        matches!(self, Self::Ellipsoid | Self::OneSheet | Self::TwoSheets | Self::Cone)
    }

    /// Whether it is flat everywhere.
    #[must_use]
    pub const fn is_flat(self) -> bool {
        matches!(self, Self::CrossingPlanes | Self::ParallelPlanes | Self::Plane)
    }
}

/// A classified quadric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricForm {
    /// Its kind.
    pub kind: QuadricKind,
    /// Its center, vertex or a point of its axis.
    pub origin: DVec3,
    /// The directions of X, Y, Z as columns, right-handed.
    pub axes: DMat3,
    /// a, b, c of the kind; 1 where it has none.
    pub half: DVec3,
}

/// Coefficients are zero where they cannot move the surface by more than about this share of its size: what is left of
/// a computed zero is 1e-16, and nothing smaller can be seen.
const VANISHES: f64 = 1e-9;

/// The polynomial `sum l_k y_k^2 + m . y + n` of coordinates along the principal axes.
struct Diagonal {
    l: [f64; 3],
    m: [f64; 3],
    n: f64,
    axes: [DVec3; 3],
    origin: DVec3,
    /// Sizes of the numbers whose sum is n.
    terms: f64,
}

impl QuadricForm {
    /// Classifies a quadric as it looks within about `size` of `around`.
    #[must_use]
    pub fn new(quadric: &Quadric, around: DVec3, size: f64) -> Self {
        let mut diagonal = Diagonal::new(quadric, around, size);
        let rank = diagonal.complete();
        match rank {
            3 => diagonal.central(size),
            2 => diagonal.of_two_squares(size),
            1 => diagonal.of_one_square(size),
            _ => diagonal.linear(),
        }
    }

    /// Classifies a quadric wherever it is, by its coefficients alone.
    #[must_use]
    pub fn anywhere(quadric: &Quadric) -> Self {
        let axes = principal_axes(&quadric.a);
        let least = axes.values.iter().map(|value| value.abs()).fold(f64::INFINITY, f64::min);
        let most = axes.values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        if most == 0.0 || least <= VANISHES * most {
            return Self::new(quadric, DVec3::ZERO, 1.0);
        }
        // The center, and the longest half axis as the size.
        let rotated = axes.axes.transpose() * quadric.b;
        let center = axes.axes * (rotated / DVec3::from_array(axes.values) / -2.0);
        let size = (quadric.value(center) / least).abs().sqrt();
        Self::new(quadric, center, if size > 0.0 { size } else { 1.0 })
    }

    /// The smallest box around an ellipsoid.
    #[must_use]
    pub fn box_around(&self) -> Bounds {
        // Its half widths are the lengths of the rows of its axes times half lengths.
        let reach = DVec3::from_array([0, 1, 2].map(|row| (self.axes.row(row) * self.half).length()));
        Bounds { min: self.origin - reach, max: self.origin + reach }
    }

    /// Coordinates along the axes.
    #[must_use]
    pub fn local(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.origin)
    }

    /// The point of coordinates along the axes.
    #[must_use]
    pub fn world(&self, local: DVec3) -> DVec3 {
        self.origin + self.axes * local
    }
}

impl Diagonal {
    fn new(quadric: &Quadric, around: DVec3, size: f64) -> Self {
        let principal = principal_axes(&quadric.a);
        let moved = quadric.around(around);
        let axes = [principal.axes.x_axis, principal.axes.y_axis, principal.axes.z_axis];
        let mut diagonal = Self {
            l: principal.values,
            m: axes.map(|axis| axis.dot(moved.b)),
            n: moved.c,
            axes,
            origin: around,
            terms: moved.c.abs(),
        };
        let terms = diagonal.l.iter().map(|l| l.abs() * size * size);
        let terms = terms.chain(diagonal.m.iter().map(|m| m.abs() * size));
        let most = terms.fold(0.0, f64::max);
        for l in &mut diagonal.l {
            if l.abs() * size * size <= VANISHES * most {
                *l = 0.0;
            }
        }
        for (k, m) in diagonal.m.iter_mut().enumerate() {
            if diagonal.l[k] == 0.0 && m.abs() * size <= VANISHES * most {
                *m = 0.0;
            }
        }
        diagonal
    }

    /// Moves the origin so that axes with a square have no linear term; how many have one. Axes with squares come
    /// first.
    fn complete(&mut self) -> usize {
        let mut order = [0, 1, 2];
        order.sort_by_key(|k| self.l[*k] == 0.0);
        self.permute(order);
        let rank = self.l.iter().filter(|l| **l != 0.0).count();
        for k in 0..rank {
            let shift = -self.m[k] / (2.0 * self.l[k]);
            self.n += self.m[k] * shift / 2.0;
            self.terms += (self.m[k] * shift / 2.0).abs();
            self.m[k] = 0.0;
            self.origin += self.axes[k] * shift;
        }
        rank
    }

    fn permute(&mut self, order: [usize; 3]) {
        self.l = order.map(|k| self.l[k]);
        self.m = order.map(|k| self.m[k]);
        self.axes = order.map(|k| self.axes[k]);
    }

    fn negate(&mut self) {
        self.l = self.l.map(|l| -l);
        self.m = self.m.map(|m| -m);
        self.n = -self.n;
    }

    fn finish(&self, kind: QuadricKind, half: [f64; 3]) -> QuadricForm {
        let [x, y, z] = self.axes;
        let z = if x.cross(y).dot(z) < 0.0 { -z } else { z };
        QuadricForm {
            kind,
            origin: self.origin,
            axes: DMat3::from_cols(x, y, z),
            half: DVec3::from_array(half),
        }
    }

    /// Whether the constant is what rounding leaves of zero.
    fn constant_vanishes(&self, size: f64) -> bool {
        /// Necks and gaps of the root of this share of the size are below what single precision tells apart.
        const SHARE: f64 = 1e-14;
        let most = self.l.iter().map(|l| l.abs()).fold(0.0, f64::max);
        self.n.abs() <= SHARE * (most * size * size + self.terms)
    }

    /// Three squares: the axis whose square has its own sign comes last, of an ellipsoid the shortest.
    fn central(mut self, size: f64) -> QuadricForm {
        let positive = self.l.iter().filter(|l| **l > 0.0).count();
        if positive < 2 {
            self.negate();
        }
        // Increasing, so that a negative one or the greatest, which is the shortest axis, can be put last.
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| self.l[*a].total_cmp(&self.l[*b]));
        if self.l[order[0]] < 0.0 {
            order.rotate_left(1);
        }
        self.permute(order);
        let half = |n: f64| self.l.map(|l| (n / l).abs().sqrt());
        let hyperbolic = self.l[2] < 0.0;
        if self.constant_vanishes(size) {
            let kind = if hyperbolic { QuadricKind::Cone } else { QuadricKind::Point };
            return self.finish(kind, half(self.l[0]));
        }
        let kind = match (hyperbolic, self.n < 0.0) {
            (false, true) => QuadricKind::Ellipsoid,
            (false, false) => QuadricKind::Empty,
            (true, true) => QuadricKind::OneSheet,
            (true, false) => QuadricKind::TwoSheets,
        };
        self.finish(kind, half(self.n))
    }

    /// Two squares, and perhaps a linear third term.
    fn of_two_squares(mut self, size: f64) -> QuadricForm {
        if self.l[0] + self.l[1] < 0.0 {
            self.negate();
        }
        if self.l[0] < 0.0 {
            self.permute([1, 0, 2]);
        }
        let saddle = self.l[1] < 0.0;
        if self.m[2] != 0.0 {
            // l X^2 + l' Y^2 + m z + n = 0: Z = -z from the vertex at z = -n / m, for a positive m.
            self.origin -= self.axes[2] * (self.n / self.m[2]);
            if self.m[2] > 0.0 {
                self.axes[2] = -self.axes[2];
            }
            let kind =
                if saddle { QuadricKind::HyperbolicParaboloid } else { QuadricKind::EllipticParaboloid };
            let root = |l: f64| (size / l.abs()).sqrt();
            let half = [root(self.l[0]), root(self.l[1]), size / self.m[2].abs()];
            return self.finish_keeping_z(kind, half);
        }
        let half = |n: f64| [(n / self.l[0]).abs().sqrt(), (n / self.l[1]).abs().sqrt(), 1.0];
        if self.constant_vanishes(size) {
            let kind = if saddle { QuadricKind::CrossingPlanes } else { QuadricKind::Line };
            return self.finish(kind, half(self.l[0]));
        }
        match (saddle, self.n < 0.0) {
            (false, true) => self.finish(QuadricKind::EllipticCylinder, half(self.n)),
            (false, false) => self.finish(QuadricKind::Empty, half(self.n)),
            (true, true) => self.finish(QuadricKind::HyperbolicCylinder, half(self.n)),
            (true, false) => {
                let half = half(self.n);
                self.permute([1, 0, 2]);
                self.finish(QuadricKind::HyperbolicCylinder, [half[1], half[0], 1.0])
            }
        }
    }

    /// The direction of Z matters, so X makes way where the axes are not right-handed.
    fn finish_keeping_z(mut self, kind: QuadricKind, half: [f64; 3]) -> QuadricForm {
        if self.axes[0].cross(self.axes[1]).dot(self.axes[2]) < 0.0 {
            self.axes[0] = -self.axes[0];
        }
        self.finish(kind, half)
    }

    /// One square, and perhaps a linear rest.
    fn of_one_square(mut self, size: f64) -> QuadricForm {
        if self.l[0] < 0.0 {
            self.negate();
        }
        let slope = self.axes[1] * self.m[1] + self.axes[2] * self.m[2];
        if slope != DVec3::ZERO {
            // l X^2 + |slope| y + n = 0: Y = -y from the vertex.
            let length = slope.length();
            let down = slope / length;
            self.origin -= down * (self.n / length);
            self.axes[1] = -down;
            self.axes[2] = self.axes[0].cross(self.axes[1]);
            let half = [(size / self.l[0]).sqrt(), size / length, 1.0];
            return self.finish(QuadricKind::ParabolicCylinder, half);
        }
        if self.constant_vanishes(size) {
            return self.finish(QuadricKind::Plane, [1.0; 3]);
        }
        let kind = if self.n < 0.0 { QuadricKind::ParallelPlanes } else { QuadricKind::Empty };
        let half = [(self.n / self.l[0]).abs().sqrt(), 1.0, 1.0];
        self.finish(kind, half)
    }

    /// No square at all.
    fn linear(mut self) -> QuadricForm {
        let slope: DVec3 = (0..3).map(|k| self.axes[k] * self.m[k]).sum();
        let length = slope.length();
        if length == 0.0 {
            let kind = if self.n == 0.0 { QuadricKind::Everything } else { QuadricKind::Empty };
            return self.finish(kind, [1.0; 3]);
        }
        let x = slope / length;
        self.origin -= x * (self.n / length);
        let y = x.any_orthonormal_vector();
        self.axes = [x, y, x.cross(y)];
        self.finish(QuadricKind::Plane, [1.0; 3])
    }
}
