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
//! [`edges`] finds the edges of the surface, [`refine`] makes few triangles of many, and what comes out is checked. Where
//! it is not sound all is made again, with [`zones`] in which small first triangles stay.

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
mod zones;

use glam::DVec3;
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use super::{Detail, Deviation, Evidence, Flaw, SurfaceDensity, TessellateError, Tessellation};
use crate::geometry::field::AnyField;
use crate::geometry::mesh;
use crate::geometry::mesh::crossing::crossings;
use crate::geometry::mesh::topology;
use crate::geometry::number::{Bounds, floor_large, single};
use cells::{Cells, Search};
use march::{NoValue, march};
use probe::{Probe, Work};
use refine::{Changed, Refiner};
use skin::{Kind, Skin};
use zones::{Wrong, Zones};

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
/// How many repairs in a row may bring nothing.
const PATIENCE: u32 = 4;
/// How often a surface is made, each time with more of its first triangles kept.
const ATTEMPTS: u32 = 8;
/// How often first triangles in zones may be joined in another way where they are half as large.
const MOST_UNSETTLED: u32 = 2;
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
        let probe = Probe::new(&self.field, self.size(), &work);
        let settled = probe.settle(place, 0.1 * self.size());
        settled.map_or_else(|| probe.far(place), |(on, _)| on.distance(place))
    }

    fn size(&self) -> f64 {
        self.within.diagonal()
    }

    fn cells(&self, zones: &Zones) -> Cells {
        let largest = (self.within.max - self.within.min).max_element() / 8.0;
        let most = (CELL_BUDGET / self.field.weight()).min(MOST_CELLS);
        let limit = usize::try_from(most).unwrap_or(usize::MAX);
        Cells::find(&self.field, &self.within, Search { least: self.least, limit, largest, zones })
    }

    /// Whether first triangles are joined in the same way where those in zones are half as large. Where parts of the surface
    /// touch it is another way at every size.
    fn is_settled(&self, detail: &Detail, zones: &Zones) -> bool {
        if zones.is_empty() {
            return true;
        }
        let most = usize::try_from(detail.triangle_limit).unwrap_or(usize::MAX).max(1000).saturating_mul(8);
        let [one, other] = [zones, &zones.halved()].map(|zones| {
            let cells = self.cells(zones);
            let rough = march(&self.field, &cells, most.min(MOST_TRIANGLES)).ok().flatten()?;
            let found = topology::of_triangles(&rough.triangles, rough.points.len()).ok()?;
            (!cells.short).then_some((found.components, found.euler))
        });
        one.is_some() && one == other
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
    let mut zones = Zones::default();
    let (mut last, mut unsettled) = (None, 0);
    for attempt in 1.. {
        let fault = match shape.made(detail, tolerance, &zones) {
            Ok(made) if shape.is_settled(detail, &zones) => return Ok(made),
            Ok(_) => {
                unsettled += 1;
                Fault::Unsound { wrong: zones.coarse(), flaw: Flaw::Touching }
            }
            Err(fault) => fault,
        };
        match (fault, last) {
            (Fault::Unsound { wrong, flaw }, _) => {
                let place = if flaw == Flaw::Touching { zones.middle() } else { wrong[0].place };
                let error = TessellateError::Unsound { place, flaw };
                if attempt == ATTEMPTS || unsettled == MOST_UNSETTLED || !zones.grow(&wrong, tolerance) {
                    return Err(error);
                }
                last = Some(error);
            }
            // Only because of small triangles in zones.
            (Fault::Ended(TessellateError::TooMuchWork | TessellateError::TooMany { .. }), Some(error)) => {
                return Err(error);
            }
            (Fault::Ended(error), _) => return Err(error),
        }
    }
    unreachable!("attempts end")
}

/// Why triangles were not made.
enum Fault {
    /// They are wrong at these places.
    Unsound { wrong: Vec<Wrong>, flaw: Flaw },
    /// Another way will not help.
    Ended(TessellateError),
}

impl From<TessellateError> for Fault {
    fn from(error: TessellateError) -> Self {
        Self::Ended(error)
    }
}

