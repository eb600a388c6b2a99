//! Curves of a document into curves of the kernel.

use glam::DVec3;

use super::{Builder, conic};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, EllipseArc, Helix, Polyline, interpolate, interpolate_closed,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{Arc, Bezier, Curve, NaturalSpline, Point, Sp};

pub(super) fn positions(points: &[Sp<Point>]) -> Vec<DVec3> {
    points.iter().map(|point| point.position).collect()
}

impl Builder<'_> {
    /// A curve of a kind that has one part.
    pub(super) fn curve(&mut self, curve: &Curve, span: Span) -> Option<AnyCurve> {
        match curve {
            Curve::Line(line) => {
                Polyline::new(vec![line.from.position, line.to.position], false).map(AnyCurve::Polyline)
            }
            Curve::Polyline(line) => {
                Polyline::new(positions(&line.points), line.closed.value).map(AnyCurve::Polyline)
            }
            Curve::Circle(circle) => {
                let radius = circle.radius.value;
                Some(AnyCurve::Ellipse(EllipseArc::full(circle.center.position, radius, radius)))
            }
            Curve::Ellipse(ellipse) => Some(conic::ellipse(ellipse)),
            Curve::Parabola(parabola) => self.parabola(parabola, span),
            Curve::Hyperbola(hyperbola) => self.hyperbola(hyperbola, span),
            Curve::Conic(conic) => self.conic(conic, span),
            Curve::Formula(formula) => self.formula_curve(formula, span),
            Curve::Arc(arc) => self.arc(arc, span),
            Curve::Helix(helix) => Some(AnyCurve::Helix(Helix {
                radius: helix.radius.value,
                end_radius: helix.end_radius.map_or(helix.radius.value, |radius| radius.value),
                pitch: helix.pitch.value,
                turns: helix.turns.value,
            })),
            Curve::NaturalSpline(spline) => self.natural_spline(spline, span),
            Curve::Bezier(bezier) => self.bezier(bezier, span),
            Curve::Spline(spline) => self.spline(spline, span),
            Curve::FunctionSpline(spline) => self.function_spline(spline, span),
            Curve::Hermite(curve) => self.hermite(curve, span),
            Curve::CatmullRom(curve) => self.catmull_rom(curve, span),
            Curve::Cardinal(curve) => self.cardinal(curve, span),
            Curve::KochanekBartels(curve) => self.kochanek_bartels(curve, span),
            Curve::BetaSpline(curve) => self.beta_spline(curve, span),
            Curve::Cubic(curve) => self.cubic(curve, span),
            Curve::SubdivisionCurve(curve) => self.subdivision_curve(curve, span),
            Curve::BSpline(spline) => self.b_spline(spline, span),
            Curve::Nurbs(spline) => self.nurbs(spline, span),
            Curve::Path(path) => self.path(path),
            // Their parts are made where parts are asked for.
            Curve::Svg(_)
            | Curve::Dxf(_)
            | Curve::Group(_)
            | Curve::Part(_)
            | Curve::Implicit(_)
            | Curve::Offset(_)
            | Curve::Union(_)
            | Curve::Difference(_)
            | Curve::Intersection(_)
            | Curve::Xor(_)
            | Curve::Fillet(_)
            | Curve::Chamfer(_)
            | Curve::Reverse(_)
            | Curve::Transform(_) => None,
        }
    }

    fn arc(&mut self, arc: &Arc, span: Span) -> Option<AnyCurve> {
        match arc {
            Arc::Center(arc) => Some(AnyCurve::Ellipse(EllipseArc::circle(
                arc.center.position,
                arc.radius.value,
                arc.from.value,
                arc.to.value,
            ))),
            Arc::Through([start, through, end]) => {
                self.arc_through(start.position, through.position, end.position, span)
            }
        }
    }

    pub(super) fn arc_through(
        &mut self,
        start: DVec3,
        through: DVec3,
        end: DVec3,
        span: Span,
    ) -> Option<AnyCurve> {
        let arc = EllipseArc::through(start, through, end);
        if arc.is_none() {
            let message = "three points determine no arc: they lie on one line";
            self.report(Diagnostic::error(Code::Degenerate, message).at(span, "on one line"));
        }
        arc.map(AnyCurve::Ellipse)
    }

    fn natural_spline(&mut self, spline: &NaturalSpline, span: Span) -> Option<AnyCurve> {
        let points = positions(&spline.points);
        let closed = spline.closed.value;
        let numbers = self.numbers(&points, closed, &spline.parameters.value, span)?;
        self.through(&points, &numbers, closed, span)
    }

    pub(super) fn through(
        &mut self,
        points: &[DVec3],
        numbers: &[f64],
        closed: bool,
        span: Span,
    ) -> Option<AnyCurve> {
        let built = if closed { interpolate_closed(points, numbers) } else { interpolate(points, numbers) };
        self.made(built, span)
    }

    pub(super) fn degenerate<T>(&mut self, message: &str, span: Span) -> Option<T> {
        self.report(Diagnostic::error(Code::Degenerate, message).at(span, "no curve"));
        None
    }

    fn bezier(&mut self, bezier: &Bezier, span: Span) -> Option<AnyCurve> {
        if let Some(weights) = &bezier.weights {
            return self.rational_bezier(bezier, weights);
        }
        match BezierSpline::new(bezier.degree.value as usize, positions(&bezier.points)) {
            Ok(curve) => Some(AnyCurve::Bezier(curve)),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }
}
