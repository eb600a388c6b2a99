//! Height maps over curved bases: heights along the normals of ellipsoids, cylinders and surfaces, as triangles.
//!
//! Promise: every point of the triangles is within the tolerance of the skin S = B + h n, and every point of the skin
//! within it of a triangle: the triangle's point of the same parameters is that near. The bound is proved where the
//! base has one for its derivatives, else sampled, and says which. What closes all around is one mesh with one point for
//! each place, at poles too; texture coordinates are cut at the seam. A skin that would cross itself is refused: where
//! normals meet by the curvature of the base, elsewhere by an exact test of the triangles. Not promised: that a row which
//! is a point has no spread; its mean stands.
//!
//! The search is that of flat maps, over points instead of heights: see [`ground`](super::ground).

mod base;
mod chart;
mod cut;
mod sheet;
mod skin;
mod surface;
#[cfg(test)]
mod tests;
mod walls;

pub use base::Base;
pub use chart::Chart;
pub use skin::Layer;
pub use surface::{BaseFault, BaseSurface, SurfaceBase};

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::greedy::{Floor, Goal, Triangles, refine};
use super::ground::{Ground as _, Value as _};
use super::lattice::Lattice;
use super::region::{Keep, Region, grain};
use super::round::Round;
use super::{Closing, HeightBound, HeightMap, border_tolerance, of_refining, of_region};
use crate::geometry::map::GridJet;
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::tessellate::{Detail, Evidence, SurfaceDensity, TessellateError, Tessellation};
use cut::Cut;
use sheet::Sheet;
use skin::Skin;

/// Heights over a base.
#[derive(Clone, Debug, PartialEq)]
pub struct BasedMap {
    heights: HeightMap,
    base: Base,
}

/// A point of a skin and its derivatives by steps of the field.
#[derive(Clone, Copy, Debug)]
pub struct SkinJet {
    /// Metres.
    pub point: DVec3,
    /// By columns.
    pub dx: DVec3,
    /// By rows.
    pub dy: DVec3,
    /// Outward unit normal.
    pub normal: DVec3,
}

impl BasedMap {
    /// Heights over a base. The size of the map follows from the base, and the field and the masks close as it does.
    #[must_use]
    pub fn new(base: Base, mut heights: HeightMap) -> Self {
        let closes = base.closes();
        let closed = |field: &Arc<_>| Arc::new(crate::geometry::map::GridField::closed(field, closes));
        heights.field = closed(&heights.field);
        for mask in &mut heights.masks {
            mask.field = closed(&mask.field);
        }
        let mut map = Self { heights, base };
        map.heights.size = map.lengths();
        map
    }

    /// The heights.
    #[must_use]
    pub fn heights(&self) -> &HeightMap {
        &self.heights
    }

    /// The greatest lengths of rows and columns on the skin, found in many places.
    fn lengths(&self) -> DVec2 {
        const PLACES: u32 = 32;
        let part = |k: u32| (f64::from(k) + 0.5) / f64::from(PLACES);
        let (low, high) = self.heights.field.range();
        let places = (0..PLACES).flat_map(|i| (0..PLACES).map(move |j| (part(i), part(j))));
        places.fold(DVec2::splat(f64::MIN_POSITIVE), |most, (s, t)| {
            let jet = self.base.jet(s, t);
            [low, high].into_iter().fold(most, |most, height| {
                let across = (jet.ds + jet.normal_ds * height).length();
                let along = (jet.dt + jet.normal_dt * height).length();
                most.max(DVec2::new(across, along))
            })
        })
    }

    /// Parts of the rectangle for a place in steps.
    fn parts(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [right, bottom] = self.heights.field.extent();
        [x / right, y / bottom]
    }

    fn height(&self, layer: Layer, [x, y]: [f64; 2]) -> f64 {
        match layer {
            Layer::Top => self.heights.field.value(x, y),
            Layer::Level(level) => level,
            Layer::Below(depth) => self.heights.field.value(x, y) - depth,
        }
    }

