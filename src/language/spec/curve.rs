//! Curves: the kinds, and those that a few numbers determine.

use glam::DVec3;

use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::arc::Arc;
use crate::language::spec::bspline::{BSpline, Nurbs};
use crate::language::spec::check::Check;
use crate::language::spec::conic::{Conic, Hyperbola, Parabola, check_turn};
use crate::language::spec::construct::{kinds, table};
use crate::language::spec::cubic::{BetaSpline, Cubic};
use crate::language::spec::dxf::Dxf;
use crate::language::spec::formula::FormulaCurve;
use crate::language::spec::implicit::Implicit;
use crate::language::spec::operation::{Chamfer, Fillet, Offset, ProfileSet};
use crate::language::spec::part::{CurveGroup, Part};
use crate::language::spec::path::Path;
use crate::language::spec::point::{Point, Scale};
use crate::language::spec::reader::Reader;
use crate::language::spec::reference::CurveReference;
use crate::language::spec::spanned::Sp;
use crate::language::spec::spline::{Bezier, NaturalSpline, check_closed, report_repeated};
use crate::language::spec::spline_end::{FunctionSpline, Spline};
use crate::language::spec::subdivision_curve::SubdivisionCurve;
use crate::language::spec::svg::Svg;
use crate::language::spec::tangent::{Cardinal, CatmullRom, Hermite, KochanekBartels};

kinds! {
    /// A curve of one kind.
    "curve" Curve {
        /// A straight line between two points.
        Line(Line) = "line";
        /// Straight lines from point to point.
        Polyline(Polyline) = "polyline";
        /// A full circle.
        Circle(Circle) = "circle";
        /// An ellipse, or a part of one.
        Ellipse(Ellipse) = "ellipse";
        /// A part of a parabola.
        Parabola(Parabola) = "parabola";
        /// A part of a hyperbola.
        Hyperbola(Hyperbola) = "hyperbola";
        /// A part of an ellipse, hyperbola or parabola in space.
        Conic(Conic) = "conic";
        /// A part of a circle.
        Arc(Arc) = "arc";
        /// A curve by formulas: y = f(x), or x, y, z of t.
        Formula(FormulaCurve) = "formula";
        /// A screw line that climbs along +y.
        Helix(Helix) = "helix";
        /// A smooth curve through points.
        NaturalSpline(NaturalSpline) = "natural-spline";
        /// A smooth curve through points, with a say in what it does at its ends.
        Spline(Spline) = "spline";
        /// The graph of a function known at some places.
        FunctionSpline(FunctionSpline) = "function-spline";
        /// A curve through points with given derivatives.
        Hermite(Hermite) = "hermite";
        /// A smooth curve through points, each piece shaped by the points near it.
        CatmullRom(CatmullRom) = "catmull-rom";
        /// The same, tighter or looser.
        Cardinal(Cardinal) = "cardinal";
        /// The same, with tension, continuity and bias.
        KochanekBartels(KochanekBartels) = "kochanek-bartels";
        /// Bezier curves joined end to end.
        Bezier(Bezier) = "bezier";
        /// A smooth curve drawn towards its control points.
        BSpline(BSpline) = "b-spline";
        /// A B-spline whose points have weights: circles and ellipses exactly.
        Nurbs(Nurbs) = "nurbs";
        /// A curve drawn towards its control points, shaped by bias and tension.
        BetaSpline(BetaSpline) = "beta-spline";
        /// Cubic pieces by any basis.
        Cubic(Cubic) = "cubic";
        /// A polygon whose corners are rounded again and again.
        SubdivisionCurve(SubdivisionCurve) = "subdivision";
        /// Lines, arcs and splines joined end to end.
        Path(Path) = "path";
        /// Where a formula of x and y is zero.
        Implicit(Implicit) = "implicit";
        /// The path of an SVG drawing.
        Svg(Svg) = "svg";
        /// The curves of a drawing from a file.
        Dxf(Dxf) = "dxf";
        /// Several curves as the parts of one.
        Group(CurveGroup) = "group";
        /// One part of a curve that has several.
        Part(Part) = "part";
        /// A closed curve, moved outward or inward.
        Offset(Offset) = "offset";
        /// What lies in any of several closed curves.
        Union(ProfileSet) = "union";
        /// What lies in a closed curve and not in others.
        Difference(ProfileSet) = "difference";
        /// What lies in all of several closed curves.
        Intersection(ProfileSet) = "intersection";
        /// What lies in an odd number of several closed curves. Where these cross, its parts touch in corners: lines show
        /// them, but no solid stands on them.
        Xor(ProfileSet) = "xor";
        /// A flat curve with rounded corners.
        Fillet(Fillet) = "fillet";
        /// A flat curve with corners cut off.
        Chamfer(Chamfer) = "chamfer";
        /// Another curve, run through from its end to its start.
        Reverse(Reverse) = "reverse";
        /// Another curve, scaled, rotated and moved.
        Transform(Transform) = "transform";
    }
}

