//! The surface that a profile sweeps around the y axis.

use glam::DVec3;

use super::{Surface, SurfaceJet};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Side};
use crate::geometry::number::sin_cos_degrees;

/// A profile (x the radius, y along the axis) turned from `start` by `angle` degrees, from +x toward -z.
/// u is the angle in degrees, v the profile's parameter. The normal is to the right of the profile.
#[derive(Clone, Debug, PartialEq)]
pub struct RevolvedSurface {
    /// The profile.
    pub profile: AnyCurve,
    /// First angle, degrees.
    pub start: f64,
    /// Turn, degrees.
    pub angle: f64,
}

impl Surface for RevolvedSurface {
    fn domain_u(&self) -> Domain {
        Domain { start: self.start, end: self.start + self.angle }
    }

    fn domain_v(&self) -> Domain {
        self.profile.domain()
    }

    fn sided(&self, (u, _): (f64, Side), (v, side): (f64, Side)) -> SurfaceJet {
        let domain = self.domain_v();
        let v = v.clamp(domain.start, domain.end);
        let jet = self.profile.evaluate(v, side);
        let (sin, cos) = sin_cos_degrees(u.clamp(self.start, self.start + self.angle));
        let turned = |plane: DVec3| DVec3::new(plane.x * cos, plane.y, -plane.x * sin);
        let direction = self.profile.direction(v, side);
        SurfaceJet {
            point: turned(jet.point),
            du: DVec3::new(-sin, 0.0, -cos) * (jet.point.x * 1.0_f64.to_radians()),
            dv: turned(jet.first),
            normal: turned(DVec3::new(direction.y, -direction.x, 0.0)).normalize_or(DVec3::Y),
        }
    }
}