    /// Height and slopes; over a seam the mean of both sides.
    fn height_jet(&self, layer: Layer, [x, y]: [f64; 2]) -> GridJet {
        let field = &*self.heights.field;
        let lower = match layer {
            Layer::Top => 0.0,
            Layer::Level(level) => return GridJet { value: level, dx: 0.0, dy: 0.0 },
            Layer::Below(depth) => depth,
        };
        let [right, bottom] = field.extent();
        let closes = self.base.closes();
        let mut jet = field.jet(x, y);
        if closes.columns && (x == 0.0 || x == right) {
            jet.dx = f64::midpoint(jet.dx, field.jet(right - x, y).dx);
        }
        if closes.rows && (y == 0.0 || y == bottom) {
            jet.dy = f64::midpoint(jet.dy, field.jet(x, bottom - y).dy);
        }
        GridJet { value: jet.value - lower, ..jet }
    }

    /// Point and derivatives of a skin at a place in steps of the field.
    #[must_use]
    pub fn jet(&self, layer: Layer, place: [f64; 2]) -> SkinJet {
        let [right, bottom] = self.heights.field.extent();
        let [s, t] = self.parts(place);
        let base = self.base.jet(s, t);
        let height = self.height_jet(layer, place);
        let dx = (base.ds + base.normal_ds * height.value) / right + base.normal * height.dx;
        let dy = (base.dt + base.normal_dt * height.value) / bottom + base.normal * height.dy;
        // Rows run down, or the other way.
        let across = if self.base.is_turned() { dx.cross(dy) } else { dy.cross(dx) };
        let size = dx.length() * dy.length();
        let normal = if across.length() > 1e-9 * size { across.normalize() } else { base.normal };
        SkinJet { point: base.point + base.normal * height.value, dx, dy, normal }
    }

    /// What closes the body below.
    fn under(&self) -> Option<Layer> {
        match self.heights.close {
            Closing::None | Closing::Ends => None,
            Closing::Base(level) => Some(Layer::Level(level)),
            Closing::Thickness(depth) => Some(Layer::Below(depth)),
        }
    }

    /// How far the layers may lie.
    #[must_use]
    pub fn layers(&self) -> Vec<Layer> {
        core::iter::once(Layer::Top).chain(self.under()).collect()
    }

    /// Refuses layers that fold over themselves since they lie deeper than the base is curved.
    fn check_folds(&self, layers: &[Layer]) -> Result<(), TessellateError> {
        let field = &*self.heights.field;
        let lowest = field.range().0;
        if let Some(reach) = self.base.reach() {
            let deep = |layer: &Layer| match layer {
                Layer::Top => lowest <= -reach,
                Layer::Level(level) => *level <= -reach,
                Layer::Below(depth) => lowest - depth <= -reach,
            };
            let Some(layer) = layers.iter().find(|layer| deep(layer)) else { return Ok(()) };
            let samples = field.samples();
            let least = (0..samples.len()).min_by(|a, b| samples[*a].total_cmp(&samples[*b])).unwrap_or(0);
            let place = [(least % field.columns()) as f64, (least / field.columns()) as f64];
            return Err(TessellateError::CrossesItself { place: self.jet(*layer, place).point });
        }
        let [right, bottom] = field.extent();
        let inner = |k: usize, of: usize, end: f64| end * (k as f64 + 0.5) / of as f64;
        let (m, n) = (2 * field.columns().max(16), 2 * field.rows().max(16));
        for (i, j) in (0..n).flat_map(|j| (0..m).map(move |i| (i, j))) {
            let place = [inner(i, m, right), inner(j, n, bottom)];
            let [s, t] = self.parts(place);
            let base = self.base.jet(s, t);
            for layer in layers {
                let height = self.height(*layer, place);
                let turned = (base.ds + base.normal_ds * height).cross(base.dt + base.normal_dt * height);
                if turned.dot(base.ds.cross(base.dt)) <= 0.0 {
                    return Err(TessellateError::CrossesItself { place: self.jet(*layer, place).point });
                }
            }
        }
        Ok(())
    }

    /// A radius that no part of the layers comes below, as far as is known.
    fn least_radius(&self) -> f64 {
        let low = self.heights.field.range().0;
        match &self.base {
            Base::Ellipsoid { radii, .. } => radii.min_element() + low.min(0.0),
            Base::Cylinder { radius, .. } => radius + low.min(0.0),
            Base::Surface(base) => base.girth() + low.min(0.0),
        }
    }
}

