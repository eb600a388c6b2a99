//! Quadrics by their equation.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// The surface of all points where xx x² + yy y² + zz z² + xy x y + yz y z + zx z x + x x + y y + z z + constant is 0:
    /// an ellipsoid, a hyperboloid, a cone, a paraboloid, a cylinder, or a pair of planes, in any position. Its inside is
    /// where the sum is negative; other signs everywhere turn it inside out.
    "quadric" pub Quadric {
        /// Factor of x².
        xx: Sp<f64> = 0.0;
        /// Factor of y².
        yy: Sp<f64> = 0.0;
        /// Factor of z².
        zz: Sp<f64> = 0.0;
        /// Factor of x y.
        xy: Sp<f64> = 0.0;
        /// Factor of y z.
        yz: Sp<f64> = 0.0;
        /// Factor of z x.
        zx: Sp<f64> = 0.0;
        /// Factor of x.
        x: Sp<f64> = 0.0;
        /// Factor of y.
        y: Sp<f64> = 0.0;
        /// Factor of z.
        z: Sp<f64> = 0.0;
        /// What is added.
        constant: Sp<f64> = 0.0;
        /// The box that it ends at, `{ min = [x, y, z], max = [x, y, z] }`, or the ball, `{ center = [x, y, z], radius = 1 }`.
        /// Only an ellipsoid ends by itself. Of a cone both halves are made, as far as they are held; they meet in the
        /// apex.
        within: Option<QuadricWithin>;
        /// Whether it is closed where it ends, so that the result is the solid of all points inside of it and of `within`.
        caps: Sp<bool> = false;
    }
    checked check
}

table! {
    /// The box or the ball at which a quadric ends.
    "quadric within" pub QuadricWithin {
        /// The least corner of a box, `[x, y, z]`.
        min: Option<Sp<DVec3>>;
        /// Its greatest corner.
        max: Option<Sp<DVec3>>;
        /// The center of a ball; without it `[0, 0, 0]`.
        center: Option<Sp<DVec3>>;
        /// The radius of a ball.
        radius: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

/// What a quadric ends at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuadricClip {
    /// A box, by its least and greatest corner.
    Box {
        /// The least.
        min: Sp<DVec3>,
        /// The greatest.
        max: Sp<DVec3>,
    },
    /// A ball.
    Ball {
        /// Its center.
        center: Sp<DVec3>,
        /// Its radius.
        radius: Sp<f64>,
    },
}

table! {
    /// A box at which a surface ends, by two of its corners.
    "within" pub Within {
        /// The least corner, `[x, y, z]`.
        min: Sp<DVec3>;
        /// The greatest corner.
        max: Sp<DVec3>;
    }
    checked check
}

impl Quadric {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let factors = [self.xx, self.yy, self.zz, self.xy, self.yz, self.zx, self.x, self.y, self.z];
        if factors.iter().any(|factor| factor.value != 0.0) {
            return true;
        }
        let message = "all factors of this quadric are 0: it has no surface";
        let report = Diagnostic::error(Code::NoQuadric, message)
            .at(span, "needs a factor")
            .help("a ball of radius 1 is `xx = 1, yy = 1, zz = 1, constant = -1`");
        reader.report(report);
        false
    }
}

impl QuadricWithin {
    /// What is written.
    #[must_use]
    pub fn clip(&self) -> QuadricClip {
        match (self.min, self.max, self.radius) {
            (Some(min), Some(max), _) => QuadricClip::Box { min, max },
            (_, _, radius) => QuadricClip::Ball {
                center: self.center.unwrap_or(DVec3::ZERO.into()),
                radius: radius.unwrap_or(1.0.into()),
            },
        }
    }

    /// Where it is written.
    #[must_use]
    pub fn span(&self) -> Span {
        match self.clip() {
            QuadricClip::Box { min, .. } => min.span,
            QuadricClip::Ball { radius, .. } => radius.span,
        }
    }

    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        let ball = self.radius.map(|radius| radius.span).or(self.center.map(|center| center.span));
        let corner = self.min.map(|min| min.span).or(self.max.map(|max| max.span));
        let report = match (corner, ball) {
            (Some(corner), Some(ball)) => {
                Diagnostic::error(Code::Conflict, "a quadric ends at a box or at a ball, not at both")
                    .at(ball, "of a ball")
                    .also(corner, "of a box")
            }
            _ => match (self.min, self.max, self.radius) {
                (Some(min), Some(max), _) => return boxed(min, max, reader),
                (None, None, Some(_)) => return true,
                (Some(_), None, _) => missing("max", "[x, y, z]", span),
                (None, Some(_), _) => missing("min", "[x, y, z]", span),
                _ => {
                    missing("radius", "1", span).help("or write a box, `min = [-1, -1, -1], max = [1, 1, 1]`")
                }
            },
        };
        reader.report(report);
        false
    }
}

fn missing(field: &str, example: &str, span: Span) -> Diagnostic {
    Diagnostic::error(Code::MissingField, format!("missing field `{field}` of quadric within"))
        .at(span, format!("needs `{field} = {example}`"))
}

impl Within {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        boxed(self.min, self.max, reader)
    }
}

/// Whether a box has an inside; a report where it has none.
fn boxed(min: Sp<DVec3>, max: Sp<DVec3>, reader: &mut Reader<'_>) -> bool {
    let (low, high) = (min.to_array(), max.to_array());
    let Some(axis) = (0..3).find(|axis| low[*axis] >= high[*axis]) else { return true };
    let message = format!(
        "`max[{axis}]` must be greater than `min[{axis}]`, found {} and {}",
        show_number(high[axis]),
        show_number(low[axis])
    );
    let report = Diagnostic::error(Code::OutOfRange, message);
    reader.report(report.at(max.span, "not greater").also(min.span, "`min`"));
    false
}
