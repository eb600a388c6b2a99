//! Fields into triangles: the surface on which a field is zero, within a tolerance.
//!
//! Promise: every point lies on the surface to a millionth of its size; the triangles are closed, without branches, and
//! no two of them cross, which is decided exactly on the positions as they are written; what cannot be made so is
//! refused. Edges of the surface (where the field has kinks) are edges of triangles. Bounds over cells decide that no
//! part of the surface is missed; where they cannot, parts smaller than a least size may be. The deviation is the
//! greatest of samples in and around the triangles, with a margin. Work ends: cells, rounds, triangles and what is asked
//! of the field are counted.
//!
//! The way: [`cells`] finds where the surface runs, [`mod@march`] makes first triangles that are sound by construction,
//! [`edges`] finds the edges of the surface, [`refine`] makes few triangles of many, and what comes out is checked.

mod cells;
mod dress;
mod edges;
mod estimate;
mod march;
mod probe;
mod refine;
mod skin;
#[cfg(test)]
mod tests;
mod untangle;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::{Detail, Deviation, Evidence, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::field::AnyField;
use crate::geometry::mesh;
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::number::{Bounds, floor_large, single};
use cells::{Cells, Search};
use march::{NoValue, march};
use probe::{Probe, Work};
use refine::{Changed, Refiner};
use skin::{Kind, Skin};

/// The surface of a field inside a box.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldSurface {
    /// The field; negative inside.
    pub field: AnyField,
    /// Where it is searched.
    pub within: Bounds,
    /// Where bounds prove nothing, parts thinner than this may be missed; a share of the box where it is not given.
    pub least: Option<f64>,
}

/// Most cells that are looked at.
const MOST_CELLS: u64 = 1 << 20;
/// Most triangles that are worked on, first ones among them: some hundred bytes each, and some tens of microseconds.
const MOST_TRIANGLES: usize = 1 << 21;
/// How often parts of fields may be studied over cells.
const CELL_BUDGET: u64 = 1 << 25;
/// How many times the triangles of the limit there may be before edges are drawn together.
const MOST_SPARE: usize = 2;
/// How much greater than the greatest sample the deviation is said to be.
const MARGIN: f64 = 1.06;
/// How often triangles that are too far off or cross are made smaller.
const REPAIRS: u32 = 14;
/// So many triangles that cross or are too far off are always worth another try.
const MOST_TANGLED: usize = 1 << 10;
/// Places in a triangle, by the shares of its corners: those of a lattice that cuts its sides in six, without the corners.
const SAMPLES: [[f64; 3]; 25] = {
    let mut all = [[0.0; 3]; 25];
    let (mut count, mut u) = (0, 0);
    while u < 6 {
        let mut v = 0;
        while v <= 6 - u {
            let w = 6 - u - v;
            if v < 6 && w < 6 {
                all[count] = [u as f64 / 6.0, v as f64 / 6.0, w as f64 / 6.0];
                count += 1;
            }
            v += 1;
        }
        u += 1;
    }
    all
};

impl FieldSurface {
    /// How far a place near the surface is from it.
    #[must_use]
    pub fn distance(&self, place: DVec3) -> f64 {
        let work = Work::default();
        let probe = Probe { field: &self.field, size: self.size(), work: &work };
        let settled = probe.settle(place, 0.1 * self.size());
        settled.map_or_else(|| probe.far(place), |(on, _)| on.distance(place))
    }

    fn size(&self) -> f64 {
        self.within.diagonal()
    }

    fn cells(&self) -> Cells {
        let largest = (self.within.max - self.within.min).max_element() / 8.0;
        let most = (CELL_BUDGET / self.field.weight()).min(MOST_CELLS);
        let limit = usize::try_from(most).unwrap_or(usize::MAX);
        Cells::find(&self.field, &self.within, Search { least: self.least, limit, largest })
    }

    /// A point of a mesh that is not in the box, by more than rounding.
    fn outside(&self, points: &[DVec3]) -> Option<DVec3> {
        let slack = 1e-6 * self.size();
        let (low, high) = (self.within.min - slack, self.within.max + slack);
        points.iter().copied().find(|point| point.cmplt(low).any() || point.cmpgt(high).any())
    }
}

