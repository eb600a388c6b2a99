//! Surfaces that one curve sweeps while it moves, without turning, along another.

use glam::DVec3;

use super::{SecondJet, SecondRange, Surface, SurfaceJet, limit};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Retimed, Side, jumps};
use crate::geometry::number::Bounds;

/// P(u, v) = P(u) + Q(v) - Q(0), both parameters from 0 to 1. The normal is du x dv.
///
/// Source: G. Farin, Curves and Surfaces for CAGD, 5th ed. 2002, section 15.2: translational surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct TranslationalSurface {
    profile: AnyCurve,
    path: AnyCurve,
    start: DVec3,
}

impl TranslationalSurface {
    /// `profile` where it is written, moved as a point is that goes along `path`.
    #[must_use]
    pub fn new(profile: AnyCurve, path: AnyCurve) -> Self {
        let (profile, path) = (Retimed::unit(profile), Retimed::unit(path));
        let start = path.point(0.0);
        Self { profile, path, start }
    }
}

impl Surface for TranslationalSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn domain_v(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let (p, q) = (self.profile.evaluate(u.0, u.1), self.path.evaluate(v.0, v.1));
        let second = SecondJet { uu: p.second, uv: DVec3::ZERO, vv: q.second };
        let normal = limit::normal((p.first, q.first), &second, (u.1, v.1)).unwrap_or_else(|| {
            let across = self.profile.direction(u.0, u.1).cross(self.path.direction(v.0, v.1));
            across.normalize_or(DVec3::Y)
        });
        SurfaceJet { point: p.point + (q.point - self.start), du: p.first, dv: q.first, normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let (p, q) = (self.profile.evaluate(u.0, u.1), self.path.evaluate(v.0, v.1));
        SecondJet { uu: p.second, uv: DVec3::ZERO, vv: q.second }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        Some(SecondRange {
            uu: self.profile.second_range(u.0, u.1)?,
            uv: Bounds::of_points([DVec3::ZERO]),
            vv: self.path.second_range(v.0, v.1)?,
        })
    }

    fn joints_u(&self) -> Vec<f64> {
        jumps(&self.profile)
    }

    fn joints_v(&self) -> Vec<f64> {
        jumps(&self.path)
    }
}