/// Makes the triangles. Texture coordinates run over the field. Anchor sources: 0 the skin, in steps of the field; 1 walls
/// and ends; 2 the lower skin.
///
/// # Errors
/// When a limit would be passed, the heights reach below what closes them, or the skin crosses itself.
pub fn based_map(map: &BasedMap, detail: &Detail, tolerance: f64) -> Result<Tessellation, TessellateError> {
    let layers = map.layers();
    map.check_folds(&layers)?;
    let aim = match detail.density {
        SurfaceDensity::Tolerance(aim) => aim,
        SurfaceDensity::Grid { .. } => tolerance,
    };
    // A tolerance about as large as the base would lose the base itself.
    let least = map.least_radius() / 4.0;
    let (aim, tolerance) =
        if least > 0.0 { (aim.min(least), tolerance.min(least)) } else { (aim, tolerance) };
    let skins: Vec<Skin<'_>> = layers.iter().map(|layer| Skin::new(map, *layer)).collect();
    let (sheets, bound) = if map.heights.bound == HeightBound::Dense && !Region::is_needed(&map.heights) {
        dense(map, &skins, detail)?
    } else {
        adaptive(map, &skins, detail, (aim, tolerance))?
    };
    let made = walls::joined(map, &layers, &sheets, detail)?;
    if map.base.reach().is_none() {
        check_crossings(&made)?;
    }
    let evidence = if map.base.bounds().is_some() { Evidence::Proved } else { Evidence::Sampled };
    Ok(super::tessellated(made, bound, evidence))
}

/// Refuses triangles that run through each other.
fn check_crossings(mesh: &crate::geometry::mesh::Mesh) -> Result<(), TessellateError> {
    let triangles: Vec<[u32; 3]> = mesh
        .triangles
        .iter()
        .map(|corners| corners.map(|corner| mesh.vertices[corner.subscript()].point.0))
        .collect();
    match crossings(&mesh.points, &triangles).first() {
        None => Ok(()),
        Some([one, _]) => {
            let corners = triangles[*one as usize].map(|corner| mesh.points[corner as usize]);
            Err(TessellateError::CrossesItself { place: (corners[0] + corners[1] + corners[2]) / 3.0 })
        }
    }
}