impl FieldSurface {
    /// Triangles within a tolerance; in the zones first triangles stay.
    fn made(&self, detail: &Detail, tolerance: f64, zones: &Zones) -> Result<Tessellation, Fault> {
        let field = &self.field;
        let cells = self.cells(zones);
        if let Some(place) = cells.lost {
            return Err(TessellateError::NoValue { place }.into());
        }
        if cells.short {
            return Err(TessellateError::TooMuchWork.into());
        }
        let limit = usize::try_from(detail.triangle_limit).unwrap_or(usize::MAX).max(1000);
        let too_many =
            |needed: usize| TessellateError::TooMany { needed: needed as u64, limit: detail.triangle_limit };
        // First triangles are many, and become few.
        let most = limit.saturating_mul(8);
        let rough = march(field, &cells, most.min(MOST_TRIANGLES))
            .map_err(|NoValue(place)| TessellateError::NoValue { place })?;
        let Some(rough) = rough else {
            let error =
                if most <= MOST_TRIANGLES { too_many(limit + 1) } else { TessellateError::TooMuchWork };
            return Err(error.into());
        };
        if rough.triangles.is_empty() {
            return Err(TessellateError::NoSurface.into());
        }
        let leaves = |place: DVec3| TessellateError::LeavesBox {
            place: place.clamp(self.within.min, self.within.max),
        };
        let skin = Skin::new(rough.points, rough.triangles).map_err(leaves)?;
        let work = Work::default();
        let probe = Probe::new(field, self.size(), &work);
        let maker = Maker { probe, kinks: field.has_kinks(), tolerance, limit, zones };
        let (refiner, bound) = maker.refined(skin, &rough.brackets)?;
        let made = dress::dress(&refiner, self, detail);
        if let Some(place) = self.outside(&made.points) {
            return Err(leaves(place).into());
        }
        if made.triangles.len() as u64 > detail.triangle_limit {
            return Err(too_many(made.triangles.len()).into());
        }
        Ok(Tessellation { mesh: made, deviation: Deviation::new(bound, Evidence::Sampled) })
    }
}

/// What makes good triangles of rough ones.
struct Maker<'a> {
    probe: Probe<'a>,
    /// Whether the surface may have edges.
    kinks: bool,
    tolerance: f64,
    limit: usize,
    zones: &'a Zones,
}

impl<'a> Maker<'a> {
    fn refined(&self, mut skin: Skin, brackets: &[[DVec3; 2]]) -> Result<(Refiner<'a>, f64), Fault> {
        self.settle(&mut skin, brackets);
        let least = estimate::least_triangles(&skin, self.kinks, self.tolerance);
        if least > self.limit as f64 {
            let needed = floor_large(least);
            return Err(TessellateError::TooMany { needed, limit: self.limit as u64 }.into());
        }
        if least > MOST_TRIANGLES as f64 {
            return Err(TessellateError::TooMuchWork.into());
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
                return Err(TessellateError::TooMuchWork.into());
            }
            let needed = self.limit as u64 + 1;
            return Err(TessellateError::TooMany { needed, limit: self.limit as u64 }.into());
        }
        let mut checked = Checked::default();
        let (mut fewest, mut nearest, mut stale) = (usize::MAX, usize::MAX, 0);
        for round in 0.. {
            if self.probe.is_spent() {
                return Err(TessellateError::TooMuchWork.into());
            }
            let far = self.too_far(&refiner, &mut checked);
            let crossed = if far.is_empty() { self.crossed(&refiner) } else { Vec::new() };
            let crossing = far.is_empty();
            let (found, best) = if crossing { (&crossed, &mut fewest) } else { (&far, &mut nearest) };
            if found.is_empty() {
                return Ok((refiner, checked.greatest * MARGIN));
            }
            if found.len() < *best {
                (*best, stale) = (found.len(), 0);
            } else {
                stale += 1;
            }
            // What gets no better comes right no longer.
            if round == REPAIRS || stale == PATIENCE {
                let skin = &refiner.skin;
                let wrong = |triangle: &u32| Wrong {
                    place: skin.middle(*triangle),
                    coarse: !crossing && skin.is_kept(*triangle),
                };
                let flaw = if crossing { Flaw::Crossing } else { Flaw::Far };
                return Err(Fault::Unsound { wrong: found.iter().map(wrong).collect(), flaw });
            }
            self.repair(&mut refiner, &far, &crossed, round);
        }
        unreachable!("rounds end")
    }

    /// Moves rough points onto the surface.
    fn settle(&self, skin: &mut Skin, brackets: &[[DVec3; 2]]) {
        let settled: Vec<(DVec3, DVec3, Kind)> = brackets
            .par_iter()
            .zip(skin.points.par_iter())
            .map(|([inside, outside], point)| {
                let reach = 0.5 * inside.distance(*outside);
                // Beside an edge steps along the gradient may lead across it: there points stay where they are in their
                // tetrahedra.
                let held = self.zones.hold(*point);
                let settled = if self.kinks || held { None } else { self.probe.settle(*point, reach) };
                let (place, normal) = settled.unwrap_or_else(|| self.probe.between(*inside, *outside));
                (place, normal, if held { Kind::Held } else { Kind::Smooth })
            })
            .collect();
        for (index, (place, normal, kind)) in settled.into_iter().enumerate() {
            (skin.points[index], skin.normals[index], skin.kinds[index]) = (place, normal, kind);
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
