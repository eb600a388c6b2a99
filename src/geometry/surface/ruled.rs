//! Surfaces of straight lines between two curves.

use glam::{DAffine3, DMat3, DVec3};

use super::second::{difference, sum, times};
use super::{SecondJet, SecondRange, Surface, SurfaceJet, limit};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Retimed, Side, Transformed, jumps};
use crate::geometry::number::Bounds;

/// Straight lines from each point of one curve to the point of another that has the same share of its
/// parameters: P(u, v) = (1 - v) A(u) + v B(u), both parameters from 0 to 1. The normal is du x dv.
///
/// Source: D. F. Rogers, J. A. Adams, Mathematical Elements for Computer Graphics, 2nd ed. 1990, ch. 6-6.
#[derive(Clone, Debug, PartialEq)]
pub struct RuledSurface {
    from: AnyCurve,
    to: AnyCurve,
    joints: Vec<f64>,
}

/// Joints of the two curves nearer than this share of the domain are one line of the surface.
const SAME_JOINT: f64 = 1e-9;

impl RuledSurface {
    /// The surface between two curves; each is run through from its start to its end while u goes from 0 to 1.
    #[must_use]
    pub fn new(from: AnyCurve, to: AnyCurve) -> Self {
        let (from, to) = (Retimed::unit(from), Retimed::unit(to));
        let mut joints = jumps(&from);
        let to = with_joints_of(to, &joints);
        joints.extend(jumps(&to));
        joints.sort_by(f64::total_cmp);
        joints.dedup();
        Self { from, to, joints }
    }

    /// The cone from a curve to a point.
    #[must_use]
    pub fn to_point(from: AnyCurve, apex: DVec3) -> Self {
        let to = gathered(&from, apex);
        Self::new(from, to)
    }

    /// The curve at v = 0.
    #[must_use]
    pub fn from(&self) -> &AnyCurve {
        &self.from
    }

    /// The curve at v = 1.
    #[must_use]
    pub fn to(&self) -> &AnyCurve {
        &self.to
    }
}

/// A curve that stays at one point, with the parameters and joints of another: the tip of a cone.
#[must_use]
pub fn gathered(curve: &AnyCurve, point: DVec3) -> AnyCurve {
    let map = DAffine3 { matrix3: DMat3::ZERO, translation: point };
    AnyCurve::Transformed(Transformed::new(curve.clone(), map))
}

/// Moves joints that miss one of `others` by rounding alone onto it.
pub(super) fn with_joints_of(curve: AnyCurve, others: &[f64]) -> AnyCurve {
    let joints = jumps(&curve);
    let near = |joint: f64| others.iter().copied().find(|other| (other - joint).abs() <= SAME_JOINT);
    if joints.iter().all(|joint| near(*joint).is_none_or(|other| other == *joint)) {
        return curve;
    }
    let mut stops = vec![(0.0, 0.0)];
    stops.extend(joints.iter().filter_map(|joint| near(*joint).map(|other| (other, *joint))));
    stops.push((1.0, 1.0));
    Retimed::new(curve.clone(), &stops).map_or(curve, AnyCurve::Retimed)
}

impl Surface for RuledSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn domain_v(&self) -> Domain {
        Domain { start: 0.0, end: 1.0 }
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        let (a, b) = (self.from.evaluate(u.0, u.1), self.to.evaluate(u.0, u.1));
        let part = v.0.clamp(0.0, 1.0);
        let mix = |a: DVec3, b: DVec3| a * (1.0 - part) + b * part;
        let (du, dv) = (mix(a.first, b.first), b.point - a.point);
        let second = SecondJet { uu: mix(a.second, b.second), uv: b.first - a.first, vv: DVec3::ZERO };
        let normal = limit::normal((du, dv), &second, (u.1, v.1)).unwrap_or_else(|| {
            let along = mix(self.from.direction(u.0, u.1), self.to.direction(u.0, u.1));
            along.cross(dv).normalize_or(DVec3::Y)
        });
        SurfaceJet { point: mix(a.point, b.point), du, dv, normal }
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let (a, b) = (self.from.evaluate(u.0, u.1), self.to.evaluate(u.0, u.1));
        let part = v.0.clamp(0.0, 1.0);
        SecondJet { uu: a.second * (1.0 - part) + b.second * part, uv: b.first - a.first, vv: DVec3::ZERO }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        let (a, b) = (self.from.second_range(u.0, u.1)?, self.to.second_range(u.0, u.1)?);
        // At each v the box is a mixture of the two; all of them lie in the hull of the first and the last.
        let mixed = |v: f64| sum(&times(&a, 1.0 - v), &times(&b, v));
        let (first, second) = (self.from.first_range(u.0, u.1)?, self.to.first_range(u.0, u.1)?);
        Some(SecondRange {
            uu: mixed(v.0.clamp(0.0, 1.0)).union(mixed(v.1.clamp(0.0, 1.0))),
            uv: difference(&second, &first),
            vv: Bounds::of_points([DVec3::ZERO]),
        })
    }

    fn joints_u(&self) -> Vec<f64> {
        self.joints.clone()
    }
}