/// Makes the triangles of a field's surface. Anchors have source 0.
///
/// # Errors
/// When there is no surface in the box, it reaches the box, the field has no value somewhere, a limit is passed, the
/// work would not end soon, or parts of the surface come too close to be told apart.
pub fn field_surface(shape: &FieldSurface, detail: &Detail) -> Result<Tessellation, TessellateError> {
    let tolerance = match detail.density {
        SurfaceDensity::Tolerance(tolerance) => tolerance,
        // Cells along the longest side take the place of steps.
        SurfaceDensity::Grid { u, v } => shape.size() / f64::from(u.max(v).max(4)) / 8.0,
    };
    let field = &shape.field;
    let cells = shape.cells();
    if let Some(place) = cells.lost {
        return Err(TessellateError::NoValue { place });
    }
    if cells.short {
        return Err(TessellateError::TooMuchWork);
    }
    let limit = usize::try_from(detail.triangle_limit).unwrap_or(usize::MAX).max(1000);
    let too_many =
        |needed: usize| TessellateError::TooMany { needed: needed as u64, limit: detail.triangle_limit };
    // First triangles are many, and become few.
    let most = limit.saturating_mul(8);
    let rough = march(field, &cells, most.min(MOST_TRIANGLES))
        .map_err(|NoValue(place)| TessellateError::NoValue { place })?;
    let Some(rough) = rough else {
        let error = if most <= MOST_TRIANGLES { too_many(limit + 1) } else { TessellateError::TooMuchWork };
        return Err(error);
    };
    if rough.triangles.is_empty() {
        return Err(TessellateError::NoSurface);
    }
    let leaves =
        |place: DVec3| TessellateError::LeavesBox { place: place.clamp(shape.within.min, shape.within.max) };
    let skin = Skin::new(rough.points, rough.triangles).map_err(leaves)?;
    let work = Work::default();
    let probe = Probe { field, size: shape.size(), work: &work };
    let maker = Maker { probe, kinks: field.has_kinks(), tolerance, limit };
    let (refiner, bound) = maker.refined(skin, &rough.brackets)?;
    let made = dress::dress(&refiner, shape, detail);
    if let Some(place) = shape.outside(&made.points) {
        return Err(leaves(place));
    }
    if made.triangles.len() as u64 > detail.triangle_limit {
        return Err(too_many(made.triangles.len()));
    }
    Ok(Tessellation { mesh: made, deviation: Deviation::new(bound, Evidence::Sampled) })
}

/// What makes good triangles of rough ones.
struct Maker<'a> {
    probe: Probe<'a>,
    /// Whether the surface may have edges.
    kinks: bool,
    tolerance: f64,
    limit: usize,
}

impl<'a> Maker<'a> {
    fn refined(
        &self,
        mut skin: Skin,
        brackets: &[[DVec3; 2]],
    ) -> Result<(Refiner<'a>, f64), TessellateError> {
        self.settle(&mut skin, brackets);
        let least = estimate::least_triangles(&skin, self.kinks, self.tolerance);
        if least > self.limit as f64 {
            return Err(TessellateError::TooMany { needed: floor_large(least), limit: self.limit as u64 });
        }
        if least > MOST_TRIANGLES as f64 {
            return Err(TessellateError::TooMuchWork);
        }
        let most = skin.triangles.len().max(self.limit.saturating_mul(MOST_SPARE).min(MOST_TRIANGLES));
        if self.kinks {
            self.probe.add_edges(&mut skin, None);
        }
        let target = self.tolerance / MARGIN;
        let mut refiner =
            Refiner { probe: self.probe, skin, tolerance: target, limit: most, changed: Changed::default() };
        if !refiner.run() || self.probe.is_spent() {
            if self.probe.is_spent() || most <= self.limit {
                return Err(TessellateError::TooMuchWork);
            }
            return Err(TessellateError::TooMany { needed: self.limit as u64 + 1, limit: self.limit as u64 });
        }
        let mut checked = Checked::default();
        let (mut fewest, mut nearest) = (usize::MAX, usize::MAX);
        for round in 0..REPAIRS {
            if self.probe.is_spent() {
                return Err(TessellateError::TooMuchWork);
            }
            let far = self.too_far(&refiner, &mut checked);
            let crossed = if far.is_empty() { self.crossed(&refiner) } else { Vec::new() };
            if far.is_empty() && crossed.is_empty() {
                return Ok((refiner, checked.greatest * MARGIN));
            }
            // What gets worse and worse comes right no longer.
            if far.len() > nearest.max(MOST_TANGLED).saturating_mul(2) {
                break;
            }
            if !far.is_empty() {
                nearest = nearest.min(far.len());
            }
            if crossed.len() > fewest.max(MOST_TANGLED).saturating_mul(2) {
                break;
            }
            if far.is_empty() {
                fewest = fewest.min(crossed.len());
            }
            self.repair(&mut refiner, &far, &crossed, round);
        }
        let crossed = self.crossed(&refiner);
        let far = self.too_far(&refiner, &mut checked);
        // What is too far off is split until it crosses.
        match far.first().or(crossed.first()) {
            None => Ok((refiner, checked.greatest * MARGIN)),
            Some(triangle) => {
                let corners = refiner.skin.triangles[*triangle as usize];
                let place = refiner.skin.point(corners[0]);
                Err(TessellateError::Unsound { place, crossing: far.is_empty() })
            }
        }
    }

