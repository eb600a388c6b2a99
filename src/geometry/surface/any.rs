//! One type for every kind of surface that is tessellated by its parameters.

use super::coons::{ThreeSidedSurface, TransfiniteSurface};
use super::tensor::{PolynomialSurface, RationalSurface};
use super::{
    FormulaSurface, LoftedSurface, PlacedSurface, RuledSurface, SecondJet, SecondRange, Surface, SurfaceJet,
    ThickSide, TranslationalSurface,
};
use crate::geometry::curve::{Domain, Side};

/// A surface of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnySurface {
    /// Straight lines between two curves.
    Ruled(Box<RuledSurface>),
    /// Through a row of curves.
    Lofted(Box<LoftedSurface>),
    /// One curve moved along another.
    Translational(Box<TranslationalSurface>),
    /// Polynomial patches by control points.
    Polynomial(Box<PolynomialSurface>),
    /// Rational patches by control points: NURBS.
    Rational(Box<RationalSurface>),
    /// Through whole curves: Coons patches and networks.
    Transfinite(Box<TransfiniteSurface>),
    /// Through three curves.
    ThreeSided(Box<ThreeSidedSurface>),
    /// Points by formulas.
    Formula(Box<FormulaSurface>),
    /// A side of a formula surface that has a thickness.
    Thick(Box<ThickSide>),
    /// Another one, somewhere else.
    Placed(Box<PlacedSurface>),
}

macro_rules! each_kind {
    ($self:ident, $surface:ident => $body:expr) => {
        match $self {
            AnySurface::Ruled($surface) => $body,
            AnySurface::Lofted($surface) => $body,
            AnySurface::Translational($surface) => $body,
            AnySurface::Polynomial($surface) => $body,
            AnySurface::Rational($surface) => $body,
            AnySurface::Transfinite($surface) => $body,
            AnySurface::ThreeSided($surface) => $body,
            AnySurface::Formula($surface) => $body,
            AnySurface::Thick($surface) => $body,
            AnySurface::Placed($surface) => $body,
        }
    };
}

impl Surface for AnySurface {
    fn domain_u(&self) -> Domain {
        each_kind!(self, surface => surface.domain_u())
    }

    fn domain_v(&self) -> Domain {
        each_kind!(self, surface => surface.domain_v())
    }

    fn evaluate(&self, u: f64, v: f64) -> SurfaceJet {
        each_kind!(self, surface => surface.evaluate(u, v))
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        each_kind!(self, surface => surface.sided(u, v))
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        each_kind!(self, surface => surface.second(u, v))
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        each_kind!(self, surface => surface.second_range(u, v))
    }

    fn lattice(&self, u: &[(f64, Side)], v: &[(f64, Side)]) -> Vec<SurfaceJet> {
        each_kind!(self, surface => surface.lattice(u, v))
    }

    fn second_ranges(&self, u: &[(f64, f64)], v: &[(f64, f64)]) -> Option<Vec<SecondRange>> {
        each_kind!(self, surface => surface.second_ranges(u, v))
    }

    fn joints_u(&self) -> Vec<f64> {
        each_kind!(self, surface => surface.joints_u())
    }

    fn joints_v(&self) -> Vec<f64> {
        each_kind!(self, surface => surface.joints_v())
    }

    fn breaks_u(&self) -> Vec<f64> {
        each_kind!(self, surface => surface.breaks_u())
    }

    fn breaks_v(&self) -> Vec<f64> {
        each_kind!(self, surface => surface.breaks_v())
    }
}
