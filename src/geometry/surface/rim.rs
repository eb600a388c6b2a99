//! Sides of a rectangle of parameters, and lines across it.

use glam::DVec3;

use super::Surface;
use crate::geometry::curve::{Domain, Side};

/// A side of a rectangle of parameters. Its own parameter is the share of u (bottom, top) or v (left, right), from
/// 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rim {
    /// Least v.
    Bottom,
    /// Greatest u.
    Right,
    /// Greatest v.
    Top,
    /// Least u.
    Left,
}

impl Rim {
    /// All four, counter-clockwise where u runs to the right and v up.
    pub const ALL: [Self; 4] = [Self::Bottom, Self::Right, Self::Top, Self::Left];

    /// The shares of u and v at a share of the rim.
    #[must_use]
    pub fn place(self, share: f64) -> (f64, f64) {
        match self {
            Self::Bottom => (share, 0.0),
            Self::Right => (1.0, share),
            Self::Top => (share, 1.0),
            Self::Left => (0.0, share),
        }
    }

    /// Whether u runs along it.
    #[must_use]
    pub fn along_u(self) -> bool {
        matches!(self, Self::Bottom | Self::Top)
    }
}

/// A line of constant u or v on a surface, seen from one side.
pub(super) struct Line<'a, S> {
    surface: &'a S,
    /// Whether u runs along it.
    along_u: bool,
    /// The parameter that is constant.
    fixed: (f64, Side),
}

/// What a surface is like at a place of a line.
pub(super) struct LineJet {
    pub(super) point: DVec3,
    /// Derivative along the line, by its share.
    pub(super) along: DVec3,
    /// Derivative across it, away from the side from which it is seen.
    pub(super) onward: DVec3,
    /// Second derivative across it.
    pub(super) second: DVec3,
}

impl<'a, S: Surface> Line<'a, S> {
    pub(super) fn rim(surface: &'a S, rim: Rim) -> Self {
        let (u, v) = (surface.domain_u(), surface.domain_v());
        let fixed = match rim {
            Rim::Bottom => (v.start, Side::After),
            Rim::Top => (v.end, Side::Before),
            Rim::Left => (u.start, Side::After),
            Rim::Right => (u.end, Side::Before),
        };
        Self { surface, along_u: rim.along_u(), fixed }
    }

    /// The line where u (v, when u runs along it) has a value inside the domain.
    pub(super) fn inner(surface: &'a S, along_u: bool, fixed: f64, side: Side) -> Self {
        Self { surface, along_u, fixed: (fixed, side) }
    }

    fn domain(&self) -> Domain {
        if self.along_u { self.surface.domain_u() } else { self.surface.domain_v() }
    }

    /// Shares at which pieces begin, strictly inside.
    pub(super) fn breaks(&self) -> Vec<f64> {
        let domain = self.domain();
        let breaks = if self.along_u { self.surface.breaks_u() } else { self.surface.breaks_v() };
        breaks.iter().map(|t| (t - domain.start) / domain.span()).collect()
    }

    fn place(&self, share: f64) -> ((f64, Side), (f64, Side)) {
        let t = self.domain().at(share);
        let along = (t, if share >= 1.0 { Side::Before } else { Side::After });
        if self.along_u { (along, self.fixed) } else { (self.fixed, along) }
    }

    pub(super) fn point(&self, share: f64) -> DVec3 {
        let (u, v) = self.place(share);
        self.surface.sided(u, v).point
    }

    pub(super) fn jet(&self, share: f64) -> LineJet {
        let (u, v) = self.place(share);
        let (jet, second) = (self.surface.sided(u, v), self.surface.second(u, v));
        let (along, across, twice) =
            if self.along_u { (jet.du, jet.dv, second.vv) } else { (jet.dv, jet.du, second.uu) };
        let away = if self.fixed.1 == Side::Before { across } else { -across };
        LineJet { point: jet.point, along: along * self.domain().span(), onward: away, second: twice }
    }
}
