//! Plane curves on which a formula is zero.

use glam::DVec2;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::construct::table;
use crate::language::spec::formula::Formula;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;

table! {
    /// The curve in a box of the x, y plane on which a formula of x and y is zero. As many parts as there are: closed
    /// ones, and open ones that end on the border of the box. The formula has a value and no kinks in the box; a curve
    /// that crosses itself, has a cusp or touches the border is an error that names the place.
    "implicit" pub Implicit {
        /// The formula: the curve is where it is 0. Where it is less, is to the left of the curve.
        f: Sp<Formula>;
        /// The lower left corner of the box.
        min: Sp<DVec2>;
        /// The upper right corner of the box.
        max: Sp<DVec2>;
    }
    checked check
}

impl Implicit {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.min.x < self.max.x && self.min.y < self.max.y {
            return true;
        }
        let report = Diagnostic::error(Code::OutOfRange, "`max` must be greater than `min` in x and in y")
            .at(self.max.span, "not greater")
            .also(self.min.span, "the lower left corner");
        reader.report(report);
        false
    }
}
