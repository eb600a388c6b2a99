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
    let knots = knots(degree, points.len(), closed, rule)?;
    let count = knots.points();
    let points: Vec<P> = points.iter().cycle().take(count).copied().collect();
    BSpline::new(knots, points).ok_or(KnotError::Few { least: degree + 1, found: count })
}

/// The knots that a rule gives for so many points; of what is closed, for as many more as the degree: the first
/// points again.
pub(super) fn knots(
    degree: usize,
    points: usize,
    closed: bool,
    rule: Option<&Sp<KnotRule>>,
) -> Result<Knots, KnotError> {
    let few = KnotError::Few { least: degree + 1, found: points };
    let rule = rule.map(|rule| &rule.value);
    if let Some(KnotRule::Given(numbers)) = rule {
        let numbers: Vec<f64> = numbers.iter().map(|number| number.value).collect();
        return if closed { Knots::periodic(degree, &numbers) } else { Knots::new(degree, numbers) };
    }
    if closed {
        let even: Vec<f64> = (0..=points).map(|knot| knot as f64).collect();
        return Knots::periodic(degree, &even);
    }
    let made = match rule {
        Some(KnotRule::Uniform) => Knots::uniform(degree, points),
        _ => Knots::clamped(degree, points),
    };
    made.ok_or(few)
}
