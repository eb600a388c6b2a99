//! B-splines, NURBS and rational Bezier curves of a document into curves of the kernel.

use glam::{DVec3, DVec4};

use super::Builder;
use super::curve::positions;
use crate::geometry::curve::control::{BSpline, Control, KnotError, Knots};
use crate::geometry::curve::{AnyCurve, BezierSpline, RationalError, RationalSpline};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec;
use crate::language::spec::{KnotRule, Point, Sp};

impl Builder<'_> {
    pub(super) fn b_spline(&mut self, spline: &spec::BSpline, span: Span) -> Option<AnyCurve> {
        let degree = spline.degree.value as usize;
        let points = positions(&spline.points);
        match with_knots(degree, points, spline.closed.value, spline.knots.as_ref()) {
            Ok(spline) => self.pieces(&spline, span),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    /// From the first to the last point, cubic where there are points enough.
    pub(super) fn clamped_b_spline(&mut self, points: Vec<DVec3>, span: Span) -> Option<AnyCurve> {
        let degree = points.len().saturating_sub(1).min(3);
        match with_knots(degree, points, false, None) {
            Ok(spline) => self.pieces(&spline, span),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    fn pieces(&mut self, spline: &BSpline<DVec3>, span: Span) -> Option<AnyCurve> {
        let (points, breaks) = spline.to_bezier();
        match BezierSpline::with_knots(spline.knots().degree(), points, breaks) {
            Ok(curve) => Some(AnyCurve::Bezier(curve)),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    pub(super) fn nurbs(&mut self, spline: &spec::Nurbs, span: Span) -> Option<AnyCurve> {
        let degree = spline.degree.value as usize;
        let points = homogeneous(&spline.points, &spline.weights);
        match with_knots(degree, points, spline.closed.value, spline.knots.as_ref()) {
            Ok(curve) => {
                let (points, breaks) = curve.to_bezier();
                self.rational(degree, points, breaks, spline.weights.span)
            }
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    pub(super) fn rational_bezier(
        &mut self,
        bezier: &spec::Bezier,
        weights: &Sp<Vec<Sp<f64>>>,
    ) -> Option<AnyCurve> {
        let degree = bezier.degree.value as usize;
        let breaks = (0..=(bezier.points.len() - 1) / degree).map(|knot| knot as f64).collect();
        self.rational(degree, homogeneous(&bezier.points, weights), breaks, weights.span)
    }

    pub(super) fn rational(
        &mut self,
        degree: usize,
        points: Vec<DVec4>,
        breaks: Vec<f64>,
        weights: Span,
    ) -> Option<AnyCurve> {
        let place = |piece: usize| breaks.get(piece).copied().unwrap_or_default();
        let message = match RationalSpline::new(degree, points, breaks.clone()) {
            Ok(curve) => return Some(AnyCurve::Rational(curve)),
            Err(RationalError::Infinite { piece }) => {
                format!("no finite point holds the curve at parameter {}: it runs to infinity", place(piece))
            }
            Err(error) => error.to_string(),
        };
        let report = Diagnostic::error(Code::BadWeight, message)
            .at(weights, "too few weights are greater than 0")
            .help("at every knot one of the points that act there needs a weight greater than 0");
        self.report(report);
        None
    }
}

fn homogeneous(points: &[Sp<Point>], weights: &[Sp<f64>]) -> Vec<DVec4> {
    let pairs = points.iter().zip(weights);
    pairs.map(|(point, weight)| RationalSpline::homogeneous(point.position, weight.value)).collect()
}

fn with_knots<P: Control>(
    degree: usize,
    points: Vec<P>,
    closed: bool,
    rule: Option<&Sp<KnotRule>>,
) -> Result<BSpline<P>, KnotError> {
    let given = match rule.map(|rule| &rule.value) {
        Some(KnotRule::Given(numbers)) => Some(numbers.iter().map(|number| number.value).collect::<Vec<_>>()),
        _ => None,
    };
    if closed {
        let even = || (0..=points.len()).map(|knot| knot as f64).collect();
        return BSpline::closed(degree, &points, &given.unwrap_or_else(even));
    }
    let few = KnotError::Few { least: degree + 1, found: points.len() };
    let knots = match (given, rule.map(|rule| &rule.value)) {
        (Some(numbers), _) => Knots::new(degree, numbers)?,
        (None, Some(KnotRule::Uniform)) => Knots::uniform(degree, points.len()).ok_or(few)?,
        (None, _) => Knots::clamped(degree, points.len()).ok_or(few)?,
    };
    BSpline::new(knots, points).ok_or(few)
}
