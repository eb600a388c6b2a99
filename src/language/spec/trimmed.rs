//! Surfaces cut off along lines of their parameters.

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::construct::table;
use crate::language::spec::profile::Fill;
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::{CurveReference, ShapeReference};
use crate::language::spec::spanned::Sp;

table! {
    /// A part of another surface, inside closed lines that are drawn on its parameters: x counts along its u, y along its
    /// v. `kiln sample --shape NAME FILE` says from where to where u and v go. The lines follow the surface, however it bends;
    /// they may run over its edges, which stay sharp, and on a surface that closes over its seam, where u or v go on counting.
    "trimmed" pub Trimmed {
        /// The surface: one of patches, Bezier triangles, Hermite, B-spline, NURBS, Coons, Gordon, ruled, translational
        /// or loft surfaces without caps.
        of: ShapeReference;
        /// The outline: the name of a closed curve, or a curve in place, in the parameters of the surface. Without it the
        /// whole surface is meant, and `holes` are cut out of it. A curve of several parts gives several faces: outlines, with
        /// the parts inside them as holes.
        profile: Option<CurveReference>;
        /// Which parts of a profile of several are holes in others.
        fill: Sp<Fill> = Fill::EvenOdd;
        /// Closed curves inside the outline that are cut out.
        holes: Vec<CurveReference> = Vec::new();
    }
    checked check
}

impl Trimmed {
    fn check(&self, span: Span, reader: &mut Reader<'_>) -> bool {
        if self.profile.is_some() || !self.holes.is_empty() {
            return true;
        }
        let report = Diagnostic::error(Code::MissingField, "a trimmed surface needs `profile` or `holes`")
            .at(span, "nothing is cut off")
            .help("write `profile = { circle = { radius = 0.4, center = [0.5, 0.5] } }`");
        reader.report(report);
        false
    }
}
