//! Curves shown as lines.

use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::reference::CurveReference;

table! {
    /// Curves as lines: without width, without surface. Viewers draw them a pixel or so wide in the color of their
    /// material, without light; a material with textures cannot be shown. Corners of polylines are kept exactly,
    /// curved parts lie within the tolerance.
    "wire" pub Wire {
        /// The curves, of any kind and of any number of parts: their names, or curves in place. Closed ones are drawn back to their start.
        curves: Vec<CurveReference> => Check::items(1);
    }
}
