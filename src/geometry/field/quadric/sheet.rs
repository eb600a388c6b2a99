//! Coordinates on the surfaces of quadrics in which their second fundamental form is the same in all directions.
//!
//! In coordinates x = X/a, y = Y/b, z = Z/c along the axes the form of a quadric is that of x^2 ± y^2 ± z^2, up to a
//! factor at each place. Stereographic coordinates (x, y) / (1 + |z|) of an ellipsoid or of a sheet of a hyperboloid of
//! two, the angle about the axis with atan z of one sheet, and (x, y) of a paraboloid make it isotropic (but for sign),
//! so that triangles which are Delaunay there have the best shapes for their error. Cylinders and cones are straight
//! along one coordinate, which is drawn together. Source of the isotropy: direct computation; of its use:
//! E. F. D'Azevedo, R. B. Simpson, On optimal triangular meshes for minimizing the gradient error, Numer. Math. 59 (1991).

use glam::{DVec2, DVec3};

use super::{QuadricForm, QuadricKind};
use crate::geometry::number::{asinh, atan, atan2, cosh, exp, hypot, ln, sin_cos, sinh, tan};

/// A part of a quadric that plane coordinates cover once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    form: QuadricForm,
    /// For each axis the sign that the coordinate has on the sheet; 0 where it has both.
    signs: [f64; 3],
    /// Where an ellipsoid is parted: z / c of the plane.
    level: f64,
    /// By what angle about the axis X and Y are turned before Y parts the sheets: its sine and cosine.
    turn: (f64, f64),
}

/// A half space: points p with normal . p >= offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Unit normal, inward.
    pub normal: DVec3,
    /// Distance of its plane from the origin along the normal.
    pub offset: f64,
}

impl HalfSpace {
    /// How far inside a point lies; negative outside.
    #[must_use]
    pub fn depth(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// Whether this is the plane between the halves of a cone, which meets both in the apex alone.
    #[must_use]
    pub fn touches_apex(&self, form: &QuadricForm) -> bool {
        form.kind == QuadricKind::Cone && self.normal.cross(form.axes.z_axis).length() < 1e-9
    }
}

/// Straight directions are drawn together by this factor: no triangle need be short along them.
const SQUEEZE: f64 = 1e-3;

impl Sheet {
    /// The sheets of a quadric that is not flat; none where it is no surface. Where they part is free within limits: it
    /// is chosen apart from the planes of `walls`, which may cut the quadric too.
    #[must_use]
    pub fn all(form: &QuadricForm, walls: &[HalfSpace]) -> Vec<Self> {
        let splits: &[usize] = match form.kind {
            QuadricKind::Ellipsoid | QuadricKind::TwoSheets => &[2],
            QuadricKind::OneSheet | QuadricKind::EllipticCylinder => &[1],
            QuadricKind::HyperbolicCylinder => &[0],
            QuadricKind::Cone => &[1, 2],
            QuadricKind::EllipticParaboloid
            | QuadricKind::HyperbolicParaboloid
            | QuadricKind::ParabolicCylinder => &[],
            _ => return Vec::new(),
        };
        let mut sheets = vec![Self { form: *form, signs: [0.0; 3], level: 0.0, turn: (0.0, 1.0) }];
        for axis in splits {
            let with = |sheet: &Self, sign: f64| {
                let mut signs = sheet.signs;
                signs[*axis] = sign;
                Self { signs, ..*sheet }
            };
            sheets = sheets.iter().flat_map(|sheet| [with(sheet, 1.0), with(sheet, -1.0)]).collect();
        }
        // Odd numbers first: what people write is seldom near them.
        let trials = [0.0371, -0.0523, 0.0797, -0.1013, 0.1193, -0.1409, 0.1607, -0.1811];
        let moved = |trial: f64| {
            let turn = sin_cos(5.0 * trial);
            sheets.iter().map(|sheet| Self { level: trial, turn, ..*sheet }).collect::<Vec<_>>()
        };
        let apart = |sheets: &Vec<Self>| {
            sheets.iter().flat_map(Self::limits).all(|limit| is_apart(&limit, form, walls))
        };
        trials.into_iter().map(moved).find(apart).unwrap_or_else(|| moved(trials[0]))
    }

    /// The half spaces whose common part holds the sheet and no other.
    #[must_use]
    pub fn limits(&self) -> Vec<HalfSpace> {
        let form = &self.form;
        let limit = |axis: usize| {
            let (across, level) = match (axis, form.kind) {
                // y cos - x sin of coordinates that are counted in half axes.
                (1, _) => (
                    form.axes.y_axis * (self.turn.1 / form.half.y)
                        - form.axes.x_axis * (self.turn.0 / form.half.x),
                    0.0,
                ),
                (2, QuadricKind::Ellipsoid) => (form.axes.z_axis, self.level * form.half.z),
                _ => (form.axes.col(axis), 0.0),
            };
            let length = across.length() * self.signs[axis];
            let normal = across / length;
            HalfSpace { normal, offset: normal.dot(form.origin) + level * self.signs[axis] }
        };
        (0..3).filter(|axis| self.signs[*axis] != 0.0).map(limit).collect()
    }