/// Every sample a corner.
fn dense(map: &BasedMap, skins: &[Skin<'_>], detail: &Detail) -> Result<(Vec<Sheet>, f64), TessellateError> {
    let field = &*map.heights.field;
    let cells = (field.columns() as u64 - 1) * (field.rows() as u64 - 1);
    detail.allow(2 * cells * skins.len() as u64)?;
    let closes = map.base.closes();
    let round = round_of(closes, 1);
    let sheets: Vec<(Sheet, f64)> = skins.iter().map(|skin| Sheet::dense(skin, &round)).collect();
    let bound = sheets.iter().map(|(_, bound)| *bound).fold(0.0, f64::max);
    Ok((sheets.into_iter().map(|(sheet, _)| sheet).collect(), bound))
}

fn round_of(closes: crate::geometry::map::Closes, ring: i32) -> Round {
    Round {
        closed: [closes.columns, closes.rows],
        poles: [closes.first, closes.last],
        ring,
        lines: Vec::new(),
    }
}

fn adaptive(
    map: &BasedMap,
    skins: &[Skin<'_>],
    detail: &Detail,
    (aim, tolerance): (f64, f64),
) -> Result<(Vec<Sheet>, f64), TessellateError> {
    /// Finer lattices that are tried where corners find no place.
    const ATTEMPTS: i32 = 4;
    let limit = detail.triangle_limit;
    let too_many = |needed| TessellateError::TooMany { needed, limit };
    let closes = map.base.closes();
    let heights = &map.heights;
    let border = border_tolerance(&heights.field, aim, tolerance) / 2.0;
    let grain = if Region::is_needed(heights) { grain(heights, tolerance) } else { 1 };
    let mut region = None;
    let mut attempt = 0;
    loop {
        let mut lattices = lattices(skins, aim, 1 << attempt, limit.saturating_mul(8)).map_err(too_many)?;
        let cut = Cut::new(&lattices, closes, border);
        for lattice in &mut lattices {
            let parts = lattice.parts().max(grain).max(u64::from(lattice.refine));
            lattice.set_parts(parts).map_err(too_many)?;
        }
        let finest = lattices.iter().map(Lattice::parts).fold(1, u64::max);
        for lattice in &mut lattices {
            lattice.set_parts(finest).map_err(too_many)?;
        }
        if region.is_none() && Region::is_needed(heights) {
            let traced = Region::trace(&[heights], &lattices, (tolerance, border), limit);
            region = Some(traced.map_err(|error| of_region(error, limit))?);
        }
        let round =
            Round { ring: lattices[0].units, lines: cut.lines(lattices[0].units), ..round_of(closes, 0) };
        let mut sheets = Vec::new();
        let (mut bound, mut missed) = (0.0_f64, false);
        for (skin, lattice) in skins.iter().zip(&lattices) {
            let everywhere = heights.bound != HeightBound::Samples;
            let goal = Goal {
                tolerance: if everywhere { aim - lattice.slack } else { aim },
                everywhere,
                limit,
                region: region.as_ref().map(|region| (region, Keep::ONLY)),
                round: round.clone(),
                floor: floor(heights, tolerance),
            };
            let made = refine(lattice, &cut.chains, &goal).map_err(|error| of_refining(error, limit))?;
            missed |= made.error > goal.tolerance;
            let inside = if everywhere { made.error } else { made.measure(lattice) };
            bound = bound.max(inside.max(made.along_lines(lattice, &round)) + lattice.slack);
            sheets.push(Sheet::of(&made, lattice, &round, skin));
        }
        if missed && attempt < ATTEMPTS {
            attempt += 1;
            continue;
        }
        return Ok((sheets, bound.max(region.as_ref().map_or(0.0, |region| region.error))));
    }
}

/// Heights next to a base at which masks may end.
fn floor(heights: &HeightMap, tolerance: f64) -> Option<Floor> {
    super::floor(heights, tolerance)
}

/// Lattices of equal steps over all skins.
fn lattices<'s, 'm>(
    skins: &'s [Skin<'m>],
    aim: f64,
    finer: i32,
    limit: u64,
) -> Result<Vec<Lattice<'s, Skin<'m>>>, u64> {
    /// Steps in each direction, so that rings around poles lie apart and a way around has its parts.
    const LEAST: f64 = 12.0;
    let [right, bottom] = skins[0].grid().extent();
    let mut least = 1_u64;
    while right.min(bottom) * (least as f64) < LEAST {
        least *= 2;
    }
    for skin in skins {
        least = least.max(super::lattice::refinement(skin.bend(), aim));
    }
    skins.iter().map(|skin| Lattice::cut(skin, (aim, least), finer, limit)).collect()
}

impl Triangles<DVec3> {
    /// The greatest error along borders and lines of what is kept, cones around poles left out.
    fn along_lines(&self, lattice: &Lattice<'_, Skin<'_>>, round: &Round) -> f64 {
        let mesh = &self.mesh;
        let of = |triangle: u32| {
            if !mesh.keeps(triangle) || round.at_pole(mesh, triangle) {
                return 0.0;
            }
            let sides = (3 * triangle..3 * triangle + 3)
                .filter(|side| mesh.beyond(*side) == super::BORDER || mesh.line(*side) != 0);
            let errors = sides.map(|side| {
                let [from, to] = [side, super::delaunay::next(side)].map(|side| {
                    let corner = mesh.corners[side as usize] as usize;
                    (mesh.places[corner], self.heights[corner])
                });
                super::scan::edge(lattice, from, to).error
            });
            errors.fold(0.0, f64::max)
        };
        (0..mesh.triangles()).map(of).fold(0.0, f64::max)
    }
}

/// The distance of two diagonals' middles: by half of it a cell rises above either.
fn twist(values: [DVec3; 4]) -> f64 {
    (values[0] - values[1] + values[2] - values[3]).size() / 4.0
}
