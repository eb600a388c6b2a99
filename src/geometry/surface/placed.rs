//! A surface somewhere else: scaled, turned and moved.

use glam::{DAffine3, DMat3, DVec3};

use super::{AnySurface, SecondJet, SecondRange, Surface, SurfaceJet};
use crate::geometry::curve::{Domain, Side};
use crate::geometry::number::Bounds;

/// The image of a surface under an affine map that loses no dimension; its parameters stay. The normal stays du x dv or its
/// opposite, as it was.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedSurface {
    surface: AnySurface,
    placement: DAffine3,
    /// What the map makes of cross products.
    cofactor: DMat3,
}

impl PlacedSurface {
    /// `surface` where `placement` puts it.
    #[must_use]
    pub fn new(surface: AnySurface, placement: DAffine3) -> Self {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = placement.matrix3;
        let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Self { surface, placement, cofactor }
    }

    fn jet(&self, jet: &SurfaceJet) -> SurfaceJet {
        SurfaceJet {
            point: self.placement.transform_point3(jet.point),
            du: self.vector(jet.du),
            dv: self.vector(jet.dv),
            normal: (self.cofactor * jet.normal).normalize_or(jet.normal),
        }
    }

    fn vector(&self, vector: DVec3) -> DVec3 {
        self.placement.matrix3 * vector
    }

    /// The box around the image of a box of vectors.
    fn range(&self, range: &SecondRange) -> SecondRange {
        let image = |bounds: &Bounds| {
            let middle = self.vector(bounds.center());
            let half = self.placement.matrix3.abs() * ((bounds.max - bounds.min) / 2.0);
            Bounds { min: middle - half, max: middle + half }
        };
        SecondRange { uu: image(&range.uu), uv: image(&range.uv), vv: image(&range.vv) }
    }
}

impl Surface for PlacedSurface {
    fn domain_u(&self) -> Domain {
        self.surface.domain_u()
    }

    fn domain_v(&self) -> Domain {
        self.surface.domain_v()
    }

    fn sided(&self, u: (f64, Side), v: (f64, Side)) -> SurfaceJet {
        self.jet(&self.surface.sided(u, v))
    }

    fn second(&self, u: (f64, Side), v: (f64, Side)) -> SecondJet {
        let SecondJet { uu, uv, vv } = self.surface.second(u, v);
        SecondJet { uu: self.vector(uu), uv: self.vector(uv), vv: self.vector(vv) }
    }

    fn second_range(&self, u: (f64, f64), v: (f64, f64)) -> Option<SecondRange> {
        self.surface.second_range(u, v).map(|range| self.range(&range))
    }

    fn lattice(&self, u: &[(f64, Side)], v: &[(f64, Side)]) -> Vec<SurfaceJet> {
        self.surface.lattice(u, v).iter().map(|jet| self.jet(jet)).collect()
    }

    fn second_ranges(&self, u: &[(f64, f64)], v: &[(f64, f64)]) -> Option<Vec<SecondRange>> {
        let ranges = self.surface.second_ranges(u, v)?;
        Some(ranges.iter().map(|range| self.range(range)).collect())
    }

    fn joints_u(&self) -> Vec<f64> {
        self.surface.joints_u()
    }

    fn joints_v(&self) -> Vec<f64> {
        self.surface.joints_v()
    }

    fn breaks_u(&self) -> Vec<f64> {
        self.surface.breaks_u()
    }

    fn breaks_v(&self) -> Vec<f64> {
        self.surface.breaks_v()
    }
}
