//! B-spline and NURBS surfaces: grids of control points, knots both ways, weights.

use glam::DVec3;

use crate::language::source::Span;
use crate::language::spec::bspline::check_weights;
use crate::language::spec::construct::table;
use crate::language::spec::grid::{Degrees, Directions, Rows, direction, same_size};
use crate::language::spec::knots::{KnotFrame, KnotRule};
use crate::language::spec::reader::Reader;
use crate::language::spec::spanned::Sp;

table! {
    /// A B-spline surface: drawn towards its control points, in the hull of its neighbors everywhere, and of degree
    /// 3 with a continuous curvature.
    "b-spline surface" pub BSplineSurface {
        /// Control points in a grid: rows of points `[x, y, z]`. u runs along a row, v from row to row. In each
        /// direction at least one more than the degree, or 3 where it is closed.
        control: Sp<Rows<DVec3>>;
        /// Degree of the pieces, one for both directions or `[u, v]`: 1 is straight, 2 has continuous tangents, 3
        /// continuous curvature.
        degree: Sp<Degrees> = Degrees { u: 3, v: 3 };
        /// Directions in which it runs back to its start, as smooth there as everywhere: `["u"]`, `["v"]` or both.
        closed: Sp<Directions> = Directions::default();
        /// The values of u at which pieces meet, as `knots` of the curve `b-spline`: `"clamped"` (reaches the first
        /// and last points; the rule where it is open), `"uniform"` (the rule where it is closed), or numbers.
        knots_u: Option<Sp<KnotRule>>;
        /// The same of v.
        knots_v: Option<Sp<KnotRule>>;
    }
    checked check
}

table! {
    /// A rational B-spline surface: as `b-spline`, with a weight for each control point. It makes spheres, cones and
    /// cylinders exactly.
    "nurbs surface" pub NurbsSurface {
        /// Control points in a grid: rows of points `[x, y, z]`. u runs along a row, v from row to row. A point of
        /// weight 0 lies at infinity: what is written is then its direction, and its length says how far the surface
        /// is drawn that way.
        control: Sp<Rows<DVec3>>;
        /// One for each control point, at least 0: how strongly it draws the surface.
        weights: Sp<Rows<f64>>;
        /// Degree of the pieces, one for both directions or `[u, v]`.
        degree: Sp<Degrees> = Degrees { u: 3, v: 3 };
        /// Directions in which it runs back to its start: `["u"]`, `["v"]` or both.
        closed: Sp<Directions> = Directions::default();
        /// The values of u at which pieces meet; as of a `b-spline`.
        knots_u: Option<Sp<KnotRule>>;
        /// The same of v.
        knots_v: Option<Sp<KnotRule>>;
    }
    checked check
}

impl BSplineSurface {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_both(&self.control, self.degree, self.closed, (&self.knots_u, &self.knots_v), reader)
    }
}

impl NurbsSurface {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let knots = (&self.knots_u, &self.knots_v);
        let framed = check_both(&self.control, self.degree, self.closed, knots, reader);
        let sized = same_size(("weights", &self.weights), ("control", &self.control), reader);
        let flat = Sp::new(self.weights.items().copied().collect::<Vec<_>>(), self.weights.span);
        sized && check_weights(&flat, flat.len(), reader) && framed
    }
}

fn check_both(
    control: &Sp<Rows<DVec3>>,
    degree: Sp<Degrees>,
    closed: Sp<Directions>,
    (knots_u, knots_v): (&Option<Sp<KnotRule>>, &Option<Sp<KnotRule>>),
    reader: &mut Reader<'_>,
) -> bool {
    let u = KnotFrame {
        what: "surface (along u)",
        points: Sp::new(control.columns(), control.span),
        degree: Sp::new(degree.u, degree.span),
        closed: direction(&closed, |closed| closed.u),
        knots: knots_u.as_ref(),
    };
    let v = KnotFrame {
        what: "surface (along v)",
        points: Sp::new(control.rows(), control.span),
        degree: Sp::new(degree.v, degree.span),
        closed: direction(&closed, |closed| closed.v),
        knots: knots_v.as_ref(),
    };
    let along_u = u.check(reader);
    v.check(reader) && along_u
}
