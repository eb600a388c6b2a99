//! The wall that an outline sweeps along z.

use glam::DVec3;

use super::{Surface, SurfaceJet};
use crate::geometry::curve::{AnyCurve, Curve, Domain, Side};

/// An outline in the xy plane pushed along z. u is the outline's parameter, v the height in metres. The
/// normal is to the right of the outline.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtrudedSurface {
    /// The outline.
    pub profile: AnyCurve,
    /// Least z, metres.
    pub bottom: f64,
    /// Height, metres.
    pub height: f64,
}

impl Surface for ExtrudedSurface {
    fn domain_u(&self) -> Domain {
        self.profile.domain()
    }

    fn domain_v(&self) -> Domain {
        Domain { start: 0.0, end: self.height }
    }

    fn sided(&self, (u, side): (f64, Side), (v, _): (f64, Side)) -> SurfaceJet {
        let jet = self.profile.evaluate(u, side);
        let direction = self.profile.direction(u, side);
        SurfaceJet {
            point: jet.point.truncate().extend(self.bottom + v.clamp(0.0, self.height)),
            du: jet.first.truncate().extend(0.0),
            dv: DVec3::Z,
            normal: DVec3::new(direction.y, -direction.x, 0.0).normalize_or(DVec3::X),
        }
    }
}
