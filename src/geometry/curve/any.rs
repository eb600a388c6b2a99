//! One type for every kind of curve.

use glam::DVec3;

use super::{
    BezierSpline, Curve, Domain, EllipseArc, FormulaCurve, FourPointCurve, Helix, HyperbolaArc, Jet, Path,
    Polyline, RationalSpline, Restarted, Retimed, Reversed, Side, Transformed, Trimmed,
};
use crate::geometry::number::Bounds;

/// A curve of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyCurve {
    /// Straight segments.
    Polyline(Polyline),
    /// A circle, an ellipse, or an arc of one.
    Ellipse(EllipseArc),
    /// An arc of a hyperbola.
    Hyperbola(HyperbolaArc),
    /// A helix.
    Helix(Helix),
    /// Bezier pieces, interpolating splines among them.
    Bezier(BezierSpline),
    /// Rational Bezier pieces: NURBS among them.
    Rational(RationalSpline),
    /// The limit of the four-point scheme.
    FourPoint(FourPointCurve),
    /// A formula of one variable.
    Formula(Box<FormulaCurve>),
    /// Curves end to start.
    Path(Path),
    /// A curve under an affine map.
    Transformed(Transformed),
    /// A curve backwards.
    Reversed(Reversed),
    /// A closed curve begun elsewhere.
    Restarted(Restarted),
    /// A curve run through at other times.
    Retimed(Retimed),
    /// A part of a curve.
    Trimmed(Trimmed),
}

macro_rules! each_kind {
    ($self:ident, $curve:ident => $body:expr) => {
        match $self {
            AnyCurve::Polyline($curve) => $body,
            AnyCurve::Ellipse($curve) => $body,
            AnyCurve::Hyperbola($curve) => $body,
            AnyCurve::Helix($curve) => $body,
            AnyCurve::Bezier($curve) => $body,
            AnyCurve::Rational($curve) => $body,
            AnyCurve::FourPoint($curve) => $body,
            AnyCurve::Formula($curve) => $body,
            AnyCurve::Path($curve) => $body,
            AnyCurve::Transformed($curve) => $body,
            AnyCurve::Reversed($curve) => $body,
            AnyCurve::Restarted($curve) => $body,
            AnyCurve::Retimed($curve) => $body,
            AnyCurve::Trimmed($curve) => $body,
        }
    };
}

impl Curve for AnyCurve {
    fn domain(&self) -> Domain {
        each_kind!(self, curve => curve.domain())
    }

    fn is_closed(&self) -> bool {
        each_kind!(self, curve => curve.is_closed())
    }

    fn evaluate(&self, t: f64, side: Side) -> Jet {
        each_kind!(self, curve => curve.evaluate(t, side))
    }

    fn tangents(&self, parameters: &[f64], side: Side, found: &mut [(DVec3, DVec3)]) {
        each_kind!(self, curve => curve.tangents(parameters, side, found));
    }

    fn joints(&self) -> Vec<f64> {
        each_kind!(self, curve => curve.joints())
    }

    fn breaks(&self) -> Vec<f64> {
        each_kind!(self, curve => curve.breaks())
    }

    fn has_curvature(&self) -> bool {
        each_kind!(self, curve => curve.has_curvature())
    }

    fn direction(&self, t: f64, side: Side) -> DVec3 {
        each_kind!(self, curve => curve.direction(t, side))
    }

    fn chord_deviation(&self, from: f64, to: f64) -> f64 {
        each_kind!(self, curve => curve.chord_deviation(from, to))
    }

    fn second_range(&self, from: f64, to: f64) -> Option<Bounds> {
        each_kind!(self, curve => curve.second_range(from, to))
    }

    fn first_range(&self, from: f64, to: f64) -> Option<Bounds> {
        each_kind!(self, curve => curve.first_range(from, to))
    }
}
