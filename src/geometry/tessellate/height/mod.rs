//! Height maps: a field over a rectangle as triangles, open or closed.
//!
//! Promise: every point of the triangles is vertically within the tolerance of the interpolated field, and the other way
//! round; the bound is proved (see [`scan`] and [`lattice`]). Borders depend on their own samples, the size and the
//! tolerance alone, so neighbouring maps that share a row of samples meet without a crack. A closed map is closed by its
//! points, not by nearness. Not promised: equal normals on both sides of such a seam.

mod based;
mod chain;
mod close;
mod contour;
mod delaunay;
mod dense;
mod drawn;
mod greedy;
mod ground;
mod lattice;
#[cfg(test)]
mod masked;
mod region;
mod round;
mod scan;
mod scribe;
mod sector;
#[cfg(test)]
mod tests;
mod two_sided;

pub use based::{Base, BaseFault, BaseSurface, BasedMap, Chart, Layer, SurfaceBase, based_map};
pub use two_sided::{TwoSided, two_sided};

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::map::{GridField, Interpolation};
use crate::geometry::mesh;
use crate::geometry::mesh::{Anchor, Color, Mesh, PointIndex, Run, Vertex, VertexIndex};
use chain::Side;
use close::close;
use delaunay::BORDER;
use greedy::{Floor, Goal, RefineError, Triangles, begun, refine};
use lattice::Lattice;
use region::{Keep, Region, RegionError, grain, rims};
use round::Round;

/// A field of heights over a rectangle in the x, z plane about the origin: columns go to +x, rows to +z.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// Heights along y, metres.
    pub field: Arc<GridField>,
    /// Lengths along x and z, metres.
    pub size: DVec2,
    /// Where the tolerance holds.
    pub bound: HeightBound,
    /// How it is closed.
    pub close: Closing,
    /// What is kept of it: the places where all of these hold. Maps are stretched over the rectangle.
    pub masks: Vec<Mask>,
}

/// A part of a map's rectangle, bounded by an iso-line.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    /// What is held against the threshold.
    pub field: Arc<GridField>,
    /// The value on the line.
    pub threshold: f64,
    /// Which side is kept.
    pub side: MaskSide,
}

/// Which side of a threshold is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaskSide {
    /// Where the field is at least as high.
    AtLeast,
    /// Where the field is at most as high.
    AtMost,
}

/// Where the tolerance of a height map holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeightBound {
    /// Everywhere.
    Surface,
    /// At the samples of the map.
    Samples,
    /// Every sample becomes a corner, whatever the tolerance.
    Dense,
}

/// How a height map is closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closing {
    /// It stays a sheet.
    None,
    /// By walls down to a flat base at this height.
    Base(f64),
    /// By a second sheet this far below.
    Thickness(f64),
    /// By flat ends across the axis of a cylinder that it goes all around.
    Ends,
}

impl HeightMap {
    /// The point over a place in steps of the field.
    #[must_use]
    pub fn point(&self, [x, y]: [f64; 2], height: f64) -> DVec3 {
        let [right, bottom] = self.field.extent();
        // Symmetric to the last bit.
        let place = (DVec2::new(x / right, y / bottom) * 2.0 - 1.0) * self.size / 2.0;
        DVec3::new(place.x, height, place.y)
    }

    /// The place under a point, in steps of the field; outside of the map too.
    #[must_use]
    pub fn place(&self, point: DVec3) -> [f64; 2] {
        let part = DVec2::new(point.x, point.z) / self.size + 0.5;
        let [right, bottom] = self.field.extent();
        [part.x * right, part.y * bottom]
    }

    /// Derivatives of the height along x and z for a place in steps.
    #[must_use]
    pub fn slopes(&self, [x, y]: [f64; 2]) -> DVec2 {
        let [right, bottom] = self.field.extent();
        let jet = self.field.jet(x, y);
        DVec2::new(jet.dx * right, jet.dy * bottom) / self.size
    }

    /// The unit normal over a place in steps, upward.
    #[must_use]
    pub fn normal(&self, place: [f64; 2]) -> DVec3 {
        let slopes = self.slopes(place);
        DVec3::new(-slopes.x, 1.0, -slopes.y).normalize()
    }
}