table! {
    /// A straight line between two points.
    "line" pub Line {
        /// Where it starts.
        from: Sp<Point>;
        /// Where it ends.
        to: Sp<Point>;
    }
    checked check
}

table! {
    /// Straight lines from point to point, with a corner at each.
    "polyline" pub Polyline {
        /// The corners, in order.
        points: Vec<Sp<Point>> => Check::items(2);
        /// Whether a last line leads back to the first point.
        closed: Sp<bool> = false;
    }
    checked check
}

table! {
    /// A full circle in the x, y plane. It starts at the right and turns counterclockwise.
    "circle" pub Circle {
        /// Radius, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// The center.
        center: Sp<Point> = Point::ORIGIN;
    }
}

table! {
    /// An ellipse in the x, y plane, its axes along x and y, or a part of it. It starts at the right and turns
    /// counterclockwise.
    "ellipse" pub Ellipse {
        /// Half of the width and half of the height, in the document's unit.
        radii: Sp<glam::DVec2> => Check::above(0.0);
        /// The center.
        center: Sp<Point> = Point::ORIGIN;
        /// Where an arc starts, in degrees: the angle on the circle of which this is the stretched image.
        from: Sp<f64> = 0.0 => Check::within(-3600.0, 3600.0);
        /// Where an arc ends, in degrees; less than `from` turns clockwise.
        to: Sp<f64> = 360.0 => Check::within(-3600.0, 3600.0);
    }
    checked check
}

table! {
    /// A screw line around the y axis: it starts at `[radius, 0, 0]` and climbs along +y, counterclockwise seen from above.
    "helix" pub Helix {
        /// Radius at the start, in the document's unit.
        radius: Sp<f64> => Check::above(0.0);
        /// Radius at the end; the same as at the start when it is not written.
        end_radius: Option<Sp<f64>> => Check::above(0.0);
        /// How far it climbs in one turn, in the document's unit; 0 winds a flat ring or spiral.
        pitch: Sp<f64>;
        /// How many turns it makes; part turns are allowed.
        turns: Sp<f64> => Check::above(0.0).up_to(10_000.0);
    }
}

table! {
    /// Another curve, run through from its end to its start.
    "reverse" pub Reverse {
        /// The curve.
        of: CurveReference;
    }
}

table! {
    /// Another curve, scaled, then rotated, then moved.
    "transform" pub Transform {
        /// The curve.
        of: CurveReference;
        /// Factor of size: a number, or one for each axis.
        scale: Sp<Scale> = Scale(DVec3::ONE) => Check::nonzero();
        /// Degrees about the x axis, then the y axis, then the z axis.
        rotate: Sp<DVec3> = DVec3::ZERO;
        /// How far it is moved, in the document's unit.
        at: Sp<DVec3> = DVec3::ZERO;
    }
}

impl Ellipse {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        let last = if self.to.span.is_none() { self.from.span } else { self.to.span };
        check_turn(self.from.value, self.to.value, last, reader)
    }
}

impl Line {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        if self.from.position != self.to.position {
            return true;
        }
        let report =
            Diagnostic::error(Code::Degenerate, "a line has two different ends, found the same point twice")
                .at(self.to.span, "equal to `from`")
                .also(self.from.span, "the start");
        reader.report(report);
        false
    }
}

impl Polyline {
    fn check(&self, _: Span, reader: &mut Reader<'_>) -> bool {
        check_closed("polyline", self.points.len(), self.closed, reader)
            && report_repeated(&self.points, self.closed.value, "points", reader)
    }
}
