//! Drawings of CAD programs as curves.

use glam::DVec2;

use crate::language::spec::check::Check;
use crate::language::spec::construct::table;
use crate::language::spec::import::FilePath;
use crate::language::spec::spanned::Sp;

table! {
    /// The lines, polylines with bulges, arcs, circles, ellipses and splines of a drawing (DXF, text or binary), blocks in
    /// their places. x and y are those of the drawing. Curves whose ends meet are joined; each that is left is a part of the
    /// curve, in the order of the file.
    "dxf" pub Dxf {
        /// The file; the path is relative to this document and stays inside the project.
        file: Sp<FilePath>;
        /// Only what lies on this layer of the drawing.
        layer: Option<Sp<String>>;
        /// What one unit of the drawing is in the document's unit.
        scale: Sp<f64> = 1.0 => Check::above(0.0);
        /// The place of the drawing, in its own coordinates, that comes to lie at `[0, 0]`.
        origin: Sp<DVec2> = DVec2::ZERO;
        /// Ends within this distance, in the unit of the drawing, are joined; 0 joins none.
        join: Sp<f64> = 1e-6 => Check::at_least(0.0);
    }
}
