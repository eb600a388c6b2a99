//! Splines of a document into curves of the kernel.

use glam::DVec3;

use super::Builder;
use super::curve::positions;
use crate::geometry::curve::control::BasisMatrix;
use crate::geometry::curve::control::from_power;
use crate::geometry::curve::{
    AnyCurve, Bartels, BezierError, BezierSpline, Border, EndRule, FourPointCurve, HermiteKnot,
    Parametrization, Polyline, RationalError, Scheme, SplineEnd, SplineError, alpha_parameters, beta_spline,
    chaikin_limit, hermite, interpolate_closed, interpolate_with, parameters, rational_hermite, refine,
    three_point_limit, through, through_closed, windows,
};
use crate::language::diagnostic::{Code, Diagnostic};
use crate::language::source::Span;
use crate::language::spec::{self, Basis, Parameters, Point, Sp};

impl Builder<'_> {
    pub(super) fn spline(&mut self, spline: &spec::Spline, span: Span) -> Option<AnyCurve> {
        let points = positions(&spline.points);
        let closed = spline.closed.value;
        let numbers = self.numbers(&points, closed, &spline.parameters.value, span)?;
        let built = if closed {
            interpolate_closed(&points, &numbers)
        } else {
            let rule =
                |own: &Option<Sp<spec::SplineEnd<Point>>>| end_of(own, &spline.ends, |point| point.position);
            interpolate_with(&points, &numbers, (rule(&spline.start), rule(&spline.end)))
        };
        self.made(built, span)
    }

    pub(super) fn function_spline(&mut self, spline: &spec::FunctionSpline, span: Span) -> Option<AnyCurve> {
        // Only y is a spline; x is the parameter, put in exactly.
        let values: Vec<DVec3> = spline.points.iter().map(|point| DVec3::new(0.0, point.y, 0.0)).collect();
        let places: Vec<f64> = spline.points.iter().map(|point| point.x).collect();
        let built = if spline.periodic.value {
            interpolate_closed(&values[..values.len() - 1], &places)
        } else {
            let vertical = |rate: f64| DVec3::new(0.0, rate, 0.0);
            let rule =
                |own: &Option<Sp<spec::SplineEnd<f64>>>| end_of(own, &spline.ends, |rate| vertical(*rate));
            interpolate_with(&values, &places, (rule(&spline.start), rule(&spline.end)))
        };
        let spline = match built {
            Ok(spline) => spline,
            Err(error) => return self.degenerate(&error.to_string(), span),
        };
        let graph = spline.control_points().iter().enumerate().map(|(index, point)| {
            let (piece, third) = (index / 3, index % 3);
            let ahead =
                if third == 0 { 0.0 } else { (places[piece + 1] - places[piece]) * third as f64 / 3.0 };
            DVec3::new(places[piece] + ahead, point.y, 0.0)
        });
        self.joined(BezierSpline::with_knots(3, graph.collect(), places.clone()), span)
    }

    pub(super) fn hermite(&mut self, curve: &spec::Hermite, span: Span) -> Option<AnyCurve> {
        let points = positions(&curve.points);
        let closed = curve.closed.value;
        let numbers = self.numbers(&points, closed, &curve.parameters.value, span)?;
        let knot = |k: usize| {
            let tangent = curve.tangents[k].position;
            HermiteKnot { point: points[k], before: tangent, after: tangent }
        };
        let order: Vec<usize> = (0..points.len()).chain(closed.then_some(0)).collect();
        let knots: Vec<HermiteKnot> = order.iter().map(|k| knot(*k)).collect();
        let Some(weights) = &curve.weights else { return self.made(hermite(&knots, &numbers), span) };
        let rate = |k: usize| curve.weight_rates.as_ref().map_or(0.0, |rates| rates[k].value);
        let weighed: Vec<(f64, f64)> = order.iter().map(|k| (weights[*k].value, rate(*k))).collect();
        match rational_hermite(&knots, &weighed, &numbers) {
            Ok(curve) => Some(AnyCurve::Rational(curve)),
            Err(RationalError::Negative { index }) => {
                let piece = index / 3;
                let message =
                    format!("the rates pull the weight between points {piece} and {} below 0", piece + 1);
                let place = curve.weight_rates.as_ref().map_or(weights.span, |rates| rates.span);
                let report = Diagnostic::error(Code::BadWeight, message).at(place, "too fast").help(
                    "a weight w that falls by r over a step h keeps above 0 where r h / 3 is less than w",
                );
                self.report(report);
                None
            }
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    pub(super) fn cardinal(&mut self, curve: &spec::Cardinal, span: Span) -> Option<AnyCurve> {
        let shape = Bartels { tension: 1.0 - 2.0 * curve.share(), ..Bartels::default() };
        let numbers = Parameters::Uniform;
        let shapes = vec![shape; curve.points.len()];
        self.shaped(&curve.points, &shapes, &numbers, (curve.closed.value, curve.ends.value), span)
    }

    pub(super) fn catmull_rom(&mut self, curve: &spec::CatmullRom, span: Span) -> Option<AnyCurve> {
        let points = positions(&curve.points);
        self.catmull_rom_through(&points, curve.alpha.value.0, (curve.closed.value, curve.ends.value), span)
    }

    pub(super) fn catmull_rom_through(
        &mut self,
        points: &[DVec3],
        alpha: f64,
        (closed, ends): (bool, spec::EndRule),
        span: Span,
    ) -> Option<AnyCurve> {
        let shapes = vec![Bartels::default(); points.len()];
        let numbers = match alpha_parameters(points, closed, alpha) {
            Ok(numbers) => numbers,
            Err(error) => return self.degenerate(&error.to_string(), span),
        };
        self.made(
            if closed {
                through_closed(points, &shapes, &numbers)
            } else {
                through(points, &shapes, &numbers, end_rule(ends))
            },
            span,
        )
    }

    pub(super) fn kochanek_bartels(&mut self, curve: &spec::KochanekBartels, span: Span) -> Option<AnyCurve> {
        let shape = |k: usize| Bartels {
            tension: curve.tension.at(k),
            continuity: curve.continuity.at(k),
            bias: curve.bias.at(k),
        };
        let shapes: Vec<Bartels> = (0..curve.points.len()).map(shape).collect();
        let ends = (curve.closed.value, curve.ends.value);
        self.shaped(&curve.points, &shapes, &curve.parameters.value, ends, span)
    }

    fn shaped(
        &mut self,
        points: &[Sp<Point>],
        shapes: &[Bartels],
        rule: &Parameters,
        (closed, ends): (bool, spec::EndRule),
        span: Span,
    ) -> Option<AnyCurve> {
        let points = positions(points);
        let numbers = self.numbers(&points, closed, rule, span)?;
        let built = if closed {
            through_closed(&points, shapes, &numbers)
        } else {
            through(&points, shapes, &numbers, end_rule(ends))
        };
        self.made(built, span)
    }

    pub(super) fn beta_spline(&mut self, curve: &spec::BetaSpline, span: Span) -> Option<AnyCurve> {
        let shape = (curve.bias.value, curve.tension.value);
        let through_ends = curve.ends.value == spec::Border::Reflect;
        let built = beta_spline(&positions(&curve.points), shape, curve.closed.value, through_ends);
        self.joined(built, span)
    }

    pub(super) fn cubic(&mut self, curve: &spec::Cubic, span: Span) -> Option<AnyCurve> {
        if let Some(pieces) = &curve.coefficients {
            let mut control = Vec::new();
            for piece in pieces.iter() {
                let points = from_power(&positions(piece));
                control.extend(&points[usize::from(!control.is_empty())..]);
            }
            return self.joined(BezierSpline::new(3, control), span);
        }
        let (basis, points) = (curve.basis.as_ref()?, curve.points.as_ref()?);
        let matrix = match basis.value {
            Basis::Bezier => BasisMatrix::BEZIER,
            Basis::BSpline => BasisMatrix::B_SPLINE,
            Basis::CatmullRom => BasisMatrix::CATMULL_ROM,
            Basis::Hermite => BasisMatrix::HERMITE,
            Basis::Matrix(rows) => BasisMatrix(rows),
        };
        self.joined(windows(&matrix, &positions(points), curve.stride(), curve.closed.value), span)
    }

    pub(super) fn subdivision_curve(
        &mut self,
        curve: &spec::SubdivisionCurve,
        span: Span,
    ) -> Option<AnyCurve> {
        let points = positions(&curve.points);
        let closed = curve.closed.value;
        let border = match curve.ends.value {
            _ if closed => Border::Closed,
            spec::Border::Reflect => Border::Reflect,
            spec::Border::Cut => Border::Cut,
        };
        let scheme = match curve.scheme.value {
            spec::CurveScheme::Chaikin => Scheme::Chaikin,
            spec::CurveScheme::ThreePoint => Scheme::ThreePoint,
            spec::CurveScheme::FourPoint => Scheme::FourPoint { tension: curve.tension() },
        };
        if let Some(levels) = curve.refinements() {
            let line = Polyline::new(refine(&points, scheme, border, levels), closed);
            return line.map(AnyCurve::Polyline);
        }
        match scheme {
            Scheme::Chaikin => self.joined(chaikin_limit(&points, border), span),
            Scheme::ThreePoint => self.joined(three_point_limit(&points, border), span),
            Scheme::FourPoint { tension } => match FourPointCurve::new(points, tension, border) {
                Some(curve) => Some(AnyCurve::FourPoint(curve)),
                None => self.degenerate("these points and this tension have no limit", span),
            },
        }
    }

    /// Parameters of points by their rule.
    pub(super) fn numbers(
        &mut self,
        points: &[DVec3],
        closed: bool,
        rule: &Parameters,
        span: Span,
    ) -> Option<Vec<f64>> {
        let rule = match rule {
            Parameters::Uniform => Parametrization::Uniform,
            Parameters::Chordal => Parametrization::Chordal,
            Parameters::Centripetal => Parametrization::Centripetal,
            Parameters::Nielsen => Parametrization::Nielsen,
            Parameters::Given(numbers) => return Some(numbers.iter().map(|number| number.value).collect()),
        };
        match parameters(points, closed, rule) {
            Ok(numbers) => Some(numbers),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    pub(super) fn made(&mut self, built: Result<BezierSpline, SplineError>, span: Span) -> Option<AnyCurve> {
        match built {
            Ok(curve) => Some(AnyCurve::Bezier(curve)),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }

    fn joined(&mut self, built: Result<BezierSpline, BezierError>, span: Span) -> Option<AnyCurve> {
        match built {
            Ok(curve) => Some(AnyCurve::Bezier(curve)),
            Err(error) => self.degenerate(&error.to_string(), span),
        }
    }
}

/// The rule of an end: its own, else that of both, else natural.
fn end_of<T>(
    own: &Option<Sp<spec::SplineEnd<T>>>,
    both: &Option<Sp<spec::SplineEnd<T>>>,
    vector: impl Fn(&T) -> DVec3,
) -> SplineEnd {
    match own.as_ref().or(both.as_ref()).map(|rule| &rule.value) {
        None | Some(spec::SplineEnd::Natural) => SplineEnd::Natural,
        Some(spec::SplineEnd::Clamped) => SplineEnd::First(DVec3::ZERO),
        Some(spec::SplineEnd::NotAKnot) => SplineEnd::NotAKnot,
        Some(spec::SplineEnd::First(first)) => SplineEnd::First(vector(&first.value)),
        Some(spec::SplineEnd::Second(second)) => SplineEnd::Second(vector(&second.value)),
    }
}

fn end_rule(rule: spec::EndRule) -> EndRule {
    match rule {
        spec::EndRule::Natural => EndRule::Natural,
        spec::EndRule::Quadratic => EndRule::Quadratic,
        spec::EndRule::Reflect => EndRule::Reflect,
        spec::EndRule::Duplicate => EndRule::Duplicate,
        spec::EndRule::Guides => EndRule::Guides,
    }
}
