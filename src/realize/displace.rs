//! Shapes moved along their normals.

use glam::{DVec2, DVec3};

use super::inherited::Inherited;
use super::limit::Working;
use super::reach::bent;
use super::shape::{Made, Maker, cost, flatten};
use super::{Level, RealizeError};
use crate::geometry::number::single_rounding;
use crate::geometry::tessellate::{Deviation, Heights, displace, normal_picture};
use crate::model::{Displacement, NormalMap, ShapeHandle, Smoothing};

impl Maker<'_> {
    /// A displaced shape in its own space. A quarter of the tolerance is for the shape that is moved.
    pub(super) fn displaced(
        &self,
        handle: ShapeHandle,
        recipe: &Displacement,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let bounds = self.extents.bounds(recipe.of);
        let Subject { mut made, periods, tolerance, left } = self.subject(recipe, inherited)?;
        Working::Displaced.check(made.mesh.triangles.len(), &self.model.limits)?;
        let before = made.deviation.bound;
        let height = |place: DVec3, uv: DVec2| recipe.heights.at(&bounds, place, uv);
        let detail = |places: [DVec3; 2], uvs: [DVec2; 2]| recipe.heights.detail(&bounds, places, uvs);
        let heights = Heights { height: &height, detail: &detail };
        let limit = Working::Displaced.most(&self.model.limits);
        let mesh = std::mem::take(&mut made.mesh);
        let (mesh, moved) = displace(mesh, &heights, &periods, left, limit)
            .map_err(|error| self.in_terms_of_limits(Working::Displaced, error))?;
        made.mesh = mesh;
        made.deviation = Deviation::new(before + moved.bound, moved.evidence.max(made.deviation.evidence));
        made.tolerance = Some(tolerance);
        made.mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source = *next_source);
        made.wire.points.iter_mut().for_each(|point| point.anchor.source = *next_source);
        *next_source += 1;
        let made = if shape.options.smoothing == Smoothing::Flat { flatten(made) } else { made };
        cost(&made).check(&self.model.limits)?;
        Ok(made)
    }
}

/// A shape before it is moved.
struct Subject {
    made: Made,
    periods: Vec<(f64, f64)>,
    tolerance: f64,
    /// What is left of the tolerance for moving it.
    left: f64,
}

impl Maker<'_> {
    /// The shape that is moved, within a quarter of the tolerance.
    fn subject(&self, recipe: &Displacement, inherited: Inherited) -> Result<Subject, RealizeError> {
        let bounds = self.extents.bounds(recipe.of);
        let tolerance = inherited.tolerance.unwrap_or_else(|| bounds.diagonal() / 2000.0);
        let share = Inherited { uv: true, ..inherited.share(tolerance / 4.0, 0.25) };
        let made = self.part(recipe.of, share, &mut 0)?;
        let mut periods = Vec::new();
        super::bent::periods(self.model, recipe.of, &mut periods);
        let tolerance = self.coarsened(tolerance, inherited.level);
        let aim = (tolerance - inherited.rounding).max(tolerance / 2.0);
        let left = (aim - made.deviation.bound).max(aim / 4.0);
        Ok(Subject { made, periods, tolerance, left })
    }

    /// The normals of a displaced shape for the texels of its normal map, in its own space.
    pub(super) fn normals_of(
        &self,
        map: &NormalMap,
        recipe: &Displacement,
    ) -> Result<Vec<Option<DVec3>>, RealizeError> {
        let shape = self.model.shape(map.shape);
        let wanted = Inherited {
            tolerance: shape.options.tolerance.or(self.model.tolerance),
            rounding: single_rounding(self.extents.bounds(map.shape).reach()),
            uv: true,
            level: Level::FINEST,
        };
        let Subject { made, .. } = self.subject(recipe, wanted.within(&shape.options.placement))?;
        let bounds = self.extents.bounds(recipe.of);
        let height = |place: DVec3, uv: DVec2| recipe.heights.at(&bounds, place, uv);
        let detail = |places: [DVec3; 2], uvs: [DVec2; 2]| recipe.heights.detail(&bounds, places, uvs);
        let heights = Heights { height: &height, detail: &detail };
        normal_picture(&made.mesh, &heights, map.size)
            .map_err(|fault| RealizeError::NormalMapPlace { place: fault.place, overlap: fault.overlap })
    }
}

/// How far heights may carry a shape beyond its box: a miter is at most three heights long.
pub(super) fn growth(
    model: &crate::model::Model,
    extents: &super::extents::Extents,
    recipe: &Displacement,
) -> f64 {
    let bounds = extents.bounds(recipe.of);
    recipe.heights.most(&bounds, &bent(model, extents, recipe.of))
}
