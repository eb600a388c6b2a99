//! Surfaces by formulas.

use glam::DVec2;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::formula::Formula;
use crate::language::spec::grid::Directions;
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;
use crate::language::value::show_number;

table! {
    /// A surface by formulas of u and v: shells, flowers, Moebius bands, whatever has an equation. Angles are in degrees.
    /// The front is the side from which v lies to the left of the way along u; a surface that encloses a volume shows its
    /// outside. Where the formula comes back to its start it is joined without a seam, and where a whole side is one point
    /// that is a pole. Kinks along lines of constant u or v (of `abs`, `min`, `max`, `if`, `%`) become edges. Where a formula has no
    /// finite value, or jumps, that is an error.
    "parametric" pub Parametric {
        /// The x coordinate, as a formula: `"= cos(u) * (3 + cos(v))"`.
        x: Sp<Formula>;
        /// The y coordinate, which goes up.
        y: Sp<Formula>;
        /// The z coordinate.
        z: Sp<Formula>;
        /// The first and the last value of u, the last one greater: `[0, 360]`.
        u: Sp<DVec2>;
        /// The first and the last value of v.
        v: Sp<DVec2>;
        /// Directions in which the surface must come back to its start: `["u"]`, `["v"]` or both. It may do so with a twist,
        /// as a Moebius band, where v runs against itself. A surface that does not is an error that says how far its ends
        /// are apart; one that does without being asked to is joined all the same.
        closed: Sp<Directions> = Directions::default();
        /// How thick it is, half to each side: the result is a closed skin, with walls along open sides. Without it the
        /// surface is one sheet, seen from its front alone unless the material says `double-sided = true`. A surface that
        /// closes with a twist has no back: it needs one or the other.
        thickness: Option<Sp<f64>> => Check::above(0.0);
    }
    checked check
}

impl Parametric {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let mut good = true;
        for (name, range) in [("u", self.u), ("v", self.v)] {
            if range.value.x < range.value.y {
                continue;
            }
            let (from, to) = (show_number(range.value.x), show_number(range.value.y));
            let message = format!("the range of `{name}` must end above its start, found [{from}, {to}]");
            let report = Diagnostic::error(Code::OutOfRange, message).at(range.span, "no range");
            let way = format!(
                "to look at the back, write -{name} for {name} in the formulas and turn the signs of its range"
            );
            reader.report(if range.value.x > range.value.y { report.help(way) } else { report });
            good = false;
        }
        good
    }
}
