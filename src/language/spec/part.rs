//! Curves of several parts: put together, and taken apart.

use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reference::CurveReference;
use crate::language::spec::spanned::Sp;

table! {
    /// Several curves as the parts of one, where a curve may have several: the profile of an extrude or a sheet, the
    /// curves of a wire, operations on profiles. They are not joined.
    "curve group" pub CurveGroup {
        /// The curves, by name or in place; all parts of each.
        of: Vec<CurveReference> => Check::items(1);
    }
}

table! {
    /// One part of a curve that has several, such as one letter of an SVG path.
    "part" pub Part {
        /// The curve.
        of: CurveReference;
        /// Which part, counted from 0 in the order of the curve.
        index: Sp<u32>;
    }
}
