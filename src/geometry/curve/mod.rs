//! Curves: points and derivatives over a parameter, with proved bounds on what a chord leaves out.
//!
//! Promise: every curve is continuous over its domain, evaluates in constant or logarithmic time, and bounds
//! the deviation of any chord rigorously ([`Curve::chord_deviation`], up to rounding of a few units in the
//! last place). Between two [`Curve::joints`] its direction is continuous. Not promised: unit speed, or that
//! the curve does not cross itself.
//!
//! Plane curves live in z = 0.

mod any;
mod bezier;
mod chord;
pub mod control;
mod ellipse;
mod formula;
mod four_point;
mod helix;
mod hermite;
mod hyperbola;
mod implicit;
mod joint;
mod length;
mod mapped;
mod nearest;
mod nielsen;
mod path;
pub(crate) mod pieces;
mod polyline;
mod rational;
mod restarted;
mod retimed;
mod spline;
mod spline_ends;
mod study;
mod subdivision;
mod trimmed;
mod windows;

pub use any::AnyCurve;
pub use bezier::{BezierError, BezierSpline};
pub use ellipse::EllipseArc;
pub use formula::FormulaCurve;
pub use four_point::FourPointCurve;
pub use helix::Helix;
pub use hermite::{
    Bartels, EndRule, HermiteKnot, alpha_parameters, hermite, rational_hermite, through, through_closed,
};
pub use hyperbola::HyperbolaArc;
pub use implicit::{ImplicitFault, implicit};
pub use joint::{Continuity, Meeting};
pub use length::{length, length_between, length_of_step, lengths_at};
pub use mapped::{Reversed, Transformed};
pub use nearest::{distance_within, nearest_within};
pub use path::Path;
pub use polyline::Polyline;
pub use rational::{RationalError, RationalSpline};
pub use restarted::Restarted;
pub use retimed::{Retimed, jumps};
pub use spline::{Parametrization, SplineError, interpolate, interpolate_closed, parameters};
pub use spline_ends::{SplineEnd, interpolate_with};
pub use study::FormulaFault;
pub use subdivision::{Border, Scheme, chaikin_limit, fewest, refine, three_point_limit};
pub use trimmed::Trimmed;
pub use windows::{beta_spline, windows};

use glam::DVec3;

use crate::geometry::number::Bounds;

/// The parameter interval of a curve, `start` < `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Least parameter.
    pub start: f64,
    /// Greatest parameter.
    pub end: f64,
}

impl Domain {
    /// Difference of the two ends.
    #[must_use]
    pub fn span(&self) -> f64 {
        self.end - self.start
    }

    /// The parameter at `fraction` (0 to 1) of the domain; exactly the end at 1.
    #[must_use]
    pub fn at(&self, fraction: f64) -> f64 {
        self.start * (1.0 - fraction) + self.end * fraction
    }
}

/// Point and derivatives by the parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Position, metres.
    pub point: DVec3,
    /// First derivative.
    pub first: DVec3,
    /// Second derivative.
    pub second: DVec3,
}

/// From which side a curve is evaluated where it is not smooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// As the end of what comes before.
    Before,
    /// As the start of what comes after.
    After,
}

impl Side {
    /// The other one.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Before => Self::After,
            Self::After => Self::Before,
        }
    }
}

/// A parametric curve in space.
pub trait Curve: Send + Sync {
    /// Parameter interval.
    fn domain(&self) -> Domain;

    /// Whether the end meets the start.
    fn is_closed(&self) -> bool;

    /// Point and derivatives at `t`; where the curve is not smooth, of the named side. A parameter outside
    /// the domain is taken as the nearer end.
    fn evaluate(&self, t: f64, side: Side) -> Jet;

    /// Points and first derivatives at many parameters, as [`Curve::evaluate`] gives them one by one: cheaper, most of
    /// all where the parameters increase. `found` is as long as `parameters`.
    fn tangents(&self, parameters: &[f64], side: Side, found: &mut [(DVec3, DVec3)]) {
        for (t, found) in parameters.iter().zip(found) {
            let jet = self.evaluate(*t, side);
            *found = (jet.point, jet.first);
        }
    }

    /// Parameters strictly inside the domain, increasing, where the direction jumps, and every given point of
    /// a polyline. A discretization must keep these points.
    fn joints(&self) -> Vec<f64>;

    /// Parameters strictly inside the domain, increasing, where pieces meet: the joints, and the places where the
    /// speed or a higher derivative may jump. Between them every derivative is continuous, unless
    /// [`Curve::has_curvature`] denies it.
    fn breaks(&self) -> Vec<f64> {
        self.joints()
    }

    /// Whether the second derivative is continuous between breaks. Where it is not, `second` of a [`Jet`] is a
    /// difference quotient.
    fn has_curvature(&self) -> bool {
        true
    }

    /// A proved bound on the distance between the chord from `from` to `to` and the part of the curve it
    /// stands for: every point of the chord is that close to the curve and every point of the curve that
    /// close to the chord. No joint may lie strictly between. Zero means straight.
    fn chord_deviation(&self, from: f64, to: f64) -> f64;

    /// A box that holds the second derivative everywhere between two parameters, for proofs; none where no
    /// bound is known. No joint may lie strictly between, and no break where the speed jumps.
    fn second_range(&self, _from: f64, _to: f64) -> Option<Bounds> {
        None
    }

    /// The same for the first derivative.
    fn first_range(&self, from: f64, to: f64) -> Option<Bounds> {
        let half = (to - from) / 2.0;
        let reach = self.second_range(from, to)?;
        let reach = reach.min.abs().max(reach.max.abs()) * half;
        let middle = self.evaluate(from + half, Side::After).first;
        Some(Bounds { min: middle - reach, max: middle + reach })
    }

    /// Position at `t`.
    fn point(&self, t: f64) -> DVec3 {
        self.evaluate(t, Side::After).point
    }

    /// Unit direction at `t` from the named side. Where the first derivative vanishes (a cusp, a doubled
    /// control point) it is the limit along the curve: by a short step into that side where the kind of curve
    /// knows no better.
    fn direction(&self, t: f64, side: Side) -> DVec3 {
        let jet = self.evaluate(t, side);
        let domain = self.domain();
        let scale = jet.second.length() * domain.span();
        if jet.first.length() > 1e-9 * scale && jet.first.length() > 0.0 {
            return jet.first.normalize();
        }
        let step = 1e-6 * domain.span() * if side == Side::After { 1.0 } else { -1.0 };
        let neighbor = self.evaluate(t + step, side).point;
        ((neighbor - jet.point) * step.signum()).normalize_or(DVec3::X)
    }
}