    /// Moves rough points onto the surface.
    fn settle(&self, skin: &mut Skin, brackets: &[[DVec3; 2]]) {
        let settled: Vec<(DVec3, DVec3)> = brackets
            .par_iter()
            .zip(skin.points.par_iter())
            .map(|([inside, outside], point)| {
                let reach = 0.5 * inside.distance(*outside);
                // Beside an edge steps along the gradient may lead across it: there points stay where they are in their
                // tetrahedra.
                let settled = if self.kinks { None } else { self.probe.settle(*point, reach) };
                settled.unwrap_or_else(|| self.probe.between(*inside, *outside))
            })
            .collect();
        for (index, (place, normal)) in settled.into_iter().enumerate() {
            (skin.points[index], skin.normals[index]) = (place, normal);
        }
    }

    /// How far a place is from the surface.
    fn distance(&self, place: DVec3) -> f64 {
        let settled = self.probe.settle(place, 8.0 * self.tolerance);
        settled.map_or_else(|| self.probe.far(place), |(on, _)| on.distance(place))
    }

    /// Triangles that are further from the surface than allowed, by samples in them and on their sides. What was measured
    /// before and has not changed is not measured again.
    fn too_far(&self, refiner: &Refiner<'_>, checked: &mut Checked) -> Vec<u32> {
        let skin = &refiner.skin;
        let allowed = self.tolerance / MARGIN;
        let measured: Vec<f64> = skin
            .triangles
            .par_iter()
            .enumerate()
            .map(|(index, corners)| {
                if corners[0] == skin::NONE {
                    return 0.0;
                }
                let [a, b, c] = corners.map(|corner| skin.point(corner));
                let key = [a, b, c];
                if checked.corners.get(index) == Some(&key) {
                    return checked.measured[index];
                }
                SAMPLES.iter().map(|[u, v, w]| self.distance(a * *u + b * *v + c * *w)).fold(0.0, f64::max)
            })
            .collect();
        let places = |corners: &[u32; 3]| {
            if corners[0] == skin::NONE { [DVec3::NAN; 3] } else { corners.map(|corner| skin.point(corner)) }
        };
        checked.corners = skin.triangles.par_iter().map(places).collect();
        checked.greatest = measured.iter().copied().fold(0.0, f64::max);
        checked.measured = measured;
        let far = checked.measured.iter().enumerate().filter(|(_, distance)| **distance > allowed);
        far.map(|(index, _)| mesh::index(index)).collect()
    }

    /// Triangles that cross others once positions are rounded as they are written.
    fn crossed(&self, refiner: &Refiner<'_>) -> Vec<u32> {
        let (kept, triangles) = refiner.skin.compact();
        let round = |point: DVec3| DVec3::from_array(point.to_array().map(|x| f64::from(single(x))));
        let points: Vec<DVec3> = kept.iter().map(|index| round(refiner.skin.point(*index))).collect();
        let all = 0..mesh::index(refiner.skin.triangles.len());
        let alive: Vec<u32> = all.filter(|triangle| refiner.skin.is_alive(*triangle)).collect();
        let mut found: Vec<u32> =
            crossings(&points, &triangles).into_iter().flatten().map(|index| alive[index as usize]).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Makes triangles smaller that are too far off, and sounder those that cross.
    fn repair(&self, refiner: &mut Refiner<'_>, far: &[u32], crossed: &[u32], round: u32) {
        if self.kinks && round % 3 == 2 && self.probe.add_edges(&mut refiner.skin, Some(far)) {
            // What was hidden between the old points was an edge.
            refiner.tidy();
            return;
        }
        for triangle in far {
            if !refiner.skin.is_alive(*triangle) {
                continue;
            }
            refiner.split_any(*triangle);
        }
        refiner.turn();
        refiner.untangle(crossed, round);
    }
}

/// What was measured of triangles, with the places of their corners then.
#[derive(Debug, Default)]
struct Checked {
    corners: Vec<[DVec3; 3]>,
    measured: Vec<f64>,
    greatest: f64,
}

/// Whether a point lies on an edge of the surface.
fn is_on_edge(skin: &Skin, index: u32) -> bool {
    skin.kind(index) != Kind::Smooth
}