/// Makes the triangles. Texture coordinates run over the map as over a flat plane: u along x, v along z. Anchor sources:
/// 0 the surface, in steps of the field; 1 walls and base; 2 the lower sheet of a thick map.
///
/// Cost: samples times the logarithm of triangles, with a small factor; dense: linear.
///
/// # Errors
/// When a limit would be passed, or the surface reaches below its base.
pub fn height_map(
    shape: &HeightMap,
    detail: &Detail,
    tolerance: f64,
) -> Result<Tessellation, TessellateError> {
    let SurfaceDensity::Tolerance(aim) = detail.density else {
        return dense::dense(shape, detail);
    };
    match shape.bound {
        HeightBound::Dense if Region::is_needed(shape) => dense_region(shape, detail, aim, tolerance),
        HeightBound::Dense => dense::dense(shape, detail),
        HeightBound::Samples | HeightBound::Surface => adaptive(shape, detail, aim, tolerance),
    }
}

/// Share of the tolerance for borders, which must not depend on what a part of it is kept for. An edge inside that runs
/// just beside a border joins heights that are off by the border's error either way, so it may be off by twice as much:
/// with less than half of the tolerance corners do not crowd there. The slack of a spline's lattice counts as well.
fn border_tolerance(field: &GridField, aim: f64, tolerance: f64) -> f64 {
    let share = match field.interpolation() {
        Interpolation::Bilinear => 7.0 / 16.0,
        Interpolation::Bicubic => 1.0 / 4.0,
    };
    if aim >= tolerance * 15.0 / 16.0 { tolerance * share } else { tolerance * share / 2.0 }
}

fn adaptive(
    shape: &HeightMap,
    detail: &Detail,
    aim: f64,
    tolerance: f64,
) -> Result<Tessellation, TessellateError> {
    /// Finer lattices that are tried where corners find no place.
    const ATTEMPTS: i32 = 4;
    let field = &*shape.field;
    let limit = detail.triangle_limit;
    let too_many = |needed| TessellateError::TooMany { needed, limit };
    let everywhere = shape.bound == HeightBound::Surface;
    let border = border_tolerance(field, aim, tolerance);
    let grain = if Region::is_needed(shape) { grain(shape, tolerance) } else { 1 };
    let mut region = None;
    let mut attempt = 0;
    loop {
        let lattice = if everywhere {
            Lattice::fine(field, aim, 1 << attempt, limit.saturating_mul(8)).map_err(too_many)?
        } else {
            Lattice::coarse(field)
        };
        // A border is cut about as finely as the lattice, which was allowed.
        let chains = Side::ALL.map(|side| {
            if everywhere { side.chain(field, border) } else { side.sampled_chain(field, border) }
        });
        let along = chains.iter().map(|chain| chain.bound).fold(0.0, f64::max);
        let lattice = lattice.holding(&chains, grain).map_err(too_many)?;
        if region.is_none() && Region::is_needed(shape) {
            let lattices = core::slice::from_ref(&lattice);
            let traced = Region::trace(&[shape], lattices, (tolerance, border), limit);
            region = Some(traced.map_err(|error| of_region(error, limit))?);
        }
        let slack = if everywhere { lattice.slack } else { 0.0 };
        let goal = Goal {
            tolerance: aim - slack,
            everywhere,
            limit,
            region: region.as_ref().map(|region| (region, Keep::ONLY)),
            round: Round::OPEN,
            floor: floor(shape, tolerance),
        };
        let made = refine(&lattice, &chains, &goal).map_err(|error| of_refining(error, limit))?;
        if everywhere && made.error > goal.tolerance && attempt < ATTEMPTS {
            attempt += 1;
            continue;
        }
        let inside = if everywhere { made.error } else { made.measure(&lattice) };
        // Points on the border are as far from the lattice's function as from the field, and its slack more; where a
        // line meets it, the two chords instead of one may be twice as far.
        let bound = match &region {
            None => (inside + lattice.slack).max(along + 2.0 * lattice.slack),
            Some(region) => {
                let lines = made.along_rims(&lattice) + lattice.slack;
                (inside + lattice.slack).max(2.0 * along + 2.0 * lattice.slack).max(lines).max(region.error)
            }
        };
        return finish(shape, detail, &lattice, &made, bound);
    }
}