    /// The apex of a cone, which plane coordinates do not hold.
    #[must_use]
    pub fn apex(&self) -> Option<DVec3> {
        (self.form.kind == QuadricKind::Cone).then_some(self.form.origin)
    }

    /// Plane coordinates of a point on or near the sheet.
    #[must_use]
    pub fn drop(&self, point: DVec3) -> DVec2 {
        let DVec3 { x, y, z } = self.form.local(point) / self.form.half;
        match self.form.kind {
            QuadricKind::Ellipsoid | QuadricKind::TwoSheets => DVec2::new(x, y) / (1.0 + z * self.signs[2]),
            QuadricKind::OneSheet => DVec2::new(self.angle(x, y), atan(z)),
            QuadricKind::EllipticCylinder => DVec2::new(self.angle(x, y), SQUEEZE * z / self.radius()),
            QuadricKind::Cone => DVec2::new(self.angle(x, y), SQUEEZE * ln(hypot(x, y))),
            QuadricKind::HyperbolicCylinder => DVec2::new(asinh(y), SQUEEZE * z / self.radius()),
            QuadricKind::ParabolicCylinder => DVec2::new(x, SQUEEZE * z / self.form.half.x),
            _ => DVec2::new(x, y),
        }
    }

    /// The point of plane coordinates.
    #[must_use]
    pub fn lift(&self, place: DVec2) -> DVec3 {
        let DVec2 { x: u, y: v } = place;
        let square = place.length_squared();
        let sign = if self.signs[2] == 0.0 { self.signs[0] } else { self.signs[2] };
        let local = match self.form.kind {
            QuadricKind::Ellipsoid => DVec3::new(2.0 * u, 2.0 * v, sign * (1.0 - square)) / (1.0 + square),
            QuadricKind::TwoSheets => DVec3::new(2.0 * u, 2.0 * v, sign * (1.0 + square)) / (1.0 - square),
            QuadricKind::OneSheet => {
                let (z, radius) = (tan(v), (1.0 + tan(v) * tan(v)).sqrt());
                let (sin, cos) = self.turned(u);
                DVec3::new(radius * cos, radius * sin, z)
            }
            QuadricKind::EllipticCylinder => {
                let (sin, cos) = self.turned(u);
                DVec3::new(cos, sin, v * self.radius() / SQUEEZE)
            }
            QuadricKind::Cone => {
                let radius = exp(v / SQUEEZE);
                let (sin, cos) = self.turned(u);
                DVec3::new(radius * cos, radius * sin, sign * radius)
            }
            QuadricKind::HyperbolicCylinder => {
                DVec3::new(sign * cosh(u), sinh(u), v * self.radius() / SQUEEZE)
            }
            QuadricKind::ParabolicCylinder => DVec3::new(u, u * u, v * self.form.half.x / SQUEEZE),
            QuadricKind::EllipticParaboloid => DVec3::new(u, v, u * u + v * v),
            _ => DVec3::new(u, v, u * u - v * v),
        };
        self.form.world(local * self.form.half)
    }

    fn radius(&self) -> f64 {
        self.form.half.x.max(self.form.half.y)
    }

    /// The angle about the axis from where the sheets part: from 0 to pi on the positive one and from -pi to 0 on the
    /// negative one, though rounding may have left a point of the line between them on the other side.
    fn angle(&self, x: f64, y: f64) -> f64 {
        let sign = self.signs[1];
        let (sin, cos) = self.turn;
        let (along, beside) = (x * cos + y * sin, (y * cos - x * sin) * sign);
        // Points of the line between the sheets lie on one line of the plane, without what rounding does.
        let beside = if beside <= 1e-9 * along.abs() { 0.0 } else { beside };
        sign * atan2(beside, along)
    }

    /// Sine and cosine of the angle from X of an angle from where the sheets part.
    fn turned(&self, angle: f64) -> (f64, f64) {
        let ((a, b), (sin, cos)) = (sin_cos(angle), self.turn);
        (a * cos + b * sin, b * cos - a * sin)
    }
}

/// Whether a plane is clearly apart from those of the walls: turned against them, or at a distance.
fn is_apart(limit: &HalfSpace, form: &QuadricForm, walls: &[HalfSpace]) -> bool {
    walls.iter().all(|wall| {
        let turned = limit.normal.cross(wall.normal).length() > 1e-3;
        let origin = limit.normal * limit.offset;
        turned || wall.depth(origin).abs() > 1e-3 * form.half.min_element()
    })
}
