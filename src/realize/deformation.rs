//! Deformations with what the shape itself decides: where a change begins and ends.

use glam::DVec3;

use super::extents::Extents;
use super::reach::reach;
use crate::geometry::curve::Curve as _;
use crate::geometry::surface::{AxialDeformation, AxialKind, Deformation, Line, PathDeformation};
use crate::geometry::tessellate::DeformError;
use crate::model::{AxialBending, Bending, Model, PathBending, ShapeHandle};

/// The map of a bending of a shape; `extents` knows all shapes up to it.
///
/// # Errors
/// When the shape has no length along the axis where the map is to act, or is longer than its path.
pub(super) fn deformation(
    model: &Model,
    extents: &Extents,
    of: ShapeHandle,
    by: &Bending,
) -> Result<Deformation, DeformError> {
    match by {
        Bending::Axial(bending) => axial(model, extents, of, bending).map(Deformation::Axial),
        Bending::Along(bending) => along(model, extents, of, bending),
    }
}

/// From where to where a shape reaches along an axis, from a point on it.
fn span(model: &Model, extents: &Extents, of: ShapeHandle, (around, axis): (DVec3, DVec3)) -> (f64, f64) {
    let (low, high) = reach(model, extents, of, axis);
    let offset = around.dot(axis);
    (low - offset, high - offset)
}

fn axial(
    model: &Model,
    extents: &Extents,
    of: ShapeHandle,
    bending: &AxialBending,
) -> Result<AxialDeformation, DeformError> {
    let (low, high) = span(model, extents, of, (bending.around, bending.axis));
    // Written places are coordinates; the map counts from the point on the axis.
    let offset = bending.around.dot(bending.axis);
    let from = bending.from.map_or(low, |from| from - offset);
    let to = bending.to.map_or(high, |to| to - offset);
    let least = 1e-9 * (high - low).max(from.abs()).max(to.abs());
    if to - from <= least || !(to - from).is_finite() {
        return Err(DeformError::NoLength);
    }
    // A taper that goes on beyond the places that were written would turn inside out sooner or later.
    let stops = (bending.from.is_some(), bending.to.is_some());
    let stops = if matches!(bending.kind, AxialKind::Taper { .. }) {
        (stops.0 || from > low, stops.1 || to < high)
    } else {
        stops
    };
    Ok(AxialDeformation {
        origin: bending.around,
        axis: bending.axis,
        side: bending.side,
        from,
        to,
        stops,
        kind: bending.kind,
    })
}

fn along(
    model: &Model,
    extents: &Extents,
    of: ShapeHandle,
    bending: &PathBending,
) -> Result<Deformation, DeformError> {
    /// Share of the length by which a shape may be longer than its path: what rounding adds.
    const ROUNDING: f64 = 1e-9;
    let (low, high) = span(model, extents, of, (bending.around, bending.axis));
    let offset = bending.around.dot(bending.axis);
    let from = bending.from.map_or(low, |from| from - offset);
    let (low, high) = (low - from, high - from);
    let map = |from: f64, scale: f64| {
        let start = bending.around + bending.axis * from;
        let line = Line {
            origin: start,
            axis: bending.axis,
            side: bending.side,
            reach: (low * scale, high * scale),
            scale,
        };
        PathDeformation::new(bending.path.clone(), &bending.carry, line)
    };
    let plain = map(from, 1.0);
    let length = plain.length();
    if bending.stretch {
        if high - low <= ROUNDING * low.abs().max(high.abs()) || !(high - low).is_finite() {
            return Err(DeformError::NoLength);
        }
        return Ok(Deformation::Along(Box::new(map(from + low, length / (high - low)))));
    }
    let rounding = ROUNDING * length;
    if !bending.path.is_closed() && (low < -rounding || high > length + rounding) {
        return Err(DeformError::TooLong { from: low, to: high, length });
    }
    Ok(Deformation::Along(Box::new(plain)))
}
