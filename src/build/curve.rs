//! Curves of a document into curves of the kernel.

use glam::DVec3;

use super::{Builder, conic};
use crate::geometry::curve::{
    AnyCurve, BezierSpline, Continuity, Curve as _, EllipseArc, Helix, Parametrization, Path, Polyline, Side,
    interpolate, interpolate_closed, parameters,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{
    Arc, ArcSegment, Bezier, Curve, EndRule, Joint, NaturalSpline, Point, Segment, Sp,
};

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
            Curve::Svg(_) | Curve::Group(_) | Curve::Part(_) | Curve::Reverse(_) | Curve::Transform(_) => {
                None
            }
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

    fn arc_through(&mut self, start: DVec3, through: DVec3, end: DVec3, span: Span) -> Option<AnyCurve> {
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

    fn through(&mut self, points: &[DVec3], numbers: &[f64], closed: bool, span: Span) -> Option<AnyCurve> {
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

    fn path(&mut self, path: &crate::language::spec::Path) -> Option<AnyCurve> {
        let mut curves = Vec::new();
        let mut current = path.start.position;
        for segment in &path.segments {
            let curve = self.segment(current, &segment.value, segment.span)?;
            current = curve.evaluate(curve.domain().end, Side::Before).point;
            curves.push(curve);
        }
        if path.closed.value && current != path.start.position {
            // A gap of rounding alone is closed by moving nothing: the seam is as good as any joint.
            curves.extend(Polyline::new(vec![current, path.start.position], false).map(AnyCurve::Polyline));
        }
        let built = Path::new(curves)?;
        self.check_joints(path, &built);
        Some(AnyCurve::Path(built))
    }

    fn segment(&mut self, start: DVec3, segment: &Segment, span: Span) -> Option<AnyCurve> {
        let with_start = |points: &[Sp<Point>]| {
            let mut all = vec![start];
            all.extend(positions(points));
            all
        };
        match segment {
            Segment::Line(points) => Polyline::new(with_start(points), false).map(AnyCurve::Polyline),
            Segment::CatmullRom(points) => {
                let ends = (false, EndRule::Natural);
                self.catmull_rom_through(&with_start(points), 0.5, ends, span)
            }
            Segment::BSpline(points) => self.clamped_b_spline(with_start(points), span),
            Segment::NaturalSpline(points) => {
                let points = with_start(points);
                match parameters(&points, false, Parametrization::Chordal) {
                    Ok(numbers) => self.through(&points, &numbers, false, span),
                    Err(error) => self.degenerate(&error.to_string(), span),
                }
            }
            Segment::Bezier(points) => BezierSpline::new(3, with_start(points)).ok().map(AnyCurve::Bezier),
            Segment::Quadratic(points) => BezierSpline::new(2, with_start(points)).ok().map(AnyCurve::Bezier),
            Segment::Arc(ArcSegment::Through { through, to }) => {
                self.arc_through(start, through.position, to.position, span)
            }
            Segment::Arc(ArcSegment::Center { center, angle }) => {
                self.arc_about(start, center, angle.value, span)
            }
        }
    }

    fn arc_about(&mut self, start: DVec3, center: &Sp<Point>, angle: f64, span: Span) -> Option<AnyCurve> {
        let spoke = start - center.position;
        if spoke.truncate().length() == 0.0 {
            let message = "the center of an arc is the point it starts from";
            self.report(
                Diagnostic::error(Code::Degenerate, message)
                    .at(center.span, "no radius")
                    .also(span, "the arc"),
            );
            return None;
        }
        let y = DVec3::new(-spoke.y, spoke.x, 0.0);
        Some(AnyCurve::Ellipse(EllipseArc { center: center.position, x: spoke, y, from: 0.0, to: angle }))
    }

    /// Joints that are declared smooth must be.
    fn check_joints(&mut self, path: &crate::language::spec::Path, built: &Path) {
        let Some(joints) = &path.joints else { return };
        let inner = path.segments.len() - 1;
        for (index, joint) in joints.iter().enumerate() {
            // The joint after the last inner one is the seam of a closed path, at the start.
            let place = if index == inner { 0 } else { index + 1 };
            if joint.value == Joint::Smooth && built.continuity(place) < Continuity::G1 {
                let t = place as f64;
                let before = if place == 0 { built.domain().end } else { t };
                let (before, after) =
                    (built.direction(before, Side::Before), built.direction(t, Side::After));
                let turn = crate::geometry::number::atan2(before.cross(after).length(), before.dot(after));
                let message = format!(
                    "joint {index} of this path is declared smooth, but the direction turns by {:.3} degrees there",
                    turn.to_degrees()
                );
                let segment = path.segments[place].span;
                let report = Diagnostic::error(Code::BrokenJoint, message)
                    .at(joint.span, "does not hold")
                    .also(segment, "the segment that starts there")
                    .help("write \"corner\", or move the points so that both segments have one direction");
                self.report(report);
            }
        }
    }
}