/// Every sample of what is kept, and the lines around it.
fn dense_region(
    shape: &HeightMap,
    detail: &Detail,
    aim: f64,
    tolerance: f64,
) -> Result<Tessellation, TessellateError> {
    let field = &*shape.field;
    let limit = detail.triangle_limit;
    detail.allow(2 * (field.columns() as u64 - 1) * (field.rows() as u64 - 1))?;
    let chains = Side::ALL.map(|side| side.whole_chain(field));
    let lattice = Lattice::coarse(field).holding(&chains, grain(shape, tolerance));
    let lattice = lattice.map_err(|needed| TessellateError::TooMany { needed, limit })?;
    let rise = border_tolerance(field, aim, tolerance);
    let lattices = core::slice::from_ref(&lattice);
    let region = Region::trace(&[shape], lattices, (tolerance, rise), limit);
    let region = region.map_err(|error| of_region(error, limit))?;
    let goal = Goal {
        tolerance: aim,
        everywhere: false,
        limit,
        region: Some((&region, Keep::ONLY)),
        round: Round::OPEN,
        floor: floor(shape, tolerance),
    };
    let mut made = begun(&lattice, &chains, &goal).map_err(|error| of_refining(error, limit))?;
    made.insert_nodes(&lattice, &goal);
    let along = chains.iter().map(|chain| chain.bound).fold(0.0, f64::max);
    let bound = made.measure(&lattice).max(made.along_rims(&lattice)).max(2.0 * along) + lattice.slack;
    finish(shape, detail, &lattice, &made, bound.max(region.error))
}

/// Heights next to a base at which masks may end.
fn floor(shape: &HeightMap, tolerance: f64) -> Option<Floor> {
    match shape.close {
        Closing::Base(base) if Region::is_needed(shape) => {
            Some(Floor { base, below: tolerance / 2.0, near: tolerance / 16.0 })
        }
        _ => None,
    }
}

fn of_region(error: RegionError, limit: u64) -> TessellateError {
    match error {
        RegionError::TooMany(needed) => TessellateError::TooMany { needed, limit },
        RegionError::Tangled => TessellateError::Tangled,
    }
}

fn of_refining(error: RefineError, limit: u64) -> TessellateError {
    match error {
        RefineError::TooMany(needed) => TessellateError::TooMany { needed, limit },
        RefineError::Tangled => TessellateError::Tangled,
        RefineError::Empty => TessellateError::NothingKept,
    }
}

/// The sheet of what is kept, closed.
fn finish(
    shape: &HeightMap,
    detail: &Detail,
    lattice: &Lattice<'_>,
    made: &Triangles,
    bound: f64,
) -> Result<Tessellation, TessellateError> {
    let mesh = &made.mesh;
    let mut sheet = Mesh::default();
    let mut numbers = vec![BORDER; mesh.places.len()];
    let kept: Vec<u32> = (0..mesh.triangles()).filter(|triangle| mesh.keeps(*triangle)).collect();
    for triangle in &kept {
        for corner in mesh.corners_of(*triangle) {
            numbers[corner as usize] = 0;
        }
    }
    for (corner, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number == 0) {
        *number = mesh::index(sheet.points.len());
        push(shape, &mut sheet, lattice.steps(mesh.places[corner]), made.heights[corner], detail.uv);
    }
    let number = |corner: u32| numbers[corner as usize];
    sheet.triangles = kept.iter().map(|triangle| up(mesh.corners_of(*triangle).map(number))).collect();
    let mut parts = rims(mesh);
    parts.iter_mut().flatten().flatten().for_each(|corner| *corner = number(*corner));
    close(shape, sheet, &parts, detail).map(|mesh| tessellation(mesh, bound))
}

/// A corner of the surface.
fn push(shape: &HeightMap, sheet: &mut Mesh, steps: [f64; 2], height: f64, uv: bool) {
    let point = PointIndex(mesh::index(sheet.points.len()));
    sheet.points.push(shape.point(steps, height));
    let [right, bottom] = shape.field.extent();
    let uv = if uv { DVec2::new(steps[0] / right, steps[1] / bottom) } else { DVec2::ZERO };
    let anchor = Anchor { source: 0, u: steps[0], v: steps[1] };
    sheet.vertices.push(Vertex { point, normal: shape.normal(steps), uv, color: Color::WHITE, anchor });
}

/// Corners that turn counter-clockwise over columns and rows look down; this looks up.
fn up([a, b, c]: [u32; 3]) -> [VertexIndex; 3] {
    [VertexIndex(a), VertexIndex(c), VertexIndex(b)]
}

fn tessellation(mesh: Mesh, bound: f64) -> Tessellation {
    tessellated(mesh, bound, Evidence::Proved)
}

fn tessellated(mut mesh: Mesh, bound: f64, evidence: Evidence) -> Tessellation {
    mesh.runs = vec![Run { origin: 0, end: mesh::index(mesh.triangles.len()) }];
    Tessellation { mesh, deviation: Deviation::new(bound, evidence) }
}
