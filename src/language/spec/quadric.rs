//! Quadrics by their equation.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
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
        /// The box that it ends at, `{ min = [x, y, z], max = [x, y, z] }`. Only an ellipsoid ends by itself. Of a cone
        /// both halves are made, as far as the box holds them; they meet in the apex.
        within: Option<Within>;
        /// Whether it is closed where it ends, so that the result is the solid of all points inside of it and of `within`.
        caps: Sp<bool> = false;
    }
    checked check
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

impl Within {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let (low, high) = (self.min.to_array(), self.max.to_array());
        let Some(axis) = (0..3).find(|axis| low[*axis] >= high[*axis]) else { return true };
        let message = format!(
            "`max[{axis}]` must be greater than `min[{axis}]`, found {} and {}",
            show_number(high[axis]),
            show_number(low[axis])
        );
        let report = Diagnostic::error(Code::OutOfRange, message);
        reader.report(report.at(self.max.span, "not greater").also(self.min.span, "`min`"));
        false
    }
}
