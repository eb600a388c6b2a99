//! Shapes moved along their normals.

use glam::{DVec2, DVec3};

use super::RealizeError;
use super::limit;
use super::reach::bent;
use super::shape::{Inherited, Made, Maker, cost, flatten};
use crate::geometry::tessellate::{Deviation, Heights, TessellateError, displace};
use crate::model::{Displacement, ShapeHandle, Smoothing};

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
        let tolerance = inherited.tolerance.unwrap_or_else(|| bounds.diagonal() / 2000.0);
        let share = Inherited { tolerance: Some(tolerance / 4.0), uv: true, ..inherited };
        let mut made = self.part(recipe.of, share, &mut 0)?;
        let mut periods = Vec::new();
        super::bent::periods(self.model, recipe.of, &mut periods);
        let tolerance = tolerance * self.coarser;
        let aim = (tolerance - inherited.rounding).max(tolerance / 2.0);
        let before = made.deviation.bound;
        let left = (aim - before).max(aim / 4.0);
        let height = |place: DVec3, uv: DVec2| recipe.heights.at(&bounds, place, uv);
        let detail = |places: [DVec3; 2], uvs: [DVec2; 2]| recipe.heights.detail(&bounds, places, uvs);
        let heights = Heights { height: &height, detail: &detail };
        let limit = limit::triangle_limit(&self.model.limits);
        let mesh = std::mem::take(&mut made.mesh);
        let (mesh, moved) = displace(mesh, &heights, &periods, left, limit).map_err(|error| match error {
            TessellateError::TooMany { needed, .. } => limit::in_terms_of(needed, &self.model.limits),
            error => error.into(),
        })?;
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

/// How far heights may carry a shape beyond its box: a miter is at most three heights long.
pub(super) fn growth(
    model: &crate::model::Model,
    extents: &super::source::Extents,
    recipe: &Displacement,
) -> f64 {
    let bounds = extents.bounds(recipe.of);
    recipe.heights.most(&bounds, &bent(model, extents, recipe.of))
}
