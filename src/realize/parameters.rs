//! Exact surfaces by their parameters.

use glam::{DAffine3, DMat3, DVec3};

use super::source::{Kind, Source};
use crate::geometry::curve::{Curve as _, Domain, Side};
use crate::geometry::surface::{Surface, SurfaceJet};

impl Source {
    /// The surface over parameters before all maps; none where it is flat or has no parameters.
    fn surface(&self) -> Option<&dyn Surface> {
        Some(match self.kind() {
            Kind::Revolved(turned) => turned.as_ref(),
            Kind::Extruded(pushed) => pushed.as_ref(),
            Kind::Swept(wall) => wall,
            Kind::Patch(field) => field.surface(),
            Kind::Bent(bent) => return bent.inner.surface(),
            _ => return None,
        })
    }

    /// For u and v the ends of the domain and the places between them where pieces meet; none where the surface has no
    /// parameters.
    pub(super) fn stops(&self) -> Option<[Vec<f64>; 2]> {
        let surface = self.surface()?;
        let breaks = match self.innermost() {
            Kind::Revolved(turned) => [Vec::new(), turned.profile.breaks()],
            Kind::Extruded(pushed) => [pushed.profile.breaks(), Vec::new()],
            Kind::Swept(wall) => [wall.surface.outlines[wall.outline].joints(), wall.surface.joints()],
            _ => [surface.breaks_u(), surface.breaks_v()],
        };
        let [u, v] = breaks;
        let with_ends = |inner: Vec<f64>, domain: Domain| {
            let inner = inner.into_iter().filter(|stop| *stop > domain.start && *stop < domain.end);
            std::iter::once(domain.start).chain(inner).chain([domain.end]).collect()
        };
        Some([with_ends(u, surface.domain_u()), with_ends(v, surface.domain_v())])
    }

    /// Whether u, and v, come round.
    pub(super) fn closed(&self) -> [bool; 2] {
        match self.innermost() {
            Kind::Revolved(turned) => [turned.angle == 360.0, turned.profile.is_closed()],
            Kind::Extruded(pushed) => [pushed.profile.is_closed(), false],
            Kind::Swept(wall) => {
                [wall.surface.outlines[wall.outline].is_closed(), wall.surface.carrier.is_closed()]
            }
            Kind::Patch(field) => field.closed(),
            _ => [false; 2],
        }
    }

    /// Whether another surface is of the same kind, behind as many maps.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        match (self.kind(), other.kind()) {
            (Kind::Bent(one), Kind::Bent(other)) => one.inner.is_like(&other.inner),
            (Kind::Patch(one), Kind::Patch(other)) => {
                std::mem::discriminant(one.surface()) == std::mem::discriminant(other.surface())
            }
            (one, other) => std::mem::discriminant(one) == std::mem::discriminant(other),
        }
    }

    fn innermost(&self) -> &Kind {
        match self.kind() {
            Kind::Bent(bent) => bent.inner.innermost(),
            kind => kind,
        }
    }

    /// The surface at parameters, in the written mesh; a surface without parameters is at its origin.
    pub(super) fn jet(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        const NOWHERE: SurfaceJet =
            SurfaceJet { point: DVec3::ZERO, du: DVec3::X, dv: DVec3::Y, normal: DVec3::Z };
        let before = match self.kind() {
            Kind::Bent(bent) => {
                let inner = bent.inner.jet(u, v);
                let bent = bent.map.apply(inner.point);
                let map = DAffine3 { matrix3: bent.jacobian, translation: DVec3::ZERO };
                SurfaceJet { point: bent.point, ..mapped(&inner, &map) }
            }
            _ => self.surface().map_or(NOWHERE, |surface| surface.sided(u, v)),
        };
        mapped(&before, self.map())
    }
}

fn mapped(jet: &SurfaceJet, map: &DAffine3) -> SurfaceJet {
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let normals = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    SurfaceJet {
        point: map.transform_point3(jet.point),
        du: map.transform_vector3(jet.du),
        dv: map.transform_vector3(jet.dv),
        normal: (normals * jet.normal).normalize_or(jet.normal),
    }
}
