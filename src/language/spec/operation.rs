//! Operations on flat curves: parallels, sets, and corners.

use crate::language::spec::check::Check;
use crate::language::spec::construct::{choices, table};
use crate::language::spec::reference::CurveReference;
use crate::language::spec::spanned::Sp;

table! {
    /// A closed, flat curve moved outward or inward by the same distance everywhere. Lines stay lines, arcs of circles
    /// stay arcs; where little is left between two sides, parts split off or vanish. Parts inside others are holes, and
    /// shrink where outlines grow.
    "offset" pub Offset {
        /// The curve: closed, in the x, y plane, of any number of parts.
        of: CurveReference;
        /// How far it is moved, in the document's unit; more than 0 is outward, less than 0 inward.
        distance: Sp<f64> => Check::nonzero();
        /// What fills the gaps that open at corners.
        corner: Sp<OffsetCorner> = OffsetCorner::Round;
        /// With `corner = "miter"`: how many distances a tip may stand away from its corner; longer ones are beveled.
        miter_limit: Sp<f64> = 4.0 => Check::at_least(1.0);
    }
}

choices! {
    /// What fills the gap that opens at a corner.
    OffsetCorner {
        /// An arc around the corner.
        Round = "round";
        /// The sides, drawn on until they meet in a tip.
        Miter = "miter";
        /// A straight cut.
        Bevel = "bevel";
    }
}

table! {
    /// What closed, flat curves enclose, put together. Inside of a curve of several parts is what an odd number of them
    /// goes around. The result has as many parts as it needs, and follows the curves it is made of exactly.
    "profile set" pub ProfileSet {
        /// The curves: closed, in the x, y plane, of any number of parts. Of a difference, the first is what the others
        /// are taken from.
        of: Vec<CurveReference> => Check::items(2);
    }
}

table! {
    /// A flat curve whose corners are rounded by arcs that are tangent to both sides.
    "fillet" pub Fillet {
        /// The curve, open or closed, in the x, y plane, of any number of parts.
        of: CurveReference;
        /// The radius of the arcs, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Which corners, counted from 0 along the curve, part after part; all of them when it is not written. A closed
        /// curve that starts in a corner has its first one there.
        corners: Vec<Sp<u32>> = Vec::new();
    }
}

table! {
    /// A flat curve whose corners are cut off straight.
    "chamfer" pub Chamfer {
        /// The curve, open or closed, in the x, y plane, of any number of parts.
        of: CurveReference;
        /// How far from the corner, along each side, the cut begins, in the document's unit.
        distance: Sp<f64> => Check::above(0.0);
        /// Which corners, counted from 0 along the curve, part after part; all of them when it is not written. A closed
        /// curve that starts in a corner has its first one there.
        corners: Vec<Sp<u32>> = Vec::new();
    }
}
