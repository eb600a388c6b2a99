//! Surfaces of fields: distances to shapes in them, and what their elements wear.

use std::sync::Arc;

use super::inherited::Inherited;
use super::limit::Working;
use super::material::{middle, own_or, split_by_element};
use super::shape::{Made, Maker, stretch};
use super::solid::may_cross;
use super::vertex_color::blend;
use super::{Level, RealizeError};
use crate::geometry::field::{AnyField, Distance};
use crate::geometry::mesh::{Mesh, VertexIndex, Wire};
use crate::geometry::number::Bounds;
use crate::geometry::solid::{Body, Check, SolidFault, body};
use crate::geometry::tessellate::{Deviation, Evidence, FieldSurface, TessellateError, field_surface};
use crate::model::{MaterialHandle, Recipe, ShapeHandle};

/// What part of a tolerance is for the shapes in a field.
const SHARE: f64 = 0.125;

impl Maker<'_> {
    /// The surface of a field with distances to shapes, in its own space. The shapes are those of the finest level: coarser ones
    /// would make another field.
    pub(super) fn around_shapes(
        &self,
        handle: ShapeHandle,
        inherited: Inherited,
        next_source: &mut u32,
    ) -> Result<Made, RealizeError> {
        let shape = self.model.shape(handle);
        let Recipe::Implicit { surface, shapes, materials, colors } = &shape.recipe else {
            return Ok(Made::empty());
        };
        let around = self.extents.bounds(handle);
        if around.is_empty() {
            return Err(TessellateError::NoSurface.into());
        }
        let around = around.diagonal() / stretch(&shape.options.placement.matrix3);
        let tolerance = inherited.tolerance.unwrap_or(around / 2000.0);
        let finest = Inherited { level: Level::FINEST, ..inherited };
        let mut parts = Vec::with_capacity(shapes.len());
        for part in shapes {
            parts.push(self.distance_to(handle, *part, finest.share(SHARE * tolerance, SHARE))?);
        }
        let tolerance = self.coarsened(tolerance, inherited.level);
        let aim = (tolerance - inherited.rounding).max(tolerance / 2.0);
        let before = parts.iter().map(|(_, off)| *off).fold(Deviation::NONE, Deviation::union);
        let left = (aim - before.bound).max(aim / 4.0);
        let mut of = |number: usize| {
            let (distance, _) = &parts[number];
            AnyField::Distance(Arc::clone(distance))
        };
        let field = surface.field.with_shapes(&mut of);
        let within =
            if surface.within.is_empty() { field.bounds().unwrap_or(Bounds::EMPTY) } else { surface.within };
        if within.is_empty() || (within.max - within.min).min_element() <= 0.0 {
            return Err(TessellateError::NoSurface.into());
        }
        let surface = FieldSurface { field, within, least: surface.least };
        let detail = self.detail(shape, left, (inherited.uv, inherited.level));
        let made = field_surface(&surface, &detail)
            .map_err(|error| self.in_terms_of_limits(Working::Field, error))?;
        let off = made.deviation;
        let mut made = Made {
            mesh: made.mesh,
            wire: Wire::default(),
            materials: vec![None],
            deviation: Deviation::new(before.bound + off.bound, Evidence::Sampled),
            tolerance: shape.options.density.is_none().then_some(tolerance),
            notes: Vec::new(),
            levels: 0,
        };
        made.mesh.vertices.iter_mut().for_each(|vertex| vertex.anchor.source = *next_source);
        *next_source += 1;
        dress_elements(&mut made, &surface.field, (materials, colors), shape.options.material);
        self.finished(shape, made)
    }

    /// The distance to a part, and how far its triangles are from it.
    fn distance_to(
        &self,
        shape: ShapeHandle,
        part: ShapeHandle,
        inherited: Inherited,
    ) -> Result<(Arc<Distance>, Deviation), RealizeError> {
        let refuse = |fault| RealizeError::Solid { shape, part: Some(part), fault };
        let made = self.part(part, Inherited { uv: false, ..inherited }, &mut 0)?;
        if !made.wire.points.is_empty() {
            return Err(refuse(SolidFault::Lines { part: 0 }));
        }
        Working::Distant.check(made.mesh.triangles.len(), &self.model.limits)?;
        let check = if may_cross(self.model, part) { Check::Crossings } else { Check::Trusted };
        let Body { points, triangles, normals } = body(&made.mesh, check).map_err(refuse)?;
        Ok((Arc::new(Distance::new(points, triangles, normals)), made.deviation))
    }
}

/// Gives the surface of a field the colors and materials of its elements.
pub(super) fn dress_elements(
    made: &mut Made,
    field: &AnyField,
    (materials, colors): (&[Option<MaterialHandle>], &[[f64; 4]]),
    whole: Option<MaterialHandle>,
) {
    blend(made, field, colors);
    if !materials.is_empty() {
        let of = |mesh: &Mesh, corners: &[VertexIndex; 3]| field.owner(middle(mesh, corners));
        split_by_element(made, of, &own_or(materials, whole));
    }
}
